"""One execution of one macro program: what its Python emits, and what it calls on the way."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from polycnc.errors import ProgramError
from polycnc.language import Execution, Flaw, Traced, standing
from polycnc.machine import SnapshotError
from polycnc.nc.macro._calls import Arguments
from polycnc.nc.macro._compile import Code
from polycnc.nc.macro._line_items import LineItems, SpanItems, check_level, is_stage, items_of
from polycnc.nc.macro._macro_state import ModalCall, SavedItems, SavedSource
from polycnc.nc.macro._plain_lines import VariableWords
from polycnc.nc.macro._refusals import Refusals
from polycnc.nc.macro._run_state import RunState
from polycnc.nc.macro._statement_values import (
    alarm,
    into_loop,
    label,
    nearest,
    negative,
    number,
    program_number,
    repetitions,
    stop,
)
from polycnc.nc.macro._variables import LEVELS, LOCALS, NO_VALUE, MacroError, Value, checked
from polycnc.nc.modal._actions import Action
from polycnc.nc.modal._modal import INCH
from polycnc.nc.sources._block_source import (
    CallProgram,
    EndSource,
    Pause,
    SourceItem,
    TextSpan,
    WordsBlock,
    elsewhere,
)
from polycnc.nc.text._program import ProgramText
from polycnc.nc.text._scan_plain import Word

_COMMON_LAST = 999
_MACRO_CALL = 65.0
_WHOLE = frozenset("DHLMNOPST")
_FEED_DECIMALS = 1e-4
_INCH_INCREMENT = 0.1
_G_INCREMENT = 0.1
_PARAMETERS = frozenset({"L", "C", "H"})


@dataclass
class Compiled:
    """A program that begins at `offset` of a text, or was begun at byte `start`: its code, or what is wrong with it."""

    text: ProgramText
    offset: int
    line: int
    plain: bool
    start: int | None
    code: Code | None
    errors: list[ProgramError]
    name: str
    number: int


class MacroSource:
    """One execution of one program."""

    def __init__(self, language: RunState, compiled: Compiled, arguments: Arguments | None) -> None:
        self._language = language
        self._compiled = compiled
        self._arguments = arguments or _NO_ARGUMENTS
        self._errors = list(compiled.errors)
        self._pauses = 0
        self._refusals = Refusals(compiled.text, compiled.code.refusals if compiled.code else [])
        self._outer_modals = language.modals
        self._outer_interrupt = language.interrupt_program
        self._outer_number = language.system.program_number
        self._closed = False
        self.main = language.channel.depth == 0
        self._local = language.variables.local
        self._execution: Execution | None = None

    def begin(self) -> MacroSource:
        """Begin the program: with local variables of its own, where it was called with any."""
        language, arguments = self._language, self._arguments
        if arguments.modal:
            language.modals = language.modals[:-1]
        if arguments.interrupt:
            language.modals, language.interrupt_program = (), None
        if arguments.by_code:
            language.codes_off += 1
        if arguments.values is not None:
            language.variables.enter(arguments.values)
            language.note_level()
        self._local = language.variables.local
        language.system.program_number = self._compiled.number
        self._execution = self._made()
        return self

    def saved(self) -> SavedSource:
        """Return where the program stands.

        Raises:
            SnapshotError: Its local variables are gone: a reset has taken them away.
        """
        compiled = self._compiled
        level = self._language.variables.level_of(self._local)
        if level is None:
            raise SnapshotError(
                "the program under way has been reset", hint="Take the snapshot when it is over."
            )
        run = self._execution
        found = {} if run is None else run.names
        names = {name: value for name, value in found.items() if name not in _PARAMETERS}
        items = None if run is None else run.inner
        return SavedSource(
            compiled.text,
            compiled.offset,
            compiled.line,
            compiled.plain,
            compiled.start,
            len(self._errors),
            self._pauses,
            None if self._arguments is _NO_ARGUMENTS else self._arguments,
            level,
            self._outer_modals,
            self._outer_interrupt,
            self._outer_number,
            self._closed,
            self.main,
            None if run is None else run.place,
            names,
            items.saved() if isinstance(items, LineItems | SpanItems) else None,
        )

    def go_to(self, saved: SavedSource, traced: Traced[int] | None) -> MacroSource:
        """Stand where another execution stood; `traced` is what `standing` has made for that."""
        self._errors = self._errors[len(self._errors) - saved.errors :]
        self._pauses, self._closed, self.main = saved.pauses, saved.closed, saved.main
        self._outer_modals, self._outer_interrupt = saved.outer_modals, saved.outer_interrupt
        self._outer_number = saved.outer_number
        self._local = self._language.variables.locals_of(saved.level)
        if (run := self._made()) is not None:
            run.go_on(traced, saved.names, None if saved.items is None else self._items(saved.items))
        self._execution = run
        return self

    def _items(self, saved: SavedItems) -> LineItems | SpanItems:
        if saved.span is None:
            return items_of(self._language, saved)
        items = self.span(saved.span[0])
        items.go_to(saved)
        return items

    @property
    def word_values(self) -> VariableWords:
        """What words with variables in its plain text are worth."""
        return VariableWords(self._local, self._language.variables.common, self.increment)

    @property
    def _code(self) -> Code:
        code = self._compiled.code
        assert code is not None
        return code

    def next(self) -> SourceItem | None:
        """Return what comes next, None at the end of the program.

        Raises:
            ProgramError: a statement that cannot be executed.
        """
        if self._errors:
            raise self._errors.pop(0)
        self._language.turns += 1
        if self._execution is None:
            return None
        item: SourceItem | None = self._execution.next()
        self._pauses = self._pauses + 1 if item is Pause.PAUSE else 0
        limit = self._language.longest_loop_pauses
        if limit is not None and self._pauses > limit:
            raise self._endless()
        return item

    def leave(self) -> bool:
        """Leave nothing: programs that are called are those of the channel."""
        return False

    def failed(self) -> None:
        """Do nothing: local variables can be looked at until the program is left."""

    def close(self) -> None:
        """End the program: its local variables are gone."""
        if self._closed:
            return
        self._closed = True
        if self.main:
            self._refusals.remark(self._language.channel.messages)
        if self._execution is not None:
            self._execution.close()
        language = self._language
        language.system.program_number = self._outer_number
        if self._arguments.values is not None:
            language.variables.leave()
        if self._arguments.by_code:
            language.codes_off -= 1
        if self._arguments.modal or self._arguments.interrupt:
            language.modals = self._outer_modals
        if self._arguments.interrupt:
            language.interrupt_program = self._outer_interrupt

    # ------------------------------------------------------------------ the program's own calls

    def _made(self) -> Execution | None:
        code, language = self._compiled.code, self._language
        if code is None:
            return None
        variables, system = language.variables, language.system
        common, ranges = variables.common, variables.ranges
        local = self._local

        def get(number: int) -> Value:
            if 0 <= number <= LOCALS:
                return local[number]
            for first, last in ranges:
                if first <= number <= last:
                    return common[number]
            system.modal_call = bool(language.modals)
            return system.read(number)

        def put(number: int, value: Value) -> None:
            if number > _COMMON_LAST:
                system.write(number, value)
            elif 1 <= number <= LOCALS:
                local[number] = value if value is None else checked(value)
            else:
                variables.set(number, value)

        names: dict[str, object] = {
            **language.bindings(),
            "PAUSE": Pause.PAUSE,
            "RETURN": EndSource.RETURN,
            "S": code.spans,
            "V": system,
            "T": code.texts,
            "get": get,
            "put": put,
            "number": number,
            "waits": system.waits,
            "checked": checked,
            "negative": negative,
            "adp": self._with_point,
            "alarm": alarm,
            "stop": stop,
            "refuse": self._refusals.refuse,
            "label": label,
            "find": self._find,
            "into_loop": into_loop,
            "block": self._block,
            "call": self._call,
            "sub": self._sub,
            "modal": self._modal_call,
        }
        return Execution(code.traced, names, (local, common, _Host(self)), self._explained)

    def skips(self, level: int) -> bool:
        return level in self._language.channel.skip_levels

    def increment(self, letter: str) -> float:
        if letter in _WHOLE:
            return 1.0
        if letter == "G":
            return _G_INCREMENT
        if letter == "F":
            return _FEED_DECIMALS
        channel = self._language.channel
        inch = _INCH_INCREMENT if channel.state.modal.whole[INCH] else 1.0
        return channel.dialect.numbers.least_input * inch

    def _with_point(self, value: float) -> float:
        """Return what an argument without a decimal point is with one (ADP)."""
        increment = self._language.channel.dialect.increment
        return value / increment if increment else value

    def _block(self, index: int, values: tuple[Value, ...]) -> WordsBlock:
        spec = self._code.blocks[index]
        following = iter(values)
        words = []
        for word in spec.words:
            if word.value is not None:
                words.append(Word(word.letter, word.value, word.at, word.point))
                continue
            value = next(following)
            if value is not None:
                words.append(Word(word.letter, nearest(value, self.increment(word.letter)), word.at, True))
        return WordsBlock(tuple(words), spec.line, spec.offset, skip_level=spec.skip)

    def words(self, index: int, values: tuple[Value, ...]) -> LineItems:
        """Return a block of words and the calls after it, or the call that it becomes (G66.1)."""
        block = self._block(index, values)
        letters = tuple((word.letter, word.value) for word in block.words)
        return LineItems(self._language, block, letters, block.line, block.offset)

    def span(self, index: int) -> SpanItems:
        """Return plain text line by line, with the call after every move."""
        whole = self._code.spans[index]
        assert isinstance(whole, TextSpan)
        return SpanItems(self._language, self._compiled.text, whole, index, self.word_values)

    def _call(self, index: int, program: float, repeats: float, values: tuple[Value, ...]) -> CallProgram:
        check_level(self._language.variables)
        spec = self._code.calls[index]
        arguments = Arguments(dict(zip(spec.numbers, values, strict=True)), by_code=spec.by_code)
        times = repetitions(repeats)
        channel = self._language.channel
        if not spec.by_code and channel.dialect.g_action(_MACRO_CALL) is Action.LEFT_OUT:
            channel.messages.note(f"G{_MACRO_CALL:g} is left out, as told", spec.line)
            times = 0
        return CallProgram(program_number(program), spec.line, spec.offset, times, arguments)

    def _sub(self, index: int, program: float, repeats: float) -> CallProgram:
        spec = self._code.calls[index]
        return CallProgram(
            program_number(program),
            spec.line,
            spec.offset,
            repetitions(repeats),
            Arguments(None, by_code=True),
        )

    def _modal_call(
        self, index: int, program: float, repeats: float, values: tuple[Value, ...], each: bool
    ) -> ModalCall:
        numbers = self._code.calls[index].numbers
        if len(self._language.modals) >= LEVELS:
            raise MacroError(f"more than {LEVELS} modal calls", "Cancel one with G67 first.", "PS0122")
        return ModalCall(
            program_number(program), repetitions(repeats), dict(zip(numbers, values, strict=True)), each
        )

    def put_out(self, index: int, values: tuple[float, ...], line: int) -> None:
        """Write an output to the device."""
        self._language.output.write(self._code.outputs[index], values, line)

    def _find(self, number: int, offset: int) -> tuple[int, int]:
        code = self._code
        found = code.shape.find(number, offset)
        if found is None:
            hint = f"Check the block number; {NO_VALUE}."
            raise MacroError(f"there is no block N{number} in this program", hint, "PS0128")
        return code.places[found]

    # ------------------------------------------------------------------ errors

    def _endless(self) -> ProgramError:
        at = 0 if self._execution is None else self._execution.at or 0
        return error_at(
            self._compiled.text,
            Flaw(at, "this loop goes on without end", "Nothing that it waits for can change here."),
        )

    def _explained(self, error: Exception, at: int) -> ProgramError:
        what, hint, number = _meaning(error)
        return error_at(self._compiled.text, Flaw(at, what, hint, code=number))


class _Host:
    """What a compiled program sees of its source."""

    def __init__(self, source: MacroSource) -> None:
        self._language = source._language
        self.main = source.main
        self.skips = source.skips
        self.span = source.span
        self.words = source.words
        self.put_out = source.put_out
        self.device = source._language.output.switch
        self.set_names = source._language.variables.set_names
        self.named = source._language.variables.named
        self._increment = source.increment

    @property
    def plain(self) -> bool:
        """Whether blocks go out as they are: nothing is called after them."""
        return not self._language.modals and self._language.interrupt_program is None

    def push(self, modal: ModalCall) -> None:
        """Call a macro after every move, or for every block (G66, G66.1)."""
        self._language.modals += (modal,)

    def cancel(self) -> None:
        """Cancel the last modal call (G67)."""
        self._language.modals = self._language.modals[:-1]

    def interrupted_by(self, program: float | None) -> None:
        """Let the interrupt signal call a program, or none (M96, M97)."""
        self._language.interrupt_program = None if program is None else program_number(program)

    @property
    def pending(self) -> int | None:
        """The block that a called program wants its caller to go on with."""
        return self._language.pending

    def back_to(self, label: int) -> None:
        """Let the caller go on with a block."""
        self._language.pending = label

    def taken(self) -> int | None:
        """Return the block to go on with, and forget it."""
        label, self._language.pending = self._language.pending, None
        return label

    def increments(self, value: float) -> float:
        """Return a value in whole increments of a length (ROUND in an address)."""
        return nearest(value, self._increment("X"))


_NO_ARGUMENTS = Arguments(None)


def standing_code(compiled: Compiled, saved: SavedSource) -> Traced[int] | None:
    """Return the code of a program that stands where an execution of it stood; None for one that has ended.

    Raises:
        SnapshotError: It cannot stand there.
    """
    code = compiled.code
    fits = (
        0 <= saved.errors <= len(compiled.errors)
        and 0 <= saved.level <= LEVELS
        and all(isinstance(value, int | float | None) for value in saved.names.values())
        and (saved.items is None or _fits(saved.items, code))
    )
    try:
        if fits:
            return None if code is None else standing(code.traced, saved.place, saved.names)
    except ValueError as error:
        raise elsewhere(compiled.text) from error
    raise elsewhere(compiled.text)


def _fits(items: SavedItems, code: Code | None) -> bool:
    number = 0 if items.span is None else items.span[0]
    spans: Mapping[int, object] = {} if code is None else dict(enumerate(code.spans))
    return is_stage(items.stage) and (items.span is None or isinstance(spans.get(number), TextSpan))


def _meaning(error: Exception) -> tuple[str, str, str]:
    if isinstance(error, MacroError):
        return error.what, error.hint, error.code
    if isinstance(error, ZeroDivisionError):
        return "a division by zero", f"Check the divisor; {NO_VALUE}.", "PS0112"
    return "this cannot be calculated", "Check the values.", "PS0119"


def error_at(text: ProgramText, flaw: Flaw) -> ProgramError:
    """Return an error of a program."""
    hint = flaw.hint or "A block holds words like X12.5 or X#1, or a statement; remarks go into a comment."
    return ProgramError(flaw.what, code=flaw.code, position=text.position(flaw.at), hint=hint)
