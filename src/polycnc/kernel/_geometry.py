"""Where a segment is, and which way it goes, at a path length.

The ends are exact: at the full length every segment gives its stored end point, bit for bit.
"""

from __future__ import annotations

import math

from polycnc.kernel._bezier import bezier_point, bezier_tangent
from polycnc.kernel._circle3d import circle3d_point, circle3d_tangent
from polycnc.kernel._cubic import cubic_slope, cubic_way
from polycnc.kernel._jit import compiled
from polycnc.kernel._segments import (
    ARC,
    CENTER_P,
    CENTER_Q,
    CIRCLE3D,
    LINE,
    OVERLAP,
    RADIUS_END,
    RADIUS_START,
    SPLINE,
    SWEEP_RAD,
    WAIT,
    WORK_POINT,
    Floats,
    Segments,
)

HALF_PI = 0.5 * math.pi


@compiled
def segment_point(seg: Segments, k: int, s: float, out: Floats) -> None:
    """Write the point of segment `k` at path length `s` to `out[n]`."""
    row = seg.row[k]
    kind = row["kind"]
    if s >= row["length"] or kind == WAIT:
        for i in range(out.shape[0]):
            out[i] = seg.end[k, i]
        return
    fraction = s / row["length"]
    for i in range(out.shape[0]):
        out[i] = seg.start[k, i] + (seg.end[k, i] - seg.start[k, i]) * fraction
    if kind == SPLINE:
        p, q = seg.plane[k, 0], seg.plane[k, 1]
        start_p, start_q = seg.start[k, p], seg.start[k, q]
        way_p, way_q = bezier_point(seg.geo[k], seg.end[k, p] - start_p, seg.end[k, q] - start_q, fraction)
        out[p], out[q] = start_p + way_p, start_q + way_q
    if kind == OVERLAP:
        for j in range(3):
            i = seg.plane[k, j]
            out[i] = seg.start[k, i] + cubic_way(seg.geo[k], j, seg.end[k, i] - seg.start[k, i], fraction)
    if kind in (ARC, CIRCLE3D):
        three = seg.geo[k, WORK_POINT:]
        if kind == ARC:
            _arc_point(seg, k, fraction, three)
            out[seg.plane[k, 0]], out[seg.plane[k, 1]] = three[0], three[1]
        else:
            circle3d_point(seg.geo[k], fraction, three)
            for j in range(3):
                out[seg.plane[k, j]] = three[j]


@compiled
def _arc_point(seg: Segments, k: int, fraction: float, out: Floats) -> None:
    """Write both plane coordinates to `out[0:2]`.

    The radius vector of the start is turned and stretched; the change is added to the start, so nothing cancels.
    """
    p, q = seg.plane[k, 0], seg.plane[k, 1]
    geo = seg.geo[k]
    half = 0.5 * geo[SWEEP_RAD] * fraction
    sine, cosine = math.sin(half), math.cos(half)
    scale = 1.0 + (geo[RADIUS_END] / geo[RADIUS_START] - 1.0) * fraction
    along = (scale - 1.0) - 2.0 * scale * sine * sine
    across = 2.0 * scale * sine * cosine
    start_p, start_q = seg.start[k, p], seg.start[k, q]
    radius_p, radius_q = start_p - geo[CENTER_P], start_q - geo[CENTER_Q]
    out[0] = start_p + (along * radius_p - across * radius_q)
    out[1] = start_q + (along * radius_q + across * radius_p)


@compiled
def segment_coordinate(seg: Segments, k: int, i: int, s: float) -> float:
    """Return coordinate `i` of segment `k` (no free curve) at path length `s`, which may lie beyond its ends."""
    row = seg.row[k]
    start, end = seg.start[k, i], seg.end[k, i]
    if s == row["length"] or row["length"] <= 0.0:
        return float(end)
    fraction = s / row["length"]
    kind = row["kind"]
    if kind == ARC and (seg.plane[k, 0] == i or seg.plane[k, 1] == i):
        _arc_point(seg, k, fraction, seg.geo[k, WORK_POINT:])
        return float(seg.geo[k, WORK_POINT + (0 if seg.plane[k, 0] == i else 1)])
    if kind == CIRCLE3D:
        three = seg.geo[k, WORK_POINT:]
        for j in range(3):
            if seg.plane[k, j] == i:
                circle3d_point(seg.geo[k], fraction, three)
                return float(three[j])
    return float(start + (end - start) * fraction)


@compiled
def segment_slope(seg: Segments, k: int, i: int, s: float) -> float:
    """Return d(coordinate `i`)/ds of segment `k` (no free curve) at path length `s`, which may lie beyond its ends."""
    row = seg.row[k]
    length = row["length"]
    if length <= 0.0:
        return 0.0
    kind = row["kind"]
    geo = seg.geo[k]
    if kind == ARC and (seg.plane[k, 0] == i or seg.plane[k, 1] == i):
        three = seg.geo[k, WORK_POINT:]
        _arc_point(seg, k, s / length, three)
        at_p, at_q = three[0] - geo[CENTER_P], three[1] - geo[CENTER_Q]
        stretch = (geo[RADIUS_END] - geo[RADIUS_START]) / (length * math.sqrt(at_p * at_p + at_q * at_q))
        turn = geo[SWEEP_RAD] / length
        return float(stretch * at_p - turn * at_q if seg.plane[k, 0] == i else stretch * at_q + turn * at_p)
    if kind == CIRCLE3D:
        three = seg.geo[k, WORK_POINT:]
        for j in range(3):
            if seg.plane[k, j] == i:
                circle3d_tangent(geo, s / length, three)
                return float(three[j])
    return float((seg.end[k, i] - seg.start[k, i]) / length)


@compiled
def segment_tangent(seg: Segments, k: int, at: float, out: Floats) -> None:
    """Write d(position)/ds of segment `k` at its start (`at` 0) or its end (1) to `out[n]`; a wait has none."""
    row = seg.row[k]
    kind = row["kind"]
    length = row["length"]
    for i in range(out.shape[0]):
        out[i] = (seg.end[k, i] - seg.start[k, i]) / length
    if kind == ARC:
        p, q = seg.plane[k, 0], seg.plane[k, 1]
        geo = seg.geo[k]
        radius = geo[RADIUS_END] if at > 0.0 else geo[RADIUS_START]
        at_p = (seg.end[k, p] if at > 0.0 else seg.start[k, p]) - geo[CENTER_P]
        at_q = (seg.end[k, q] if at > 0.0 else seg.start[k, q]) - geo[CENTER_Q]
        turn = geo[SWEEP_RAD] / length
        stretch = (geo[RADIUS_END] - geo[RADIUS_START]) / (length * radius)
        out[p] = stretch * at_p - turn * at_q
        out[q] = stretch * at_q + turn * at_p
    elif kind == SPLINE:
        p, q = seg.plane[k, 0], seg.plane[k, 1]
        way_p, way_q = seg.end[k, p] - seg.start[k, p], seg.end[k, q] - seg.start[k, q]
        out[p], out[q] = bezier_tangent(seg.geo[k], way_p, way_q, at)
    elif kind == OVERLAP:
        for j in range(3):
            i = seg.plane[k, j]
            out[i] = cubic_slope(seg.geo[k], j, seg.end[k, i] - seg.start[k, i], at) / length
    elif kind == CIRCLE3D:
        three = seg.geo[k, WORK_POINT:]
        circle3d_tangent(seg.geo[k], at, three)
        for j in range(3):
            out[seg.plane[k, j]] = three[j]


@compiled
def grow_extents(seg: Segments, k: int, low: Floats, high: Floats, work: Floats) -> None:
    """Widen the box `low[n]`, `high[n]` to hold segment `k`, with the quadrant points of an arc.

    `work[n]` is scratch. Other curves are sampled: 64 points are within 0.1 % of a turn's radius.
    """
    for i in range(low.shape[0]):
        low[i] = min(low[i], seg.start[k, i], seg.end[k, i])
        high[i] = max(high[i], seg.start[k, i], seg.end[k, i])
    kind = seg.row[k]["kind"]
    if kind == ARC:
        _grow_by_quadrants(seg, k, low, high)
    elif kind in (SPLINE, CIRCLE3D, OVERLAP):
        for step in range(1, 64):
            segment_point(seg, k, seg.row[k]["length"] * step / 64.0, work)
            for i in range(low.shape[0]):
                low[i] = min(low[i], work[i])
                high[i] = max(high[i], work[i])


@compiled
def _grow_by_quadrants(seg: Segments, k: int, low: Floats, high: Floats) -> None:
    p, q = seg.plane[k, 0], seg.plane[k, 1]
    geo = seg.geo[k]
    begin = math.atan2(seg.start[k, q] - geo[CENTER_Q], seg.start[k, p] - geo[CENTER_P])
    first = min(begin, begin + geo[SWEEP_RAD])
    last = max(begin, begin + geo[SWEEP_RAD])
    radius = max(geo[RADIUS_START], geo[RADIUS_END])
    quadrant = math.ceil(first / HALF_PI)
    for _ in range(4):
        if quadrant * HALF_PI > last:
            break
        which = int(quadrant) % 4
        axis = p if which % 2 == 0 else q
        center = geo[CENTER_P] if which % 2 == 0 else geo[CENTER_Q]
        if which < 2:
            high[axis] = max(high[axis], center + radius)
        else:
            low[axis] = min(low[axis], center - radius)
        quadrant += 1


@compiled
def is_curved(seg: Segments, k: int) -> bool:
    """Tell whether the direction of segment `k` changes along it."""
    kind = seg.row[k]["kind"]
    return bool(kind != LINE and kind != WAIT)
