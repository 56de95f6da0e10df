"""Motion at once: jogs, searches, stops, lines, circles, helices (Manual 002, 4.4.19 to 4.4.39).

Speeds and distances of interpolation are in the units of ctru; a jog takes those of its axis.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeAlias

from polycnc.controllers.apci.board import _jog_commands as jogs
from polycnc.controllers.apci.board import _move_commands as moves
from polycnc.controllers.apci.board._move_commands import Speeds
from polycnc.controllers.apci.board._path_units import path_units
from polycnc.controllers.apci.board._records import AS, CMP, HMP, HMP3D, LMP, TSRP
from polycnc.controllers.apci.library._library import on_axes, selected
from polycnc.errors import UsageError

Command: TypeAlias = Callable[..., None]

# ---------------------------------------------------------------------- single axes


def ja(asel: AS, tsrp: Sequence[TSRP]) -> None:
    """Jog the selected axes to `tsrp[axis].tp`, each by itself (Manual 002, 4.4.19).

    `tsrp` is the whole sequence of records, indexed by axis number; accelerations and velocities are those that
    wrjac, wrjvl and wrjtvl wrote.

    Raises:
        UsageError: `tsrp` has no record for a selected axis.
    """
    _jog(jogs.ja, asel, tsrp)


def jr(asel: AS, tsrp: Sequence[TSRP]) -> None:
    """Jog the selected axes by `tsrp[axis].tp`, each by itself (Manual 002, 4.4.23).

    Raises:
        UsageError: `tsrp` has no record for a selected axis.
    """
    _jog(jogs.jr, asel, tsrp)


def jhi(asel: AS, tsrp: Sequence[TSRP]) -> None:
    """Search the encoder's index over the distance `tsrp[axis].tp` (Manual 002, 4.4.20).

    Raises:
        UsageError: `tsrp` has no record for a selected axis.
    """
    _jog(jogs.jhi, asel, tsrp)


def _jog(command: Command, asel: AS, tsrp: Sequence[TSRP]) -> None:
    found = selected(asel)
    if found is None:
        return
    board, axes = found
    if isinstance(tsrp, TSRP) or max(axes) >= len(tsrp):
        raise UsageError(
            "there is no TSRP record for every selected axis", hint="pass all records: tsrp_array()"
        )
    command(board, axes, [tsrp[axis].tp for axis in axes])


def jhl(asel: AS) -> None:
    """Search the reference switches to the left (Manual 002, 4.4.21)."""
    on_axes(jogs.jhl, asel)


def jhr(asel: AS) -> None:
    """Search the reference switches to the right (Manual 002, 4.4.22)."""
    on_axes(jogs.jhr, asel)


def js(asel: AS) -> None:
    """Stop each selected axis by itself with its stop deceleration; queues are rejected (Manual 002, 4.4.24)."""
    on_axes(jogs.js, asel)


def ms(asel: AS) -> None:
    """Stop the selected axes along their path; queues are rejected (Manual 002, 4.4.39).

    With MODEREG bit MS_DECEL the deceleration is TRAC.
    """
    found = selected(asel)
    if found is not None:
        board, axes = found
        units = path_units(board, axes)
        trac = board.variables.trac
        jogs.ms_of_pc(board, axes, trac if units is None else units.acceleration(trac))


# ---------------------------------------------------------------------- interpolation


def mla(asel: AS, lmp: LMP) -> None:
    """Move on a straight line to the targets `lmp.dtm[axis]` (Manual 002, 4.4.37)."""
    line(moves.mla, asel, lmp)


def mlr(asel: AS, lmp: LMP) -> None:
    """Move on a straight line by the distances `lmp.dtm[axis]` (Manual 002, 4.4.38)."""
    line(moves.mlr, asel, lmp)


def mca(asel: AS, cmp: CMP) -> None:
    """Move on a circle of the first two selected axes about an absolute centre (Manual 002, 4.4.28)."""
    circle(moves.mca, asel, cmp)


def mcr(asel: AS, cmp: CMP) -> None:
    """Move on a circle of the first two selected axes about a centre from the present position (Manual 002, 4.4.29)."""
    circle(moves.mcr, asel, cmp)


def mha(asel: AS, hmp: HMP) -> None:
    """Move on a helix, centre and targets absolute (Manual 002, 4.4.35).

    Targets are `hmp.dtm[axis]`; those of the circle count if `hmp.phi` is no angle, and its sign is the sense.
    """
    helix(moves.mha, asel, hmp)


def mhr(asel: AS, hmp: HMP) -> None:
    """Move on a helix, centre and distances from the present position (Manual 002, 4.4.36)."""
    helix(moves.mhr, asel, hmp)


def mca3d(asel: AS, hmp3d: HMP3D) -> None:
    """Move on a circle in space about an absolute centre (Manual 002, 4.4.30)."""
    circle_in_space(moves.mca3d, asel, hmp3d)


def mcr3d(asel: AS, hmp3d: HMP3D) -> None:
    """Move on a circle in space about a centre from the present position (Manual 002, 4.4.31)."""
    circle_in_space(moves.mcr3d, asel, hmp3d)


# ---------------------------------------------------------------------- from records to commands


def line(command: Command, asel: AS, lmp: LMP, *, spool: bool = False) -> None:
    """Give the command for a straight line."""
    found = selected(asel)
    if found is not None:
        board, axes = found
        speeds = Speeds(lmp.ac, lmp.vl, lmp.tvl)
        command(board, axes, [lmp.dtm[axis] for axis in axes], speeds, spool=spool)


def circle(command: Command, asel: AS, cmp: CMP, *, spool: bool = False) -> None:
    """Give the command for a circle, which two axes take."""
    found = selected(asel, 2)
    if found is not None:
        board, axes = found
        speeds = Speeds(cmp.ac, cmp.vl, cmp.tvl)
        command(board, axes[:2], (cmp.dtca1, cmp.dtca2), cmp.phi, speeds, spool=spool)


def helix(command: Command, asel: AS, hmp: HMP, *, spool: bool = False) -> None:
    """Give the command for a helix, which at least two axes take."""
    found = selected(asel, 2)
    if found is not None:
        board, axes = found
        speeds = Speeds(hmp.ac, hmp.vl, hmp.tvl)
        ends = [hmp.dtm[axis] for axis in axes]
        command(board, axes, (hmp.dtca1, hmp.dtca2), hmp.phi, ends, speeds, spool=spool)


def circle_in_space(command: Command, asel: AS, hmp3d: HMP3D, *, spool: bool = False) -> None:
    """Give the command for a circle in space, which three axes take."""
    found = selected(asel, 3)
    if found is not None:
        board, axes = found
        center = (hmp3d.dtca1, hmp3d.dtca2, hmp3d.dtca3)
        normal = (hmp3d.pn1, hmp3d.pn2, hmp3d.pn3)
        speeds = Speeds(hmp3d.ac, hmp3d.vl, hmp3d.tvl)
        command(board, axes[:3], center, normal, hmp3d.phi, speeds, spool=spool)
