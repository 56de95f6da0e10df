"""How fast a segment and a junction may be taken so that no axis breaks its limits, cycle by cycle.

An axis has a speed and an acceleration limit and, optionally, a velocity step that it stands at a junction.
Without that step (`jump` < 0) a corner is taken so slowly that the change of velocity fits into the axis'
acceleration over one control cycle, or over the time of the shorter neighbour where segments are shorter than a
cycle's travel. What the corner uses up is taken from the tangential acceleration of the lines beside it, so that
the sum stays within the limit. On a curve the centripetal and the tangential part share what is left after the
corners' fixed part, as a circle where they are a quarter turn apart (arcs), as a sum elsewhere (splines).
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
    IN_PLANE,
    LINE,
    RADIUS_END,
    RADIUS_START,
    SPLINE,
    SPLINE_INDEX,
    STOP,
    WAIT,
    WORK_POINT,
    Floats,
    Segments,
)
from polycnc.kernel._spline import spline_curvature_bound, spline_tangent_bound

CORNER_SHARE = 0.5  # highest part of an axis' acceleration that a corner between lines may use
CURVE_CORNER_SHARE = 0.1  # the same beside a curve, which needs the rest for itself
CURVE_SHARE = 1.0 - CURVE_CORNER_SHARE
CENTRIPETAL_SHARE = 0.75  # highest part that the curvature of an arc may use
SPLINE_CENTRIPETAL_SHARE = 0.45
CORNER_MARGIN = 1.1  # several corners in one cycle do not sum up evenly; measured worst 1.09
STRAIGHT = 1e-13  # a smaller change of direction is rounding


class AxisLimits(NamedTuple):
    """Limits of n axes, and which of them count in the path length."""

    speed: Floats
    acceleration: Floats
    jump: Floats  # velocity step at a junction; negative: what the acceleration allows
    feed_axis: npt.NDArray[np.uint8]


def make_limits(axes: int) -> AxisLimits:
    """Allocate limits of `axes` axes: unlimited, all counting."""
    return AxisLimits(
        speed=np.full(axes, np.inf),
        acceleration=np.full(axes, np.inf),
        jump=np.full(axes, -1.0),
        feed_axis=np.ones(axes, np.uint8),
    )


@compiled
def limit_segment(
    seg: Segments, k: int, limits: AxisLimits, override: float, top: float, jerkrel: float, work: Floats
) -> None:
    """Set the caps and `full_accel` of segment `k`: feed times override, within what every axis allows.

    Curvature and corners take their part of the acceleration as at the highest override so far (`top`): when
    the override falls, the path is still faster than the new cap, and must keep the limits while it brakes.
    Peak acceleration of an S-shaped ramp is (1 + jerkrel) times the mean one, so the mean is lowered to keep
    the peak within the limit. `work` is scratch, [2, n].
    """
    kind = seg.row[k]["kind"]
    if kind == WAIT:
        seg.row[k]["full_cap"] = 0.0
        seg.row[k]["cap"] = 0.0
        seg.row[k]["full_accel"] = 1.0
        return
    cap = seg.row[k]["feed"] * top
    accel = math.inf
    if kind == LINE:
        for i in range(limits.speed.shape[0]):
            part = abs(seg.end[k, i] - seg.start[k, i]) / seg.row[k]["length"]
            if part > 0.0:
                cap = min(cap, limits.speed[i] / part)
                accel = min(accel, limits.acceleration[i] / part)
    else:
        cap, accel = _limit_curve(seg, k, limits, cap, work)
    seg.row[k]["full_cap"] = cap
    seg.row[k]["cap"] = min(cap, seg.row[k]["feed"] * override)
    seg.row[k]["full_accel"] = accel / (1.0 + jerkrel)


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
    kind = seg.row[k]["kind"]
    n = tangent.shape[0]
    if kind == SPLINE:
        index = int(seg.geo[k, SPLINE_INDEX])
        spline_tangent_bound(seg.splines, index, tangent)
        spline_curvature_bound(seg.splines, index, bend)
        return
    for i in range(n):
        tangent[i] = abs(seg.end[k, i] - seg.start[k, i]) / seg.row[k]["length"]
        bend[i] = 0.0
    if kind == ARC:
        geo = seg.geo[k]
        small = min(geo[RADIUS_START], geo[RADIUS_END])
        large = max(geo[RADIUS_START], geo[RADIUS_END])
        speed = geo[IN_PLANE] * large / (0.5 * (small + large))
        for j in range(2):
            tangent[seg.plane[k, j]] = speed
            bend[seg.plane[k, j]] = speed * speed / small
    elif kind == CIRCLE3D:
        three = seg.geo[k, WORK_POINT:]
        circle3d_tangent_bound(seg.geo[k], three)
        for j in range(3):
            tangent[seg.plane[k, j]] = three[j]
            bend[seg.plane[k, j]] = three[j] / seg.geo[k, CIRCLE3D_RADIUS]


@compiled
def limit_junction(
    seg: Segments, k: int, following: int, limits: AxisLimits, dt: float, work: Floats
) -> None:
    """Set `junction` and `share` at the end of segment `k`, which segment `following` continues."""
    if seg.row[k]["flags"] & STOP or seg.row[k]["kind"] == WAIT or seg.row[following]["kind"] == WAIT:
        seg.row[k]["junction"] = 0.0
        seg.row[k]["share"] = 0.0
        return
    before, after = work[0], work[1]
    segment_tangent(seg, k, True, before)
    segment_tangent(seg, following, False, after)
    curved = is_curved(seg, k) or is_curved(seg, following)
    budget = (CURVE_CORNER_SHARE if curved else CORNER_SHARE) / CORNER_MARGIN
    shorter = min(seg.row[k]["length"], seg.row[following]["length"])
    speed = min(seg.row[k]["full_cap"], seg.row[following]["full_cap"])
    for i in range(before.shape[0]):
        change = abs(after[i] - before[i])
        if change > STRAIGHT:
            if limits.jump[i] >= 0.0:
                speed = min(speed, limits.jump[i] / change)
            else:
                allowed = budget * limits.acceleration[i]
                speed = min(speed, allowed * dt / change, math.sqrt(allowed * shorter / change))
    share = 0.0
    if speed > 0.0:
        window = min(dt, shorter / speed)
        for i in range(before.shape[0]):
            change = abs(after[i] - before[i])
            if change > STRAIGHT and limits.jump[i] < 0.0:
                share = max(share, CORNER_MARGIN * speed * change / (limits.acceleration[i] * window))
    seg.row[k]["junction"] = min(speed, seg.row[k]["cap"], seg.row[following]["cap"])
    seg.row[k]["share"] = share


@compiled
def share_acceleration(seg: Segments, k: int, share_before: float, share_after: float) -> None:
    """Set `accel` of segment `k` to what the corners at its two ends leave; a curve has put their part aside."""
    left = 1.0 if is_curved(seg, k) else 1.0 - max(share_before, share_after)
    seg.row[k]["accel"] = seg.row[k]["full_accel"] * left
