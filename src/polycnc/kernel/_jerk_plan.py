"""Look-ahead with limited jerk: how fast the end of every queued segment may be passed without acceleration.

One backward pass. From the end of a segment the path comes down either to the speed of the next end, or, through
several segments at once, to that of a later one, the node: with the least acceleration of all of them, and no faster
than the slowest of them (`NODE_WAY`, `NODE_SPEED`, `NODE_ACCEL`, `NODE_FLOOR`). The faster way counts. Accelerations
may be carried through ends as well; `EASE` says how much, so that the following segments keep their own limits.

Beside a corner that shares the acceleration of its lines (see `_limits`) a node is reached early enough that the speed
stays for a cycle; ways through such corners have the reduced acceleration of their lines (`REDUCED`) throughout. A
corner that is not worth that cycle is a stop.

Units: those of `_segments`; jerk per s3.
"""

from __future__ import annotations

import math
from typing import TypeAlias

import numpy as np

from polycnc.kernel._jerk import fastest_start
from polycnc.kernel._jit import compiled
from polycnc.kernel._path import HELD, RUNNING, Paths, slot
from polycnc.kernel._ramps import MOST_SHARE, beside_corner
from polycnc.kernel._segments import (
    EASE,
    LIMIT,
    NODE_ACCEL,
    NODE_COUNT,
    NODE_FLOOR,
    NODE_SPEED,
    NODE_WAY,
    REACHED,
    REDUCED,
    SHARE_IN,
    STOP,
    ZONE_IN,
    ZONE_OUT,
    Floats,
    Segments,
)

WORTH_A_CYCLE = 1.5  # of what an acceleration gives in a cycle is the least speed of a corner that shares it
LEAST = 1e-3  # of that, of any corner

# Speed of an end; way, speed and acceleration of its node, its floor; ease; the node's count; the highest speed at all.
Ends: TypeAlias = tuple[float, float, float, float, float, float, int, float]


@compiled
def has_limited_jerk(path: np.void) -> bool:
    """Tell whether a path keeps a jerk."""
    return bool(path["jerk_mm_s3"] > 0.0)


@compiled
def last_known(path: np.void) -> int:
    """Return the count after the last segment that the look-ahead sees; the path could rest there."""
    last = int(path["prepared"])
    if path["depth"] > 0:
        last = min(last, int(path["head"]) + int(path["depth"]) + 1)
    return last


@compiled
def _corner_limit(row: np.void, after: np.void, dt: float) -> float:
    """Return the highest speed through the corner between two segments."""
    speed = row["junction"]
    if row["end_speed"] >= 0.0:
        speed = min(row["end_speed"], row["cap"])
    shares = row["yield_before"] > 0.0 or row["yield_after"] > 0.0
    worth = WORTH_A_CYCLE if shares else LEAST
    return float(speed if speed >= worth * max(row["accel"], after["accel"]) * dt else 0.0)


@compiled
def node_short(geo: Floats, speed_mm_s: float, dt: float) -> float:
    """Return how far before the end of a segment its speed there has to be reached."""
    return float(min(speed_mm_s * dt, geo[ZONE_OUT]))


@compiled
def _share(per_speed: float, bound: float) -> float:
    """Return what a corner passed with up to `bound` takes of the acceleration of a line."""
    return float(min(MOST_SHARE, per_speed * bound))


@compiled
def _step_back(
    seg: Segments,
    k: int,
    count: int,
    end: Ends,
    limit: float,
    reached: float,
    corner: float,
    unknown: bool,
    jerk: float,
    dt: float,
) -> Ends:
    """Return what holds for the end before segment `k`, number `count`, from what holds for its own.

    What it gives to corners is set as well. `limit` is of the corner before, which takes `corner` per speed, at most
    `reached`; `unknown`: the segment may give MOST_SHARE to the corner after it.
    """
    row, geo = seg.row[k], seg.geo[k]
    speed, way, node_speed, node_accel, floor, ease, node, bound = end
    length, cap, accel = row["length"], row["cap"], row["accel"]
    before_bound = min(reached, math.sqrt(bound * bound + 2.0 * accel * length))
    first = _share(corner, before_bound)
    last = MOST_SHARE if unknown else _share(row["yield_before"], bound)
    reduced = accel * (1.0 - max(first, last))
    geo[REDUCED], geo[SHARE_IN] = reduced, first
    geo[ZONE_IN] = beside_corner(before_bound, accel, first, dt, length) if first > 0.0 else 0.0
    geo[ZONE_OUT] = beside_corner(bound, accel, last, dt, length) if last > 0.0 else 0.0
    short = length - node_short(geo, speed, dt)
    near = max(speed, fastest_start(speed, short, reduced, jerk))
    least = min(reduced, node_accel)
    far = min(floor, fastest_start(node_speed, length + way, least, jerk))
    most = min(limit, cap)
    before = min(most, max(near, far))
    stops = geo[LIMIT] <= 0.0 and not unknown
    eased = reduced if stops else min(reduced, ease + jerk * length / cap)
    if far > near:
        return before, length + way, node_speed, least, min(floor, most), eased, node, before_bound
    return before, short, speed, reduced, most, eased, count, before_bound


@compiled
def _put(seg: Segments, k: int, end: Ends) -> None:
    geo = seg.geo[k]
    seg.row[k]["out"] = end[0]
    geo[NODE_WAY], geo[NODE_SPEED], geo[NODE_ACCEL] = end[1], end[2], end[3]
    geo[NODE_FLOOR], geo[EASE], geo[NODE_COUNT] = end[4], end[5], end[6]


@compiled
def _set_limits(seg: Segments, paths: Paths, g: int, known: int, tail: int, dt: float) -> None:
    """Set the highest speeds through the ends of segments `known` up to `tail`: corners, and what can be reached."""
    path = paths.row[g]
    reached = 0.0
    if known > path["head"]:
        reached = seg.geo[slot(paths, g, known - 1), REACHED]
    elif path["state"] == RUNNING or path["state"] == HELD:
        reached = math.inf
    for count in range(known, tail):
        k = slot(paths, g, count)
        row = seg.row[k]
        limit = 0.0
        if count + 1 < tail:
            limit = _corner_limit(row, seg.row[slot(paths, g, count + 1)], dt)
        reached = min(limit, math.sqrt(reached * reached + 2.0 * row["accel"] * row["length"]))
        seg.geo[k, LIMIT], seg.geo[k, REACHED] = limit, reached


@compiled
def plan_with_jerk(seg: Segments, paths: Paths, g: int, dt: float) -> None:
    """Set what `_follow` needs for the end of every queued segment, and `planned`: how many of them are final.

    Two estimates run backward from the tail: coming to rest there, and going on at any speed. Where they meet,
    nothing appended later can change what lies before.
    """
    path = paths.row[g]
    head, tail = int(path["head"]), last_known(path)
    known = head if path["depth"] > 0 else max(int(path["planned"]), head)
    if tail <= known:
        return
    jerk = path["jerk_mm_s3"]
    closed = path["closed"] != 0 and tail == path["tail"]
    _set_limits(seg, paths, g, known, tail, dt)
    k = slot(paths, g, tail - 1)
    row = seg.row[k]
    met = bool(closed or row["flags"] & STOP)
    # What comes into view later may need everything of the last segment but that it can end at rest.
    ease, bound = (math.inf, 0.0) if met else (0.0, float(row["cap"]))
    rest = (0.0, 0.0, 0.0, math.inf, 0.0, ease, tail - 1, bound)
    more = (row["cap"], 0.0, row["cap"], math.inf, row["cap"], math.inf, tail - 1, row["cap"])
    final = tail if met else -1
    _put(seg, k, rest)
    rests = path["limit"] <= tail  # after the last segment, which owes nothing to what comes into view later
    if rests:
        seg.geo[k, EASE] = math.inf
    stop = (0.0, 0.0, 0.0, math.inf, 0.0, math.inf, tail - 1, 0.0)
    to_go = 0.0
    for count in range(tail - 1, known - 1, -1):
        k = slot(paths, g, count)
        row, geo = seg.row[k], seg.geo[k]
        limit, reached, corner = 0.0, 0.0, 0.0
        if count > head:
            last = slot(paths, g, count - 1)
            limit, reached, corner = (
                seg.geo[last, LIMIT],
                seg.geo[last, REACHED],
                seg.row[last]["yield_after"],
            )
        unknown = not met and count == tail - 1
        if not met:
            more = _step_back(seg, k, count, more, limit, reached, corner, unknown, jerk, dt)
        rest = _step_back(seg, k, count, rest, limit, reached, corner, unknown, jerk, dt)
        if rests and unknown:
            _step_back(seg, k, count, stop, limit, reached, corner, False, jerk, dt)
        if count == head:
            geo[SHARE_IN], geo[ZONE_IN] = path["entry_share"], path["entry_zone"]
            geo[REDUCED] = min(geo[REDUCED], row["accel"] * (1.0 - path["entry_share"]))
        if count > known:
            _put(seg, last, rest)
        if final >= 0:
            continue
        if not met:
            met = rest == more
            to_go = row["cap"] * row["accel"] / jerk
        else:  # what is traversed while an acceleration is taken back is looked at beforehand
            to_go -= row["length"]
            if to_go <= 0.0:
                final = count
    if final > path["planned"]:
        path["planned"] = final
