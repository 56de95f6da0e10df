"""The virtual board: its axes, variables and terminals, and its time.

Commands are functions of their own that take the board (`_axis_commands`, `_jog_commands`, `_move_commands`,
`_spool_commands`); the function library and the SAP tasks both call them.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from polycnc.controllers.apci.board._axis import Axis
from polycnc.controllers.apci.board._axis_commands import reset_system
from polycnc.controllers.apci.board._board_snapshot import restore_state, take_snapshot
from polycnc.controllers.apci.board._board_variables import Tasks, Variables
from polycnc.controllers.apci.board._command import Command
from polycnc.controllers.apci.board._declared import COMMON_VARIABLES
from polycnc.controllers.apci.board._path_units import PathUnits
from polycnc.controllers.apci.board._setup import load_parameters, set_up_plant
from polycnc.controllers.apci.board._status import BoardStatus, board_status
from polycnc.controllers.apci.board._system_file import SystemFile
from polycnc.controllers.apci.core._compiled_entries import change_override
from polycnc.controllers.apci.core._motion import profile_velocity
from polycnc.controllers.apci.core._registers import OUTPUTS, ErrorReg, ModeReg
from polycnc.controllers.apci.core._scan import INTERRUPT, NO_TURNS, PROFILE_END, RESET, run_scans
from polycnc.controllers.apci.core._state import BoardState, Floats, make_board_state
from polycnc.kernel import ADDED, SHORT_OVERSHOOT, KernelState, make_state, move_to
from polycnc.machine import PIECE_CYCLES, Clock, Snapshot, wait

LATENCY_SCANS = 2  # after which a direct command takes effect (Manual 002, 2.2.8.1)
_AT_ONCE = 1e9  # 1/s: how steep an offset that moves with a velocity of its own begins


class Board:
    """A board as its system file describes it, just booted: all loops open, nothing referenced.

    `record_scans` is the size of the recorder's buffer (`kernel.recorder`), 0 for none; a full one keeps what it has.
    """

    def __init__(self, config: SystemFile | None = None, *, record_scans: int = 0) -> None:
        self.is_described = config is not None
        self._record_scans = record_scans
        self._build(config or SystemFile())

    def rebuild(self, config: SystemFile) -> None:
        """Be the board of another system file, just booted; what had been got from this one before is void."""
        self.is_described = True
        self._build(config)

    def _build(self, config: SystemFile) -> None:
        self.config = config
        n = len(self.config.axes)
        dt = self.config.sample_time_s
        self.kernel: KernelState = make_state(
            n, cycle_s=dt, segments=1, record_cycles=self._record_scans, record_actual=True
        )
        self.state: BoardState = make_board_state(n, dt)
        self.clock = Clock(dt)
        self.variables = Variables()
        self.sysvarint = np.zeros(COMMON_VARIABLES, np.int32)
        self.sysvardbl = np.zeros(COMMON_VARIABLES)
        self.axes = tuple(Axis(self, i, setup) for i, setup in enumerate(self.config.axes))
        self.tasks: Tasks | None = None
        self.interrupts: list[Callable[[], None]] = []
        self.units_in_use: dict[tuple[tuple[int, ...], int, int, int], PathUnits | None] = {}
        self.planned = self.config  # the system file that was loaded last
        self.pending: list[Command] = []
        self.orders = [0] * n  # a command is void when its axes have had another since
        set_up_plant(self)
        load_parameters(self, self.config)

    def load_parameters(self, system: SystemFile) -> None:
        """Take over the parameters and the planning of a system file, as loading system.dat does."""
        load_parameters(self, system)

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
        """Set a bit of the error register, also one for a fault that only hardware has."""
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
        self.look_at_interface()
        return int(self.state.board[0]["inputs"])

    def set_input(self, number: int, level: bool) -> None:
        """Put a level on terminal `number`, from 1; what is planned for it reacts in the next scan."""
        bit = 1 << (number - 1)
        external = int(self.state.board[0]["external"])
        self.state.board[0]["external"] = external | bit if level else external & ~bit

    def look_at_interface(self) -> None:
        """Take inputs and outputs away where an error in ifs has reset them."""
        board = self.state.board[0]
        board["io_down"] = self.variables.interface.is_down
        if board["io_down"]:
            board["inputs"] = board["inverted"]

    @property
    def outputs(self) -> int:
        """Digital outputs; output 1 is bit 0."""
        return 0 if self.variables.interface.is_down else int(self.state.board[0]["outputs"])

    @outputs.setter
    def outputs(self, value: int) -> None:
        self.state.board[0]["outputs"] = value & ((1 << OUTPUTS) - 1)

    @property
    def nfrax(self) -> int:
        """Axes that do not count for the path, bit by index."""
        return int(self.state.board[0]["nfrax"])

    @nfrax.setter
    def nfrax(self, value: int) -> None:
        self.state.board[0]["nfrax"] = value & 0xFFFFFFFF
        self.state.feed_axis[:] = [1 - (value >> i & 1) for i in range(len(self.axes))]

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
        return float(profile_velocity(self.state, i))

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

    def start_analysis(self, axes: tuple[int, ...], *, every: int = 1) -> None:
        """Record setpoint, actual position and commanded velocity of `axes`, in every so many scans."""
        row = self.state.board[0]
        row["record_axes"] = sum(1 << i for i in axes)
        row["record_every"] = max(every, 1)
        row["record_count"] = row["recorded"] = 0

    def analysis(self, i: int) -> Floats:
        """Return what was recorded of an axis, one row a time: machine positions, and a velocity."""
        return self.state.analysis[: self.state.board[0]["recorded"], i].copy()

    # ------------------------------------------------------------------ time

    @property
    def time_s(self) -> float:
        """Time since the board was booted."""
        return self.clock.now_s

    def command(self, axes: tuple[int, ...], begin: partial[None]) -> None:
        """Let `axes` have a direct command: no profile end from now on; `begin` is called when it takes effect."""
        for i in axes:
            row = self.state.axis[i]
            row["commanded"] += 1
            row["pe"] = row["saf"] = 0
        orders = tuple(self.orders[i] for i in axes)
        self.pending.append(Command(self.clock.cycles + LATENCY_SCANS, axes, orders, begin))

    def in_turn(self, axes: Sequence[int], carry_out: partial[None]) -> None:
        """Carry out a command of the spoolers of `axes`, behind the direct commands that they have been given.

        A direct command rejects what is queued when it takes effect; what is queued behind it stays.
        """
        on_the_way = [each.due for each in self.pending if not set(axes).isdisjoint(each.axes)]
        if not on_the_way:
            carry_out()
            return
        due, orders = max(on_the_way), tuple(self.orders[i] for i in axes)
        at = bisect_right(self.pending, due, key=lambda each: each.due)
        self.pending.insert(at, Command(due, tuple(axes), orders, carry_out, moves=False))

    def cancel_commands(self, i: int) -> None:
        """Make void what was commanded to an axis and has not taken effect."""
        self.orders[i] += 1
        self.state.axis[i]["commanded"] = 0

    def _carry_out(self) -> None:
        """Carry out the direct commands that are due."""
        while self.pending and self.pending[0].due <= self.clock.cycles:
            command = self.pending.pop(0)
            valid = [
                i for i, order in zip(command.axes, command.orders, strict=True) if order == self.orders[i]
            ]
            for i in valid if command.moves else ():
                self.state.axis[i]["commanded"] -= 1
            if len(valid) == len(command.axes):
                command.begin()

    def advance(self, cycles: int, *, until: int | None = None) -> int:
        """Run up to `cycles` scans; return how many were run.

        Fewer after a scan in which one of the attentions `until` happened (`_scan`).
        """
        done, wanted = 0, until or 0
        self.look_at_interface()
        while done < cycles:
            self._carry_out()
            mask = INTERRUPT | RESET | wanted
            piece = min(cycles - done, PIECE_CYCLES)
            turns = NO_TURNS if self.tasks is None else self.tasks.turns()
            if self.pending:
                piece = min(piece, max(self.pending[0].due - self.clock.cycles, 1))
            ran = int(run_scans(self.state, self.kernel, turns, piece, mask, self.clock.cycles))
            done += ran
            self.clock.tick(ran)
            if self._attend() & wanted:
                break
        self._carry_out()
        return done

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

    def wait(self, axes: tuple[int, ...] | None = None, limit_s: float = 3600.0) -> None:
        """Run until the profiles of `axes` (all if None) have ended, at most `limit_s`."""
        chosen = [self.axes[i] for i in (range(len(self.axes)) if axes is None else axes)]
        wait(self, lambda: not any(axis.is_busy for axis in chosen), until=PROFILE_END, limit_s=limit_s)

    def reset(self) -> None:
        """Reset the whole system, as rs does."""
        self.pending.clear()
        reset_system(self)

    # ------------------------------------------------------------------ state

    def status(self) -> BoardStatus:
        """Return what the board is and does in the present scan."""
        return board_status(self)

    def snapshot(self) -> Snapshot:
        """Return the whole state of the board, its drives, its tasks, and commands on their way."""
        return take_snapshot(self)

    def restore(self, snapshot: Snapshot) -> None:
        """Go back to a snapshot of this board, or of one with the same system file.

        Raises:
            SnapshotError: It is of something else, or damaged; nothing has changed.
        """
        restore_state(self, snapshot)
