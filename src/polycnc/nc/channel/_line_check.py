"""The check of blocks before they are executed: what would be wrong with them after all that has come before."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

from polycnc.errors import ProgramError
from polycnc.machine import MachineConfig
from polycnc.nc.blocks._channel_state import ChannelState
from polycnc.nc.blocks._interpreter import Interpreter
from polycnc.nc.blocks._messages import Messages
from polycnc.nc.blocks._moves import QueueItem
from polycnc.nc.blocks._outcomes import Continuation, Problem
from polycnc.nc.blocks._queue import QueueWriter
from polycnc.nc.blocks._tables import ProgramTables
from polycnc.nc.dialect._dialect import Dialect
from polycnc.nc.modal._modal_snapshot import ModalSnapshot
from polycnc.nc.text._program import ProgramText
from polycnc.nc.text._scan import PERCENT
from polycnc.nc.text._scan_plain import Block, scan_block


class _Unwritten(Mapping[Any, Any]):
    """Show a table of the machine; what blocks set in it stays with those who look through this."""

    def __init__(self, table: Any) -> None:
        self._table = table

    def __getitem__(self, key: Any) -> Any:
        return self._table[key]

    def __iter__(self) -> Iterator[Any]:
        return iter(self._table)

    def __len__(self) -> int:
        return len(self._table)

    def __contains__(self, key: object) -> bool:
        return key in self._table

    @property
    def revision(self) -> int:
        """How often the table has been changed."""
        return int(getattr(self._table, "revision", 0))


class _NoQueue(QueueWriter):
    """Take what blocks give to a queue, and drop it."""

    def __init__(self) -> None:
        self.marks = None

    def set_tolerance(self, tolerance_mm: float, merge_mm: float) -> None:
        """Do nothing."""

    def put_block(self, items: list[QueueItem]) -> None:
        """Do nothing."""

    def put(self, item: QueueItem) -> None:
        """Do nothing."""


class LineCheck:
    """Execute blocks on a copy of the state of a channel: nothing moves, and nothing of the channel changes.

    With `words_only` a language executes the programs, so that only those lines are refused that are no blocks at all.
    `ended_at` is the line that ends the program, 0 while none has.
    """

    def __init__(
        self,
        dialect: Dialect,
        state: ChannelState,
        call_problem: Callable[[int, ProgramText, int], Problem | None],
        *,
        words_only: bool,
    ) -> None:
        self.state = state.copy()
        self._machine = state.machine
        self._seen = _unwritten(state.machine)
        self._follow(state)
        self._rules = dialect.text
        self._words_only = words_only
        self._sure = True
        self._begun = False
        self.ended_at = 0
        self._interpreter = Interpreter(
            dialect, self.state, Messages(), _NoQueue(), call_problem, _no_reference
        )

    def follow(self, state: ChannelState) -> None:
        """Take over a state in which everything that was checked has been executed."""
        self.state.take(state)
        self._follow(state)
        self._sure = True

    def _follow(self, state: ChannelState) -> None:
        mine = self.state
        if state.machine is not self._machine:
            self._machine, self._seen = state.machine, _unwritten(state.machine)
        mine.machine = self._seen
        mine.tables = ProgramTables(self._seen)
        mine.tables.restore(state.tables.save())
        mine.compensation = state.compensation.copy()

    def check(self, text: ProgramText, skip_levels: frozenset[int]) -> None:
        """Take the blocks of a text as those that come next; refused ones change nothing.

        Raises:
            ProgramError: one of them cannot be executed, or stands after the end of the program.
        """
        before = self.state.copy()
        tables = before.tables.save()
        flags = self._sure, self._begun, self.ended_at
        try:
            offset, line = 0, text.first_line
            while offset < len(text):
                block = scan_block(text, offset, line, self._rules)
                self._take(text, block, skip_levels)
                offset, line = text.next_line(offset), line + 1
        except ProgramError:
            self.state.take(before)
            self.state.tables.restore(tables)
            self._sure, self._begun, self.ended_at = flags
            raise

    def _take(self, text: ProgramText, block: Block, skip_levels: frozenset[int]) -> None:
        if self.ended_at:
            if block.words:
                raise ProgramError(
                    f"the program ended on line {self.ended_at}",
                    position=text.position(block.words[0].place),
                    hint="Send what follows as another program.",
                )
            return
        if block.flags & PERCENT:
            self.ended_at = block.line if self._begun else 0
            return
        if block.words and block.skip_level not in skip_levels:
            if self._begun and block.words[0].letter == "O":
                self.ended_at = block.line
                return
            self._begun = True
        if block.is_blank or self._words_only or not self._sure or block.skip_level in skip_levels:
            return
        outcome = self._interpreter.execute(text, block)
        if outcome.continuation in (Continuation.END, Continuation.RETURN):
            self.ended_at = block.line
        elif (
            outcome.continuation is Continuation.CALL
        ):  # what it leaves behind is known when it has been executed
            self._sure = False


def _unwritten(machine: MachineConfig) -> MachineConfig:
    """Return a machine file whose tables no block can set."""
    tables = {"tools": _Unwritten(machine.tools), "offsets": _Unwritten(machine.offsets)}
    return machine.model_copy(update=tables)


def _no_reference(line: int, modal: ModalSnapshot) -> int:
    return 0
