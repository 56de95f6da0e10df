"""The piece in which one motion ends while the next begins: put between both, read, taken off them, given back.

Its size is how long both motions overlap, s; the speeds with which the first one begins to end and the second one has
begun, mm/s; and what that takes of the second, mm. Of the first it takes what slowing down evenly to rest needs.
"""

from __future__ import annotations

from typing import TypeAlias

from polycnc.kernel._cubic import CUT_AFTER, ENTRY, FIRST, SECOND, TAKEN
from polycnc.kernel._geometry import segment_coordinate, segment_tangent
from polycnc.kernel._jit import compiled
from polycnc.kernel._segments import (
    LINE,
    OVERLAP,
    OVERLAPS,
    RADIUS_END,
    RADIUS_START,
    RISE,
    SWEEP_RAD,
    Floats,
    Segments,
    set_common,
)

Size: TypeAlias = tuple[float, float, float, float]


@compiled
def size_of(seg: Segments, between: int) -> Size:
    """Return the size of OVERLAP `between`."""
    geo, row = seg.geo[between], seg.row[between]
    both = row["feed_mm_s"] / max(geo[ENTRY], 1.0 - geo[ENTRY])
    return 2.0 * row["length"] / both, geo[ENTRY] * both, (1.0 - geo[ENTRY]) * both, float(geo[CUT_AFTER])


@compiled
def taken_of_first(size: Size) -> float:
    """Return what an OVERLAP takes of the motion before it."""
    return 0.5 * size[0] * size[1]


@compiled
def insert(
    seg: Segments,
    slots: tuple[int, int, int],
    axes: tuple[int, int, int],
    size: Size,
    taken: float,
    point: Floats,
) -> None:
    """Put an OVERLAP between the motions in the first two of these slots, of which the second goes to the third.

    `taken` of the first is gone at its start; `point` is scratch.
    """
    between = slots[1]
    copy(seg, between, slots[2])
    for j in range(3):
        seg.plane[between, j] = axes[j]
    seg.geo[between, TAKEN] = taken
    join(seg, slots, size, point)


@compiled
def join(seg: Segments, slots: tuple[int, int, int], size: Size, point: Floats) -> None:
    """Take off two motions what an OVERLAP of this size needs, and set it; `point` is scratch."""
    k, between, following = slots
    time, leaving, entering, cut_after = size
    cut, even = taken_of_first(size), 0.5 * time * entering
    _shorten(seg, k, cut, False, point)
    _shorten(seg, following, cut_after, True, point)
    tag = int(seg.row[following]["tag"])
    set_common(seg, between, seg.end[k], seg.start[following], max(leaving, entering), OVERLAPS, tag)
    seg.row[between]["kind"] = OVERLAP
    seg.row[between]["length"] = cut + even
    geo, axes = seg.geo[between], seg.plane[between]
    geo[ENTRY], geo[CUT_AFTER] = leaving / (leaving + entering), cut_after
    segment_tangent(seg, k, 1.0, point)
    for j in range(3):
        geo[FIRST + j] = 2.0 / 3.0 * cut * point[axes[j]]
    segment_tangent(seg, following, 0.0, point)
    for j in range(3):
        i = axes[j]
        geo[SECOND + j] = seg.end[between, i] - seg.start[between, i] - 2.0 / 3.0 * even * point[i]


@compiled
def copy(seg: Segments, k: int, to: int) -> None:
    """Copy segment `k` to another slot."""
    row, copy = seg.row[k], seg.row[to]
    set_common(seg, to, seg.start[k], seg.end[k], row["feed_mm_s"], int(row["flags"]), int(row["tag"]))
    copy["event"], copy["events"] = row["event"], row["events"]
    copy["kind"], copy["length"], copy["end_speed"] = row["kind"], row["length"], row["end_speed"]
    for j in range(3):
        seg.plane[to, j] = seg.plane[k, j]
    for j in range(RISE + 1):
        seg.geo[to, j] = seg.geo[k, j]


@compiled
def part(seg: Segments, slots: tuple[int, int, int], size: Size, point: Floats) -> None:
    """Give two motions back what an OVERLAP of this size took of them; `point` is scratch."""
    _shorten(seg, slots[0], -taken_of_first(size), False, point)
    _shorten(seg, slots[2], -size[3], True, point)


@compiled
def _shorten(seg: Segments, k: int, cut: float, at_start: bool, point: Floats) -> None:
    """Take `cut` off the start or the end of the line or arc `k`, or add it if negative; `point` is scratch."""
    row, geo = seg.row[k], seg.geo[k]
    length = row["length"]
    for i in range(point.shape[0]):
        point[i] = segment_coordinate(seg, k, i, cut if at_start else length - cut)
    for i in range(point.shape[0]):
        if at_start:
            seg.start[k, i] = point[i]
        else:
            seg.end[k, i] = point[i]
    row["length"] = length - cut
    if row["kind"] == LINE:
        return
    growth = (geo[RADIUS_END] - geo[RADIUS_START]) * cut / length
    if at_start:
        geo[RADIUS_START] += growth
    else:
        geo[RADIUS_END] -= growth
    geo[SWEEP_RAD] *= 1.0 - cut / length
