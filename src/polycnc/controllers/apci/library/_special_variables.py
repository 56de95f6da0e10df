"""Variables that special firmware defines, of the board and of its axes (Manual 002, 2.5).

The manual names the functions without their arguments: an index comes first, behind the axis where there is one.
"""

# ruff: noqa: N802  the names are the manual's

from __future__ import annotations

from typing import Any

from polycnc.controllers.apci.library._library import (
    is_number,
    longint,
    polled_board,
    usable_axis,
    usable_board,
)


def rdSysVarInt(ndx: int) -> int:
    """Return an integer system variable; 0 where there is none (Manual 002, 2.5.1)."""
    board = polled_board()
    return 0 if board is None else int(_read(board.sysvarint, ndx))


def rdSysVarDbl(ndx: int) -> float:
    """Return a floating-point system variable; 0.0 where there is none (Manual 002, 2.5.1)."""
    board = polled_board()
    return 0.0 if board is None else float(_read(board.sysvardbl, ndx))


def wrSysVarInt(ndx: int, value: int) -> None:
    """Write an integer system variable (Manual 002, 2.5.1)."""
    board = usable_board()
    if board is not None and is_number(value):
        _write(board.sysvarint, ndx, longint(value))


def wrSysVarDbl(ndx: int, value: float) -> None:
    """Write a floating-point system variable (Manual 002, 2.5.1)."""
    board = usable_board()
    if board is not None and is_number(value):
        _write(board.sysvardbl, ndx, value)


def rdAxVarInt(an: int, ndx: int) -> int:
    """Return an integer variable of an axis; 0 where there is none (Manual 002, 2.5.2)."""
    axis = usable_axis(an, polled=True)
    return 0 if axis is None else int(_read(axis.varint, ndx))


def rdAxVarDbl(an: int, ndx: int) -> float:
    """Return a floating-point variable of an axis; 0.0 where there is none (Manual 002, 2.5.2)."""
    axis = usable_axis(an, polled=True)
    return 0.0 if axis is None else float(_read(axis.vardbl, ndx))


def wrAxVarInt(an: int, ndx: int, value: int) -> None:
    """Write an integer variable of an axis (Manual 002, 2.5.2)."""
    axis = usable_axis(an)
    if axis is not None and is_number(value):
        _write(axis.varint, ndx, longint(value))


def wrAxVarDbl(an: int, ndx: int, value: float) -> None:
    """Write a floating-point variable of an axis (Manual 002, 2.5.2)."""
    axis = usable_axis(an)
    if axis is not None and is_number(value):
        _write(axis.vardbl, ndx, value)


def _read(variables: Any, ndx: int) -> Any:
    return variables[ndx] if 0 <= ndx < len(variables) else 0


def _write(variables: Any, ndx: int, value: float) -> None:
    if 0 <= ndx < len(variables):
        variables[ndx] = value
