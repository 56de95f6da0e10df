"""The simulated machine: a configuration brought to life as kernel state."""

from __future__ import annotations

import math

from polycnc.kernel import LIMIT_HIGH, LIMIT_LOW, PIDF, REFERENCE, KernelState, make_state, place_machine
from polycnc.machine._config import MachineConfig


class Machine:
    """A machine at its start position, ready to move.

    `servo` simulates the position loops that the configuration describes; without it every axis follows
    exactly.
    `record_cycles` is the size of the recorder's buffer, 0 for none.
    """

    def __init__(
        self,
        config: MachineConfig,
        *,
        servo: bool = False,
        record_cycles: int = 0,
        paths: int = 1,
        segments: int = 1 << 16,
    ) -> None:
        self.config = config
        self.state: KernelState = make_state(
            len(config.axes),
            cycle_s=config.cycle_s,
            paths=paths,
            segments=segments,
            record_cycles=record_cycles,
            record_actual=servo,
        )
        for index, axis in enumerate(config.axes):
            self._set_axis(index, axis.vmax, axis.amax, axis.jump, axis.kind == "linear")
            self._set_switches(index)
            if servo and axis.servo.kind == "pidf":
                self._set_servo(index)
            place_machine(self.state, index, config.start_positions[index])
        rows = self.state.paths.row
        rows["jerkrel"] = config.path.jerkrel
        rows["depth"] = config.path.look_ahead_limit or 0

    def _set_axis(
        self, index: int, speed: float, acceleration: float, jump: float | None, counts: bool
    ) -> None:
        limits = self.state.limits
        limits.speed[index] = speed
        limits.acceleration[index] = acceleration
        limits.jump[index] = -1.0 if jump is None else jump
        limits.feed_axis[index] = counts

    def _set_servo(self, index: int) -> None:
        axis = self.config.axes[index]
        servo, plant = self.state.servo.row[index], self.state.plant.row[index]
        servo["mode"] = PIDF
        for name in ("kp", "ki", "kd", "kpl", "kfcv", "kfca", "following_error_limit"):
            servo[name] = getattr(axis.servo, name)
        servo["in_position_window"] = axis.servo.in_position
        plant["lag_s"] = axis.servo.lag_s
        plant["resolution"] = axis.resolution
        plant["backlash"] = axis.backlash

    def _set_switches(self, index: int) -> None:
        axis = self.config.axes[index]
        switch, marks = self.state.switches.switch[index], self.state.switches.marks[index]
        marks["soft_low"], marks["soft_high"] = axis.soft_limits
        marks["soft_enabled"] = 1
        low, high = axis.limit_switches
        stretches = [(LIMIT_LOW, -math.inf, low), (LIMIT_HIGH, high, math.inf)]
        if axis.reference_switch is not None:
            stretches.append((REFERENCE, -math.inf, axis.reference_switch))
        for which, on_from, on_to in stretches:
            if not math.isinf(on_from) or not math.isinf(on_to):
                switch[which]["on_from"], switch[which]["on_to"] = on_from, on_to
        if axis.index_pulse is not None:
            marks["index_origin"] = axis.index_pulse

    @property
    def time_s(self) -> float:
        """Time since the machine was switched on."""
        return float(self.state.clock[0]["cycle"] * self.config.cycle_s)
