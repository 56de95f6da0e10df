"""The simulated machine: a configuration brought to life, with its clock, inputs and outputs, and memory."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from enum import IntFlag
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from polycnc import kernel
from polycnc.errors import UsageError
from polycnc.kernel import LIMIT_HIGH, LIMIT_LOW, PIDF, REFERENCE, KernelState, make_state, place_machine
from polycnc.machine._bounds import PIECE_CYCLES
from polycnc.machine._clock import Clock
from polycnc.machine._config import MachineConfig
from polycnc.machine._config_axis import AnyAxis
from polycnc.machine._io import IoImage
from polycnc.machine._snapshot import Array, Snapshot, arrays_of

if TYPE_CHECKING:
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


@dataclass(frozen=True, slots=True)
class AxisState:
    """One axis at one cycle: positions in mm or degree, machine coordinates; velocity and acceleration per second."""

    setpoint: float
    actual: float
    velocity: float
    acceleration: float
    following_error: float


@dataclass(frozen=True, slots=True)
class MachineStatus:
    """A machine at one cycle; `inputs` and `outputs` hold one byte, 0 or 1, for each bit."""

    cycle: int
    time_s: float
    now: datetime
    raised: Reason
    axes: Mapping[str, AxisState]
    inputs: bytes
    outputs: bytes
    input_words: tuple[int, ...]
    output_words: tuple[int, ...]


class Machine:
    """A machine at its start position, ready to move.

    `servo` simulates the position loops that the configuration describes; without it every axis follows
    exactly. `record_cycles` is the size of the recorder's buffer, 0 for none. `memory` is the file of the
    durable memory, or an open store; without one it lasts as long as the machine.
    """

    def __init__(
        self,
        config: MachineConfig,
        *,
        servo: bool = False,
        record_cycles: int = 0,
        paths: int = 1,
        segments: int = 1 << 16,
        memory: str | Path | Store | None = None,
    ) -> None:
        self.config = config
        self.clock = Clock(config.cycle_s, config.epoch)
        self.io = IoImage(config.io)
        self._memory_file = memory if isinstance(memory, str | Path) else None
        self._memory = None if isinstance(memory, str | Path) else memory
        self.state: KernelState = make_state(
            len(config.axes),
            cycle_s=config.cycle_s,
            paths=paths,
            segments=segments,
            record_cycles=record_cycles,
            record_actual=servo,
            limited_jerk=config.path.jerk_mm_s3 is not None,
        )
        self._mask = self.state.clock["mask"]
        for index, axis in enumerate(config.axes):
            self._set_axis(index, axis.vmax, axis.amax, axis.jump, axis.kind == "linear")
            self._set_switches(index)
            if servo and axis.servo.kind == "pidf":
                self._set_servo(index)
            place_machine(self.state, index, config.start_positions[index])
        self._set_paths()

    # ------------------------------------------------------------------ time

    @property
    def time_s(self) -> float:
        """Time since the machine was switched on."""
        return self.clock.now_s

    def advance(self, cycles: int, *, until: int | None = None) -> int:
        """Run up to `cycles` control cycles; return how many were run.

        Fewer after a cycle that has `raised` one of the reasons `until` (`Reason`).
        """
        self._mask[0] = mask = until or 0
        done = 0
        while True:
            piece = min(cycles - done, PIECE_CYCLES)
            ran = kernel.advance(self.state, piece)
            self.clock.tick(ran)
            done += ran
            if done >= cycles or ran < piece or self.state.clock[0]["raised"] & mask:
                return done

    def skip(self, path: int, until: int) -> int:
        """Go along a path in closed form to segment count `until` or the next event; return the cycles."""
        done = kernel.skip(self.state, path, until)
        self.clock.tick(done)
        return done

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

    def change_axes(self, axes: tuple[AnyAxis, ...]) -> None:
        """Let the axes have these speeds, accelerations, limits, switches and servos from now on, while they stand.

        Raises:
            UsageError: Other axes than the machine has, or a path moves them.
        """
        if [(axis.name, axis.kind) for axis in axes] != [(axis.name, axis.kind) for axis in self.config.axes]:
            raise UsageError(
                "these are other axes", hint=f"The axes are {', '.join(self.config.axis_names)}."
            )
        if (self.state.paths.row["state"] == kernel.RUNNING).any():
            raise UsageError("a path moves the axes", hint="Wait until the path has come to rest.")
        self.config = self.config.model_copy(update={"axes": axes})
        for index, axis in enumerate(axes):
            self._set_axis(index, axis.vmax, axis.amax, axis.jump, axis.kind == "linear")
            self._set_switches(index)
            if axis.servo.kind == "pidf" and self.state.servo.row[index]["mode"] == PIDF:
                self._set_servo(index)

    # ------------------------------------------------------------------ memory

    @property
    def memory(self) -> Store:
        """The durable memory, opened when it is first used."""
        if self._memory is None:
            from polycnc.machine._store import Store

            self._memory = Store(self._memory_file)
        return self._memory

    # ------------------------------------------------------------------ state

    def status(self) -> MachineStatus:
        """Return what the machine is and does in the present cycle."""
        state, io = self.state, self.io
        columns = (
            state.setpoint,
            state.servo.actual,
            state.velocity,
            state.acceleration,
            state.servo.row["following_error"],
        )
        axes = (AxisState(*map(float, row)) for row in zip(*columns, strict=True))
        return MachineStatus(
            cycle=self.clock.cycles,
            time_s=self.clock.now_s,
            now=self.clock.now,
            raised=self.raised,
            axes=MappingProxyType(dict(zip(self.config.axis_names, axes, strict=True))),
            inputs=io.inputs.now.tobytes(),
            outputs=io.outputs.now.tobytes(),
            input_words=tuple(map(int, io.input_words)),
            output_words=tuple(map(int, io.output_words)),
        )

    def snapshot(self) -> Snapshot:
        """Return the whole state of motion, inputs and outputs, and the clock; the durable memory is not in it."""
        clock = self.clock
        beside = {"epoch": clock.epoch.isoformat()}
        return Snapshot.take("machine", self._made_from, clock.cycles, self._arrays(), beside)

    def restore(self, snapshot: Snapshot) -> None:
        """Go back to a snapshot of this machine, or of one that was made alike; the durable memory stays as it is.

        Raises:
            SnapshotError: It is of another machine, or damaged; nothing has changed.
        """
        snapshot.check("machine", self._made_from, self._arrays())
        epoch = snapshot.moment("epoch")
        snapshot.restore_state(self._arrays())
        self.clock.go_back(snapshot.cycle, epoch)

    @property
    def _made_from(self) -> str:
        return self.config.model_dump_json()

    def _arrays(self) -> list[Array]:
        io = self.io
        return arrays_of((self.state, io.inputs, io.outputs, io.input_words, io.output_words))

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

    def _set_paths(self) -> None:
        path, rows = self.config.path, self.state.paths.row
        rows["jerkrel"] = path.jerkrel
        rows["jerk_mm_s3"] = path.jerk_mm_s3 or 0.0
        rows["depth"] = path.look_ahead_limit or 0
        rows["speed_limit_mm_s"] = path.speed_limit_mm_s or math.inf
        rows["accel_limit_mm_s2"] = path.acceleration_limit_mm_s2 or math.inf
        highest = path.acceleration_limit_mm_s2 or max(axis.amax for axis in self.config.axes)
        if path.junction_deviation_mm is not None:
            rows["corner_rule"] = kernel.BY_DEVIATION
            rows["corner_deviation_mm"] = path.junction_deviation_mm
        elif path.square_corner_mm_s is not None:
            # The arc through a right angle has the radius deviation / (sqrt(2) - 1) and the highest acceleration.
            rows["corner_rule"] = kernel.BY_SQUARE_CORNER
            rows["corner_deviation_mm"] = path.square_corner_mm_s**2 * (math.sqrt(2.0) - 1.0) / highest
        elif path.corner_share is not None:
            rows["corner_rule"] = kernel.BY_SHARE
            rows["corner_share"], rows["corner_cycle_s"] = path.corner_share, self.config.cycle_s
        rows["rounding_share"] = path.rounding_share or 0.0
        rows["last_share"] = path.last_share or 0.0
        rows["rounding_gap_s"] = path.rounding_gap_s
        rows["free_overlaps"] = path.free_overlaps
        if path.minimum_cruise_share > 0.0:
            rows["low_accel_mm_s2"] = highest * (1.0 - path.minimum_cruise_share)

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
