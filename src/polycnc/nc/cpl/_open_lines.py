"""NC blocks in which single variables stand for numbers, like X[A]: they stay text, read by the control in pieces.

No statement is made of them: what a word is worth is asked for when its block is prepared. Permanent variables are
left to statements, as others than the program may write them at any time.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from polycnc.errors import ProgramError
from polycnc.language import Flaw, Source
from polycnc.nc.cpl._faults import Fault
from polycnc.nc.cpl._lexicon import RESERVED
from polycnc.nc.cpl._numbers import not_assigned
from polycnc.nc.cpl._syntax import Name, NcLine
from polycnc.nc.cpl._variables import Variable, variable_at

_B = r"[ \t]*+"
_DIGITS = r"[+-]?[0-9]{1,8}+"
_NAMED = r"\[#?[A-Z_][A-Z0-9_]*+[%!]?\]"
_WORD = rf"[GMST]{_B}{_DIGITS}(?:\.[0-9]{{0,7}}+)?+|[A-FH-LQRU-Z]{_B}(?:{_DIGITS}\.[0-9]{{0,7}}+|{_NAMED})"
_LINE = re.compile(
    rf"{_B}(?:N{_B}[0-9]{{1,8}}+)?(?:{_B}(?:{_WORD})(?![0-9.\[]))++{_B}", re.IGNORECASE | re.ASCII
)
_NAME = re.compile(r"\[([^\]]*)\]")
_WORDS = re.compile(rf"([A-Za-z]){_B}(?:(\[[^\]]*\])|([+-]?[0-9.]++))")
_NUMBERS = ("I", "R", "D")


def open_line(text: str, begin: int, end: int, line: int) -> NcLine | None:
    """Return the NC block at `text[begin:end]` with the variables in it; None if it is no such block."""
    if text.find("[", begin, end) < 0 or _LINE.fullmatch(text, begin, end) is None:
        return None
    names: dict[Variable, Name] = {}
    for found in _NAME.finditer(text, begin, end):
        word, at = found[1].upper(), found.start(1)
        if word in RESERVED:
            return None
        variable = variable_at(at, word)
        if variable.scope == "permanent" or variable.kind not in _NUMBERS:
            return None
        names.setdefault(variable, Name(at, variable))
    return NcLine(begin, line, line, names)


class BracketWords:
    """What words like X[A] are worth to a program that stands before their blocks.

    `local` returns the names of its Python, `shared` are the global variables, `starts` where the lines of its text
    begin.
    """

    def __init__(
        self,
        local: Callable[[], Mapping[str, Any]],
        shared: Mapping[str, Any],
        source: Source,
        starts: Sequence[int],
    ) -> None:
        self._local = local
        self._shared = shared
        self._source = source
        self._starts = starts

    def value(self, letter: str, text: str, place: int) -> float:
        """Return the value of a word.

        Raises:
            ProgramError: The variable has none.
        """
        variable = variable_at(0, text[1:-1].upper())
        scope = self._shared if variable.scope == "global" else self._local()
        value = scope.get(variable.name if variable.scope == "global" else variable.python)
        if value is None:
            raise self._error(not_assigned(), place)
        return float(value)

    def _error(self, fault: Fault, place: int) -> ProgramError:
        line = bisect_right(self._starts, place, hi=len(self._starts) - 1)
        text = self._source.line(line)
        numbered = re.match(r"[ \t]*(?:[Nn][ \t]*[0-9]+[ \t]*)?", text)
        at = self._source.begin(line) + (numbered.end() if numbered else 0)
        return self._source.error(Flaw(at, fault.what, fault.hint, code=fault.code))


def line_words(line: str, values: BracketWords, place: int) -> Iterator[tuple[str, float]]:
    """Yield the words of such a block, which begins at byte `place`.

    Raises:
        ProgramError: A variable has no value.
    """
    for found in _WORDS.finditer(line):
        letter = found[1].upper()
        yield letter, values.value(letter, found[2], place) if found[2] else float(found[3])
