"""What a board is and does in one scan, as a value."""

from __future__ import annotations

from dataclasses import dataclass

from polycnc.controllers.apci.board._commanded import CommandedBoard
from polycnc.controllers.apci.core._registers import Axst, ErrorReg, ModeReg


@dataclass(frozen=True, slots=True)
class AxisStatus:
    """One axis, by the manual's names and in its own units."""

    rp: float
    dp: float
    rv: float
    dv: float
    axst: Axst
    mcp: int
    queued: int


@dataclass(frozen=True, slots=True)
class BoardStatus:
    """A board in one scan; `inputs` and `outputs` bit by bit, number 1 is bit 0."""

    cycle: int
    time_s: float
    axes: tuple[AxisStatus, ...]
    inputs: int
    outputs: int
    errorreg: ErrorReg
    modereg: ModeReg


def board_status(board: CommandedBoard) -> BoardStatus:
    """Return the status of a board in its present scan."""
    return BoardStatus(
        cycle=board.clock.cycles,
        time_s=board.clock.now_s,
        axes=tuple(
            AxisStatus(axis.rp, axis.dp, axis.rv, axis.dv, axis.axst, axis.mcp, axis.queued)
            for axis in board.axes
        ),
        inputs=board.inputs,
        outputs=board.outputs,
        errorreg=board.errorreg,
        modereg=board.modereg,
    )
