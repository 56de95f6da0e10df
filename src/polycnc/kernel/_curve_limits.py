"""What axes allow along curves, and what is left to ramps there; `_limits` has lines and corners.

Units: those of `_segments` along the path; an axis' limits in its own unit (mm or deg) per s and s2.
"""

from __future__ import annotations

import math

import numpy as np

from polycnc.kernel._axis_limits import AxisLimits
from polycnc.kernel._bezier import BEND_BOUND, TANGENT_BOUND
from polycnc.kernel._circle3d import circle3d_tangent_bound
from polycnc.kernel._cubic import ENTRY, cubic_bounds
from polycnc.kernel._jit import compiled
from polycnc.kernel._segments import (
    ARC,
    CIRCLE3D,
    CIRCLE3D_RADIUS,
    LAST,
    OVERLAP,
    OVERLAPS,
    RADIUS_END,
    RADIUS_START,
    RISE,
    ROUNDING,
    SPLINE,
    SWEEP_RAD,
    WORK_POINT,
    Floats,
    Segments,
)

CENTRIPETAL_SHARE = math.sqrt(0.75)  # highest part that the curvature of an arc may use
OVERLAP_SHARE = 0.5  # of its acceleration has a segment that overlaps with another
OVERLAP_BEND_SHARE = 0.95  # of an axis' acceleration may be what an OVERLAP changes its speed by
# Of what it could has a free OVERLAP, whose speed goes evenly from that of one motion to the other.
EVENLY = 0.05
BRAKED_PART = 0.5  # of its speed at its start, above which an OVERLAP that gets faster is gone through
LAST_ARC_SHARE = 0.5  # of its acceleration has an arc that may go on, as if turning took CENTRIPETAL_SHARE


@compiled
def adds_up(row: np.void) -> bool:
    """Tell whether turning and ramps of a segment may need an axis at once, not a quarter turn apart as on circles."""
    return bool(row["kind"] == SPLINE or row["kind"] == OVERLAP)


@compiled
def curve_bounds(seg: Segments, k: int, tangent: Floats, bend: Floats) -> None:
    """Write the greatest |dp/ds| and |d2p/ds2| of every axis over curve `k`."""
    row, geo = seg.row[k], seg.geo[k]
    kind = row["kind"]
    for i in range(tangent.shape[0]):
        tangent[i] = abs(seg.end[k, i] - seg.start[k, i]) / row["length"]
        bend[i] = 0.0
    if kind == ARC:
        small = min(geo[RADIUS_START], geo[RADIUS_END])
        large = max(geo[RADIUS_START], geo[RADIUS_END])
        turn = abs(geo[SWEEP_RAD]) / row["length"]
        # A changing radius adds a part along the radius, and as much again across it by turning.
        spiral = 1.0 + 2.0 * (large - small) / (abs(geo[SWEEP_RAD]) * small)
        for j in range(2):
            tangent[seg.plane[k, j]] = spiral * turn * large
            bend[seg.plane[k, j]] = spiral * turn * turn * large
    elif kind == SPLINE:
        for j in range(2):
            tangent[seg.plane[k, j]] = geo[TANGENT_BOUND + j]
            bend[seg.plane[k, j]] = geo[BEND_BOUND + j]
    elif kind == CIRCLE3D:
        three = seg.geo[k, WORK_POINT:]
        circle3d_tangent_bound(geo, three)
        for j in range(3):
            tangent[seg.plane[k, j]] = three[j]
            bend[seg.plane[k, j]] = three[j] / geo[CIRCLE3D_RADIUS]
    elif kind == OVERLAP:
        for j in range(3):
            i = seg.plane[k, j]
            way = seg.end[k, i] - seg.start[k, i]
            tangent[i], _, bend[i], _ = cubic_bounds(geo, j, way, row["length"])


@compiled
def axes_allow(
    seg: Segments, k: int, limits: AxisLimits, path: np.void, tangent: Floats, bend: Floats
) -> tuple[float, float]:
    """Return the speed of a line or arc that its axes allow whatever the feed, and the acceleration along it alone."""
    curve_bounds(seg, k, tangent, bend)
    return _axes_allow(limits, path, tangent, bend)


@compiled
def _axes_allow(limits: AxisLimits, path: np.void, tangent: Floats, bend: Floats) -> tuple[float, float]:
    whole = path["accel_limit_mm_s2"]
    top, accel = math.inf, float(whole)
    for i in range(tangent.shape[0]):
        allowed = min(limits.acceleration[i], whole)
        if tangent[i] > 0.0:
            top = min(top, limits.speed[i] / tangent[i])
            accel = min(accel, allowed / tangent[i])
        if bend[i] > 0.0:
            top = min(top, math.sqrt(CENTRIPETAL_SHARE * allowed / bend[i]))
    return top, accel


@compiled
def limit_arc_by_share(
    seg: Segments,
    k: int,
    limits: AxisLimits,
    path: np.void,
    asked_mm_s: float,
    tangent: Floats,
    bend: Floats,
) -> tuple[float, float]:
    """Return speed cap and tangential acceleration of an arc or helix on a path with BY_SHARE.

    Its ramps have what turning leaves at the speed of its axes, whatever the feed. How much turning takes is found as
    if the whole rise of a helix made its radius larger; what the axes really have left at its cap bounds that.
    """
    geo, whole = seg.geo[k], path["accel_limit_mm_s2"]
    top, accel = _axes_allow(limits, path, tangent, bend)
    if seg.row[k]["flags"] & OVERLAPS:
        accel *= OVERLAP_SHARE
    radius = _radius_by_rise(geo)
    turns_at = min(top, math.sqrt(CENTRIPETAL_SHARE * accel * radius))
    turning = turns_at * turns_at / (radius * accel)
    left = math.sqrt(1.0 - turning * turning)
    if seg.row[k]["flags"] & LAST:
        left = min(left, LAST_ARC_SHARE)
    else:
        top = turns_at
    accel *= left
    cap = min(asked_mm_s, path["speed_limit_mm_s"], top)
    for i in range(tangent.shape[0]):
        if bend[i] > 0.0:
            allowed = min(limits.acceleration[i], whole)
            used = cap * cap * bend[i] / allowed
            accel = min(accel, math.sqrt(1.0 - used * used) * allowed / tangent[i])
    return cap, accel


@compiled
def _radius_by_rise(geo: Floats) -> float:
    """Return the radius of an arc, made larger by the whole rise of a helix."""
    radius = min(geo[RADIUS_START], geo[RADIUS_END])
    return float(radius + geo[RISE] * geo[RISE] / radius)


@compiled
def keep_turning(seg: Segments, k: int, limits: AxisLimits, path: np.void, work: Floats, kept: float) -> None:
    """Lower the cap of an arc on a path with BY_SHARE so that turning leaves its corner its part; `work`: scratch."""
    row = seg.row[k]
    if row["kind"] == ARC and not row["flags"] & (ROUNDING | LAST):
        top, accel = axes_allow(seg, k, limits, path, work[0], work[1])
        if row["flags"] & OVERLAPS:
            accel *= OVERLAP_SHARE
        accel *= 1.0 - kept
        radius = _radius_by_rise(seg.geo[k])
        top = min(top, math.sqrt(CENTRIPETAL_SHARE * accel * radius))
        turning = top * top / (radius * accel)
        row["cap"] = min(row["cap"], top)
        left = math.sqrt(1.0 - turning * turning) * accel / (1.0 - kept)  # `kept` is taken of it later
        row["full_accel"] = min(row["full_accel"], left)


@compiled
def limit_overlap(
    seg: Segments,
    k: int,
    limits: AxisLimits,
    path: np.void,
    asked_mm_s: float,
    tangent: Floats,
    bend: Floats,
) -> tuple[float, float]:
    """Return the highest speed in an OVERLAP, which is that at its faster end, and its acceleration.

    The acceleration takes the path from the speed of one end to that of the other. No override makes it faster than its
    motions were found with, and none changes the acceleration.
    """
    geo, length = seg.geo[k], seg.row[k]["length"]
    entry = geo[ENTRY]
    faster = max(entry, 1.0 - entry)
    even = abs(1.0 - 2.0 * entry) / (2.0 * faster * faster * length)  # acceleration per squared speed
    whole = path["accel_limit_mm_s2"]
    square = min(seg.row[k]["feed_mm_s"], path["speed_limit_mm_s"]) ** 2
    for i in range(tangent.shape[0]):
        bend[i], tangent[i] = 0.0, 0.0
    for j in range(3):
        i = seg.plane[k, j]
        tangent[i], turned, steady, bend[i] = cubic_bounds(geo, j, seg.end[k, i] - seg.start[k, i], length)
        if tangent[i] > 0.0:
            square = min(square, (limits.speed[i] / tangent[i]) ** 2)
            used = axis_use(turned, steady, tangent[i] * even, entry)
            square = min(square, OVERLAP_BEND_SHARE * min(limits.acceleration[i], whole) / used)
    accel = math.inf
    for i in range(tangent.shape[0]):
        if tangent[i] > 0.0:
            accel = min(accel, (min(limits.acceleration[i], whole) - square * bend[i]) / tangent[i])
    if path["free_overlaps"] != 0:
        accel *= EVENLY
    return min(asked_mm_s, math.sqrt(square)), max(accel, square * even)


@compiled
def axis_use(turned: float, steady: float, along: float, entry: float) -> float:
    """Return the most that an axis accelerates by in an OVERLAP, however it is traversed.

    `turned` where the path speed goes evenly from one end to the other, `steady` where it stays as high as it then is,
    and `along` by a ramp alone. One that gets faster is braked in below BRAKED_PART of its speed only (`_plan_from`).
    One that gets slower may be entered slower than it could; whoever then speeds up first meets the ramp down while the
    speed there is above 1 / sqrt(2) of the highest, where the axis turns with less.
    """
    slower = min(entry, 1.0 - entry) / max(entry, 1.0 - entry)
    part = BRAKED_PART * BRAKED_PART if entry < 0.5 else min(1.0, math.sqrt(2.0) * slower)
    return max(turned, steady, part * steady + along)


@compiled
def speed_at_end(seg: Segments, k: int, at: float) -> float:
    """Return the highest speed at the start of segment `k` (`at` 0) or at its end (1)."""
    row = seg.row[k]
    if row["kind"] != OVERLAP:
        return float(row["cap"])
    entry = seg.geo[k, ENTRY]
    return float(row["cap"] * (1.0 - entry if at > 0.0 else entry) / max(entry, 1.0 - entry))


@compiled
def gets_faster(row: np.void, geo: Floats) -> bool:
    """Tell whether a segment is an OVERLAP whose end is faster than its start."""
    return bool(row["kind"] == OVERLAP and geo[ENTRY] < 0.5)


@compiled
def goes_through(row: np.void, geo: Floats, speed_mm_s: float) -> bool:
    """Tell whether a path that has this speed in a segment may not brake in it."""
    if not gets_faster(row, geo):
        return False
    return bool(speed_mm_s > BRAKED_PART * row["feed_mm_s"] * geo[ENTRY] / (1.0 - geo[ENTRY]))
