"""One run of a control file's macros: the state from block to block, and the way from an error back to its macro."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any, NoReturn

import numpy as np
import numpy.typing as npt

from polycnc.errors import ProgramError, SourcePosition, UsageError
from polycnc.language import frame_of
from polycnc.post.macros._compile import ENDS, START_WORDS, Style, TracedMacro
from polycnc.post.macros._events import MACROS
from polycnc.post.macros._format import decimal, plain
from polycnc.post.macros._rows import Rows, SteadyLine
from polycnc.post.macros._symbols import Symbols

Write = Callable[[str], object]
Locate = Callable[[str, int, int], SourcePosition]
Value = float | str
_NOTHING: Mapping[str, Value] = {}


class MacroRun:
    """Call macros for one output program; `ControlFile.start` makes it.

    Modes, last outputs, variables and the sequence number last from call to call, over all paths of the program.
    """

    __slots__ = (
        "_along",
        "_known",
        "_last",
        "_locate",
        "_macros",
        "_number",
        "_steady",
        "_style",
        "_symbols",
        "_texts",
        "_traced",
        "_values",
    )

    def __init__(
        self, macros: Mapping[str, TracedMacro], symbols: Symbols, style: Style, write: Write, locate: Locate
    ) -> None:
        self._symbols = symbols
        self._locate = locate
        self._traced = {each.code.co_filename: (name, each) for name, each in macros.items()}
        self._values: dict[str, Value] = dict(symbols.values)
        self._known = len(self._values)
        self._last: list[float | None] = [None] * len(symbols.variables)
        self._texts: list[str | None] = [None] * len(symbols.variables)
        self._number = [style.number_start]
        self._style = style
        state = (
            self._values,
            [0] * len(symbols.groups),
            self._last,
            self._texts,
            self._number,
            write,
        )
        self._macros: dict[str, Callable[[], None] | None] = dict.fromkeys(MACROS)
        self._along: dict[str, Callable[[Iterable[Sequence[float]], float, float], Iterator[None]]] = {}
        self._steady: Callable[[], list[SteadyLine] | None] | None = None
        for name, traced in macros.items():
            self._macros[name], along, steady = traced.load(_SCOPE)["build"](*state)
            if along is not None:
                self._along[name] = along
                self._steady = steady

    def call(self, macro: str, words: Mapping[str, Value] = _NOTHING) -> None:
        """Set the words given, then run a macro; each block goes to `write` with a line feed at its end.

        A macro that the control file does not have writes nothing; the words are set all the same. Words are
        spelled in capitals. Numbers are finite; a text has one line.

        Raises:
            UsageError: There is no such macro, or no such word that holds a text.
            ProgramError: The macro divides by zero, takes the root of a negative number, or the like.
        """
        self._values.update(words)
        if len(self._values) != self._known:
            self._check_names(words)
        try:
            function = self._macros[macro]
        except KeyError:
            raise UsageError(
                f"there is no macro '{macro}'", hint=f"macros: {', '.join(sorted(MACROS))}"
            ) from None
        if function is None:
            return
        try:
            function()
        except (ArithmeticError, ValueError, TypeError) as error:
            self._explain(error, words)

    def call_along(self, rows: Iterable[Sequence[float]], feed: float, mode: float) -> Iterator[None]:
        """Run LINEAR once for each row, as `call` does with its numbers as X, Y, Z and STARTX, STARTY, STARTZ.

        A row has all six if any macro names one of the latter, else three; F and FEEDMODE stay the same. Yields after
        each.

        Raises:
            ProgramError: The macro divides by zero, takes the root of a negative number, or the like.
        """
        try:
            yield from self._along["LINEAR"](rows, feed, mode)
        except (ArithmeticError, ValueError, TypeError) as error:
            self._explain(error, _NOTHING)

    def rows(self) -> Rows | None:
        """Return what writes LINEAR for many rows at once, if nothing but where they end would change any more."""
        try:
            lines = self._steady() if self._steady is not None else None
        except (ArithmeticError, ValueError, TypeError):
            return None  # the macro itself says what is wrong
        return None if lines is None else Rows.of(lines, self._symbols.variables, self._style)

    def write_rows(
        self, rows: Rows, ends: npt.NDArray[np.float64], behind: npt.NDArray[np.int64]
    ) -> tuple[str, int, int]:
        """Write LINEAR for the rows of `ends`, [rows, 3 or 6], as far as that goes.

        `behind` gets how many blocks there are after each row, from none.

        Returns:
            The blocks, their number, and how many rows are done.
        """
        lasts = {
            name: None if self._texts[each.memory] is None else self._last[each.memory]
            for name, each in rows.variables.items()
        }
        text, blocks, done, number = rows.write(ends, lasts, self._number[0], behind)
        if done:
            self._number[0] = number
            self._values.update(zip((*ENDS, *START_WORDS), ends[done - 1].tolist(), strict=False))
            for name, variable in rows.variables.items():
                if variable.modal:
                    value = float(ends[done - 1, ENDS.index(name)])
                    self._last[variable.memory] = value
                    self._texts[variable.memory] = self._style.before(variable) + variable.format.text(value)
        return text, blocks, done

    def keep(self, words: Mapping[str, Value]) -> None:
        """Set words for the macros that follow."""
        self._values.update(words)
        self._known = len(self._values)

    def forget(self, names: Iterable[str]) -> None:
        """Let the next output of function variables not be omitted, as `&X&` does."""
        for name in names:
            if variable := self._symbols.variables.get(name):
                self._last[variable.memory] = self._texts[variable.memory] = None

    def formatted(self, name: str, value: float) -> str:
        """Return a number in the format of a function variable, as `$T$` would write it.

        Raises:
            UsageError: The control file has no such function variable.
        """
        variable = self._symbols.variables.get(name)
        if variable is None:
            raise UsageError(f"the control file has no function variable {name}")
        return variable.format.text(value)

    def _check_names(self, words: Mapping[str, Value]) -> None:
        """Check names that no macro uses: they have no effect, but a misspelled one should not go unnoticed."""
        for name in words:
            if name != name.upper() or not name.isidentifier():
                raise UsageError(
                    f"'{name}' is not a word", hint="words are spelled in capitals, like X or COMMENT"
                )
        self._known = len(self._values)

    def _explain(self, error: Exception, words: Mapping[str, Value]) -> NoReturn:
        """Raise what stands after an error in compiled code, at its place in the macro; others go on as they are."""
        if isinstance(error, UsageError):
            raise error
        found = self._place(error)
        if found is None:
            raise error
        for name, value in words.items():
            if isinstance(value, str) and not self._symbols.is_text(name):
                raise UsageError(f"the word {name} is a number, not {value!r}") from error
        macro, line, column = found
        what, hint = _meaning(error)
        raise ProgramError(
            f"[nc_macros] {macro}, line {line}: {what}", position=self._locate(macro, line, column), hint=hint
        ) from error

    def _place(self, error: Exception) -> tuple[str, int, int] | None:
        """Return macro, line and column that an error stems from; None if it is not the macro's."""
        frame = frame_of(error, lambda name: self._traced[name][1] if name in self._traced else None)
        if frame is None:
            return None
        if frame.line.lstrip().startswith("write(") and not isinstance(error, UnicodeEncodeError):
            return None
        return (self._traced[frame.name][0], *frame.place)


def _meaning(error: Exception) -> tuple[str, str]:
    match error:
        case ZeroDivisionError():
            return "division by zero", "test the divisor with IF before"
        case UnicodeEncodeError():
            return (
                f"the character '{error.object[error.start]}' cannot be written in {error.encoding}",
                "use other characters, or another 'encoding' in the parameters",
            )
        case OverflowError():
            return "the number is not finite", "look at what the expression is made of"
        case _:
            return "a function has no value there", "test its argument with IF before"


def _text(name: str, text: Value) -> str:
    """Return the text of a word, which stays within its block.

    Raises:
        UsageError: It has more than one line.
    """
    if not isinstance(text, str):
        raise UsageError(f"the word {name} is a text, not {text!r}")
    if "\n" in text or "\r" in text:
        raise UsageError(f"the text of {name} has more than one line", hint="give each line by itself")
    return text


def _dms(degrees: float) -> float:
    """Return an angle packed as degrees, two digits of minutes, two digits of seconds: 12.5 becomes 12.3."""
    seconds = round(abs(degrees) * 3600.0, 6)
    minutes, seconds = divmod(seconds, 60.0)
    whole, minutes = divmod(minutes, 60.0)
    return math.copysign(whole + minutes / 100.0 + seconds / 10000.0, degrees)


def _adms(packed: float) -> float:
    """Return the degrees of a packed angle: 12.3 becomes 12.5."""
    digits = round(abs(packed) * 10000.0, 6)
    minutes, seconds = divmod(digits, 100.0)
    whole, minutes = divmod(minutes, 100.0)
    return math.copysign(whole + minutes / 60.0 + seconds / 3600.0, packed)


_SCOPE: dict[str, Any] = {
    "SIN": math.sin,
    "COS": math.cos,
    "TAN": math.tan,
    "ASIN": math.asin,
    "ACOS": math.acos,
    "ATAN": math.atan,
    "DEG": math.degrees,
    "RAD": math.radians,
    "SQRT": math.sqrt,
    "EXP": math.exp,
    "LOG10": math.log10,
    "LOG": math.log,
    "DABS": abs,
    "abs": abs,
    "OverflowError": OverflowError,
    "DMS": _dms,
    "ADMS": _adms,
    "text": _text,
    "plain": plain,
    "decimal": decimal,
}
"""What compiled macros may call; angles of SIN, COS, TAN, ASIN, ACOS, ATAN are in radians (Manual 001, 6)."""
