"""Lines of plain words in which single variables stand for numbers: they stay text, read by the channel in pieces.

Posts write such lines by the ten thousand (G1 X.. Y.. F#101). No statement is made of them: what a word is worth is
asked for when its block is prepared.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

from polycnc.nc.macro._statement_values import nearest
from polycnc.nc.macro._variables import LOCALS, Value
from polycnc.nc.sources._block_source import WordValues
from polycnc.nc.text._program import ProgramText
from polycnc.nc.text._scan_plain import Word

_B = r"[ \t]*+"
_NUMBER = r"[+-]?(?:[0-9]{1,8}+(?:\.[0-9]{0,7}+)?+|\.[0-9]{1,12}+)(?![0-9.])"
_CALLS = rf"M{_B}0*9[6-9](?![0-9.])"
_COMMENT = r"\((?!\W*MSG)[^)\r\n]*+\)"
_VARIABLE = re.compile("#([0-9]+)")
_WORD = re.compile(rf"([A-Z]){_B}([+-]?)(#?)([0-9]++\.?[0-9]*+|\.[0-9]++)", re.IGNORECASE | re.ASCII)
_COMMENTS = re.compile(r"\([^)\r\n]*\)")


class OpenLines:
    """Tell lines of plain words, of which none is one of `codes` (patterns) and variables are `known`."""

    def __init__(self, codes: list[str], known: Callable[[int], bool]) -> None:
        others = "|".join((_CALLS, *codes))
        fixed = rf"[GMT]{_B}{_NUMBER}"
        word = rf"[A-FH-LP-SU-Z]{_B}(?:{_NUMBER}|[+-]?#[0-9]{{1,3}}+(?!\.))"
        self._line = re.compile(
            rf"{_B}(?:N{_B}[0-9]{{1,8}}+(?!\.))?(?:{_B}(?!{others})(?:{word}|{fixed}))*+{_B}(?:{_COMMENT}{_B})?"
            r"(?:\r\n|\r|\n|\Z)",
            re.IGNORECASE | re.ASCII,
        )
        self._known = known
        self._told: dict[str, bool] = {}

    def end(self, text: str, at: int, end: int) -> int:
        """Return where the first line from `at` on begins that is none, or has no variable."""
        while at < end and (found := self._line.match(text, at, end)) is not None:
            numbers = _VARIABLE.findall(found[0])
            if not numbers or not all(map(self._is_known, numbers)):
                break
            at = found.end()
        return at

    def _is_known(self, digits: str) -> bool:
        if (known := self._told.get(digits)) is None:
            known = self._told[digits] = self._known(int(digits))
        return known


class VariableWords:
    """What words like F#101 are worth to one execution of a program."""

    def __init__(self, local: list[Value], common: list[Value], increment: Callable[[str], float]) -> None:
        self._local = local
        self._common = common
        self._increment = increment

    def value(self, letter: str, text: str, place: int) -> float | None:
        """Return the value of a word in whole increments, None for a vacant one."""
        number = int(text.lstrip("+-#"))
        value = (self._local if number <= LOCALS else self._common)[number]
        if value is None:
            return None
        return nearest(-value if text[0] == "-" else value, self._increment(letter))


def line_words(text: ProgramText, begin: int, end: int, values: WordValues) -> Iterator[Word]:
    """Yield the words of such a line, but those that are vacant."""
    line = text.content[begin:end].decode("latin-1")
    for found in _WORD.finditer(_COMMENTS.sub(lambda match: " " * len(match[0]), line)):
        letter, sign, mark, number = found.groups()
        place = begin + found.start()
        if not mark:
            yield Word(letter.upper(), float(sign + number), place, "." in number)
        elif (value := values.value(letter.upper(), f"{sign}#{number}", place)) is not None:
            yield Word(letter.upper(), value, place, True)
