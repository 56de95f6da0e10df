"""Append arcs that bend by less than the merging distance as two lines, which merge with what is beside them.

That is how LinuxCNC takes them, in the plane of the first two axes. The points that the merged line has to stay near
are corners of a line that runs round the arc outside of it, so no point of the arc lies farther off than the distance.
"""

from __future__ import annotations

import math

import numpy as np

from polycnc.kernel._axis_limits import AxisLimits
from polycnc.kernel._jit import apart, compiled, entry
from polycnc.kernel._merge import NOT_MERGED, append_line, is_open, keep_point, merge_line
from polycnc.kernel._path import MOST_MERGED, SCRATCH_POINTS, Paths
from polycnc.kernel._segments import RAPID, STOP, WITH_SPINDLE, Floats, Segments

NOT_SMALL = -2
CORNERS = 3  # around each half of an arc
# Of the arc, from its start to the first of them and from there to where that touches.
PART = 1.0 / (4.0 * CORNERS)


@apart
@entry
def append_small_arc(
    seg: Segments,
    paths: Paths,
    g: int,
    limits: AxisLimits,
    end: Floats,
    axis_p: int,
    axis_q: int,
    center_p: float,
    center_q: float,
    sweep_rad: float,
    speed_mm_s: float,
    flags: int,
    tag: int,
) -> int:
    """Append an arc as two lines to path `g` if it is small; return what `merge_line` returns of the first of them.

    NOT_SMALL if it is not: `append_arc` takes it then. It may take six slots.
    """
    row, start = paths.row[g], paths.queued[g]
    n = end.shape[0]
    if flags & (RAPID | STOP | WITH_SPINDLE) or not _is_small(
        row, limits, start, end, (axis_p, axis_q), (center_p, center_q), sweep_rad
    ):
        return NOT_SMALL
    middle = paths.blend[g, SCRATCH_POINTS + 2 * n : SCRATCH_POINTS + 3 * n]
    corners = paths.blend[g, SCRATCH_POINTS + 3 * n : SCRATCH_POINTS + 3 * n + 6 * CORNERS].reshape(-1, 3)
    r = _third_axis(limits, axis_q)
    at_p, at_q = start[axis_p] - center_p, start[axis_q] - center_q
    for i in range(n):
        middle[i] = 0.5 * (start[i] + end[i])
    middle[axis_p], middle[axis_q] = _turned(center_p, center_q, at_p, at_q, 0.5 * sweep_rad, 1.0)
    outside = 1.0 / math.cos(PART * sweep_rad)
    for number in range(2 * CORNERS):
        part = PART * (2 * number + 1)
        corners[number, 0], corners[number, 1] = _turned(
            center_p, center_q, at_p, at_q, part * sweep_rad, outside
        )
        corners[number, 2] = start[r] + part * (end[r] - start[r])
    joined = _append_half(seg, paths, g, limits, middle, corners[:CORNERS], speed_mm_s, flags, tag)
    _append_half(seg, paths, g, limits, end, corners[CORNERS:], speed_mm_s, flags, tag)
    return joined


@compiled
def _is_small(
    path: np.void,
    limits: AxisLimits,
    start: Floats,
    end: Floats,
    axes: tuple[int, int],
    center: tuple[float, float],
    sweep_rad: float,
) -> bool:
    """Tell whether an arc in the first two axes that count bends by less than the merging distance."""
    if path["merge_mm"] <= 0.0 or path["tolerance_mm"] <= 0.0:
        return False
    found = 0
    for i in range(end.shape[0]):
        if limits.feed_axis[i] != 0 and found < 3:
            if found < 2 and i != axes[found]:
                return False
            found += 1
        elif start[i] != end[i]:
            return False
    p, q = start[axes[0]] - center[0], start[axes[1]] - center[1]
    bend = math.sqrt(p * p + q * q) * (1.0 - math.cos(min(0.5 * abs(sweep_rad), math.pi)))
    return bool(found == 3 and bend < path["merge_mm"])


@compiled
def _third_axis(limits: AxisLimits, q: int) -> int:
    r = q + 1
    while limits.feed_axis[r] == 0:
        r += 1
    return r


@compiled
def _turned(
    center_p: float, center_q: float, at_p: float, at_q: float, angle: float, size: float
) -> tuple[float, float]:
    """Return the point about a centre that another, given from there, comes to by an angle and a factor."""
    cosine, sine = size * math.cos(angle), size * math.sin(angle)
    return center_p + cosine * at_p - sine * at_q, center_q + sine * at_p + cosine * at_q


@compiled
def _append_half(
    seg: Segments,
    paths: Paths,
    g: int,
    limits: AxisLimits,
    end: Floats,
    corners: Floats,
    speed_mm_s: float,
    flags: int,
    tag: int,
) -> int:
    """Append a line to `end`, merged with the last one if these corners fit as well; return what `merge_line` does."""
    row = paths.row[g]
    if is_open(paths, g) and row["merged"] + CORNERS < MOST_MERGED:
        _keep(paths, g, corners)
        joined = merge_line(seg, paths, g, limits, end, speed_mm_s, flags, tag)
        if joined != NOT_MERGED:
            return int(joined)
    append_line(seg, paths, g, limits, end, speed_mm_s, flags, tag)
    if is_open(paths, g):
        _keep(paths, g, corners)
    return NOT_MERGED


@compiled
def _keep(paths: Paths, g: int, corners: Floats) -> None:
    for number in range(corners.shape[0]):
        keep_point(paths, g, corners[number], 0, 1, 2)
