"""Look-ahead: the speed at the end of every queued segment, from one backward pass.

The forward pass happens as segments begin: each starts with the speed it is entered with, and its ramp reaches no
more than its acceleration allows. A planned end speed is final once it would be the same whatever is appended;
only segments after that are looked at again, so a long program costs linear time. All passes work on squared
speeds, which grow by 2 a s along a segment.
"""

from __future__ import annotations

import math

import numpy as np

from polycnc.kernel._axis_limits import AxisLimits
from polycnc.kernel._corner_rules import BY_SHARE
from polycnc.kernel._geometry import grow_extents
from polycnc.kernel._jit import compiled, entry
from polycnc.kernel._limits import least_accel, limit_junction, limit_segment, share_acceleration
from polycnc.kernel._path import Paths, slot
from polycnc.kernel._segments import STOP, WAIT, Floats, Segments

ROUNDING = 1e-9  # of a sum of gains


@compiled
def limit_queue(
    seg: Segments,
    paths: Paths,
    g: int,
    limits: AxisLimits,
    dt: float,
    first: int,
    first_end: int,
    work: Floats,
) -> None:
    """Set the caps of the segments from count `first` on, and junctions and accelerations from `first_end` on."""
    row = paths.row[g]
    head, tail, jerkrel = int(row["head"]), int(row["prepared"]), row["jerkrel"]
    for count in range(first, tail):
        limit_segment(seg, slot(paths, g, count), limits, row, work)
    for count in range(first_end, tail):
        k = slot(paths, g, count)
        seg.row[k]["bound"] = 0.0
        if count + 1 < tail:
            limit_junction(seg, k, slot(paths, g, count + 1), limits, row, dt, work)
        else:
            seg.row[k]["junction"] = 0.0
            seg.row[k]["yield_before"] = 0.0
            seg.row[k]["yield_after"] = 0.0
            if row["corner_rule"] == BY_SHARE:
                seg.row[k]["kept_out"] = 0.0
        last = seg.row[slot(paths, g, max(count - 1, head))]
        entered = last["junction"] if count > head else 0.0  # what lies before the head is planned no more
        share_acceleration(seg, k, entered, last["yield_after"], jerkrel, row, dt)


@compiled
def end_limit(row: np.void) -> float:
    """Return the highest speed through the end of a segment: its junction, or what the caller prescribed."""
    if row["end_speed"] >= 0.0:
        return float(min(row["end_speed"], row["cap"]))
    return float(row["junction"])


@compiled
def _last_limit(row: np.void, closed: bool) -> float:
    """Return the highest speed through the end of the last segment known: rest, or what the caller prescribed."""
    if closed or row["end_speed"] < 0.0:
        return 0.0
    return float(min(row["end_speed"], row["cap"]))


@compiled
def _last_gain(row: np.void, closed: bool, path: np.void) -> float:
    """Return how much the last segment known can take off the squared speed, whatever corner will follow it."""
    if closed or row["flags"] & STOP:
        return float(row["gain"])
    return float(2.0 * least_accel(row, path) * row["length"])


@compiled
def plan_path(seg: Segments, paths: Paths, g: int) -> None:
    """Set the end speeds of all queued segments, and `planned`: how many of them are final.

    Two estimates run backward from the tail: coming to rest there, and going on at any speed. Where they meet,
    nothing appended later can change what lies before.
    """
    path = paths.row[g]
    tail = int(path["prepared"])
    known = max(int(path["planned"]), int(path["head"]))
    closed = path["closed"] != 0 and tail == path["tail"]
    rest = 0.0  # squared entry speed of the following segment if the path ends at the tail
    more = math.inf
    met = False
    for count in range(tail - 1, known - 1, -1):
        row = seg.row[slot(paths, g, count)]
        if count == tail - 1:
            limit = _last_limit(row, closed)
            out = limit * limit
            met = bool(closed or row["flags"] & STOP)
            if met:
                path["planned"] = tail
            rest = out + _last_gain(row, closed, path)
        else:
            limit = end_limit(row)
            limit *= limit
            gain = row["gain"]
            out = min(limit, rest)
            if not met and out == min(limit, more):
                met = True
                path["planned"] = count + 1
            rest = out + gain
            more = min(limit, more) + gain
        row["out"] = math.sqrt(out)


@compiled
def window_speed(seg: Segments, paths: Paths, g: int, count: int) -> float:
    """Return the end speed of segment `count` when only `depth` segments after it are known.

    It is the planned one where all of the queue is known, or where the path can rest from it within the window.
    """
    path = paths.row[g]
    tail = int(path["prepared"])
    planned = float(seg.row[slot(paths, g, count)]["out"])
    last = min(tail - 1, count + int(path["depth"]))
    if last == tail - 1:
        return planned
    to_brake = planned * planned * (1.0 + ROUNDING)
    for other in range(count + 1, last):
        row = seg.row[slot(paths, g, other)]
        if row["end_speed"] >= 0.0:
            break  # the caller prescribes what comes after, which the window does not see
        to_brake -= row["gain"]
        if to_brake < 0.0:
            return planned
    row = seg.row[slot(paths, g, last)]
    limit = _last_limit(row, False)
    rest = limit * limit + _last_gain(row, False, path)
    for other in range(last - 1, count, -1):
        row = seg.row[slot(paths, g, other)]
        limit = end_limit(row)
        rest = min(limit * limit, rest) + row["gain"]
    return min(end_limit(seg.row[slot(paths, g, count)]), math.sqrt(rest))


@entry(steps=lambda seg, paths, g, first, low, high: int(paths.row["prepared"][g]) - first + 1)
def measure_queue(seg: Segments, paths: Paths, g: int, first: int, low: Floats, high: Floats) -> None:
    """Widen the box `low[n]`, `high[n]` to hold the prepared segments of path `g` from count `first` on."""
    work = np.empty(low.shape[0])
    for count in range(first, paths.row[g]["prepared"]):
        k = slot(paths, g, count)
        if seg.row[k]["kind"] != WAIT:
            grow_extents(seg, k, low, high, work)
