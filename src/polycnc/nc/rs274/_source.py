"""One execution of a program of RS274/NGC: what its Python gives, as items of the channel."""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import Protocol, TypeAlias

from polycnc.errors import ProgramError, UsageError
from polycnc.language import Traced, frame_of, line_of, names_of
from polycnc.machine import Machine
from polycnc.nc.records._block_records import Call
from polycnc.nc.rs274 import _inputs as inputs
from polycnc.nc.rs274._functions import FUNCTIONS, NumberError
from polycnc.nc.rs274._kept_modes import Words, modes_of, words_back
from polycnc.nc.rs274._parameters import LAST_LOCAL, Parameters
from polycnc.nc.rs274._profile import profile_of
from polycnc.nc.rs274._program import Program, numbered_label
from polycnc.nc.rs274._saved import SavedLevel, SavedProgram
from polycnc.nc.rs274._texts import text_functions
from polycnc.nc.sources._block_source import (
    Drain,
    EndSource,
    Pause,
    SourceItem,
    TextSpan,
    WordsBlock,
)
from polycnc.nc.text._program import ProgramText
from polycnc.nc.text._scan_plain import Block, Word

MOST_LEVELS = 10
"""How deep calls may be nested. Source: LinuxCNC `interp_internal.hh`, INTERP_SUB_ROUTINE_LEVELS."""
LONGEST_LOOP_PAUSES = 2_500
_PAUSE_CALLS = 100
_LARGEST = 1e12
_PARAMETERS = ("L", "N")
_PROBLEMS = (NumberError, KeyError, OverflowError, ValueError, UsageError)
Suspended: TypeAlias = Generator[
    "SourceItem | CallRequest | ModesRequest | WaitRequest", None, "float | None"
]
ValuedWords: TypeAlias = tuple[tuple[str, float, int], ...]
Function: TypeAlias = Callable[[list[float], dict[str, float]], Suspended]


class Owner(Protocol):
    """What a source needs of its language."""

    parameters: Parameters
    fast_forward: bool

    @property
    def machine(self) -> Machine:
        """The machine, with its inputs and its clock."""
        ...

    def skips(self, level: int) -> bool:
        """Tell whether lines with a skip mark of this number are left out."""
        ...

    def file_of(self, name: str, main: ProgramText) -> Program | None:
        """Return the translated file of a sub-program, None if there is none."""
        ...


@dataclass(frozen=True, slots=True)
class CallRequest:
    """What an O-word asks for: the program of a file, its sub-program, the arguments, and the line of the call.

    A sub-program of M98 `shares` the numbered parameters of what calls it.
    """

    program: Program
    label: str
    arguments: tuple[float, ...]
    line: int
    shares: bool = False


@dataclass(frozen=True, slots=True)
class ModesRequest:
    """What M70 to M73 ask for, on a line and at a byte of the text."""

    code: int
    line: int
    offset: int


class WaitRequest(Enum):
    """What M66 asks for until its input is as it wants it: to be asked again in the next cycle."""

    WAIT = "wait"


@dataclass(slots=True)
class _Level:
    """A program or sub-program under way: its own parameters, and the generator that gives its items.

    `kept` are the modes that M70 or M73 has kept; with `goes_back` they are in force again when it returns. A level
    that `shares` has the numbered parameters of the one before.
    """

    program: Program
    label: str
    numbered: list[float]
    named: dict[str, float]
    calls: tuple[Call, ...]
    run: Suspended
    kept: tuple[Words, ...] = ()
    goes_back: ModesRequest | None = None
    shares: bool = False


class RunningProgram:
    """Execute one program: its Python runs until it gives an item."""

    def __init__(self, owner: Owner, program: Program) -> None:
        self._owner = owner
        self._main = program
        self._names: dict[str, object] = {
            **FUNCTIONS,
            "V": owner.parameters.common,
            "get": owner.parameters.get,
            "put": owner.parameters.put,
            "name": owner.parameters.name,
            "named": owner.parameters.named,
            "exists": owner.parameters.exists,
            "exists_number": owner.parameters.exists_number,
            "PAUSE": Pause.PAUSE,
            "skips": owner.skips,
            "span": self._span,
            "block": self._block,
            "profile": lambda words: profile_of(
                self._levels[-1].program.functions, self._function, owner.parameters.state, words
            ),
            "says": lambda line, offset, text: self._block(line, offset, (), text),
            **text_functions(owner.parameters),
            "times": lambda number: max(0, round(number)),
            "label": lambda number: str(round(number)),
            "call": self._asked,
            "call_number": self._asked_number,
            "whole": _whole,
            "drain": self._drain,
            "asked": lambda words: inputs.asked(owner.machine, words),
            "begun": lambda wait: inputs.begun(owner.machine, wait),
            "look": self._look,
            "WAIT": WaitRequest.WAIT,
            "modes": ModesRequest,
        }
        self._functions: dict[int, tuple[Traced[int], Function]] = {}
        self._pauses = 0
        self._calls = 0  # without a block since the last pause
        self._over = False
        self._levels: list[_Level] = []
        self._back: list[WordsBlock] = []
        self._begin(program, "", [0.0] * (LAST_LOCAL + 1), ())

    # ------------------------------------------------------------------ what the channel asks

    def next(self) -> SourceItem | None:
        """Return what comes next, None at the end of the program.

        Raises:
            ProgramError: a statement that cannot be executed.
        """
        if self._over:
            return EndSource.END
        item: SourceItem | CallRequest | ModesRequest | WaitRequest | None = None
        while item is None or isinstance(item, CallRequest | ModesRequest | WaitRequest):
            item = None
            if self._back:
                return self._back.pop(0)
            try:
                item = next(self._levels[-1].run)
            except StopIteration as ended:
                if len(self._levels) == 1:
                    self._over = True
                    return None
                level = self._levels[-1]
                if level.goes_back is not None:
                    self._restore_modes(level, level.goes_back)
                self._return(ended.value)
            except _PROBLEMS as error:
                raise self._refused(error) from None
            if item is WaitRequest.WAIT:
                self._pauses = 0  # this one ends by itself
                return Pause.PAUSE
            if isinstance(item, CallRequest):
                self._enter(item)
                self._calls += 1
                if self._calls >= _PAUSE_CALLS:
                    item = Pause.PAUSE
            elif isinstance(item, ModesRequest):
                self._keep(item)
        self._pauses = self._pauses + 1 if item is Pause.PAUSE else 0
        self._calls = 0
        if self._pauses > LONGEST_LOOP_PAUSES:
            endless = NumberError("a loop goes round without a block", "Add what ends it.")
            try:
                self._levels[-1].run.throw(endless)  # it comes back with the place of the loop
            except NumberError as error:
                raise self._refused(error) from None
        return item

    def leave(self) -> bool:
        """Leave nothing: M99 has no meaning for what an O-word called."""
        return False

    def failed(self) -> None:
        """Ask for nothing more."""
        self._over = True

    def close(self) -> None:
        """End the program."""
        for level in self._levels:
            level.run.close()
        self._owner.parameters.level = 0

    # ------------------------------------------------------------------ levels

    def _begin(self, program: Program, label: str, numbered: list[float], calls: tuple[Call, ...]) -> None:
        named: dict[str, float] = {}
        run = self._function(program.functions[label])(numbered, named)
        self._levels.append(_Level(program, label, numbered, named, calls, run))

    def _function(self, traced: Traced[int]) -> Function:
        if id(traced) not in self._functions:
            self._functions[id(traced)] = traced, traced.load(self._names)["program"]
        return self._functions[id(traced)][1]

    def _enter(self, asked: CallRequest) -> None:
        caller = self._levels[-1]
        numbered = [0.0, *asked.arguments, *[0.0] * (LAST_LOCAL - len(asked.arguments))]
        calls = (*caller.calls, Call(caller.program.text.name, asked.line, 0))
        self._owner.parameters.level += 1
        self._begin(asked.program, asked.label, caller.numbered if asked.shares else numbered, calls)
        self._levels[-1].shares = asked.shares

    def _return(self, value: float | None) -> None:
        level = self._levels.pop()
        parameters = self._owner.parameters
        parameters.level -= 1
        if level.shares:
            return
        parameters.names["_value"] = 0.0 if value is None else value
        parameters.names["_value_returned"] = float(value is not None)

    def _keep(self, asked: ModesRequest) -> None:
        """Keep the modes in force (M70, M73), forget them (M71), or put them in force again (M72).

        Raises:
            ProgramError: there are none, or they cannot be in force again.
        """
        level = self._levels[-1]
        if asked.code == 72:
            self._restore_modes(level, asked)
            return
        level.kept = () if asked.code == 71 else modes_of(self._owner.parameters.state)
        level.goes_back = asked if asked.code == 73 else None

    def _restore_modes(self, level: _Level, asked: ModesRequest) -> None:
        text = level.program.text
        try:
            if not level.kept:
                raise NumberError("no modes have been kept", "Write M70 before M72, in the same sub-program.")
            blocks = words_back(level.kept, self._owner.parameters.state)
        except NumberError as error:
            self._over = True
            raise ProgramError(error.what, position=text.position(asked.offset), hint=error.hint) from None
        for words in blocks:
            made = tuple(Word(letter, value, asked.offset, True) for letter, value in words)
            self._back.append(WordsBlock(made, asked.line, asked.offset, text=text, calls=level.calls))

    # ------------------------------------------------------------------ where it stands

    def saved(self) -> SavedProgram:
        """Return where the program stands."""
        levels = tuple(
            SavedLevel(
                level.program.text,
                level.program.offset,
                level.label,
                tuple(level.numbered),
                dict(level.named),
                level.calls,
                line_of(level.run),
                {name: value for name, value in names_of(level.run).items() if name not in _PARAMETERS},
                level.kept,
                None if (asked := level.goes_back) is None else (asked.code, asked.line, asked.offset),
                level.shares,
            )
            for level in self._levels
        )
        back = tuple(
            (tuple((w.letter, w.value, w.place) for w in each.words), each.line, each.offset, each.calls)
            for each in self._back
        )
        return SavedProgram(levels, self._pauses, self._over, back, self._calls)

    def go_to(
        self, saved: SavedProgram, codes: Sequence[tuple[Program, Traced[int] | None]]
    ) -> RunningProgram:
        """Stand where another execution stood; `codes` are the programs of its levels, and what `standing` has made."""
        self.close()
        self._levels.clear()
        for level, (program, traced) in zip(saved.levels, codes, strict=True):
            numbered = self._levels[-1].numbered if level.shares else list(level.numbered)
            self._begin(program, level.label, numbered, level.calls)
            made = self._levels[-1]
            made.shares = level.shares
            made.named.update(level.named)
            made.kept = level.kept
            made.goes_back = None if level.goes_back is None else ModesRequest(*level.goes_back)
            if traced is not program.functions[level.label]:
                made.run.close()
                if traced is not None:
                    made.run = traced.load(self._names)["program"](made.numbered, made.named, level.names)
                    next(made.run)
        self._pauses, self._over, self._calls = saved.pauses, saved.over, saved.calls
        text = self._levels[-1].program.text
        self._back = [
            WordsBlock(tuple(Word(*each, True) for each in words), line, offset, text=text, calls=calls)
            for words, line, offset, calls in saved.back
        ]
        return self

    # ------------------------------------------------------------------ what the Python calls

    def _span(self, offset: int, line: int, end: int) -> TextSpan:
        level = self._levels[-1]
        return TextSpan(offset, line, end, level.program.text, level.calls)

    def _block(
        self,
        line: int,
        offset: int,
        words: ValuedWords,
        message: str,
        profile: tuple[Block, ...] | None = None,
    ) -> WordsBlock:
        level = self._levels[-1]
        return WordsBlock(
            _made(words), line, offset, message, text=level.program.text, calls=level.calls, profile=profile
        )

    def _drain(self, line: int) -> Drain:
        level = self._levels[-1]
        return Drain(line, level.program.text, level.calls)

    def _look(self, wait: inputs.Looking) -> inputs.Looking | None:
        """Look at the input of an M66; return the wait as it goes on, None where it has its answer."""
        owner = self._owner
        found = inputs.look(owner.machine, wait, at_once=owner.fast_forward)
        if isinstance(found, float):
            owner.parameters.answer(found)
            return None
        return found

    def _asked(self, label: str, arguments: tuple[float, ...], line: int) -> CallRequest:
        program = self._program_with(label, label) if label else None
        if program is None:
            raise NumberError(
                f"there is no sub-program O<{label}>",
                f"Write O<{label}> SUB in this file, or put it into {label}.ngc beside the program or in --root.",
            )
        return CallRequest(program, label, arguments, line)

    def _asked_number(self, number: int, line: int) -> CallRequest:
        label = numbered_label(str(number))
        program = self._program_with(label, str(number))
        if program is None:
            raise NumberError(
                f"there is no sub-program O{number} that ends with M99",
                f"Write O{number} and M99 in lines of their own, here or in {number}.ngc beside the program.",
            )
        return CallRequest(program, label, (), line, shares=True)

    def _program_with(self, label: str, file: str) -> Program | None:
        """Return the program that has a sub-program: this one, the main one, or that of a file; None if none has.

        Raises:
            NumberError: calls are nested too deep.
        """
        level = self._levels[-1]
        found = [each for each in (level.program, self._main) if label in each.functions]
        program = found[0] if found else self._owner.file_of(file, self._main.text)
        if program is None or label not in program.functions:
            return None
        if len(level.calls) >= MOST_LEVELS:
            raise NumberError(
                f"sub-programs are nested more than {MOST_LEVELS} deep", "Does one call itself?"
            )
        return program

    def _refused(self, error: Exception) -> ProgramError:
        """Return an error with the place in the program that it came from; nothing more is asked for."""
        self._over = True
        traced = {
            each.name: (each, level.program)
            for level in self._levels
            for each in level.program.functions.values()
        }
        frame = frame_of(error, lambda name: traced[name][0] if name in traced else None)
        position = None if frame is None else traced[frame.name][1].text.position(frame.place)
        match error:
            case NumberError() | UsageError():
                return ProgramError(error.what, position=position, hint=error.hint)
            case KeyError():
                return ProgramError(
                    f"#<{error.args[0]}> has no value", position=position, hint="Set it first."
                )
        return ProgramError("the number is too large", position=position, hint="Look at the expression.")


def _made(words: ValuedWords) -> tuple[Word, ...]:
    for letter, value, _ in words:
        if not abs(value) < _LARGEST:
            raise NumberError(f"the number {value:g} of {letter} is too large")
    return tuple(Word(letter, value, place, True) for letter, value, place in words)


def _whole(**words: float) -> int:
    """Return the number of a word, which is a whole one from 0 up."""
    ((letter, value),) = words.items()
    if not (0.0 <= value < _LARGEST and value == round(value)):
        raise NumberError(f"{letter}{value:g} is no whole number from 0 up", "Look at the expression.")
    return round(value)


def sub_program_file(name: str, main: ProgramText, folders: tuple[Path, ...]) -> Path | None:
    """Return the file of a sub-program beside the main program, or in folders; None if there is none."""
    if not name or "/" in name or "\\" in name or name.startswith(".") or "\0" in name:
        return None
    beside = Path(main.name).parent if "\n" not in main.name else Path()
    for folder in (beside, *folders):
        path = folder / f"{name}.ngc"
        try:
            if path.is_file():
                return path
        except (OSError, ValueError):
            return None
    return None
