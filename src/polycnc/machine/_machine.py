"""The simulated machine: a configuration brought to life, with its clock, inputs and outputs, and memory."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import IntFlag
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from polycnc import kernel
from polycnc.errors import UsageError
from polycnc.kernel import LIMIT_HIGH, LIMIT_LOW, PIDF, REFERENCE, KernelState, make_state, place_machine
from polycnc.machine._clock import Clock, Way
from polycnc.machine._config import MachineConfig
from polycnc.machine._io import IoImage
from polycnc.machine._store import Store

Floats = npt.NDArray[np.float64]


class Reason(IntFlag):
    """Why a machine stopped advancing."""

    NONE = 0
    QUEUE_LOW = kernel.QUEUE_LOW
    PATH_RESTED = kernel.PATH_RESTED
    PROFILE_ENDED = kernel.PROFILE_ENDED
    SWITCH_EDGE = kernel.SWITCH_EDGE
    SOFT_LIMIT = kernel.SOFT_LIMIT
    FOLLOWING_ERROR = kernel.FOLLOWING_ERROR
    RECORDER_FULL = kernel.RECORDER_FULL
    PATH_EVENT = kernel.PATH_EVENT
    TABLE_EMPTY = kernel.TABLE_EMPTY


@dataclass(frozen=True, slots=True)
class Snapshot:
    """The state of a machine at one cycle, to go back to; see `Machine.snapshot`."""

    cycles: int
    arrays: tuple[npt.NDArray[Any], ...]


class Machine:
    """A machine at its start position, ready to move.

    `servo` simulates the position loops that the configuration describes; without it every axis follows
    exactly. `record_cycles` is the size of the recorder's buffer, 0 for none. `memory` is the file of the
    durable memory; without one it lasts as long as the machine.
    """

    def __init__(
        self,
        config: MachineConfig,
        *,
        servo: bool = False,
        record_cycles: int = 0,
        paths: int = 1,
        segments: int = 1 << 16,
        memory: str | Path | None = None,
    ) -> None:
        self.config = config
        self.clock = Clock(config.cycle_s, config.epoch)
        self.io = IoImage(config.io)
        self._memory_file = memory
        self._memory: Store | None = None
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

    # ------------------------------------------------------------------ time

    @property
    def time_s(self) -> float:
        """Time since the machine was switched on."""
        return self.clock.now_s

    def advance(self, cycles: int) -> int:
        """Run up to `cycles` control cycles; return how many were run until something asked for attention."""
        done = kernel.advance(self.state, cycles)
        self.clock.tick(done)
        return done

    def skip(self, path: int, until: int) -> int:
        """Go along a path in closed form to segment count `until` or the next event; return the cycles."""
        done = kernel.skip(self.state, path, until)
        self.clock.tick(done)
        return done

    def run(self, way: Way) -> int:
        """Let the machine run in one of the ways of its clock (`Step`, `Free`, ...); return the cycles done."""
        return way.run(self.advance)

    def stop_on(self, reasons: Reason) -> None:
        """Set what `advance` stops for, once the cycle in which it happens is complete."""
        self.state.clock[0]["mask"] = int(reasons)

    @property
    def raised(self) -> Reason:
        """What happened in the last cycle that was run."""
        return Reason(int(self.state.clock[0]["raised"]))

    # ------------------------------------------------------------------ axes

    @property
    def setpoints(self) -> dict[str, float]:
        """Where each axis shall be (mm or degree, machine coordinates)."""
        return self._by_axis(self.state.setpoint)

    @property
    def actual(self) -> dict[str, float]:
        """Where each axis is (mm or degree, machine coordinates)."""
        return self._by_axis(self.state.servo.actual)

    def move(self, axis: str, target: float, *, speed: float | None = None) -> None:
        """Start moving one axis to `target` (mm or degree), from whatever it is doing; `advance` moves it.

        Raises:
            UsageError: no such axis, a target outside the soft limits, a speed that is not above zero, or an
                axis that a path is moving.
        """
        index = self.config.axis_index(axis)
        limits = self.config.axes[index]
        low, high = limits.soft_limits
        if not low <= target <= high:
            raise UsageError(
                f"axis {axis} cannot go to {target:g} {limits.unit}",
                hint=f"Its soft limits are {low:g} to {high:g} {limits.unit}.",
            )
        if self.state.owner[index] != kernel.POINT_TO_POINT:
            raise UsageError(f"a path moves axis {axis}", hint="Wait until the path has come to rest.")
        done = kernel.move_to(
            self.state.ptp,
            kernel.MAIN,
            index,
            target,
            0.0,
            limits.vmax if speed is None else min(speed, limits.vmax),
            limits.amax,
            limits.amax,
            self.config.path.jerkrel,
            kernel.SHORT_OVERSHOOT,
        )
        if done < 0:
            raise UsageError(f"axis {axis} cannot move like that", hint="Give a finite speed above zero.")

    # ------------------------------------------------------------------ memory

    @property
    def memory(self) -> Store:
        """The durable memory, opened when it is first used."""
        if self._memory is None:
            self._memory = Store(self._memory_file)
        return self._memory

    def snapshot(self) -> Snapshot:
        """Return the whole state of motion, inputs and outputs, to go back to with `restore`."""
        return Snapshot(self.clock.cycles, tuple(array.copy() for array in self._arrays()))

    def restore(self, snapshot: Snapshot) -> None:
        """Go back to a snapshot of this machine; the durable memory stays as it is."""
        for array, saved in zip(self._arrays(), snapshot.arrays, strict=True):
            array[...] = saved
        self.clock.cycles = snapshot.cycles

    def _arrays(self) -> list[npt.NDArray[Any]]:
        io = self.io
        return _arrays_of((self.state, io.inputs, io.outputs, io.input_words, io.output_words))

    # ------------------------------------------------------------------ set-up

    def _by_axis(self, values: Floats) -> dict[str, float]:
        return {name: float(value) for name, value in zip(self.config.axis_names, values, strict=True)}

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


def _arrays_of(value: Any) -> list[npt.NDArray[Any]]:
    """Return all arrays in nested tuples, in a fixed order."""
    if isinstance(value, np.ndarray):
        return [value]
    return [array for item in value for array in _arrays_of(item)] if isinstance(value, tuple) else []
