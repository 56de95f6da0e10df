"""The preparation of a program: one block after the other, from its text or its language, until there is no room.

How much is prepared before time has to pass is counted for each cycle of the clock, never for each call, so it does not
matter how time is cut into calls.
"""

from __future__ import annotations

from typing import NamedTuple

from polycnc.errors import ProgramError
from polycnc.machine import Clock
from polycnc.nc.blocks._interpreter import Interpreter
from polycnc.nc.blocks._moves import Stop, Wait
from polycnc.nc.blocks._outcomes import Continuation
from polycnc.nc.channel._calls import Calls
from polycnc.nc.channel._errors import Errors
from polycnc.nc.channel._options import ChannelOptions
from polycnc.nc.channel._prepared import Prepared
from polycnc.nc.channel._reader import Reader
from polycnc.nc.channel._search import Search
from polycnc.nc.fast._plain_blocks import NOT_PLAIN, QUEUE_FULL, RESERVE
from polycnc.nc.sources._block_source import (
    CallProgram,
    Drain,
    EndSource,
    Pause,
    SourceItem,
    Statement,
    TextSpan,
    WordsBlock,
)
from polycnc.nc.text._place import Place
from polycnc.nc.text._program import ProgramText
from polycnc.nc.text._scan import MESSAGE, PLAIN
from polycnc.nc.text._scan_plain import Block

TURNS_PER_CYCLE = 2000
"""Blocks with something for the queue that are prepared in one control cycle at the most."""
BARREN_TURNS = 50
"""What a block counts that takes no time, or a call: of such ones there are 40 in a cycle."""
PLAIN_PER_TURN = 64
"""Plain blocks that the compiled kernel prepares in the time of one turn."""


class SavedTurns(NamedTuple):
    """What was prepared in which cycle, to go back to; see `Turns`."""

    cycle: int
    taken: int
    paused: bool
    looks: tuple[tuple[str, int], ...]


class Turns:
    """Count what is prepared in the present cycle of `clock`.

    `paused` is set while preparation has done all that it may in a cycle and wants to go on in the next one.
    """

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._cycle = -1
        self._taken = 0
        self._looks: set[tuple[str, int]] = set()
        self.paused = False

    def begin(self) -> bool:
        """Take note that preparation goes on; False where nothing more is prepared in this cycle."""
        cycle = self._clock.cycles
        if self._cycle == cycle:
            return not self.paused
        self._cycle, self._taken = cycle, 0
        if not self.paused:
            self._looks.clear()
        self.paused = False
        return True

    def take(self, turns: int = 1) -> None:
        """Count turns; after the last one of a cycle preparation pauses."""
        self._taken += turns
        if self._taken >= TURNS_PER_CYCLE:
            self.pause()

    def pause(self) -> None:
        """Let preparation go on in the next cycle."""
        self._looks.clear()
        self.paused = True

    def look(self, program: str, line: int) -> None:
        """Count a block that reads what only cycles change; where it has done so in this one, preparation pauses."""
        place = program, line
        if place in self._looks:
            self.pause()
        self._looks.add(place)  # what pauses now is read with the next cycle, and is its look

    def forget(self) -> None:
        """Begin anew, as if a cycle had passed."""
        self.restore(SavedTurns(-1, 0, False, ()))

    def snapshot(self) -> SavedTurns:
        """Return what has been counted, to go back to."""
        return SavedTurns(self._cycle, self._taken, self.paused, tuple(sorted(self._looks)))

    def restore(self, saved: SavedTurns) -> None:
        """Go back to a snapshot."""
        self._cycle, self._taken, self.paused = saved.cycle, saved.taken, saved.paused
        self._looks = set(saved.looks)


NAMED_END = "a line that begins with % ends the program: what follows it is not read"
"""The message on a program whose % has words after it, as if it began a remark."""


class Preparation:
    """Execute the blocks that `reader` and the languages of `calls` give, and go on where they say.

    `begun` and `ended` tell how far the program is, `turns` how much of it may be prepared in this cycle. The compiled
    kernel takes over after the first `ordinary_blocks`. With `end_returns` the end of a program returns from a
    sub-program.
    """

    def __init__(
        self,
        reader: Reader,
        calls: Calls,
        prepared: Prepared,
        search: Search,
        interpreter: Interpreter,
        errors: Errors,
        turns: Turns,
        *,
        options: ChannelOptions,
        end_returns: bool,
    ) -> None:
        self._reader = reader
        self._calls = calls
        self._prepared = prepared
        self._search = search
        self._interpreter = interpreter
        self._errors = errors
        self._options = options
        self._end_returns = end_returns
        self.begun = False
        self.ended = False
        self.turns = turns

    def fill(self, blocks: int | None, *, compiled: bool) -> None:
        """Prepare blocks until there is no room, the program has ended or waits; `blocks` more at the most."""
        reader, prepared, turns = self._reader, self._prepared, self.turns
        writer = prepared.writer
        if not turns.begin():
            return
        if not self.begun:
            self.begun = True
            if (error := self._reader.text.endless_line()) is not None:
                self._note(error)
                self.close()
                return
            self._calls.begin()
        if writer.backlog and not self._catch_up():
            return
        most = None if blocks is None else reader.blocks + blocks
        while not self.over and (most is None or reader.blocks < most) and writer.has_room(RESERVE):
            if turns.paused:
                return
            if reader.at_end:
                if not self._next_piece():
                    return
                continue
            reason, first, tail = NOT_PLAIN, reader.blocks, int(prepared.row["tail"])
            if compiled and reader.blocks >= self._options.ordinary_blocks and prepared.is_plain:
                reason = reader.take_plain(self._calls.running, self._calls.stack, most, prepared)
            if reason == QUEUE_FULL:
                return
            if reason == NOT_PLAIN:
                self._ordinary_block()
            least = 1 if writer.takes_time(tail) else BARREN_TURNS
            turns.take(max(least, (reader.blocks - first) // PLAIN_PER_TURN))

    def _next_piece(self) -> bool:
        """Get more blocks, where the text ends from the language; False if there are none for now."""
        if self._reader.more():
            return True
        if self._calls.running.source is not None:
            return self._from_source()
        if self._search.in_main_program:
            return False
        if self._calls.is_coming:
            return self._calls.take_piece()
        self._leave()
        return True

    def _ordinary_block(self) -> None:
        reader = self._reader
        try:
            block = reader.take(self._calls.running)
            if block is EndSource.RETURN:
                if self._calls.depth == 0 and reader.at_named_end:
                    self._interpreter.messages.note(NAMED_END, reader.line)
                self._leave()
            elif isinstance(block, Block):
                self._execute(reader.text, block)
        except ProgramError as error:
            self._note(error)
            if error.position is not None and error.position.line != reader.line:
                self._interpreter.leave_compensation()  # the move before is wrong: not every one after it
            self._go_past()

    def _from_source(self) -> bool:
        """Do what the source of the present program gives; False if that is nothing for now."""
        try:
            item = self._search.next_item()
            if item is Pause.PAUSE:
                self.turns.pause()
                return False
            tail = int(self._prepared.row["tail"])
            self._source_item(item)
            barren = not isinstance(item, TextSpan) and not self._prepared.writer.takes_time(tail)
            self.turns.take(BARREN_TURNS if barren else 1)
            if isinstance(item, Drain) and not self._search.active:
                self.turns.look(self._reader.text.name, item.line)
        except ProgramError as error:
            self._note(error)
            self._go_past()
        return True

    def _source_item(self, item: SourceItem | None) -> None:
        text = self._calls.running.begin.text
        if isinstance(item, WordsBlock | TextSpan | Drain | Statement):
            text = item.text or text
            self._calls.go_within(item.calls)
            self._reader.stand_at(text, item.line)
        match item:
            case WordsBlock():
                self._words_block(text, item)
            case TextSpan():
                self._reader.jump(Place(text, item.offset, item.line), item.end)
            case Drain():
                self._interpreter.drain(text, item.line)
            case Statement():
                self._interpreter.mark(item.line)
            case CallProgram():
                self._calls.call(text, item)
            case EndSource.END:
                self._end()
            case None if self._calls.is_coming:
                self._calls.end_piece()
            case _:
                self._leave()

    def _words_block(self, text: ProgramText, item: WordsBlock) -> None:
        self._reader.blocks += 1
        if item.skip_level in self._reader.skip_levels:
            return
        flags = MESSAGE if item.message else PLAIN
        block = Block(
            item.words, flags, item.skip_level, item.offset, item.line,
            message=item.message, profile=item.profile,
        )  # fmt: skip
        self._execute(text, block)

    # ------------------------------------------------------------------ where it goes on

    def _execute(self, text: ProgramText, block: Block) -> None:
        """Execute a block and go on where it says."""
        outcome = self._interpreter.execute(text, block)
        match outcome.continuation:
            case Continuation.END:
                if not self._end_returns or not self._calls.leave():
                    self._end()
            case Continuation.CALL:
                self._calls.enter(outcome.program, outcome.repeats, block.line)
            case Continuation.GO_ON:
                self._go_behind(outcome.place, block)
            case Continuation.RETURN:
                self._return()
            case _:
                pass

    def _go_behind(self, place: Place | None, block: Block) -> None:
        """Go on after the contour that a cycle has cut.

        Raises:
            ProgramError: statements stand before that place.
        """
        assert place is not None
        if place.offset > self._reader.end:
            raise ProgramError(
                "a contour that is cut apart by statements is not supported yet",
                position=place.text.position(block.offset),
                hint="Write the contour in plain words.",
            )
        self._reader.jump(place, self._reader.end)

    def _go_past(self) -> None:
        """Go on after a block that was refused, where errors are collected."""
        place = self._interpreter.past_refused() if self._options.past_refused else None
        if place is not None and place.offset <= self._reader.end:
            self._reader.jump(place, self._reader.end)

    def _return(self) -> None:
        """Return to the block after the call."""
        source = self._calls.running.source
        if source is not None and source.leave():
            self._reader.stop()
            return
        if self._calls.depth == 0:
            self._interpreter.messages.add("a return from the main program ends it")
        self._leave()

    def _leave(self) -> None:
        """End the present program: go back to the one that called it, or end everything."""
        if not self._calls.leave():
            self._end()

    def _end(self) -> None:
        self.close()
        try:
            self._interpreter.finish()
        except ProgramError as error:
            self._note(error)
        self._drop_in_step()

    def _catch_up(self) -> bool:
        """Put what waits for room, and return whether nothing waits any more."""
        done = self._prepared.writer.catch_up()
        if done and self.over:
            self._drop_in_step()
        return done

    def _drop_in_step(self) -> None:
        """Drop functions that wait for a move when none is left."""
        writer = self._prepared.writer
        for event in [] if writer.backlog else writer.withdraw_in_step():
            self._interpreter.messages.note(f"{event.word} does nothing: no move follows", event.line)

    @property
    def starved(self) -> bool:
        """Whether everything that has come of a program that is still coming has been prepared."""
        reader, calls = self._reader, self._calls
        read = reader.at_end and reader.place.offset >= reader.end and calls.running.source is None
        return read and calls.is_coming and not calls.has_come and not self.over

    @property
    def over(self) -> bool:
        """Whether nothing more is to be prepared."""
        return self.ended or self._errors.over

    def close(self) -> None:
        """Give up the program: what a language holds for it ends."""
        self.ended = True
        self._search.held = None
        self._calls.close()

    def _note(self, error: ProgramError) -> None:
        self._errors.note(error)
        if not self._errors.collects:
            self._calls.failed()
            return
        if not self._options.mark_refused:
            return
        line = self._reader.line if error.position is None else error.position.line
        tag = self._interpreter.tag_of(line)
        self._prepared.writer.put(Wait(0.0, line, stop=Stop.REFUSED, tag=tag))
