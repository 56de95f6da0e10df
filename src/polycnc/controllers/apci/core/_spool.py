"""The spoolers: each axis works through its own queue, in the scan, without a gap between two entries.

An interpolation stands in the queues of all its axes. Whether they are in step is watched, not enforced: an axis that
was stopped or started alone runs its part of the contour at another time, and `saf` says so (Manual 002, 2.2.8.3).
"""

from __future__ import annotations

import math

from polycnc.controllers.apci.core._motion import axis_velocity, brake, keep_going, plan_motion, rest
from polycnc.controllers.apci.core._registers import ErrorReg, ModeReg
from polycnc.controllers.apci.core._special_functions import MET, NOT_MET, STOPS, carry_out
from polycnc.controllers.apci.core._state import (
    BY_SYSTEM,
    ENTRY_BYTES,
    IDLE,
    MOVE,
    POINT_BYTES,
    SPECIAL,
    SPOOL_ENTRIES,
    TABLE,
    WAITING,
    BoardState,
)
from polycnc.kernel import SHORT_REDUCE_START, KernelState, compiled

_SAF_DONE = int(ErrorReg.JSatSAFdone)
_TOO_SMALL = int(ErrorReg.ProfileTooSmall)
_STOP_AT_SAF = int(ModeReg.JSatSAF)


@compiled
def bytes_of(b: BoardState, e: int) -> int:
    """Return the spooler memory that entry `e` takes."""
    return int(ENTRY_BYTES + POINT_BYTES * b.entry[e]["points"])


@compiled
def free_entry(b: BoardState, e: int) -> None:
    """Put entry `e` back on the free list."""
    board = b.board[0]
    b.free[board["free"]] = e
    board["free"] += 1


@compiled
def release(b: BoardState, e: int) -> None:
    """Let one axis be done with entry `e`; the last one gives it back."""
    row = b.entry[e]
    row["refs"] -= 1
    if row["refs"] <= 0:
        free_entry(b, e)


@compiled
def drop_entries(b: BoardState, i: int, keep: int) -> None:
    """Reject what axis `i` has queued, but for the first `keep` entries."""
    row = b.axis[i]
    while row["tail"] - row["head"] > keep:
        row["tail"] -= 1
        e = int(b.ring[i, row["tail"] % SPOOL_ENTRIES])
        row["used"] -= bytes_of(b, e)
        row["points"] -= b.entry[e]["points"]
        release(b, e)


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
    """Take the first entry out of axis `i`'s queue."""
    row = b.axis[i]
    e = int(b.ring[i, row["head"] % SPOOL_ENTRIES])
    row["head"] += 1
    row["used"] -= bytes_of(b, e)
    release(b, e)


@compiled
def _count(mask: int) -> int:
    count = 0
    while mask != 0:
        mask &= mask - 1
        count += 1
    return count


@compiled
def watch_step(b: BoardState) -> None:
    """Look whether all axes of each interpolation that began in this scan have begun it."""
    scan = b.board[0]["scan"]
    for i in range(b.axis.shape[0]):
        row = b.axis[i]
        if row["motion"] == MOVE and row["direct"] == 0:
            entry = b.entry[row["entry"]]
            if entry["started"] == scan and entry["begun"] < _count(entry["mask"]):
                _note_asynchrony(b, entry["mask"])


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
        leave_and_brake(b, state, i, b.axis[i]["sdec"], BY_SYSTEM)


@compiled
def leave_and_brake(b: BoardState, state: KernelState, i: int, rate: float, who: int) -> None:
    """Take axis `i` out of whatever it does, reject its queue, and brake it to rest by itself."""
    row = b.axis[i]
    velocity = axis_velocity(b, i)
    moves = row["motion"] != IDLE and row["motion"] != WAITING
    give_up(b, i)
    if moves:
        brake(b, i, state.base[i], velocity, rate, who)
    else:
        rest(b, i)


@compiled
def give_up(b: BoardState, i: int) -> None:
    """Take axis `i` out of its entry and reject its queue; its motion is up to the caller."""
    row = b.axis[i]
    if row["direct"] != 0:
        row["direct"] = 0
        release(b, int(row["entry"]))
    if row["motion"] == WAITING:
        row["motion"] = IDLE
    row["entry"] = -1
    row["running"] = 0
    row["search"] = 0
    row["past"] = 0
    row["ends_at_speed"] = 0
    drop_entries(b, i, 0)


@compiled
def take_next(b: BoardState, state: KernelState, i: int, speed: float, lead: float) -> bool:
    """Let axis `i` begin what its queue holds next, entered with path speed `speed`, `lead` seconds ago.

    True if it moves from now on; False if it waits, or nothing is left: then it is in direct mode again.
    """
    row = b.axis[i]
    waited = row["motion"] == WAITING
    row["motion"] = IDLE
    while row["head"] < row["tail"] and (row["running"] != 0 or waited):
        e = int(b.ring[i, row["head"] % SPOOL_ENTRIES])
        entry = b.entry[e]
        if entry["index"] >= 0:
            row["pcap_index"] = entry["index"]
        if entry["kind"] == SPECIAL:
            answer = MET if waited else carry_out(b, state, i, e)
            waited = False
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
        if entry["kind"] == TABLE:
            row["motion"] = TABLE
            row["point"] = 0
            row["speed"] = 0.0
            row["ends_at_speed"] = 0
            row["anchor"] = state.base[i]
        else:
            _begin_move(b, i, e, speed, lead)
        return True
    row["running"] = 0
    row["short_entries"] = 0
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
    row["ends_at_speed"] = 1 if entry["tvl"] != 0.0 else 0
    length = b.seg.row[e]["length"]
    short = length < entry["vl"] * board["dt"]
    row["short_entries"] = row["short_entries"] + 1 if short else 0
    if row["short_entries"] >= 2:
        board["error_register"] |= _TOO_SMALL
    start_move(b, i, e, min(speed, entry["vl"] * row["tovr"]), lead)


@compiled
def start_move(b: BoardState, i: int, e: int, speed: float, lead: float) -> None:
    """Let axis `i` follow entry `e`, entered with path speed `speed`, `lead` seconds ago."""
    row, entry = b.axis[i], b.entry[e]
    row["motion"] = MOVE
    row["entry"] = e
    row["stopping"] = 0
    row["past"] = 0
    row["endless"] = 0
    row["target"] = b.seg.row[e]["length"]
    row["tvl"] = entry["tvl"] if math.isnan(entry["out"]) else entry["out"]
    row["vl"] = entry["vl"]
    row["ac"] = entry["ac"]
    row["dec"] = entry["ac"]
    row["policy"] = SHORT_REDUCE_START
    row["tp"] = b.seg.end[e, i] / b.weight[e, i] - row["zero"] - row["offset"]
    plan_motion(b, i, 0.0, speed, lead, False)


@compiled
def leave_path(
    b: BoardState, state: KernelState, i: int, position: float, velocity: float, lead: float
) -> None:
    """Let axis `i`, whose queue has ended with a velocity, go on with it."""
    keep_going(b, i, position, velocity, lead)
    state.base[i] = position + velocity * lead
