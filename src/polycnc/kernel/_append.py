"""Append arcs, circles, splines and waits to a path; lines are appended by `_merge` and `_lines`.

The caller sees to free slots, and closes the last line (`close_line`) where the path merges lines. Units: see
`_segments`.
"""

from __future__ import annotations

from polycnc.kernel._axis_limits import AxisLimits
from polycnc.kernel._blend_arcs import round_to_arc
from polycnc.kernel._jit import compiled, entry
from polycnc.kernel._overlap import overlap_corner
from polycnc.kernel._path import Paths, appended, attach, end_thread, mark_last, set_ends, slot
from polycnc.kernel._segments import STOP, Floats, Segments, set_arc, set_circle3d, set_spline, set_wait


@compiled
def stop_before_next(seg: Segments, paths: Paths, g: int) -> None:
    """Make the last segment appended come to rest, unless it has run already."""
    if paths.row[g]["tail"] > paths.row[g]["head"]:
        mark_last(seg, paths, g)
        seg.row[slot(paths, g, paths.row[g]["tail"] - 1)]["flags"] |= STOP


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
    """Append an arc or helix to path `g`; False if it has no length. It may take two slots.

    With a path tolerance the corner before it is rounded where that is possible.
    """
    end_thread(seg.row, paths.row, g, flags)
    sweep_rad = round_to_arc(
        seg, paths, g, limits, end, (axis_p, axis_q), (center_p, center_q), sweep_rad, speed_mm_s, tag
    )
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
    set_ends(seg.row, paths.row, g, flags)
    appended(seg.end, paths.row, paths.queued, g, k)
    attach(seg.row, paths.row, g)
    overlap_corner(seg, paths, g, limits)
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
    set_ends(seg.row, paths.row, g, flags)
    appended(seg.end, paths.row, paths.queued, g, k)
    attach(seg.row, paths.row, g)
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
    set_ends(seg.row, paths.row, g, flags)
    appended(seg.end, paths.row, paths.queued, g, k)
    attach(seg.row, paths.row, g)


@entry
def append_wait(
    seg: Segments, paths: Paths, g: int, duration_s: float, event: int, tag: int, passes: int
) -> None:
    """Append a wait at rest of `duration_s` that reports `event` (-1 none) when it begins.

    With `passes` the path need not stop for whoever wants its events: it may note it and go on, see `settle`.
    """
    stop_before_next(seg, paths, g)
    k = slot(paths, g, paths.row[g]["tail"])
    set_wait(seg, k, paths.queued[g], duration_s, event, tag, passes)
    appended(seg.end, paths.row, paths.queued, g, k)
