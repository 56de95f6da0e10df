"""Latching positions by the scan, and recording for the graphical system analysis (Manual 002, 4.4.25 to 4.4.27)."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from polycnc.controllers.apci.board import _axis_commands as commands
from polycnc.controllers.apci.board._commanded import BoardAxis
from polycnc.controllers.apci.board._records import LATCH_INFOS
from polycnc.controllers.apci.library._call import INT, LIBRARY, axes_call, axis_call, session_call
from polycnc.controllers.apci.library._session import Selection, Session
from polycnc.controllers.library import Refused


@axis_call
def lps(an: BoardAxis, mst: INT) -> None:
    """Latch the actual position of an axis every `mst` scans, until `mst` is 0 (Manual 002, 4.4.27)."""
    commands.lps(an.board, an.index, mst)


@session_call
def lpr(session: Session, latch_infos: LATCH_INFOS) -> None:
    """Start recording axis `latch_infos.san`; `recording` returns what was recorded (Manual 002, 4.4.25)."""
    axis = session.axis(latch_infos.san)
    commands.lprs(axis.board, (axis.index,))


@axes_call
def lprs(asel: Selection, latch_infos: LATCH_INFOS) -> None:
    """Start recording the selected axes together; `latch_infos.san` is ignored (Manual 002, 4.4.26).

    Ruling: every scan is recorded, until the board's memory for it is full; a new call begins anew.
    """
    asel.order(commands.lprs)


def recording(an: int) -> npt.NDArray[np.float64]:
    """Return what lpr or lprs has recorded of an axis; mcfg.exe shows it on the real board.

    A row per scan: setpoint and actual machine position in axis units, commanded velocity in axis units/s. No rows for
    an axis that is not recorded.
    """
    try:
        board = LIBRARY.default.axis(an).board
    except Refused:
        return np.zeros((0, 3))
    row = board.state.board[0]
    rows = int(row["recorded"]) if int(row["record_axes"]) >> an & 1 else 0
    return np.array(board.state.analysis[:rows, an])


# fmt: off
__all__ = [
    "lpr", "lprs", "lps", "recording",
]
# fmt: on
