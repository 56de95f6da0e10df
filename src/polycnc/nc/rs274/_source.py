"""One execution of a program of RS274/NGC: what its Python gives, as items of the channel."""

from __future__ import annotations

from collections.abc import Generator
from pathlib import Path
from typing import Any, Protocol, TypeAlias

from polycnc.errors import ProgramError, UsageError
from polycnc.language import frame_of
from polycnc.nc.records._block_records import Call
from polycnc.nc.rs274._functions import FUNCTIONS, NumberError
from polycnc.nc.rs274._parameters import Parameters
from polycnc.nc.rs274._program import Program
from polycnc.nc.sources._block_source import EndSource, Pause, SourceItem, TextSpan, WordsBlock
from polycnc.nc.text._program import ProgramText
from polycnc.nc.text._scan_plain import Word

MOST_LEVELS = 10
"""How deep calls may be nested. Source: LinuxCNC `interp_internal.hh`, INTERP_SUB_ROUTINE_LEVELS."""
LONGEST_LOOP_PAUSES = 2_500
_LARGEST = 1e12
_Run: TypeAlias = Generator[SourceItem, None, "float | None"]


class Owner(Protocol):
    """What a source needs of its language."""

    parameters: Parameters

    def skips(self, level: int) -> bool:
        """Tell whether lines with a skip mark of this number are left out."""
        ...

    def file_of(self, name: str, main: ProgramText) -> Program | None:
        """Return the translated file of a sub-program, None if there is none."""
        ...


class RunningProgram:
    """Execute one program: its Python runs until it gives an item."""

    def __init__(self, owner: Owner, program: Program) -> None:
        self._owner = owner
        self._main = program
        self._scopes: dict[str, dict[str, Any]] = {}
        self._programs = {program.text.name: program}
        self._program = program
        self._calls: tuple[Call, ...] = ()
        self._pauses = 0
        self._over = False
        self._run: _Run = self._scope(program)["main"]([0.0] * 31, {})

    # ------------------------------------------------------------------ what the channel asks

    def next(self) -> SourceItem | None:
        """Return what comes next, None at the end of the program.

        Raises:
            ProgramError: a statement that cannot be executed.
        """
        if self._over:
            return EndSource.END
        try:
            item = next(self._run)
        except StopIteration:
            self._over = True
            return None
        except (NumberError, KeyError, OverflowError, ValueError, RecursionError, UsageError) as error:
            self._over = True
            raise self._placed(error) from None
        self._pauses = self._pauses + 1 if item is Pause.PAUSE else 0
        if self._pauses > LONGEST_LOOP_PAUSES:
            self._over = True
            endless = NumberError("a loop goes round without a block", "Add what ends it.")
            try:
                self._run.throw(endless)  # it comes back with the place of the loop
            except NumberError as error:
                raise self._placed(error) from None
        return item

    def leave(self) -> bool:
        """Leave nothing: M99 has no meaning for what an O-word called."""
        return False

    def failed(self) -> None:
        """Ask for nothing more."""
        self._over = True

    def close(self) -> None:
        """End the program."""
        self._run.close()
        self._owner.parameters.level = 0

    # ------------------------------------------------------------------ what the Python calls

    def _scope(self, program: Program) -> dict[str, Any]:
        name = program.text.name
        if name not in self._scopes:
            parameters = self._owner.parameters
            self._programs[name] = program
            self._scopes[name] = program.traced.load(
                {
                    **FUNCTIONS,
                    "V": parameters.common,
                    "get": parameters.get,
                    "put": parameters.put,
                    "name": parameters.name,
                    "named": parameters.named,
                    "exists": parameters.exists,
                    "PAUSE": Pause.PAUSE,
                    "skips": self._owner.skips,
                    "span": self._span,
                    "block": self._block,
                    "says": self._says,
                    "six": "{:f}".format,
                    "times": lambda number: range(max(0, round(number))),
                    "label": lambda number: str(round(number)),
                    "call": self._call,
                }
            )
        return self._scopes[name]

    def _span(self, offset: int, line: int, end: int) -> TextSpan:
        return TextSpan(offset, line, end, self._program.text, self._calls)

    def _block(
        self, line: int, offset: int, words: tuple[tuple[str, float, int], ...], message: str
    ) -> WordsBlock:
        for letter, value, _ in words:
            if not abs(value) < _LARGEST:
                raise NumberError(f"the number {value:g} of {letter} is too large")
        made = tuple(Word(letter, value, place, True) for letter, value, place in words)
        return WordsBlock(made, line, offset, message, text=self._program.text, calls=self._calls)

    def _says(self, line: int, offset: int, text: str) -> WordsBlock:
        return WordsBlock((), line, offset, text, text=self._program.text, calls=self._calls)

    def _call(self, label: str, arguments: tuple[float, ...], line: int) -> _Run:
        owner, caller, calls = self._owner, self._program, self._calls
        program = caller if label in caller.subs else self._main if label in self._main.subs else None
        program = program or owner.file_of(label, self._main.text)
        if program is None or label not in program.subs:
            raise NumberError(
                f"there is no sub-program O<{label}>",
                f"Write O<{label}> SUB in this file, or put it into {label}.ngc beside the program or in --root.",
            )
        if len(calls) >= MOST_LEVELS:
            raise NumberError(
                f"sub-programs are nested more than {MOST_LEVELS} deep", "Does one call itself?"
            )
        parameters = owner.parameters
        frame = [0.0, *arguments, *[0.0] * (30 - len(arguments))]
        self._program, self._calls = program, (*calls, Call(caller.text.name, line, 0))
        parameters.level += 1
        value = yield from self._scope(program)[program.subs[label]](frame, {})
        parameters.level -= 1
        self._program, self._calls = caller, calls
        parameters.names["_value"] = 0.0 if value is None else value
        parameters.names["_value_returned"] = float(value is not None)
        return None

    def _placed(self, error: Exception) -> ProgramError:
        """Return an error with the place in the program that it came from."""
        traced = {each.traced.name: each for each in self._programs.values()}
        frame = frame_of(error, lambda name: traced[name].traced if name in traced else None)
        position = None if frame is None else traced[frame.name].text.position(frame.place)
        match error:
            case NumberError():
                return ProgramError(error.what, position=position, hint=error.hint)
            case KeyError():
                return ProgramError(
                    f"#<{error.args[0]}> has no value", position=position, hint="Set it first."
                )
            case RecursionError():
                return ProgramError("the program is nested too deeply", position=position, hint="Split it.")
            case UsageError():
                return ProgramError(error.what, position=position, hint=error.hint)
        return ProgramError("the number is too large", position=position, hint="Look at the expression.")


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
