"""Look-ahead: the speed at the end of every queued segment, from one backward pass.

The forward pass happens as segments begin: each starts with the speed it is entered with, and its ramp reaches no
more than its acceleration allows. A planned end speed is final once it would be the same whatever is appended;
only segments after that are looked at again, so a long program costs linear time.
"""

from __future__ import annotations

import math

from polycnc.kernel._geometry import grow_extents
from polycnc.kernel._jit import compiled, entry
from polycnc.kernel._limits import CORNER_SHARE, AxisLimits, limit_junction, limit_segment, share_acceleration
from polycnc.kernel._path import RUNNING, Paths, slot
from polycnc.kernel._segments import WAIT, Floats, Segments


@compiled
def limit_queue(
    seg: Segments, paths: Paths, g: int, limits: AxisLimits, dt: float, first: int, work: Floats
) -> None:
    """Set caps, junctions and accelerations of the queued segments from count `first` on."""
    row = paths.row[g]
    tail = row["tail"]
    first = max(first, int(row["head"]))
    row["top_override"] = max(row["top_override"], row["override"])
    for count in range(first, tail):
        limit_segment(
            seg, slot(paths, g, count), limits, row["override"], row["top_override"], row["jerkrel"], work
        )
    for count in range(max(first - 1, int(row["head"])), tail):
        k = slot(paths, g, count)
        if count + 1 < tail:
            limit_junction(seg, k, slot(paths, g, count + 1), limits, dt, work)
        else:
            seg.row[k]["junction"] = 0.0
            seg.row[k]["share"] = 0.0
        was_last = count == first - 1
        if was_last and count == row["head"] and row["state"] == RUNNING and seg.row[k]["share"] > 0.0:
            # It began as the last one and has used all of its acceleration: nothing is left for a corner.
            seg.row[k]["junction"] = 0.0
            seg.row[k]["share"] = 0.0
    for count in range(max(first - 1, int(row["head"])), tail):
        k = slot(paths, g, count)
        before = seg.row[slot(paths, g, count - 1)]["share"] if count > row["head"] else row["entry_share"]
        share_acceleration(seg, k, before, seg.row[k]["share"])


@compiled
def end_limit(seg: Segments, k: int) -> float:
    """Return the highest speed through the end of segment `k`: its junction, or what the caller prescribed."""
    row = seg.row[k]
    return float(row["junction"] if row["end_speed"] < 0.0 else min(row["end_speed"], row["cap"]))


@compiled
def entry_speed(seg: Segments, k: int, out: float, accel: float) -> float:
    """Return the highest speed at the start of segment `k` from which `out` can be braked to."""
    return math.sqrt(out * out + 2.0 * accel * seg.row[k]["length"])


@compiled
def plan_path(seg: Segments, paths: Paths, g: int) -> None:
    """Set the end speeds of all queued segments, and `planned`: how many of them are final.

    Two estimates run backward from the tail: coming to rest there, and going on at any speed. Where they meet,
    nothing appended later can change what lies before.
    """
    tail = int(paths.row[g]["tail"])
    first = int(paths.row[g]["head"])
    known = max(int(paths.row[g]["planned"]), first)
    closed = paths.row[g]["closed"] != 0
    if closed:
        paths.row[g]["planned"] = tail
    rest = 0.0  # entry speed of the following segment if the path ends at the tail
    more = 0.0 if closed else math.inf
    met = closed
    for count in range(tail - 1, known - 1, -1):
        k = slot(paths, g, count)
        if count == tail - 1:
            limit = 0.0 if closed or seg.row[k]["end_speed"] < 0.0 else end_limit(seg, k)
            seg.row[k]["out"] = limit
            # Its junction is not known yet: neither the speed there nor how much acceleration it will take.
            rest = entry_speed(
                seg, k, limit, seg.row[k]["accel"] if closed else seg.row[k]["accel"] * (1.0 - CORNER_SHARE)
            )
            more = rest if closed else math.inf
            continue
        limit = end_limit(seg, k)
        out = min(limit, rest)
        if not met and out == min(limit, more):
            met = True
            paths.row[g]["planned"] = max(int(paths.row[g]["planned"]), count + 1)
        seg.row[k]["out"] = out
        rest = entry_speed(seg, k, out, seg.row[k]["accel"])
        more = rest if met else entry_speed(seg, k, min(limit, more), seg.row[k]["accel"])


@compiled
def window_speed(seg: Segments, paths: Paths, g: int, count: int) -> float:
    """Return the end speed of segment `count` when only `depth` segments after it are known."""
    last = min(int(paths.row[g]["tail"]) - 1, count + int(paths.row[g]["depth"]))
    rest = 0.0
    for other in range(last, count, -1):
        k = slot(paths, g, other)
        limit = 0.0 if other == last and seg.row[k]["end_speed"] < 0.0 else end_limit(seg, k)
        rest = entry_speed(seg, k, min(limit, rest) if other < last else limit, seg.row[k]["accel"])
    k = slot(paths, g, count)
    if count == last:
        return 0.0 if seg.row[k]["end_speed"] < 0.0 else end_limit(seg, k)
    return min(end_limit(seg, k), rest)


@entry
def prepare_path(
    seg: Segments, paths: Paths, g: int, limits: AxisLimits, dt: float, first: int, work: Floats
) -> None:
    """Take the segments appended from count `first` on into the look-ahead of path `g`. `work` is scratch, [2, n]."""
    limit_queue(seg, paths, g, limits, dt, first, work)
    plan_path(seg, paths, g)


@entry
def measure_queue(seg: Segments, paths: Paths, g: int, first: int, low: Floats, high: Floats) -> None:
    """Widen the box `low[n]`, `high[n]` to hold the segments of path `g` from count `first` on."""
    for count in range(first, paths.row[g]["tail"]):
        k = slot(paths, g, count)
        if seg.row[k]["kind"] != WAIT:
            grow_extents(seg, k, low, high)
