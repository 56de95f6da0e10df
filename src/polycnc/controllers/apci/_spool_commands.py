"""Commands of the spoolers: start, pause, empty, special functions, setpoint tables (Manual 002, 4.4.115 ff.)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from polycnc.controllers.apci._entries import reject_queue
from polycnc.controllers.apci._look_ahead import look_ahead
from polycnc.controllers.apci._path_units import path_units
from polycnc.controllers.apci._registers import ErrorReg, ModeReg
from polycnc.controllers.apci._state import (
    ENTRY_BYTES,
    IDLE,
    MOVE,
    POINTS,
    SPECIAL,
    SPOOL_BYTES,
    SPOOL_ENTRIES,
    TABLE,
    WAITING,
)

if TYPE_CHECKING:
    from polycnc.controllers.apci._board import Board

MOST_POINTS = 1000  # of one spd call

RESET_TARGET_VELOCITY = 2001


def free_entry(board: Board) -> int:
    """Take an entry from the free list; -1 if there is none."""
    row = board.state.board[0]
    if row["free"] <= 0:
        board.raise_error(ErrorReg.errSpoolerOverrun)
        return -1
    row["free"] -= 1
    e = int(board.state.free[row["free"]])
    entry = board.state.entry[e]
    entry["started"] = -1
    entry["index"] = -1
    for name in ("begun", "command", "value", "first", "points", "relative"):
        entry[name] = 0
    return e


def give_back(board: Board, e: int) -> None:
    """Return an entry that was not used."""
    row = board.state.board[0]
    board.state.free[row["free"]] = e
    row["free"] += 1


def queued_position(board: Board, i: int) -> float:
    """Return the machine position of axis `i` behind everything it has queued."""
    state, row = board.state, board.state.axis[i]
    for count in range(int(row["tail"]) - 1, int(row["head"]) - 1, -1):
        e = int(state.ring[i, count % SPOOL_ENTRIES])
        entry = state.entry[e]
        if entry["kind"] == MOVE:
            return float(state.seg.end[e, i] / state.weight[e, i])
        if entry["kind"] == TABLE:
            return float(entry["value"])
    return float(board.kernel.base[i])


def queue_entry(board: Board, axes: Sequence[int], e: int) -> bool:
    """Put an entry at the end of the queues of `axes`; False, with nothing queued, if one is full or moves alone."""
    state = board.state
    refused = None
    for i in axes:
        row = state.axis[i]
        if not row["closed"]:
            refused = ErrorReg(0)
        elif row["stopping"] or row["search"]:
            refused = ErrorReg.SpoolerLoadError
        elif row["tail"] - row["head"] >= SPOOL_ENTRIES:
            refused = ErrorReg.errSpoolerOverrun
        if refused is not None:
            board.raise_error(refused)
            give_back(board, e)
            return False
    for i in axes:
        row = state.axis[i]
        state.ring[i, row["tail"] % SPOOL_ENTRIES] = e
        row["tail"] += 1
    if board.modereg & ModeReg.lookahead:
        _look_ahead(board, axes)
    return True


def _look_ahead(board: Board, axes: Sequence[int], last_out: float = 0.0) -> None:
    units = path_units(board, axes)
    if units is None:
        return
    jump = np.zeros(len(board.axes))
    for i in axes:
        jump[i] = units.velocity(board.axes[i].MDVEL)
    for i in axes:
        if look_ahead(board.state, i, jump, last_out):
            board.raise_error(ErrorReg.SpoolerDeepTooLess)


def ssms(board: Board, axes: Sequence[int]) -> None:
    """Start the spoolers of `axes` together; ends a wait for time or inputs (Manual 002, 4.4.120)."""
    rows = [board.state.axis[i] for i in axes]
    for row in rows:
        if row["motion"] == WAITING:
            row["skip_wait"] = 1
    ready = [row for row in rows if row["closed"] and row["head"] < row["tail"]]
    if any(row["motion"] != IDLE for row in ready if not row["running"]):
        return  # only from rest
    for row in ready:
        row["running"] = 1
        row["pe"] = 0


def sstps(board: Board, axes: Sequence[int]) -> None:
    """Pause the spoolers of `axes` behind what they carry out now; ssms goes on (Manual 002, 4.4.121)."""
    for i in axes:
        row = board.state.axis[i]
        if row["motion"] == WAITING:
            row["motion"] = IDLE
            row["pe"] = 1
        row["running"] = 0


def sdels(board: Board, axes: Sequence[int]) -> None:
    """Reject what `axes` have queued behind what they carry out now (Manual 002, 4.4.115)."""
    for i in axes:
        reject_queue(board.state, i, True)


def sstvl(board: Board, axes: Sequence[int], tvl: float) -> None:
    """Give the last move queued for `axes` another target velocity (Manual 002, 4.4.122)."""
    units = path_units(board, axes)
    if units is None or not math.isfinite(tvl):
        return
    for i in axes:
        e = _last_move(board, i)
        if e >= 0:
            entry = board.state.entry[e]
            entry["tvl"] = min(units.velocity(tvl), float(entry["vl"]))
    if board.modereg & ModeReg.lookahead:
        _look_ahead(board, axes, units.velocity(tvl))


def _last_move(board: Board, i: int) -> int:
    row = board.state.axis[i]
    for count in range(int(row["tail"]) - 1, int(row["head"]) - 1, -1):
        e = int(board.state.ring[i, count % SPOOL_ENTRIES])
        if board.state.entry[e]["kind"] == MOVE:
            return e
    return -1


def ssf(board: Board, i: int, command: int, value: float, *, index: int = -1) -> None:
    """Put a special function into the spooler of one axis (Manual 002, 4.4.123)."""
    if not _is_command(command) or not math.isfinite(value):
        return
    if command == RESET_TARGET_VELOCITY:
        e = _last_move(board, i)
        if e >= 0:
            board.state.entry[e]["tvl"] = 0.0
            board.state.entry[e]["out"] = math.nan
        return
    e = free_entry(board)
    if e < 0:
        return
    entry = board.state.entry[e]
    entry["kind"] = SPECIAL
    entry["mask"] = 1 << i
    entry["refs"] = 1
    entry["command"] = command
    entry["value"] = value
    entry["index"] = index
    queue_entry(board, (i,), e)


def _is_command(command: int) -> bool:
    return (
        0 <= command <= 1006
        or command in (1015, 1025, 1101, RESET_TARGET_VELOCITY)
        or 1200 <= command <= 1207
        or 10000 <= command < 12000
        or 20000 <= command < 21000
    )


def spd(board: Board, i: int, points: Sequence[float], *, relative: bool = False, index: int = -1) -> None:
    """Put setpoints, one a scan, into the spooler of an axis (Manual 002, 4.4.117 to 4.4.119)."""
    if not 1 <= len(points) <= MOST_POINTS or not all(map(math.isfinite, points)):
        return
    e = free_entry(board)
    if e < 0:
        return
    state, entry, axis = board.state, board.state.entry[e], board.axes[i]
    first = int(state.board[0]["point"])
    end = queued_position(board, i)
    for k, value in enumerate(points):
        state.points[(first + k) % POINTS] = value if relative else value + axis.origin
    state.board[0]["point"] = (first + len(points)) % POINTS
    entry["kind"] = TABLE
    entry["mask"] = 1 << i
    entry["refs"] = 1
    entry["first"] = first
    entry["points"] = len(points)
    entry["relative"] = relative
    entry["index"] = index
    entry["value"] = end + sum(points) if relative else points[-1] + axis.origin
    queue_entry(board, (i,), e)


def free_bytes(board: Board, i: int) -> int:
    """Return the free spooler memory of an axis (Manual 002, 4.4.84)."""
    return SPOOL_BYTES - ENTRY_BYTES * board.axes[i].queued


def moves_queued(board: Board, i: int) -> int:
    """Return the number of motion commands in the spooler of an axis (Manual 002, 4.4.87)."""
    state, row = board.state, board.state.axis[i]
    kinds = (
        state.entry[int(state.ring[i, count % SPOOL_ENTRIES])]["kind"]
        for count in range(int(row["head"]), int(row["tail"]))
    )
    return sum(kind in (MOVE, TABLE) for kind in kinds)
