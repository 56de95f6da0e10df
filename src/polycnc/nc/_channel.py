"""A channel: prepares a program ahead of its execution and fills the channel queue with it.

Runs of plain blocks go through the compiled kernel (`fast`), every other block, and the first blocks of a
program, through the ordinary interpreter. Where a language executes a program, its `BlockSource` gives the blocks.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import replace

from polycnc.errors import ProgramError, UsageError
from polycnc.kernel import free_slots
from polycnc.machine import Machine, MachineConfig, SnapshotError
from polycnc.nc._block_reading import CHUNK_BLOCKS, BlockReading
from polycnc.nc._block_records import BlockRecords, Call
from polycnc.nc._block_source import (
    BoundLanguage,
    CallProgram,
    Drain,
    EndSource,
    HastyLanguage,
    Language,
    LastingLanguage,
    Pause,
    Returning,
    SearchingLanguage,
    SourceItem,
    Statement,
    TextSpan,
    WordsBlock,
)
from polycnc.nc._channel_snapshot import ChannelSnapshot, Suppressed
from polycnc.nc._dialect import Dialect
from polycnc.nc._first_state import first_state
from polycnc.nc._turns import BARREN_TURNS, PLAIN_PER_TURN, Turns
from polycnc.nc.blocks._calls import Back, Calls, Library, Place
from polycnc.nc.blocks._channel_state import ChannelState
from polycnc.nc.blocks._interpreter import Interpreter
from polycnc.nc.blocks._messages import Messages
from polycnc.nc.blocks._modal import (
    ORDINARY,
)
from polycnc.nc.blocks._moves import Feed, Line
from polycnc.nc.blocks._outcomes import Control, Trouble
from polycnc.nc.blocks._queue import QueueWriter
from polycnc.nc.fast._plain_blocks import NOT_PLAIN, QUEUE_FULL, RESERVE, make_fast_work, marked, run_plain
from polycnc.nc.text._program import ProgramText
from polycnc.nc.text._scan import (
    MESSAGE,
    PERCENT,
    PLAIN,
    scan_rules,
)
from polycnc.nc.text._scan_plain import Block

ORDINARY_BLOCKS = 2000
_MOST_ERRORS = 1000
_MOST_IDLE_TURNS = 100  # of a calculated search without a block: nothing ends its wait or loop


class Channel:
    """Prepare one program for one path of a machine.

    `config` has the tools and work offsets, which may change while it runs (the machine's, where there is
    none), and `library` gives sub-programs before files are looked for. `language` executes the programs that
    are more than words. With `stands_at_stops` preparation waits at M0 and M1 for `go_on`; else they are
    events like any other. With `answers` the path waits at auxiliary functions for whoever runs it, not for
    the machine file's times; with `marks` blocks that leave nothing in the queue are noted (see
    `QueueWriter`). `records` tells what block a segment belongs to. `before` is the channel that used the
    path until now: with `keeps_modal` its modal state stays in force. `axes` are the names of the machine's
    axes in this channel, those of others by `of_another_channel`. With `collect_errors` a refused block
    is noted in `errors` and left out; else preparation ends there with `error`. The ordinary interpreter
    gives the same queue as the compiled kernel, which takes over after the first `ordinary_blocks`: loading
    it, and once compiling it, takes longer than they do. Without `attaches` the channel is made to go back to a
    snapshot: only then it
    takes path and language over.
    """

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
        stands_at_stops: bool = False,
        answers: bool = False,
        marks: bool = False,
        before: Channel | None = None,
        keeps_modal: bool = True,
        collect_errors: bool = False,
        ordinary_blocks: float = ORDINARY_BLOCKS,
        attaches: bool = True,
    ) -> None:
        self.dialect = dialect
        self.machine = machine
        self.path = path
        self.blocks = 0
        self._axes = axes
        self._ended = False
        self.errors: list[ProgramError] = []
        self.on_filled: Callable[[], None] | None = (
            None  # for whoever looks at the queue before it is executed
        )
        self.messages = Messages()
        self.suppressed = Suppressed()
        self._collect_errors = collect_errors
        self._known_errors: set[str] = set()
        self._refused_calls: dict[tuple[str, int], Trouble] = {}
        self.skip_levels = skip_levels
        self._language = language
        self._ordinary_blocks = ordinary_blocks
        self._calls = Calls(program, dialect, library)
        self._calls_within: tuple[
            Call, ...
        ] = ()  # those that the source of the present program made by itself
        text_rules = dialect.text_rules()
        rules = scan_rules(text_rules)
        self._reading = BlockReading(program, text_rules, rules)
        self._tables = dialect.tables()
        kernel = machine.state
        if before is None:
            self.writer = QueueWriter(kernel.seg, kernel.paths, kernel.limits, path)
            self.state = self._first_state(config or machine.config)
            self.records = BlockRecords(dialect, rules, self._tables, CHUNK_BLOCKS)
        else:
            self.writer, self.state, self.records = before.writer, before.state, before.records
            if not keeps_modal:
                self.state = self._first_state(config or machine.config)
                self.state.tool = before.state.tool
        self._fast_work = make_fast_work(
            self.state.modal,
            CHUNK_BLOCKS if marks else 0,
            feed_needs_point=dialect.numbers.feed_least_input > 0.0,
        )
        self.interpreter = Interpreter(
            dialect, self.state, self.messages, self.writer, self._trouble_of_call, self._reference
        )
        self.writer.stands_at_stops = stands_at_stops
        self.writer.answers = answers
        self.writer.marks = deque() if marks else None
        if attaches:
            self.writer.set_tolerance(self.state.path_tolerance_mm, self.state.merge_mm)
        if attaches and isinstance(language, BoundLanguage):
            language.attach(self)
        self._begun = False
        self._turns = Turns(machine.clock)
        self._sought: Place | None = None
        self._held: SourceItem | None = (
            None  # what the source of the main program has given of the block sought
        )

    def sub_program(self, number: int) -> ProgramText | None:
        """Return the text that a sub-program stands in, None if there is none."""
        return self._calls.text_of(number)

    @property
    def seeking(self) -> bool:
        """Whether a block is sought by carrying out what stands before it."""
        return self._sought is not None

    @property
    def holds_searched(self) -> bool:
        """Whether statements have led to a block that was sought, which comes next."""
        return self._held is not None

    @property
    def depth(self) -> int:
        """How deep the present program is nested; 0 is the main program."""
        return self._calls.depth

    @property
    def done(self) -> bool:
        """Whether the program has ended and all of it is in the queue."""
        return self._ended and not self.writer.backlog

    @property
    def error(self) -> ProgramError | None:
        """The first error, if there is one."""
        return self.errors[0] if self.errors else None

    @property
    def progress(self) -> float:
        """How much of the program text has been prepared, 0 to 1; it goes back where sub-programs repeat."""
        here = self._reading.here
        size = len(here.text)
        return min(here.offset / size, 1.0) if size else 1.0

    @property
    def waits(self) -> bool:
        """Whether preparation waits until the path has come to a stop, and `go_on`."""
        return self.writer.stops > 0

    @property
    def paused(self) -> bool:
        """Whether preparation has done what it may in one control cycle, and goes on in the next."""
        return self._turns.paused and not self._ended

    @property
    def _tail(self) -> int:
        return int(self.writer.paths.row[self.path]["tail"])

    def go_on(self) -> None:
        """Go on behind the first stop that preparation waits for; it has been executed."""
        self.writer.stops -= 1

    def fill(self, blocks: int | None = None, *, compiled: bool = True) -> None:
        """Prepare blocks until the queue is full, the program has ended or waits; `blocks` more at the most.

        Without `compiled` every block goes through the ordinary interpreter.
        """
        self._fill(blocks, compiled=compiled)
        if self.on_filled is not None:
            self.on_filled()

    def _fill(self, blocks: int | None, *, compiled: bool) -> None:
        if self._turns.used_up:
            return
        self._turns.begin()
        if not self._begun:
            self._begun = True
            self._begin()
        if not self.writer.catch_up():
            return
        most = None if blocks is None else self.blocks + blocks
        whole = self.state.modal.whole
        writer = self.writer
        while not self._ended and not writer.stops and free_slots(writer.paths, self.path) > RESERVE:
            if writer.backlog or self._turns.paused:
                return
            if most is not None and self.blocks >= most:
                return
            if self._reading.is_through:
                if not self._next_chunk():
                    return
            elif compiled and self.blocks >= self._ordinary_blocks and not whole[ORDINARY]:
                reason = self._plain_blocks(most)
                if reason == QUEUE_FULL:
                    return
                if reason == NOT_PLAIN:
                    self._ordinary_block()
            else:
                self._ordinary_block()

    def go_to(self, line: int) -> None:
        """Begin at a line of the main program instead of its first, with the modal state as it is.

        Raises:
            UsageError: a language executes the program, and cannot begin there.
        """
        place = self._target(line)
        self._begun = True
        running = self._calls.running
        running.begun = True
        if isinstance(self._language, SearchingLanguage):
            begin = running.begin
            try:
                running.source = self._language.source_at(begin.text, begin.offset, begin.line, place.offset)
            except ProgramError as error:
                raise UsageError(error.what, hint=error.hint) from error
            if running.source is not None:
                self._reading.jump(begin, begin.offset)  # no text for now
                return
        self._reading.jump(place, len(place.text))

    def calculate_to(self, line: int, drop: Callable[[], None]) -> bool:
        """Carry out all blocks before a line of the main program; False if the program ends before.

        `drop` is called to throw away what has come into the queue. Afterwards the program goes on at the line.

        Statements of a language are executed too; what they wait for goes on at once.

        Raises:
            UsageError: statements wait or loop without end before the line, or radius compensation is active there.
        """
        place = self._target(line)
        self._begun = True
        self._sought = place
        try:
            self._seek(place, drop)
        finally:
            self._sought = None
            self._be_hasty(False)
        if self._ended:
            return False
        if self.state.compensation.active:
            raise UsageError(
                f"radius compensation is active at line {line}",
                hint="Search a block before G41 or G42, or behind G40.",
            )
        if self._held is None:
            self._reading.jump(place, len(place.text))
        return True

    def _seek(self, place: Place, drop: Callable[[], None]) -> None:
        self._be_hasty(True)
        self._begin()
        language = self._language if isinstance(self._language, HastyLanguage) else None
        if self._calls.running.source is None:
            self._reading.end = place.offset
        idle, before = 0, (-1, -1)
        while not self._ended and not self._is_at(place):
            self._turns.forget()  # no time passes here
            self.fill()
            drop()
            self.writer.clear()
            now = self.blocks, self._calls.depth
            idle, before = idle + 1 if now == before else 0, now
            if language is not None and not idle:
                language.moves_on()
            if idle > _MOST_IDLE_TURNS or (idle and language is not None and language.loops()):
                raise UsageError(
                    f"the program waits or loops without a block before line {place.line}",
                    hint="Let it look at the search (SD(13) of a Typ3 osa or PNC), or search another block.",
                )

    def _be_hasty(self, on: bool) -> None:
        if isinstance(self._language, HastyLanguage):
            self._language.hasty = on

    def begin_at(self, position: tuple[float, ...], line: int) -> None:
        """Go straight at rapid to a position (machine coordinates), as part of the block on `line`."""
        modal = self.state.modal
        start = tuple(modal.position.tolist())
        tag = self._reference(line)
        self.writer.put(Line(start, position, Feed(), rapid=True, exact_stop=True, line=line, tag=tag))
        modal.position[:] = position

    def _target(self, line: int) -> Place:
        if self._language is not None and self._calls.running.source is not None:
            raise UsageError("a block of a program with statements cannot be searched", hint="Start it anew.")
        text = self._calls.running.begin.text
        return Place(text, text.line_start(line), line)

    def _is_at(self, place: Place) -> bool:
        if self._calls.depth or not self._reading.is_through or self.writer.backlog:
            return False
        if self._calls.running.source is not None:
            return self._held is not None
        return self._reading.place.offset >= place.offset

    def snapshot(self) -> ChannelSnapshot:
        """Return where preparation stands and all that it has found, to go back to with `restore`.

        The queue itself belongs to the machine.

        Raises:
            SnapshotError: a language executes a program, and cannot tell where it stands.
        """
        return ChannelSnapshot(
            self.state.save(),
            self.state.tables.save(),
            self._calls.snapshot(),
            self._reading.here,
            self._reading.end,
            self._calls_within,
            self.blocks,
            tuple(self.errors),
            self.messages.snapshot(),
            (self._ended, self._begun),
            self._turns.snapshot(),
            self.suppressed,
            self.writer.snapshot(),
            self.records.snapshot(),
            self.interpreter.snapshot(),
            self._language_state(),
        )

    def _language_state(self) -> object:
        if self._held is not None:
            raise SnapshotError(
                "a block of a program with statements has been searched",
                hint="Take the snapshot behind its start.",
            )
        under_way = [(each.arguments, each.source) for each in self._calls.under_way]
        if isinstance(self._language, LastingLanguage):
            return self._language.save(under_way)
        if any(source is not None for _, source in under_way):
            raise SnapshotError(
                "a program with statements is under way, whose language cannot tell where it stands",
                hint="Take the snapshot before or after it.",
            )
        return None

    def way_back(self, saved: ChannelSnapshot) -> Callable[[], None]:
        """Return what goes back to a snapshot of this channel, or of one that was made alike; nothing changes yet.

        Raises:
            SnapshotError: a program of it cannot go on from there.
        """
        language = self._language
        returning: Returning | None = None
        if isinstance(language, LastingLanguage):
            returning = language.way_back(self, saved.language)
        elif saved.language is not None:
            raise SnapshotError(
                "the program under way needs its language", hint="Restore it where it was taken."
            )
        return lambda: self._go_back(saved, returning)

    def _go_back(self, saved: ChannelSnapshot, returning: Returning | None) -> None:
        if isinstance(self._language, BoundLanguage):
            self._language.attach(self)
        self.state.restore(saved.state)
        self.state.tables.restore(saved.tables)
        self._calls.restore(saved.calls, (key[0] for key in saved.records.contexts.values()))
        self._calls_within = saved.calls_within
        self.blocks = saved.blocks
        self.errors[:] = saved.errors
        self._known_errors = {str(error) for error in saved.errors}
        self.messages.restore(saved.messages)
        self._ended, self._begun = saved.flags
        self._turns.restore(saved.turns)
        self.suppressed = saved.suppressed
        self.writer.restore(saved.writer)
        self.records.restore(saved.records)
        self.interpreter.restore(saved.interpreter)
        self._reading.jump(saved.place, saved.text_end)
        if returning is not None:
            for running, (arguments, source) in zip(self._calls.under_way, returning(), strict=True):
                running.arguments, running.source = arguments, source

    def close(self) -> None:
        """Give up the program: what a language holds for it ends."""
        self._ended = True
        self._held = None
        self._calls.close()

    def _first_state(self, config: MachineConfig) -> ChannelState:
        return first_state(config, self.dialect, tuple(self._axes or config.axis_names))

    # ------------------------------------------------------------------ reading

    def _next_chunk(self) -> bool:
        """Get more blocks, where the text ends from the language; False if there are none for now."""
        if self._reading.more():
            return True
        if self._calls.running.source is not None:
            return self._from_source()
        if self._sought is not None and self._calls.depth == 0:
            return False
        self._leave()
        return True

    def _begin(self) -> None:
        """Begin the present program, or its next round."""
        self._calls_within = ()
        running = self._calls.running
        begin = running.begin
        if self._language is not None:
            try:
                running.source = self._language.source(
                    begin.text, begin.offset, begin.line, running.arguments
                )
            except ProgramError as error:
                self._note(error)
        if running.source is not None:
            self._reading.jump(begin, begin.offset)  # no text for now
        elif self._calls.depth or self._language is not None:
            self._reading.jump(begin, len(begin.text))

    # ------------------------------------------------------------------ from a language

    def _from_source(self) -> bool:
        """Do what the source of the present program gives; False if that is nothing for now."""
        running = self._calls.running
        assert running.source is not None
        try:
            item, self._held = (running.source.next() if self._held is None else self._held), None
            running.begun = True
            if self._sought is not None and self._calls.depth == 0:
                item = self._before_sought(item, self._sought)
            if item is Pause.PAUSE:
                self._turns.pause()
                return False
            before = self._tail
            self._source_item(item)
            self._turns.take(1 if isinstance(item, TextSpan) or self._tail != before else BARREN_TURNS)
            if isinstance(item, Drain) and self._sought is None:
                self._turns.look(self._reading.text.name, item.line)
        except ProgramError as error:
            self._note(error)
        return True

    def _before_sought(self, item: SourceItem | None, place: Place) -> SourceItem | None:
        """Return what of an item stands before the block sought, and hold the rest; a pause if nothing does."""
        if not isinstance(item, WordsBlock | TextSpan | Drain | Statement | CallProgram) or (
            not isinstance(item, CallProgram) and (item.calls or (item.text or place.text) is not place.text)
        ):
            return item
        if isinstance(item, TextSpan) and item.offset < place.offset < item.end:
            self._held = replace(item, offset=place.offset, line=place.line)
            return replace(item, end=place.offset)
        if item.line == place.line:
            self._held = item
            return Pause.PAUSE
        return item

    def _source_item(self, item: SourceItem | None) -> None:
        text = self._calls.running.begin.text
        if isinstance(item, WordsBlock | TextSpan | Drain | Statement):
            text = item.text or text
            self._calls_within = item.calls
            self._reading.stand_at(text, item.line)
        match item:
            case WordsBlock():
                self._words_block(text, item)
            case TextSpan():
                self._reading.jump(Place(text, item.offset, item.line), item.end)
            case Drain():
                self.interpreter.drain(text, item.line)
            case Statement():
                self.interpreter.mark(item.line)
            case CallProgram():
                self._call(text, item)
            case EndSource.END:
                self._end()
            case _:
                self._leave()

    def _words_block(self, text: ProgramText, item: WordsBlock) -> None:
        self.blocks += 1
        if item.skip_level in self.skip_levels:
            return
        flags = MESSAGE if item.message else PLAIN
        end = text.next_line(item.offset)
        block = Block(item.words, flags, item.skip_level, item.offset, end, item.line, message=item.message)
        self._execute(text, block)

    def _trouble_of_call(self, program: int | ProgramText, text: ProgramText, offset: int) -> Trouble | None:
        """Return what is against a call, None if nothing is.

        Where errors are collected, a call that has been refused once is so ever after: a program that calls itself k
        times would else be gone through k to the power of the depth times.
        """
        site = (text.name, offset)
        trouble = self._refused_calls.get(site) or self._calls.trouble(program)
        if trouble is not None and self._collect_errors:
            self._refused_calls[site] = trouble
        return trouble

    def _call(self, text: ProgramText, call: CallProgram) -> None:
        trouble = self._trouble_of_call(call.program, text, call.offset)
        if trouble is not None:
            what, hint, code = trouble
            raise ProgramError(what, position=text.position(call.offset), hint=hint, code=code)
        back = Back(self._reading.here, self._reading.end, call.line, self._calls_within)
        if self._calls.enter(call.program, call.repeats, back, call.arguments):
            self._begin()

    def _reference(self, line: int) -> int:
        """Return the reference of the block on `line` of the present program, as it leaves the modal state."""
        return self.records.reference(self._reading.text, self.stack, self.state.snapshot(), line)

    @property
    def stack(self) -> tuple[Call, ...]:
        """The calls that led to what is prepared now, the outermost first."""
        return self._calls.stack + self._calls_within if self._calls_within else self._calls.stack

    # ------------------------------------------------------------------ blocks

    def _plain_blocks(self, most: int | None) -> int:
        """Let the compiled kernel take what it can; return why it stopped."""
        reading = self._reading
        first, words = reading.next, reading.words
        kernel = self.machine.state
        self.state.coordinates.take_changes()
        begin = int(words.offset[first]), int(words.line[first])
        base = self.records.run_base(reading.text, self.stack, self.state.snapshot(), begin)
        after, before = words.n_blocks, self._tail
        if most is not None:
            after = min(after, first + most - self.blocks)
        reading.next, reason = run_plain(
            words,
            first,
            after,
            base,
            self._tables,
            self.state.modal,
            kernel.seg,
            kernel.paths,
            self.path,
            kernel.limits,
            self._fast_work,
        )
        if self.writer.marks is not None:
            self.writer.marks.extend(marked(self._fast_work))
        if reading.next > first:
            self.blocks += reading.next - first
            least = 1 if self._tail != before else BARREN_TURNS
            self._turns.take(max(least, (reading.next - first) // PLAIN_PER_TURN))
            if words.first_word[reading.next] > words.first_word[first]:
                self._calls.running.begun = True
        return reason

    def _ordinary_block(self) -> None:
        reading = self._reading
        index, words = reading.next, reading.words
        reading.next += 1
        before = self._tail
        try:
            self._carry_out_block(index)
        finally:
            self._turns.take(1 if self._tail != before else BARREN_TURNS)

    def _carry_out_block(self, index: int) -> None:
        reading, words = self._reading, self._reading.words
        running = self._calls.running
        if words.flags[index] & PERCENT:
            if running.begun:  # the % behind a program ends it, the one before it does not matter
                self._leave()
            return
        if int(words.skip_level[index]) in self.skip_levels:
            self.blocks += 1
            return
        try:
            block = reading.block(index)
            if running.begun and _is_program_number(block):
                self._leave()  # another program begins here
                return
            running.begun = running.begun or bool(block.words)
            self.blocks += 1
            self._execute(self._reading.text, block)
        except ProgramError as error:
            self._note(error)
            if error.position is not None and error.position.line != words.line[index]:
                self.interpreter.leave_compensation()  # the move before is wrong: not every one after it

    def _note(self, error: ProgramError) -> None:
        """Note an error once, however often its block is repeated."""
        text = str(error)
        if text not in self._known_errors:
            self._known_errors.add(text)
            self.errors.append(error)
        if len(self.errors) >= _MOST_ERRORS:
            self.messages.begin(0)
            self.messages.add(f"the program was checked up to its error number {_MOST_ERRORS}")
            self._ended = True
        if not self._collect_errors:
            self._ended = True
            if (source := self._calls.running.source) is not None:
                source.failed()

    # ------------------------------------------------------------------ where it goes on

    def _execute(self, text: ProgramText, block: Block) -> None:
        """Execute a block and go on where it says."""
        outcome = self.interpreter.execute(text, block)
        match outcome.control:
            case Control.END:
                if self.dialect.sub_program.end_returns and self._calls.depth:
                    self._leave()
                else:
                    self._end()
            case Control.CALL:
                back = Back(self._reading.here, self._reading.end, block.line, self._calls_within)
                if self._calls.enter(outcome.program, outcome.repeats, back):
                    self._begin()
            case Control.GO_ON:
                self._go_behind(outcome.place, block)
            case Control.RETURN:
                source = self._calls.running.source
                if source is not None and source.leave():
                    self._reading.stop()
                    return
                if self._calls.depth == 0:
                    self.messages.add("a return from the main program ends it")
                self._leave()
            case _:
                pass

    def _go_behind(self, place: Place | None, block: Block) -> None:
        """Go on behind the contour that a cycle has cut.

        Raises:
            ProgramError: statements stand before that place.
        """
        assert place is not None
        if place.offset > self._reading.end:
            raise ProgramError(
                "a contour that is cut apart by statements is not supported yet",
                position=place.text.position(block.offset),
                hint="Write the contour in plain words.",
            )
        self._reading.jump(place, self._reading.end)

    def _leave(self) -> None:
        """End the present program: go back to the one that called it, or end everything."""
        if self._calls.depth == 0:
            self._end()
            return
        back = self._calls.leave()
        if back is None:
            self._begin()
        else:
            self._calls_within = back.within
            self._reading.jump(back.place, back.end)

    def _end(self) -> None:
        self.close()
        try:
            self.interpreter.finish()
        except ProgramError as error:
            self._note(error)


def _is_program_number(block: Block) -> bool:
    return bool(block.words) and block.words[0].letter == "O"
