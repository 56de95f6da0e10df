"""Variables that special firmware defines, of the board and of its axes (Manual 002, 2.5).

The manual names the functions without their arguments: an index comes first, after the axis where there is one.
"""

# ruff: noqa: N802  the names are the manual's

from __future__ import annotations

from typing import Any

from polycnc.controllers.apci.board._axis import Axis
from polycnc.controllers.apci.board._board import Board
from polycnc.controllers.apci.library._call import (
    DOUBLE,
    INT,
    axis_call,
    board_call,
    polled_axis_call,
    polled_call,
)


@polled_call
def rdSysVarInt(board: Board, ndx: INT) -> INT:
    """Return an integer system variable; 0 where there is none (Manual 002, 2.5.1)."""
    return int(_read(board.sysvarint, ndx))


@polled_call
def rdSysVarDbl(board: Board, ndx: INT) -> DOUBLE:
    """Return a floating-point system variable; 0.0 where there is none (Manual 002, 2.5.1)."""
    return float(_read(board.sysvardbl, ndx))


@board_call
def wrSysVarInt(board: Board, ndx: INT, value: INT) -> None:
    """Write an integer system variable (Manual 002, 2.5.1)."""
    _write(board.sysvarint, ndx, value)


@board_call
def wrSysVarDbl(board: Board, ndx: INT, value: DOUBLE) -> None:
    """Write a floating-point system variable (Manual 002, 2.5.1)."""
    _write(board.sysvardbl, ndx, value)


@polled_axis_call
def rdAxVarInt(an: Axis, ndx: INT) -> INT:
    """Return an integer variable of an axis; 0 where there is none (Manual 002, 2.5.2)."""
    return int(_read(an.varint, ndx))


@polled_axis_call
def rdAxVarDbl(an: Axis, ndx: INT) -> DOUBLE:
    """Return a floating-point variable of an axis; 0.0 where there is none (Manual 002, 2.5.2)."""
    return float(_read(an.vardbl, ndx))


@axis_call
def wrAxVarInt(an: Axis, ndx: INT, value: INT) -> None:
    """Write an integer variable of an axis (Manual 002, 2.5.2)."""
    _write(an.varint, ndx, value)


@axis_call
def wrAxVarDbl(an: Axis, ndx: INT, value: DOUBLE) -> None:
    """Write a floating-point variable of an axis (Manual 002, 2.5.2)."""
    _write(an.vardbl, ndx, value)


def _read(variables: Any, ndx: int) -> Any:
    return variables[ndx] if 0 <= ndx < len(variables) else 0


def _write(variables: Any, ndx: int, value: float) -> None:
    if 0 <= ndx < len(variables):
        variables[ndx] = value


# fmt: off
__all__ = [
    "rdAxVarDbl", "rdAxVarInt", "rdSysVarDbl", "rdSysVarInt", "wrAxVarDbl", "wrAxVarInt", "wrSysVarDbl",
    "wrSysVarInt",
]
# fmt: on
