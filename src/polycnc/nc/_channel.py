"""A channel: prepares a program ahead of its execution and fills the channel queue with it.

Runs of plain blocks go through the compiled kernel (`_fast`), every other block through the ordinary interpreter.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from polycnc.errors import ProgramError, UsageError
from polycnc.kernel import free_slots
from polycnc.machine import Machine
from polycnc.nc._channel_state import ChannelState
from polycnc.nc._coordinates import Coordinates
from polycnc.nc._dialect import Dialect
from polycnc.nc._fast import NOT_PLAIN, QUEUE_FULL, RESERVE, make_fast_work, run_plain
from polycnc.nc._interpreter import Control, Interpreter, Outcome
from polycnc.nc._messages import Messages
from polycnc.nc._modal import make_modal
from polycnc.nc._program import ProgramText
from polycnc.nc._queue import QueueWriter
from polycnc.nc._scan import PERCENT, scan, scan_rules, word_columns
from polycnc.nc._scan_plain import scan_block

_LABEL = re.compile(rb"^[ \t]*[Oo:][ \t]*0*([0-9]+)", re.MULTILINE)
_CHUNK_BLOCKS = 1 << 14


@dataclass
class _Place:
    """Where the reading of a program stands."""

    text: ProgramText
    offset: int = 0
    line: int = 1


@dataclass
class _Call:
    """A sub-program that is being executed: where it began, how often it still runs, and where to go back to."""

    begin: _Place
    repeats: int
    back: _Place


class Channel:
    """Prepare one program for one path of a machine.

    With `collect_errors` a refused block is noted in `errors` and left out; else preparation ends there with `error`.
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
    ) -> None:
        self.dialect = dialect
        self.machine = machine
        self.path = path
        self.done = False
        self.blocks = 0
        self.errors: list[ProgramError] = []
        self.messages = Messages()
        self._collect_errors = collect_errors
        self._skip_levels = skip_levels
        self._place = _Place(program)
        self._calls: list[_Call] = []
        self._labels: dict[str, dict[int, _Place]] = {}
        self._seen_percent = False
        self._words = word_columns(_CHUNK_BLOCKS)
        self._next_block = 0
        self._text_rules = dialect.text_rules()
        self._scan_rules = scan_rules(self._text_rules)
        self._tables = dialect.tables()
        kernel = machine.state
        self.writer = QueueWriter(kernel.seg, kernel.paths, kernel.limits, path)
        self.state = self._initial_state()
        self._fast_work = make_fast_work(len(machine.config.axes))
        self.writer.set_tolerance(self.state.path_tolerance_mm)
        self.interpreter = Interpreter(
            dialect, self.state, self.messages, self.writer.put, self.writer.set_tolerance
        )
        self._scan_chunk()

    @property
    def error(self) -> ProgramError | None:
        """The first error, if there is one."""
        return self.errors[0] if self.errors else None

    @property
    def progress(self) -> float:
        """How much of the program text has been prepared, 0 to 1; it goes back where sub-programs repeat."""
        size = len(self._place.text)
        return min(self._here().offset / size, 1.0) if size else 1.0

    def on_full_queue(self, make_room: Callable[[], None]) -> None:
        """Set what is called when one block needs more room in the queue than there is."""
        self.writer.make_room = make_room

    def fill(self) -> None:
        """Prepare blocks until the queue is full or the program has ended."""
        while not self.done and free_slots(self.writer.paths, self.path) > RESERVE:
            if self._next_block >= self._words.n_blocks:
                self._next_chunk()
                continue
            first = self._next_block
            kernel = self.machine.state
            self._next_block, reason = run_plain(
                self._words,
                first,
                self._tables,
                self.state.modal,
                kernel.seg,
                kernel.paths,
                self.path,
                kernel.limits,
                self._fast_work,
            )
            self.blocks += self._next_block - first
            if reason == QUEUE_FULL:
                return
            if reason == NOT_PLAIN:
                self._ordinary_block()

    def _initial_state(self) -> ChannelState:
        config = self.machine.config
        limits = [axis.soft_limits for axis in config.axes]
        modal = make_modal(
            list(config.axis_names),
            [axis.kind == "rotary" for axis in config.axes],
            [low for low, _ in limits],
            [high for _, high in limits],
        )
        modal.position[:] = config.start_positions
        self.dialect.set_initial_state(modal)
        state = ChannelState(
            config, modal, Coordinates(config, modal), path_tolerance_mm=config.path.path_tolerance_mm
        )
        if "G54" in config.offsets:
            state.coordinates.select_work_offset("G54")
        return state

    # ------------------------------------------------------------------ reading

    def _scan_chunk(self) -> None:
        """Scan the blocks that follow the present place; the place moves behind them."""
        place = self._place
        offset = scan(place.text.data, place.offset, place.line, self._scan_rules, self._words)
        self._place = _Place(place.text, offset, self._words.next_line)
        self._next_block = 0

    def _next_chunk(self) -> None:
        if self._place.offset < len(self._place.text):
            self._scan_chunk()
        elif self._calls:
            self._return()
        else:
            self._end()

    def _jump(self, place: _Place) -> None:
        self._place = place
        self._scan_chunk()

    def _here(self) -> _Place:
        """Return the place of the next block."""
        if self._next_block < self._words.n_blocks:
            return _Place(
                self._place.text,
                int(self._words.offset[self._next_block]),
                int(self._words.line[self._next_block]),
            )
        return self._place

    # ------------------------------------------------------------------ one block

    def _ordinary_block(self) -> None:
        index = self._next_block
        self._next_block += 1
        words = self._words
        if words.flags[index] & PERCENT:
            self._percent(index)
            return
        self.blocks += 1
        if int(words.skip_level[index]) in self._skip_levels:
            return
        text = self._place.text
        try:
            block = scan_block(text, int(words.offset[index]), int(words.line[index]), self._text_rules)
            outcome = self.interpreter.execute(text, block)
            self._go_on(outcome, block.offset)
        except ProgramError as error:
            self.errors.append(error)
            if not self._collect_errors:
                self.done = True

    def _percent(self, index: int) -> None:
        """A % opens the program or, behind anything else, ends it."""
        if self._seen_percent or self.blocks:
            if self._calls:
                self._return()
            else:
                self._end()
        self._seen_percent = True

    def _go_on(self, outcome: Outcome, offset: int) -> None:
        match outcome.control:
            case Control.END:
                self._end()
            case Control.CALL:
                self._call(outcome, offset)
            case Control.RETURN:
                if self._calls:
                    self._return()
                else:
                    self.messages.add("a return from the main program ends it")
                    self._end()
            case _:
                pass

    def _end(self) -> None:
        self.done = True
        try:
            self.interpreter.finish()
        except ProgramError as error:
            self.errors.append(error)

    # ------------------------------------------------------------------ sub-programs

    def _call(self, outcome: Outcome, offset: int) -> None:
        deepest = self.dialect.sub_program.depth
        if len(self._calls) >= deepest:
            raise ProgramError(
                f"sub-programs are nested more than {deepest} deep",
                position=self._place.text.position(offset),
                hint=f"Dialect '{self.dialect.name}' allows {deepest} levels.",
            )
        begin = self._find(outcome.program)
        if begin is None:
            raise ProgramError(
                f"there is no sub-program {outcome.program}",
                position=self._place.text.position(offset),
                hint=f"Write it behind the program, beginning with O{outcome.program}, or as a file of this name "
                "in the same folder.",
            )
        if outcome.repeats > 0:
            self._calls.append(_Call(begin, outcome.repeats - 1, self._here()))
            self._jump(begin)

    def _return(self) -> None:
        call = self._calls[-1]
        if call.repeats > 0:
            call.repeats -= 1
            self._jump(call.begin)
        else:
            self._calls.pop()
            self._jump(call.back)

    def _find(self, number: int) -> _Place | None:
        """Return where sub-program `number` begins: in this file, or in a file of its name beside it."""
        text = self._place.text
        if text.name not in self._labels:
            self._labels[text.name] = _labels(text)
        found = self._labels[text.name].get(number)
        if found is not None:
            return found
        folder = Path(text.name).parent
        for name in (f"O{number:04d}", f"O{number}", f"{number}"):
            for extension in ("", *self.dialect.extensions):
                try:
                    return _Place(ProgramText.from_path(folder / f"{name}{extension}"))
                except UsageError:
                    continue
        return None


def _labels(text: ProgramText) -> dict[int, _Place]:
    """Return where the programs of a file begin, by number; the first of a number counts."""
    found: dict[int, _Place] = {}
    for match in _LABEL.finditer(text.content):
        number = int(match[1])
        if number not in found:
            position = text.position(match.start())
            found[number] = _Place(text, match.start(), position.line)
    return found
