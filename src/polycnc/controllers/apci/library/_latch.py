"""Latching positions by the scan, and recording for the graphical system analysis (Manual 002, 4.4.25 to 4.4.27)."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from polycnc.controllers.apci.board._records import AS, LATCH_INFOS
from polycnc.controllers.apci.library._library import selected, usable_axis, usable_board


def lps(an: int, mst: int) -> None:
    """Latch the actual position of an axis every `mst` scans, until `mst` is 0 (Manual 002, 4.4.27)."""
    axis = usable_axis(an)
    if axis is not None and mst >= 0:
        axis.row["latch_scans"], axis.row["latch_count"] = int(mst), 0


def lpr(latch_infos: LATCH_INFOS) -> None:
    """Start recording axis `latch_infos.san`; `recording` returns what was recorded (Manual 002, 4.4.25)."""
    lprs(AS(1, [latch_infos.san]), latch_infos)


def lprs(asel: AS, latch_infos: LATCH_INFOS) -> None:
    """Start recording the selected axes together; `latch_infos.san` is ignored (Manual 002, 4.4.26).

    Ruling: every scan is recorded, until the board's memory for it is full; a new call begins anew.
    """
    found = selected(asel)
    if found is not None:
        board, axes = found
        row = board.state.board[0]
        row["record_axes"] = sum(1 << axis for axis in set(axes))
        row["record_every"] = 1
        row["record_count"] = row["recorded"] = 0


def recording(an: int) -> npt.NDArray[np.float64]:
    """Return what lpr or lprs has recorded of an axis; mcfg.exe shows it on the real board.

    A row per scan: setpoint and actual machine position in axis units, commanded velocity in axis units/s. No rows for
    an axis that is not recorded.
    """
    board = usable_board()
    if board is None or not 0 <= an < len(board.axes):
        return np.zeros((0, 3))
    row = board.state.board[0]
    rows = int(row["recorded"]) if int(row["record_axes"]) >> an & 1 else 0
    return np.array(board.state.analysis[:rows, an])
