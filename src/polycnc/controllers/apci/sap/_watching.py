"""Which values of the board are watched in the scan for a program that polls them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from polycnc.controllers.apci.core import _watch as watch
from polycnc.controllers.apci.core._state import WATCHES
from polycnc.controllers.apci.sap._polling import Read

if TYPE_CHECKING:
    from polycnc.controllers.apci.board._board import Board

_AXIS = {
    "axst": (watch.STATUS,),
    "digi": (watch.SIGNALS,),
    "rp": (watch.ACTUAL,),
    "dp": (watch.SETPOINT,),
    "rv": (watch.ACTUAL_VELOCITY,),
    "dv": (watch.VELOCITY,),
    "tp": (watch.TARGET,),
    "lpndx": (watch.AT_INDEX,),
    "jovr": (watch.JOG_OVERRIDE,),
    "lsm": (watch.USED,),
    "MCiS": (watch.HEAD, watch.TAIL),
    "PcapIndex": (watch.POINT,),
    "PosErr": (watch.DIFFERENCE,),
}
_SYSTEM = {"errorreg": watch.ERRORS}
_BY_INDEX = {"ci": watch.CI, "cd": watch.CD}
_UNWATCHED = frozenset({"mcp"})  # made anew from several values with every reading


def is_watchable(read: Read) -> bool:
    """Tell whether a scan can change what `read` gives only where it is watched."""
    return not (read[0] == "axis" and read[1] in _UNWATCHED)


def watched_by(reads: Iterable[Read]) -> list[tuple[int, int]] | None:
    """Return kind and index of what is to be watched for `reads`; None if it is too much."""
    rows: set[tuple[int, int]] = set()
    for kind, name, where in reads:
        if kind == "axis":
            each = (watch.OUTPUTS,) if name == "digo" else _AXIS.get(name, ())
            rows.update((row, where[0]) for row in each)
        elif kind == "ended":
            rows.update((watch.PROFILE_ENDED, i) for i in where)
        elif name in _BY_INDEX:
            rows.add((_BY_INDEX[name], where))
        elif name in _SYSTEM:
            rows.add((_SYSTEM[name], 0))
    return sorted(rows) if len(rows) <= WATCHES else None


def arm(board: Board, rows: Iterable[tuple[int, int]]) -> None:
    """Let the scan end when one of these values changes; nothing is watched without any."""
    table = board.state.watch
    count = 0
    for count, row in enumerate(rows, 1):
        table[count - 1] = row
    watch.note_watched(board.state, board.kernel, count)
