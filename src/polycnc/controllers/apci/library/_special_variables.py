"""Variables that special firmware defines, of the board and of its axes (Manual 002, 2.5).

The manual names the functions without their arguments: an index comes first, after the axis where there is one.
"""

# ruff: noqa: N816  the names are the manual's

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeAlias

from polycnc.controllers.apci.board._board import Board
from polycnc.controllers.apci.board._commanded import BoardAxis
from polycnc.controllers.apci.library._call import (
    DOUBLE,
    INT,
    axis_call,
    board_call,
    polled_axis_call,
    polled_call,
)
from polycnc.controllers.library import named

Pair: TypeAlias = tuple[Callable[..., Any], Callable[..., None]]


def _pair(name: str, field: str, kind: Any, noun: str, of_axis: bool) -> Pair:
    """Make the function that reads a field of variables of the board or of an axis, and the one that writes it."""
    number = float if kind is DOUBLE else int

    def read(owner: Any, ndx: int) -> float:
        variables = getattr(owner, field)
        return number(variables[ndx] if 0 <= ndx < len(variables) else 0)

    def write(owner: Any, ndx: int, value: float) -> None:
        variables = getattr(owner, field)
        if 0 <= ndx < len(variables):
            variables[ndx] = value

    first = {"an": BoardAxis} if of_axis else {"board": Board}
    reads, writes = (polled_axis_call, axis_call) if of_axis else (polled_call, board_call)
    source = f"(Manual 002, 2.5.{2 if of_axis else 1})."
    what = f"{noun} variable of an axis" if of_axis else f"{noun} system variable"
    text = f"Return {what}; {number()} where there is none {source}"
    return (
        reads(named(read, f"rd{name}", text, {**first, "ndx": INT}, kind)),
        writes(named(write, f"wr{name}", f"Write {what} {source}", {**first, "ndx": INT, "value": kind})),
    )


rdSysVarInt, wrSysVarInt = _pair("SysVarInt", "sysvarint", INT, "an integer", of_axis=False)
rdSysVarDbl, wrSysVarDbl = _pair("SysVarDbl", "sysvardbl", DOUBLE, "a floating-point", of_axis=False)
rdAxVarInt, wrAxVarInt = _pair("AxVarInt", "varint", INT, "an integer", of_axis=True)
rdAxVarDbl, wrAxVarDbl = _pair("AxVarDbl", "vardbl", DOUBLE, "a floating-point", of_axis=True)

# fmt: off
__all__ = [
    "rdAxVarDbl", "rdAxVarInt", "rdSysVarDbl", "rdSysVarInt", "wrAxVarDbl", "wrAxVarInt", "wrSysVarDbl",
    "wrSysVarInt",
]
# fmt: on
