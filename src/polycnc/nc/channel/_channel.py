"""A channel: prepares a program ahead of its execution and fills the channel queue with it.

A `Reader` makes blocks of program texts, `Calls` know which program runs and which language executes it, `Prepared` is
the queue with the records of its blocks, and the `Preparation` executes one block after the other and goes on where it
says. Runs of plain blocks go through the compiled kernel (`fast`), every other block, and the first blocks of a
program, through the reference interpreter. Where a language executes a program, its `BlockSource` gives the blocks.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from polycnc.errors import ProgramError, UsageError
from polycnc.machine import Machine, MachineConfig
from polycnc.nc.blocks._interpreter import Interpreter
from polycnc.nc.blocks._messages import Messages
from polycnc.nc.blocks._queue import QueueWriter
from polycnc.nc.channel._calls import Calls
from polycnc.nc.channel._channel_snapshot import ChannelSnapshot
from polycnc.nc.channel._errors import Errors
from polycnc.nc.channel._line_check import LineCheck
from polycnc.nc.channel._options import ChannelOptions
from polycnc.nc.channel._preparation import Preparation, Turns
from polycnc.nc.channel._prepared import Prepared
from polycnc.nc.channel._reader import Reader
from polycnc.nc.channel._search import Search
from polycnc.nc.channel._sub_programs import Library, SubPrograms
from polycnc.nc.dialect._dialect import Dialect
from polycnc.nc.modal._modal_snapshot import ModalSnapshot
from polycnc.nc.modal._suppressed import Suppressed
from polycnc.nc.records._block_records import BlockRecords, Call
from polycnc.nc.sources._block_source import Language
from polycnc.nc.text._program import ProgramText, TextRules
from polycnc.nc.text._scan import ScanRules, scan_rules


class Channel:
    """Prepare one program for one path of a machine.

    `config` has the tools and work offsets, which may change while it runs (the machine's, where there is
    none), and `library` gives sub-programs before files are looked for. `language` executes the programs that
    are more than words. `records` tells what block a segment belongs to. `before` is the channel that used the
    path until now: with `keeps_modal` its modal state stays in force. `axes` are the names of the machine's
    axes in this channel, those of others by `of_another_channel`. Refused blocks are in `errors`. Without `attaches`
    the channel is made to go back to a snapshot: only then it takes path and language over.
    """

    _prepared: Prepared
    _rules: tuple[TextRules, ScanRules]

    def __init__(
        self,
        program: ProgramText,
        dialect: Dialect,
        machine: Machine,
        *,
        path: int = 0,
        config: MachineConfig | None = None,
        library: Library | None = None,
        language: Language | None = None,
        axes: Sequence[str] | None = None,
        skip_levels: frozenset[int] = frozenset(),
        options: ChannelOptions | None = None,
        before: Channel | None = None,
        keeps_modal: bool = True,
        attaches: bool = True,
    ) -> None:
        options = options or ChannelOptions()
        self.dialect, self.machine, self.path = dialect, machine, path
        self.on_filled: Callable[[], None] | None = None  # looks at the queue before it is executed
        self.suppressed = Suppressed()
        self._rules = text_rules, rules = before.rules_of(dialect) if before else _rules_of(dialect)
        prepared = self._prepared = Prepared(
            dialect,
            rules,
            machine,
            path,
            config=config or machine.config,
            axes=axes,
            options=options,
            before=None if before is None else before._prepared,
            keeps_modal=keeps_modal,
        )
        self.writer, self.records, self.state = prepared.writer, prepared.records, prepared.state
        self.messages = Messages(ahead=_put_count(prepared.writer))
        self._errors = errors = Errors(self.messages, collects=options.collect_errors)
        self.errors = errors.all
        self._reader = reader = Reader(program.opening, text_rules, rules, skip_levels)
        sub_programs = SubPrograms(program, dialect, library)
        self._calls = calls = Calls(program, dialect, sub_programs, language, reader, errors)
        self._search = search = Search(calls, reader, language)
        self._reference = _reference(self.records, reader, calls)
        self.interpreter = Interpreter(
            dialect, self.state, self.messages, self.writer, calls.problem, self._reference
        )
        self._preparation = Preparation(
            reader,
            calls,
            prepared,
            search,
            self.interpreter,
            errors,
            Turns(machine.clock),
            options=options,
            end_returns=dialect.sub_program.end_returns,
        )
        if attaches:
            prepared.take_tolerance()
            calls.attach(self)

    def rules_of(self, dialect: Dialect) -> tuple[TextRules, ScanRules]:
        """Return the rules by which texts of a dialect are read; those of the channel's own are made already."""
        return self._rules if dialect is self.dialect else _rules_of(dialect)

    # ------------------------------------------------------------------ how far it is

    @property
    def blocks(self) -> int:
        """How many blocks have been prepared."""
        return self._reader.blocks

    @property
    def skip_levels(self) -> frozenset[int]:
        """The numbers of the skip marks whose blocks are left out."""
        return self._reader.skip_levels

    @skip_levels.setter
    def skip_levels(self, levels: frozenset[int]) -> None:
        self._reader.skip_levels = levels

    @property
    def seeking(self) -> bool:
        """Whether a block is sought by carrying out what stands before it."""
        return self._search.active

    @property
    def holds_searched(self) -> bool:
        """Whether statements have led to a block that was sought, which comes next."""
        return self._search.held is not None

    @property
    def depth(self) -> int:
        """How deep the present program is nested; 0 is the main program."""
        return self._calls.depth

    @property
    def stack(self) -> tuple[Call, ...]:
        """The calls that led to what is prepared now, the outermost first."""
        return self._calls.stack

    @property
    def done(self) -> bool:
        """Whether the program has ended and all of it is in the queue."""
        return self._preparation.over and not self.writer.backlog

    @property
    def starved(self) -> bool:
        """Whether all that has come of a program that is still coming has been prepared, and is in the queue."""
        return self._preparation.starved and not self.writer.backlog

    def line_check(self) -> LineCheck:
        """Return a check of blocks that would come after what has been prepared."""
        return LineCheck(
            self.dialect, self.state, lambda program, text, offset: None, words_only=self._calls.has_language
        )

    @property
    def error(self) -> ProgramError | None:
        """The first error, if there is one."""
        return self.errors[0] if self.errors else None

    @property
    def progress(self) -> float:
        """How much of the program text has been prepared, 0 to 1; it goes back where sub-programs repeat."""
        here = self._reader.here
        size = len(here.text)
        return min(here.offset / size, 1.0) if size else 1.0

    @property
    def waits(self) -> bool:
        """Whether preparation waits until the path has come to a stop, and `go_on`."""
        return self.writer.stops > 0

    @property
    def text_is_over(self) -> bool:
        """Whether all blocks of the main program's text have been taken, and no language has more."""
        reader, calls = self._reader, self._calls
        read = reader.at_end and reader.place.offset >= reader.end
        return read and calls.depth == 0 and calls.running.source is None and not calls.is_coming

    @property
    def paused(self) -> bool:
        """Whether preparation has done what it may in one control cycle, and goes on in the next."""
        return self._preparation.turns.paused and not self._preparation.over

    def sub_program(self, number: int) -> ProgramText | None:
        """Return the text that a sub-program stands in, None if there is none."""
        return self._calls.text_of(number)

    # ------------------------------------------------------------------ preparing

    def go_on(self) -> None:
        """Go on after the first stop that preparation waits for; it has been executed."""
        self.writer.stops -= 1

    def fill(self, blocks: int | None = None, *, compiled: bool = True) -> None:
        """Prepare blocks until the queue is full, the program has ended or waits; `blocks` more at the most.

        Without `compiled` every block goes through the reference interpreter.
        """
        self._preparation.fill(blocks, compiled=compiled)
        if self.on_filled is not None:
            self.on_filled()

    def close(self) -> None:
        """Give up the program: what a language holds for it ends."""
        self._preparation.close()

    # ------------------------------------------------------------------ beginning elsewhere

    def go_to(self, line: int) -> None:
        """Begin at a line of the main program instead of its first, with the modal state as it is.

        Raises:
            UsageError: a language executes the program, and cannot begin there.
        """
        place = self._calls.target(line)
        self._preparation.begun = True
        self._calls.begin_at(place)

    def bound(self, first: int, last: int) -> None:
        """Let the main program, which has not begun, be searched for line `first` and end after line `last`.

        Raises:
            UsageError: a language executes it that cannot end there.
        """
        self._calls.bounds.set(first, last)

    def calculate_to(self, line: int, drop: Callable[[], None]) -> bool:
        """Carry out all blocks before a line of the main program; False if the program ends before.

        `drop` is called to throw away what has come into the queue. Afterwards the program goes on at the line.

        Statements of a language are executed too; what they wait for goes on at once.

        Raises:
            UsageError: statements wait or loop without end before the line, or radius compensation is active there.
        """
        search = self._search
        place = self._calls.target(line)
        self._preparation.begun = True
        with search.of(place):
            self._calls.begin()
            search.begin()
            while not self._preparation.over and not search.found:
                self._preparation.turns.forget()  # no time passes here
                self.fill()
                drop()
                self.writer.clear()
                search.check()
        if self._preparation.over:
            return False
        if self.state.compensation.active:
            raise UsageError(
                f"radius compensation is active at line {line}",
                hint="Search a block before G41 or G42, or after G40.",
            )
        if search.held is None:
            self._reader.jump(place, self._calls.bounds.end)
        return True

    def begin_at(self, position: tuple[float, ...], line: int) -> None:
        """Go straight at rapid to a position (machine coordinates), as part of the block on `line`."""
        self._prepared.go_straight(position, line, self._reference(line, self.state.snapshot()))

    # ------------------------------------------------------------------ going back

    def snapshot(self) -> ChannelSnapshot:
        """Return where preparation stands and all that it has found, to go back to with `restore_point`.

        The queue itself belongs to the machine.

        Raises:
            SnapshotError: a language executes a program, and cannot tell where it is.
        """
        self._search.refuse_held()
        return ChannelSnapshot(
            self.state.save(),
            self.state.tables.save(),
            self._calls.snapshot(),
            self._reader.here,
            self._reader.end,
            self._calls.within,
            self.blocks,
            tuple(self.errors),
            self.messages.snapshot(),
            (self._preparation.over, self._preparation.begun),
            self._preparation.turns.snapshot(),
            self.suppressed,
            self.writer.snapshot(),
            self.records.snapshot(),
            self.interpreter.snapshot(),
            self._calls.language_state(),
        )

    def restore_point(self, saved: ChannelSnapshot) -> Callable[[], None]:
        """Return what goes back to a snapshot of this channel, or of one that was made alike; nothing changes yet.

        Raises:
            SnapshotError: a program of it cannot go on from there.
        """
        take_up = self._calls.restore_point(self, saved.language)
        return lambda: self._go_back(saved, take_up)

    def _go_back(self, saved: ChannelSnapshot, take_up: Callable[[], None]) -> None:
        self._calls.attach(self)
        self.state.restore(saved.state)
        self.state.tables.restore(saved.tables)
        self._calls.restore(
            saved.calls, saved.calls_within, (key[0] for key in saved.records.contexts.values())
        )
        self._reader.blocks = saved.blocks
        self._errors.restore(saved.errors)
        self.messages.restore(saved.messages)
        preparation = self._preparation
        preparation.ended, preparation.begun = saved.flags
        preparation.turns.restore(saved.turns)
        self.suppressed = saved.suppressed
        self.writer.restore(saved.writer)
        self.records.restore(saved.records)
        self.interpreter.restore(saved.interpreter)
        take_up()  # before anything is read: words may have variables for their numbers
        self._reader.jump(saved.place, saved.text_end)


# Nothing of a channel holds the whole of it: one that a program leaves behind goes at once, with its large arrays.


def _rules_of(dialect: Dialect) -> tuple[TextRules, ScanRules]:
    text_rules = dialect.text
    return text_rules, scan_rules(text_rules)


def _put_count(writer: QueueWriter) -> Callable[[], int]:
    """Return what tells how many segments have been put."""
    return lambda: writer.put_count


def _reference(records: BlockRecords, reader: Reader, calls: Calls) -> Callable[[int, ModalSnapshot], int]:
    """Return what gives the reference of the block on a line of the present program, which leaves this in force."""
    return lambda line, modal: records.reference(reader.place.text, calls.stack, modal, line)
