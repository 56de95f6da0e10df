"""Append lines, arcs, circles, splines and waits to a path. The caller sees to free slots.

Units: see `_segments`.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from polycnc.kernel._axis_limits import AxisLimits
from polycnc.kernel._blend import blend_corner
from polycnc.kernel._jit import compiled, entry
from polycnc.kernel._path import Paths, slot, slot_of
from polycnc.kernel._segments import (
    CORNER_STOP,
    RAPID,
    STOP,
    Floats,
    Segments,
    set_arc,
    set_circle3d,
    set_line,
    set_spline,
    set_wait,
)

Rows: TypeAlias = npt.NDArray[np.void]


@compiled
def _appended(ends: Floats, path: Rows, queued: Floats, g: int, k: int) -> None:
    path[g]["closed"] = 0
    path[g]["tail"] += 1
    for i in range(ends.shape[1]):
        queued[g, i] = ends[k, i]


@compiled
def stop_before_next(seg: Segments, paths: Paths, g: int) -> None:
    """Make the last segment appended come to rest, unless it has run already."""
    if paths.row[g]["tail"] > paths.row[g]["head"]:
        seg.row[slot(paths, g, paths.row[g]["tail"] - 1)]["flags"] |= STOP


@compiled
def _set_ends(row: Rows, path: Rows, g: int, flags: int) -> None:
    """Let a path come to rest where positioning meets feed motion, and in the corners of an exact path."""
    if path[g]["tolerance_mm"] < 0.0:
        row[slot_of(path, g, path[g]["tail"])]["flags"] |= CORNER_STOP
    if path[g]["tail"] > path[g]["head"]:
        k = slot_of(path, g, path[g]["tail"] - 1)
        if (row[k]["flags"] ^ flags) & RAPID:
            row[k]["flags"] |= STOP


@entry
def append_line(
    seg: Segments,
    paths: Paths,
    g: int,
    limits: AxisLimits,
    end: Floats,
    speed_mm_s: float,
    flags: int,
    tag: int,
) -> bool:
    """Append a straight line to path `g`; False if it has no length. It may take two slots.

    With a path tolerance the corner before it is rounded where that is possible.
    """
    blend_corner(seg, paths, g, limits, end, speed_mm_s, tag)
    return add_line(
        seg.row, seg.start, seg.end, paths.row, paths.queued, g, limits.feed_axis, end, speed_mm_s, flags, tag
    )


@compiled
def add_line(
    row: Rows,
    starts: Floats,
    ends: Floats,
    path: Rows,
    queued: Floats,
    g: int,
    feed_axis: npt.NDArray[np.uint8],
    end: Floats,
    speed_mm_s: float,
    flags: int,
    tag: int,
) -> bool:
    """Do what `append_line` does without a path tolerance, from single columns of `Segments` and `Paths`."""
    k = slot_of(path, g, path[g]["tail"])
    if not set_line(row, starts, ends, k, feed_axis, queued[g], end, speed_mm_s, flags, tag):
        return False
    _set_ends(row, path, g, flags)
    _appended(ends, path, queued, g, k)
    return True


@entry
def append_arc(
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
) -> bool:
    """Append an arc or helix to path `g`; False if it has no length."""
    k = slot(paths, g, paths.row[g]["tail"])
    start = paths.queued[g]
    if not set_arc(
        seg,
        k,
        limits.feed_axis,
        start,
        end,
        axis_p,
        axis_q,
        center_p,
        center_q,
        sweep_rad,
        speed_mm_s,
        flags,
        tag,
    ):
        return False
    _set_ends(seg.row, paths.row, g, flags)
    _appended(seg.end, paths.row, paths.queued, g, k)
    return True


@entry
def append_circle3d(
    seg: Segments,
    paths: Paths,
    g: int,
    axis_p: int,
    axis_q: int,
    axis_r: int,
    center: Floats,
    normal: Floats,
    sweep_deg: float,
    speed_mm_s: float,
    flags: int,
    tag: int,
) -> bool:
    """Append a circle in three axes about `center[3]` to path `g`; False if there is none (`set_circle3d`)."""
    k = slot(paths, g, paths.row[g]["tail"])
    start = paths.queued[g]
    if not set_circle3d(
        seg, k, start, axis_p, axis_q, axis_r, center, normal, sweep_deg, speed_mm_s, flags, tag
    ):
        return False
    _set_ends(seg.row, paths.row, g, flags)
    _appended(seg.end, paths.row, paths.queued, g, k)
    return True


@entry
def append_spline(
    seg: Segments,
    paths: Paths,
    g: int,
    end: Floats,
    axis_p: int,
    axis_q: int,
    span: Floats,
    length_mm: float,
    speed_mm_s: float,
    flags: int,
    tag: int,
) -> None:
    """Append a span of a Bezier curve in two axes that count (see `_bezier`) to path `g`."""
    k = slot(paths, g, paths.row[g]["tail"])
    set_spline(seg, k, paths.queued[g], end, axis_p, axis_q, span, length_mm, speed_mm_s, flags, tag)
    _set_ends(seg.row, paths.row, g, flags)
    _appended(seg.end, paths.row, paths.queued, g, k)


@entry
def append_wait(seg: Segments, paths: Paths, g: int, duration_s: float, event: int, tag: int) -> None:
    """Append a wait at rest of `duration_s` that reports `event` (-1 none) when it begins."""
    stop_before_next(seg, paths, g)
    k = slot(paths, g, paths.row[g]["tail"])
    set_wait(seg, k, paths.queued[g], duration_s, event, tag)
    _appended(seg.end, paths.row, paths.queued, g, k)
