"""The profiles of axes that are moved by hand, planned anew whenever a key, a pulse or an override changes them."""

from __future__ import annotations

import math
from dataclasses import replace

from polycnc.cnc._manual_data import REST, AxisMotion, ManualData, ManualKind
from polycnc.kernel import LIMIT_HIGH, LIMIT_LOW, MAIN, SHORT_OVERSHOOT, move_to, rest_position, stop_axis
from polycnc.machine import AxisConfig, Machine

DOWN, UP = -1, 1


class ManualProfiles:
    """Plan motions by hand; every list has a value for each axis, by its place, and is changed in place.

    `motions` are what the axes are doing, `references` which are referenced, `jog_speeds` how fast a jog key moves them
    with their override (mm/s or deg/s).
    """

    def __init__(self, machine: Machine, data: ManualData, *, referenced: bool) -> None:
        self.data = data
        self.axes: tuple[AxisConfig, ...] = machine.config.axes
        count = len(self.axes)
        self.motions = [REST] * count
        self.references = [referenced] * count
        self.feed_overrides = [1.0] * count
        self.rapid_overrides = [1.0] * count
        self.jog_speeds = [0.0] * count
        self._machine = machine
        self._clock = machine.clock
        self.note_speeds()

    def note_speeds(self) -> None:
        """Take over other speeds of jogging."""
        self._jog_speeds = [self.jog_speed(i) for i in range(len(self.axes))]
        self.note_overrides()

    def note_overrides(self) -> None:
        """Take over other overrides."""
        self.jog_speeds[:] = [
            speed * share for speed, share in zip(self._jog_speeds, self.feed_overrides, strict=True)
        ]
        self._clock.changes += 1

    def position(self, i: int) -> float:
        """Return where an axis is commanded to be."""
        return float(self._machine.state.base[i])

    def jog_speed(self, i: int) -> float:
        """Return how fast a jog key moves an axis, without override."""
        axis = self.axes[i]
        return min(self.data.jog_speeds.get(axis.name, axis.vmax * self.data.jog_share), axis.vmax)

    def soft(self, i: int, direction: int) -> float:
        """Return the software limit of a side, infinite where none holds."""
        if not (self.references[i] or self.data.soft_limits_unreferenced):
            return direction * math.inf
        low, high = self.axes[i].soft_limits
        return low if direction == DOWN else high

    def towards(self, i: int, kind: ManualKind, target: float, speed: float, rapid: bool) -> AxisMotion:
        """Return a motion to a target, or to the software limit before it."""
        direction = UP if target > self.position(i) else DOWN
        end = self.soft(i, direction)
        beyond = (target - end) * direction > 0.0
        return AxisMotion(kind, direction, end if beyond else target, speed, rapid, beyond=beyond)

    def speed(self, i: int, motion: AxisMotion) -> float:
        """Return the speed of an axis' motion with its override."""
        if motion.kind is ManualKind.HANDLE:
            return motion.speed
        if motion.kind is ManualKind.REFERENCE:
            fast = motion.home or motion.steps[motion.step].fast
            return motion.speed * (self.rapid_overrides[i] if fast else 1.0)
        return motion.speed * (self.rapid_overrides[i] if motion.rapid else self.feed_overrides[i])

    def begin(self, i: int, motion: AxisMotion) -> None:
        """Let an axis begin a motion."""
        self.motions[i] = motion
        self._clock.changes += 1
        self.plan(i)

    def plan(self, i: int) -> None:
        """Plan the profile of an axis from where and how fast it is now."""
        motion, axis, state = self.motions[i], self.axes[i], self._machine.state
        speed = min(self.speed(i, motion), axis.vmax)
        if speed <= 0.0:
            self.brake(i)
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
            target = self.position(i) + _ramp_distance(velocity, then, rate)
        move_to(state.ptp, MAIN, i, target, then, speed, rate, rate, jerkrel, SHORT_OVERSHOOT)

    def _is_late(self, i: int) -> bool:
        """Tell whether an axis that comes to rest at its software limit would pass it with another profile.

        Every profile begins without acceleration, so a ramp that is under way already ends sooner than a new one.
        """
        axis, state = self.axes[i], self._machine.state
        velocity = float(state.ptp.row[MAIN, i]["velocity"])
        direction = UP if velocity > 0.0 else DOWN
        end = self.soft(i, direction)
        rate = axis.amax / (1.0 + self._machine.config.path.jerkrel)
        rest = self.position(i) + _ramp_distance(velocity, 0.0, rate)
        return (rest - end) * direction > 0.0 and (rest_position(state.ptp, MAIN, i) - end) * direction <= 0.0

    def brake(self, i: int) -> None:
        """Plan an axis to rest, as soon as it may be."""
        if self._is_late(i):
            return
        jerkrel = self._machine.config.path.jerkrel
        rate = self.axes[i].amax / (1.0 + jerkrel)
        stop_axis(self._machine.state.ptp, MAIN, i, rate, jerkrel)

    def stop(self, i: int) -> None:
        """Brake an axis to rest and end what it was doing."""
        motion = self.motions[i]
        if motion is REST or motion.stopping:
            return
        self._machine.state.switches.marks[i]["index_armed"] = 0
        self._clock.changes += 1
        self.motions[i] = replace(motion, stopping=True, beyond=False)
        if not motion.braking:
            self.brake(i)

    def on(self, i: int, which: int) -> bool:
        """Tell whether a switch is on, before the first cycle as well."""
        switch = self._machine.state.switches.switch[i][which]
        return bool(switch["on_from"] <= self._machine.state.servo.actual[i] <= switch["on_to"])

    def blocked(self, i: int, direction: int) -> bool:
        """Tell whether a limit switch keeps an axis from moving in a direction."""
        return self.on(i, LIMIT_LOW if direction == DOWN else LIMIT_HIGH)


def _ramp_distance(first: float, last: float, rate: float) -> float:
    """Return the way while the velocity goes from `first` to `last`."""
    if first * last < 0.0:
        return 0.5 * (first * abs(first) + last * abs(last)) / rate
    return 0.5 * (first + last) * (abs(last - first) / rate)
