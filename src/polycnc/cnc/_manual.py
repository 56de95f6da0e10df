"""Axes moved by hand: jog, increments, handwheel, reference search, and going to a position.

Every motion is a point-to-point profile of the kernel, planned anew when a key, a pulse or an override changes it, so
an axis keeps its speed and acceleration limits in every cycle. It comes to rest before a software limit; on a limit
switch everything brakes, and the axis can only leave it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum

import numpy as np
import numpy.typing as npt

from polycnc.cnc._alarms import AlarmList
from polycnc.cnc._reference_steps import Step, Until, reference_steps
from polycnc.cnc._refusal import ControlError, Refusal
from polycnc.errors import UsageError
from polycnc.kernel import (
    LIMIT_HIGH,
    LIMIT_LOW,
    MAIN,
    POINT_TO_POINT,
    REFERENCE,
    SHORT_OVERSHOOT,
    move_to,
    rest_position,
    stop_axis,
)
from polycnc.machine import AxisConfig, Machine, Reason

ANY_CYCLES = 1 << 40
_DOWN, _UP = -1, 1
_SIDE = {_DOWN: "low", _UP: "high"}


class ManualKind(StrEnum):
    """What moves an axis by hand."""

    NONE = "none"
    JOG = "jog"
    INCREMENT = "increment"
    HANDLE = "handle"
    REFERENCE = "reference"
    GO = "go"


@dataclass(frozen=True, slots=True)
class ManualData:
    """Say how a control moves axes by hand; speeds are shares of an axis' highest, or by axis in mm/s or deg/s.

    `soft_limits_unreferenced`: software limits hold before an axis is referenced. `search_again`: referencing a
    referenced axis searches its switch again, where otherwise it goes straight to its reference position.
    `soft_limit_alarm`: an axis that was told to go beyond a software limit puts an alarm on when it rests there.
    """

    jog_share: float = 0.2
    jog_speeds: Mapping[str, float] = field(default_factory=dict)
    reference_share: float = 0.25
    creep_share: float = 0.01
    search_margin: float = 10.0
    soft_limits_unreferenced: bool = False
    search_again: bool = False
    soft_limit_alarm: bool = True

    def __post_init__(self) -> None:
        for speed in (self.jog_share, self.reference_share, self.creep_share, *self.jog_speeds.values()):
            if not (math.isfinite(speed) and speed > 0.0):
                raise UsageError(f"a manual speed of {speed} moves nothing", hint="Give a speed above 0.")


@dataclass(frozen=True, slots=True)
class AxisMotion:
    """What an axis is doing by hand; `target` None is no end in `direction`.

    `stopping`: it brakes and then is done. `beyond`: it was told to go farther than the software limit at `target`.
    `home`: a reference search goes to the reference position. `braking`: a step of a search is over. `waiting`: what it
    did before has to come to rest first (see `ManualMotion._is_late`).
    """

    kind: ManualKind = ManualKind.NONE
    direction: int = 0
    target: float | None = None
    speed: float = 0.0
    rapid: bool = False
    stopping: bool = False
    beyond: bool = False
    steps: tuple[Step, ...] = ()
    step: int = 0
    braking: bool = False
    home: bool = False
    waiting: bool = False


_REST = AxisMotion()


@dataclass(frozen=True, slots=True)
class Handwheel:
    """The axis that the handwheel was turned for last, and the size of its pulses (mm or degree); "" before that."""

    axis: str = ""
    size: float = 0.0


@dataclass(frozen=True, slots=True)
class ManualState:
    """Everything that manual motion holds beside the kernel's arrays, to go back to."""

    motions: tuple[AxisMotion, ...]
    referenced: tuple[bool, ...]
    feed_overrides: tuple[float, ...]
    rapid_overrides: tuple[float, ...]
    wheel: Handwheel = Handwheel()


class ManualMotion:
    """Move the axes of a machine by hand; the machine's time passes elsewhere, in stretches that this limits.

    Before time passes ask `horizon` for the most cycles, let it stop for `REASONS`, and call `after` behind it.
    """

    REASONS = Reason.PROFILE_ENDED | Reason.SWITCH_EDGE

    def __init__(
        self, machine: Machine, alarms: AlarmList, data: ManualData | None = None, *, referenced: bool = True
    ) -> None:
        self._data = data or ManualData()
        self._clock = machine.clock
        self._machine = machine
        self._alarms = alarms
        self._axes: tuple[AxisConfig, ...] = machine.config.axes
        self.names = machine.config.axis_names
        """The names of the axes, by their place."""
        self.motions = [_REST] * len(self._axes)
        """What each axis is doing by hand, by its place."""
        self.references = [referenced] * len(self._axes)
        """Whether each axis is referenced, by its place."""
        self._feed_overrides = [1.0] * len(self._axes)
        self._rapid_overrides = [1.0] * len(self._axes)
        self.wheel = Handwheel()
        self.jog_speeds: list[float] = []
        """How fast a jog key moves each axis with its override (mm/s or deg/s), by its place."""
        self._note_speeds()

    @property
    def data(self) -> ManualData:
        """How axes are moved by hand."""
        return self._data

    @data.setter
    def data(self, data: ManualData) -> None:
        self._data = data
        self._note_speeds()

    # ------------------------------------------------------------------ what is known

    def _note_speeds(self) -> None:
        self._speeds = [self._jog_speed(i) for i in range(len(self._axes))]
        self._note_overrides()

    def _note_overrides(self) -> None:
        self.jog_speeds = [
            speed * share for speed, share in zip(self._speeds, self._feed_overrides, strict=True)
        ]
        self._clock.changes += 1

    @property
    def referenced(self) -> dict[str, bool]:
        """Which axes are referenced."""
        return dict(zip(self.names, self.references, strict=True))

    def motion(self, axis: str) -> AxisMotion:
        """Return what an axis is doing by hand."""
        return self.motions[self._index(axis)]

    @property
    def active(self) -> bool:
        """Whether an axis is moved by hand, or waits with its override at 0."""
        return any(motion is not _REST for motion in self.motions)

    def moves(self, axes: Iterable[str]) -> bool:
        """Tell whether one of these axes is moved by hand, or waits with its override at 0."""
        return any(self.motions[self._index(axis)] is not _REST for axis in axes)

    # ------------------------------------------------------------------ commands

    def change_axes(self, axes: tuple[AxisConfig, ...]) -> None:
        """Move axes with other speeds and limits from now on; nothing may be moving by hand."""
        self._axes = axes
        self._note_speeds()

    def set_overrides(
        self, *, feed: float | None = None, rapid: float | None = None, axes: Iterable[str] | None = None
    ) -> None:
        """Set the overrides of jogging (0 to 2) and of rapid jogging and reference searches (0 to 1).

        They are those of `axes`, None: of all.
        """
        for i in range(len(self._axes)) if axes is None else map(self._index, axes):
            before = self._feed_overrides[i], self._rapid_overrides[i]
            now = before[0] if feed is None else feed, before[1] if rapid is None else rapid
            self._feed_overrides[i], self._rapid_overrides[i] = now
            motion = self.motions[i]
            if now != before and motion is not _REST and not motion.stopping and not motion.braking:
                self._plan(i)
        self._note_overrides()

    def jog(self, axis: str, direction: int | None, *, rapid: bool = False) -> None:
        """Press the key of a direction (1 or -1), or let it go (0 or None); the axis then brakes to rest.

        Raises:
            ControlError: No such axis or direction, an axis at the end of its travel, or one that something else moves.
        """
        i = self._index(axis)
        if not direction:
            if self.motions[i].kind is ManualKind.JOG:
                self._stop(i)
            return
        self._check_direction(direction)
        self._check_free(i, ManualKind.JOG)
        self._check_way(i, direction)
        end = self._soft(i, direction)
        self._begin(
            i,
            AxisMotion(
                ManualKind.JOG,
                direction,
                end if math.isfinite(end) else None,
                self._axes[i].vmax if rapid else self._jog_speed(i),
                rapid,
                beyond=math.isfinite(end),
            ),
        )

    def increment(self, axis: str, direction: int, size: float, *, rapid: bool = False) -> None:
        """Go one increment (mm or degree) in a direction, or as far as the software limit.

        Raises:
            ControlError: No such axis or direction, a size that is not above zero, an axis that moves or stands at the
                end of its travel.
        """
        i = self._index(axis)
        self._check_direction(direction)
        self._check_size(size)
        self._check_free(i)
        self._check_way(i, direction)
        speed = self._axes[i].vmax if rapid else self._jog_speed(i)
        self._begin(
            i, self._towards(i, ManualKind.INCREMENT, self._position(i) + direction * size, speed, rapid)
        )

    def handwheel(self, axis: str, pulses: int, size: float) -> None:
        """Turn the handwheel by pulses of a size (mm or degree) each; the axis follows, within its limits.

        What leads beyond a software limit is lost.

        Raises:
            ControlError: No such axis, a size that is not above zero, an axis that something else moves or that stands
                at the end of its travel.
        """
        i = self._index(axis)
        self._check_size(size)
        self._check_free(i, ManualKind.HANDLE)
        if pulses == 0:
            return
        moving = self.motions[i]
        start = self._position(i) if moving.target is None or moving.stopping else moving.target
        target = start + pulses * size
        if not math.isfinite(target):
            raise ControlError(Refusal.DATA, f"{pulses} pulses are too many", hint="Turn the handwheel less.")
        self._check_way(i, _UP if pulses > 0 else _DOWN)
        self.wheel = Handwheel(axis, size)
        self._begin(i, self._towards(i, ManualKind.HANDLE, target, self._axes[i].vmax, rapid=False))

    def go_to(self, axis: str, target: float, *, rapid: bool = False) -> None:
        """Go to a position (mm or degree, machine coordinates) at jogging or rapid speed.

        Raises:
            ControlError: No such axis, a target outside the software limits, or an axis that moves.
        """
        i = self._index(axis)
        self._check_free(i)
        if not (math.isfinite(target) and self._soft(i, _DOWN) <= target <= self._soft(i, _UP)):
            raise ControlError(
                Refusal.TRAVEL,
                f"axis {axis} cannot go to {target:g} {self._axes[i].unit}",
                hint="Give a position within the software limits.",
            )
        if target != self._position(i):
            self._check_way(i, _UP if target > self._position(i) else _DOWN)
        speed = self._axes[i].vmax if rapid else self._jog_speed(i)
        self._begin(i, AxisMotion(ManualKind.GO, 0, target, speed, rapid))

    def reference(self, axis: str) -> None:
        """Reference an axis: find switch and index pulse and go to the reference position, or go there straight away.

        An axis without switch and index pulse, and one that is referenced (see `ManualData.search_again`), goes
        straight.

        Raises:
            ControlError: No such axis, or one that moves.
        """
        i = self._index(axis)
        self._check_free(i)
        config = self._axes[i]
        steps: tuple[Step, ...] = ()
        if not self.references[i] or self.data.search_again:
            steps = reference_steps(config, self._position(i), self._on(i, REFERENCE))
            self.references[i] = False
        self.motions[i] = AxisMotion(ManualKind.REFERENCE, steps=steps)
        self._clock.changes += 1
        if steps:
            self._begin_step(i, 0)
        else:
            self._go_home(i)

    def stop(self, axis: str) -> None:
        """Brake an axis to rest and end what it was doing by hand.

        Raises:
            ControlError: There is no such axis.
        """
        self._stop(self._index(axis))

    def stop_all(self, axes: Iterable[str] | None = None) -> None:
        """Brake these axes (None: all) to rest and end what they were doing by hand."""
        for i in range(len(self.motions)) if axes is None else map(self._index, axes):
            self._stop(i)

    # ------------------------------------------------------------------ time

    def horizon(self) -> int:
        """Return how many cycles may pass at most until `after` has to look: one while an index pulse is searched."""
        for motion in self.motions:
            searching = motion.kind is ManualKind.REFERENCE and not (
                motion.home or motion.braking or motion.stopping
            )
            if searching and motion.steps[motion.step].until is Until.INDEX:
                return 1
        return ANY_CYCLES

    def after(self) -> None:
        """Look at what the last cycle has brought: ends of profiles, switches, pulses; and go on from there."""
        edges: npt.NDArray[np.uint8] = self._machine.state.switches.rising[:, (LIMIT_LOW, LIMIT_HIGH)]
        if edges.any():
            self.check_limit_switches()
            owners = [self._alarms.owner(axis.name) for axis in self._axes]
            stopped = {owner for owner, edge in zip(owners, edges, strict=True) if edge.any()}
            for i, owner in enumerate(owners):
                if owner in stopped:
                    self._stop(i)
        for i, motion in enumerate(self.motions):
            if motion is _REST:
                continue
            at_rest = not self._machine.state.ptp.row[MAIN, i]["active"]
            if motion.stopping:
                if at_rest:
                    self.motions[i] = _REST
            elif motion.waiting:
                if at_rest:
                    self._plan(i)
            elif motion.kind is ManualKind.REFERENCE and not motion.home:
                self._search(i, motion, at_rest)
            elif at_rest and self._speed(i, motion) > 0.0:
                self._arrive(i, motion)

    def snapshot(self) -> ManualState:
        """Return everything beside the kernel's arrays, to go back to."""
        return ManualState(
            tuple(self.motions),
            tuple(self.references),
            tuple(self._feed_overrides),
            tuple(self._rapid_overrides),
            self.wheel,
        )

    def restore(self, state: ManualState) -> None:
        """Go back to a snapshot; the kernel's arrays are the machine's to restore."""
        self.motions = [_REST if motion == _REST else motion for motion in state.motions]
        self.references = list(state.referenced)
        self._feed_overrides = list(state.feed_overrides)
        self._rapid_overrides = list(state.rapid_overrides)
        self.wheel = state.wheel
        self._note_speeds()

    # ------------------------------------------------------------------ planning

    def _index(self, axis: str) -> int:
        if axis not in self.names:
            raise ControlError(
                Refusal.DATA, f"there is no axis '{axis}'", hint=f"The axes are {', '.join(self.names)}."
            )
        return self.names.index(axis)

    def _position(self, i: int) -> float:
        return float(self._machine.state.base[i])

    def _jog_speed(self, i: int) -> float:
        axis = self._axes[i]
        return min(self.data.jog_speeds.get(axis.name, axis.vmax * self.data.jog_share), axis.vmax)

    def _soft(self, i: int, direction: int) -> float:
        """Return the software limit of a side, infinite where none holds."""
        if not (self.references[i] or self.data.soft_limits_unreferenced):
            return direction * math.inf
        low, high = self._axes[i].soft_limits
        return low if direction == _DOWN else high

    def _towards(self, i: int, kind: ManualKind, target: float, speed: float, rapid: bool) -> AxisMotion:
        """Return a motion to a target, or to the software limit before it."""
        direction = _UP if target > self._position(i) else _DOWN
        end = self._soft(i, direction)
        beyond = (target - end) * direction > 0.0
        return AxisMotion(kind, direction, end if beyond else target, speed, rapid, beyond=beyond)

    def _speed(self, i: int, motion: AxisMotion) -> float:
        """Return the speed of an axis' motion with its override."""
        if motion.kind is ManualKind.HANDLE:
            return motion.speed
        if motion.kind is ManualKind.REFERENCE:
            fast = motion.home or motion.steps[motion.step].fast
            return motion.speed * (self._rapid_overrides[i] if fast else 1.0)
        return motion.speed * (self._rapid_overrides[i] if motion.rapid else self._feed_overrides[i])

    def _begin(self, i: int, motion: AxisMotion) -> None:
        self.motions[i] = motion
        self._clock.changes += 1
        self._plan(i)

    def _plan(self, i: int) -> None:
        """Plan the profile of an axis from where and how fast it is now."""
        motion, axis, state = self.motions[i], self._axes[i], self._machine.state
        speed = min(self._speed(i, motion), axis.vmax)
        if speed <= 0.0:
            self._brake(i)
            return
        waiting = self._is_late(i)
        if waiting is not motion.waiting:
            self.motions[i] = replace(motion, waiting=waiting)
        if waiting:
            return
        jerkrel = self._machine.config.path.jerkrel
        rate = axis.amax / (1.0 + jerkrel)
        target, then = motion.target, 0.0
        if target is None:
            then = motion.direction * speed
            velocity = float(state.ptp.row[MAIN, i]["velocity"])
            target = self._position(i) + _ramp_distance(velocity, then, rate)
        move_to(state.ptp, MAIN, i, target, then, speed, rate, rate, jerkrel, SHORT_OVERSHOOT)

    def _is_late(self, i: int) -> bool:
        """Tell whether an axis that comes to rest at its software limit would pass it with another profile.

        Every profile begins without acceleration, so a ramp that is under way already ends sooner than a new one.
        """
        axis, state = self._axes[i], self._machine.state
        velocity = float(state.ptp.row[MAIN, i]["velocity"])
        direction = _UP if velocity > 0.0 else _DOWN
        end = self._soft(i, direction)
        rate = axis.amax / (1.0 + self._machine.config.path.jerkrel)
        rest = self._position(i) + _ramp_distance(velocity, 0.0, rate)
        return (rest - end) * direction > 0.0 and (rest_position(state.ptp, MAIN, i) - end) * direction <= 0.0

    def _brake(self, i: int) -> None:
        if self._is_late(i):
            return
        jerkrel = self._machine.config.path.jerkrel
        rate = self._axes[i].amax / (1.0 + jerkrel)
        stop_axis(self._machine.state.ptp, MAIN, i, rate, jerkrel)

    def _stop(self, i: int) -> None:
        motion = self.motions[i]
        if motion is _REST or motion.stopping:
            return
        self._machine.state.switches.marks[i]["index_armed"] = 0
        self._clock.changes += 1
        self.motions[i] = replace(motion, stopping=True, beyond=False)
        if not motion.braking:
            self._brake(i)

    # ------------------------------------------------------------------ ends and limits

    def _arrive(self, i: int, motion: AxisMotion) -> None:
        self.motions[i] = _REST
        self._clock.changes += 1
        if motion.kind is ManualKind.REFERENCE:
            self.references[i] = True
        elif motion.beyond and self.data.soft_limit_alarm:
            self._alarms.put(f"soft_limit_{_SIDE[motion.direction]}", axis=self._axes[i].name)

    def check_limit_switches(self) -> bool:
        """Put an alarm on for every limit switch that is on; return whether there is one."""
        found = False
        for axis in self._axes:
            for side in (_DOWN, _UP):
                if self.blocked(axis.name, side):
                    self._alarms.put(f"limit_switch_{_SIDE[side]}", axis=axis.name)
                    found = True
        return found

    def blocked(self, axis: str, direction: int) -> bool:
        """Tell whether a limit switch keeps an axis from moving in a direction."""
        i = self._index(axis)
        return self._on(i, LIMIT_LOW if direction == _DOWN else LIMIT_HIGH)

    def _on(self, i: int, which: int) -> bool:
        """Tell whether a switch is on, before the first cycle as well."""
        switch = self._machine.state.switches.switch[i][which]
        return bool(switch["on_from"] <= self._machine.state.servo.actual[i] <= switch["on_to"])

    def _check_way(self, i: int, direction: int) -> None:
        axis = self._axes[i]
        if self.blocked(axis.name, direction):
            raise ControlError(
                Refusal.TRAVEL,
                f"axis {axis.name} is on a limit switch",
                hint="Move it off in the other direction.",
            )
        if (self._soft(i, direction) - self._position(i)) * direction <= 0.0:
            raise ControlError(
                Refusal.TRAVEL,
                f"axis {axis.name} is at its software limit",
                hint="Move it in the other direction.",
            )

    def _check_free(self, i: int, same: ManualKind = ManualKind.NONE) -> None:
        """Refuse an axis that something else than `same` is moving."""
        axis = self._axes[i].name
        if self._machine.state.owner[i] != POINT_TO_POINT:
            raise ControlError(
                Refusal.RUNNING, f"a program moves axis {axis}", hint="Wait for its end, or reset it."
            )
        kind = self.motions[i].kind
        if kind is not ManualKind.NONE and kind is not same:
            raise ControlError(
                Refusal.RUNNING, f"axis {axis} is moving ({kind})", hint="Wait until it stands."
            )

    def _check_direction(self, direction: int) -> None:
        if direction not in (_DOWN, _UP):
            raise ControlError(Refusal.DATA, f"{direction} is no direction", hint="Give 1 or -1.")

    def _check_size(self, size: float) -> None:
        if not (math.isfinite(size) and size > 0.0):
            raise ControlError(
                Refusal.DATA, f"an increment of {size} is none", hint="Give a size above 0, in mm or degree."
            )

    # ------------------------------------------------------------------ reference search

    def _begin_step(self, i: int, step: int) -> None:
        motion, axis = self.motions[i], self._axes[i]
        what = motion.steps[step]
        marks = self._machine.state.switches.marks[i]
        marks["index_latched"] = 0
        marks["index_armed"] = 1 if what.until is Until.INDEX else 0
        share = self.data.reference_share if what.fast else self.data.creep_share
        self._begin(
            i,
            replace(
                motion,
                direction=what.direction,
                target=self._search_end(i, what.direction),
                speed=axis.vmax * share,
                step=step,
                braking=False,
            ),
        )

    def _search_end(self, i: int, direction: int) -> float:
        """Return where a search gives up: at the limit switch, or well behind everything there is to find."""
        axis = self._axes[i]
        switch = axis.limit_switches[0 if direction == _DOWN else 1]
        if math.isfinite(switch):
            return switch
        low, high = axis.soft_limits
        marks = (low, high, axis.reference_switch, axis.index_pulse, axis.home, self._position(i))
        known = [mark for mark in marks if mark is not None and math.isfinite(mark)]
        return (min(known) if direction == _DOWN else max(known)) + direction * self.data.search_margin

    def _search(self, i: int, motion: AxisMotion, at_rest: bool) -> None:
        if motion.braking:
            if not at_rest:
                return
            if motion.step + 1 < len(motion.steps):
                self._begin_step(i, motion.step + 1)
            else:
                self._go_home(i)
        elif self._found(i, motion.steps[motion.step].until):
            self.motions[i] = replace(motion, braking=True)
            self._brake(i)
        elif at_rest and self._speed(i, motion) > 0.0:
            self._stop(i)
            self._alarms.put(
                "reference_not_found", axis=self._axes[i].name, detail=motion.steps[motion.step].until.value
            )

    def _found(self, i: int, until: Until) -> bool:
        if until is Until.INDEX:
            return bool(self._machine.state.switches.marks[i]["index_latched"])
        return self._on(i, REFERENCE) == (until is Until.ON)

    def _go_home(self, i: int) -> None:
        axis = self._axes[i]
        self._begin(
            i,
            replace(
                self.motions[i],
                home=True,
                braking=False,
                target=axis.home,
                speed=axis.vmax * self.data.reference_share,
            ),
        )


def _ramp_distance(first: float, last: float, rate: float) -> float:
    """Return the way while the velocity goes from `first` to `last`."""
    if first * last < 0.0:
        return 0.5 * (first * abs(first) + last * abs(last)) / rate
    return 0.5 * (first + last) * (abs(last - first) / rate)
