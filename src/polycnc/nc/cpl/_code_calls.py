"""Codes that call sub-programs: alone in their block, and again after every move (Manual 003, 3.1 and 3.2)."""

from __future__ import annotations

import re
from collections.abc import Callable, Container, Iterable
from dataclasses import dataclass, field
from typing import NamedTuple

from polycnc.nc.text._program import TextRules


class CodeWord(NamedTuple):
    """A word of a block as far as calls go by it: address in capitals, extension (X2= has 2) or None, value."""

    address: str
    extension: int | None
    value: float


def _no_codes() -> frozenset[str]:
    return frozenset()


@dataclass(frozen=True)
class CodeCalls:
    """What a control says of codes that call programs.

    `alone` are those that do so without brackets ("G322", "M50"), `modal` those whose program is executed again after
    every move. `cancels` are the G codes that end this, `stands` those whose axis words are no move. `axes` are the
    axes that words move, as addresses with their extensions ("X", "X2"), `rules` how blocks are read.
    """

    alone: Callable[[], frozenset[str]] = _no_codes
    modal: frozenset[str] = frozenset()
    cancels: frozenset[float] = frozenset()
    stands: frozenset[float] = frozenset()
    axes: Callable[[], Container[str]] = field(default=_no_codes)
    rules: TextRules = field(default_factory=TextRules)

    def cancels_modal(self, words: Iterable[CodeWord]) -> bool:
        """Tell whether a block ends modal calls."""
        return any(word.address == "G" and word.value in self.cancels for word in words)

    def moves(self, words: Iterable[CodeWord]) -> bool:
        """Tell whether a block prescribes a move."""
        axes, moved = self.axes(), False
        for word in words:
            if word.address == "G" and word.value in self.stands:
                return False
            name = word.address if word.extension is None else f"{word.address}{word.extension}"
            moved = moved or name in axes
        return moved


NO_CODES = CodeCalls()

_NUMBER = re.compile(r"([GM])([0-9]+)")


def pattern_of(alone: frozenset[str]) -> re.Pattern[bytes] | None:
    """Return what finds one of the codes at the beginning of a line, None if there is none."""
    found = [match for match in map(_NUMBER.fullmatch, sorted(alone)) if match]
    if not found:
        return None
    codes = "|".join(f"{match[1]}[ \\t]*0*{match[2]}" for match in found)
    head = r"(?mi)^[ \t]*(?:/[ \t]*[1-9]?[ \t]*)?(?:N[ \t]*[0-9]+[ \t]*)?"
    return re.compile(f"{head}(?:{codes})(?![0-9.])".encode("ascii"))
