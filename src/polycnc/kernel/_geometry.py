"""Where a segment is, and which way it goes, at a path length.

The ends are exact: at the full length every segment gives its stored end point, bit for bit.
"""

from __future__ import annotations

import math

from polycnc.kernel._circle3d import circle3d_point, circle3d_tangent
from polycnc.kernel._jit import allocating, compiled, entry
from polycnc.kernel._segments import (
    ANGLE_START,
    ARC,
    CENTER_P,
    CENTER_Q,
    CIRCLE3D,
    LINE,
    RADIUS_END,
    RADIUS_START,
    SPLINE,
    SPLINE_INDEX,
    SWEEP,
    WAIT,
    WORK_POINT,
    Floats,
    Segments,
)
from polycnc.kernel._spline import spline_point, spline_tangent

HALF_PI = 0.5 * math.pi


@entry
def segment_point(seg: Segments, k: int, s: float, out: Floats) -> None:
    """Write the point of segment `k` at path length `s` to `out[n]`."""
    n = out.shape[0]
    length = seg.row[k]["length"]
    kind = seg.row[k]["kind"]
    if s >= length or kind == WAIT:
        for i in range(n):
            out[i] = seg.end[k, i]
        return
    fraction = s / length
    if kind == SPLINE:
        spline_point(seg.splines, int(seg.geo[k, SPLINE_INDEX]), s, out)
        return
    for i in range(n):
        out[i] = seg.start[k, i] + (seg.end[k, i] - seg.start[k, i]) * fraction
    if kind == ARC and s > 0.0:
        geo = seg.geo[k]
        radius = geo[RADIUS_START] + (geo[RADIUS_END] - geo[RADIUS_START]) * fraction
        angle = geo[ANGLE_START] + geo[SWEEP] * fraction
        out[seg.plane[k, 0]] = geo[CENTER_P] + radius * math.cos(angle)
        out[seg.plane[k, 1]] = geo[CENTER_Q] + radius * math.sin(angle)
    elif kind == CIRCLE3D and s > 0.0:
        three = seg.geo[k, WORK_POINT:]
        circle3d_point(seg.geo[k], fraction, three)
        out[seg.plane[k, 0]], out[seg.plane[k, 1]], out[seg.plane[k, 2]] = three[0], three[1], three[2]


@compiled
def segment_tangent(seg: Segments, k: int, at_end: bool, out: Floats) -> None:
    """Write d(position)/ds of segment `k` at its start or end to `out[n]`."""
    n = out.shape[0]
    kind = seg.row[k]["kind"]
    length = seg.row[k]["length"]
    if kind == WAIT:
        for i in range(n):
            out[i] = 0.0
        return
    if kind == SPLINE:
        spline_tangent(seg.splines, int(seg.geo[k, SPLINE_INDEX]), length if at_end else 0.0, out)
        return
    for i in range(n):
        out[i] = (seg.end[k, i] - seg.start[k, i]) / length
    if kind == ARC:
        geo = seg.geo[k]
        angle = geo[ANGLE_START]
        radius = geo[RADIUS_START]
        if at_end:
            angle += geo[SWEEP]
            radius = geo[RADIUS_END]
        turn = geo[SWEEP] / length
        shrink = (geo[RADIUS_END] - geo[RADIUS_START]) / length
        cos, sin = math.cos(angle), math.sin(angle)
        out[seg.plane[k, 0]] = shrink * cos - radius * turn * sin
        out[seg.plane[k, 1]] = shrink * sin + radius * turn * cos
    elif kind == CIRCLE3D:
        three = seg.geo[k, WORK_POINT:]
        circle3d_tangent(seg.geo[k], 1.0 if at_end else 0.0, three)
        out[seg.plane[k, 0]], out[seg.plane[k, 1]], out[seg.plane[k, 2]] = three[0], three[1], three[2]


@allocating
def grow_extents(seg: Segments, k: int, low: Floats, high: Floats) -> None:
    """Widen the box `low[n]`, `high[n]` to hold segment `k`, with the quadrant points of an arc."""
    n = low.shape[0]
    for i in range(n):
        low[i] = min(low[i], seg.start[k, i], seg.end[k, i])
        high[i] = max(high[i], seg.start[k, i], seg.end[k, i])
    kind = seg.row[k]["kind"]
    if kind == ARC:
        _grow_by_quadrants(seg, k, low, high)
    elif kind in (SPLINE, CIRCLE3D):
        # No closed form worth its lines: 64 points are within 0.1 % of a turn's radius.
        _grow_by_points(seg, k, low, high)


@compiled
def _grow_by_quadrants(seg: Segments, k: int, low: Floats, high: Floats) -> None:
    geo = seg.geo[k]
    first = min(geo[ANGLE_START], geo[ANGLE_START] + geo[SWEEP])
    last = max(geo[ANGLE_START], geo[ANGLE_START] + geo[SWEEP])
    radius = max(geo[RADIUS_START], geo[RADIUS_END])
    quadrant = math.ceil(first / HALF_PI)
    for _ in range(4):
        if quadrant * HALF_PI > last:
            break
        which = int(quadrant) % 4
        axis = seg.plane[k, which % 2]
        center = geo[CENTER_P] if which % 2 == 0 else geo[CENTER_Q]
        if which < 2:
            high[axis] = max(high[axis], center + radius)
        else:
            low[axis] = min(low[axis], center - radius)
        quadrant += 1


@allocating
def _grow_by_points(seg: Segments, k: int, low: Floats, high: Floats) -> None:
    point = low.copy()
    for step in range(1, 64):
        segment_point(seg, k, seg.row[k]["length"] * step / 64.0, point)
        for i in range(low.shape[0]):
            low[i] = min(low[i], point[i])
            high[i] = max(high[i], point[i])


@compiled
def is_curved(seg: Segments, k: int) -> bool:
    """Tell whether the direction of segment `k` changes along it."""
    return bool(seg.row[k]["kind"] != LINE and seg.row[k]["kind"] != WAIT)
