"""What blocks of a macro program give to the channel: themselves, and the calls that stand after or instead of them.

Both iterators can tell where they stand between two items, and be made to stand there.
"""

from __future__ import annotations

from polycnc.nc.macro._calls import ARGUMENTS_EACH, Arguments
from polycnc.nc.macro._macro_state import ModalCall, SavedItems
from polycnc.nc.macro._plain_lines import line_words
from polycnc.nc.macro._run_state import RunState
from polycnc.nc.macro._variables import LEVELS, MacroError, MacroVariables, Value
from polycnc.nc.sources._block_source import CallProgram, Drain, SourceItem, TextSpan, WordValues
from polycnc.nc.text._program import ProgramText
from polycnc.nc.text._scan import STATEMENT
from polycnc.nc.text._scan_plain import scan_block

_NOT_A_MOVE = (4.0, 10.0, 28.0, 29.0, 30.0, 52.0, 65.0, 66.0, 67.0, 68.0, 50.0, 51.0, 92.0, 50.1, 51.1)
_BLOCK, _MOVE, _WAIT, _INTERRUPT, _END = "block", "move", "wait", "interrupt", "end"
_STAGES = (_BLOCK, _MOVE, _WAIT, _INTERRUPT, _END)

Letters = tuple[tuple[str, float], ...]


class LineItems:
    """The items of one block with these `letters`; `block` is the block itself, None once it has been given.

    `stage` is what comes next: the block (or the call that it becomes, G66.1), the call after its move (G66), the wait
    for an interrupt signal (M96), and the call by that signal.
    """

    def __init__(
        self,
        language: RunState,
        block: SourceItem | None,
        letters: Letters,
        line: int,
        offset: int,
        *,
        stage: str = _BLOCK,
    ) -> None:
        self._language = language
        self._block = block
        self._letters = letters
        self._line = line
        self._offset = offset
        self._stage = stage

    def __iter__(self) -> LineItems:
        return self

    def __next__(self) -> SourceItem:
        while self._stage != _END:
            if (item := self._stage_item()) is not None:
                return item
        raise StopIteration

    def saved(self, span: tuple[int, int, int] | None = None) -> SavedItems:
        """Return where it stands, between two items."""
        return SavedItems(self._letters, self._line, self._offset, self._stage, span)

    def only_block(self) -> SourceItem | None:
        """Give the block, and nothing after it."""
        self._stage = _END
        return self._block

    def _stage_item(self) -> SourceItem | None:
        """Return what the present stage gives, and go to the next one."""
        language = self._language
        match self._stage:
            case "block":
                if language.modals and language.modals[-1].each:
                    self._stage = _END
                    return self._each_item(language.modals[-1])
                self._stage = _MOVE
                return self._block
            case "move":
                self._stage = _WAIT
                return self._modal_item()
            case "wait":
                waits = language.interrupt_program is not None and language.pending is None
                self._stage = _INTERRUPT if waits else _END
                return Drain(self._line) if waits else None
            case _:
                self._stage = _END
                return self._interrupt_item()

    def _each_item(self, modal: ModalCall) -> SourceItem | None:
        """Return the call that a block becomes, with its words as arguments; a block number alone is none."""
        values: dict[int, Value] = {
            ARGUMENTS_EACH[letter]: value for letter, value in self._letters if letter in ARGUMENTS_EACH
        }
        if all(letter in "NO" for letter, _ in self._letters):
            return None
        return self._call(modal.program, modal.repeats, Arguments(values, modal=True))

    def _modal_item(self) -> SourceItem | None:
        """Return the call after a block that moves."""
        language = self._language
        axes = language.channel.state.axis_names
        moves = any(letter in axes for letter, _ in self._letters)
        if (
            not language.modals
            or not moves
            or any(letter == "G" and code in _NOT_A_MOVE for letter, code in self._letters)
        ):
            return None
        modal = language.modals[-1]
        return self._call(modal.program, modal.repeats, Arguments(dict(modal.values), modal=True))

    def _interrupt_item(self) -> SourceItem | None:
        language = self._language
        if not language.take_interrupt() or language.interrupt_program is None:
            return None
        return self._call(language.interrupt_program, 1, Arguments({}, interrupt=True))

    def _call(self, program: int, repeats: int, arguments: Arguments) -> CallProgram:
        check_level(self._language.variables)
        return CallProgram(program, self._line, self._offset, repeats, arguments)


class SpanItems:
    """The items of plain text line by line, with the call after every move; `number` is the span's in its program."""

    def __init__(
        self, language: RunState, text: ProgramText, whole: TextSpan, number: int, values: WordValues
    ) -> None:
        self._values = values
        self._language = language
        self._text = text
        self._end = whole.end
        self._number = number
        self._offset, self._line = whole.offset, whole.line
        self._items: LineItems | None = None

    def __iter__(self) -> SpanItems:
        return self

    def __next__(self) -> SourceItem:
        while True:
            if self._items is not None:
                if (item := next(self._items, None)) is not None:
                    return item
                self._items = None
                if self._language.pending is not None:
                    self._offset = self._end  # another block of the caller comes next
            if self._offset >= self._end:
                raise StopIteration
            if (item := self._next_line()) is not None:
                return item

    def _next_line(self) -> SourceItem | None:
        """Go to the next line; return it where nothing comes after it."""
        text, channel = self._text, self._language.channel
        offset, line = self._offset, self._line
        end = min(text.next_line(offset), self._end)
        block = scan_block(text, offset, line, channel.dialect.text)
        opened = block.flags & STATEMENT
        words = line_words(text, offset, end, self._values) if opened else block.words
        letters = tuple((word.letter, word.value) for word in words)
        self._items = LineItems(self._language, TextSpan(offset, line, end), letters, line, offset)
        self._offset, self._line = end, line + 1
        if block.skip_level and block.skip_level in channel.skip_levels:
            return self._items.only_block()
        return None

    def saved(self) -> SavedItems:
        """Return where it stands, between two items."""
        span = self._number, self._offset, self._line
        items = self._items or LineItems(self._language, None, (), self._line, self._offset, stage=_END)
        return items.saved(span)

    def go_to(self, saved: SavedItems) -> None:
        """Stand where another one stood."""
        assert saved.span is not None
        _, self._offset, self._line = saved.span
        self._items = items_of(self._language, saved)


def items_of(language: RunState, saved: SavedItems) -> LineItems:
    """Return the items of a block from where they stood."""
    return LineItems(language, None, saved.letters, saved.line, saved.offset, stage=saved.stage)


def is_stage(stage: str) -> bool:
    """Tell whether there is such a stage after a block."""
    return stage in _STAGES[1:]


def check_level(variables: MacroVariables) -> None:
    """Refuse a call of another macro where they are nested too deep.

    Raises:
        MacroError: They are.
    """
    if variables.level >= LEVELS:
        raise MacroError(f"macros are nested more than {LEVELS} deep", "Does a macro call itself?", "PS0122")
