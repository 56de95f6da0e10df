"""Opening and closing the loops, resetting, machine zero and zero offsets, overrides (Manual 002, 4.4.3 to 4.4.132)."""

# ruff: noqa: N802  the names are the manual's

from __future__ import annotations

from polycnc.controllers.apci.board import _axis_commands as commands
from polycnc.controllers.apci.board._records import AS, TSRP
from polycnc.controllers.apci.library._library import (
    RPTODP_SINCE,
    is_number,
    on_axes,
    revision,
    usable_axis,
    usable_board,
)
from polycnc.controllers.apci.pc._slots import revision_numbers


def cl(asel: AS) -> None:
    """Close the position loops of the selected axes; each stays where it is (Manual 002, 4.4.8)."""
    on_axes(commands.cl, asel)


def clv(asel: AS) -> None:
    """Close the position loops; each selected axis goes on with its actual velocity (Manual 002, 4.4.9)."""
    on_axes(commands.clv, asel)


def ol(asel: AS) -> None:
    """Open the position loops of the selected axes: 0 V or 0 Hz, PAE outputs off (Manual 002, 4.4.41)."""
    on_axes(commands.ol, asel)


def ra(asel: AS) -> None:
    """Reset the selected axes; parameters stay (Manual 002, 4.4.42)."""
    on_axes(commands.ra, asel)


def rs() -> None:
    """Reset the whole board; parameters, common variables and ifs stay (Manual 002, 4.4.113)."""
    board = usable_board()
    if board is not None:
        commands.rs(board)


def RPtoDP(asel: AS) -> None:
    """Make the actual positions the setpoints where no profile runs (Manual 002, 4.4.112).

    Older operating systems than V2.5.3.100 do not know it.
    """
    if revision_numbers(revision()) >= revision_numbers(RPTODP_SINCE):
        on_axes(commands.RPtoDP, asel)


def shp(tsrp: TSRP) -> None:
    """Make `tsrp.tp` the actual position of axis `tsrp.an`: the machine zero (Manual 002, 4.4.116)."""
    axis = usable_axis(tsrp.an)
    if axis is not None and is_number(tsrp.tp):
        commands.shp(axis.board, axis.index, tsrp.tp)


def azo(set_: int) -> None:
    """Put zero offsets 0 to 4 in force for all axes; a higher number ends them (Manual 002, 4.4.3)."""
    board = usable_board()
    if board is not None:
        commands.azo(board, int(set_))


def szpa(an: int, Position: float) -> None:  # noqa: N803
    """Set the virtual zero of an axis to `Position`, from the machine zero (Manual 002, 4.4.127)."""
    axis = usable_axis(an)
    if axis is not None and is_number(Position):
        commands.szpa(axis.board, axis.index, Position)


def szpr(an: int, Position: float) -> None:  # noqa: N803
    """Move the virtual zero of an axis by `Position` (Manual 002, 4.4.128)."""
    axis = usable_axis(an)
    if axis is not None and is_number(Position):
        commands.szpr(axis.board, axis.index, Position)


def utrovr(asel: AS) -> None:
    """Put the trajectory override in force for the selected axes, together (Manual 002, 4.4.132)."""
    on_axes(commands.utrovr, asel)
