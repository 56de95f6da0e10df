"""Round the corner between two lines with an arc, so that it can be passed with speed; `_blend_arcs` has those of arcs.

The arc touches both lines and stays within a tolerance of the corner. It takes at most half of the line before it and
half of the line after it, so every line keeps room for arcs at both ends. An infinite tolerance is a quarter of the
shorter line. Where coming to rest in the corner takes no longer than the arc, there is none.
"""

from __future__ import annotations

import math

from polycnc.kernel._axis_limits import AxisLimits
from polycnc.kernel._blend_arcs import (
    FREE_SHARE,
    LARGEST_TURN,
    SMALLEST_ARC,
    SMALLEST_TURN,
    may_be_rounded,
    round_to_line,
)
from polycnc.kernel._blend_speed import (
    AFTER,
    BEFORE,
    CENTER,
    CUT,
    CUT_LINE,
    NORMAL,
    START,
    cut_by_share,
    feed_along,
    saves_time,
)
from polycnc.kernel._circle3d import circle3d_point, circle3d_setup
from polycnc.kernel._corner_rules import BY_SHARE
from polycnc.kernel._jit import apart, compiled
from polycnc.kernel._path import Paths, slot
from polycnc.kernel._segments import (
    ARC,
    CIRCLE3D,
    CIRCLE3D_LENGTH,
    OVERLAPS,
    RAPID,
    ROUNDING,
    WITH_SPINDLE,
    Floats,
    Segments,
    set_common,
)


@apart
@compiled
def blend_corner(
    seg: Segments, paths: Paths, g: int, limits: AxisLimits, end: Floats, speed_mm_s: float, tag: int
) -> bool:
    """Append an arc at the end of path `g` towards `end`, if its last segment is one that may be rounded.

    Shortens that segment; the arc goes on in the direction of `end`. Only where no axis moves but the first three
    that count in the path length.
    """
    row = paths.row[g]
    work = paths.blend[g]
    cut_before = work[CUT] if work[CUT_LINE] == row["tail"] - 1 else 0.0
    tolerance = row["tolerance_mm"]
    if tolerance <= 0.0 or row["tail"] <= row["prepared"]:  # what has been planned cannot be shortened
        return False
    k = slot(paths, g, row["tail"] - 1)
    line = seg.row[k]
    if not may_be_rounded(row, line) or math.isinf(speed_mm_s) != (line["flags"] & RAPID != 0):
        return False
    if line["kind"] == ARC:
        return round_to_line(seg, paths, g, limits, end, speed_mm_s, tag)
    p, q, r = counting_axes(seg, k, limits, end)
    if p < 0:
        return False
    before, after = work[BEFORE:AFTER], work[AFTER:START]
    length_before = _direction(seg.start[k], seg.end[k], p, q, r, before)
    length_after = _direction(seg.end[k], end, p, q, r, after)
    if length_before <= 0.0 or length_after <= 0.0:
        return False
    cosine = before[0] * after[0] + before[1] * after[1] + before[2] * after[2]
    turn = math.atan2(_cross(before, after, work[NORMAL:CUT]), cosine)
    if turn < SMALLEST_TURN or turn > LARGEST_TURN:
        return False
    length_before += cut_before
    if math.isinf(tolerance):
        tolerance = FREE_SHARE * min(length_before, length_after)
    elif row["corner_rule"] == BY_SHARE:
        tolerance = min(tolerance, FREE_SHARE * min(length_before, length_after))
    tangent = math.tan(0.5 * turn)
    quarter = math.sin(0.25 * turn)
    # Along the lines: what the tolerance allows, radius (1 / cos(turn / 2) - 1), within the room there is.
    cut = tolerance * math.sin(0.5 * turn) / (2.0 * quarter * quarter)
    cut = min(cut, 0.5 * length_before, 0.5 * length_after, line["length"] - SMALLEST_ARC)
    speed = 0.0
    if row["corner_rule"] == BY_SHARE:
        cut, speed = cut_by_share(row, line, limits, (p, q, r), work, cut, turn, speed_mm_s, 1.0)
    radius = cut / tangent
    if radius * turn < SMALLEST_ARC:
        return False
    if row["corner_rule"] != BY_SHARE and not saves_time(
        line, limits, (p, q, r), work, cut, radius, turn, speed_mm_s
    ):
        return False
    if line["length"] - cut < row["rounding_gap_s"] * speed and not line["flags"] & OVERLAPS:
        line["flags"] |= ROUNDING
    work[CUT], work[CUT_LINE] = cut, row["tail"] + 1
    return _append_arc(seg, paths, g, k, (p, q, r), cut, radius, turn, speed_mm_s, tag)


@compiled
def counting_axes(seg: Segments, k: int, limits: AxisLimits, end: Floats) -> tuple[int, int, int]:
    """Return the first three axes that count; -1 where another moves on line `k` or to `end`, or there are fewer."""
    found = 0
    p, q, r = -1, -1, -1
    for i in range(end.shape[0]):
        if limits.feed_axis[i] != 0 and found < 3:
            if found == 0:
                p = i
            elif found == 1:
                q = i
            else:
                r = i
            found += 1
        elif seg.start[k, i] != seg.end[k, i] or end[i] != seg.end[k, i]:
            return -1, -1, -1
    if found < 3:
        return -1, -1, -1
    return p, q, r


@compiled
def _direction(start: Floats, end: Floats, p: int, q: int, r: int, out: Floats) -> float:
    """Write the unit vector from `start` to `end` to `out[3]` and return the distance."""
    out[0], out[1], out[2] = end[p] - start[p], end[q] - start[q], end[r] - start[r]
    length = math.sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2])
    if length > 0.0:
        for i in range(3):
            out[i] /= length
    return length


@compiled
def _cross(a: Floats, b: Floats, out: Floats) -> float:
    """Write a x b to `out[3]` and return its length."""
    out[0] = a[1] * b[2] - a[2] * b[1]
    out[1] = a[2] * b[0] - a[0] * b[2]
    out[2] = a[0] * b[1] - a[1] * b[0]
    return math.sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2])


@compiled
def _append_arc(
    seg: Segments,
    paths: Paths,
    g: int,
    k: int,
    axes: tuple[int, int, int],
    cut_mm: float,
    radius_mm: float,
    turn_rad: float,
    speed_mm_s: float,
    tag: int,
) -> bool:
    """Shorten line `k` by `cut_mm` and append the arc of `radius_mm` through `turn_rad` that touches it there."""
    p, q, r = axes
    work = paths.blend[g]
    before, after = work[BEFORE:AFTER], work[AFTER:START]
    start, center = work[START:CENTER], work[CENTER:NORMAL]
    corner = seg.end[k]
    start[0] = corner[p] - cut_mm * before[0]
    start[1] = corner[q] - cut_mm * before[1]
    start[2] = corner[r] - cut_mm * before[2]
    cosine, sine = math.cos(turn_rad), math.sin(turn_rad)
    for i in range(3):
        center[i] = start[i] + radius_mm * (after[i] - cosine * before[i]) / sine
    arc = slot(paths, g, paths.row[g]["tail"])
    geo = seg.geo[arc]
    if circle3d_setup(start, center, work[NORMAL:CUT], math.degrees(turn_rad), geo) != 0:
        return False
    line = seg.row[k]
    seg.end[k, p], seg.end[k, q], seg.end[k, r] = start[0], start[1], start[2]
    line["length"] -= cut_mm
    flags = ROUNDING | line["flags"] & (RAPID | WITH_SPINDLE)
    feed = feed_along(paths.row[g], line["feed_mm_s"], speed_mm_s)
    set_common(seg, arc, seg.end[k], seg.end[k], feed, flags, tag)
    circle3d_point(geo, 1.0, start)
    seg.end[arc, p], seg.end[arc, q], seg.end[arc, r] = start[0], start[1], start[2]
    seg.row[arc]["kind"] = CIRCLE3D
    seg.row[arc]["length"] = geo[CIRCLE3D_LENGTH]
    seg.plane[arc, 0], seg.plane[arc, 1], seg.plane[arc, 2] = p, q, r
    for i in range(corner.shape[0]):
        paths.queued[g, i] = seg.end[arc, i]
    paths.row[g]["tail"] += 1
    return True
