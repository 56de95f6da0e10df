"""What the names in macros stand for: codes with their groups, function variables and words.

A run of macros keeps modes and last outputs in lists; a symbol knows its index in them.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from polycnc.post.macros._events import ADDED_WORDS, KEPT_WORDS, NUMBER_WORDS, TEXT_WORDS
from polycnc.post.macros._expression import FUNCTIONS
from polycnc.post.macros._format import NumberFormat

OUTPUTORDER = "OUTPUTORDER"
STARTOFLINE = "STARTOFLINE"
ENDOFLINE = "ENDOFLINE"
TOOLCHANGE = "TOOLCHANGE"
LINE_TEXTS = (STARTOFLINE, ENDOFLINE)
"""Reserved words that macros set to a text in quotes."""
SEQUENCE_NUMBER = "SEQUENCE_NUMBER"
"""Key of the sequence number in the section of NC codes."""


def reserved(strict: bool) -> frozenset[str]:
    """Return the names that no code and no function variable may have."""
    names = frozenset({OUTPUTORDER, *LINE_TEXTS, *TEXT_WORDS, *FUNCTIONS})
    return names - ADDED_WORDS if strict else names


@dataclass(frozen=True, slots=True)
class CodeSymbol:
    """A G or M code: what is written, its order, its group (-1: none) and its number within all codes, from 1."""

    key: str
    text: str
    order: int
    group: int
    number: int
    separated: bool = True


@dataclass(frozen=True, slots=True)
class VariableSymbol:
    """A function variable: its order and format, and the place of what was written last."""

    key: str
    order: int
    format: NumberFormat
    modal: bool
    memory: int
    origin: float | None
    initial: float
    separated: bool = True


@dataclass(slots=True)
class Symbols:
    """All names of a control file; `values` holds what each word and variable that a macro uses begins with.

    With `strict` the additions to the manual's words are no words.
    """

    strict: bool = False

    codes: dict[str, CodeSymbol] = field(default_factory=dict)
    variables: dict[str, VariableSymbol] = field(default_factory=dict)
    orders: dict[str, int] = field(default_factory=dict)
    values: dict[str, float | str] = field(default_factory=dict)
    groups: dict[str, int] = field(default_factory=dict)

    def use(self, name: str) -> str:
        """Note that a macro uses a variable or word, and return the Python for its value."""
        if name in self.variables:
            self.values[name] = self.variables[name].initial
        else:
            self.values.setdefault(name, "" if self.is_text(name) else 0.0)
        return f"values[{name!r}]"

    def group(self, name: str) -> int:
        """Return the number of a modal group, -1 for no group."""
        return self.groups.setdefault(name, len(self.groups)) if name else -1

    def is_text(self, name: str) -> bool:
        """Tell whether a reserved word holds a text."""
        return (name in TEXT_WORDS and not self._is_missing(name)) or name in LINE_TEXTS

    def is_number(self, name: str) -> bool:
        """Tell whether a reserved word holds a number and can be written without a format.

        Words of one letter are addresses: they are written by the format of their function variable, or not at all.
        """
        return name == OUTPUTORDER or (name in NUMBER_WORDS and len(name) > 1 and not self._is_missing(name))

    def is_kept(self, name: str) -> bool:
        """Tell whether a word is kept by the driver, so that a macro cannot set it."""
        return name in KEPT_WORDS and not self._is_missing(name)

    def _is_missing(self, name: str) -> bool:
        return self.strict and name in ADDED_WORDS

    def words(self) -> Iterable[str]:
        """Return what `$...$` may name."""
        numbers = (name for name in NUMBER_WORDS if len(name) > 1)
        found = {*TEXT_WORDS, *LINE_TEXTS, OUTPUTORDER, *numbers}
        return sorted({*self.variables, *(found - ADDED_WORDS if self.strict else found)})
