"""A point-to-point profile as a short table of phases: its ramps, its end, its exact evaluation.

Every phase is a polynomial in its own time. The row after the last phase holds the end state exactly as
given, so a profile ends on its target to the last bit.

Units: one of length and one of time, the caller's (mm or deg and s, counts and cycles); everything else follows.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from polycnc.kernel._jit import compiled

# Four ramps of three phases, a cruise, and the end row, make 14.
PROFILE_PHASES = 16

DURATION = 0
POSITION = 1
VELOCITY = 2
ACCELERATION = 3
JERK = 4
PROFILE_COLUMNS = 5

# A shorter jerk edge is left out: its jerk would come near the largest number there is.
SHORTEST_EDGE_S = 1e-100


@compiled
def clamped_jerkrel(jerkrel: float) -> float:
    """Return `jerkrel` limited to 0..1 (Manual 002, 4.4.76.1)."""
    if jerkrel > 1.0:
        return 1.0
    if jerkrel > 0.0:
        return jerkrel
    return 0.0


@compiled
def reverses(first: float, last: float) -> bool:
    """Tell whether a ramp between two velocities goes through standstill."""
    return first < 0.0 < last or last < 0.0 < first


@compiled
def ramp_distance(first: float, last: float, acceleration: float, deceleration: float) -> float:
    """Return the signed distance covered while the velocity goes from `first` to `last` without a pause."""
    if reverses(first, last):
        return 0.5 * (first * abs(first) / deceleration + last * abs(last) / acceleration)
    rate = acceleration if abs(last) > abs(first) else deceleration
    return 0.5 * (first + last) * (abs(last - first) / rate)


@compiled
def add_phase(
    phases: npt.NDArray[np.float64],
    count: int,
    duration: float,
    distance: float,
    velocity: float,
    acceleration: float,
    jerk: float,
) -> int:
    """Append one phase and return the new count; POSITION holds its distance until `close_profile`."""
    phases[count, DURATION] = duration
    phases[count, POSITION] = distance
    phases[count, VELOCITY] = velocity
    phases[count, ACCELERATION] = acceleration
    phases[count, JERK] = jerk
    return count + 1


@compiled
def _add_one_way_ramp(
    phases: npt.NDArray[np.float64], count: int, first: float, last: float, rate: float, jerkrel: float
) -> int:
    duration = abs(last - first) / rate
    if duration == 0.0:
        return count
    mean = 0.5 * (first + last)
    edge = duration * jerkrel / (1.0 + jerkrel)
    if edge < SHORTEST_EDGE_S:
        signed_rate = math.copysign(rate, last - first)
        return add_phase(phases, count, duration, mean * duration, first, signed_rate, 0.0)
    peak = math.copysign(rate * (1.0 + jerkrel), last - first)
    jerk = peak / edge
    change = 0.5 * peak * edge
    bend = peak * edge * edge / 6.0
    plateau = duration - 2.0 * edge
    count = add_phase(phases, count, edge, first * edge + bend, first, 0.0, jerk)
    if plateau > 0.0:
        count = add_phase(phases, count, plateau, mean * plateau, first + change, peak, 0.0)
    return add_phase(phases, count, edge, last * edge - bend, last - change, peak, -jerk)


@compiled
def add_ramp(
    phases: npt.NDArray[np.float64],
    count: int,
    first: float,
    last: float,
    acceleration: float,
    deceleration: float,
    jerkrel: float,
) -> int:
    """Append the ramp from velocity `first` to `last`, two ramps if through standstill; return the new count.

    `jerkrel` (0..1) bends the acceleration: mean, duration and distance stay, the peak is the mean times
    1 + jerkrel, and each of the two edges lasts jerkrel / (1 + jerkrel) of the ramp (Manual 002, 4.4.76.1).
    """
    if reverses(first, last):
        count = _add_one_way_ramp(phases, count, first, 0.0, deceleration, jerkrel)
        return _add_one_way_ramp(phases, count, 0.0, last, acceleration, jerkrel)
    rate = acceleration if abs(last) > abs(first) else deceleration
    return _add_one_way_ramp(phases, count, first, last, rate, jerkrel)


@compiled
def close_profile(
    phases: npt.NDArray[np.float64],
    count: int,
    split: int,
    start: float,
    target: float,
    target_velocity: float,
) -> None:
    """Write the end row, and turn the distances of the phases into positions.

    Positions before row `split` are summed from the start, the others back from the target: rounding shows
    in the middle, not where the profile joins its neighbours.
    """
    position = start
    for row in range(min(max(split, 1), count)):
        distance = phases[row, POSITION]
        phases[row, POSITION] = position
        position += distance
    position = target
    for row in range(count - 1, max(split, 1) - 1, -1):
        position -= phases[row, POSITION]
        phases[row, POSITION] = position
    add_phase(phases, count, 0.0, target, target_velocity, 0.0, 0.0)


@compiled
def profile_duration(phases: npt.NDArray[np.float64], count: int) -> float:
    """Return the time in seconds from the start of a profile of `count` phases to its target."""
    total = 0.0
    for row in range(count):
        total += phases[row, DURATION]
    return total


@compiled
def profile_at(phases: npt.NDArray[np.float64], count: int, time: float) -> tuple[float, float, float]:
    """Return position, velocity and acceleration `time` seconds after the start of a profile.

    From the duration on, the answer is the stored target (at the duration itself to the last bit), moving on
    with the target velocity. Before the start it is the start.
    """
    # The same sum as in profile_duration, so that both agree bit by bit on where the profile ends.
    begin = 0.0
    for row in range(count):
        end = begin + phases[row, DURATION]
        if time < end:
            since = time - begin if time > begin else 0.0
            velocity = phases[row, VELOCITY]
            acceleration = phases[row, ACCELERATION]
            jerk = phases[row, JERK]
            moved = since * (velocity + since * (0.5 * acceleration + since * (jerk / 6.0)))
            gained = since * (acceleration + since * (0.5 * jerk))
            return phases[row, POSITION] + moved, velocity + gained, acceleration + since * jerk
        begin = end
    velocity = phases[count, VELOCITY]
    since = time - begin if time > begin else 0.0
    return phases[count, POSITION] + velocity * since, velocity, 0.0
