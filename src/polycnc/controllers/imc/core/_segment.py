"""A segment of a path: its axes, its ends, its shape, taken out of the queue of its space."""

from __future__ import annotations

import math

from polycnc.controllers.imc.core import _addresses as addr
from polycnc.controllers.imc.core._bits import INSERR
from polycnc.controllers.imc.core._instructions import ARC, HEADER, POINTS
from polycnc.controllers.imc.core._ownership import take_over
from polycnc.controllers.imc.core._planner import to_units
from polycnc.controllers.imc.core._queue import cell, drop_head, drop_point
from polycnc.controllers.imc.core._state import COORDINATES, GIVEN, IDLE, PFIFO1, RELEASED, SPACES, CardState
from polycnc.controllers.imc.core._words import FLAG, get48, get_u16, get_u32, put16, put32
from polycnc.kernel import compiled, set_arc, set_line

_SPEED_COUNTS_ON = 3  # X, Y and Z


@compiled
def _is_elsewhere(s: CardState, g: int, i: int) -> bool:
    """Tell whether the other path space or a contour has axis `i` under way."""
    by = s.axis[i]["by"]
    if s.system[0, i]["mode"] != GIVEN or by in (g, RELEASED):
        return False
    if by < SPACES:
        return bool(s.space[by]["active"] != 0)
    return bool(0 <= s.card[0]["group_row"] < s.card[0]["group_smooth"])


@compiled
def _map_axes(s: CardState, g: int, count: int, whole: bool) -> bool:
    """Find the axes of the coordinates; False, with an error on those there are, if one cannot take part."""
    m, n, o = s.memory, s.axis.shape[0], g * addr.SPACE
    named = get_u16(m, n, o + addr.PATHAXISNUM)
    fits = whole and (named == 0 or count <= named)
    mask = 0
    for k in range(min(count, COORDINATES)):
        i = get_u16(m, n, o + addr.SEGMAP + k)
        if i >= n or mask >> i & 1:
            fits = False
        else:
            mask |= 1 << i
            fits = fits and m[i, addr.RUN] != 0 and not _is_elsewhere(s, g, i)
            s.place[g, k, 0] = i
    if not fits:
        for i in range(n):
            if mask >> i & 1:
                put16(m, i, addr.ERROR, get_u16(m, i, addr.ERROR) | INSERR)
        return False
    for i in range(n):
        if s.space[g]["mask"] >> i & 1 and not mask >> i & 1:
            put16(m, i, addr.MOVEINPATH[g], 0)
            if s.axis[i]["given"] != 0:
                s.axis[i]["by"] = RELEASED
            else:
                s.system[0, i]["mode"] = IDLE
    s.space[g]["mask"] = mask
    return True


@compiled
def _set_ends(s: CardState, g: int, count: int, at: int, relative: bool) -> None:
    """Fill start and end, which stands from cell `at` on, of the segment, and take the axes over."""
    m, f = s.memory, PFIFO1 + g
    start, end = s.point[2 * g], s.point[2 * g + 1]
    for k in range(start.shape[0]):
        start[k] = 0.0
        end[k] = 0.0
        s.counted[g, k] = 0
    for k in range(count):
        i = s.place[g, k, 0]
        position = get48(m, i, addr.POS_FRACTION) + s.axis[i]["given"]
        s.place[g, k, 1] = position
        start[k] = position / 65536.0
        end[k] = float(cell(s, f, at + k))
        if relative or m[i, addr.PATHABS] == 0:
            end[k] += start[k]
        s.counted[g, k] = 1 if k < _SPEED_COUNTS_ON else 0
        put32(m, i, addr.SEGSTART, position >> 16)
        put32(m, i, addr.SEGEND, to_units(end[k]) >> 16)
        take_over(s, i)
        s.system[0, i]["mode"] = GIVEN
        s.axis[i]["by"] = g
        put16(m, i, addr.GO, 0)
        put16(m, i, addr.MOVEINPATH[g], FLAG)


@compiled
def _set_arc(s: CardState, g: int) -> bool:
    """Make the segment an arc; its direction is negative from X to Y if it is clockwise."""
    m, n, o, f = s.memory, s.axis.shape[0], g * addr.SPACE, PFIFO1 + g
    start, end = s.point[2 * g], s.point[2 * g + 1]
    x, y = float(cell(s, f, HEADER + 5)), float(cell(s, f, HEADER + 6))
    if m[s.place[g, 0, 0], addr.PATHABS] == 0:
        x += start[0]
    if m[s.place[g, 1, 0], addr.PATHABS] == 0:
        y += start[1]
    counter = cell(s, f, HEADER + 7) != 0
    begin = math.atan2(start[1] - y, start[0] - x)
    sweep = math.atan2(end[1] - y, end[0] - x) - begin
    if counter and sweep <= 0.0:
        sweep += 2.0 * math.pi
    elif not counter and sweep >= 0.0:
        sweep -= 2.0 * math.pi
    put16(m, n, o + addr.ARCDIR, FLAG if counter else 0)
    put32(m, n, o + addr.RADIUS, int(math.hypot(start[0] - x, start[1] - y) + 0.5))
    return set_arc(s.seg, g, s.counted[g], start, end, 0, 1, x, y, sweep, 0.0, 0, 0)


@compiled
def _set_segment(s: CardState, g: int) -> bool:
    """Take the segment at the head of the queue into work; False if there is nothing to follow."""
    m, n, o, f = s.memory, s.axis.shape[0], g * addr.SPACE, PFIFO1 + g
    count = cell(s, f, HEADER + 2)
    if cell(s, f, HEADER + 1) != 0:
        put32(m, n, o + addr.SEGTGVEL, cell(s, f, HEADER + 3))
        put32(m, n, o + addr.SEGENDVEL, cell(s, f, HEADER + 4))
    if not _map_axes(s, g, count, True):
        return False
    _set_ends(s, g, count, HEADER + 8, False)
    start, end = s.point[2 * g], s.point[2 * g + 1]
    if cell(s, f, HEADER) == ARC:
        fits = _set_arc(s, g)
    else:
        put32(m, n, o + addr.RADIUS, 0)
        fits = set_line(s.seg.row, s.seg.start, s.seg.end, g, s.counted[g], start, end, 0.0, 0, 0)
    put32(m, n, o + addr.SEGID, get_u32(m, n, o + addr.SEGID) + 1)
    if fits:
        _set_length(s, g, count)
    return fits


@compiled
def _set_point(s: CardState, g: int, count: int) -> bool:
    """Take the point at the head of the queue, of `count` displacements, into work as a line."""
    m, n, o, f = s.memory, s.axis.shape[0], g * addr.SPACE, PFIFO1 + g
    whole = 0 < count <= min(COORDINATES, cell(s, f, 1) - HEADER)
    if not _map_axes(s, g, max(count, 1), whole):
        return False
    _set_ends(s, g, count, HEADER, True)
    start, end = s.point[2 * g], s.point[2 * g + 1]
    put32(m, n, o + addr.RADIUS, 0)
    put32(m, n, o + addr.SEGID, get_u32(m, n, o + addr.SEGID) + 1)
    if not set_line(s.seg.row, s.seg.start, s.seg.end, g, s.counted[g], start, end, 0.0, 0, 0):
        return False
    _set_length(s, g, count)
    return True


@compiled
def _set_length(s: CardState, g: int, count: int) -> None:
    """Show the length of the segment that has been taken into work, and note what its speed counts on."""
    m, n, o, row = s.memory, s.axis.shape[0], g * addr.SPACE, s.space[g]
    start, end = s.point[2 * g], s.point[2 * g + 1]
    length = s.seg.row[g]["length"]
    row["count"] = count
    row["weight"] = 1.0
    alone = get_u16(m, n, o + addr.ASSEGLEN)
    if 0 < alone <= count and abs(end[alone - 1] - start[alone - 1]) > 0.0:
        row["weight"] = length / abs(end[alone - 1] - start[alone - 1])
    put32(m, n, o + addr.SEGLEN, int(length / row["weight"] + 0.5))


@compiled
def begin_segment(s: CardState, g: int, lead: float) -> bool:
    """Begin the segment at the head of the queue with the path speed there is."""
    row = s.space[g]
    speed = row["speed"] / row["weight"] if row["weight"] > 0.0 else 0.0
    f = PFIFO1 + g
    points = cell(s, f, 0) == POINTS
    if points:
        count = get_u16(s.memory, s.axis.shape[0], g * addr.SPACE + addr.PATHAXISNUM)
        begun = _set_point(s, g, count)
        drop_point(s, f, count if count > 0 else cell(s, f, 1))
    else:
        begun = _set_segment(s, g)
        drop_head(s, f)
    if not begun:
        return False
    row["points"] = 1 if points else 0
    row["active"] = 1
    row["place"] = 0.0
    row["speed"] = speed * row["weight"]
    row["lead"] = lead
    row["stale"] = 1
    return True
