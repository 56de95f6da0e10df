"""Axes moved by hand: jog, increments, handwheel, reference search, and going to a position.

Every motion is a point-to-point profile of the kernel, planned anew when a key, a pulse or an override changes it, so
an axis keeps its speed and acceleration limits in every cycle. It comes to rest before a software limit; on a limit
switch everything brakes, and the axis can only leave it.
"""

from __future__ import annotations

from collections.abc import Iterable

from polycnc.cnc._alarms import AlarmList
from polycnc.cnc._manual_data import REST, AxisMotion, Handwheel, ManualData, ManualKind, ManualState
from polycnc.cnc._manual_profiles import DOWN, UP, ManualProfiles
from polycnc.cnc._reference_search import ReferenceSearch
from polycnc.cnc._reference_steps import Step, Until, reference_steps
from polycnc.cnc._refusal import ControlError, Refusal
from polycnc.errors import shown
from polycnc.kernel import LIMIT_HIGH, LIMIT_LOW, MAIN, POINT_TO_POINT, REFERENCE
from polycnc.machine import AxisConfig, Machine, Reason
from polycnc.units import is_finite

ANY_CYCLES = 1 << 40
_SIDE = {DOWN: "low", UP: "high"}


class ManualMotion:
    """Move the axes of a machine by hand; the machine's time passes elsewhere, in stretches that this limits.

    Before time passes ask `horizon` for the most cycles, let it stop for `REASONS`, and call `after` after it.
    """

    REASONS = Reason.PROFILE_ENDED | Reason.SWITCH_EDGE

    def __init__(
        self, machine: Machine, alarms: AlarmList, data: ManualData | None = None, *, referenced: bool = True
    ) -> None:
        self.names = machine.config.axis_names
        """The names of the axes, by their place."""
        self.wheel = Handwheel()
        self._clock = machine.clock
        self._machine = machine
        self._alarms = alarms
        self._profiles = ManualProfiles(machine, data or ManualData(), referenced=referenced)
        self._references = ReferenceSearch(machine, self._profiles, alarms)
        self.motions = self._profiles.motions
        """What each axis is doing by hand, by its place."""
        self.references = self._profiles.references
        """Whether each axis is referenced, by its place."""
        self.jog_speeds = self._profiles.jog_speeds
        """How fast a jog key moves each axis with its override (mm/s or deg/s), by its place."""
        self.feed_overrides = self._profiles.feed_overrides
        """The feed override that acts on each axis moved by hand (1 is 100 %), by its place."""

    @property
    def data(self) -> ManualData:
        """How axes are moved by hand."""
        return self._profiles.data

    @data.setter
    def data(self, data: ManualData) -> None:
        self._profiles.data = data
        self._profiles.note_speeds()

    # ------------------------------------------------------------------ what is known

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
        return any(motion is not REST for motion in self.motions)

    def moves(self, axes: Iterable[str]) -> bool:
        """Tell whether one of these axes is moved by hand, or waits with its override at 0."""
        return any(self.motions[self._index(axis)] is not REST for axis in axes)

    # ------------------------------------------------------------------ commands

    def change_axes(self, axes: tuple[AxisConfig, ...]) -> None:
        """Move axes with other speeds and limits from now on; nothing may be moving by hand."""
        self._profiles.axes = axes
        self._profiles.note_speeds()

    def set_overrides(
        self, *, feed: float | None = None, rapid: float | None = None, axes: Iterable[str] | None = None
    ) -> None:
        """Set the overrides of jogging (0 to 2) and of rapid jogging and reference searches (0 to 1).

        They are those of `axes`, None: of all.
        """
        for i in range(len(self._profiles.axes)) if axes is None else map(self._index, axes):
            before = self._profiles.feed_overrides[i], self._profiles.rapid_overrides[i]
            now = before[0] if feed is None else feed, before[1] if rapid is None else rapid
            self._profiles.feed_overrides[i], self._profiles.rapid_overrides[i] = now
            motion = self.motions[i]
            if now != before and motion is not REST and not motion.stopping and not motion.braking:
                self._profiles.plan(i)
        self._profiles.note_overrides()

    def jog(self, axis: str, direction: int | None, *, rapid: bool = False) -> None:
        """Press the key of a direction (1 or -1), or let it go (0 or None); the axis then brakes to rest.

        Raises:
            ControlError: No such axis or direction, an axis at the end of its travel, or one that something else moves.
        """
        i = self._index(axis)
        if not direction:
            if self.motions[i].kind is ManualKind.JOG:
                self._profiles.stop(i)
            return
        check_direction(direction)
        check_free(self._machine, self._profiles, i, ManualKind.JOG)
        check_way(self._profiles, i, direction)
        end = self._profiles.soft(i, direction)
        self._profiles.begin(
            i,
            AxisMotion(
                ManualKind.JOG,
                direction,
                end if is_finite(end) else None,
                self._profiles.axes[i].vmax if rapid else self._profiles.jog_speed(i),
                rapid,
                beyond=is_finite(end),
            ),
        )

    def increment(self, axis: str, direction: int, size: float, *, rapid: bool = False) -> None:
        """Go one increment (mm or degree) in a direction, or as far as the software limit.

        Raises:
            ControlError: No such axis or direction, a size that is not above zero, an axis that moves or stands at the
                end of its travel.
        """
        i = self._index(axis)
        check_direction(direction)
        check_size(size)
        check_free(self._machine, self._profiles, i)
        check_way(self._profiles, i, direction)
        speed = self._profiles.axes[i].vmax if rapid else self._profiles.jog_speed(i)
        self._profiles.begin(
            i,
            self._profiles.towards(
                i, ManualKind.INCREMENT, self._profiles.position(i) + direction * size, speed, rapid
            ),
        )

    def handwheel(self, axis: str, pulses: int, size: float) -> None:
        """Turn the handwheel by pulses of a size (mm or degree) each; the axis follows, within its limits.

        What leads beyond a software limit is lost.

        Raises:
            ControlError: No such axis, a size that is not above zero, an axis that something else moves or that stands
                at the end of its travel.
        """
        i = self._index(axis)
        check_size(size)
        check_free(self._machine, self._profiles, i, ManualKind.HANDLE)
        if pulses == 0:
            return
        moving = self.motions[i]
        start = self._profiles.position(i) if moving.target is None or moving.stopping else moving.target
        target = start + pulses * size
        if not is_finite(target):
            raise ControlError(Refusal.DATA, f"{pulses} pulses are too many", hint="Turn the handwheel less.")
        check_way(self._profiles, i, UP if pulses > 0 else DOWN)
        self.wheel = Handwheel(axis, size)
        self._profiles.begin(
            i, self._profiles.towards(i, ManualKind.HANDLE, target, self._profiles.axes[i].vmax, rapid=False)
        )

    def go_to(self, axis: str, target: float, *, rapid: bool = False) -> None:
        """Go to a position (mm or degree, machine coordinates) at jogging or rapid speed.

        Raises:
            ControlError: No such axis, a target outside the software limits, or an axis that moves.
        """
        i = self._index(axis)
        check_free(self._machine, self._profiles, i)
        if not (is_finite(target) and self._profiles.soft(i, DOWN) <= target <= self._profiles.soft(i, UP)):
            raise ControlError(
                Refusal.TRAVEL,
                f"axis {axis} cannot go to {target:g} {self._profiles.axes[i].unit}",
                hint="Give a position within the software limits.",
            )
        if target != self._profiles.position(i):
            check_way(self._profiles, i, UP if target > self._profiles.position(i) else DOWN)
        speed = self._profiles.axes[i].vmax if rapid else self._profiles.jog_speed(i)
        self._profiles.begin(i, AxisMotion(ManualKind.GO, 0, target, speed, rapid))

    def reference(self, axis: str) -> None:
        """Reference an axis: find switch and index pulse and go to the reference position, or go there straight away.

        An axis without switch and index pulse, and one that is referenced (see `ManualData.search_again`), goes
        straight.

        Raises:
            ControlError: No such axis, or one that moves.
        """
        i = self._index(axis)
        check_free(self._machine, self._profiles, i)
        config = self._profiles.axes[i]
        steps: tuple[Step, ...] = ()
        if not self.references[i] or self.data.search_again:
            steps = reference_steps(config, self._profiles.position(i), self._profiles.on(i, REFERENCE))
            self.references[i] = False
        self.motions[i] = AxisMotion(ManualKind.REFERENCE, steps=steps)
        self._clock.changes += 1
        if steps:
            self._references.begin_step(i, 0)
        else:
            self._references.go_home(i)

    def stop(self, axis: str) -> None:
        """Brake an axis to rest and end what it was doing by hand.

        Raises:
            ControlError: There is no such axis.
        """
        self._profiles.stop(self._index(axis))

    def stop_all(self, axes: Iterable[str] | None = None) -> None:
        """Brake these axes (None: all) to rest and end what they were doing by hand."""
        for i in range(len(self.motions)) if axes is None else map(self._index, axes):
            if self.motions[i] is not REST:
                self._profiles.stop(i)

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
        rising = self._machine.state.switches.rising
        if any(rising.tobytes()) and (edges := rising[:, (LIMIT_LOW, LIMIT_HIGH)]).any():
            self.check_limit_switches()
            owners = [self._alarms.owner(axis.name) for axis in self._profiles.axes]
            stopped = {owner for owner, edge in zip(owners, edges, strict=True) if edge.any()}
            for i, owner in enumerate(owners):
                if owner in stopped:
                    self._profiles.stop(i)
        for i, motion in enumerate(self.motions):
            if motion is REST:
                continue
            at_rest = not self._machine.state.ptp.row[MAIN, i]["active"]
            if motion.stopping:
                if at_rest:
                    self.motions[i] = REST
            elif motion.waiting:
                if at_rest:
                    self._profiles.plan(i)
            elif motion.kind is ManualKind.REFERENCE and not motion.home:
                self._references.look(i, motion, at_rest)
            elif at_rest and self._profiles.speed(i, motion) > 0.0:
                self._arrive(i, motion)

    def snapshot(self) -> ManualState:
        """Return everything beside the kernel's arrays, to go back to."""
        return ManualState(
            tuple(self.motions),
            tuple(self.references),
            tuple(self._profiles.feed_overrides),
            tuple(self._profiles.rapid_overrides),
            self.wheel,
        )

    def restore(self, state: ManualState) -> None:
        """Go back to a snapshot; the kernel's arrays are the machine's to restore."""
        self.motions[:] = [REST if motion == REST else motion for motion in state.motions]
        self.references[:] = list(state.referenced)
        self._profiles.feed_overrides[:] = list(state.feed_overrides)
        self._profiles.rapid_overrides[:] = list(state.rapid_overrides)
        self.wheel = state.wheel
        self._profiles.note_speeds()

    # ------------------------------------------------------------------ planning

    def _index(self, axis: str) -> int:
        if axis not in self.names:
            raise ControlError(
                Refusal.DATA, f"there is no axis '{axis}'", hint=f"The axes are {', '.join(self.names)}."
            )
        return self.names.index(axis)

    # ------------------------------------------------------------------ ends and limits

    def _arrive(self, i: int, motion: AxisMotion) -> None:
        self.motions[i] = REST
        self._clock.changes += 1
        if motion.kind is ManualKind.REFERENCE:
            self.references[i] = True
        elif motion.beyond and self.data.soft_limit_alarm:
            self._alarms.put(f"soft_limit_{_SIDE[motion.direction]}", axis=self._profiles.axes[i].name)

    def check_limit_switches(self) -> bool:
        """Put an alarm on for every limit switch that is on; return whether there is one."""
        found = False
        for axis in self._profiles.axes:
            for side in (DOWN, UP):
                if self.blocked(axis.name, side):
                    self._alarms.put(f"limit_switch_{_SIDE[side]}", axis=axis.name)
                    found = True
        return found

    def blocked(self, axis: str, direction: int) -> bool:
        """Tell whether a limit switch keeps an axis from moving in a direction."""
        return self._profiles.blocked(self._index(axis), direction)

    # ------------------------------------------------------------------ reference search


def check_way(profiles: ManualProfiles, i: int, direction: int) -> None:
    """Refuse to move an axis towards the end of travel at which it is."""
    axis = profiles.axes[i]
    if profiles.blocked(i, direction):
        raise ControlError(
            Refusal.TRAVEL,
            f"axis {axis.name} is on a limit switch",
            hint="Move it off in the other direction.",
        )
    if (profiles.soft(i, direction) - profiles.position(i)) * direction <= 0.0:
        raise ControlError(
            Refusal.TRAVEL,
            f"axis {axis.name} is at its software limit",
            hint="Move it in the other direction.",
        )


def check_free(
    machine: Machine, profiles: ManualProfiles, i: int, same: ManualKind = ManualKind.NONE
) -> None:
    """Refuse an axis that something else than `same` is moving."""
    axis = profiles.axes[i].name
    if machine.state.owner[i] != POINT_TO_POINT:
        raise ControlError(
            Refusal.RUNNING, f"a program moves axis {axis}", hint="Wait for its end, or reset it."
        )
    kind = profiles.motions[i].kind
    if kind is not ManualKind.NONE and kind is not same:
        raise ControlError(Refusal.RUNNING, f"axis {axis} is moving ({kind})", hint="Wait until it stops.")


def check_direction(direction: int) -> None:
    """Refuse what is no direction."""
    if direction not in (DOWN, UP):
        raise ControlError(Refusal.DATA, f"{shown(direction)} is no direction", hint="Give 1 or -1.")


def check_size(size: float) -> None:
    """Refuse what is no size of an increment."""
    if not (is_finite(size) and size > 0.0):
        raise ControlError(
            Refusal.DATA,
            f"an increment of {shown(size)} is none",
            hint="Give a size above 0, in mm or degree.",
        )
