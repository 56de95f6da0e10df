"""The PC's slots with the boards in them, what a board must offer to be booted, and faults made to happen."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Protocol

from polycnc.controllers.apci.board._codes import BootCode, InitCode, TransferCode
from polycnc.controllers.apci.board._environment import EnvironmentStrings
from polycnc.controllers.apci.board._system_file import SystemFile
from polycnc.controllers.apci.core._registers import Axst
from polycnc.controllers.apci.pc._board_memory import BoardMemory
from polycnc.controllers.library import Code
from polycnc.errors import UsageError

REVISION = "V2.5.3.100"
_STATUS_BITS_SINCE = {Axst.referenced: "V2.5.3.16", Axst.refh: "V2.5.3.47", Axst.saf: "V2.5.3.88"}

# Faults of the hardware in the order in which they show; the library finds all other codes by itself.
FAULTS_BEFORE_RESET = (BootCode.DEVICE_ADDRESSES, BootCode.FLASH_ACCESS, BootCode.FLASH_SIZE)
FAULTS_IN_BOOTING = (
    BootCode.BAD_ELF,
    BootCode.START_ADDRESS,
    BootCode.WRONG_PLATFORM,
    BootCode.VERIFY_FAILED,
)
FAULTS_IN_REACHING = (
    InitCode.MAPPING,
    InitCode.MAPPING_IN,
    InitCode.MAPPING_OUT,
    InitCode.BOARD_ACCESS,
    InitCode.MAILBOX_ACCESS,
)
FAULTS_IN_TRANSFER = (TransferCode.MEMORY, TransferCode.REMOTE)
FAULTS: tuple[Code, ...] = (
    *FAULTS_BEFORE_RESET,
    *FAULTS_IN_BOOTING,
    *FAULTS_IN_REACHING,
    InitCode.VERSION_MISMATCH,
    *FAULTS_IN_TRANSFER,
)


class BootableBoard(Protocol):
    """What a board offers to whoever boots it."""

    @property
    def board_type(self) -> int:
        """Return the type number, see `BoardType`."""

    @property
    def number_of_axes(self) -> int:
        """Return the number of axis channels."""

    def reset(self) -> None:
        """Become as after a start of the operating system; nothing of a system file is left."""

    def load_system(self, config: SystemFile) -> None:
        """Take over a system file, over whatever was changed since."""

    def load_program(self, content: bytes) -> int:
        """Load a CNC file into the task that it names and return a `TransferCode`."""

    def axis_parameters(self, axis: int) -> Mapping[str, float]:
        """Return the elements of TSRP with their present values, but for `an` and `scratch`."""


@dataclass(slots=True, eq=False)
class Slot:
    """A place in the PC with a board in it."""

    board: BootableBoard
    revision: str = REVISION
    environment: EnvironmentStrings = field(default_factory=EnvironmentStrings)
    running: bool = False  # the operating system is loaded and has not stopped
    sysfile_loaded: bool = False
    has_defaults: bool = False  # nobody has said what the board is: its system file is an empty one
    boots: int = 0
    memory: BoardMemory | None = None  # where the environment strings outlast switching off
    _faults: set[Code] = field(default_factory=set)

    def inject(self, fault: Code) -> None:
        """Make a fault happen from now on, named by the code that reports it.

        Raises:
            UsageError: The code reports something that the virtual board finds by itself.
        """
        if fault not in FAULTS:
            raise UsageError(
                f"{fault!r} is no fault of the hardware",
                hint="bring about what it reports: a missing file, ...",
            )
        self._faults.add(fault)

    def repair(self, fault: Code) -> None:
        """End a fault."""
        self._faults.discard(fault)

    def write_environment(self, name: str, value: str) -> None:
        """Set an environment string, as the setup program of the firmware does.

        Raises:
            UsageError: The board is booted, or the text is longer than getEnvStr can give back.
        """
        if self.running:
            raise UsageError(
                f"'{name}' cannot be written: the board is booted", hint="write it before BootFile"
            )
        self.environment.write(name, value)
        if self.memory is not None:
            self.memory.write_environment(name, value)

    def stop(self) -> None:
        """Stop the operating system, as an exception on the board does; only BootFile starts it again."""
        self.running = False

    def first_fault(self, among: Sequence[Code]) -> Code | None:
        """Return the first of these faults that is present."""
        return next((fault for fault in among if fault in self._faults), None)


@dataclass(slots=True, eq=False)
class Pc:
    """A PC: its boards, and whether their driver is installed."""

    slots: list[Slot] = field(default_factory=list)
    driver_installed: bool = True

    def attach(
        self,
        board: BootableBoard,
        *,
        revision: str = REVISION,
        environment: Mapping[str, str] | None = None,
        memory: BoardMemory | None = None,
    ) -> Slot:
        """Put a board into the next slot and return the slot; what `memory` holds goes before `environment`.

        Raises:
            UsageError: An environment string is longer than getEnvStr can give back.
        """
        strings = {**(environment or {}), **(memory.environment if memory is not None else {})}
        self.slots.append(Slot(board, revision, EnvironmentStrings(strings), memory=memory))
        return self.slots[-1]


def revision_numbers(revision: str) -> tuple[int, ...]:
    """Return the numbers in a revision like V2.5.3.37, for comparison."""
    return tuple(map(int, re.findall(r"\d+", revision)))


@lru_cache
def status_mask(revision: str) -> int:
    """Return the bits of axst that a revision of the operating system has."""
    numbers = revision_numbers(revision)
    young = (bit for bit, since in _STATUS_BITS_SINCE.items() if revision_numbers(since) > numbers)
    return Axst.assigned() & ~sum(young)
