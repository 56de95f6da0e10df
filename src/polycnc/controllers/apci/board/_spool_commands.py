"""Commands of the spoolers: start, pause, empty, special functions, setpoint tables (Manual 002, 4.4.115 ff.)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial
from typing import Any

from polycnc.controllers.apci.board._commanded import CommandedBoard
from polycnc.controllers.apci.board._path_units import path_units, trajectory_units
from polycnc.controllers.apci.core._compiled_entries import aim_at_velocity, reject_queue
from polycnc.controllers.apci.core._registers import ErrorReg
from polycnc.controllers.apci.core._spool_entries import (
    look_ahead_again,
    new_entry,
    queue_entry,
    queued_position,
)
from polycnc.controllers.apci.core._state import (
    IDLE,
    MOVE,
    POINTS,
    SPECIAL,
    SPOOL_ENTRIES,
    TABLE,
    WAITING,
)

MOST_POINTS = 1000  # of one spd call

RESET_TARGET_VELOCITY = 2001


def ssms(board: CommandedBoard, axes: Sequence[int]) -> None:
    """Start the spoolers of `axes` together; ends a wait for time or inputs (Manual 002, 4.4.120).

    An axis that still carries out the entry at which sstps will halt it continues after that entry.
    """
    board.in_turn(axes, partial(start_spoolers, board, axes))


def start_spoolers(board: CommandedBoard, axes: Sequence[int]) -> None:
    """Start the spoolers of `axes`, if they are at rest."""
    rows = [board.state.axis[i] for i in axes]
    for row in rows:
        if row["motion"] == WAITING:
            row["skip_wait"] = 1
    ready = [row for row in rows if row["closed"] and row["head"] < row["tail"] and not row["running"]]
    resumes = board.config.rulings.ssms_undoes_sstps
    if not all(row["motion"] in (IDLE, WAITING) or (resumes and _works_on_its_queue(row)) for row in ready):
        return  # only from rest
    for row in ready:
        row["running"] = 1
        row["pe"] = 0


def _works_on_its_queue(row: Any) -> bool:
    return bool(row["motion"] in (MOVE, TABLE) and not row["direct"] and not row["stopping"])


def sstps(board: CommandedBoard, axes: Sequence[int]) -> None:
    """Pause the spoolers of `axes` after what they carry out now; ssms goes on (Manual 002, 4.4.121)."""
    for i in axes:
        board.state.axis[i]["running"] = 0


def sdels(board: CommandedBoard, axes: Sequence[int]) -> None:
    """Reject what `axes` have queued after what they carry out now (Manual 002, 4.4.115)."""
    board.in_turn(axes, partial(reject_queued, board, axes))


def reject_queued(board: CommandedBoard, axes: Sequence[int]) -> None:
    """Reject what `axes` have queued."""
    for i in axes:
        reject_queue(board.state, i)


def sstvl(board: CommandedBoard, axes: Sequence[int], tvl: float) -> None:
    """Give the last move queued for `axes` another target velocity (Manual 002, 4.4.122)."""
    units = path_units(board, axes)
    if units is None:
        board.raise_error(ErrorReg.errUnit)
    elif math.isfinite(tvl):
        board.in_turn(axes, partial(aim_last_moves, board, axes, units.velocity(tvl), units.velocity_unit))


def aim_last_moves(board: CommandedBoard, axes: Sequence[int], tvl: float, velocity_unit: float) -> None:
    """Give the last move queued for `axes` another target velocity, path units/s."""
    for e in {_last_move(board, i) for i in axes} - {-1}:
        aim_at_velocity(board.state, e, tvl)
    look_ahead_again(board.state, sum(1 << i for i in axes), velocity_unit)


def _last_move(board: CommandedBoard, i: int) -> int:
    row = board.state.axis[i]
    for count in range(int(row["tail"]) - 1, int(row["head"]) - 1, -1):
        e = int(board.state.ring[i, count % SPOOL_ENTRIES])
        if board.state.entry[e]["kind"] == MOVE:
            return e
    return -1


def ssf(board: CommandedBoard, i: int, command: int, value: float, *, index: int = -1) -> None:
    """Put a special function into the spooler of one axis (Manual 002, 4.4.123)."""
    if not _is_command(command) or not math.isfinite(value):
        return
    if command == RESET_TARGET_VELOCITY:
        board.in_turn((i,), partial(aim_last_moves, board, (i,), 0.0, trajectory_units(board)[0]))
    else:
        board.in_turn((i,), partial(add_special, board, i, command, value, index=index))


def add_special(board: CommandedBoard, i: int, command: int, value: float, *, index: int) -> None:
    """Put a special function after what the spooler of an axis holds."""
    e = _new(board, i, SPECIAL, index)
    if e < 0:
        return
    entry = board.state.entry[e]
    entry["command"] = command
    entry["value"] = value
    queue_entry(board.state, e, 0.0)


def _new(board: CommandedBoard, i: int, kind: int, index: int) -> int:
    """Take an entry for one axis; -1 if there is none."""
    e = int(new_entry(board.state))
    if e >= 0:
        entry = board.state.entry[e]
        entry["kind"] = kind
        entry["mask"] = 1 << i
        entry["refs"] = 1
        entry["index"] = index
    return e


def _is_command(command: int) -> bool:
    return (
        0 <= command <= 1006
        or command in (1015, 1025, 1101, RESET_TARGET_VELOCITY)
        or 1200 <= command <= 1207
        or 10000 <= command < 12000
        or 20000 <= command < 21000
    )


def spd(
    board: CommandedBoard, i: int, points: Sequence[float], *, relative: bool = False, index: int = -1
) -> None:
    """Put setpoints, one a scan, into the spooler of an axis (Manual 002, 4.4.117 to 4.4.119)."""
    if not 1 <= len(points) <= MOST_POINTS or not all(map(math.isfinite, points)):
        return
    board.in_turn((i,), partial(add_points, board, i, tuple(points), relative=relative, index=index))


def add_points(board: CommandedBoard, i: int, points: Sequence[float], *, relative: bool, index: int) -> None:
    """Put a table after what the spooler of an axis holds."""
    state, axis = board.state, board.axes[i]
    end = queued_position(state, board.kernel.base, i) + sum(points) if relative else points[-1] + axis.origin
    e = _new(board, i, TABLE, index) if math.isfinite(end) else -1
    if e < 0:
        return
    first = int(axis.row["points"])
    entry = state.entry[e]
    entry["first"] = first
    entry["points"] = len(points)
    entry["relative"] = relative
    entry["value"] = end
    if queue_entry(state, e, trajectory_units(board)[0]):
        for k, value in enumerate(points):
            state.points[i, (first + k) % POINTS] = value if relative else value + axis.origin
