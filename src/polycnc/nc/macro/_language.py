"""Custom macros as the language of a channel: programs are compiled once and give their blocks one after the other."""

from __future__ import annotations

from collections.abc import Generator, Iterator
from dataclasses import dataclass
from typing import Any, NoReturn

from polycnc.errors import ProgramError
from polycnc.language import Flaw, Frame, frame_of
from polycnc.nc._block_records import Call
from polycnc.nc._block_source import (
    CallProgram,
    Drain,
    EndSource,
    Pause,
    SourceItem,
    TextSpan,
    WordsBlock,
)
from polycnc.nc._channel import Channel
from polycnc.nc.blocks._modal import INCH
from polycnc.nc.macro._calls import ARGUMENTS_EACH, Arguments, MacroCalls
from polycnc.nc.macro._compile import Code, compile_program, names
from polycnc.nc.macro._functions import asin, atan2, rounded
from polycnc.nc.macro._output import OutputDevice
from polycnc.nc.macro._reader import LARGEST_LABEL, LineReader
from polycnc.nc.macro._shape import (
    Special,
    called_programs,
    extent,
    parse,
    returns_to_a_block,
    shape,
    special,
)
from polycnc.nc.macro._system import SystemVariables
from polycnc.nc.macro._variables import LEVELS, LOCALS, MacroError, MacroVariables, Value, checked
from polycnc.nc.text._program import ProgramText
from polycnc.nc.text._scan_plain import Word, scan_block

PAUSE_JUMPS = 20_000
"""Jumps back after which a program gives a pause."""
LONGEST_LOOP_PAUSES = 2_500
"""So many pauses in a row without a block are a loop without end."""
_COMMON_LAST = 999
_LEVELS_REMEMBERED = 64
_ALARM_BASE = 3000
_LARGEST_ALARM = 999
_WHOLE = frozenset("DHLMNOPST")
_FEED_DECIMALS = 1e-4
_INCH_INCREMENT = 0.1
_G_INCREMENT = 0.1
_NOT_A_MOVE = (4.0, 10.0, 28.0, 29.0, 30.0, 52.0, 65.0, 66.0, 67.0, 68.0, 50.0, 51.0, 92.0, 50.1, 51.1)
_PLAIN_CALLS = MacroCalls()
_PIECE_BYTES = 1 << 20


@dataclass(frozen=True, slots=True)
class _Modal:
    """A call behind every move: program, repetitions and arguments; `each` in place of every block (G66.1)."""

    program: int
    repeats: int
    values: dict[int, Value]
    each: bool = False


@dataclass
class _Compiled:
    """A program: its code, or what is wrong with it."""

    text: ProgramText
    code: Code | None
    errors: list[ProgramError]
    name: str
    number: int


class MacroLanguage:
    """Execute programs with custom macros.

    `turns` counts how often programs were asked for a block: whoever keeps variables sees by it that they may have
    changed. `variables` may be shared with whoever else reads and writes them, `system` are the control's own
    variables, `calls` the codes that call programs. With `nat` ASIN and ATAN give -90 to 90 and -180 to 180 degrees.
    With `main_repeats` M99 in the main program begins it anew instead of ending it. With `endless_loops` a loop may go
    round without a block for ever; else that is an error after 50,000,000 rounds. It pauses after `pause_jumps` of
    them.
    """

    def __init__(
        self,
        variables: MacroVariables | None = None,
        *,
        system: SystemVariables | None = None,
        calls: MacroCalls | None = None,
        nat: bool = False,
        main_repeats: bool = False,
        endless_loops: bool = False,
        pause_jumps: int = PAUSE_JUMPS,
    ) -> None:
        self.variables = variables or MacroVariables()
        self.system = system or SystemVariables()
        self.calls = calls or _PLAIN_CALLS
        self.nat = nat
        self.main_repeats = main_repeats
        self.longest_loop_pauses = None if endless_loops else LONGEST_LOOP_PAUSES
        self.modals: tuple[_Modal, ...] = ()
        self.interrupt_program: int | None = None
        self.output = OutputDevice()
        self.pending: int | None = None
        self._interrupt = False
        self.codes_off = 0
        self._channel: Channel | None = None
        self._compiled: dict[tuple[int, int, bool], _Compiled | None] = {}
        self._returns: dict[int, tuple[ProgramText, bool]] = {}
        self._latin: dict[int, tuple[ProgramText, str, bytes]] = {}
        self._without: dict[tuple[int, bool], ProgramText] = {}
        self.turns = 0
        self._levels: dict[tuple[Call, ...], list[Value]] = {}
        self._pause_jumps = pause_jumps

    def attach(self, channel: Channel) -> None:
        """Work for a channel: its positions, modal state and tables are what system variables read."""
        self._channel = channel
        self._levels.clear()
        self.system.attach(channel)
        self.variables.leave_all()
        self.modals, self.pending = (), None
        self.interrupt_program, self._interrupt = None, False
        self.output.attach(channel)
        self.codes_off = 0
        self._compiled.clear()
        self._latin.clear()
        self._without.clear()
        self._returns.clear()

    def interrupt(self) -> None:
        """Give the interrupt signal: the program that M96 names is called behind the block that is executed."""
        self._interrupt = self.interrupt_program is not None

    def take_interrupt(self) -> bool:
        """Tell whether the interrupt signal has come since this was asked last."""
        taken, self._interrupt = self._interrupt, False
        return taken

    @property
    def channel(self) -> Channel:
        """The channel that the language works for."""
        assert self._channel is not None
        return self._channel

    def locals_of(self, stack: tuple[Call, ...]) -> list[Value]:
        """Return the local variables of a block that calls led to; preparation may have left its macro already."""
        for depth in range(len(stack), 0, -1):
            if (found := self._levels.get(stack[:depth])) is not None:
                return found
        return self.variables.locals_of(0)

    def note_level(self) -> None:
        """Remember the local variables of the macro that begins, for those who look at the block executed."""
        self._levels.pop(self.channel.stack, None)
        self._levels[self.channel.stack] = self.variables.local
        if len(self._levels) > _LEVELS_REMEMBERED:
            del self._levels[next(iter(self._levels))]

    def source(self, text: ProgramText, offset: int, line: int, arguments: object) -> MacroSource | None:
        """Return a source for the program that begins at byte `offset`, None where plain text needs none."""
        given = arguments if isinstance(arguments, Arguments) else None
        needed = given is not None or bool(self.modals) or self.interrupt_program is not None
        key = (id(text), offset, self.codes_off > 0 or (given is not None and given.by_code))
        if key not in self._compiled:
            self._compiled[key] = self._compile(text, offset, line, key[2], force=False)
        compiled = self._compiled[key]
        if compiled is None:
            if not needed:
                return None
            compiled = self._compile(text, offset, line, key[2], force=True)
            assert compiled is not None
        return MacroSource(self, compiled, given)

    def source_at(self, text: ProgramText, offset: int, line: int, start: int) -> MacroSource | None:
        """Return a source that begins at byte `start`, the beginning of a line; None where plain text needs none.

        Raises:
            ProgramError: The program is wrong, or cannot begin there.
        """
        compiled = self._compile(text, offset, line, False, force=False, start=start)
        if compiled is None:
            return None
        if compiled.errors:
            raise compiled.errors[0]
        return MacroSource(self, compiled, None)

    def _compile(
        self,
        text: ProgramText,
        offset: int,
        line: int,
        plain: bool,
        *,
        force: bool,
        start: int | None = None,
    ) -> _Compiled | None:
        calls = _PLAIN_CALLS if plain else self.calls
        known = id(text) in self._latin or force
        if not known and self._is_plain(
            text, plain, special(calls, restarts=self.main_repeats, returns=True)
        ):
            return None
        returns = self._is_returned_into(text, calls)
        wanted = special(calls, restarts=self.main_repeats, returns=returns)
        if not known and not returns and self._is_plain(text, plain, wanted):
            return None
        if id(text) not in self._latin:
            self._latin[id(text)] = (text, text.content.decode("latin-1"), text.content.upper())
        _, whole, folded = self._latin[id(text)]
        if not force and next(wanted.lines(whole, folded, offset, len(whole)), None) is None:
            return None
        begin, first_line, end = extent(whole, offset, line)
        if not force and next(wanted.lines(whole, folded, begin, end), None) is None:
            return None
        reader = LineReader(whole, calls, repeats=self.main_repeats)
        parts, flaws = parse(whole, wanted.lines(whole, folded, begin, end), begin, first_line, end, reader)
        name = f"<macro {id(text)} {offset} {plain}>"
        code = None
        if not flaws:
            made, flaws = shape(whole, parts, returns=returns, start=start)
            if not flaws:
                increment = self.channel.dialect.increment
                code, flaws = compile_program(whole, made, self, increment, name)
        errors = [_error(text, flaw) for flaw in flaws]
        return _Compiled(text, code, errors, name, _program_number(whole, offset))

    def _is_returned_into(self, text: ProgramText, calls: MacroCalls) -> bool:
        """Tell whether a program of a text, or one that it calls, returns to a block of its caller (M99 P)."""
        known = self._returns.get(id(text))
        if known is None:
            called = [text]
            numbers = called_programs(text.content, calls)
            for number in numbers or ():
                found = self.channel.sub_program(number)
                if found is not None and found is not text:
                    called.append(found)
            returns = numbers is None or any(returns_to_a_block(each.content) for each in called)
            self._returns[id(text)] = known = text, returns
        return known[1]

    def _is_plain(self, text: ProgramText, plain: bool, wanted: Special) -> bool:
        """Tell whether no line of a text is special; it is looked at in pieces, as most programs are long and plain."""
        key = (id(text), plain)
        if key in self._without:
            return True
        begin, size = 0, len(text.content)
        while begin < size:
            end = text.content.find(b"\n", begin + _PIECE_BYTES) + 1 or size
            piece = text.content[begin:end]
            if next(wanted.lines(piece.decode("latin-1"), piece.upper(), 0, len(piece)), None) is not None:
                return False
            begin = end
        self._without[key] = text
        return True

    # ------------------------------------------------------------------ what the compiler asks

    def kind(self, number: int) -> str | None:
        """Return the sort of a variable that is none of the system's, None if there is none."""
        return self.variables.kind(number)

    def has(self, number: int) -> bool:
        """Tell whether there is a system variable."""
        return self.system.has(number)

    def waits(self, number: int) -> bool:
        """Tell whether reading a system variable waits for all blocks before."""
        return self.system.waits(number)

    def bindings(self) -> dict[str, object]:
        """Return the functions and operators as compiled programs call them, and what they are set to."""
        nat = self.nat
        return {
            **names(),
            "JUMPS": self._pause_jumps,
            "f_ASIN": lambda value: asin(value, nat),
            "f_ATAN2": lambda value, below: atan2(value, below, nat),
        }


class MacroSource:
    """One execution of one program."""

    def __init__(self, language: MacroLanguage, compiled: _Compiled, arguments: Arguments | None) -> None:
        self._language = language
        self._compiled = compiled
        self._errors = list(compiled.errors)
        self._pauses = 0
        self._by_code = arguments is not None and arguments.by_code
        self._has_level = arguments is not None and arguments.values is not None
        self._outer_modals = language.modals
        self._outer_interrupt = language.interrupt_program
        self._is_modal_call = arguments is not None and arguments.modal
        self._is_interrupt = arguments is not None and arguments.interrupt
        self._closed = False
        self.main = language.channel.depth == 0
        if self._is_modal_call:
            language.modals = language.modals[:-1]
        if self._is_interrupt:
            language.modals, language.interrupt_program = (), None
        if self._by_code:
            language.codes_off += 1
        if arguments is not None and arguments.values is not None:
            language.variables.enter(arguments.values)
            language.note_level()
        self._outer_number, language.system.program_number = language.system.program_number, compiled.number
        self._inch = 1.0
        nothing: tuple[SourceItem, ...] = ()
        self._generator: Generator[Any, None, None] = (item for item in nothing)
        if compiled.code is not None:
            self._generator = self._start(compiled.code)

    def next(self) -> SourceItem | None:
        """Return what comes next, None at the end of the program.

        Raises:
            ProgramError: a statement that cannot be executed.
        """
        if self._errors:
            raise self._errors.pop(0)
        self._language.turns += 1
        try:
            item: SourceItem | None = next(self._generator, None)
        except (MacroError, ArithmeticError, TypeError, ValueError) as error:
            self._explain(error)
        if item is Pause.PAUSE:
            self._pauses += 1
            limit = self._language.longest_loop_pauses
            if limit is not None and self._pauses > limit:
                raise self._endless()
        else:
            self._pauses = 0
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
        self._generator.close()
        language = self._language
        language.system.program_number = self._outer_number
        if self._has_level:
            language.variables.leave()
        if self._by_code:
            language.codes_off -= 1
        if self._is_modal_call or self._is_interrupt:
            language.modals = self._outer_modals
        if self._is_interrupt:
            language.interrupt_program = self._outer_interrupt

    # ------------------------------------------------------------------ the program's own calls

    def _start(self, code: Code) -> Generator[Any, None, None]:
        language = self._language
        variables, system = language.variables, language.system
        common, ranges = variables.common, variables.ranges
        local = variables.local

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
            "number": _number,
            "waits": system.waits,
            "checked": checked,
            "negative": _negative,
            "adp": self._with_point,
            "alarm": _alarm,
            "stop": _stop,
            "label": _label,
            "find": self._find,
            "into_loop": _into_loop,
            "block": self._block,
            "call": self._call,
            "sub": self._sub,
            "modal": self._modal_call,
        }
        program = code.traced.load(names)["program"]
        result: Generator[Any, None, None] = program(local, common, _Host(self))
        return result

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
        code = self._compiled.code
        assert code is not None
        spec = code.blocks[index]
        following = iter(values)
        words = []
        for word in spec.words:
            if word.value is not None:
                words.append(Word(word.letter, word.value, word.at, word.point))
                continue
            value = next(following)
            if value is not None:
                words.append(Word(word.letter, _nearest(value, self.increment(word.letter)), word.at, True))
        return WordsBlock(tuple(words), spec.line, spec.offset, skip_level=spec.skip)

    def words(self, index: int, values: tuple[Value, ...]) -> Iterator[SourceItem]:
        """Give a block of words and the calls behind it, or the call that it becomes (G66.1)."""
        block = self._block(index, values)
        modals = self._language.modals
        letters: list[tuple[str, float]] = [(word.letter, word.value) for word in block.words]
        if modals and modals[-1].each:
            yield from self._each_item(modals[-1], letters, block.line, block.offset)
            return
        yield block
        yield from self._calls_behind(letters, block.line, block.offset)

    def span(self, index: int) -> Iterator[SourceItem]:
        """Give plain text line by line, with the call behind every move."""
        code = self._compiled.code
        assert code is not None
        whole = code.spans[index]
        assert isinstance(whole, TextSpan)
        channel, text = self._language.channel, self._compiled.text
        rules = channel.dialect.text_rules()
        offset, line = whole.offset, whole.line
        while offset < whole.end:
            end = min(text.next_line(offset), whole.end)
            block = scan_block(text, offset, line, rules)
            skipped = bool(block.skip_level) and self.skips(block.skip_level)
            letters = [(word.letter, word.value) for word in block.words]
            modals = self._language.modals
            if modals and modals[-1].each and not skipped:
                yield from self._each_item(modals[-1], letters, line, offset)
            else:
                yield TextSpan(offset, line, end)
                if not skipped:
                    yield from self._calls_behind(letters, line, offset)
            if self._language.pending is not None:
                return
            offset, line = end, line + 1

    def _each_item(
        self, modal: _Modal, letters: list[tuple[str, float]], line: int, offset: int
    ) -> Iterator[SourceItem]:
        """Give the call that a block becomes, with its words as arguments; a block number alone is none."""
        values: dict[int, Value] = {
            ARGUMENTS_EACH[letter]: value for letter, value in letters if letter in ARGUMENTS_EACH
        }
        if all(letter in "NO" for letter, _ in letters):
            return
        self._check_level()
        yield CallProgram(modal.program, line, offset, modal.repeats, Arguments(values, modal=True))

    def _calls_behind(self, letters: list[tuple[str, float]], line: int, offset: int) -> Iterator[SourceItem]:
        yield from self._modal_item(letters, line, offset)
        language = self._language
        if language.interrupt_program is not None and language.pending is None:
            yield Drain(line)
            if language.take_interrupt():
                self._check_level()
                arguments = Arguments({}, interrupt=True)
                yield CallProgram(language.interrupt_program, line, offset, 1, arguments)

    def _modal_item(self, letters: list[tuple[str, float]], line: int, offset: int) -> Iterator[SourceItem]:
        modal = self._language.modals[-1] if self._language.modals else None
        axes = self._language.channel.state.axis_names
        moves = any(letter in axes for letter, _ in letters)
        if (
            modal is None
            or not moves
            or any(letter == "G" and code in _NOT_A_MOVE for letter, code in letters)
        ):
            return
        self._check_level()
        yield CallProgram(
            modal.program, line, offset, modal.repeats, Arguments(dict(modal.values), modal=True)
        )

    def _check_level(self) -> None:
        if self._language.variables.level >= LEVELS:
            raise MacroError(
                f"macros are nested more than {LEVELS} deep", "Does a macro call itself?", "PS0122"
            )

    def _call(self, index: int, program: float, repeats: float, values: tuple[Value, ...]) -> CallProgram:
        code = self._compiled.code
        assert code is not None
        self._check_level()
        spec = code.calls[index]
        arguments = Arguments(dict(zip(spec.numbers, values, strict=True)), by_code=spec.by_code)
        return CallProgram(_program(program), spec.line, spec.offset, _repeats(repeats), arguments)

    def _sub(self, index: int, program: float, repeats: float) -> CallProgram:
        code = self._compiled.code
        assert code is not None
        spec = code.calls[index]
        return CallProgram(
            _program(program), spec.line, spec.offset, _repeats(repeats), Arguments(None, by_code=True)
        )

    def _modal_call(
        self, index: int, program: float, repeats: float, values: tuple[Value, ...], each: bool
    ) -> _Modal:
        code = self._compiled.code
        assert code is not None
        numbers = code.calls[index].numbers
        if len(self._language.modals) >= LEVELS:
            raise MacroError(f"more than {LEVELS} modal calls", "Cancel one with G67 first.", "PS0122")
        return _Modal(_program(program), _repeats(repeats), dict(zip(numbers, values, strict=True)), each)

    def put_out(self, index: int, values: tuple[float, ...], line: int) -> None:
        """Write an output to the device."""
        code = self._compiled.code
        assert code is not None
        self._language.output.write(code.outputs[index], values, line)

    def _find(self, number: int, offset: int) -> tuple[int, int]:
        code = self._compiled.code
        assert code is not None
        label = code.shape.find(number, offset)
        if label is None:
            raise MacroError(
                f"there is no block N{number} in this program", "Check the block number.", "PS0128"
            )
        return label.region.number, label.region.targets[label.part]

    # ------------------------------------------------------------------ errors

    def _endless(self) -> ProgramError:
        frame = getattr(self._generator, "gi_frame", None)
        code = self._compiled.code
        assert code is not None
        at = 0 if frame is None else code.traced.places[frame.f_lineno - 1]
        return _error(
            self._compiled.text,
            Flaw(at, "this loop goes on without end", "Nothing that it waits for can change here."),
        )

    def _explain(self, error: Exception) -> NoReturn:
        code = self._compiled.code
        assert code is not None
        known = {self._compiled.name: code.traced}
        frame: Frame[int] | None = frame_of(error, known.get)
        if frame is None:
            raise error
        what, hint, number = _meaning(error)
        raise _error(self._compiled.text, Flaw(frame.place, what, hint, code=number)) from error


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
        self._increment = source.increment

    @property
    def plain(self) -> bool:
        """Whether blocks go out as they are: nothing is called behind them."""
        return not self._language.modals and self._language.interrupt_program is None

    def push(self, modal: _Modal) -> None:
        """Call a macro behind every move, or for every block (G66, G66.1)."""
        self._language.modals += (modal,)

    def cancel(self) -> None:
        """Cancel the last modal call (G67)."""
        self._language.modals = self._language.modals[:-1]

    def interrupted_by(self, program: float | None) -> None:
        """Let the interrupt signal call a program, or none (M96, M97)."""
        self._language.interrupt_program = None if program is None else _program(program)

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
        return _nearest(value, self._increment("X"))


def _nearest(value: float, increment: float) -> float:
    """Return the nearest multiple of an increment, as it would be written in decimal digits."""
    if abs(value) > 1e12:
        return value
    per_unit = round(1.0 / increment)
    return rounded(value * per_unit + (1e-9 if value >= 0.0 else -1e-9)) / per_unit


def _number(value: float) -> int:
    if not -0.5 < value < 1e6:
        raise MacroError(f"there is no variable #{value:g}", "See the table of variables.", "PS0115")
    return int(rounded(value))


def _negative(value: Value) -> Value:
    return None if value is None else -value


def _alarm(value: float, text: str) -> NoReturn:
    if not 0 <= value <= _LARGEST_ALARM:
        raise MacroError(f"#3000={value:g}: alarms are numbered 0 to 999", "Write 0 to 999.", "PS0119")
    raise MacroError(
        text or f"macro alarm {int(value)}",
        "The program has raised this alarm.",
        f"MC{_ALARM_BASE + int(value)}",
    )


def _stop(value: float, line: int, offset: int, text: str) -> WordsBlock:
    return WordsBlock((Word("M", 0.0, offset, False),), line, offset, text or f"macro message {value:g}")


def _label(value: float) -> int:
    if not 0 <= value <= LARGEST_LABEL:
        raise MacroError(f"{value:g} is no block number", "Check the value.", "PS0128")
    return int(rounded(value))


def _into_loop(number: int) -> NoReturn:
    raise MacroError(
        f"block N{number} is inside a loop", "Jump out of loops or inside them, never into one.", "PS0128"
    )


def _program(value: float) -> int:
    number = rounded(value)
    if not 0 < number <= LARGEST_LABEL:
        raise MacroError(f"{value:g} is no program number", "Check P.", "PS0076")
    return int(number)


def _repeats(value: float) -> int:
    number = rounded(value)
    if not 0 <= number <= 9999:
        raise MacroError(f"{value:g} is no number of repetitions", "Write L1 to L9999.", "PS0119")
    return int(number)


def _meaning(error: Exception) -> tuple[str, str, str]:
    if isinstance(error, MacroError):
        return error.what, error.hint, error.code
    if isinstance(error, ZeroDivisionError):
        return "a division by zero", "Check the divisor.", "PS0112"
    return "this cannot be calculated", "Check the values.", "PS0119"


def _error(text: ProgramText, flaw: Flaw) -> ProgramError:
    hint = flaw.hint or "A block holds words like X12.5 or X#1, or a statement; remarks stand in a comment."
    return ProgramError(flaw.what, code=flaw.code, position=text.position(flaw.at), hint=hint)


def _program_number(text: str, offset: int) -> int:
    digits = text[offset : offset + 200].lstrip("% \t\r\n:Oo")[:8]
    number = ""
    for char in digits:
        if not char.isdigit() or not char.isascii():
            break
        number += char
    return int(number) if number else 0
