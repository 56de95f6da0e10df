"""What the function library knows in one program: the boards in the PC, the one selected, and how time passes.

This holds the only state of the library: `attach` makes it, as loading mcug3.dll into a program does.
"""

from __future__ import annotations

import logging
import math
from collections.abc import Callable, Sequence
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

from polycnc.controllers.apci.board._axis import Axis
from polycnc.controllers.apci.board._board import Board
from polycnc.controllers.apci.board._codes import Status, TransferCode
from polycnc.controllers.apci.board._environment import InterfaceStatus, InterruptLine, Messages, Show
from polycnc.controllers.apci.board._records import AS
from polycnc.controllers.apci.core._registers import Axst
from polycnc.controllers.apci.core._scan import INTERRUPT, PROFILE_END
from polycnc.controllers.apci.pc._boot import Application
from polycnc.controllers.apci.pc._installed import InstalledBoard
from polycnc.controllers.apci.pc._slots import REVISION, Pc, Slot, revision_numbers
from polycnc.controllers.apci.sap import CncFileError, read_cnc
from polycnc.controllers.apci.sap._board_host import BoardTasks
from polycnc.machine import Poll, Way

UNKNOWN_ERROR = 1
"""Ruling: what functions with the usual status return for an axis or a number that cannot be."""

LARGEST = 1e100
"""Ruling: a number beyond it is treated like infinity."""

INTERRUPT_LINES = 1
"""Ruling: the bits an interrupt routine gets; Part 1 does not say which line is which."""

EVENTS = PROFILE_END | INTERRUPT
RPTODP_SINCE = "V2.5.3.100"
_STATUS_BITS_SINCE = {Axst.referenced: "V2.5.3.16", Axst.refh: "V2.5.3.47", Axst.saf: "V2.5.3.88"}

_log = logging.getLogger("polycnc.apci")


class Library:
    """The library in one program."""

    def __init__(self, pc: Pc, folder: str | Path, path: Sequence[str | Path], clock: Way | None, show: Show):
        self.application = Application(pc, folder, path)
        self.messages = Messages(show)
        self.clock = clock
        self.lines: dict[InstalledBoard, InterruptLine] = {}

    def installed(self) -> InstalledBoard | None:
        """Return the selected board if it can be used: there, booted and initialised."""
        slot = self.application.slot
        if slot is None or self.application.status() is not Status.DONE:
            return None
        return slot.board if isinstance(slot.board, InstalledBoard) else None

    def let_time_pass(self, board: Board) -> None:
        """Do what a status call does to the time of the board."""
        if self.clock is not None:
            self.clock.run(board, until=EVENTS)


_library = Library(Pc(), ".", (), None, _log.warning)


def library() -> Library:
    """Return the library as `attach` made it."""
    return _library


def attach(
    *boards: InstalledBoard | Board,
    booted: bool = True,
    clock: Way | None = Poll(1),  # noqa: B008  immutable
    folder: str | Path = ".",
    path: Sequence[str | Path] = (),
    revision: str = REVISION,
    driver_installed: bool = True,
    show: Show = _log.warning,
) -> tuple[Slot, ...]:
    """Put boards into the PC, numbered from 0, and load the library anew; return the boards' slots.

    `booted` boards are as mcfg.exe leaves them, with operating system and system file; else BootFile is the first
    call. In either case a program then calls InitMcuSystem3. `clock` says what a call that reads a status does to the
    board's time: `Poll(1)` lets one scan pass, `Poll(1000)` the time to the next end of a profile or interrupt but at
    most 1000 scans, `None` nothing, so that only `Board.advance` does. `folder` and `path` are the program's current
    directory and search path, `revision` is that of the operating system, `show` gets the message boxes.

    Booting makes a new `Board`, which `board` returns.
    """
    global _library
    pc = Pc(driver_installed=driver_installed)
    made = Library(pc, folder, path, clock, show)
    for each in boards:
        installed = each if isinstance(each, InstalledBoard) else _in_slot(each)
        slot = pc.attach(installed, revision=revision, environment=installed.board.config.environment)
        made.lines[installed] = line = InterruptLine()
        if booted:
            slot.running = slot.sysfile_loaded = True
            installed.interface.start_firmware()
        connect = partial(_connect, installed, line)
        connect(installed.board)
        installed.on_new_board.append(connect)
        installed.load_cnc = _load_cnc
    _library = made
    return tuple(pc.slots)


def detach() -> None:
    """Take all boards out of the PC."""
    attach()


def board() -> Board:
    """Return the selected board for Python: its time, terminals and simulated machine.

    Raises:
        LookupError: There is no board in the PC.
    """
    slot = _library.application.slot
    if slot is None or not isinstance(slot.board, InstalledBoard):
        raise LookupError("no board is attached")
    return slot.board.board


def _in_slot(board: Board) -> InstalledBoard:
    installed = InstalledBoard(board.config)
    installed.take(board)
    return installed


def _connect(installed: InstalledBoard, line: InterruptLine, board: Board) -> None:
    """Join a board to its tasks and to the interrupt routine of the PC."""
    board.interrupts.append(partial(line.raise_interrupt, INTERRUPT_LINES))
    if board.tasks is None:
        BoardTasks(board)


def _load_cnc(board: Board, content: bytes) -> TransferCode:
    """Load a CNC file into the task that it names."""
    try:
        program = read_cnc(content)
    except CncFileError as error:
        return TransferCode(error.code)
    if isinstance(board.tasks, BoardTasks):
        board.tasks.load(program)
    return TransferCode.DONE


# ---------------------------------------------------------------------- what the functions ask for


def usable_board() -> Board | None:
    """Return the selected board, None if a call does not reach it."""
    installed = _library.installed()
    return None if installed is None else installed.board


def usable_interface() -> InterfaceStatus | None:
    """Return the interface status of the selected board, None if a call does not reach it."""
    installed = _library.installed()
    return None if installed is None else installed.interface


def usable_axis(number: int, *, polled: bool = False) -> Axis | None:
    """Return an axis of the selected board, None if there is none; after time has passed if `polled`."""
    present = usable_board()
    if present is None or not 0 <= number < len(present.axes):
        return None
    if polled:
        _library.let_time_pass(present)
    return present.axes[number]


def polled_board() -> Board | None:
    """Return the selected board after time has passed, None if a call does not reach it."""
    present = usable_board()
    if present is not None:
        _library.let_time_pass(present)
    return present


def selected(asel: AS, least: int = 1) -> tuple[Board, tuple[int, ...]] | None:
    """Return the board and the axes of a selection; None if one of them is not there or they are too few."""
    present = usable_board()
    if present is None or not least <= asel.unoa <= len(asel.san):
        return None
    axes = tuple(asel.san[: asel.unoa])
    return (present, axes) if all(0 <= axis < len(present.axes) for axis in axes) else None


def on_axes(command: Callable[..., object], asel: AS, *arguments: Any) -> None:
    """Give a command to the axes of a selection; nothing happens if one of them is not there."""
    found = selected(asel)
    if found is not None:
        command(*found, *arguments)


def status_code() -> int:
    """Return what a function with the usual status returns for want of anything else."""
    return int(_library.application.status())


def is_number(value: float) -> bool:
    """Tell whether a board can be given this number."""
    return math.isfinite(value) and abs(value) <= LARGEST


def longint(value: float) -> int:
    """Return a whole number as 32 bits hold it."""
    return (int(value) + 0x80000000 & 0xFFFFFFFF) - 0x80000000


def revision() -> str:
    """Return the revision of the selected board's operating system; empty without a board."""
    slot = _library.application.slot
    return slot.revision if slot else ""


@lru_cache
def status_mask(revision: str) -> int:
    """Return the bits of axst that a revision of the operating system has."""
    numbers = revision_numbers(revision)
    young = (bit for bit, since in _STATUS_BITS_SINCE.items() if revision_numbers(since) > numbers)
    return Axst.assigned() & ~sum(young)
