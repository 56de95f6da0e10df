"""What commands of a board act on: its axes, registers, variables, and the commands that are on their way.

Commands are functions of their own that take it (`_axis_commands`, `_jog_commands`, `_move_commands`,
`_spool_commands`); the function library and the SAP tasks both call them.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from polycnc.controllers.apci.board._axis import Axis
from polycnc.controllers.apci.board._board_variables import Tasks, Variables
from polycnc.controllers.apci.board._command import Command
from polycnc.controllers.apci.board._declared import COMMON_VARIABLES
from polycnc.controllers.apci.board._system_file import SystemFile
from polycnc.controllers.apci.board._units import PathUnits
from polycnc.controllers.apci.core._registers import OUTPUTS, ErrorReg, ModeReg
from polycnc.controllers.apci.core._state import BoardState, make_board_state
from polycnc.kernel import KernelState, make_state
from polycnc.machine import Clock

LATENCY_SCANS = 2  # after which a direct command takes effect (Manual 002, 2.2.8.1)


class BoardAxis(Axis):
    """An axis with the board that it is on, for those who are given an axis alone."""

    def __init__(self, board: CommandedBoard, index: int) -> None:
        super().__init__(
            board.config, board.state, board.kernel, index, lambda: board.inputs, board.units_in_use.clear
        )
        self.board = board

    @property
    def digo(self) -> int:
        """Digital outputs: those of the board, whatever the axis."""
        return self.board.outputs

    @digo.setter
    def digo(self, value: int) -> None:
        self.board.outputs = value

    @property
    def ifs(self) -> int:
        """State of the board's interfaces."""
        return int(self.board.variables.interface.word)


class CommandedBoard:
    """A board as its system file describes it, without its time; `record_scans` as for `Board`."""

    def __init__(self, config: SystemFile | None = None, *, record_scans: int = 0) -> None:
        self.is_described = config is not None
        self._record_scans = record_scans
        self._build(config or SystemFile())

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
        self.tasks: Tasks | None = None
        self.interrupts: list[Callable[[], None]] = []
        self.units_in_use: dict[tuple[tuple[int, ...], int, int, int], PathUnits | None] = {}
        self.axes = tuple(BoardAxis(self, i) for i in range(n))
        self.planned = self.config  # the system file that was loaded last
        self.pending: list[Command] = []
        self.orders = [0] * n  # a command is void when its axes have had another since

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

    # ------------------------------------------------------------------ commands

    def command(self, axes: tuple[int, ...], begin: partial[None]) -> None:
        """Let `axes` have a direct command: no profile end from now on; `begin` is called when it takes effect."""
        for i in axes:
            row = self.state.axis[i]
            row["commanded"] += 1
            row["pe"] = row["saf"] = 0
        orders = tuple(self.orders[i] for i in axes)
        self.pending.append(Command(self.clock.cycles + LATENCY_SCANS, axes, orders, begin))

    def in_turn(self, axes: Sequence[int], carry_out: partial[None]) -> None:
        """Carry out a command of the spoolers of `axes`, after the direct commands that they have been given.

        A direct command rejects what is queued when it takes effect; what is queued after it stays.
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
