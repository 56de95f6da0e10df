"""The spoolers: what the move commands queue, special functions, setpoint tables, start and pause (Manual 002, 2.2.9).

Commands with PcapIndex show it in rdPcapIndex while they are executed.
"""

# ruff: noqa: N803  the names are the manual's

from __future__ import annotations

from polycnc.controllers.apci.board import _move_commands as moves
from polycnc.controllers.apci.board import _spool_commands as spooler
from polycnc.controllers.apci.board._records import AS, CMP, HMP, HMP3D, LMP, SPDBUF
from polycnc.controllers.apci.core._state import SPOOL_ENTRIES
from polycnc.controllers.apci.library._library import (
    is_number,
    longint,
    on_axes,
    selected,
    usable_axis,
    usable_board,
)
from polycnc.controllers.apci.library._motion import Command, circle, circle_in_space, helix, line

# ---------------------------------------------------------------------- moves


def smla(asel: AS, lmp: LMP) -> None:
    """Queue a straight line to the targets `lmp.dtm[axis]` (Manual 002, 4.4.37)."""
    line(moves.mla, asel, lmp, spool=True)


def smlr(asel: AS, lmp: LMP) -> None:
    """Queue a straight line by the distances `lmp.dtm[axis]` (Manual 002, 4.4.38)."""
    line(moves.mlr, asel, lmp, spool=True)


def smlai(asel: AS, lmp: LMP, PcapIndex: int) -> None:
    """Queue a straight line to targets, with an index; only named in the manual (Manual 002, 4.4.94)."""
    _with_index(moves.mla, asel, lmp, PcapIndex)


def smlri(asel: AS, lmp: LMP, PcapIndex: int) -> None:
    """Queue a straight line by distances, with an index; only named in the manual (Manual 002, 4.4.94)."""
    _with_index(moves.mlr, asel, lmp, PcapIndex)


def _with_index(command: Command, asel: AS, lmp: LMP, index: int) -> None:
    found = selected(asel)
    if found is None:
        return
    board, axes = found
    row = board.state.axis[axes[0]]
    tail = int(row["tail"])
    line(command, asel, lmp, spool=True)
    if row["tail"] > tail:
        entry = int(board.state.ring[axes[0], tail % SPOOL_ENTRIES])
        board.state.entry[entry]["index"] = longint(index)


def smca(asel: AS, cmp: CMP) -> None:
    """Queue a circle about an absolute centre (Manual 002, 4.4.28)."""
    circle(moves.mca, asel, cmp, spool=True)


def smcr(asel: AS, cmp: CMP) -> None:
    """Queue a circle about a centre from where the move begins (Manual 002, 4.4.29)."""
    circle(moves.mcr, asel, cmp, spool=True)


def smha(asel: AS, hmp: HMP) -> None:
    """Queue a helix, centre and targets absolute (Manual 002, 4.4.35)."""
    helix(moves.mha, asel, hmp, spool=True)


def smhr(asel: AS, hmp: HMP) -> None:
    """Queue a helix, centre and distances from where the move begins (Manual 002, 4.4.36)."""
    helix(moves.mhr, asel, hmp, spool=True)


def smca3d(asel: AS, hmp3d: HMP3D) -> None:
    """Queue a circle in space about an absolute centre (Manual 002, 4.4.30)."""
    circle_in_space(moves.mca3d, asel, hmp3d, spool=True)


def smcr3d(asel: AS, hmp3d: HMP3D) -> None:
    """Queue a circle in space about a centre from where the move begins (Manual 002, 4.4.31)."""
    circle_in_space(moves.mcr3d, asel, hmp3d, spool=True)


# ---------------------------------------------------------------------- start, pause, empty


def ssms(asel: AS) -> None:
    """Start the spoolers of the selected axes together; ends a wait for time or inputs (Manual 002, 4.4.120)."""
    on_axes(spooler.ssms, asel)


def sstps(asel: AS) -> None:
    """Pause the spoolers behind what they carry out now; ssms goes on (Manual 002, 4.4.121)."""
    on_axes(spooler.sstps, asel)


def sdels(asel: AS) -> None:
    """Reject what the selected axes have queued; what is carried out now is finished (Manual 002, 4.4.115)."""
    on_axes(spooler.sdels, asel)


def sstvl(asel: AS, tvl: float) -> None:
    """Give the last move queued another target velocity, to run on into a setpoint table (Manual 002, 4.4.122)."""
    if is_number(tvl):
        on_axes(spooler.sstvl, asel, tvl)


def ClearCI99() -> None:  # noqa: N802
    """Clear CI99 between two scans, so that all axes that wait for it go on together (Manual 002, 4.4.7)."""
    board = usable_board()
    if board is not None:
        board.state.ci[99] = 0


# ---------------------------------------------------------------------- special functions and setpoint tables


def ssf(axis: int, command: int, value: float) -> None:
    """Queue a special function of one axis: outputs, waits, variables, ... (Manual 002, 4.4.123)."""
    ssfi(axis, command, value, -1)


def ssfi(axis: int, command: int, value: float, PcapIndex: int) -> None:
    """Queue a special function with an index; only named in the manual (Manual 002, 4.4.94)."""
    one = usable_axis(axis)
    if one is not None and is_number(value):
        spooler.ssf(one.board, one.index, int(command), value, index=longint(PcapIndex))


def ssfni(axis: int, command: int, value: float, PcapIndex: int) -> None:
    """Queue a special function with an index, as ssfi; only named in the manual (Manual 002, 4.4.94)."""
    ssfi(axis, command, value, PcapIndex)


def spd(an: int, size: int, spdbuf: SPDBUF) -> None:
    """Queue `size` absolute setpoints, 1 to 1000, one a scan (Manual 002, 4.4.117)."""
    spda(an, size, spdbuf, -1)


def spda(an: int, size: int, spdbuf: SPDBUF, PcapIndex: int) -> None:
    """Queue `size` absolute setpoints, one a scan; the index counts up with each (Manual 002, 4.4.118)."""
    _points(an, size, spdbuf, PcapIndex, relative=False)


def spdr(an: int, size: int, spdbuf: SPDBUF, PcapIndex: int) -> None:
    """Queue `size` relative setpoints, one a scan; the index counts up with each (Manual 002, 4.4.119)."""
    _points(an, size, spdbuf, PcapIndex, relative=True)


def _points(an: int, size: int, spdbuf: SPDBUF, index: int, *, relative: bool) -> None:
    axis = usable_axis(an)
    if axis is None or not 1 <= size <= len(spdbuf.position):
        return
    points = spdbuf.position[:size]
    if all(map(is_number, points)):
        spooler.spd(axis.board, axis.index, points, relative=relative, index=longint(index))
