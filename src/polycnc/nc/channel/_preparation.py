"""The preparation of a program: one block after the other, from its text or its language, until there is no room."""

from __future__ import annotations

from polycnc.errors import ProgramError
from polycnc.nc.blocks._interpreter import Interpreter
from polycnc.nc.blocks._moves import Stop, Wait
from polycnc.nc.blocks._outcomes import Control
from polycnc.nc.channel._calls import Calls
from polycnc.nc.channel._errors import Errors
from polycnc.nc.channel._options import ChannelOptions
from polycnc.nc.channel._prepared import Prepared
from polycnc.nc.channel._reader import Reader
from polycnc.nc.channel._search import Search
from polycnc.nc.channel._turns import BARREN_TURNS, PLAIN_PER_TURN, Turns
from polycnc.nc.fast._plain_blocks import NOT_PLAIN, QUEUE_FULL
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
        if not turns.begin():
            return
        if not self.begun:
            self.begun = True
            if (error := self._reader.text.endless_line()) is not None:
                self._note(error)
                self.close()
                return
            self._calls.begin()
        if prepared.writer.backlog and not self._catch_up():
            return
        most = None if blocks is None else reader.blocks + blocks
        while not self.over and (most is None or reader.blocks < most) and prepared.has_room():
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
            least = 1 if prepared.takes_time(tail) else BARREN_TURNS
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
                self._leave()
            elif isinstance(block, Block):
                self._execute(reader.text, block)
        except ProgramError as error:
            self._note(error)
            if error.position is not None and error.position.line != reader.line:
                self._interpreter.leave_compensation()  # the move before is wrong: not every one after it

    def _from_source(self) -> bool:
        """Do what the source of the present program gives; False if that is nothing for now."""
        try:
            item = self._search.next_item()
            if item is Pause.PAUSE:
                self.turns.pause()
                return False
            tail = int(self._prepared.row["tail"])
            self._source_item(item)
            barren = not isinstance(item, TextSpan) and not self._prepared.takes_time(tail)
            self.turns.take(BARREN_TURNS if barren else 1)
            if isinstance(item, Drain) and not self._search.active:
                self.turns.look(self._reader.text.name, item.line)
        except ProgramError as error:
            self._note(error)
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
        end = text.next_line(item.offset)
        block = Block(
            item.words, flags, item.skip_level, item.offset, end, item.line,
            message=item.message, profile=item.profile,
        )  # fmt: skip
        self._execute(text, block)

    # ------------------------------------------------------------------ where it goes on

    def _execute(self, text: ProgramText, block: Block) -> None:
        """Execute a block and go on where it says."""
        outcome = self._interpreter.execute(text, block)
        match outcome.control:
            case Control.END:
                if not self._end_returns or not self._calls.leave():
                    self._end()
            case Control.CALL:
                self._calls.enter(outcome.program, outcome.repeats, block.line)
            case Control.GO_ON:
                self._go_behind(outcome.place, block)
            case Control.RETURN:
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
