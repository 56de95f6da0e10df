"""What a control shows across the NCS coupling, read from its runs (Manual 003, 4.14.2)."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Protocol

import numpy as np

from polycnc.cnc import AxisStatus, ProgramRun, RunState
from polycnc.controllers.bosch._axes import SystemAxes
from polycnc.controllers.bosch._channel_ports import CUTTING, ChannelPorts, SpindleNow
from polycnc.controllers.bosch._positions import executed_words, workpiece
from polycnc.controllers.bosch.ncs import (
    Axis,
    Channel,
    Coordinate,
    Drive,
    Image,
    Ipo,
    Sav,
    Spindle,
    SpindleMotion,
    Unit,
    Wait,
)
from polycnc.controllers.bosch.system import (
    TOOL_KIND,
    TOOL_LENGTH,
    TOOL_RADIUS,
    ToolCompensations,
    ZeroShifts,
)
from polycnc.kernel import RAPID, RUNNING, WAIT
from polycnc.machine import Machine
from polycnc.nc import Group, ModalWords

_INTERFACE_CHANNELS = 5
_GROUPS = (range(54, 60), range(154, 160), range(254, 260))
_FULL = 10000.0
_NO_RADIUS = "G40"
_GENERAL_TOOL = {"length_3": 1, "radius": 2, "length_1": 3, "length_2": 4, "orientation": 5}
_SAV = {
    RunState.ACTIVE: Sav.ACTIVE, RunState.HOLD: Sav.ACTIVE, RunState.STOPPED_AT_BLOCK: Sav.READY,
    RunState.PROGRAM_STOP: Sav.READY, RunState.OPTIONAL_STOP: Sav.READY, RunState.ALARM: Sav.ERROR,
}  # fmt: skip
_WAITS = {
    RunState.PROGRAM_STOP: Wait.PROGRAM_STOP, RunState.OPTIONAL_STOP: Wait.PROGRAM_STOP, RunState.HOLD: Wait.FEED_HOLD,
}  # fmt: skip
_MOTIONS = {1: SpindleMotion.CLOCKWISE, -1: SpindleMotion.COUNTER_CLOCKWISE, 0: SpindleMotion.STOP}
_WET = {**_MOTIONS, 1: SpindleMotion.CLOCKWISE_COOLANT, -1: SpindleMotion.COUNTER_CLOCKWISE_COOLANT}


class Programs(Protocol):
    """What a channel's programs wait for."""

    @property
    def waits(self) -> bool:
        """Whether a WAIT for a signal or a time is under way."""

    @property
    def is_buffered(self) -> bool:
        """Whether blocks can be put after those under way."""

    @property
    def buffer_is_empty(self) -> bool:
        """Whether all blocks that were buffered have been taken, and more may come."""


class _Axes(dict[int, Axis]):
    """Axes, each read when somebody asks for it first."""

    def __init__(self, numbers: Iterable[int], read: Callable[[int], Axis]) -> None:
        super().__init__((number, Axis(number, "")) for number in numbers)
        self._read = read
        self._old = set(self)

    def renew(self) -> None:
        """Let each be read anew."""
        self._old = set(self)

    def __getitem__(self, number: int) -> Axis:
        if number in self._old:
            self._old.discard(number)
            self[number] = self._read(number)
        return super().__getitem__(number)

    def get(self, number: int, default: Any = None) -> Any:
        if number not in self:
            return default
        return self[number]

    def values(self) -> Any:
        return [self[number] for number in self]


class _Coordinates(Sequence[Coordinate]):
    """The coordinates of a channel, read when somebody asks for one first."""

    def __init__(self, read: Callable[[], list[Coordinate]]) -> None:
        self._read = read
        self._found: list[Coordinate] | None = None

    @property
    def _all(self) -> list[Coordinate]:
        if self._found is None:
            self._found = self._read()
        return self._found

    def __getitem__(self, place: Any) -> Any:
        return self._all[place]

    def __len__(self) -> int:
        return len(self._all)


class Shown:
    """Keep an image up to date: `renew` reads channels and the spindle at the present cycle.

    Axes and coordinates are read in that cycle too, where somebody asks for them.
    """

    def __init__(
        self,
        axes: SystemAxes,
        channels: ChannelPorts,
        tables: Callable[[], tuple[ZeroShifts, ToolCompensations]],
        programs: Mapping[int, Programs],
    ) -> None:
        self._programs = programs
        self._axes = axes
        self._channels = channels
        self._tables = tables
        self._tags: dict[int, tuple[int, bool]] = {}
        self._unmoved = (0.0,) * len(axes.names)
        self._now: Mapping[str, AxisStatus] | None = None
        self._blocks: dict[int, tuple[ModalWords, list[float]]] = {}
        self._openings: dict[int, tuple[ProgramRun, object, ModalWords]] = {}
        self._read = _Axes(axes.numbers, self._axis_now)
        self.image = Image(axes=self._read, channels={number: Channel(number) for number in axes.channels})

    def forget(self) -> None:
        """Forget which blocks were seen: the control has gone back to a snapshot."""
        self._tags.clear()
        self._openings.clear()

    def renew(self) -> Image:
        """Read everything at the present cycle."""
        image, machine = self.image, self._channels.machine
        image.cycle = machine.clock.cycles
        image.drives, image.all_channels = len(self._axes.numbers), len(image.channels)
        image.interface_channels = _INTERFACE_CHANNELS
        self._read.renew()
        self._now = None
        self._blocks.clear()
        for number, shown in image.channels.items():
            self._channel(shown, number)
        image.spindles[1] = self._spindle(machine)
        image.test_mode = any(self._channels.switches(number).machine_lock for number in image.channels)
        return image

    def _axis_now(self, number: int) -> Axis:
        if self._now is None:
            self._now = self._channels.axes()
        index = self._axes.index(number)
        return self._axis(self._channels.machine, index, number, self._now[self._axes.names[index]])

    def _axis(self, machine: Machine, index: int, number: int, now: AxisStatus) -> Axis:
        axes, config = self._axes, machine.config.axes[index]
        channel = axes.channel_of(number)
        default = next((each for each, own in axes.defaults.items() if number in own), None)
        name, setpoint, actual = now.name, now.setpoint, now.actual
        shown = Axis(
            number, name, "linear" if config.unit == "mm" else "rotary", channel, default,
            setpoint=setpoint, actual=actual, machine_coordinate=setpoint,
            lag=now.following_error, travel=now.velocity != 0.0, referenced=now.referenced,
            jog_speed=now.jog_speed * 60.0 if now.unit == "mm" else now.jog_speed / 6.0,
            potentiometer=now.feed_override * _FULL,
            drive=Drive("polycnc", "simulated", f"simulated {config.kind}", _telegram(actual, now.velocity)),
        )  # fmt: skip
        window = config.servo.in_position
        shown.in_window = abs(setpoint - actual) <= window
        run = None if channel is None else self._channels.run(channel)
        if channel is not None and channel in axes.channels:
            shown.logical_name = axes.logical.get((channel, number), "")
            shown.mode = self._channels.mode(channel)
        if run is None:
            shown.axis_coordinate = setpoint
            return shown
        assert channel is not None
        words, ends = self._block(run, channel)
        shifts, _ = self._tables()
        works = [
            sum(shifts.shift_mm(code).get(name, 0.0) for code in group if f"G{code}" in words.work)
            for group in _GROUPS
        ]
        shown.shifts = (works[0], works[1], works[2])
        shown.external_shift = sum(
            shifts.shift_mm(int(code[1:])).get(name, 0.0) for code in words.placement.offsets
        )
        shown.preset = -(words.shifts.preset or self._unmoved)[index]
        shown.axis_coordinate = setpoint - shown.shift
        shown.end = ends[index] - shown.shift
        return shown

    def _block(self, run: ProgramRun, number: int) -> tuple[ModalWords, list[float]]:
        """Return words and end of the executed block of a channel, found once in a cycle."""
        if number not in self._blocks:
            self._blocks[number] = self._words(run, number), self._ends(run)
        return self._blocks[number]

    def _words(self, run: ProgramRun, number: int) -> ModalWords:
        """Return the modal words of the executed block; after a reset those of the power-up condition."""
        if not _is_reset(run):
            return executed_words(run)
        kept = self._openings.get(number)
        if kept is None or kept[0] is not run or kept[1] is not run.channel:
            kept = self._openings[number] = run, run.channel, run.selection.opening_words()
        return kept[2]

    def _ends(self, run: ProgramRun) -> list[float]:
        """Return where the executed block ends (machine coordinates)."""
        to_go = list(run.reading.distance_to_go.values())
        return [each + left for each, left in zip(run.reading.position.values(), to_go, strict=True)]

    def _channel(self, shown: Channel, number: int) -> None:
        run = self._channels.run(number)
        shown.mode = self._channels.mode(number)
        self._select(shown, number)
        shown.reselection = self._channels.reselects()
        shown.auxiliary_waits = self._channels.functions_wait(number)
        shown.potentiometer = self._channels.overrides(number).feed * _FULL
        switches = self._channels.switches(number)
        shown.optional_stop = (switches.optional_stop, switches.optional_stop)
        shown.skip = (bool(switches.block_delete), bool(switches.block_delete))
        shifts, tools = self._tables()
        shown.tool_table, shown.shift_table = tools.selected, shifts.active
        failed = self._channels.needs_reset(number)
        if failed:
            shown.sav = Sav.ERROR
        if run is None:
            shown.coordinates = _Coordinates(lambda: self._at_rest(number))
            return
        row = run.machine.state.paths.row[run.path]
        words, _ = self._block(run, number)
        executed = run.reading.tag, _is_reset(run)
        if self._tags.get(number) != executed:
            self._tags[number] = executed
            shown.blocks += 1
        self._state(shown, run, number, failed=failed)
        running = row["state"] == RUNNING
        shown.ipo = (
            Ipo.RUNNING if run.state is RunState.ACTIVE else Ipo.RUNNING_DOWN if running else Ipo.STOPPED
        )
        shown.inch = words.inch
        shown.message = run.channel.messages.latest(int(row["head"]))
        segment = run.machine.state.seg.row[int(row["base"]) + int(row["head"]) % int(row["capacity"])]
        shown.dwell = bool(running and segment["kind"] == WAIT)
        moving = bool(running and not shown.dwell)
        shown.feeds = _feeds(segment, row, run.overrides.feed) if moving else (0.0, 0.0, 0.0)
        shown.programmed_feed = words.feed * (25.4 if words.inch else 1.0)
        self._tool(shown, words)
        reason = Wait(0) if failed else _WAITS.get(run.state, Wait(0))
        shown.other_waits = (shown.other_waits & Wait.DATA_SERVICE) | reason
        if self._waits(number):
            shown.other_waits |= Wait.SIGNAL_OR_TIME
        if shown.sav is Sav.ACTIVE and not running and self._buffer_empty(number):
            shown.sav = Sav.BUFFER_EMPTY
        shown.coordinates = _Coordinates(lambda: self._coordinates(run, number))

    def _select(self, shown: Channel, number: int) -> None:
        """Show what is selected."""
        selected, missing = self._channels.selected(number), self._channels.missing(number)
        shown.program = missing if selected is None else selected.program
        if selected is None:
            shown.sav = Sav.ERROR if missing else Sav.INACTIVE
        else:
            shown.sav = Sav.READY if selected.searched else Sav.AT_START

    def _state(self, shown: Channel, run: ProgramRun, number: int, *, failed: bool) -> None:
        """Show what is executed."""
        if run.state in _SAV:
            shown.sav = Sav.ERROR if failed else _SAV[run.state]
            shown.program = "" if self._channels.is_by_hand(number) else run.program.name
        elif run.state is RunState.RESET and not run.at_rest:
            shown.sav = Sav.RESET

    def _waits(self, number: int) -> bool:
        programs = self._programs.get(number)
        return programs is not None and programs.waits

    def _buffer_empty(self, number: int) -> bool:
        programs = self._programs.get(number)
        return programs is not None and programs.buffer_is_empty

    def _tool(self, shown: Channel, words: ModalWords) -> None:
        """Show the compensations of the executed block."""
        _, tools = self._tables()
        values, codes = tools.values, words.placement.compensations
        cutting = words.g.get(Group.RADIUS_COMPENSATION, _NO_RADIUS) != _NO_RADIUS
        shown.length_number = words.h or -1
        shown.radius_number = words.d or 0 if cutting else -1
        added = [
            sum(values.get((code, place), 0.0) for code in codes) for place in (TOOL_LENGTH, TOOL_RADIUS)
        ]
        shown.length = (_group(tools, words.h)[0] + added[0]) if words.h else 0.0
        shown.radius = (_group(tools, shown.radius_number)[1] + added[1]) if cutting else 0.0
        external = [code for code in codes if code % 100 == 45]
        shown.external_tool = (
            sum(values.get((code, TOOL_RADIUS), 0.0) for code in external),
            sum(values.get((code, TOOL_LENGTH), 0.0) for code in external),
        )
        general = next((code for code in codes if code % 100 != 45), 0)
        for name, place in _GENERAL_TOOL.items():
            setattr(shown.tool, name, values.get((general, place), 0.0))
        shown.tool.kind = int(values.get((general, TOOL_KIND), 0.0))

    def _at_rest(self, number: int) -> list[Coordinate]:
        """Return the coordinates of a channel that has executed nothing yet: those of its axes."""
        found = []
        for each in self._axes.channels[number]:
            axis, name = self.image.axes[each], self._axes.logical_name(number, each)
            unit = Unit.METRIC if axis.kind == "linear" else Unit.DEGREE
            at = axis.setpoint
            found.append(Coordinate(name, (each,), False, unit, at, at, axis.actual, at, at))
        return found

    def _coordinates(self, run: ProgramRun, number: int) -> list[Coordinate]:
        axes, state = self._axes, run.machine.state
        words, ends = self._block(run, number)
        now = workpiece(words, state.setpoint)
        end_at = workpiece(words, np.array(ends))
        to_go = list(run.reading.distance_to_go.values())
        config = run.machine.config.axes
        found = []
        for each in axes.channels[number]:
            index = axes.index(each)
            unit = Unit.DEGREE if config[index].unit == "deg" else Unit.METRIC
            if unit is Unit.METRIC and self.image.channels[number].inch:
                unit = Unit.INCH
            setpoint = float(state.setpoint[index])
            found.append(
                Coordinate(
                    axes.logical_name(number, each), (each,), False, unit, now[index],
                    setpoint - self.image.axes[each].shift, self.image.axes[each].actual - self.image.axes[each].shift,
                    end_at[index], ends[index], to_go[index],
                )
            )  # fmt: skip
        return found

    def _spindle(self, machine: Machine) -> Spindle:
        number = next((each for each in self.image.channels if self._channels.run(each) is not None), None)
        run = None if number is None else self._channels.run(number)
        words = None if run is None or number is None else self._block(run, number)[0]
        now, top = self._channels.spindle(), machine.config.spindle.max_rpm
        if now.actual_rpm is None and words is not None:
            turning = words.speed if words.spindle_direction else 0.0
            now = SpindleNow(
                now.override, turning, words.speed, words.spindle_direction, words.spindle_oriented
            )
        cutting = words is not None and words.g.get(Group.SPINDLE_MODE) in CUTTING
        speed = words.speed if words is not None and cutting else now.programmed_rpm
        return Spindle(
            programmed=speed, actual=now.actual_rpm or 0.0, potentiometer=now.override * _FULL,
            limits=(0.0, top), gear_limits=(0.0, top),
            motion=_motion(now, words is not None and bool(words.coolant)),
            cutting_m_min=(speed if now.direction else 0.0) if cutting else None,
        )  # fmt: skip


def _is_reset(run: ProgramRun) -> bool:
    """Whether the power-up condition holds again, after a reset."""
    return run.state is RunState.RESET and run.at_rest


def _motion(now: SpindleNow, wet: bool) -> SpindleMotion:
    if now.oriented:
        return SpindleMotion.ORIENTATION
    return (_WET if wet else _MOTIONS)[now.direction]


def _feeds(segment: np.void, path: np.void, override: float) -> tuple[float, float, float]:
    """Return the feed that is asked for with the override, the present one, and what the axes allow of the first."""
    allowed = float(segment["cap"])
    asked = allowed if segment["flags"] & RAPID else float(segment["feed_mm_s"]) * override
    return asked * 60.0, float(path["speed"]) * 60.0, allowed * 60.0


def _telegram(actual: float, velocity: float) -> dict[int, int]:
    """Return what is in the cyclic telegram: S-0-0040 and S-0-0051, in 0.0001 mm or degree, and per minute."""
    return {51: round(actual * 10_000), 40: round(velocity * 60)}


def _group(tools: ToolCompensations, group: int) -> tuple[float, float]:
    """Return length and radius of a group, 0 if nothing is in it."""
    try:
        return tools.group_mm(group)
    except KeyError:
        return 0.0, 0.0
