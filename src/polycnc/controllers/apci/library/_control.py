"""Opening and closing the loops, resetting, machine zero and zero offsets, overrides (Manual 002, 4.4.3 to 4.4.132)."""

# ruff: noqa: E501, N802  the names are the manual's

from __future__ import annotations

from polycnc.controllers.apci.board import _axis_commands as commands
from polycnc.controllers.apci.board._board import Board
from polycnc.controllers.apci.board._commanded import BoardAxis
from polycnc.controllers.apci.board._numbers import is_number
from polycnc.controllers.apci.board._records import AS
from polycnc.controllers.apci.library._call import (
    DOUBLE,
    INT,
    LIBRARY,
    axes_order,
    axis_call,
    board_call,
    record_call,
)
from polycnc.controllers.apci.library._session import UNKNOWN_ERROR, Exchange, Selection, Session
from polycnc.controllers.library import Refused

# fmt: off
cl  = axes_order(commands.cl,  "Close the position loops of the selected axes; each stays where it is",                   8)
clv = axes_order(commands.clv, "Close the position loops; each selected axis goes on with its actual velocity",           9)
ol  = axes_order(commands.ol,  "Open the position loops of the selected axes: 0 V or 0 Hz, PAE outputs off",             41)
ra  = axes_order(commands.ra,  "Reset the selected axes; parameters stay",                                               42)
utrovr = axes_order(commands.utrovr, "Put the trajectory override in force for the selected axes, together",            132)
# fmt: on


@board_call
def rs(board: Board) -> None:
    """Reset the whole board; parameters, common variables and ifs stay (Manual 002, 4.4.113)."""
    commands.rs(board)


@LIBRARY.through(Session.selected_by_new, AS, name="as")
def RPtoDP(asel: Selection) -> None:
    """Make the actual positions the setpoints where no profile runs (Manual 002, 4.4.112).

    Older operating systems than V2.5.3.100 do not know it.
    """
    asel.order(commands.RPtoDP)


@record_call
def shp(tsrp: Exchange) -> None:
    """Make `tsrp.tp` the actual position of axis `tsrp.an`: the machine zero (Manual 002, 4.4.116)."""
    if not is_number(tsrp.record.tp):
        raise Refused(UNKNOWN_ERROR)
    commands.shp(tsrp.axis.board, tsrp.axis.index, tsrp.record.tp)


@board_call
def azo(board: Board, set_: INT) -> None:
    """Put zero offsets 0 to 4 in force for all axes; a higher number ends them (Manual 002, 4.4.3)."""
    commands.azo(board, set_)


@axis_call
def szpa(an: BoardAxis, Position: DOUBLE) -> None:  # noqa: N803
    """Set the virtual zero of an axis to `Position`, from the machine zero (Manual 002, 4.4.127)."""
    commands.szpa(an.board, an.index, Position)


@axis_call
def szpr(an: BoardAxis, Position: DOUBLE) -> None:  # noqa: N803
    """Move the virtual zero of an axis by `Position` (Manual 002, 4.4.128)."""
    commands.szpr(an.board, an.index, Position)


# fmt: off
__all__ = [
    "RPtoDP", "azo", "cl", "clv", "ol", "ra", "rs", "shp", "szpa", "szpr", "utrovr",
]
# fmt: on
