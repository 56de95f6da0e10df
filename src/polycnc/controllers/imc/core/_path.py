"""The two path spaces: segments of mapped axes, traversed with one speed profile each, joined within a cycle."""

from __future__ import annotations

import math

from polycnc.controllers.imc.core import _addresses as addr
from polycnc.controllers.imc.core._instructions import HEADER, POINTS
from polycnc.controllers.imc.core._planner import REST_SLACK, to_units
from polycnc.controllers.imc.core._state import GIVEN, IDLE, PFIFO1, CardState
from polycnc.controllers.imc.core._words import FLAG, clip32, get32, get_u16, put16, put32
from polycnc.kernel import (
    SHORT_JUMP,
    compiled,
    plan_profile,
    profile_at,
    profile_duration,
    segment_coordinate,
    stop_profile,
)

_SPEED_COUNTS_ON = 3  # X, Y and Z


@compiled
def _feed(s: CardState, g: int) -> float:
    """Return the override that acts on space `g`."""
    n = s.axis.shape[0]
    if s.memory[n, addr.HPAUSE] != 0:
        return 0.0
    return max(get32(s.memory, n, g * addr.SPACE + addr.FEEDRATE), 0) / 65536.0


@compiled
def _point_length(s: CardState, f: int, at: int, count: int) -> float:
    """Return the length of the point whose displacements stand from place `at` of the ring of queue `f` on."""
    mask = s.ring.shape[1] - 1
    counted, riding = 0.0, 0.0
    for k in range(count):
        way = float(s.ring[f, (at + k) & mask])
        if k < _SPEED_COUNTS_ON:
            counted += way * way
        else:
            riding += way * way
    return math.sqrt(counted) if counted > 0.0 else math.sqrt(riding)


@compiled
def _points_ahead(s: CardState, g: int, enough: float) -> float:
    """Return the length of the points that wait at the head of the queue, not looking further than `enough`."""
    f = PFIFO1 + g
    count = get_u16(s.memory, s.axis.shape[0], g * addr.SPACE + addr.PATHAXISNUM)
    mask, at, tail = s.ring.shape[1] - 1, s.fifo[f]["head"], s.fifo[f]["tail"]
    length = 0.0
    while count > 0 and at < tail and s.ring[f, at & mask] == POINTS:
        size = s.ring[f, (at + 1) & mask]
        for k in range(HEADER, size - count + 1, count):
            length += _point_length(s, f, at + k, count)
            if length >= enough:
                return length
        at += size
    return length


@compiled
def _plan(s: CardState, g: int) -> None:
    """Plan the rest of the segment from its present place and speed, which were reached `lead` cycles ago."""
    m, n, o, row = s.memory, s.axis.shape[0], g * addr.SPACE, s.space[g]
    phases = s.phases[2 * n + g]
    feed = 0.0 if row["stopping"] != 0 else _feed(s, g)
    row["feed"] = feed
    weight = row["weight"]
    accel = get32(m, n, o + addr.PATHACC) / 65536.0 * weight
    top = feed * weight * get32(m, n, o + addr.SEGTGVEL) / 65536.0
    end = min(feed * weight * max(get32(m, n, o + addr.SEGENDVEL), 0) / 65536.0, top)
    if row["points"] != 0 and end < top and accel > 0.0:
        ahead = _points_ahead(s, g, (top * top - end * end) / (2.0 * accel))
        end = min(math.sqrt(end * end + 2.0 * accel * ahead), top)
    count = -1
    if top > 0.0:
        length = s.seg.row[g]["length"]
        place, speed = row["place"], row["speed"]
        count = plan_profile(phases, place, speed, length, end, top, accel, accel, 0.0, SHORT_JUMP)
    row["end_speed"] = end
    if count < 0:
        count = stop_profile(phases, row["place"], row["speed"], accel, 0.0)
        row["end_speed"] = -1.0  # not the end of the segment
    row["phases"] = count
    row["duration"] = profile_duration(phases, count)
    row["cycles"] = 0
    row["stale"] = 0


@compiled
def _leave(s: CardState, g: int) -> None:
    """Let the axes of space `g` go, and its segment."""
    row, n, o = s.space[g], s.axis.shape[0], g * addr.SPACE
    for i in range(n):
        if row["mask"] >> i & 1:
            put16(s.memory, i, addr.MOVEINPATH[g], 0)
            if s.system[0, i]["mode"] == GIVEN and s.axis[i]["by"] == g:
                s.system[0, i]["mode"] = IDLE
    row["mask"] = 0
    row["active"] = 0
    row["speed"] = 0.0
    row["stopping"] = 0
    put16(s.memory, n, o + addr.PATHMOVING, 0)
    put32(s.memory, n, o + addr.PATHVEL, 0)


@compiled
def stop_space(s: CardState, g: int, at_once: bool) -> None:
    """Stop interpolation in space `g`, along the path unless `at_once`; the space is switched off then."""
    row = s.space[g]
    if at_once or row["active"] == 0:
        put16(
            s.memory, s.axis.shape[0], g * addr.SPACE + addr.STARTPATH, 0
        )  # the next cycle lets the axes go
    elif row["stopping"] == 0:
        row["stopping"] = 1
        row["stale"] = 1


@compiled
def _give(s: CardState, g: int, at: float) -> None:
    """Give every axis what it has to move to be at path length `at`."""
    for k in range(s.space[g]["count"]):
        position = to_units(segment_coordinate(s.seg, g, k, at))
        s.axis[s.place[g, k, 0]]["given"] += position - s.place[g, k, 1]
        s.place[g, k, 1] = position


@compiled
def _sample(s: CardState, g: int) -> float:
    row = s.space[g]
    phases = s.phases[2 * s.axis.shape[0] + g]
    t = row["lead"] + row["cycles"]
    past = t - row["duration"]
    ends = row["end_speed"] >= 0.0
    if not ends or past < (-REST_SLACK if row["end_speed"] == 0.0 else 0.0):
        at, speed, _ = profile_at(phases, row["phases"], min(t, row["duration"]))
        row["place"] = at
        row["speed"] = 0.0 if past >= 0.0 else speed
        _give(s, g, at)
        return -1.0
    length = s.seg.row[g]["length"]
    _, speed, _ = profile_at(phases, row["phases"], row["duration"])
    row["place"] = length
    row["speed"] = speed
    _give(s, g, length)
    row["active"] = 0
    return max(float(past), 0.0)


@compiled
def _rest_space(s: CardState, g: int) -> None:
    """Let space `g` be at rest after its last segment, and its axes go once they have taken what they were given."""
    n = s.axis.shape[0]
    s.space[g]["speed"] = 0.0
    put16(s.memory, n, g * addr.SPACE + addr.PATHMOVING, 0)
    put32(s.memory, n, g * addr.SPACE + addr.PATHVEL, 0)
    for i in range(n):
        if s.space[g]["mask"] >> i & 1 and s.axis[i]["given"] != 0:
            return
    _leave(s, g)


@compiled
def begin_space_cycle(s: CardState, g: int) -> bool:
    """Begin the control cycle of space `g`; False if it is switched off."""
    row = s.space[g]
    if s.memory[s.axis.shape[0], g * addr.SPACE + addr.STARTPATH] == 0:
        if row["mask"] != 0:
            _leave(s, g)
        return False
    if row["active"] != 0:
        halted = row["end_speed"] < 0.0 and row["speed"] == 0.0
        if row["stopping"] == 0 and (halted or row["feed"] != _feed(s, g)):
            row["stale"] = 1
        if row["stale"] != 0:
            row["lead"] = 1.0
        else:
            row["cycles"] += 1
    return True


@compiled
def go_along(s: CardState, g: int) -> float:
    """Take space `g` along its segment; return the time left over behind its end, negative if it is not there."""
    row = s.space[g]
    if row["stale"] != 0:
        _plan(s, g)
    return _sample(s, g)


@compiled
def end_space_cycle(s: CardState, g: int) -> None:
    """End the control cycle of space `g`."""
    n, row = s.axis.shape[0], s.space[g]
    if row["active"] == 0:
        if row["mask"] != 0:
            _rest_space(s, g)
    elif row["stopping"] != 0 and row["speed"] == 0.0:
        row["stopping"] = 0
        put16(s.memory, n, g * addr.SPACE + addr.STARTPATH, 0)  # the next cycle lets the axes go
    else:
        put16(s.memory, n, g * addr.SPACE + addr.PATHMOVING, FLAG)
        put32(s.memory, n, g * addr.SPACE + addr.PATHVEL, clip32(to_units(row["speed"] / row["weight"])))
