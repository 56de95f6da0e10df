"""Merge short lines into one as long as every point that is left out lies within a distance of it.

The last line appended stays open while lines may still join it. Its corner with the line before is rounded when it is
complete, so the arc touches the line that remains. Points are kept of the first three axes that count in the path
length; where another axis moves nothing is merged.
"""

from __future__ import annotations

from polycnc.kernel._axis_limits import AxisLimits
from polycnc.kernel._blend import blend_corner, counting_axes
from polycnc.kernel._jit import apart, compiled, entry
from polycnc.kernel._overlap import overlap_corner
from polycnc.kernel._path import BLEND_COLUMNS, MOST_MERGED, SCRATCH_POINTS, Paths, add_line, end_thread, slot
from polycnc.kernel._segments import RAPID, STOP, WITH_SPINDLE, Floats, Segments, set_line

NOT_MERGED = -1


@compiled
def is_open(paths: Paths, g: int) -> bool:
    """Tell whether lines may still join the last line of path `g`; what has been planned stays as it is."""
    row = paths.row[g]
    return bool(row["merged"] > 0 and row["tail"] > row["prepared"])


@compiled
def _open_line(seg: Segments, paths: Paths, g: int, limits: AxisLimits) -> None:
    """Let lines join the line just appended to path `g`."""
    k = slot(paths, g, paths.row[g]["tail"] - 1)
    p, q, r = counting_axes(seg, k, limits, seg.end[k])
    if p >= 0:
        keep_point(paths, g, seg.end[k], p, q, r)


@compiled
def keep_point(paths: Paths, g: int, point: Floats, p: int, q: int, r: int) -> None:
    """Note a point that lines merged into the last one of path `g` have to stay near."""
    at = BLEND_COLUMNS + 3 * int(paths.row[g]["merged"])
    kept = paths.blend[g]
    kept[at], kept[at + 1], kept[at + 2] = point[p], point[q], point[r]
    paths.row[g]["merged"] += 1


@entry
def merge_line(
    seg: Segments,
    paths: Paths,
    g: int,
    limits: AxisLimits,
    end: Floats,
    speed_mm_s: float,
    flags: int,
    tag: int,
) -> int:
    """Let a line to `end` join the last line of path `g`, which then has its tag; return the tag that it had.

    NOT_MERGED if it may not: `append_line` takes it then.
    """
    row = paths.row[g]
    if row["merge_mm"] <= 0.0 or not is_open(paths, g) or row["merged"] >= MOST_MERGED:
        return NOT_MERGED
    k = slot(paths, g, row["tail"] - 1)
    line = seg.row[k]
    if line["feed_mm_s"] != speed_mm_s or line["flags"] != flags:
        return NOT_MERGED
    p, q, r = counting_axes(seg, k, limits, end)
    if p < 0 or not _within(paths, g, seg.start[k], end, p, q, r):
        return NOT_MERGED
    before, events = int(line["tag"]), line["events"]
    set_line(seg.row, seg.start, seg.end, k, limits.feed_axis, seg.start[k], end, speed_mm_s, flags, tag)
    line["events"] = events
    for i in range(end.shape[0]):
        paths.queued[g, i] = end[i]
    keep_point(paths, g, end, p, q, r)
    return before


@compiled
def _within(paths: Paths, g: int, start: Floats, end: Floats, p: int, q: int, r: int) -> bool:
    """Tell whether every point kept lies within the merging distance of the line from `start` to `end`."""
    row, kept = paths.row[g], paths.blend[g]
    x, y, z = end[p] - start[p], end[q] - start[q], end[r] - start[r]
    square = x * x + y * y + z * z
    if square <= 0.0:
        return False
    most = row["merge_mm"] * row["merge_mm"]
    for number in range(row["merged"]):
        at = BLEND_COLUMNS + 3 * number
        u, v, w = kept[at] - start[p], kept[at + 1] - start[q], kept[at + 2] - start[r]
        along = min(1.0, max(0.0, (u * x + v * y + w * z) / square))
        u, v, w = u - along * x, v - along * y, w - along * z
        if u * u + v * v + w * w > most:
            return False
    return True


@apart
@entry
def close_line(seg: Segments, paths: Paths, g: int, limits: AxisLimits) -> None:
    """Let no more lines join the last line of path `g`, and round its corner with the line before."""
    row = paths.row[g]
    joins = is_open(paths, g)
    row["merged"] = 0
    if not joins:
        return
    k = slot(paths, g, row["tail"] - 1)
    line = seg.row[k]
    speed, flags, tag = line["feed_mm_s"], int(line["flags"]), int(line["tag"])
    event, events = line["event"], line["events"]
    end = paths.blend[g, SCRATCH_POINTS : SCRATCH_POINTS + seg.end.shape[1]]
    for i in range(end.shape[0]):
        end[i] = seg.end[k, i]
        paths.queued[g, i] = seg.start[k, i]
    row["tail"] -= 1
    blend_corner(seg, paths, g, limits, end, speed, tag)
    add_line(
        seg.row, seg.start, seg.end, paths.row, paths.queued, g, limits.feed_axis, end, speed, flags, tag
    )
    line = seg.row[slot(paths, g, row["tail"] - 1)]
    line["event"], line["events"] = event, events
    overlap_corner(seg, paths, g, limits)


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

    With a path tolerance the corner before it is rounded where that is possible: at once, or when it is complete.
    """
    row = paths.row[g]
    if row["merged"] > 0:
        close_line(seg, paths, g, limits)
    rounds = row["tolerance_mm"] > 0.0
    merges = row["merge_mm"] > 0.0 and rounds and not flags & (RAPID | STOP | WITH_SPINDLE)
    if not merges:
        end_thread(seg.row, paths.row, g, flags)
        if rounds:
            blend_corner(seg, paths, g, limits, end, speed_mm_s, tag)
    added = add_line(
        seg.row, seg.start, seg.end, paths.row, paths.queued, g, limits.feed_axis, end, speed_mm_s, flags, tag
    )
    if merges and added:
        _open_line(seg, paths, g, limits)
    elif added and rounds:
        overlap_corner(seg, paths, g, limits)
    return bool(added)
