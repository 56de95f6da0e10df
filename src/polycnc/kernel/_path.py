"""A path: its part of the segment ring, appending to it, and where it stands.

Counts (`head`, `tail`, ...) only grow; the slot of count c is `base + c % capacity`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from polycnc.kernel._jit import compiled, entry
from polycnc.kernel._limits import AxisLimits
from polycnc.kernel._ramps import REGISTERS
from polycnc.kernel._segments import RAPID, STOP, Floats, Segments, set_arc, set_line, set_wait

Ints = npt.NDArray[np.int64]

IDLE = 0  # not started
READY = 1  # started and at rest: the next segment begins with the next cycle
RUNNING = 2  # the segment at `head` is being gone along
HELD = 3  # at rest within a segment, until released

# Columns of `totals`.
RAPID_S, FEED_S, WAIT_S, RAPID_LENGTH, FEED_LENGTH, SEGMENTS, TOP_SPEED = 0, 1, 2, 3, 4, 5, 6
TOTALS = 7


PATH_ROW = np.dtype(
    [
        ("base", np.int64),
        ("capacity", np.int64),
        ("head", np.int64),  # count of the segment that is running or comes next
        ("tail", np.int64),  # count of segments appended
        ("planned", np.int64),  # segments before this count have their final end speed
        ("depth", np.int64),  # look-ahead in segments, 0 = unlimited
        ("cycles", np.int64),  # samples taken in the running segment
        ("event", np.int64),  # event last met, -1 none
        ("override", np.float64),
        ("jerkrel", np.float64),
        ("lead", np.float64),  # time into the running segment at sample 0
        ("entry_share", np.float64),  # what the corner last passed takes of the acceleration
        ("speed", np.float64),  # path speed now
        ("tag", np.int32),  # tag of the segment that gave the last setpoint
        ("flags", np.int8),  # of that segment
        ("state", np.int8),
        ("hold", np.int8),
        ("closed", np.int8),  # nothing will be appended: the last segment ends the path
    ],
    align=True,
)


class Paths(NamedTuple):
    """G paths, each an ordered set of m coordinates mapped to machine axes."""

    row: npt.NDArray[np.void]  # [G] of PATH_ROW
    ramps: Floats  # [G, REGISTERS]
    totals: Floats  # [G, TOTALS] of the segments gone along so far
    position: Floats  # [G, m] now
    queued: Floats  # [G, m] end of the last segment appended
    axis: Ints  # [G, m] machine axis of each coordinate, -1 none


def make_paths(paths: int, slots: int, coordinates: int) -> Paths:
    """Allocate `paths` idle paths, each with an equal part of `slots` segments."""
    row = np.zeros(paths, PATH_ROW)
    row["capacity"] = slots // paths
    row["base"] = np.arange(paths) * (slots // paths)
    row["override"] = 1.0
    row["event"] = -1
    return Paths(
        row=row,
        ramps=np.zeros((paths, REGISTERS)),
        totals=np.zeros((paths, TOTALS)),
        position=np.zeros((paths, coordinates)),
        queued=np.zeros((paths, coordinates)),
        axis=np.tile(np.arange(coordinates, dtype=np.int64), (paths, 1)),
    )


@compiled
def slot(paths: Paths, g: int, count: int) -> int:
    """Return the slot of segment `count` of path `g`."""
    return int(paths.row[g]["base"] + count % paths.row[g]["capacity"])


@entry
def free_slots(paths: Paths, g: int) -> int:
    """Return how many segments path `g` still takes."""
    return int(paths.row[g]["capacity"] - (paths.row[g]["tail"] - paths.row[g]["head"]))


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
    """Append a straight line to path `g`; False if it has no length. The caller sees to free slots."""
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
