"""Commands that open and close loops, reset, and set positions; by the manual's names, axes by their numbers."""

from __future__ import annotations

import math
from collections.abc import Sequence

from polycnc.controllers.apci.board._commanded import CommandedBoard
from polycnc.controllers.apci.core._compiled_entries import go_on_with, stand
from polycnc.controllers.apci.core._registers import ModeReg
from polycnc.kernel import ADDED


def cl(board: CommandedBoard, axes: Sequence[int]) -> None:
    """Close the position loops of `axes`; each stays where it is (Manual 002, 4.4.8)."""
    for i in axes:
        _close(board, i)


def clv(board: CommandedBoard, axes: Sequence[int]) -> None:
    """Close the position loops of `axes`; each goes on with its actual velocity (Manual 002, 4.4.9)."""
    for i in axes:
        velocity = float(board.state.axis[i]["rv"])
        _close(board, i)
        if velocity != 0.0:
            board.kernel.velocity[i] = velocity
            go_on_with(board.state, i, float(board.kernel.base[i]), velocity)


def _close(board: CommandedBoard, i: int) -> None:
    row, kernel = board.state.axis[i], board.kernel
    board.cancel_commands(i)
    stand(board.state, i)
    kernel.base[i] = _base_at_actual(board, i)
    kernel.setpoint[i] = kernel.servo.actual[i]
    kernel.velocity[i] = 0.0
    kernel.servo.row[i]["running"] = 0
    kernel.servo.row[i]["loop_closed"] = 1
    row["closed"] = 1
    row["saf"] = row["held"] = row["hard_limit"] = row["soft_limit"] = row["position_error"] = 0
    if row["stepper"]:
        row["referenced"] = 0
    board.outputs |= int(board.state.plan[i]["PAE"])


def _base_at_actual(board: CommandedBoard, i: int) -> float:
    """Return what the profile must give for the setpoint to be where the axis is."""
    added = board.kernel.ptp.row[ADDED, i]["position"] + board.state.axis[i]["shift"]
    return float(board.kernel.servo.actual[i] - added)


def ol(board: CommandedBoard, axes: Sequence[int]) -> None:
    """Open the position loops of `axes`: 0 V or 0 Hz, PAE off (Manual 002, 4.4.41)."""
    for i in axes:
        _open(board, i)
        board.outputs &= ~int(board.state.plan[i]["PAE"])


def _open(board: CommandedBoard, i: int) -> None:
    row = board.state.axis[i]
    board.cancel_commands(i)
    stand(board.state, i)
    row["closed"] = row["held"] = 0
    if row["stepper"]:
        row["referenced"] = 0
    board.axes[i].mcp = 0
    servo = board.kernel.servo.row[i]
    servo["loop_closed"] = 0
    servo["output"] = 0.0


def ra(board: CommandedBoard, axes: Sequence[int]) -> None:
    """Reset `axes` (Manual 002, 4.4.42)."""
    for i in axes:
        row = board.state.axis[i]
        _open(board, i)
        board.outputs = _at_reset(board, int(board.state.plan[i]["PAE"]))
        row["zero"] = board.kernel.servo.actual[i] - row["shift"]
        row["offset"] = row["tp"] = 0.0
        board.kernel.base[i] = _base_at_actual(board, i)
        board.kernel.setpoint[i] = board.kernel.servo.actual[i]
        _clear(board, i)
        row["saf"] = 0


def rs(board: CommandedBoard) -> None:
    """Reset the whole system (Manual 002, 4.4.113).

    All loops are opened, queues emptied, tasks halted; positions and common variables stay.
    """
    board.pending.clear()
    for axis in board.axes:
        _open(board, axis.index)
        _clear(board, axis.index)
        axis.row["cef"] = bool(board.planned.differences(board.config))
    board.outputs = board.config.outputs_at_reset
    board.trovr = 1.0
    if board.tasks is not None:
        board.tasks.halt()


def _clear(board: CommandedBoard, i: int) -> None:
    row = board.state.axis[i]
    row["referenced"] = row["dhef"] = row["soft_limit"] = row["held"] = 0
    row["jovr"] = row["tovr"] = row["override_goal"] = 1.0


def _at_reset(board: CommandedBoard, group: int) -> int:
    """Return the outputs after the reset of an axis: planned defaults, and the PAE outputs of its group off."""
    return board.config.outputs_at_reset & ~group


def RPtoDP(board: CommandedBoard, axes: Sequence[int]) -> None:  # noqa: N802  the manual's name
    """Make the setpoint of `axes` their actual position, where no profile runs (Manual 002, 4.4.112)."""
    for i in axes:
        row, actual = board.state.axis[i], _base_at_actual(board, i)
        if row["past"]:
            go_on_with(board.state, i, actual, float(row["speed"]))
        elif row["pe"] and row["closed"]:
            board.kernel.base[i] = actual


def shp(board: CommandedBoard, i: int, position: float) -> None:
    """Set the actual position, and with it the machine zero (Manual 002, 4.4.116).

    Without effect on an axis that moves or has moves queued: its targets would be elsewhere.
    """
    axis = board.axes[i]
    if axis.is_busy or axis.queued or not math.isfinite(position):
        return
    row = axis.row
    row["zero"] = axis.rp + float(row["zero"]) - position
    row["referenced"] = 1


def azo(board: CommandedBoard, number: int) -> None:
    """Put zero offsets 0 to 4 in force for all axes, none for a higher number (Manual 002, 4.4.3)."""
    for axis in board.axes:
        if number < 0:
            continue
        axis.row["offset"] = axis.zero_offsets[number] if number < len(axis.zero_offsets) else 0.0


def szpa(board: CommandedBoard, i: int, position: float) -> None:
    """Set the virtual zero of an axis to `position` from the machine zero (Manual 002, 4.4.127)."""
    axis = board.axes[i]
    if not axis.is_busy and not axis.queued and math.isfinite(position):
        axis.row["offset"] = position


def szpr(board: CommandedBoard, i: int, position: float) -> None:
    """Move the virtual zero of an axis by `position` (Manual 002, 4.4.128)."""
    szpa(board, i, float(board.state.axis[i]["offset"]) + position)


def lps(board: CommandedBoard, i: int, scans: int) -> None:
    """Latch the actual position of an axis every so many scans from now on, until it is 0 (Manual 002, 4.4.27)."""
    if scans >= 0:
        row = board.state.axis[i]
        row["latch_scans"], row["latch_count"] = scans, 0


def lprs(board: CommandedBoard, axes: Sequence[int], *, every: int = 1) -> None:
    """Record setpoint, actual position and commanded velocity of `axes` every so many scans (Manual 002, 4.4.26)."""
    row = board.state.board[0]
    row["record_axes"] = sum({1 << i for i in axes})
    row["record_every"] = max(every, 1)
    row["record_count"] = row["recorded"] = 0


def utrovr(board: CommandedBoard, axes: Sequence[int]) -> None:
    """Take over the trajectory override for `axes`, in the same scan (Manual 002, 4.4.132)."""
    copies = not board.modereg & ModeReg.OvrMode
    for i in axes:
        row = board.state.axis[i]
        row["override_goal"] = board.trovr
        if row["tovr"] == board.trovr and copies:  # nothing settles that would bring it along
            board.axes[i].change_jog_override(board.trovr)
