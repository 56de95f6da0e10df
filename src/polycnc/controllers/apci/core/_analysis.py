"""Recording for the graphical system analysis: setpoint, actual position, command of chosen axes (lpr, lprs)."""

from __future__ import annotations

from polycnc.controllers.apci.core._state import BoardState
from polycnc.kernel import KernelState, compiled


@compiled
def analysis_cycle(b: BoardState, state: KernelState) -> None:
    """Append a row of what is recorded, in every so many scans, until the buffer is full."""
    board = b.board[0]
    if board["record_every"] <= 0 or board["recorded"] >= b.analysis.shape[0]:
        return
    board["record_count"] += 1
    if board["record_count"] < board["record_every"]:
        return
    board["record_count"] = 0
    row = b.analysis[board["recorded"]]
    for i in range(b.axis.shape[0]):
        if board["record_axes"] >> i & 1:
            row[i, 0] = state.setpoint[i]
            row[i, 1] = state.servo.actual[i]
            row[i, 2] = state.servo.row[i]["output"]
    board["recorded"] += 1
