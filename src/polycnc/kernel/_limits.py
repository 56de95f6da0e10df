"""How fast a segment and a junction may be taken so that no axis breaks its limits, cycle by cycle.

What an axis does in two neighbouring cycles weighs the motion with a triangle two cycles wide. A corner's change of
velocity must fit under it together with the ramps beside it and with the other corners nearby. It does if every
change is at most `share / CORNER_MARGIN` of what the axis' acceleration gives in a cycle, or in the time to the
next corner where that is shorter, and if the ramps on both sides leave that share alone. On a curve the
centripetal and the tangential part share what is left after the corners' fixed part: as a circle where they are a
quarter turn apart (arcs), as a sum elsewhere (splines). See docs/explanation/motion.md.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from polycnc.kernel._circle3d import circle3d_tangent_bound
from polycnc.kernel._geometry import is_curved, segment_tangent
from polycnc.kernel._jit import compiled
from polycnc.kernel._segments import (
    ARC,
    CIRCLE3D,
    CIRCLE3D_RADIUS,
    LINE,
    RADIUS_END,
    RADIUS_START,
    RAPID,
    SPLINE,
    SPLINE_FROM,
    SPLINE_INDEX,
    STOP,
    SWEEP,
    WAIT,
    WORK_POINT,
    Floats,
    Segments,
)
from polycnc.kernel._spline import Splines, spline_bounds_between

CORNER_SHARE = 0.5  # highest part of an axis' acceleration that a corner between lines may use
CURVE_CORNER_SHARE = 0.1  # the same beside a curve, which needs the rest for itself
CURVE_SHARE = 1.0 - CURVE_CORNER_SHARE
CENTRIPETAL_SHARE = 0.75  # highest part that the curvature of an arc may use
SPLINE_CENTRIPETAL_SHARE = 0.45
CORNER_MARGIN = 1.125  # the most that corners closer than a cycle can add up to unevenly
STRAIGHT = 1e-13  # a smaller change of direction is rounding
LEAST_PART = 0.5  # of `full_accel` is left whatever the corners and the override turn out to be


class AxisLimits(NamedTuple):
    """Limits of n axes, and which of them count in the path length."""

    speed: Floats
    acceleration: Floats
    jump: Floats  # velocity step at a junction; negative: what the acceleration allows
    feed_axis: npt.NDArray[np.uint8]


def make_limits(axes: int) -> AxisLimits:
    """Allocate limits of `axes` axes: unlimited, all counting. Rapids need a speed limit."""
    return AxisLimits(
        speed=np.full(axes, np.inf),
        acceleration=np.full(axes, np.inf),
        jump=np.full(axes, -1.0),
        feed_axis=np.ones(axes, np.uint8),
    )


@compiled
def feed_in_force(row: np.void, path: np.void) -> float:
    """Return the path speed that is asked for: the programmed feed, or that of a dry run, times the override.

    An override of 0 holds the path, so its segments stay planned as they are programmed.
    """
    feed = row["feed"]
    if row["flags"] & RAPID:
        return float(feed)
    if path["dry_feed"] > 0.0:
        feed = path["dry_feed"]
    return float(feed * path["override"] if path["override"] > 0.0 else feed)


@compiled
def overridden_rapid(cap: float, path: np.void) -> float:
    """Return what the override of positioning leaves of a path speed that the axes allow."""
    factor = path["rapid_override"] if path["rapid_override"] > 0.0 else 1.0
    return float(min(cap * factor, path["rapid_top"]))


@compiled
def line_speed(seg: Segments, k: int, limits: AxisLimits) -> float:
    """Return the path speed that the axes allow on line `k`."""
    speed = math.inf
    for i in range(limits.speed.shape[0]):
        part = abs(seg.end[k, i] - seg.start[k, i]) / seg.row[k]["length"]
        if part > 0.0:
            speed = min(speed, limits.speed[i] / part)
    return speed


@compiled
def limit_segment(seg: Segments, k: int, limits: AxisLimits, path: np.void, work: Floats) -> None:
    """Set `cap` and `full_accel` of segment `k`: feed times override, within what every axis allows.

    `work` is scratch, [2, n].
    """
    row = seg.row[k]
    kind = row["kind"]
    cap = feed_in_force(row, path)
    accel = math.inf
    if kind == WAIT:
        cap = 0.0
        accel = 1.0
    elif kind == LINE:
        for i in range(limits.speed.shape[0]):
            part = abs(seg.end[k, i] - seg.start[k, i]) / row["length"]
            if part > 0.0:
                cap = min(cap, limits.speed[i] / part)
                accel = min(accel, limits.acceleration[i] / part)
        if row["flags"] & RAPID:
            cap = overridden_rapid(cap, path)
    else:
        cap, accel = _limit_curve(seg, k, limits, cap, work)
    row["cap"] = cap
    row["full_accel"] = accel


@compiled
def _limit_curve(seg: Segments, k: int, limits: AxisLimits, feed: float, work: Floats) -> tuple[float, float]:
    """Return speed cap and tangential acceleration on a curve from per-axis bounds of tangent and curvature."""
    tangent, bend = work[0], work[1]
    _curve_bounds(seg, k, tangent, bend)
    is_spline = seg.row[k]["kind"] == SPLINE
    bend_share = SPLINE_CENTRIPETAL_SHARE if is_spline else CENTRIPETAL_SHARE
    cap = feed
    for i in range(tangent.shape[0]):
        if tangent[i] > 0.0:
            cap = min(cap, limits.speed[i] / tangent[i])
        if bend[i] > 0.0:
            cap = min(cap, math.sqrt(bend_share * limits.acceleration[i] / bend[i]))
    accel = math.inf
    for i in range(tangent.shape[0]):
        if tangent[i] > 0.0:
            used = cap * cap * bend[i] / limits.acceleration[i] if bend[i] > 0.0 else 0.0
            left = CURVE_SHARE - used if is_spline else math.sqrt(CURVE_SHARE * CURVE_SHARE - used * used)
            accel = min(accel, left * limits.acceleration[i] / tangent[i])
    return cap, accel


@compiled
def _curve_bounds(seg: Segments, k: int, tangent: Floats, bend: Floats) -> None:
    """Write the greatest |dp/ds| and |d2p/ds2| of every axis over curve `k`."""
    row, geo = seg.row[k], seg.geo[k]
    kind = row["kind"]
    if kind == SPLINE:
        _spline_bounds(seg.splines, geo, row["length"], tangent, bend)
        return
    for i in range(tangent.shape[0]):
        tangent[i] = abs(seg.end[k, i] - seg.start[k, i]) / row["length"]
        bend[i] = 0.0
    if kind == ARC:
        small = min(geo[RADIUS_START], geo[RADIUS_END])
        large = max(geo[RADIUS_START], geo[RADIUS_END])
        turn = abs(geo[SWEEP]) / row["length"]
        # A changing radius adds a part along the radius, and as much again across it by turning.
        spiral = 1.0 + 2.0 * (large - small) / (abs(geo[SWEEP]) * small)
        for j in range(2):
            tangent[seg.plane[k, j]] = spiral * turn * large
            bend[seg.plane[k, j]] = spiral * turn * turn * large
    elif kind == CIRCLE3D:
        three = seg.geo[k, WORK_POINT:]
        circle3d_tangent_bound(geo, three)
        for j in range(3):
            tangent[seg.plane[k, j]] = three[j]
            bend[seg.plane[k, j]] = three[j] / geo[CIRCLE3D_RADIUS]


@compiled
def _spline_bounds(
    splines: Splines | None, geo: Floats, length: float, tangent: Floats, bend: Floats
) -> None:
    if splines is not None:  # known when it is compiled
        begin = geo[SPLINE_FROM]
        spline_bounds_between(splines, int(geo[SPLINE_INDEX]), begin, begin + length, tangent, bend)


@compiled
def _gap_s(row: np.void, speed: float) -> float:
    """Return the shortest time that a segment takes when one of its ends is passed with `speed`."""
    length = row["length"]
    return float(2.0 * length / (speed + math.sqrt(speed * speed + 2.0 * row["full_accel"] * length)))


@compiled
def _fitting_square(allowed: float, change: float, row: np.void) -> float:
    """Return the square of the speed v at which v change = allowed times the shortest time of the segment."""
    step = 2.0 * allowed / change
    return float(step * step * row["length"] / (2.0 * (row["full_accel"] + step)))


@compiled
def limit_junction(
    seg: Segments, k: int, following: int, limits: AxisLimits, dt: float, work: Floats
) -> None:
    """Set `junction` and `share` at the end of segment `k`, which segment `following` continues."""
    row, after = seg.row[k], seg.row[following]
    row["junction"] = 0.0
    row["share"] = 0.0
    if row["flags"] & STOP or row["kind"] == WAIT or after["kind"] == WAIT:
        return
    segment_tangent(seg, k, 1.0, work[0])
    segment_tangent(seg, following, 0.0, work[1])
    curved = is_curved(seg, k) or is_curved(seg, following)
    most = CURVE_CORNER_SHARE if curved else CORNER_SHARE
    speed = min(row["cap"], after["cap"])
    square = speed * speed
    corner = False
    for i in range(work.shape[1]):
        change = abs(work[1, i] - work[0, i])
        if change <= STRAIGHT:
            work[0, i] = 0.0
            continue
        corner = True
        jump = limits.jump[i]
        allowed = (jump / dt if jump >= 0.0 else most * limits.acceleration[i]) / CORNER_MARGIN
        top = jump if jump >= 0.0 else allowed * dt
        # What share of its acceleration the axis needs per speed and time, for the second pass.
        work[0, i] = change / limits.acceleration[i] if jump < 0.0 else 0.0
        if allowed < math.inf:
            square = min(square, top * top / (change * change))
            square = min(square, _fitting_square(allowed, change, row))
            square = min(square, _fitting_square(allowed, change, after))
    if corner:
        speed = math.sqrt(square)
    row["junction"] = speed
    need = 0.0
    for i in range(work.shape[1]):
        need = max(need, work[0, i])
    if corner and need > 0.0 and speed > 0.0:
        row["share"] = CORNER_MARGIN * need * speed / min(dt, min(_gap_s(row, speed), _gap_s(after, speed)))


@compiled
def share_acceleration(seg: Segments, k: int, share_before: float, jerkrel: float) -> None:
    """Set `accel` of segment `k` to what the corners at its two ends leave; a curve has put their part aside.

    An S-shaped ramp has (1 + jerkrel) times its mean acceleration at its peak, so the mean is that much lower.
    """
    row = seg.row[k]
    left = 1.0 if is_curved(seg, k) else 1.0 - max(share_before, row["share"])
    row["accel"] = row["full_accel"] * left / (1.0 + jerkrel)


@compiled
def least_accel(row: np.void, jerkrel: float) -> float:
    """Return an acceleration that the segment will allow whatever comes behind it."""
    return float(row["full_accel"] * LEAST_PART / (1.0 + jerkrel))
