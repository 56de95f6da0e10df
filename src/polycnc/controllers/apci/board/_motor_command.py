"""What the counts of the motor command port mean for an axis: volts of a servo, half periods of a stepper's pulses."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from polycnc.controllers.apci.board._system_axis import SERVO_MCP_LIMIT, STEPPER_MCP_LIMIT

if TYPE_CHECKING:
    from polycnc.controllers.apci.board._axis import Axis


def mcp_range(axis: Axis) -> tuple[int, int]:
    """Return the lowest and the highest motor command; limits that cannot be meant are none."""
    limit = axis.setup.mcp_limit
    return axis.setup.mcp_range if axis.setup.mcp_limits_are_possible else (-limit, limit)


def change_units(axis: Axis) -> None:
    """Take over what follows from the resolution, the gear factor or the effective radius."""
    sign = -1.0 if axis.setup.mcp_inverted else 1.0
    at_10_v = axis.setup.plant.velocity_at_10_v / axis.time_unit_s
    low, high = mcp_range(axis)
    axis.row["mcp_low"], axis.row["mcp_high"] = low, high
    axis.row["mcp_gain"] = sign * at_10_v / SERVO_MCP_LIMIT
    axis.row["mcp_clock"] = sign * axis.board.config.stepper_clock_hz / 2.0 / axis.counts_per_unit
    if axis.setup.motor == "servo":
        axis.servo["output_limit"] = max(-low, high) / SERVO_MCP_LIMIT * at_10_v
    axis.board.units_in_use.clear()


def counts_for(axis: Axis, velocity: float) -> int:
    """Return the motor command for a velocity; mcpcp and mcpcn are what the drive needs to move at all."""
    low, high = mcp_range(axis)
    if axis.setup.motor == "servo":
        counts = round(velocity / float(axis.row["mcp_gain"]))
        counts += axis.setup.mcpcp if counts > 0 else axis.setup.mcpcn if counts < 0 else 0
        return min(max(counts, low), high)
    share = velocity / float(axis.row["mcp_clock"])
    if abs(share) * (STEPPER_MCP_LIMIT + 1) < 1.0:
        return 0
    delay = max(round(1.0 / abs(share)) - 1, 1)
    return int(min(max(math.copysign(delay, share), low), high))
