"""Check a trace against the machine's limits, cycle by cycle: the promise that every motion keeps them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from polycnc.machine import MachineConfig
from polycnc.runner._outcome import Trace

ROUNDING = 1e-6
"""Part of a limit by which rounding may exceed it; positions are doubles, and differences of them are divided twice."""


@dataclass(frozen=True, slots=True)
class Violation:
    """Say where a setpoint breaks a limit: the axis, what, when, how much and what is allowed."""

    axis: str
    what: str  # "speed", "acceleration" or "position"
    time_s: float
    block: int
    value: float
    limit: float

    def __str__(self) -> str:
        side = "below" if self.value < self.limit else "above"
        return (
            f"axis {self.axis}: {self.what} {self.value:.6g} {side} {self.limit:.6g} "
            f"at {self.time_s:.6f} s, block {self.block}"
        )


def verify_trace(trace: Trace, machine: MachineConfig) -> list[Violation]:
    """Return the worst violation of each limit of each axis; an empty list if the trace keeps them all.

    Speed and acceleration are differences of setpoints over one control cycle. Where an axis has a permitted
    velocity step (`jump`), its acceleration may exceed the limit by that step within one cycle.
    """
    dt = machine.cycle_s
    found: list[Violation] = []
    for index, axis in enumerate(machine.axes):
        position = trace.setpoint[:, index]
        start = machine.start_positions[index]
        speed = np.diff(position, prepend=start) / dt
        acceleration = np.diff(speed, prepend=0.0) / dt
        size = max(1.0, float(np.max(np.abs(position), initial=0.0)))
        noise = 16.0 * np.finfo(float).eps * size
        low, high = axis.soft_limits
        limits = (
            ("speed", 1.0, np.abs(speed), axis.vmax, noise / dt),
            ("acceleration", 1.0, np.abs(acceleration), axis.amax + (axis.jump or 0.0) / dt, noise / dt**2),
            ("position", 1.0, position, high, 0.0),
            ("position", -1.0, position, low, 0.0),
        )
        for what, side, values, limit, slack in limits:
            if not len(values) or not np.isfinite(limit):
                continue
            worst = int(np.argmax(side * values))
            if side * (values[worst] - limit) > abs(limit) * ROUNDING + slack:
                found.append(
                    Violation(
                        axis.name,
                        what,
                        float(trace.t_s[worst]),
                        int(trace.block[worst]),
                        float(values[worst]),
                        limit,
                    )
                )
    return found
