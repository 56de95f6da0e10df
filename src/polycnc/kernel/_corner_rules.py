"""Corner speeds by the angle alone, as many open controls take them: the path steps through the corner.

With AS_AXES_ALLOW (see `_limits`) the axes keep their acceleration in every cycle. The rules here allow the step in
velocity that an arc near the corner would spread: the arc that touches both sides and passes the corner at a
deviation has the radius deviation s / (1 - s), s the cosine of half the turn, and is traversed with the full
acceleration. Units: those of `_segments`.
"""

from __future__ import annotations

import math

import numpy as np

from polycnc.kernel._axis_limits import AxisLimits
from polycnc.kernel._jit import compiled
from polycnc.kernel._segments import LINE, Floats, Segments

AS_AXES_ALLOW = 0
BY_DEVIATION = 1  # acceleration: what the axes allow in the direction of the turn
BY_SQUARE_CORNER = 2  # acceleration: that of both moves; a move also bounds the radius by half its length
# A part of what each axis has in a cycle, which the lines beside the corner do without all along.
BY_SHARE = 3

REVERSAL = 1e-6  # of 1 + cosine; a sharper corner is a stop
STRAIGHT_ON = 1e-12  # of 1 - s; a smaller turn is none


@compiled
def turns(work: Floats, angle_rad: float) -> bool:
    """Tell whether the tangents `work[0]` and `work[1]` differ by more than an angle."""
    dot, before, behind = 0.0, 0.0, 0.0
    for i in range(work.shape[1]):
        dot += work[0, i] * work[1, i]
        before += work[0, i] * work[0, i]
        behind += work[1, i] * work[1, i]
    return bool(dot < math.cos(angle_rad) * math.sqrt(before * behind))


@compiled
def step_share(
    limits: AxisLimits, work: Floats, speed_mm_s: float, accel_mm_s2: float, cycle_s: float
) -> float:
    """Return which part of its acceleration the busiest axis needs to step through a corner within a cycle.

    The path passes it with a speed, from the tangent `work[0]` to `work[1]`, and speeds up in the same cycle.
    """
    share = 0.0
    for i in range(work.shape[1]):
        change = abs(work[1, i] - work[0, i])
        if change > 0.0:
            share = max(share, change * (speed_mm_s / cycle_s + accel_mm_s2) / limits.acceleration[i])
    return share


@compiled
def corner_speed(
    seg: Segments, k: int, following: int, limits: AxisLimits, path: np.void, work: Floats, speed_mm_s: float
) -> float:
    """Return the speed up to `speed_mm_s` through the end of segment `k` by the rule of the path.

    `work`, [3, n], holds the tangents on both sides; the third row is scratch.
    """
    row, after = seg.row[k], seg.row[following]
    dot, before, behind = 0.0, 0.0, 0.0
    for i in range(work.shape[1]):
        dot += work[0, i] * work[1, i]
        before += work[0, i] * work[0, i]
        behind += work[1, i] * work[1, i]
    if before <= 0.0 or behind <= 0.0:
        return 0.0
    before, behind = math.sqrt(before), math.sqrt(behind)
    cosine = max(-1.0, min(1.0, dot / (before * behind)))
    if 1.0 + cosine < REVERSAL:
        return 0.0
    half = math.sqrt(0.5 * (1.0 + cosine))
    if 1.0 - half < STRAIGHT_ON:
        return speed_mm_s
    radius = path["corner_deviation_mm"] * half / (1.0 - half)
    if path["corner_rule"] == BY_DEVIATION:
        square = radius * _turning_acceleration(limits, path, work, before, behind)
    else:
        square = radius * min(row["full_accel"], after["full_accel"])
        room = 0.5 * half / math.sqrt(0.5 * (1.0 - cosine))
        if row["kind"] == LINE:
            square = min(square, room * row["length"] * row["full_accel"])
        if after["kind"] == LINE:
            square = min(square, room * after["length"] * after["full_accel"])
    return min(speed_mm_s, math.sqrt(square))


@compiled
def _turning_acceleration(
    limits: AxisLimits, path: np.void, work: Floats, before: float, behind: float
) -> float:
    """Return the acceleration that the axes allow in the direction in which the path turns."""
    size = 0.0
    for i in range(work.shape[1]):
        work[2, i] = abs(work[1, i] / behind - work[0, i] / before)
        size += work[2, i] * work[2, i]
    size = math.sqrt(size)
    accel = float(path["accel_limit_mm_s2"])
    for i in range(work.shape[1]):
        if work[2, i] > 0.0:
            accel = min(accel, limits.acceleration[i] * size / work[2, i])
    return accel
