"""What SD, SDR, COF, DPC, SCL and NCF read of a channel, taken from its run when called (Manual 003, 4.6-4.9)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, cast

from polycnc.cnc import ProgramRun
from polycnc.controllers.bosch._axes import SystemAxes
from polycnc.controllers.bosch._channel_ports import CUTTING, ChannelPorts, SpindleNow
from polycnc.controllers.bosch.ncs import Mode
from polycnc.controllers.bosch.system import SD_GROUPS, LastFunctions, Moment, ProgrammedShifts, SystemData
from polycnc.nc import Group, ModalWords

_SPINDLE = 1
_SINGLE_BLOCK, _AUTOMATIC, _PROGRAM_BLOCK = range(3)
_SEARCH = 10
"""Added to the machining mode while a block is sought: 10 with single blocks, 11 in automatic."""
_SENSES = {1: 3, -1: 4, 0: 0}
_ORIENTED = 19
_OFF = (53, 153, 253, 67, 39, 146, 167)
"""What is in force of groups of which nothing was programmed; the last switches external zero shifts off."""
_EXTERNAL = frozenset(("G160", "G260", "G360", "G167"))
_STATED = (
    Group.MOTION, Group.DISTANCE, Group.UNITS, Group.PLANE, Group.FEED_MODE, Group.RADIUS_COMPENSATION,
)  # fmt: skip
_PLANES = {17: (0, 1), 18: (2, 0), 19: (1, 2)}
_M_GROUPS = (("M3", "M4", "M5", "M19"), ("M7", "M8", "M9"))
_GROUP_OF = {code: group for group, codes in SD_GROUPS.items() for code in codes}
_OTHER_GROUPS = ((138, 139), (168, 169), (268, 269), (147, 148, 247, 347, 447, 547, 647, 747, 847))


class ChannelData:
    """The system data of channel `number` of `channels`; `language` is the country code of MACODA 6010 00010."""

    def __init__(self, axes: SystemAxes, number: int, channels: ChannelPorts, language: int) -> None:
        self._axes = axes
        self._number = number
        self._channels = channels
        self._language = language
        self.functions: Mapping[str, Callable[..., object]] = {
            "SD": lambda *place: self.system_data().sd(*place),
            "SDR": lambda *place: self.system_data().sdr(*place),
            "COF": lambda *axis: self._shifts().cof(*axis),
            "DPC": lambda *axis: self._shifts().dpc(*axis),
            "SCL": lambda *axis: self._shifts().scl(*axis),
            "NCF": lambda word: self._last().ncf(word),
        }

    @property
    def run(self) -> ProgramRun:
        """The run of the channel."""
        run = self._channels.run(self._number)
        assert run is not None, "attach the run first"
        return run

    # ------------------------------------------------------------------ SD

    def system_data(self) -> SystemData:
        """Return what SD and SDR read now."""
        run, axes = self.run, self._axes
        state = run.channel.state
        programmed, executed = self.programmed(), run.reading.modal
        once = programmed.placement.once
        now = self._channels.spindle()
        overrides = {_SPINDLE: now.override * 100.0}
        turning = programmed if executed is None else executed
        rpm = now.actual_rpm
        if rpm is None:
            rpm = turning.speed if turning.spindle_direction else 0.0
        probe = state.probe
        config = run.machine.config
        own = [config.axes[axes.index(number)] for number in axes.channels[self._number]]
        return SystemData(
            channel=self._number,
            programmed=_later(lambda: self._moment(programmed)),
            active=_later(lambda: self._active(turning, now)),
            block_function=0 if once in _GROUP_OF else once,
            feed_override=run.overrides.feed * 100.0,
            rapid=max((axis.vmax * 60.0 for axis in own if axis.unit == "mm"), default=0.0)
            / (25.4 if programmed.inch else 1.0),
            spindle_overrides=overrides,
            actual_rpm={_SPINDLE: rpm},
            probe_missing=probe is not None and probe.position is None,
            machining_mode=self._machining_mode(),
            language=self._language,
            test_without_motion=run.switches.machine_lock,
            axis_names=dict(zip(axes.names, axes.numbers, strict=True)),
            logical_names=axes.logical_names(),
            search_positions=dict(
                enumerate(self._by_axis(run.selection.searched or (), state.modal.scale), 1)
            ),
            machining_axes=frozenset(range(1, len(axes.channels[self._number]) + 1)),
        )

    def _active(self, words: ModalWords, now: SpindleNow) -> Moment:
        """Return what holds with the executed block; the spindle may turn since a program before."""
        moment = self._moment(words)
        if now.actual_rpm is None or not moment.senses:
            return moment
        cutting = words.g.get(Group.SPINDLE_MODE) in CUTTING
        return replace(
            moment,
            speeds_rpm={_SPINDLE: words.speed if cutting else now.programmed_rpm},
            senses={_SPINDLE: _ORIENTED if now.oriented else _SENSES[now.direction]},
        )

    def _machining_mode(self) -> int:
        mode = _SINGLE_BLOCK if self.run.switches.single_block else _AUTOMATIC
        if self.run.channel.seeking:
            return _SEARCH + mode
        return _PROGRAM_BLOCK if self._channels.mode(self._number) is Mode.PROGRAM_BLOCK else mode

    def programmed(self) -> ModalWords:
        """Return the words that were programmed last."""
        channel = self.run.channel
        return channel.records.words(self.run.program, channel.state.snapshot())

    def _moment(self, words: ModalWords) -> Moment:
        axes, placement = self._axes, words.placement
        own = axes.channels[self._number]
        pair = placement.plane
        if pair is None:
            letters = self._letters()
            code = _last_of((17, 18, 19), self.codes(words)) or 17
            pair = tuple(letters.get("XYZ"[each], each) for each in _PLANES[code])  # type: ignore[assignment]
        assert pair is not None
        scales = self.run.channel.state.modal.scale
        return (
            Moment(
                functions=frozenset(self.codes(words)),
                feed=words.feed,
                plane=(self._logical(pair[0]), self._logical(pair[1])),
                drilling_axes=(self._drilling(), self._drilling()),
                shifts_168=self._by_axis(placement.program, scales),
                shifts_268=self._by_axis(placement.additive, scales),
                axes={channel: tuple(numbers) for channel, numbers in axes.channels.items()},
                speeds_rpm={_SPINDLE: words.speed},
                senses={_SPINDLE: _ORIENTED if words.spindle_oriented else _SENSES[words.spindle_direction]},
            )
            if own
            else Moment()
        )

    def codes(self, words: ModalWords) -> set[int]:
        """Return the G codes in force, one of each group."""
        said = list(words.placement.codes)
        for group in _STATED:
            code = words.g.get(group, "G-").removeprefix("G")
            if code.isdigit() and not (group is Group.PLANE and words.placement.plane is not None):
                said.append(int(code))
        said += [int(name[1:]) for name in words.work if name[1:].isdigit()]
        if words.placement.plane is not None:
            said.append(20)
        found = {_GROUP_OF[code]: code for code in said if code in _GROUP_OF}
        for off in _OFF[: -1 if words.placement.offsets else None]:  # G260 and G360 are in no group of SD(1)
            found.setdefault(_GROUP_OF[off], off)
        return set(found.values())

    def _letters(self) -> dict[str, int]:
        names = list(self.run.channel.state.axis_names)
        return {letter: names.index(letter) for letter in "XYZ" if letter in names}

    def _logical(self, index: int) -> int:
        """Return the logical number of the machine's axis at a place, 0 if it is not of the channel."""
        own = self._axes.channels[self._number]
        number = self._axes.numbers[index] if index < len(self._axes.numbers) else 0
        return own.index(number) + 1 if number in own else 0

    def _drilling(self) -> int:
        return self._logical(self._letters().get("Z", len(self._axes.numbers)))

    def _by_axis(self, vector: tuple[float, ...], scales: Any) -> tuple[float, ...]:
        """Return a vector by logical axes 1 to 8, in the unit of the channel."""
        found = [0.0] * 8
        for place, number in enumerate(self._axes.channels[self._number][:8]):
            index = self._axes.index(number)
            found[place] = vector[index] / float(scales[index]) if vector else 0.0
        return tuple(found)

    # ------------------------------------------------------------------ COF, DPC, SCL, NCF

    def _shifts(self) -> ProgrammedShifts:
        axes, own = self._axes, self._axes.channels[self._number]
        state = self.run.channel.state
        placement = state.placement
        place = {axes.index(number): coordinate for coordinate, number in enumerate(own, 1)}
        by_place = {
            name: {place[index]: value for index, value in enumerate(vector) if index in place}
            for name, vector in (("contour", placement.contour), ("position", placement.position))
        }
        return ProgrammedShifts(
            coordinates=[axes.logical_name(self._number, number) for number in own],
            physical={number: coordinate for coordinate, number in enumerate(own, 1)},
            names={axes.physical_name(number): coordinate for coordinate, number in enumerate(own, 1)},
            rotary=frozenset(each for index, each in place.items() if state.modal.rotary[index]),
            inch=bool(self.programmed().inch),
            contour=by_place["contour"],
            position=by_place["position"],
            position_angle_deg=placement.position_deg,
            plane_angle_deg=placement.angle_deg,
            poles={place[index]: value for index, value in placement.poles.items() if index in place},
            factors={place[index]: value for index, value in placement.factors.items() if index in place},
        )

    def _last(self) -> LastFunctions:
        words = self.programmed()
        numbered = (*SD_GROUPS.values(), *_OTHER_GROUPS)
        groups = [_EXTERNAL, *(frozenset(f"G{code}" for code in group) for group in numbered)]
        groups += [frozenset(group) for group in _M_GROUPS]
        last = LastFunctions(groups)
        for code in (*words.placement.codes, *sorted(self.codes(words))):
            if any(code in group for group in numbered):
                last.program(f"G{code}")
        for name in words.placement.offsets[-1:]:
            last.program(name)
        for name in (
            "M19" if words.spindle_oriented else {1: "M3", -1: "M4", 0: "M5"}[words.spindle_direction],
            *(f"M{code}" for code in (*words.coolant, *words.m)),
        ):
            if any(name in group for group in _M_GROUPS):
                last.program(name)
        return last


class _Later:
    """What is made when it is first looked at: most of what SD can read is not asked for."""

    def __init__(self, make: Callable[[], Moment]) -> None:
        self._make = make

    def __getattr__(self, name: str) -> object:
        found = self.__dict__.setdefault("_made", None) or self._make()
        self.__dict__["_made"] = found
        return getattr(found, name)


def _later(make: Callable[[], Moment]) -> Moment:
    return cast(Moment, _Later(make))


def _last_of(group: tuple[int, ...], said: list[int] | set[int]) -> int | None:
    """Return the code of a group that was said last."""
    return next((code for code in reversed(list(said)) if code in group), None)
