"""What the counts of the motor command port mean for an axis: volts of a servo, half periods of a stepper's pulses."""

from __future__ import annotations

import math
from typing import Any

from polycnc.controllers.apci.board._system_axis import SERVO_MCP_LIMIT, STEPPER_MCP_LIMIT, AxisSetup


class MotorCommand:
    """The motor command of an axis, by its row and that of its position loop."""

    def __init__(self, row: Any, servo: Any, setup: AxisSetup, time_unit_s: float, clock_hz: float) -> None:
        self._row = row
        self._servo = servo
        self._setup = setup
        self._at_10_v = setup.plant.velocity_at_10_v / time_unit_s
        self._clock_hz = clock_hz
        limit = setup.mcp_limit  # limits that cannot be meant are none
        self._range = setup.mcp_range if setup.mcp_limits_are_possible else (-limit, limit)

    def change_units(self, counts_per_unit: float) -> None:
        """Take over what follows from the resolution, the gear factor or the effective radius."""
        row, (low, high) = self._row, self._range
        sign = -1.0 if self._setup.mcp_inverted else 1.0
        row["mcp_low"], row["mcp_high"] = low, high
        row["mcp_gain"] = sign * self._at_10_v / SERVO_MCP_LIMIT
        row["mcp_clock"] = sign * self._clock_hz / 2.0 / counts_per_unit
        if self._setup.motor == "servo":
            self._servo["output_limit"] = max(-low, high) / SERVO_MCP_LIMIT * self._at_10_v

    def counts_for(self, velocity: float) -> int:
        """Return the motor command for a velocity; mcpcp and mcpcn are what the drive needs to move at all."""
        low, high = self._range
        if self._setup.motor == "servo":
            counts = round(velocity / float(self._row["mcp_gain"]))
            counts += self._setup.mcpcp if counts > 0 else self._setup.mcpcn if counts < 0 else 0
            return min(max(counts, low), high)
        share = velocity / float(self._row["mcp_clock"])
        if abs(share) * (STEPPER_MCP_LIMIT + 1) < 1.0:
            return 0
        delay = max(round(1.0 / abs(share)) - 1, 1)
        return int(min(max(math.copysign(delay, share), low), high))

    def step_frequency_hz(self, counts: int) -> float:
        """Return the signed step frequency of a stepper's motor command."""
        return math.copysign(self._clock_hz / 2.0 / (abs(counts) + 1), counts) if counts else 0.0
