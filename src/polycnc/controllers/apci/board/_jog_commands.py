"""Commands that move single axes: jogs, search runs, stops. Axes by their numbers, targets in the axes' units."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import partial

from polycnc.controllers.apci.board._commanded import CommandedBoard
from polycnc.controllers.apci.core._compiled_entries import begin_jog, brake_axis, brake_on_path, reject_queue
from polycnc.controllers.apci.core._registers import ErrorReg, ModeReg
from polycnc.controllers.apci.core._state import JOG, MOVE, NO_SEARCH, SEARCH_INDEX, SEARCH_REFERENCE


def ja(board: CommandedBoard, axes: Sequence[int], targets: Sequence[float]) -> None:
    """Jog to absolute positions, each axis by itself (Manual 002, 4.4.19)."""
    _command(board, axes, targets, "jac", partial(jog, relative=False))


def jr(board: CommandedBoard, axes: Sequence[int], distances: Sequence[float]) -> None:
    """Jog by distances from the instantaneous positions (Manual 002, 4.4.23)."""
    _command(board, axes, distances, "jac", partial(jog, relative=True))


def _command(
    board: CommandedBoard,
    axes: Sequence[int],
    values: Sequence[float],
    acceleration: str,
    begin: Callable[[CommandedBoard, int, float], None],
) -> None:
    """Command what can be run: an axis named twice refuses all, an open loop or wrong data its axis."""
    if len(set(axes)) < len(axes):
        board.raise_error(ErrorReg.errAxDef)
        return
    for i, value in zip(axes, values, strict=True):
        row = board.state.axis[i]
        if not row["closed"]:
            continue
        if not math.isfinite(value) or row[acceleration] <= 0.0:
            row["dhef"] = 1
            continue
        board.command((i,), partial(begin, board, i, value))


def jog(board: CommandedBoard, i: int, value: float, *, relative: bool) -> None:
    """Begin to jog to, or by, `value`."""
    row, base = board.state.axis[i], board.kernel.base
    here = float(base[i])
    target = here + value if relative else value + board.axes[i].origin
    row["tp"] = target - board.axes[i].origin
    direction = math.copysign(1.0, target - here)
    jvl, jac, jdec = float(row["jvl"]), float(row["jac"]), float(row["jdec"])
    tvl = direction * float(row["jtvl"])
    if jvl > 0.0:
        begin_jog(board.state, base, i, NO_SEARCH, False, target, tvl, jvl, jac, jdec)
    else:  # an endless profile the wrong way
        begin_jog(board.state, base, i, NO_SEARCH, True, 0.0, direction * jvl, abs(jvl), jac, jac)


def jhi(board: CommandedBoard, axes: Sequence[int], distances: Sequence[float]) -> None:
    """Search the encoder's index over a distance (Manual 002, 4.4.20)."""
    _command(board, axes, distances, "hac", search_index)


def search_index(board: CommandedBoard, i: int, distance: float) -> None:
    """Begin to search the index."""
    row, base = board.state.axis[i], board.kernel.base
    target = float(base[i]) + distance
    row["tp"] = target - board.axes[i].origin
    hvl, hac = float(row["hvl"]), float(row["hac"])
    begin_jog(board.state, base, i, SEARCH_INDEX, False, target, 0.0, hvl, hac, hac)


def jhl(board: CommandedBoard, axes: Sequence[int]) -> None:
    """Search the reference switch to the left, without end (Manual 002, 4.4.21)."""
    _command(board, axes, [-1.0] * len(axes), "hac", search_reference)


def jhr(board: CommandedBoard, axes: Sequence[int]) -> None:
    """Search the reference switch to the right, without end (Manual 002, 4.4.22)."""
    _command(board, axes, [1.0] * len(axes), "hac", search_reference)


def search_reference(board: CommandedBoard, i: int, direction: float) -> None:
    """Begin to search the reference switch."""
    row = board.state.axis[i]
    hvl, hac = float(row["hvl"]), float(row["hac"])
    begin_jog(board.state, board.kernel.base, i, SEARCH_REFERENCE, True, 0.0, direction * hvl, hvl, hac, hac)


def js(board: CommandedBoard, axes: Sequence[int]) -> None:
    """Stop each axis by itself with its stop deceleration, and reject the queues (Manual 002, 4.4.24)."""
    for i in axes:
        board.cancel_commands(i)
        brake_axis(board.state, board.kernel, i, float(board.state.axis[i]["sdec"]))


def ms(board: CommandedBoard, axes: Sequence[int], *, deceleration: float | None = None) -> None:
    """Stop along the path, and reject the queues (Manual 002, 4.4.39).

    `deceleration` is that of the path (path units/s2); None for the one in force. An axis past its profile's end, or
    moved by a table, brakes with its stop deceleration.
    """
    for i in axes:
        board.cancel_commands(i)
        row = board.state.axis[i]
        if row["stopping"]:
            reject_queue(board.state, i)
        elif row["motion"] == MOVE:
            rate = deceleration if deceleration is not None else float(row["dec"] * row["tovr"])
            brake_on_path(board.state, i, rate)
        elif row["motion"] == JOG and not row["past"]:
            brake_axis(board.state, board.kernel, i, float(row["dec"] * row["jovr"]))
        else:
            brake_axis(board.state, board.kernel, i, float(row["sdec"]))


def ms_of_pc(board: CommandedBoard, axes: Sequence[int], trac: float) -> None:
    """Stop along the path as the PC's ms does: with TRAC, in path units, if MS_DECEL says so."""
    ms(board, axes, deceleration=trac if board.modereg & ModeReg.MS_DECEL else None)
