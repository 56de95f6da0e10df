"""A spindle that ramps, turns and is brought to an angle: what it does at any cycle, in closed form.

Speeds are signed, positive clockwise (M3), in revolutions per minute; a minute's turn of 1 rpm is 360 degree. The
motion is a list of ramps, each from one speed to another; after the last one the speed stays.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

from polycnc.cnc._frozen import row
from polycnc.cnc._refusal import ControlError, Refusal
from polycnc.errors import shown
from polycnc.machine import Clock, MachineConfig
from polycnc.units import is_finite

_DEG_S_PER_RPM = 6.0
_AT_ONCE = math.inf


@dataclass(frozen=True, slots=True)
class Ramp:
    """Go from one speed to another (deg/s) in a time."""

    duration_s: float
    from_deg_s: float
    to_deg_s: float

    def angle_deg(self, time_s: float) -> float:
        """Return how far it has turned after a time within the ramp."""
        share = time_s / self.duration_s if self.duration_s > 0.0 else 0.0
        return (self.from_deg_s + 0.5 * share * (self.to_deg_s - self.from_deg_s)) * time_s


@dataclass(frozen=True, slots=True)
class SpindleMotion:
    """What the spindle was told and what it has done until then: everything there is to know about it."""

    rpm: float = 0.0  # programmed, without sign and override
    direction: int = 0  # 1 clockwise, -1 counter-clockwise, 0 stopped
    override: float = 1.0
    orienting: bool = False
    from_cycle: int = 0
    from_angle_deg: float = 0.0
    ramps: tuple[Ramp, ...] = ()
    then_deg_s: float = 0.0
    end_angle_deg: float | None = None  # where the ramps end, if it was brought there


@row
class SpindleState(NamedTuple):
    """The spindle at one cycle; rpm signed, positive clockwise, `commanded_rpm` with override and within its limit."""

    programmed_rpm: float
    direction: int
    override: float
    commanded_rpm: float
    actual_rpm: float
    reached: bool
    angle_deg: float
    oriented: bool


class Spindle:
    """One spindle of a machine, on its clock."""

    def __init__(self, clock: Clock, config: MachineConfig) -> None:
        self._clock = clock
        self._config = config.spindle
        self._start_s = 0.0 if config.spindle.laser else config.times.spindle_start_s
        self._motion = SpindleMotion()
        self._rest: tuple[SpindleMotion, SpindleState] | None = None  # what a motion has come to rest at

    def turn(self, *, rpm: float | None = None, direction: int | None = None) -> None:
        """Take over an S word and the direction of M3 (1), M4 (-1) or M5 (0); what is None stays.

        A speed above the spindle's highest is held at it, as its status shows.

        Raises:
            ControlError: A speed that is negative or not finite, a direction other than -1, 0 and 1.
        """
        if rpm is not None and not (is_finite(rpm) and rpm >= 0.0):
            raise ControlError(
                Refusal.DATA,
                f"the spindle cannot turn at {shown(rpm)} rpm",
                hint="Give a speed from 0; M4 turns back.",
            )
        if direction is not None and direction not in (-1, 0, 1):
            raise ControlError(
                Refusal.DATA,
                f"{shown(direction)} is no direction of a spindle",
                hint="1 is M3, -1 is M4, 0 is M5.",
            )
        motion = self._motion
        wanted = replace(
            motion,
            rpm=motion.rpm if rpm is None else rpm,
            direction=motion.direction if direction is None else direction,
            orienting=motion.orienting and direction is None,
        )
        self._go_on(wanted)

    def set_override(self, override: float) -> None:
        """Set the spindle override, 1 is 100 %; an orientation goes on at its own speed.

        Raises:
            ControlError: Not a number from 0 to 2.
        """
        if not 0.0 <= override <= 2.0:
            raise ControlError(
                Refusal.DATA,
                f"a spindle override of {shown(override)} is out of range",
                hint="Give 0 to 2; 1 is 100 %.",
            )
        if override != self._motion.override:
            self._go_on(replace(self._motion, override=override), in_proportion=True)

    def orient(self, angle_deg: float | None = None) -> None:
        """Bring the spindle to rest at an angle (M19), by default that of the machine file, in its direction of turn.

        Raises:
            ControlError: The angle is not finite.
        """
        target = self._config.orientation_deg if angle_deg is None else angle_deg
        if not is_finite(target):
            raise ControlError(
                Refusal.DATA,
                f"the spindle cannot stop at {shown(target)} degree",
                hint="Give an angle in degree.",
            )
        self._clock.changes += 1
        now = self._now()
        speed = now.actual_rpm * _DEG_S_PER_RPM
        sign = math.copysign(1.0, speed) if speed != 0.0 else 1.0
        creep = sign * self._config.orientation_rpm * _DEG_S_PER_RPM
        rate = self._rate_deg_s2(max(abs(speed), abs(creep)), self._start_s)
        first = Ramp(abs(creep - speed) / rate, speed, creep)
        last = Ramp(abs(creep) / rate, creep, 0.0)
        swept = first.angle_deg(first.duration_s) + last.angle_deg(last.duration_s)
        left = (sign * (target - now.angle_deg - swept)) % 360.0
        between = Ramp(left / abs(creep), creep, creep)
        self._motion = replace(
            self._motion,
            direction=0,
            orienting=True,
            from_cycle=self._clock.cycles,
            from_angle_deg=now.angle_deg,
            ramps=(first, between, last),
            then_deg_s=0.0,
            end_angle_deg=target % 360.0,
        )

    @property
    def is_orienting(self) -> bool:
        """Whether the spindle is brought to an angle, or stands there."""
        return self._motion.orienting

    def stop(self) -> None:
        """Stop the spindle (emergency, reset); the programmed speed stays known."""
        self.turn(direction=0)

    def state(self) -> SpindleState:
        """Return the spindle at the present cycle."""
        if self._rest is not None and self._rest[0] is self._motion:
            return self._rest[1]
        now = self._now()
        if now.reached and now.actual_rpm == self._motion.then_deg_s == 0.0:
            self._rest = self._motion, now
        return now

    def reached_cycle(self) -> int:
        """Return the first cycle in which the commanded speed, or the angle, is reached."""
        motion = self._motion
        total_s = sum(ramp.duration_s for ramp in motion.ramps)
        share = self._config.reached_share
        if share > 0.0 and not motion.orienting and motion.ramps:
            ramp = motion.ramps[-1]
            gap = abs(ramp.to_deg_s - ramp.from_deg_s)
            band = share * abs(ramp.to_deg_s)
            total_s -= ramp.duration_s * (min(band / gap, 1.0) if gap > 0.0 else 1.0)
        return motion.from_cycle + self._clock.cycles_for(total_s)

    def snapshot(self) -> SpindleMotion:
        """Return everything, to go back to."""
        return self._motion

    def restore(self, motion: SpindleMotion) -> None:
        """Go back to a snapshot."""
        self._motion, self._rest = motion, None
        self._clock.changes += 1

    def _commanded_rpm(self, motion: SpindleMotion) -> float:
        return motion.direction * min(motion.rpm * motion.override, self._config.max_rpm)

    def _go_on(self, wanted: SpindleMotion, *, in_proportion: bool = False) -> None:
        """Ramp from what the spindle does now to what is wanted; a ramp that leads there already stays.

        Without an acceleration in the machine file a ramp takes its starting time, or `in_proportion` as much of
        that as the change is of the highest speed.
        """
        self._clock.changes += 1
        target = self._commanded_rpm(wanted) * _DEG_S_PER_RPM
        if wanted.orienting or (target == wanted.then_deg_s and not self._motion.orienting):
            self._motion = wanted
            return
        now = self._now()
        speed = now.actual_rpm * _DEG_S_PER_RPM
        gap = abs(target - speed)
        time_s = self._start_s
        if in_proportion:
            time_s *= gap / (self._config.max_rpm * _DEG_S_PER_RPM)
        duration = gap / self._rate_deg_s2(gap, time_s)
        self._motion = replace(
            wanted,
            from_cycle=self._clock.cycles,
            from_angle_deg=now.angle_deg,
            ramps=(Ramp(duration, speed, target),),
            then_deg_s=target,
            end_angle_deg=None,
        )

    def _rate_deg_s2(self, gap_deg_s: float, time_s: float) -> float:
        """Return the acceleration: the machine file's, or what covers the gap in the machine file's starting time."""
        if self._config.acceleration_rpm_s is not None:
            return self._config.acceleration_rpm_s * _DEG_S_PER_RPM
        return gap_deg_s / time_s if time_s > 0.0 and gap_deg_s > 0.0 else _AT_ONCE

    def _now(self) -> SpindleState:
        motion = self._motion
        cycle = self._clock.cycles
        left_s = (cycle - motion.from_cycle) * self._clock.cycle_s
        ended = cycle >= motion.from_cycle + self._clock.cycles_for(
            sum(each.duration_s for each in motion.ramps)
        )
        turned = 0.0
        speed = motion.then_deg_s
        for ramp in motion.ramps:
            if left_s < ramp.duration_s and not ended:
                turned += ramp.angle_deg(left_s)
                speed = ramp.from_deg_s + left_s / ramp.duration_s * (ramp.to_deg_s - ramp.from_deg_s)
                left_s = 0.0
                break
            turned += ramp.angle_deg(ramp.duration_s)
            left_s -= ramp.duration_s
        turned += motion.then_deg_s * left_s
        angle = motion.from_angle_deg + turned
        if ended and motion.end_angle_deg is not None:
            angle = motion.end_angle_deg
        return SpindleState(
            programmed_rpm=motion.rpm,
            direction=motion.direction,
            override=motion.override,
            commanded_rpm=self._commanded_rpm(motion),
            actual_rpm=speed / _DEG_S_PER_RPM,
            reached=cycle >= self.reached_cycle(),
            angle_deg=angle % 360.0,
            oriented=motion.orienting and ended,
        )
