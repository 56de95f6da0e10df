"""From a board that is switched on to one that moves: selecting, booting, initialising, transferring files.

An `Application` is one program with the library loaded; it uses one board at a time.
"""

from __future__ import annotations

import logging
import re
from collections.abc import Sequence
from pathlib import Path

from polycnc.controllers.apci.board._codes import CARD_NOT_THERE, BootCode, InitCode, Status, TransferCode
from polycnc.controllers.apci.board._declared import MAXAXIS, ROSI, TSRP, CppString
from polycnc.controllers.apci.board._system_file import parse_system_file
from polycnc.controllers.apci.core._registers import BoardType
from polycnc.controllers.apci.pc._slots import (
    FAULTS_BEFORE_RESET,
    FAULTS_IN_BOOTING,
    FAULTS_IN_REACHING,
    FAULTS_IN_TRANSFER,
    Pc,
    Slot,
    revision_numbers,
    status_mask,
)
from polycnc.controllers.library import Code, Elements
from polycnc.errors import ConfigurationError, UsageError

_log = logging.getLogger("polycnc.apci")

ELF_MAGIC = b"\x7fELF"
SYSTEM_FILE = "system.dat"
GET_ENV_STR_SINCE = "V2.5.3.37"


class Application:
    """A program that uses the library. `folder` is its current directory, `path` its search path.

    `problem` tells what was wrong with the last system file that was refused.
    """

    def __init__(self, pc: Pc, folder: str | Path = ".", path: Sequence[str | Path] = ()) -> None:
        self.pc = pc
        self.problem: ConfigurationError | None = None
        self._folders = [Path(folder), *map(Path, path)]
        self._selected = 0
        self._known: list[Slot] = []  # the library's list of boards, as of the last initialisation
        self._connected: dict[Slot, int] = {}  # boots of the board when it was initialised

    @property
    def slot(self) -> Slot | None:
        """Return the selected board's slot, None if there is no board."""
        return self.pc.slots[self._selected] if self._selected < len(self.pc.slots) else None

    @property
    def selected(self) -> int:
        """The number of the selected board, from 0."""
        return self._selected

    def status(self, since: str = "") -> Status:
        """Return what a function with the usual status returns; `since` is the revision that brought it.

        Without initialisation, or after the board was booted again or has stopped, there is no connection.
        """
        slot = self.slot
        if slot is None or self._unreachable() is not None or self._connected.get(slot) != slot.boots:
            return Status.TIMEOUT
        if since and revision_numbers(slot.revision) < revision_numbers(since):
            return Status.NOT_AVAILABLE
        return Status.DONE

    def card_select(self, card: int) -> int:
        """Select a board, from 0, and return its number, or -1 after selecting board 0 instead (4.4.6).

        The library knows the boards that were there at the last initialisation, so none before the first.
        """
        found = 0 <= card < len(self._known)
        self._selected = card if found else 0
        return card if found else CARD_NOT_THERE

    def boot_file(self, filename: str, tpu_base_address: int = 0) -> int:
        """Reset the selected board, load its operating system and return a `BootCode` (4.4.5).

        Any file that begins like an ELF file will do. What is wrong with the file or in reaching the board leaves
        the board as it was; what goes wrong later leaves it reset and not booted.
        """
        if not re.fullmatch(r'[^\x00-\x1f<>"|?*]*[^\x00-\x1f<>"|?*\\/ ]', filename):
            return BootCode.FILE_NAME
        try:
            with (self._folders[0] / filename).open("rb") as file:
                magic = file.read(len(ELF_MAGIC))
        except (OSError, ValueError):  # ValueError: no file can have this name
            return BootCode.CANNOT_OPEN
        if magic != ELF_MAGIC:
            return BootCode.UNKNOWN_FORMAT
        slot = self.slot
        if slot is None:
            return BootCode.DEVICE_ADDRESSES
        if fault := slot.first_fault(FAULTS_BEFORE_RESET):
            return fault
        slot.running = slot.sysfile_loaded = slot.has_defaults = False
        slot.boots += 1
        slot.board.reset()
        if fault := slot.first_fault(FAULTS_IN_BOOTING):
            return fault
        slot.running = True
        return BootCode.DONE

    def mcuinit(self, rosi: ROSI) -> None:
        """Fill `rosi` from the board, with zeros if it does not answer (4.4.32)."""
        slot = self._reach() if self._unreachable() is None else None
        rosi.revision = slot.revision if slot else ""
        rosi.number_axis = slot.board.number_of_axes if slot else 0
        rosi.sysfile_loaded = int(slot.sysfile_loaded) if slot else 0

    def init_mcu_system(self, tsrp: Elements[TSRP]) -> int:
        """Initialise the connection with `system.dat` and return an `InitCode` or `TransferCode` (4.4.16).

        Raises:
            UsageError: `tsrp` has not one record for each possible axis.
        """
        return self._initialise(tsrp, SYSTEM_FILE, named_only=True)

    def init_mcu_system2(self, tsrp: Elements[TSRP], tpu_base_address: int, filename: str) -> int:
        """Initialise the connection with a system file of any name (4.4.17).

        Raises:
            UsageError: `tsrp` has not one record for each possible axis.
        """
        return self._initialise(tsrp, filename)

    def init_mcu_system3(
        self, tsrp: Elements[TSRP], rosi: ROSI, tpu_base_address: int, filename: str
    ) -> tuple[int, int]:
        """Initialise the connection, fill `rosi`, and return the code and the type of the board (4.4.18).

        Raises:
            UsageError: `tsrp` has not one record for each possible axis.
        """
        code = self._initialise(tsrp, filename)
        self.mcuinit(rosi)
        slot = self.slot if self.status() == Status.DONE else None
        return code, slot.board.board_type if slot else BoardType.UNKNOWN

    def txbf(self, filename: str) -> int:
        """Transfer a file whose name has neither drive nor folder, else as `txbf2`."""
        return TransferCode.CANNOT_OPEN if re.search(r"[\\/:]", filename) else self.txbf2(filename)

    def txbf2(self, filename: str) -> int:
        """Transfer a system file or a CNC file to the board and return a `TransferCode` (4.4.129).

        A name that ends in .CNC is a CNC file, text is a system file. The search goes through the current directory
        and then the search path.
        """
        content = self._content(filename)
        if content is None:
            return TransferCode.CANNOT_OPEN
        slot = self.slot
        if slot is None or self.status() != Status.DONE:
            return TransferCode.REMOTE
        if fault := slot.first_fault(FAULTS_IN_TRANSFER):
            return fault
        if filename.upper().endswith(".CNC"):
            return slot.board.load_program(content)
        try:
            text = content.decode("utf-8-sig")
        except UnicodeDecodeError:
            return TransferCode.WRONG_TYPE
        if "\0" in text:
            return TransferCode.WRONG_TYPE
        try:
            config = parse_system_file(text, filename)
        except ConfigurationError as error:
            self.problem = error
            return TransferCode.DAMAGED
        slot.board.load_system(config)
        slot.sysfile_loaded = True
        slot.has_defaults = False
        return TransferCode.DONE

    def get_env_str(self, env: CppString) -> int:
        """Put the value of the environment string that `env` names into `env`, and return its length (4.4.12).

        Returns 0 and an empty text for a name that is not there; a negative `Status` leaves `env` alone.
        """
        if (status := self.status(GET_ENV_STR_SINCE)) != Status.DONE:
            return status
        slot = self._reach()
        length, env.text = slot.environment.read(env.text)
        return length

    def _initialise(self, tsrp: Elements[TSRP], filename: str, *, named_only: bool = False) -> int:
        if len(tsrp) != MAXAXIS:
            raise UsageError(
                f"{len(tsrp)} TSRP records", hint=f"the library wants {MAXAXIS}: use tsrp_array()"
            )
        if self.pc.driver_installed:
            self._known = list(self.pc.slots)
        if (code := self._unreachable()) is not None:
            return code
        slot = self._reach()
        for axis in range(MAXAXIS):
            tsrp[axis].an = axis
        if slot.has_defaults or not slot.sysfile_loaded:
            loaded = self.txbf(filename) if named_only else self.txbf2(filename)
            if slot.has_defaults and loaded == TransferCode.CANNOT_OPEN:
                _log.warning("there is no system file '%s': the board keeps its default parameters", filename)
            elif loaded != TransferCode.DONE:
                return loaded
        for axis in range(slot.board.number_of_axes):
            for name, value in slot.board.axis_parameters(axis).items():
                setattr(tsrp[axis], name, value)
            tsrp[axis].axst &= status_mask(slot.revision)
        return InitCode.DONE

    def _unreachable(self) -> Code | None:
        """Return why the board cannot be reached: from the driver inwards, None if it can."""
        if not self.pc.driver_installed:
            return InitCode.NO_DRIVER
        slot = self.slot
        if slot is None:
            return InitCode.NO_BOARD
        if fault := slot.first_fault(FAULTS_IN_REACHING):
            return fault
        if not slot.running:
            return InitCode.NOT_BOOTED
        return slot.first_fault((InitCode.VERSION_MISMATCH,))

    def _reach(self) -> Slot:
        slot = self.pc.slots[self._selected]
        self._connected[slot] = slot.boots
        return slot

    def _content(self, filename: str) -> bytes | None:
        if not filename or "\0" in filename:
            return None
        for folder in self._folders:
            try:
                return (folder / filename).read_bytes()
            except (OSError, ValueError):
                continue
        return None
