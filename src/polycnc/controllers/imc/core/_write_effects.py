"""Write a parameter as a client does: with all that the write sets off, and nothing for a read-only word."""

from __future__ import annotations

from polycnc.controllers.imc.core import _addresses as addr
from polycnc.controllers.imc.core._ownership import is_pending
from polycnc.controllers.imc.core._parameters import WORDS
from polycnc.controllers.imc.core._state import CAPTURES, GEAR, GOAL, IFIFO, QUEUES, CardState
from polycnc.controllers.imc.core._words import FLAG, get32, get48, get_u16, put16, put32, put48, wrap32
from polycnc.kernel import compiled, entry

_PCS_MOVING = addr.PCS + addr.SYSTEM_MOVING


@compiled
def row_of(s: CardState, at: int, axis: int) -> int:
    """Return the row of memory that holds address `at` for `axis`, or -1 if there is none."""
    n = s.axis.shape[0]
    if at < 0 or at >= WORDS:
        return -1
    if s.word[at, 0] != 0:
        return int(n)
    return axis if 0 <= axis < n else -1


@compiled
def sync_source(s: CardState, i: int) -> int:
    """Return the parameter that paces the synchronous motion of axis `i`."""
    at = get_u16(s.memory, i, addr.SYNSRC)
    row = row_of(s, at, get_u16(s.memory, i, addr.SYNAXIS))
    return get32(s.memory, row, at) if row >= 0 and at + 1 < WORDS else 0


@compiled
def empty_fifo(s: CardState, f: int) -> None:
    """Drop all that queue `f` holds, and the wait it is in; IFIFO, which acts at once, spares what came after it."""
    q = s.fifo[f]
    if s.card[0]["immediate"] == 0:
        q["cut"], q["since"] = q["tail"], 0
    elif f == IFIFO or q["head"] > q["cut"]:
        return
    q["head"] = q["cut"]
    q["words"] = q["since"]
    q["waiting"] = 0
    n = s.axis.shape[0]
    for k in range(QUEUES):
        if k == f:
            put16(s.memory, n, addr.COUNTS[k], q["words"])
            if 0 < k < QUEUES - 1:
                put32(s.memory, n, addr.WAIT_TIMES[k], 0)


@compiled
def keep_capture(s: CardState, i: int, position: int) -> None:
    """Append a captured position; a full buffer keeps what it has."""
    row = s.axis[i]
    if row["captured"] - row["fetched"] >= CAPTURES:
        return
    s.capture[i, row["captured"] % CAPTURES] = position
    row["captured"] += 1
    show_captures(s, i)


@compiled
def show_captures(s: CardState, i: int) -> None:
    """Bring the registers of the capture buffer up to date."""
    row = s.axis[i]
    waiting = row["captured"] - row["fetched"]
    put16(s.memory, i, addr.CAPFIFOCNT, waiting)
    put32(s.memory, i, addr.CAPFIFO, s.capture[i, row["fetched"] % CAPTURES] if waiting > 0 else 0)


@compiled
def _couples_at_once(s: CardState, i: int, action: int) -> bool:
    """Tell whether a word that has been written lets something else move the axis from its next turn on."""
    m = s.memory
    if action == addr.DO_ENGEAR:
        return bool(m[i, addr.ENASYN] == 0)
    if action in (addr.DO_STARTSYN, addr.DO_ENASYN):
        both = m[i, addr.STARTSYN] != 0 and m[i, addr.ENASYN] != 0
        return bool(both and (action == addr.DO_STARTSYN or s.axis[i]["sync_share"] < 0.0))
    return bool(action == addr.DO_GOHOME)


@compiled
def _forget_moves(s: CardState, i: int) -> None:
    """Forget a move or velocity that was commanded since the last turn of an axis: what comes later counts."""
    row = s.axis[i]
    if row["commands"] >> addr.DO_GO_MCS & 1:
        put16(s.memory, i, addr.GO, 0)
        put32(s.memory, i, addr.DIST, 0)
    row["commands"] &= ~(1 << addr.DO_GO_MCS | 1 << addr.DO_TGVEL_MCS)


@compiled
def _command(s: CardState, i: int, action: int, value: int) -> None:
    """Note what an axis has to do in its next turn; what begins a motion shows in the flags at once."""
    row = s.axis[i]
    if value != 0 or action in (addr.DO_TGVEL_MCS, addr.DO_TGVEL_PCS):  # the last one counts
        if action in (addr.DO_GO_MCS, addr.DO_TGVEL_MCS):
            row["commands"] &= ~(1 << addr.DO_GO_MCS | 1 << addr.DO_TGVEL_MCS)
        elif action in (addr.DO_GO_PCS, addr.DO_TGVEL_PCS):
            row["commands"] &= ~(1 << addr.DO_GO_PCS | 1 << addr.DO_TGVEL_PCS)
    if value != 0 and _couples_at_once(s, i, action):
        _forget_moves(s, i)
    row["commands"] |= 1 << action
    if action in (addr.DO_CLEAR, addr.DO_SETHOME):
        s.card[0]["hold"] = 1
    if action == addr.DO_SYNSRCVAR:
        row["armed"] = 2
        row["prepared"] = 1
        if is_pending(s, i):  # what is set up now starts when startsyn is set after it
            put16(s.memory, i, addr.STARTSYN, 0)
    elif action == addr.DO_ENGEAR:
        row["armed"] = 0
    elif action in (addr.DO_STARTSYN, addr.DO_ENASYN):
        row["sync_noted"] = sync_source(s, i)
    if addr.DO_GO_MCS <= action <= addr.DO_GOHOME and value != 0 and s.memory[i, addr.RUN] != 0:
        second = action in (addr.DO_GO_PCS, addr.DO_TGVEL_PCS)
        put16(s.memory, i, _PCS_MOVING if second else addr.SYSTEM_MOVING, FLAG)
        put16(s.memory, i, addr.PROFILING, FLAG)
        put16(s.memory, i, addr.MOVING, FLAG)
        put16(s.memory, i, addr.MOTION, FLAG)


@compiled
def _write_axis_word(s: CardState, i: int, at: int, action: int, value: int) -> None:
    row, m = s.axis[i], s.memory
    if action == addr.DO_CAPTURE:
        position = get48(m, i, addr.ENCP_FRACTION) >> 16
        put32(m, i, addr.CAPPOS, position)
        keep_capture(s, i, position)
    elif action == addr.DO_POPCAP:
        if row["fetched"] < row["captured"]:
            row["fetched"] += 1
        show_captures(s, i)
    elif action == addr.DO_CLRCAP:
        row["fetched"] = row["captured"]
        show_captures(s, i)
    elif action == addr.DO_ZERO:
        put16(m, i, at, 0)
    elif action == addr.DO_CLRENCS:
        put48(m, i, addr.ENCS_FRACTION, 0)


@compiled
def _write_card_word(s: CardState, at: int, action: int, value: int) -> None:
    n = s.axis.shape[0]
    if action == addr.DO_EVENTS:
        if value == 0:
            s.card[0]["events"] = 0
        put16(s.memory, n, addr.EVENTS, s.card[0]["events"])
        return
    for f in range(QUEUES):
        if action == addr.DO_CLEARIMC or addr.COUNTS[f] == at:
            empty_fifo(s, f)


@compiled
def write_word(s: CardState, at: int, axis: int, value: int) -> None:
    """Write one word of a parameter."""
    row = row_of(s, at, axis)
    if row < 0:
        return
    action = int(s.word[at, 1])
    if action == addr.STORE:
        put16(s.memory, row, at, value)
    elif action < addr.REFUSE:
        put16(s.memory, row, at, value)
        _command(s, row, action, value)
    elif action == addr.DO_CLEAR_BITS:
        put16(s.memory, row, at, get_u16(s.memory, row, at) & ~value)
    elif action in (addr.DO_CLEAR_FIFO, addr.DO_CLEARIMC, addr.DO_EVENTS):
        _write_card_word(s, at, action, value)
    elif action != addr.REFUSE:
        _write_axis_word(s, row, at, action, value)


@compiled
def _is_goal(s: CardState, axis: int, value: int) -> bool:
    """Tell whether mcstgvel is written as the goal of a synchronous motion that is being set up, not as a command.

    It is the first write after synsrcvar, as the functions of synchronous motion do. A stop that comes in a later
    cycle than synsrcvar is a stop all the same, and so is any velocity then on a gear.
    """
    if not 0 <= axis < s.axis.shape[0]:
        return False
    row = s.axis[axis]
    armed = row["armed"]
    row["armed"] = 0
    if armed == 0 or s.memory[axis, addr.SYNTYPE] != 0:
        return False
    geared = row["waits"] != 0 or s.system[0, axis]["mode"] == GEAR
    if armed == 2 or (wrap32(value) != 0 and not geared):
        row["prepared"] = GOAL
        return True
    return False


@compiled
def write_words(s: CardState, at: int, axis: int, words: int, value: int) -> None:
    """Write `words` words of a parameter, low word first."""
    if at == addr.TGVEL and words == 2 and _is_goal(s, axis, value):
        put32(s.memory, axis, at, value)
        return
    for k in range(words):
        write_word(s, at + k, axis, (value >> (16 * k)) & 0xFFFF)


@entry
def write_now(s: CardState, at: int, axis: int, words: int, value: int) -> None:
    """Write a parameter between two control cycles."""
    write_words(s, at, axis, words, value)


@entry
def empty_now(s: CardState, f: int) -> None:
    """Empty queue `f` between two control cycles."""
    empty_fifo(s, f)
