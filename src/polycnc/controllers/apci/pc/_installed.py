"""A virtual board in a slot of the PC: booted, loaded, and with it the simulated drives that its system file plans."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from polycnc.controllers.apci.board._board import Board
from polycnc.controllers.apci.board._codes import TransferCode
from polycnc.controllers.apci.board._environment import InterfaceStatus
from polycnc.controllers.apci.board._system_file import SystemFile
from polycnc.controllers.apci.pc._board_memory import BoardMemory

_IN_RECORD = (
    *("kp", "ki", "kd", "kpl", "kfca", "kfcv", "jac", "jvl", "jovr", "hac", "hvl", "sdec"),
    *("rp", "dp", "dv", "tp", "sll", "slr", "ipw", "mpe", "gf", "mcp", "aux", "digo", "ifs", "lsm"),
)


class InstalledBoard:
    """Hold the present `board`; booting makes a new one.

    `hardware` says what is really there: the type, the axes, their motors and what is simulated. Without it the system
    file that is loaded first after a boot is believed. `load_cnc` takes the programs of the tasks.
    """

    def __init__(self, hardware: SystemFile | None = None, *, record_scans: int = 0) -> None:
        self.hardware = hardware
        self.record_scans = record_scans
        self.interface = InterfaceStatus()
        self.on_new_board: list[Callable[[Board], None]] = []
        self.load_cnc: Callable[[Board, bytes], TransferCode] | None = None
        self.memory: BoardMemory | None = None
        self._eprom_cycles = 0
        self.take(Board(hardware, record_scans=record_scans))

    def take(self, board: Board) -> None:
        """Let `board` be the one in the slot."""
        self.board = board
        board.variables.interface = self.interface

    @property
    def eprom_cycles(self) -> int:
        """How often the EEPROM of the board has been programmed."""
        return self._eprom_cycles if self.memory is None else self.memory.programming_cycles

    @eprom_cycles.setter
    def eprom_cycles(self, count: int) -> None:
        if self.memory is None:
            self._eprom_cycles = count
        else:
            self.memory.programming_cycles = count

    @property
    def is_described(self) -> bool:
        """Whether somebody has said what the board is, its hardware or in a system file."""
        return self.hardware is not None or self.board.is_described

    @property
    def board_type(self) -> int:
        """Type number of the board."""
        return int(self.board.config.type_number)

    @property
    def number_of_axes(self) -> int:
        """Number of axis channels."""
        return len(self.board.axes)

    def reset(self) -> None:
        """Start the firmware anew."""
        self._replace(self.hardware)
        self.interface.start_firmware()

    def load_system(self, config: SystemFile) -> None:
        """Take over a system file: the whole board if it has just been booted, else its parameters."""
        if self.hardware is None and self.board.clock.cycles == 0:
            self.board.rebuild(config)
            self._announce()
        else:
            self.board.load_parameters(config)

    def _replace(self, config: SystemFile | None) -> None:
        self.take(Board(config, record_scans=self.record_scans))
        self._announce()

    def _announce(self) -> None:
        self.board.variables.interface = self.interface
        for announce in self.on_new_board:
            announce(self.board)

    def load_program(self, content: bytes) -> int:
        """Load a CNC file into the task that it names."""
        return TransferCode.WRONG_TYPE if self.load_cnc is None else self.load_cnc(self.board, content)

    def axis_parameters(self, axis: int) -> Mapping[str, float]:
        """Return the elements of TSRP with their present values."""
        one = self.board.axes[axis]
        values = {name: getattr(one, name) for name in _IN_RECORD}
        others = {"jtv": one.jtvl, "axst": int(one.axst), "digi": int(one.digi), "epc": self.eprom_cycles}
        return values | others
