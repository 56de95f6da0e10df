"""The motor command port: from counts to the velocity of the drive, with the limits that are planned for it.

With the loop closed the position controller writes it in every scan; with the loop open it holds what was written
(Manual 002, 4.4.88 and 4.4.162).
"""

from __future__ import annotations

from polycnc.controllers.apci.core._state import BoardState
from polycnc.kernel import KernelState, compiled, entry


@compiled
def velocity_of(b: BoardState, i: int, counts: int) -> float:
    """Return the velocity (axis units/s) that a motor command gives: a voltage, or half periods of a step."""
    row = b.axis[i]
    if row["stepper"] == 0:
        return float(counts * row["mcp_gain"])
    if counts == 0:
        return 0.0
    velocity = row["mcp_clock"] / (abs(counts) + 1.0)
    return float(velocity if counts > 0 else -velocity)


@entry
def write_command(b: BoardState, state: KernelState, i: int, counts: int) -> None:
    """Write the port of axis `i`; without effect while the controller writes it (Manual 002, 4.4.162)."""
    row = b.axis[i]
    if row["closed"] == 0:
        row["mcp"] = min(max(counts, row["mcp_low"]), row["mcp_high"])
        state.servo.row[i]["command"] = velocity_of(b, i, int(row["mcp"]))


@compiled
def command_cycle(b: BoardState, state: KernelState, i: int) -> None:
    """Keep what the controller of axis `i` commands within the limits of its port."""
    row, servo = b.axis[i], state.servo.row[i]
    if row["stepper"] != 0 or row["closed"] == 0:
        return
    one, other = row["mcp_low"] * row["mcp_gain"], row["mcp_high"] * row["mcp_gain"]
    servo["output"] = min(max(servo["output"], min(one, other)), max(one, other))
