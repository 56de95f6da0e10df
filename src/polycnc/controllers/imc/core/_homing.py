"""Search the origin: run to an edge of the origin switch, come back to that place once or twice, count index pulses.

What to do is in homeseq (`_bits`): the one value that is known from programs, 0014h (origin switch only, positive
direction), means the same here. The closing move has the speed of the stage that it ends, as homing uses highvel and
lowvel alone (Manual 004, 4.3).
"""

from __future__ import annotations

import math

import numpy as np

from polycnc.controllers.imc.core import _addresses as addr
from polycnc.controllers.imc.core._bits import (
    HOME_GO_TO,
    HOME_INDEX,
    HOME_NEGATIVE,
    HOME_RETURNS,
    HOME_RISING,
    HOME_SWITCH,
)
from polycnc.controllers.imc.core._origin import set_origin_at
from polycnc.controllers.imc.core._planner import begin_move, start_velocity
from polycnc.controllers.imc.core._state import IDLE, CardState
from polycnc.controllers.imc.core._words import get32, get_u16, put16, put32
from polycnc.kernel import REFERENCE, KernelState, compiled

_RETURNS_SHIFT = 5

# Phases.
NOT_HOMING = 0
SEEK = 1
FIRST_STOP = 2
RETURN = 3
SECOND_STOP = 4
AGAIN = 5
COUNT = 6
ENDING = 7

# Columns of PHASES. An edge ends a run unless as many returns as are asked for came before it: then it is the origin,
# or the index pulses from it on are counted.
ON_EDGE = 0  # the phase that follows the edge
ON_REST = 1  # the phase that follows standstill
RETURNS = 2  # comings back to the edge before
LEAVES = 3  # 1: the edge is the one by which the axis leaves the switch again
SPEED = 4  # register of the speed, 0 stands
WAY = 5  # 1 in the direction of the search, -1 back

# fmt: off
PHASES = np.array([
    # on edge       on rest       returns  leaves  speed                  way
    (NOT_HOMING,    NOT_HOMING,         0,      0, 0,                       0),  # NOT_HOMING
    (FIRST_STOP,    NOT_HOMING,         0,      0, addr.HIGHVEL,            1),  # SEEK
    (NOT_HOMING,    RETURN,             0,      0, 0,                       0),  # FIRST_STOP
    (SECOND_STOP,   NOT_HOMING,         1,      1, addr.LOWVEL,            -1),  # RETURN
    (NOT_HOMING,    AGAIN,              0,      0, 0,                       0),  # SECOND_STOP
    (NOT_HOMING,    NOT_HOMING,         2,      0, addr.LOWVEL,             1),  # AGAIN
    (NOT_HOMING,    NOT_HOMING,         0,      0, addr.HIGHVEL,            1),  # COUNT
    (NOT_HOMING,    NOT_HOMING,         0,      0, 0,                       0),  # ENDING
], np.int64)
# fmt: on
PHASES.setflags(write=False)

_ORIGIN_BIT = 4  # of `inverted`, and of aio: terminal 2


def home_sequence(
    *, switch: bool, index: bool, negative: bool, rising: bool, go_to: bool, returns: int = 0
) -> int:
    """Return the value of homeseq for a way to search the origin."""
    bits = ((HOME_SWITCH, switch), (HOME_INDEX, index), (HOME_NEGATIVE, negative), (HOME_RISING, rising))
    value = sum(bit for bit, wanted in (*bits, (HOME_GO_TO, go_to)) if wanted)
    return value | returns << _RETURNS_SHIFT


@compiled
def _begin(s: CardState, i: int, phase: int) -> None:
    """Begin a phase: run at its speed in the direction of the search, or back, or come to rest."""
    s.axis[i]["home"] = phase
    register = PHASES[phase, SPEED]
    if register == 0:
        start_velocity(s, 0, i, 0)
        return
    speed = abs(get32(s.memory, i, register))
    negative = (get_u16(s.memory, i, addr.HOMESEQ) & HOME_NEGATIVE) != 0
    start_velocity(s, 0, i, speed if (PHASES[phase, WAY] > 0) != negative else -speed)


@compiled
def begin_homing(s: CardState, i: int) -> None:
    """Start to search the origin as homeseq says."""
    axis, m = s.axis[i], s.memory
    sequence = get_u16(m, i, addr.HOMESEQ)
    if not sequence & (HOME_SWITCH | HOME_INDEX):
        put16(m, i, addr.GOHOME, 0)
        return
    put16(m, i, addr.HOMED, 0)
    axis["home_count"] = 0
    _begin(s, i, SEEK if sequence & HOME_SWITCH else COUNT)


@compiled
def _edge(s: CardState, state: KernelState, i: int, rising: bool) -> bool:
    """Tell whether the origin terminal has risen, or fallen, in this cycle; its place is in `home_edge`."""
    axis, switch = s.axis[i], state.switches.switch[i, REFERENCE]
    comes_on = rising == ((axis["inverted"] & _ORIGIN_BIT) == 0)
    if comes_on:
        axis["home_edge"] = switch["rising_position"]
        return bool(state.switches.rising[i, REFERENCE] != 0)
    axis["home_edge"] = switch["falling_position"]
    return bool(state.switches.falling[i, REFERENCE] != 0)


@compiled
def _count(s: CardState, state: KernelState, i: int, beyond: float) -> bool:
    """Count the index pulses of this cycle that lie beyond a place; True if one of them is the last."""
    axis, marks = s.axis[i], state.switches.marks[i]
    crossed = marks["index_crossed"]
    way = 1.0 if crossed > 0 else -1.0
    for k in range(abs(crossed)):
        at = marks["index_position"] + way * k * marks["index_pitch"]
        if math.isfinite(beyond) and (at - beyond) * way <= 0.0:
            continue
        axis["home_count"] += 1
        if axis["home_count"] >= get_u16(s.memory, i, addr.INDEX_NUM):
            axis["home_edge"] = at
            return True
    return False


@compiled
def _closing_speed(sequence: int) -> int:
    """Return the parameter of the speed that the last stage of a search has."""
    comes_back = sequence & HOME_SWITCH and sequence & HOME_RETURNS
    return addr.LOWVEL if comes_back else addr.HIGHVEL


@compiled
def _found(s: CardState, state: KernelState, i: int) -> None:
    """Set the origin at `home_edge`, and stop or go where it is asked for."""
    axis, m = s.axis[i], s.memory
    set_origin_at(s, i, state.servo.actual[i] - axis["home_edge"])
    axis["home"] = ENDING
    sequence = get_u16(m, i, addr.HOMESEQ)
    if sequence & HOME_GO_TO:
        put32(m, i, addr.DIST, 0)
        put32(m, i, addr.TGPOS, get32(m, i, addr.HOMESTPOS))
        begin_move(s, 0, i, _closing_speed(sequence))
    else:
        start_velocity(s, 0, i, 0)


@compiled
def _turn_back(s: CardState, state: KernelState, i: int, phase: int, returns: int) -> bool:
    """Carry out a phase that is ended by an edge; True if it was the last edge."""
    rising = (get_u16(s.memory, i, addr.HOMESEQ) & HOME_RISING) != 0
    if not _edge(s, state, i, rising != (PHASES[phase, LEAVES] != 0)):
        return False
    if returns <= PHASES[phase, RETURNS]:
        return True
    _begin(s, i, PHASES[phase, ON_EDGE])
    return False


@compiled
def homing_cycle(s: CardState, state: KernelState, i: int) -> None:
    """Take the search of axis `i` one control cycle on, by what it has run over in this one."""
    axis, m = s.axis[i], s.memory
    phase = axis["home"]
    if phase == NOT_HOMING:
        return
    sequence = get_u16(m, i, addr.HOMESEQ)
    beyond = math.inf
    found = False
    if phase in (SEEK, RETURN, AGAIN):  # an edge ends them
        if not _turn_back(s, state, i, phase, min((sequence & HOME_RETURNS) >> _RETURNS_SHIFT, 2)):
            return
        if sequence & HOME_INDEX:
            axis["home"] = COUNT
            beyond = axis["home_edge"]
        else:
            found = True
    if axis["home"] == COUNT:
        found = _count(s, state, i, beyond)
    if found:
        _found(s, state, i)
    elif axis["home"] != COUNT and s.system[0, i]["mode"] == IDLE and get32(m, i, addr.CURVEL) == 0:
        _after_rest(s, i, phase)


@compiled
def _after_rest(s: CardState, i: int, phase: int) -> None:
    """Go on where the axis has come to rest: back, or that was it."""
    following = PHASES[phase, ON_REST]
    if following == NOT_HOMING:
        s.axis[i]["home"] = NOT_HOMING
        put16(s.memory, i, addr.GOHOME, 0)
    else:
        _begin(s, i, following)
