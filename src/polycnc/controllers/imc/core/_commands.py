"""What an axis does about the words that have been written to it since its last turn."""

from __future__ import annotations

from polycnc.controllers.imc.core import _addresses as addr
from polycnc.controllers.imc.core._bits import HOME_NEGATIVE, TGPOS_RANGE
from polycnc.controllers.imc.core._errors import halt_axis, is_blocked
from polycnc.controllers.imc.core._follow import arm_gear, begin_gear, begin_sync, leave_gear
from polycnc.controllers.imc.core._homing import begin_homing
from polycnc.controllers.imc.core._origin import clear_axis, set_origin_here
from polycnc.controllers.imc.core._ownership import (
    ENDS,
    ENGAGE,
    GO,
    HOME,
    NO_GO,
    NO_HOME,
    NO_START,
    REFUSES,
    RUN_AT,
    START,
    cancel_waiting,
    effect_on,
    end_sync,
    take_over,
)
from polycnc.controllers.imc.core._planner import begin_move, can_move, refuse_move, start_velocity
from polycnc.controllers.imc.core._state import GEAR, IDLE, MOVE, RELEASED, SPACES, SYNC, CardState
from polycnc.controllers.imc.core._words import FLAG, get32, get_u16, put16, put32, wrap32
from polycnc.kernel import compiled


@compiled
def _is_refused(s: CardState, i: int, layer: int, command: int, bit: int) -> bool:
    """Tell whether a path or contour refuses a command; one that came right after a path is kept for later."""
    if layer != 0 or effect_on(s, i, command) != REFUSES:
        return False
    axis = s.axis[i]
    by = axis["by"]
    if by == RELEASED or (by < SPACES and s.space[by]["active"] == 0):
        axis["commands"] |= 1 << bit
    return True


@compiled
def _is_kept(s: CardState, i: int, bit: int) -> bool:
    """Tell whether a command has been kept for a later turn."""
    return bool(s.axis[i]["commands"] >> bit & 1)


@compiled
def _is_still(s: CardState, i: int) -> bool:
    """Tell whether axis `i` is out of run or stopped by an error."""
    return bool(s.memory[i, addr.RUN] == 0 or is_blocked(s, i, 0))


@compiled
def _refuse(s: CardState, i: int, layer: int) -> None:
    """Forget a move that cannot be."""
    put16(s.memory, i, layer * addr.PCS + addr.GO, 0)
    put32(s.memory, i, layer * addr.PCS + addr.DIST, 0)


@compiled
def _go(s: CardState, i: int, layer: int, bit: int) -> None:
    m, o, row = s.memory, layer * addr.PCS, s.system[layer, i]
    if m[i, o + addr.GO] == 0:
        if row["mode"] == MOVE or (layer == 0 and effect_on(s, i, NO_GO) == ENDS):
            if layer == 0 and s.axis[i]["home"] == 0:
                take_over(s, i)
            start_velocity(s, layer, i, 0)
        return
    if _is_refused(s, i, layer, GO, bit):
        if not _is_kept(s, i, bit):
            _refuse(s, i, layer)
        return
    distance = get32(m, i, o + addr.DIST)
    before = row["mode"]
    if m[i, addr.RUN] == 0 or is_blocked(
        s, i, 1 if distance > 0 else (-1 if distance < 0 else _way(s, i, layer))
    ):
        _refuse(s, i, layer)
        return
    if not can_move(s, layer, i):
        _refuse(s, i, layer)
        refuse_move(s, layer, i)
        return
    if layer == 0:
        take_over(s, i)
    if not begin_move(s, layer, i, o + addr.MAXVEL):
        put16(m, i, addr.ERROR, get_u16(m, i, addr.ERROR) | TGPOS_RANGE)
        if before in (GEAR, SYNC):
            start_velocity(s, layer, i, 0)
        return
    if layer == 1 and distance != 0 and m[i, addr.SHIFTMASTER] == 0:
        put32(m, i, addr.TGPOS, wrap32(get32(m, i, addr.TGPOS) + distance))


@compiled
def _way(s: CardState, i: int, layer: int) -> int:
    """Return the direction of an absolute move."""
    o = layer * addr.PCS
    left = get32(s.memory, i, o + addr.TGPOS) - get32(s.memory, i, o + addr.TGPOS - 2)
    return 1 if left > 0 else (-1 if left < 0 else 0)


@compiled
def _target_velocity(s: CardState, i: int, layer: int, bit: int) -> None:
    target = get32(s.memory, i, layer * addr.PCS + addr.TGVEL)
    if s.memory[i, addr.RUN] == 0 or _is_refused(s, i, layer, RUN_AT, bit):
        return
    if is_blocked(s, i, 1 if target > 0 else -1) and target != 0:
        return
    if target == 0 and s.system[layer, i]["mode"] == IDLE:
        return
    if layer == 0:
        take_over(s, i)
    start_velocity(s, layer, i, target)


@compiled
def _home(s: CardState, i: int) -> None:
    m = s.memory
    if m[i, addr.GOHOME] == 0:
        if effect_on(s, i, NO_HOME) == ENDS:
            take_over(s, i)
            start_velocity(s, 0, i, 0)
        return
    way = -1 if get_u16(m, i, addr.HOMESEQ) & HOME_NEGATIVE else 1
    refused = effect_on(s, i, HOME) == REFUSES
    if m[i, addr.RUN] == 0 or is_blocked(s, i, way) or refused or get32(m, i, addr.HIGHVEL) == 0:
        put16(m, i, addr.GOHOME, 0)
        return
    take_over(s, i)
    put16(m, i, addr.GOHOME, FLAG)
    begin_homing(s, i)


@compiled
def _gear(s: CardState, i: int) -> None:
    """Engage a gear, let it wait for startsyn, or leave it; one that cannot be shows as refused."""
    m = s.memory
    if m[i, addr.ENGEAR] == 0:
        leave_gear(s, i)
        return
    waits = m[i, addr.ENASYN] != 0
    if not _is_still(s, i):
        if waits:
            arm_gear(s, i)
            return
        if not _is_refused(s, i, 0, ENGAGE, addr.DO_ENGEAR):
            begin_gear(s, i)
            return
        if _is_kept(s, i, addr.DO_ENGEAR):
            return
    cancel_waiting(s, i)


@compiled
def _start_sync(s: CardState, i: int) -> None:
    """Start what waits for startsyn; what cannot start shows as refused, and waits on."""
    if _is_still(s, i):
        put16(s.memory, i, addr.STARTSYN, 0)
    elif not _is_refused(s, i, 0, START, addr.DO_STARTSYN):
        begin_sync(s, i)
    elif not _is_kept(s, i, addr.DO_STARTSYN):
        put16(s.memory, i, addr.STARTSYN, 0)


@compiled
def _sync(s: CardState, i: int, again: bool) -> None:
    """Act on startsyn and enasyn; `again` if startsyn has been written."""
    m, axis = s.memory, s.axis[i]
    waits = axis["waits"] != 0 or axis["prepared"] != 0
    if m[i, addr.STARTSYN] != 0 and m[i, addr.ENASYN] != 0:
        if axis["sync_share"] < 0.0 or (again and waits):
            _start_sync(s, i)
        return
    if effect_on(s, i, NO_START) == ENDS:
        end_sync(s, i)
        if s.system[0, i]["mode"] == SYNC:
            start_velocity(s, 0, i, 0)
    if m[i, addr.ENASYN] == 0 and axis["waits"] != 0:
        cancel_waiting(s, i)
    elif m[i, addr.STARTSYN] != 0 and not waits:
        put16(m, i, addr.STARTSYN, 0)


@compiled
def take_commands(s: CardState, i: int) -> None:
    """Act on the words that have been written to axis `i`."""
    axis, m = s.axis[i], s.memory
    commands = axis["commands"]
    axis["commands"] = 0
    axis["armed"] = min(axis["armed"], 1)
    if commands >> addr.DO_CLEAR & 1 and m[i, addr.CLEAR] != 0:
        clear_axis(s, i)
        put16(m, i, addr.CLEAR, 0)
    if commands >> addr.DO_SETHOME & 1 and m[i, addr.SETHOME] != 0:
        set_origin_here(s, i)
    if commands >> addr.DO_RUN & 1 and m[i, addr.RUN] == 0:
        halt_axis(s, i)
    go, target_velocity = get_u16(m, i, addr.GO), get32(m, i, addr.TGVEL)
    if commands >> addr.DO_ENGEAR & 1:
        _gear(s, i)
    if commands & (1 << addr.DO_STARTSYN | 1 << addr.DO_ENASYN):
        _sync(s, i, commands >> addr.DO_STARTSYN & 1 != 0)
    if commands >> addr.DO_GOHOME & 1:
        _home(s, i)
    if commands >> addr.DO_GO_MCS & 1:  # leaving what moved the axis does not take back what comes with it
        put16(m, i, addr.GO, go)
    if commands >> addr.DO_TGVEL_MCS & 1:
        put32(m, i, addr.TGVEL, target_velocity)
    for layer in range(2):
        velocity = addr.DO_TGVEL_MCS if layer == 0 else addr.DO_TGVEL_PCS
        go = addr.DO_GO_MCS if layer == 0 else addr.DO_GO_PCS
        if commands >> velocity & 1:
            _target_velocity(s, i, layer, velocity)
        if commands >> go & 1:
            _go(s, i, layer, go)
