"""Commands that move single axes: jogs, search runs, stops. Axes by their numbers, targets in the axes' units."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

from polycnc.controllers.apci._entries import begin_jog, brake_axis, brake_on_path
from polycnc.controllers.apci._registers import ErrorReg, ModeReg
from polycnc.controllers.apci._state import JOG, MOVE, NO_SEARCH, SEARCH_INDEX, SEARCH_REFERENCE, TABLE

if TYPE_CHECKING:
    from polycnc.controllers.apci._board import Board


def ja(board: Board, axes: Sequence[int], targets: Sequence[float]) -> None:
    """Jog to absolute positions, each axis by itself (Manual 002, 4.4.19)."""
    for i, target in _accepted(board, axes, targets):
        board.later(partial(_jog, board, i, target, False))


def jr(board: Board, axes: Sequence[int], distances: Sequence[float]) -> None:
    """Jog by distances from the instantaneous positions (Manual 002, 4.4.23)."""
    for i, distance in _accepted(board, axes, distances):
        board.later(partial(_jog, board, i, distance, True))


def _accepted(board: Board, axes: Sequence[int], values: Sequence[float]) -> list[tuple[int, float]]:
    """Return what can be run; an axis named twice refuses all, an open loop or a number that is none its axis."""
    if len(set(axes)) < len(axes):
        board.raise_error(ErrorReg.errAxDef)
        return []
    chosen = [(i, v) for i, v in zip(axes, values, strict=True) if _can_move(board, i) and math.isfinite(v)]
    for i, _ in chosen:
        board.state.axis[i]["pe"] = 0
        board.state.axis[i]["commanded"] += 1
        board.state.axis[i]["saf"] = 0
    return chosen


def _can_move(board: Board, i: int) -> bool:
    return bool(board.state.axis[i]["closed"])


def _jog(board: Board, i: int, value: float, relative: bool) -> None:
    row, axis = board.state.axis[i], board.axes[i]
    row["commanded"] -= 1
    if not row["closed"]:
        row["pe"] = 1
        return
    here = float(board.kernel.base[i])
    target = here + value if relative else value + axis.origin
    row["tp"] = target - axis.origin
    direction = math.copysign(1.0, target - here)
    jvl, jac, jdec = float(row["jvl"]), float(row["jac"]), float(row["jdec"])
    tvl = direction * float(row["jtvl"])
    if jvl > 0.0:
        begin_jog(board.state, board.kernel, i, NO_SEARCH, False, target, tvl, jvl, jac, jdec)
    else:  # an endless profile the wrong way
        begin_jog(board.state, board.kernel, i, NO_SEARCH, True, 0.0, direction * jvl, abs(jvl), jac, jac)


def jhi(board: Board, axes: Sequence[int], distances: Sequence[float]) -> None:
    """Search the encoder's index over a distance (Manual 002, 4.4.20)."""
    for i, distance in _accepted(board, axes, distances):
        board.later(partial(_search_index, board, i, distance))


def _search_index(board: Board, i: int, distance: float) -> None:
    row = board.state.axis[i]
    row["commanded"] -= 1
    target = float(board.kernel.base[i]) + distance
    row["tp"] = target - board.axes[i].origin
    hvl, hac = float(row["hvl"]), float(row["hac"])
    begin_jog(board.state, board.kernel, i, SEARCH_INDEX, False, target, 0.0, hvl, hac, hac)


def jhl(board: Board, axes: Sequence[int]) -> None:
    """Search the reference switch to the left, without end (Manual 002, 4.4.21)."""
    for i, direction in _accepted(board, axes, [-1.0] * len(axes)):
        board.later(partial(_search_reference, board, i, direction))


def jhr(board: Board, axes: Sequence[int]) -> None:
    """Search the reference switch to the right, without end (Manual 002, 4.4.22)."""
    for i, direction in _accepted(board, axes, [1.0] * len(axes)):
        board.later(partial(_search_reference, board, i, direction))


def _search_reference(board: Board, i: int, direction: float) -> None:
    row = board.state.axis[i]
    row["commanded"] -= 1
    hvl, hac = float(row["hvl"]), float(row["hac"])
    begin_jog(board.state, board.kernel, i, SEARCH_REFERENCE, True, 0.0, direction * hvl, hvl, hac, hac)


def js(board: Board, axes: Sequence[int]) -> None:
    """Stop each axis by itself with its stop deceleration, and reject the queues (Manual 002, 4.4.24)."""
    for i in axes:
        brake_axis(board.state, board.kernel, i, float(board.state.axis[i]["sdec"]))


def ms(board: Board, axes: Sequence[int], *, deceleration: float | None = None) -> None:
    """Stop along the path, and reject the queues (Manual 002, 4.4.39).

    `deceleration` is that of the path (path units/s2); None for the one in force. An axis past its profile's end, or
    moved by a table, brakes with its stop deceleration.
    """
    for i in axes:
        row = board.state.axis[i]
        if row["motion"] == MOVE and not row["stopping"]:
            rate = deceleration if deceleration is not None else float(row["dec"] * row["tovr"])
            brake_on_path(board.state, i, rate)
        elif row["motion"] == JOG and not row["pe"] and not row["stopping"]:
            brake_axis(board.state, board.kernel, i, float(row["dec"] * row["jovr"]))
        elif row["motion"] in (JOG, TABLE) and not row["stopping"]:
            brake_axis(board.state, board.kernel, i, float(row["sdec"]))
        elif not row["stopping"]:
            brake_axis(board.state, board.kernel, i, 0.0)


def ms_of_pc(board: Board, axes: Sequence[int], trac: float) -> None:
    """Stop along the path as the PC's ms does: with TRAC, in path units, if MS_DECEL says so."""
    ms(board, axes, deceleration=trac if board.modereg & ModeReg.MS_DECEL else None)
