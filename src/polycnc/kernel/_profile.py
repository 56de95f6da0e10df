"""Plan a point-to-point profile in closed form, from any state to any state.

The one idea: compare the distance to go with the distance of the direct ramp from the start to the target
velocity. The difference (the surplus) says to which side the velocity must leave that ramp, and how far:
peak^2 = (outer end velocity)^2 + surplus / (1/2a + 1/2d), or the maximum velocity and a cruise. Its sign
chooses the side, and that choice is the time-optimal one, also with unequal rates and changes of direction.

Rates belong to the speed, not to the axis direction: `acceleration` while it grows, `deceleration` while it
falls.

Units: one of length and one of time, the caller's, as in `_profile_shape`.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from polycnc.kernel._jit import compiled
from polycnc.kernel._profile_shape import (
    add_phase,
    add_ramp,
    clamped_jerkrel,
    close_profile,
    ramp_distance,
    reverses,
)

PROFILE_REFUSED = -1

# What to do when the distance is too short for the direct ramp (see plan_profile).
SHORT_OVERSHOOT = 0
SHORT_JUMP = 1
SHORT_REDUCE_START = 2

# Rounding, relative and as a time of travel: a ramp that misses its target by no more is continued, where
# strict arithmetic could ask for a turn back and a new run-up.
SAME_LENGTH = 1e-14
SAME_INSTANT_S = 1e-12


@compiled
def _direction(distance: float, start_velocity: float, target_velocity: float) -> float:
    """Return +1 or -1: where the target lies, or where the motion goes when it starts on the target."""
    if distance != 0.0:
        return math.copysign(1.0, distance)
    if start_velocity != 0.0:
        return math.copysign(1.0, start_velocity)
    return math.copysign(1.0, target_velocity)


@compiled
def _is_running_ramp(
    surplus: float, start: float, start_velocity: float, target: float, end_velocity: float, per_square: float
) -> bool:
    """Tell whether all that is left is the ramp to the end velocity, as when planning again in mid-ramp."""
    if start_velocity == 0.0 or reverses(start_velocity, end_velocity):
        return False
    speeds = abs(start_velocity) + abs(end_velocity)
    lengths = abs(start) + abs(target) + speeds * speeds * per_square
    return abs(surplus) <= SAME_LENGTH * lengths + SAME_INSTANT_S * speeds


@compiled
def _plan_short(
    phases: npt.NDArray[np.float64],
    start: float,
    start_velocity: float,
    target: float,
    end_velocity: float,
    target_velocity: float,
    direction: float,
    acceleration: float,
    deceleration: float,
    jerkrel: float,
    reduce: bool,
) -> int:
    """Plan one ramp over a distance that is too short for it: a velocity is stepped or reduced."""
    distance = abs(target - start)
    first = start_velocity * direction
    last = end_velocity * direction
    if first > last:
        if reduce:
            first = math.sqrt(last * last + 2.0 * deceleration * distance)
        else:
            square = first * first - 2.0 * deceleration * distance
            last = math.sqrt(square) if square > 0.0 else 0.0
    else:
        if first > 0.0:
            last = math.sqrt(first * first + 2.0 * acceleration * distance)
        else:
            last = math.sqrt(2.0 * acceleration * (distance + first * first / (2.0 * deceleration)))
        if reduce:
            target_velocity = last * direction
    count = add_ramp(phases, 0, first * direction, last * direction, acceleration, deceleration, jerkrel)
    close_profile(phases, count, count, start, target, target_velocity)
    return count


@compiled
def plan_profile(
    phases: npt.NDArray[np.float64],
    start: float,
    start_velocity: float,
    target: float,
    target_velocity: float,
    velocity: float,
    acceleration: float,
    deceleration: float,
    jerkrel: float,
    short_policy: int,
) -> int:
    """Fill `phases` with the fastest profile to `target`, passed with `target_velocity`; return the count.

    All numbers are signed in axis direction, in one length unit and seconds. `phases` is
    (PROFILE_PHASES, PROFILE_COLUMNS); the row after the last phase holds the target and the velocity there.
    A count of 0 means already there; PROFILE_REFUSED (with `phases` untouched) that a limit is not above zero
    or a number is not finite (`velocity` may be infinite). To change a running profile, plan again from
    `profile_at`.

    A start faster than `velocity` brakes down to it. A target velocity above `velocity` counts as `velocity`
    and is stepped to at the target. A target velocity against the direction of travel makes the profile pass
    the target, turn, and have that velocity at the target on the way back; such a profile is never too short.
    When the distance is otherwise too short to brake or to reach the target velocity, `short_policy` decides:

    - SHORT_OVERSHOOT: no velocity steps; pass the target and come back, or move back to gain run-up.
    - SHORT_JUMP: brake or accelerate up to the target; the velocity steps to the target velocity there.
    - SHORT_REDUCE_START: lower the start velocity (a step at the start), or the target velocity (no step).

    When start and target velocity both exceed `velocity` in the direction of travel and braking does not fit,
    the velocity steps at the target whatever the policy, as it has to step there anyway.
    Source: Manual 002, 2.2.1, 2.2.2 and 4.4.76.1.
    """
    if not (velocity > 0.0 and acceleration > 0.0 and deceleration > 0.0):
        return PROFILE_REFUSED
    end_velocity = target_velocity
    if abs(target_velocity) > velocity:
        end_velocity = math.copysign(velocity, target_velocity)
    surplus = target - start - ramp_distance(start_velocity, end_velocity, acceleration, deceleration)
    rates = acceleration + deceleration
    if not (math.isfinite(surplus) and math.isfinite(target_velocity) and math.isfinite(rates)):
        return PROFILE_REFUSED
    jerkrel = clamped_jerkrel(jerkrel)
    # Distance per squared speed of a ramp up from standstill and down again.
    per_square = 0.5 / acceleration + 0.5 / deceleration

    if _is_running_ramp(surplus, start, start_velocity, target, end_velocity, per_square):
        count = add_ramp(phases, 0, start_velocity, end_velocity, acceleration, deceleration, jerkrel)
        close_profile(phases, count, count, start, target, target_velocity)
        return count

    direction = _direction(target - start, start_velocity, end_velocity)
    if surplus * direction < 0.0 and end_velocity * direction >= 0.0:
        steps_anyway = abs(target_velocity) > velocity and start_velocity * direction > velocity
        if steps_anyway or short_policy != SHORT_OVERSHOOT:
            return _plan_short(
                phases,
                start,
                start_velocity,
                target,
                end_velocity,
                target_velocity,
                direction,
                acceleration,
                deceleration,
                jerkrel,
                short_policy == SHORT_REDUCE_START and not steps_anyway,
            )

    # Seen from the side of the surplus, the velocity rises from the higher end velocity to a peak.
    side = 1.0 if surplus > 0.0 else -1.0
    higher = side * start_velocity if side * start_velocity > side * end_velocity else side * end_velocity
    if higher > velocity:
        higher = velocity
    room = (velocity - higher) * (velocity + higher) * per_square
    peak = velocity
    cruise = abs(surplus) - room
    if cruise < 0.0:
        peak = math.sqrt(higher * higher + abs(surplus) / per_square)
        if peak > velocity:
            peak = velocity
    peak *= side
    count = add_ramp(phases, 0, start_velocity, peak, acceleration, deceleration, jerkrel)
    if cruise > 0.0:
        count = add_phase(phases, count, cruise / velocity, side * cruise, peak, 0.0, 0.0)
    split = count
    count = add_ramp(phases, count, peak, end_velocity, acceleration, deceleration, jerkrel)
    close_profile(phases, count, split, start, target, target_velocity)
    return count


@compiled
def stop_profile(
    phases: npt.NDArray[np.float64], start: float, start_velocity: float, deceleration: float, jerkrel: float
) -> int:
    """Fill `phases` with the way to rest from here; return the count of phases.

    The end row holds where it comes to rest. A deceleration that is not above zero stops at once: 0 phases.
    """
    count = 0
    target = start
    if deceleration > 0.0:
        count = add_ramp(phases, 0, start_velocity, 0.0, deceleration, deceleration, clamped_jerkrel(jerkrel))
        target = start + ramp_distance(start_velocity, 0.0, deceleration, deceleration)
    close_profile(phases, count, count, start, target, 0.0)
    return count
