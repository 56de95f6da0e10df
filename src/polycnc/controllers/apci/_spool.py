"""The spoolers: each axis works through its own queue, in the scan, without a gap between two entries.

An interpolation stands in the queues of all its axes. Whether they are in step is watched, not enforced: an axis that
was stopped or started alone runs its part of the contour at another time, and `saf` says so (Manual 002, 2.2.8.3).
"""

from __future__ import annotations

import math

from polycnc.controllers.apci._motion import axis_velocity, brake, keep_going, plan_motion
from polycnc.controllers.apci._registers import ErrorReg, ModeReg
from polycnc.controllers.apci._state import (
    IDLE,
    MOVE,
    SPECIAL,
    SPOOL_ENTRIES,
    TABLE,
    WAITING,
    BoardState,
)
from polycnc.kernel import SHORT_REDUCE_START, KernelState, compiled

_SAF_DONE = int(ErrorReg.JSatSAFdone)
_WAIT_REFUSED = int(ErrorReg.SsfWaitRefused)
_TOO_SMALL = int(ErrorReg.ProfileTooSmall)
_STOP_AT_SAF = int(ModeReg.JSatSAF)

SYNC_VARIABLE = 99  # CI99
WAIT_UNIT_S = 64e-6  # of a wait (ssf 1003)

# What a spooled command says.
MET = 0
NOT_MET = 1
STOPS = 2


@compiled
def release(b: BoardState, e: int) -> None:
    """Let one axis be done with entry `e`; the last one gives it back."""
    row = b.entry[e]
    row["refs"] -= 1
    if row["refs"] <= 0:
        board = b.board[0]
        b.free[board["free"]] = e
        board["free"] += 1


@compiled
def drop_entries(b: BoardState, i: int, keep: int) -> None:
    """Reject what axis `i` has queued, but for the first `keep` entries."""
    row = b.axis[i]
    while row["tail"] - row["head"] > keep:
        row["tail"] -= 1
        release(b, int(b.ring[i, row["tail"] % SPOOL_ENTRIES]))


@compiled
def end_entry(b: BoardState, i: int) -> None:
    """Take the entry that axis `i` has finished out of its queue, or give a direct one back."""
    row = b.axis[i]
    if row["direct"] != 0:
        row["direct"] = 0
        release(b, int(row["entry"]))
    else:
        _pass(b, i)
    row["entry"] = -1


@compiled
def _pass(b: BoardState, i: int) -> None:
    """Take the first entry out of axis `i`'s queue; if others have not begun it, they are out of step."""
    row = b.axis[i]
    e = int(b.ring[i, row["head"] % SPOOL_ENTRIES])
    entry = b.entry[e]
    if entry["kind"] == MOVE and entry["begun"] < _count(entry["mask"]):
        _note_asynchrony(b, entry["mask"])
    row["head"] += 1
    release(b, e)


@compiled
def _count(mask: int) -> int:
    count = 0
    while mask != 0:
        mask &= mask - 1
        count += 1
    return count


@compiled
def _note_asynchrony(b: BoardState, mask: int) -> None:
    board = b.board[0]
    for j in range(b.axis.shape[0]):
        if mask >> j & 1:
            b.axis[j]["saf"] = 1
    if board["mode_register"] & _STOP_AT_SAF:
        board["stop_all"] = 1


@compiled
def stop_out_of_step(b: BoardState, state: KernelState) -> None:
    """Brake all axes as by js if the monitor found them out of step and may stop them."""
    board = b.board[0]
    if board["stop_all"] == 0:
        return
    board["stop_all"] = 0
    board["error_register"] |= _SAF_DONE
    for i in range(b.axis.shape[0]):
        leave_and_brake(b, state, i, b.axis[i]["sdec"])


@compiled
def leave_and_brake(b: BoardState, state: KernelState, i: int, rate: float) -> None:
    """Take axis `i` out of whatever it does, reject its queue, and brake it to rest by itself."""
    row = b.axis[i]
    velocity = axis_velocity(b, state, i)
    moves = row["motion"] != IDLE and row["motion"] != WAITING
    give_up(b, i)
    if moves:
        row["pe"] = 0
        brake(b, i, state.base[i], velocity, rate)


@compiled
def give_up(b: BoardState, i: int) -> None:
    """Take axis `i` out of its entry and reject its queue; its motion is up to the caller."""
    row = b.axis[i]
    if row["direct"] != 0 and row["entry"] >= 0:
        row["direct"] = 0
        release(b, int(row["entry"]))
    if row["motion"] == WAITING:
        row["motion"] = IDLE
    row["entry"] = -1
    row["running"] = 0
    row["search"] = 0
    drop_entries(b, i, 0)


@compiled
def take_next(b: BoardState, state: KernelState, i: int, speed: float, lead: float) -> bool:
    """Let axis `i` begin what its queue holds next, entered with path speed `speed`, `lead` seconds ago.

    True if it moves from now on; False if it waits, or nothing is left: then it is in direct mode again.
    """
    row = b.axis[i]
    row["motion"] = IDLE
    while row["running"] != 0 and row["head"] < row["tail"]:
        e = int(b.ring[i, row["head"] % SPOOL_ENTRIES])
        entry = b.entry[e]
        if entry["index"] >= 0:
            row["pcap_index"] = entry["index"]
        if entry["kind"] == SPECIAL:
            answer = MET if row["met"] != 0 else _special(b, i, e, speed)
            row["met"] = 0
            row["skip_wait"] = 0
            if answer == NOT_MET:
                row["motion"] = WAITING
                return False
            _pass(b, i)
            if answer == STOPS:
                row["running"] = 0
                return False
            continue
        row["entry"] = e
        row["pe"] = 0
        if entry["kind"] == TABLE:
            row["motion"] = TABLE
            row["point"] = 0
            row["anchor"] = state.base[i]
        else:
            _begin_move(b, i, e, speed, lead)
        return True
    row["running"] = 0
    return False


@compiled
def _begin_move(b: BoardState, i: int, e: int, speed: float, lead: float) -> None:
    """Begin entry `e` on axis `i`. A speed above its velocity is lowered at once (Manual 002, 2.2.2)."""
    row, entry, board = b.axis[i], b.entry[e], b.board[0]
    if entry["started"] < 0:
        entry["started"] = board["scan"]
        entry["lead"] = lead
    elif entry["started"] != board["scan"] or entry["lead"] != lead:
        _note_asynchrony(b, entry["mask"])
    entry["begun"] += 1
    length = b.seg.row[e]["length"]
    short = length < entry["vl"] * board["dt"]
    row["short_entries"] = row["short_entries"] + 1 if short else 0
    if row["short_entries"] >= 2:
        board["error_register"] |= _TOO_SMALL
    start_move(b, i, e, min(speed, entry["vl"] * row["tovr"]), lead)


@compiled
def start_move(b: BoardState, i: int, e: int, speed: float, lead: float) -> None:
    """Let axis `i` go along entry `e`, entered with path speed `speed`, `lead` seconds ago."""
    row, entry = b.axis[i], b.entry[e]
    row["motion"] = MOVE
    row["entry"] = e
    row["stopping"] = 0
    row["endless"] = 0
    row["target"] = b.seg.row[e]["length"]
    row["tvl"] = entry["tvl"] if math.isnan(entry["out"]) else entry["out"]
    row["vl"] = entry["vl"]
    row["ac"] = entry["ac"]
    row["dec"] = entry["ac"]
    row["policy"] = SHORT_REDUCE_START
    row["pe"] = 0
    plan_motion(b, i, 0.0, speed, lead)


@compiled
def _special(b: BoardState, i: int, e: int, speed: float) -> int:
    """Carry out a spooled command (ssf), or tell that its condition is not met yet."""
    entry = b.entry[e]
    command = int(entry["command"])
    if command < 1000 or command >= 10000:
        _write_variable(b, command, entry["value"])
        return MET
    if command in (1000, 1003, 1004, 1005, 1006, 1015, 1025):
        if speed != 0.0:
            b.board[0]["error_register"] |= _WAIT_REFUSED
            return MET
        return _arrive(b, i, e)
    value = int(entry["value"])
    board = b.board[0]
    if command == 1001:
        board["outputs"] |= value
    elif command == 1002:
        board["outputs"] &= ~value
    elif command == 1101:
        board["irq"] = 1
        board["attention"] |= 1
    elif 1200 <= command <= 1207 and command - 1200 < b.axis.shape[0]:
        other = command - 1200
        if b.axis[other]["closed"] == 0:
            b.axis[other]["mcp"] = value
            b.axis[other]["mcp_written"] = 1
    return MET


@compiled
def _write_variable(b: BoardState, command: int, value: float) -> None:
    if command < 1000:
        b.ci[command] = int(value)
    elif 10000 <= command < 11000:
        b.ci[command - 10000] |= int(value)
    elif 11000 <= command < 12000:
        b.ci[command - 11000] &= ~int(value)
    elif 20000 <= command < 21000:
        b.cd[command - 20000] = value


@compiled
def _arrive(b: BoardState, i: int, e: int) -> int:
    """Begin the wait `e` of axis `i`, which is at rest; tell whether there is nothing to wait for."""
    row, entry = b.axis[i], b.entry[e]
    command, value = int(entry["command"]), int(entry["value"])
    row["met"] = 0
    if command == 1000:
        return STOPS
    if command == 1003:
        row["wait_scans"] = math.ceil(entry["value"] * WAIT_UNIT_S / b.board[0]["dt"] - 1e-9)
        return MET if row["wait_scans"] <= 0 else NOT_MET
    if command == 1004:
        return MET if b.board[0]["inputs"] & value == value else NOT_MET
    if command == 1005:
        b.ci[SYNC_VARIABLE] = value
    elif command == 1015:
        b.ci[SYNC_VARIABLE] += value
    elif command == 1025:
        b.ci[SYNC_VARIABLE] |= 1 << i
    return NOT_MET


@compiled
def look_at_waits(b: BoardState) -> None:
    """Find out which waits are over, for all axes from one state, so that they go on in the same scan."""
    for i in range(b.axis.shape[0]):
        row = b.axis[i]
        if row["motion"] == WAITING:
            row["met"] = 1 if _is_over(b, i) else 0


@compiled
def _is_over(b: BoardState, i: int) -> bool:
    row = b.axis[i]
    entry = b.entry[b.ring[i, row["head"] % SPOOL_ENTRIES]]
    command, value = int(entry["command"]), int(entry["value"])
    if command == 1003:
        row["wait_scans"] -= 1
        return bool(row["wait_scans"] <= 0 or row["skip_wait"] != 0)
    if command == 1004:
        return bool(b.board[0]["inputs"] & value == value or row["skip_wait"] != 0)
    if command == 1006:
        return _all_arrived(b, value)
    if command == 1025:
        return bool(b.ci[SYNC_VARIABLE] & (1 << i) == 0)
    return bool(b.ci[SYNC_VARIABLE] == 0)


@compiled
def _all_arrived(b: BoardState, mask: int) -> bool:
    """Tell whether every axis of a barrier stands at it."""
    for j in range(b.axis.shape[0]):
        if mask >> j & 1:
            row = b.axis[j]
            if row["motion"] != WAITING:
                return False
            entry = b.entry[b.ring[j, row["head"] % SPOOL_ENTRIES]]
            if entry["command"] != 1006 or int(entry["value"]) != mask:
                return False
    return True


@compiled
def leave_path(
    b: BoardState, state: KernelState, i: int, position: float, velocity: float, lead: float
) -> None:
    """Let axis `i`, whose queue has ended with a velocity, go on with it."""
    row = b.axis[i]
    row["pe"] = 1
    keep_going(b, i, position, velocity, lead)
    state.base[i] = position + velocity * lead
