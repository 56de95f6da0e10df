"""Append lines, arcs and waits to a path."""

from __future__ import annotations

from polycnc.kernel._blend import blend_corner
from polycnc.kernel._jit import compiled, entry
from polycnc.kernel._limits import AxisLimits
from polycnc.kernel._path import Paths, slot
from polycnc.kernel._segments import RAPID, STOP, Floats, Segments, set_arc, set_line, set_wait


@compiled
def _appended(seg: Segments, paths: Paths, g: int, k: int) -> None:
    paths.row[g]["closed"] = 0
    paths.row[g]["tail"] += 1
    for i in range(seg.end.shape[1]):
        paths.queued[g, i] = seg.end[k, i]


@compiled
def stop_before_next(seg: Segments, paths: Paths, g: int) -> None:
    """Make the last segment appended come to rest, unless it has run already."""
    if paths.row[g]["tail"] > paths.row[g]["head"]:
        seg.row[slot(paths, g, paths.row[g]["tail"] - 1)]["flags"] |= STOP


@compiled
def _keep_rapids_apart(seg: Segments, paths: Paths, g: int, flags: int) -> None:
    """Let a path come to rest where positioning meets feed motion, unless the caller lets them blend."""
    if paths.row[g]["tail"] > paths.row[g]["head"]:
        k = slot(paths, g, paths.row[g]["tail"] - 1)
        if (seg.row[k]["flags"] ^ flags) & RAPID:
            seg.row[k]["flags"] |= STOP


@entry
def append_line(
    seg: Segments, paths: Paths, g: int, limits: AxisLimits, end: Floats, feed: float, flags: int, tag: int
) -> bool:
    """Append a straight line to path `g`; False if it has no length. The caller sees to two free slots.

    With a path tolerance the corner before it is rounded where that is possible.
    """
    blend_corner(seg, paths, g, limits, end, feed, tag)
    k = slot(paths, g, paths.row[g]["tail"])
    if not set_line(seg, k, limits.feed_axis, paths.queued[g], end, feed, flags, tag):
        return False
    _keep_rapids_apart(seg, paths, g, flags)
    _appended(seg, paths, g, k)
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
    sweep: float,
    feed: float,
    flags: int,
    tag: int,
) -> bool:
    """Append an arc or helix to path `g`; False if it has no length."""
    k = slot(paths, g, paths.row[g]["tail"])
    if not set_arc(
        seg,
        k,
        limits.feed_axis,
        paths.queued[g],
        end,
        axis_p,
        axis_q,
        center_p,
        center_q,
        sweep,
        feed,
        flags,
        tag,
    ):
        return False
    _keep_rapids_apart(seg, paths, g, flags)
    _appended(seg, paths, g, k)
    return True


@entry
def append_wait(seg: Segments, paths: Paths, g: int, duration: float, event: int, tag: int) -> None:
    """Append a wait at rest of `duration` s that reports `event` (-1 none) when it begins."""
    stop_before_next(seg, paths, g)
    k = slot(paths, g, paths.row[g]["tail"])
    set_wait(seg, k, paths.queued[g], duration, event, tag)
    _appended(seg, paths, g, k)
