"""Contour motion: points of displacements, each spread evenly over the same number of control cycles."""

from __future__ import annotations

from polycnc.controllers.imc.core._addresses import (
    CONTOURING,
    COUNTS,
    GO,
    GROUP,
    GROUPNUM,
    GROUPSMOOTH,
    HPAUSE,
    RUN,
    STARTGROUP,
)
from polycnc.controllers.imc.core._ownership import take_over
from polycnc.controllers.imc.core._state import CFIFO, COORDINATES, GIVEN, IDLE, SPACES, CardState
from polycnc.controllers.imc.core._words import FLAG, ONE, get_u16, put16
from polycnc.kernel import compiled

CONTOUR = SPACES  # the row of `place`, and what `by` calls it


@compiled
def end_contour(s: CardState) -> None:
    """Let the axes of the contour go."""
    s.card[0]["group_row"] = -1
    for i in range(s.axis.shape[0]):
        if s.memory[i, CONTOURING] != 0:
            put16(s.memory, i, CONTOURING, 0)
            if s.system[0, i]["mode"] == GIVEN and s.axis[i]["by"] == CONTOUR:
                s.system[0, i]["mode"] = IDLE


@compiled
def _is_on_a_path(s: CardState, i: int) -> bool:
    by = s.axis[i]["by"]
    return bool(s.system[0, i]["mode"] == GIVEN and by < SPACES and s.space[by]["active"] != 0)


@compiled
def _next_point(s: CardState) -> bool:
    """Take the next point out of the queue; False if there is none, or an axis cannot take part."""
    m, n, card, q = s.memory, s.axis.shape[0], s.card[0], s.fifo[CFIFO]
    count = get_u16(m, n, GROUPNUM)
    if count == 0 or count > COORDINATES or q["tail"] - q["head"] < count:
        return False
    for k in range(count):
        i = get_u16(m, n, GROUP + k)
        if i >= n or m[i, RUN] == 0 or _is_on_a_path(s, i):
            return False
        s.place[CONTOUR, k, 0] = i
        s.place[CONTOUR, k, 1] = s.ring[CFIFO, (q["head"] + k) & (s.ring.shape[1] - 1)]
    for k in range(count):
        i = s.place[CONTOUR, k, 0]
        take_over(s, i)
        s.system[0, i]["mode"] = GIVEN
        s.axis[i]["by"] = CONTOUR
        put16(m, i, CONTOURING, FLAG)
        put16(m, i, GO, 0)
    q["head"] += count
    q["words"] -= count
    put16(m, n, COUNTS[CFIFO], q["words"])
    card["group_count"] = count
    card["group_smooth"] = max(get_u16(m, n, GROUPSMOOTH), 1)
    card["group_row"] = 0
    return True


@compiled
def contour_cycle(s: CardState) -> None:
    """Take contour motion one control cycle on."""
    m, n, card = s.memory, s.axis.shape[0], s.card[0]
    if m[n, STARTGROUP] == 0:
        if card["group_row"] >= 0:
            end_contour(s)
        return
    if m[n, HPAUSE] != 0:
        return
    between = card["group_row"] < 0 or card["group_row"] >= card["group_smooth"]
    if between and not _next_point(s):
        end_contour(s)
        return
    j, cycles = card["group_row"], card["group_smooth"]
    card["group_row"] = j + 1
    for k in range(card["group_count"]):
        i = s.place[CONTOUR, k, 0]
        if s.system[0, i]["mode"] == GIVEN and s.axis[i]["by"] == CONTOUR:
            way = s.place[CONTOUR, k, 1] * ONE
            s.axis[i]["given"] += way * (j + 1) // cycles - way * j // cycles
