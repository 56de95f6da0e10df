"""What the function library knows in one program: the boards in the PC, the one selected, and how time passes.

A session is one program with mcug3.dll loaded; `attach` loads it anew. The functions of the module share one.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from polycnc.controllers.apci.board._board import Board
from polycnc.controllers.apci.board._codes import Status, TransferCode
from polycnc.controllers.apci.board._commanded import BoardAxis
from polycnc.controllers.apci.board._environment import InterruptLine, Messages, Show
from polycnc.controllers.apci.board._records import AS, TSRP
from polycnc.controllers.apci.core._scan import INTERRUPT, PROFILE_END
from polycnc.controllers.apci.pc._board_memory import BoardMemory
from polycnc.controllers.apci.pc._boot import Application
from polycnc.controllers.apci.pc._installed import InstalledBoard
from polycnc.controllers.apci.pc._slots import REVISION, Pc, Slot, revision_numbers, status_mask
from polycnc.controllers.apci.sap import CncFileError, read_cnc
from polycnc.controllers.apci.sap._board_host import BoardTasks
from polycnc.controllers.library import Refused
from polycnc.controllers.library import Session as AnySession
from polycnc.machine import Poll, Polling, Store, Way

UNKNOWN_ERROR = 1
"""Ruling: what functions with the usual status return for an axis or a number that cannot be."""

INTERRUPT_LINES = 1
"""Ruling: the bits an interrupt routine gets; Part 1 does not say which line is which."""

EVENTS = PROFILE_END | INTERRUPT
RPTODP_SINCE = "V2.5.3.100"

_log = logging.getLogger("polycnc.apci")


@dataclass(frozen=True, slots=True)
class Exchange:
    """A record, and the axis that it names."""

    record: TSRP
    axis: BoardAxis
    session: Session


@dataclass(frozen=True, slots=True)
class Selection:
    """The axes that a program has selected."""

    board: Board
    axes: tuple[int, ...]

    def order(self, command: Callable[..., object], *arguments: object) -> None:
        """Give them a command of the board."""
        command(self.board, self.axes, *arguments)


class Session(AnySession):
    """A program that has loaded the library."""

    def __init__(self) -> None:
        super().__init__()
        self.lines: dict[InstalledBoard, InterruptLine] = {}
        self._memory: Store | None = None
        self._owns_memory = False
        self.attach()

    def attach(
        self,
        *boards: InstalledBoard | Board,
        booted: bool = True,
        clock: Way | None = Poll(1),  # noqa: B008  immutable
        folder: str | Path = ".",
        path: Sequence[str | Path] = (),
        revision: str = REVISION,
        driver_installed: bool = True,
        show: Show = _log.warning,
        memory: str | Path | Store | None = None,
    ) -> tuple[Slot, ...]:
        """Put boards into the PC, numbered from 0, and load the library anew; return the boards' slots.

        `booted` boards are as mcfg.exe leaves them, with operating system and system file; else BootFile is the first
        call. A booted board that was made without a system file takes the one that InitMcuSystem names, if it is there.
        In either case a program then calls InitMcuSystem3. `clock` says what a call that reads a status which has been
        read in this scan already does to the boards' time: `Poll(1)` lets one scan pass, `Poll(1000)` the time to the
        next end of a profile or interrupt but at most 1000 scans, `None` nothing, so that only `Board.advance` does;
        with `Elapsed` every call lets the time pass that has passed for the program. `folder` and `path` are the
        program's current directory and search path, `revision` is that of the operating system, `show` gets the message
        boxes. `memory` is the file of what outlasts switching off, or an open store: the EEPROM's programming cycles,
        environment strings written, and the programs loaded into the tasks, which are there again after every boot.

        Booting makes a new `Board`, which `board` returns.

        Raises:
            StoreError: The memory file cannot be used.
        """
        with self.lock:
            self._close_memory()
            store = Store(memory) if isinstance(memory, str | Path) else memory
            self._memory, self._owns_memory = store, isinstance(memory, str | Path)
        pc = Pc(driver_installed=driver_installed)
        lines: dict[InstalledBoard, InterruptLine] = {}
        for number, each in enumerate(boards):
            installed = each if isinstance(each, InstalledBoard) else _in_slot(each)
            kept = None if store is None else BoardMemory(store, number)
            installed.memory = kept
            slot = pc.attach(
                installed, revision=revision, environment=installed.board.config.environment, memory=kept
            )
            lines[installed] = line = InterruptLine()
            if booted:
                slot.running = slot.sysfile_loaded = True
                slot.has_defaults = not installed.is_described
                installed.interface.start_firmware()
            connect = partial(_connect, installed, line)
            connect(installed.board)
            installed.on_new_board.append(connect)
            installed.load_cnc = partial(_load_cnc, kept)
        with self.lock:
            self._disconnect()
            self.application = Application(pc, folder, path)
            self.messages = Messages(show)
            self.polling, self.lines = Polling(clock, self._boards), lines
            self._said = False
        return tuple(pc.slots)

    def detach(self) -> None:
        """Take all boards out of the PC."""
        self.attach()

    def _disconnect(self) -> None:
        """Take the interrupt routines of this program from boards that other programs may go on using."""
        for installed, line in self.lines.items():
            interrupts = installed.board.interrupts
            interrupts[:] = [
                each for each in interrupts if getattr(each, "func", None) != line.raise_interrupt
            ]

    def _close_memory(self) -> None:
        if self._memory is not None and self._owns_memory:
            self._memory.close()
        self._memory = None

    def board(self) -> Board:
        """Return the selected board for Python: its time, terminals and simulated machine.

        Raises:
            LookupError: There is no board in the PC.
        """
        slot = self.application.slot
        if slot is None or not isinstance(slot.board, InstalledBoard):
            raise LookupError("no board is attached")
        return slot.board.board

    # ------------------------------------------------------------------ what the functions ask for

    def installed(self) -> InstalledBoard:
        """Return the selected board in its slot.

        Raises:
            Refused: It cannot be used: it is not there, not booted or not initialised.
        """
        slot, status = self.application.slot, self.application.status()
        if slot is None or status is not Status.DONE or not isinstance(slot.board, InstalledBoard):
            self._say_that_nothing_happens(slot)
            raise Refused(status or UNKNOWN_ERROR)
        return slot.board

    def usable(self) -> Board:
        """Return the selected board.

        Raises:
            Refused: A call does not reach it.
        """
        board = self.installed().board
        self.polling.call(board, until=EVENTS)
        return board

    def polled(self) -> Board:
        """Return the selected board after time has passed.

        Raises:
            Refused: A call does not reach it.
        """
        board = self.usable()
        self.polling.read(board, self.asked, until=EVENTS)
        return board

    def axis(self, number: int) -> BoardAxis:
        """Return an axis of the selected board.

        Raises:
            Refused: There is none, or the board is not reached.
        """
        board = self.usable()
        if not 0 <= number < len(board.axes):
            raise Refused(UNKNOWN_ERROR)
        return board.axes[number]

    def polled_axis(self, number: int) -> BoardAxis:
        """Return an axis of the selected board after time has passed.

        Raises:
            Refused: There is none, or the board is not reached.
        """
        axis = self.axis(number)
        self.polling.read(self.usable(), (self.asked, number), until=EVENTS)
        return axis

    def named_in(self, record: TSRP) -> Exchange:
        """Return a record with the axis that it names.

        Raises:
            Refused: There is none, or the board is not reached.
        """
        return Exchange(record, self.axis(record.an), self)

    def polled_in(self, record: TSRP) -> Exchange:
        """Return a record with the axis that it names, after time has passed.

        Raises:
            Refused: There is none, or the board is not reached.
        """
        return Exchange(record, self.polled_axis(record.an), self)

    def selected(self, asel: AS) -> Selection:
        """Return the axes of a selection.

        Raises:
            Refused: One of them is not there, there are none, or the board is not reached.
        """
        board = self.usable()
        if not 1 <= asel.unoa <= len(asel.san):
            raise Refused(UNKNOWN_ERROR)
        axes = tuple(asel.san[: asel.unoa])
        if not all(0 <= axis < len(board.axes) for axis in axes):
            raise Refused(UNKNOWN_ERROR)
        return Selection(board, axes)

    def selected_by_new(self, asel: AS) -> Selection:
        """Return the axes of a selection if the operating system knows RPtoDP.

        Raises:
            Refused: It does not, or the axes cannot be selected.
        """
        if revision_numbers(self.revision) < revision_numbers(RPTODP_SINCE):
            raise Refused(Status.NOT_AVAILABLE)
        return self.selected(asel)

    def line(self) -> InterruptLine:
        """Return the interrupt line of the selected board.

        Raises:
            Refused: There is none.
        """
        slot = self.application.slot
        if slot is None or not isinstance(slot.board, InstalledBoard):
            raise Refused(UNKNOWN_ERROR)
        return self.lines[slot.board]

    def _say_that_nothing_happens(self, slot: Slot | None) -> None:
        """Log, once, that calls do not reach a board: a program that polls it would wait for ever without a word."""
        if not self._said:
            self._said = True
            why = "there is no board" if slot is None else "the program has not called InitMcuSystem3"
            _log.warning("calls do not reach a board and do nothing: %s", why)

    def _boards(self) -> list[Board]:
        return [installed.board for installed in self.lines]

    @property
    def revision(self) -> str:
        """Return the revision of the selected board's operating system; empty without a board."""
        slot = self.application.slot
        return slot.revision if slot else ""

    def status_of(self, axis: BoardAxis) -> int:
        """Return the status of an axis, without bits that the operating system does not have yet."""
        return axis.status_word & status_mask(self.revision)


def _in_slot(board: Board) -> InstalledBoard:
    installed = InstalledBoard(board.config if board.is_described else None)
    installed.take(board)
    return installed


def _connect(installed: InstalledBoard, line: InterruptLine, board: Board) -> None:
    """Join a board to its tasks and to the interrupt routine of the PC."""
    board.interrupts.append(partial(line.raise_interrupt, INTERRUPT_LINES))
    if board.tasks is None:
        BoardTasks(board)
    for task, content in ({} if installed.memory is None else installed.memory.programs).items():
        if _load_cnc(None, board, content) != TransferCode.DONE:
            _log.warning("the program of task %s in the memory file is damaged: the task has none", task)


def _load_cnc(memory: BoardMemory | None, board: Board, content: bytes) -> TransferCode:
    """Load a CNC file into the task that it names, and keep it."""
    try:
        program = read_cnc(content)
    except CncFileError as error:
        return TransferCode(error.code)
    if isinstance(board.tasks, BoardTasks):
        board.tasks.load(program)
    if memory is not None:
        memory.keep_program(program.task, content)
    return TransferCode.DONE
