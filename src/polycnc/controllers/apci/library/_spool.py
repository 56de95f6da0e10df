"""The spoolers: special functions, setpoint tables, start and pause (Manual 002, 2.2.9).

Commands with PcapIndex show it in rdPcapIndex while they are executed.
"""

# ruff: noqa: E501, N803  the names are the manual's

from __future__ import annotations

from polycnc.controllers.apci.board import _spool_commands as spooler
from polycnc.controllers.apci.board._board import Board
from polycnc.controllers.apci.board._commanded import BoardAxis
from polycnc.controllers.apci.board._numbers import is_number
from polycnc.controllers.apci.board._records import SPDBUF
from polycnc.controllers.apci.library._call import (
    DOUBLE,
    INT,
    LONG,
    PointCount,
    axes_call,
    axes_order,
    axis_call,
    board_call,
)
from polycnc.controllers.apci.library._session import UNKNOWN_ERROR, Selection
from polycnc.controllers.library import Refused

# fmt: off
ssms  = axes_order(spooler.ssms,  "Start the spoolers of the selected axes together; ends a wait for time or inputs",        120)
sstps = axes_order(spooler.sstps, "Pause the spoolers after what they carry out now; ssms goes on",                          121)
sdels = axes_order(spooler.sdels, "Reject what the selected axes have queued; what is carried out now is finished",          115)
# fmt: on


@axes_call
def sstvl(asel: Selection, tvl: DOUBLE) -> None:
    """Give the last move queued another target velocity, to run on into a setpoint table (Manual 002, 4.4.122)."""
    asel.order(spooler.sstvl, tvl)


@board_call
def ClearCI99(board: Board) -> None:  # noqa: N802
    """Clear CI99 between two scans, so that all axes that wait for it go on together (Manual 002, 4.4.7)."""
    board.state.ci[99] = 0


@axis_call
def ssf(axis: BoardAxis, command: INT, value: DOUBLE) -> None:
    """Queue a special function of one axis: outputs, waits, variables, ... (Manual 002, 4.4.123)."""
    spooler.ssf(axis.board, axis.index, command, value)


@axis_call
def ssfi(axis: BoardAxis, command: INT, value: DOUBLE, PcapIndex: LONG) -> None:
    """Queue a special function with an index; only named in the manual (Manual 002, 4.4.94)."""
    spooler.ssf(axis.board, axis.index, command, value, index=PcapIndex)


@axis_call
def ssfni(axis: BoardAxis, command: INT, value: DOUBLE, PcapIndex: LONG) -> None:
    """Queue a special function with an index, as ssfi; only named in the manual (Manual 002, 4.4.94)."""
    spooler.ssf(axis.board, axis.index, command, value, index=PcapIndex)


@axis_call
def spd(an: BoardAxis, size: PointCount, spdbuf: SPDBUF) -> None:
    """Queue `size` absolute setpoints, 1 to 1000, one a scan (Manual 002, 4.4.117)."""
    _points(an, size, spdbuf)


@axis_call
def spda(an: BoardAxis, size: PointCount, spdbuf: SPDBUF, PcapIndex: LONG) -> None:
    """Queue `size` absolute setpoints, one a scan; the index counts up with each (Manual 002, 4.4.118)."""
    _points(an, size, spdbuf, PcapIndex)


@axis_call
def spdr(an: BoardAxis, size: PointCount, spdbuf: SPDBUF, PcapIndex: LONG) -> None:
    """Queue `size` relative setpoints, one a scan; the index counts up with each (Manual 002, 4.4.119)."""
    _points(an, size, spdbuf, PcapIndex, relative=True)


def _points(an: BoardAxis, size: int, spdbuf: SPDBUF, index: int = -1, *, relative: bool = False) -> None:
    points = spdbuf.position[: max(size, 0)]
    if not points or size > len(points) or not all(map(is_number, points)):
        raise Refused(UNKNOWN_ERROR)
    spooler.spd(an.board, an.index, points, relative=relative, index=index)


# fmt: off
__all__ = [
    "ClearCI99", "sdels", "spd", "spda", "spdr", "ssf", "ssfi", "ssfni", "ssms", "sstps", "sstvl",
]
# fmt: on
