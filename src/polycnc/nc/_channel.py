"""A channel: prepares a program ahead of its execution and fills the channel queue with it.

Runs of plain blocks go through the compiled kernel (`fast`), every other block, and the first blocks of a
program, through the ordinary interpreter.
"""

from __future__ import annotations

from collections.abc import Callable

from polycnc.errors import ProgramError
from polycnc.kernel import free_slots
from polycnc.machine import Machine
from polycnc.nc._dialect import Dialect
from polycnc.nc.blocks._calls import Calls, Place
from polycnc.nc.blocks._channel_state import ChannelState
from polycnc.nc.blocks._interpreter import Control, Interpreter, Outcome
from polycnc.nc.blocks._messages import Messages
from polycnc.nc.blocks._modal import LINEAR_AXIS, MODULO_AXIS, ORDINARY, ROTARY_AXIS, make_modal
from polycnc.nc.blocks._queue import ExecutionStoppedError, QueueWriter
from polycnc.nc.fast._plain_blocks import NOT_PLAIN, QUEUE_FULL, RESERVE, make_fast_work, run_plain
from polycnc.nc.text._program import ProgramText
from polycnc.nc.text._scan import COMMENT, LABEL, PERCENT, WordColumns, scan, scan_rules, word_columns
from polycnc.nc.text._scan_plain import Block, Word, scan_block

ORDINARY_BLOCKS = 2000
_CHUNK_BLOCKS = 1 << 14
_JUMP_BLOCKS = 1 << 8  # scanned behind a call or a return: sub-programs are short, and jumps many
_MOST_ERRORS = 1000
_WORDS_ONLY = COMMENT | LABEL
_START_OFFSET = "G54"


class Channel:
    """Prepare one program for one path of a machine.

    With `collect_errors` a refused block is noted in `errors` and left out; else preparation ends there with
    `error`. The ordinary interpreter gives the same queue as the compiled kernel, which takes over after the
    first `ordinary_blocks`: loading it, and once compiling it, takes longer than they do.
    """

    def __init__(
        self,
        program: ProgramText,
        dialect: Dialect,
        machine: Machine,
        *,
        path: int = 0,
        skip_levels: frozenset[int] = frozenset(),
        collect_errors: bool = False,
        ordinary_blocks: float = ORDINARY_BLOCKS,
    ) -> None:
        self.dialect = dialect
        self.machine = machine
        self.path = path
        self.done = False
        self.blocks = 0
        self.errors: list[ProgramError] = []
        self.messages = Messages()
        self._collect_errors = collect_errors
        self._known_errors: set[str] = set()
        self._skip_levels = skip_levels
        self._ordinary_blocks = ordinary_blocks
        self._calls = Calls(program, dialect)
        self._place = Place(program)
        self._chunk = word_columns(_CHUNK_BLOCKS)
        self._jump_chunk = word_columns(_JUMP_BLOCKS)
        self._words = self._chunk
        self._next_block = 0
        self._text_rules = dialect.text_rules()
        self._scan_rules = scan_rules(self._text_rules)
        self._tables = dialect.tables()
        kernel = machine.state
        self.writer = QueueWriter(kernel.seg, kernel.paths, kernel.limits, path)
        self.state = self._initial_state()
        self._fast_work = make_fast_work(self.state.modal)
        self.interpreter = Interpreter(dialect, self.state, self.messages, self.writer, self._calls.trouble)

    @property
    def error(self) -> ProgramError | None:
        """The first error, if there is one."""
        return self.errors[0] if self.errors else None

    @property
    def progress(self) -> float:
        """How much of the program text has been prepared, 0 to 1; it goes back where sub-programs repeat."""
        here = self._here()
        size = len(here.text)
        return min(here.offset / size, 1.0) if size else 1.0

    def on_full_queue(self, make_room: Callable[[], None]) -> None:
        """Set what is called when one block needs more room in the queue than there is."""
        self.writer.make_room = make_room

    def fill(self) -> None:
        """Prepare blocks until the queue is full or the program has ended."""
        whole = self.state.modal.whole
        while not self.done and free_slots(self.writer.paths, self.path) > RESERVE:
            if self._next_block >= self._words.n_blocks:
                self._next_chunk()
            elif self.blocks >= self._ordinary_blocks and not whole[ORDINARY]:
                reason = self._plain_blocks()
                if reason == QUEUE_FULL:
                    return
                if reason == NOT_PLAIN:
                    self._ordinary_block()
            else:
                self._ordinary_block()

    def _initial_state(self) -> ChannelState:
        config = self.machine.config
        limits = [axis.soft_limits for axis in config.axes]
        modal = make_modal(
            config.axis_names,
            [
                LINEAR_AXIS if axis.kind == "linear" else MODULO_AXIS if axis.modulo else ROTARY_AXIS
                for axis in config.axes
            ],
            [low for low, _ in limits],
            [high for _, high in limits],
        )
        modal.position[:] = config.start_positions
        self.dialect.set_initial_state(modal)
        state = ChannelState(config, modal)
        if _START_OFFSET in config.offsets:
            state.coordinates.select_work_offset(0, _START_OFFSET)
        return state

    # ------------------------------------------------------------------ reading

    def _scan(self, columns: WordColumns) -> None:
        """Scan the blocks that follow the present place; the place moves behind them."""
        place = self._place
        self._words = columns
        offset = scan(place.text.data, place.offset, place.line, self._scan_rules, columns)
        self._place = Place(place.text, offset, columns.next_line)
        self._next_block = 0

    def _next_chunk(self) -> None:
        if self._place.offset < len(self._place.text):
            self._scan(self._chunk)
        else:
            self._leave()

    def _jump(self, place: Place) -> None:
        self._place = place
        self._scan(self._jump_chunk)

    def _here(self) -> Place:
        """Return the place of the next block."""
        if self._next_block < self._words.n_blocks:
            return Place(
                self._place.text,
                int(self._words.offset[self._next_block]),
                int(self._words.line[self._next_block]),
            )
        return self._place

    # ------------------------------------------------------------------ blocks

    def _plain_blocks(self) -> int:
        """Let the compiled kernel take what it can; return why it stopped."""
        first = self._next_block
        words = self._words
        kernel = self.machine.state
        self._next_block, reason = run_plain(
            words,
            first,
            self._tables,
            self.state.modal,
            kernel.seg,
            kernel.paths,
            self.path,
            kernel.limits,
            self._fast_work,
        )
        if self._next_block > first:
            self.blocks += self._next_block - first
            if words.first_word[self._next_block] > words.first_word[first]:
                self._calls.running.begun = True
        return reason

    def _ordinary_block(self) -> None:
        index = self._next_block
        self._next_block += 1
        words = self._words
        running = self._calls.running
        if words.flags[index] & PERCENT:
            if running.begun:  # the % behind a program ends it, the one before it does not matter
                self._leave()
            return
        if int(words.skip_level[index]) in self._skip_levels:
            self.blocks += 1
            return
        try:
            block = self._block(index)
            if running.begun and _is_program_number(block):
                self._leave()  # another program begins here
                return
            running.begun = running.begun or bool(block.words)
            self.blocks += 1
            self._go_on(self.interpreter.execute(self._place.text, block))
        except ProgramError as error:
            self._note(error)
            if error.position is not None and error.position.line != words.line[index]:
                self.interpreter.leave_compensation()  # the move before is wrong: not every one after it
        except ExecutionStoppedError:
            self.done = True

    def _block(self, index: int) -> Block:
        """Return a block of the columns; one that is more than words is read again."""
        columns = self._words
        text = self._place.text
        offset, line = int(columns.offset[index]), int(columns.line[index])
        flags = int(columns.flags[index])
        if flags & ~_WORDS_ONLY:
            return scan_block(text, offset, line, self._text_rules)
        span = slice(columns.first_word[index], columns.first_word[index + 1])
        words = tuple(
            map(
                Word,
                columns.letter[span].tobytes().decode("ascii"),
                columns.value[span].tolist(),
                columns.place[span].tolist(),
                columns.point[span].astype(bool).tolist(),
            )
        )
        return Block(words, flags, int(columns.skip_level[index]), offset, text.next_line(offset), line)

    def _note(self, error: ProgramError) -> None:
        """Note an error once, however often its block is repeated."""
        text = str(error)
        if text not in self._known_errors:
            self._known_errors.add(text)
            self.errors.append(error)
        if len(self.errors) >= _MOST_ERRORS:
            self.messages.begin(0)
            self.messages.add(f"the program was checked up to its error number {_MOST_ERRORS}")
            self.done = True
        if not self._collect_errors:
            self.done = True

    # ------------------------------------------------------------------ where it goes on

    def _go_on(self, outcome: Outcome) -> None:
        match outcome.control:
            case Control.END:
                self._end()
            case Control.CALL:
                begin = self._calls.enter(outcome.program, outcome.repeats, self._here())
                if begin is not None:
                    self._jump(begin)
            case Control.RETURN:
                if self._calls.depth == 0:
                    self.messages.add("a return from the main program ends it")
                self._leave()
            case _:
                pass

    def _leave(self) -> None:
        """End the present program: go back to the one that called it, or end everything."""
        back = self._calls.leave()
        if back is None:
            self._end()
        else:
            self._jump(back)

    def _end(self) -> None:
        self.done = True
        try:
            self.interpreter.finish()
        except ProgramError as error:
            self._note(error)
        except ExecutionStoppedError:
            pass


def _is_program_number(block: Block) -> bool:
    return bool(block.words) and block.words[0].letter == "O"
