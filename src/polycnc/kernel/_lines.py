"""Append lines as they are, and what every segment appended needs. The caller sees to free slots.

Units: see `_segments`.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from polycnc.kernel._jit import compiled
from polycnc.kernel._path import Paths, slot, slot_of
from polycnc.kernel._segments import (
    CORNER_STOP,
    LAST,
    RAPID,
    STOP,
    WAIT,
    WITH_SPINDLE,
    Floats,
    Segments,
    set_line,
)

Rows: TypeAlias = npt.NDArray[np.void]


@compiled
def appended(ends: Floats, path: Rows, queued: Floats, g: int, k: int) -> None:
    """Count slot `k` as the last segment of path `g`."""
    path[g]["closed"] = 0
    path[g]["tail"] += 1
    for i in range(ends.shape[1]):
        queued[g, i] = ends[k, i]


@compiled
def attach(row: Rows, path: Rows, g: int) -> None:
    """Let the events that wait for the next motion of path `g` come with the last segment appended."""
    events = path[g]["next_events"]
    if events > 0:
        k = slot_of(path, g, path[g]["tail"] - 1)
        row[k]["event"], row[k]["events"] = path[g]["next_event"], events
        path[g]["next_events"] = 0
        if path[g]["in_step"] == 0:
            path[g]["looked_at"] = path[g]["tail"] - 1
        path[g]["in_step"] += 1


@compiled
def set_ends(row: Rows, path: Rows, g: int, flags: int) -> None:
    """Let a path come to rest where positioning meets feed motion, and in the corners of an exact path."""
    if path[g]["tolerance_mm"] < 0.0:
        row[slot_of(path, g, path[g]["tail"])]["flags"] |= CORNER_STOP
    end_thread(row, path, g, flags)
    if path[g]["tail"] > path[g]["head"]:
        k = slot_of(path, g, path[g]["tail"] - 1)
        if (row[k]["flags"] ^ flags) & RAPID:
            row[k]["flags"] |= STOP


@compiled
def end_thread(row: Rows, path: Rows, g: int, flags: int) -> None:
    """Let a path rest, in a corner that is not rounded, where a motion with the spindle begins or ends."""
    if path[g]["tail"] > path[g]["head"]:
        k = slot_of(path, g, path[g]["tail"] - 1)
        if (row[k]["flags"] ^ flags) & WITH_SPINDLE:
            row[k]["flags"] |= STOP


@compiled
def mark_last(seg: Segments, paths: Paths, g: int) -> None:
    """Mark the last segment appended as the end of a path with rounded corners, if nothing has planned it."""
    path = paths.row[g]
    if path["tolerance_mm"] > 0.0 and path["tail"] > path["prepared"]:
        row = seg.row[slot(paths, g, path["tail"] - 1)]
        if row["kind"] != WAIT and not row["flags"] & (STOP | CORNER_STOP):
            row["flags"] |= LAST


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
    """Append a straight line to path `g`, corners as they are, from single columns; False if it has no length."""
    k = slot_of(path, g, path[g]["tail"])
    if not set_line(row, starts, ends, k, feed_axis, queued[g], end, speed_mm_s, flags, tag):
        return False
    set_ends(row, path, g, flags)
    appended(ends, path, queued, g, k)
    attach(row, path, g)
    return True
