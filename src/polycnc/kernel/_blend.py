"""Round the corner between two lines with an arc, so that it can be passed with speed.

The arc touches both lines and stays within a tolerance of the corner. It takes at most half of the line before it and
half of the line after it, so every line keeps room for arcs at both ends. An infinite tolerance is a quarter of the
shorter line. Where coming to rest in the corner takes no longer than the arc, there is none.
"""

from __future__ import annotations

import math

import numpy as np

from polycnc.kernel._axis_limits import AxisLimits
from polycnc.kernel._circle3d import circle3d_point, circle3d_setup
from polycnc.kernel._corner_rules import BY_SHARE
from polycnc.kernel._jit import compiled
from polycnc.kernel._limits import CENTRIPETAL_SHARE
from polycnc.kernel._path import Paths, slot
from polycnc.kernel._segments import (
    CIRCLE3D,
    CIRCLE3D_LENGTH,
    CORNER_STOP,
    LINE,
    RAPID,
    ROUNDING,
    STOP,
    Floats,
    Segments,
    set_common,
)

SMALLEST_TURN = 1e-6  # rad; a smaller corner is passed as it is
LARGEST_TURN = math.radians(175.0)  # a reversal has no room for an arc
SMALLEST_ARC = 1e-6  # mm
FREE_SHARE = 0.25  # of the shorter line is the tolerance where none is set

# Columns of the scratch `paths.blend`.
_BEFORE, _AFTER, _START, _CENTER, _NORMAL = 0, 3, 6, 9, 12
_CUT, _CUT_LINE = 15, 16  # what the last arc took of the line behind it, mm, and which line that is


@compiled
def may_be_rounded(path: np.void, row: np.void) -> bool:
    """Tell whether a corner behind a segment may be rounded: it is a line, and at feed but for BY_SHARE."""
    stops = STOP | CORNER_STOP | (0 if path["corner_rule"] == BY_SHARE else RAPID)
    return bool(row["kind"] == LINE and not row["flags"] & stops)


@compiled
def blend_corner(
    seg: Segments, paths: Paths, g: int, limits: AxisLimits, end: Floats, speed_mm_s: float, tag: int
) -> bool:
    """Append an arc at the end of path `g` towards `end`, if its last segment is a line that may be rounded.

    Shortens that line; the arc goes on in the direction of `end`. Only where no axis moves but the first three
    that count in the path length.
    """
    row = paths.row[g]
    work = paths.blend[g]
    cut_before = work[_CUT] if work[_CUT_LINE] == row["tail"] - 1 else 0.0
    tolerance = row["tolerance_mm"]
    if tolerance <= 0.0 or row["tail"] <= row["prepared"]:  # what has been planned cannot be shortened
        return False
    k = slot(paths, g, row["tail"] - 1)
    line = seg.row[k]
    if not may_be_rounded(row, line) or math.isinf(speed_mm_s) != (line["flags"] & RAPID != 0):
        return False
    p, q, r = counting_axes(seg, k, limits, end)
    if p < 0:
        return False
    before, after = work[_BEFORE:_AFTER], work[_AFTER:_START]
    length_before = _direction(seg.start[k], seg.end[k], p, q, r, before)
    length_after = _direction(seg.end[k], end, p, q, r, after)
    if length_before <= 0.0 or length_after <= 0.0:
        return False
    cosine = before[0] * after[0] + before[1] * after[1] + before[2] * after[2]
    turn = math.atan2(_cross(before, after, work[_NORMAL:_CUT]), cosine)
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
        cut, speed = _cut_by_share(row, line, limits, (p, q, r), work, cut, turn, speed_mm_s)
    radius = cut / tangent
    if radius * turn < SMALLEST_ARC:
        return False
    if row["corner_rule"] != BY_SHARE and not _saves_time(
        line, limits, (p, q, r), work, cut, radius, turn, speed_mm_s
    ):
        return False
    if line["length"] - cut < row["rounding_gap_s"] * speed:
        line["flags"] |= ROUNDING
    work[_CUT], work[_CUT_LINE] = cut, row["tail"] + 1
    return _append_arc(seg, paths, g, k, (p, q, r), cut, radius, turn, speed_mm_s, tag)


@compiled
def _cut_by_share(
    path: np.void,
    line: np.void,
    limits: AxisLimits,
    axes: tuple[int, int, int],
    work: Floats,
    cut_mm: float,
    turn_rad: float,
    speed_mm_s: float,
) -> tuple[float, float]:
    """Return how much of both lines the arc of a path with BY_SHARE takes, up to `cut_mm`; 0 where it has none.

    It is as large as the speed needs that the largest would allow, and at least half as long as the ramps are that
    overlap in the corner with half the acceleration.
    """
    sine = math.sqrt(work[_NORMAL] ** 2 + work[_NORMAL + 1] ** 2 + work[_NORMAL + 2] ** 2)
    speed = min(line["feed_mm_s"], speed_mm_s)
    accel, accel_after, busiest = math.inf, math.inf, 0.0
    for j in range(3):
        allowed, most = limits.acceleration[axes[j]], limits.speed[axes[j]]
        u, w, normal = work[_BEFORE + j], work[_AFTER + j], work[_NORMAL + j] / sine
        if u != 0.0:
            speed = min(speed, most / abs(u))
        if w != 0.0:
            speed, accel_after = min(speed, most / abs(w)), min(accel_after, allowed / abs(w))
        busiest = max(busiest, abs(w - u) / allowed)
        in_plane = math.sqrt(max(0.0, 1.0 - normal * normal))  # of the axis; nothing turns along the others
        if in_plane > 0.0:
            accel = min(accel, allowed / in_plane)
            speed = min(speed, most / in_plane)
    if busiest * (speed / path["corner_cycle_s"] + accel_after) < path["corner_share"]:
        return 0.0, 0.0
    tangent = math.tan(0.5 * turn_rad)
    largest = cut_mm / tangent
    speed = min(speed, math.sqrt(CENTRIPETAL_SHARE * accel * largest))
    overlap_s = 2.0 * min(math.sqrt(accel * cut_mm), speed) / accel
    radius = max(speed * speed / (CENTRIPETAL_SHARE * accel), min(overlap_s * speed / turn_rad, largest))
    return min(cut_mm, radius * tangent), speed


@compiled
def _saves_time(
    line: np.void,
    limits: AxisLimits,
    axes: tuple[int, int, int],
    work: Floats,
    cut_mm: float,
    radius_mm: float,
    turn_rad: float,
    speed_mm_s: float,
) -> bool:
    """Tell whether the arc, gone along with the lower feed, is quicker than both lines with a rest between them."""
    before_mm_s, after_mm_s = line["feed_mm_s"], speed_mm_s
    accel_before, accel_after, accel = math.inf, math.inf, math.inf
    for j in range(3):
        allowed, speed = limits.acceleration[axes[j]], limits.speed[axes[j]]
        u, w = abs(work[_BEFORE + j]), abs(work[_AFTER + j])
        if u > 0.0:
            before_mm_s, accel_before = min(before_mm_s, speed / u), min(accel_before, allowed / u)
        if w > 0.0:
            after_mm_s, accel_after = min(after_mm_s, speed / w), min(accel_after, allowed / w)
        if u > 0.0 or w > 0.0:
            accel = min(accel, allowed)
    turning = min(before_mm_s, after_mm_s, math.sqrt(CENTRIPETAL_SHARE * accel * radius_mm))
    stopping = _stop_s(cut_mm, before_mm_s, accel_before) + _stop_s(cut_mm, after_mm_s, accel_after)
    rounding = radius_mm * turn_rad / turning
    slower, later = before_mm_s - turning, after_mm_s - turning
    rounding += slower * slower / (2.0 * accel_before * before_mm_s)
    rounding += later * later / (2.0 * accel_after * after_mm_s)
    return bool(rounding < stopping)


@compiled
def _stop_s(way_mm: float, speed_mm_s: float, accel_mm_s2: float) -> float:
    """Return the time that the last `way_mm` before a rest and what slowing down takes of the way before cost."""
    return float(way_mm / speed_mm_s + 0.5 * speed_mm_s / accel_mm_s2)


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
    before, after = work[_BEFORE:_AFTER], work[_AFTER:_START]
    start, center = work[_START:_CENTER], work[_CENTER:_NORMAL]
    corner = seg.end[k]
    start[0] = corner[p] - cut_mm * before[0]
    start[1] = corner[q] - cut_mm * before[1]
    start[2] = corner[r] - cut_mm * before[2]
    cosine, sine = math.cos(turn_rad), math.sin(turn_rad)
    for i in range(3):
        center[i] = start[i] + radius_mm * (after[i] - cosine * before[i]) / sine
    arc = slot(paths, g, paths.row[g]["tail"])
    geo = seg.geo[arc]
    if circle3d_setup(start, center, work[_NORMAL:_CUT], math.degrees(turn_rad), geo) != 0:
        return False
    line = seg.row[k]
    seg.end[k, p], seg.end[k, q], seg.end[k, r] = start[0], start[1], start[2]
    line["length"] -= cut_mm
    flags = ROUNDING | line["flags"] & RAPID
    set_common(seg, arc, seg.end[k], seg.end[k], min(speed_mm_s, line["feed_mm_s"]), flags, tag)
    circle3d_point(geo, 1.0, start)
    seg.end[arc, p], seg.end[arc, q], seg.end[arc, r] = start[0], start[1], start[2]
    seg.row[arc]["kind"] = CIRCLE3D
    seg.row[arc]["length"] = geo[CIRCLE3D_LENGTH]
    seg.plane[arc, 0], seg.plane[arc, 1], seg.plane[arc, 2] = p, q, r
    for i in range(corner.shape[0]):
        paths.queued[g, i] = seg.end[arc, i]
    paths.row[g]["tail"] += 1
    return True
