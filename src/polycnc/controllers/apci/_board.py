"""The virtual board: its axes, variables and terminals, and its time.

Commands are functions of their own that take the board (`_axis_commands`, `_jog_commands`, `_move_commands`,
`_spool_commands`); the function library and the SAP tasks both call them.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from polycnc.controllers.apci._axis import Axis
from polycnc.controllers.apci._axis_commands import reset_system
from polycnc.controllers.apci._entries import change_override
from polycnc.controllers.apci._motion import profile_velocity
from polycnc.controllers.apci._registers import ErrorReg, ModeReg
from polycnc.controllers.apci._scan import INTERRUPT, PROFILE_END, RECORD_FULL, RESET, run_scans
from polycnc.controllers.apci._state import SMA, SMD, TOM, BoardState, make_board_state
from polycnc.controllers.apci._system_file import InputFunction, SystemFile
from polycnc.controllers.apci._units import PositionUnit, TimeUnit
from polycnc.kernel import (
    ADDED,
    LIMIT_HIGH,
    LIMIT_LOW,
    OTHER_SOURCE,
    PIDF,
    REFERENCE,
    SHORT_OVERSHOOT,
    KernelState,
    make_state,
    move_to,
    place_machine,
)
from polycnc.machine import Clock, Way

LATENCY_SCANS = 2  # after which a direct command takes effect (Manual 002, 2.2.8.1)
COMMON_VARIABLES = 1000
COMMON_BUFFER_BYTES = 1000
CNC_TASKS = 4
_LIMIT_FUNCTIONS = {"none": 0, "TOM": TOM, "SMA": SMA, "SMD": SMD}
_INPUT_FUNCTIONS: tuple[InputFunction, ...] = (
    "EO",
    "DR",
    "LSL_TOM",
    "LSL_SMA",
    "LSL_SMD",
    "LSR_TOM",
    "LSR_SMA",
    "LSR_SMD",
    "UI",
    "REF",
    "LP",
)
_PARAMETERS = (
    *("jac", "jvl", "jtvl", "hac", "hvl", "sdec", "jerkrel", "MaxVel", "MaxAcc", "MDVEL"),
    *("kp", "ki", "kd", "kpl", "kfca", "kfcv", "ipw", "mpe"),
    *("sll", "slr", "gf", "slsp", "effradius"),
)
_STROBE_INPUTS = (13, 14, 15)  # bits of the inputs that latch axes 0, 1, 2 by hardware
_AT_ONCE = 1e9  # 1/s: how steep an offset that moves with a velocity of its own begins


class Tasks(Protocol):
    """What runs SAP programs within the board's time."""

    def scans_to_wait(self) -> float:
        """Return for how many scans no task has anything to do; 0 if one can go on, inf if all wait for profiles."""
        ...

    def run_scan(self) -> None:
        """Let every task do what it can within one scan."""
        ...

    def halt(self) -> None:
        """Halt all tasks."""
        ...


@dataclass
class Variables:
    """Variables of the whole board, by the manual's names in lower case."""

    pu: int = 0
    tu: int = 0
    trac: float = 1000.0
    trvl: float = 100.0
    trtvl: float = 0.0
    ledgn: int = 0
    ledrd: int = 0
    ledyl: int = 0
    irqpc: int = 0
    ifs: int = 0  # interface status, kept by whoever boots the board
    buffers: list[bytearray] = field(
        default_factory=lambda: [bytearray(COMMON_BUFFER_BYTES) for _ in range(CNC_TASKS)]
    )


class Board:
    """A board as its system file describes it, just booted: all loops open, nothing referenced.

    `record_scans` is the size of the recorder's buffer, 0 for none.
    """

    def __init__(self, config: SystemFile | None = None, *, record_scans: int = 0) -> None:
        self.config = config or SystemFile()
        n = len(self.config.axes)
        dt = self.config.sample_time_s
        self.kernel: KernelState = make_state(
            n, cycle_s=dt, segments=1, record_cycles=record_scans, record_actual=True
        )
        self.state: BoardState = make_board_state(n, dt)
        self.clock = Clock(dt)
        self.variables = Variables()
        self.sysvarint = np.zeros(COMMON_VARIABLES, np.int32)
        self.sysvardbl = np.zeros(COMMON_VARIABLES)
        self.axes = tuple(Axis(self, i, setup) for i, setup in enumerate(self.config.axes))
        self.tasks: Tasks | None = None
        self.interrupts: list[Callable[[], None]] = []
        self._pending: list[tuple[int, Callable[[], None]]] = []
        for i in range(n):
            place_machine(self.kernel, i, 0.0)
        self._set_up_plant()
        self.load_parameters(self.config)

    # ------------------------------------------------------------------ set-up

    def _set_up_plant(self) -> None:
        """Set up what stays with the board: drives, encoders, switches."""
        kernel = self.kernel
        kernel.owner[:] = OTHER_SOURCE
        for axis in self.axes:
            i, plant = axis.index, axis.setup.plant
            kernel.servo.row[i]["loop_closed"] = 0
            if plant.kind == "lag":
                kernel.servo.row[i]["mode"] = PIDF
                kernel.plant.row[i]["lag_s"] = plant.lag_s
            if plant.encoder == "counts":
                kernel.plant.row[i]["resolution"] = 1.0 / axis.setup.counts_per_unit
            kernel.plant.row[i]["backlash"] = plant.play
            switch, marks = kernel.switches.switch[i], kernel.switches.marks[i]
            if plant.limit_left is not None:
                switch[LIMIT_LOW]["on_from"], switch[LIMIT_LOW]["on_to"] = -math.inf, plant.limit_left
            if plant.limit_right is not None:
                switch[LIMIT_HIGH]["on_from"], switch[LIMIT_HIGH]["on_to"] = plant.limit_right, math.inf
            if plant.reference is not None:
                switch[REFERENCE]["on_from"], switch[REFERENCE]["on_to"] = plant.reference
            if plant.index is not None:
                marks["index_origin"] = plant.index
                marks["index_pitch"] = 1.0 / axis.setup.gf  # one pulse per turn of the motor

    def load_parameters(self, system: SystemFile) -> None:
        """Take over the parameters and the planning of a system file, as loading system.dat does."""
        variables, board = self.variables, self.state.board[0]
        for axis, setup in zip(self.axes, system.axes, strict=False):
            for name in [
                "jac",
                "jvl",
                "jtvl",
                "hac",
                "hvl",
                "sdec",
                "kp",
                "ki",
                "kd",
                "kpl",
                "kfca",
                "kfcv",
                "sll",
                "slr",
                "ipw",
                "mpe",
                "gf",
                "slsp",
                "effradius",
                "MaxVel",
                "MaxAcc",
                "MDVEL",
                "jerkrel",
            ]:
                setattr(axis, name, getattr(setup, name))
            axis.row["soft_left"] = _LIMIT_FUNCTIONS[setup.soft_left]
            axis.row["soft_right"] = _LIMIT_FUNCTIONS[setup.soft_right]
            axis.row["stepper"] = setup.motor == "stepper"
            axis.row["rotary"] = setup.is_rotary
            axis.row["cef"] = bool(system.differences(self.config))
            if not setup.mcp_limits_are_possible:
                self.raise_error(ErrorReg.LimitDefError)
            self.update_filter(axis.index)
            self._plan_inputs(system, axis.index)
        planned = system.board
        variables.pu = int(PositionUnit[planned.pu])
        variables.tu = int(TimeUnit[planned.tu])
        variables.trac, variables.trvl, variables.trtvl = planned.trac, planned.trvl, planned.trtvl
        board["trovrst"] = planned.trovrst
        board["mode_register"] = int(system.modereg)
        board["nfrax"] = system.nfrax
        board["inverted"] = system.inverted_inputs
        board["outputs"] = system.outputs_at_reset

    def _plan_inputs(self, system: SystemFile, i: int) -> None:
        plan = self.state.plan[i]
        for function in _INPUT_FUNCTIONS:
            plan[function] = system.inputs_for(function, i)
        plan["PAE"] = system.outputs_for(i)
        plan["strobe"] = 1 << _STROBE_INPUTS[i] if i < len(_STROBE_INPUTS) else 0
        plan["left_switch"] = plan["LSL_TOM"] | plan["LSL_SMA"] | plan["LSL_SMD"]
        plan["right_switch"] = plan["LSR_TOM"] | plan["LSR_SMA"] | plan["LSR_SMD"]
        plan["reference_switch"] = plan["REF"]

    def update_filter(self, i: int) -> None:
        """Hand the six filter coefficients of an axis to its position loop."""
        servo, axis = self.kernel.servo.row[i], self.axes[i]
        for name in ("kp", "ki", "kd", "kpl", "kfcv", "kfca"):
            servo[name] = getattr(axis, name)

    # ------------------------------------------------------------------ registers

    @property
    def errorreg(self) -> ErrorReg:
        """Errors since the board was booted."""
        return ErrorReg(int(self.state.board[0]["error_register"]))

    def raise_error(self, error: ErrorReg) -> None:
        """Set a bit of the error register."""
        self.state.board[0]["error_register"] |= int(error)

    @property
    def modereg(self) -> ModeReg:
        """Mode register."""
        return ModeReg(int(self.state.board[0]["mode_register"]))

    @modereg.setter
    def modereg(self, value: int) -> None:
        self.state.board[0]["mode_register"] = value & 0xFFFFFFFF

    @property
    def inputs(self) -> int:
        """Active digital inputs; input 1 is bit 0."""
        return int(self.state.board[0]["inputs"])

    def set_input(self, number: int, level: bool) -> None:
        """Put a level on terminal `number`, from 1; what is planned for it reacts in the next scan."""
        bit = 1 << (number - 1)
        external = int(self.state.board[0]["external"])
        self.state.board[0]["external"] = external | bit if level else external & ~bit

    @property
    def outputs(self) -> int:
        """Digital outputs; output 1 is bit 0."""
        return int(self.state.board[0]["outputs"])

    @outputs.setter
    def outputs(self, value: int) -> None:
        self.state.board[0]["outputs"] = value & 0xFF

    @property
    def nfrax(self) -> int:
        """Axes that do not count for the path, bit by index."""
        return int(self.state.board[0]["nfrax"])

    @nfrax.setter
    def nfrax(self, value: int) -> None:
        self.state.board[0]["nfrax"] = value & 0xFFFFFFFF

    @property
    def trovr(self) -> float:
        """Trajectory override as it was written."""
        return float(self.state.board[0]["trovr"])

    @trovr.setter
    def trovr(self, value: float) -> None:
        if value > 0.0 and math.isfinite(value):
            self.state.board[0]["trovr"] = value

    @property
    def trovrst(self) -> float:
        """Seconds in which the trajectory override changes by 1."""
        return float(self.state.board[0]["trovrst"])

    @trovrst.setter
    def trovrst(self, value: float) -> None:
        if value >= 0.0 and math.isfinite(value):
            self.state.board[0]["trovrst"] = value

    # ------------------------------------------------------------------ axes

    def change_jog_override(self, i: int, value: float) -> None:
        """Give an axis another jog override, at once."""
        change_override(self.state, i, value)

    def profile_velocity(self, i: int) -> float:
        """Return the velocity of an axis' profile (axis units/s)."""
        return float(profile_velocity(self.state, self.kernel, i))

    def move_offset(self, i: int) -> None:
        """Bring what is added to the setpoint to `dpoffset`, at once or with `dvoffset`."""
        row, ptp = self.state.axis[i], self.kernel.ptp
        velocity = abs(float(row["dvoffset"]))
        if velocity > 0.0:
            rate = velocity * _AT_ONCE
            move_to(ptp, ADDED, i, float(row["dpoffset"]), 0.0, velocity, rate, rate, 0.0, SHORT_OVERSHOOT)
        else:
            ptp.row[ADDED, i]["active"] = 0
            ptp.row[ADDED, i]["position"] = row["dpoffset"]
            ptp.row[ADDED, i]["velocity"] = 0.0

    # ------------------------------------------------------------------ time

    @property
    def time_s(self) -> float:
        """Time since the board was booted."""
        return self.clock.now_s

    def later(self, command: Callable[[], None], scans: int = LATENCY_SCANS) -> None:
        """Carry out `command` after so many scans; at once for 0."""
        if scans <= 0:
            command()
        else:
            self._pending.append((self.clock.cycles + scans, command))

    def advance(self, scans: int, *, until: int = 0) -> int:
        """Run up to `scans` scans; return how many were run.

        Fewer if the recorder is full, or after a scan in which one of the attentions `until` happened (`_scan`).
        """
        done = 0
        while done < scans:
            self._carry_out()
            mask = INTERRUPT | RESET | RECORD_FULL | until
            piece = scans - done
            if self.tasks is not None:
                waiting = self.tasks.scans_to_wait()
                if waiting == 0:
                    self.tasks.run_scan()
                piece = int(min(piece, max(waiting, 1)))
                mask |= PROFILE_END  # a task may wait for it
            if self._pending:
                piece = min(piece, max(self._pending[0][0] - self.clock.cycles, 1))
            ran = int(run_scans(self.state, self.kernel, piece, mask))
            done += ran
            self.clock.tick(ran)
            if self._attend() & (RECORD_FULL | until):
                break
        self._carry_out()
        return done

    def _carry_out(self) -> None:
        """Carry out the direct commands that are due."""
        while self._pending and self._pending[0][0] <= self.clock.cycles:
            self._pending.pop(0)[1]()

    def _attend(self) -> int:
        """Do what the last scan asked for, and return it."""
        board = self.state.board[0]
        attention = int(board["attention"])
        board["attention"] = 0
        if attention & INTERRUPT:
            self.raise_interrupt(True)
        if attention & RESET:
            self.reset()
        return attention

    def raise_interrupt(self, active: bool) -> None:
        """Set or reset the interrupt request to the PC; setting it calls the routines that are installed."""
        rises = active and not self.variables.irqpc
        self.variables.irqpc = int(active)
        for routine in self.interrupts if rises else ():
            routine()

    def run(self, way: Way) -> int:
        """Let the board run in one of the ways of its clock (`Step`, `Free`, ...); return the scans done."""
        return way.run(self.advance)

    def wait(self, axes: tuple[int, ...] | None = None, limit_s: float = 3600.0) -> None:
        """Run until the profiles of `axes` (all if None) have ended, at most `limit_s`."""
        chosen = [self.axes[i] for i in (range(len(self.axes)) if axes is None else axes)]
        end = self.clock.cycles + self.clock.cycles_for(limit_s)
        while any(axis.is_busy for axis in chosen) and self.clock.cycles < end:
            if self.advance(end - self.clock.cycles, until=PROFILE_END) == 0:
                break

    def reset(self) -> None:
        """Reset the whole system, as rs does."""
        self._pending.clear()
        reset_system(self)
