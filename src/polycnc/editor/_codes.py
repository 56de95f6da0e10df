"""What a G or M code does in the dialect of a program, from the rows that the reference is generated from."""

from __future__ import annotations

import re
from dataclasses import dataclass

from polycnc.editor._place import Span, words_only
from polycnc.nc import Dialect, MAction

_CODE = re.compile(r"(?<![A-Za-z_%$])([GM])[ \t]*([0-9]{1,6}(?:\.[0-9]{0,6})?)", re.IGNORECASE)
_ADDRESS = re.compile(r"(?<![A-Za-z_%$#.])([A-Z])[ \t]*[-+]?[0-9.#\[][0-9.\[\]#]*", re.IGNORECASE)
_BEGUN = re.compile(r"(?:\A|(?<=[^A-Za-z_%$]))([GM])[0-9]*\.?[0-9]*\Z", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Completion:
    """A code that may be meant, and what it does."""

    label: str
    detail: str


def hover(lines: list[str], line: int, character: int, dialect: Dialect) -> tuple[str, Span] | None:
    """Return what the G or M code at a place does, as Markdown, and where it stands; None where none stands."""
    if not 0 <= line < len(lines):
        return None
    for found in _CODE.finditer(words_only(lines[line], dialect)):
        if found.start() <= character < found.end():
            described = _described(found[1].upper(), float(found[2]), dialect)
            return described, Span(line, found.start(), found.end())
    return None


def word(lines: list[str], line: int, character: int, dialect: Dialect) -> tuple[str, Span] | None:
    """Return the letter of the word at a place, and where it stands; None where no word stands."""
    if not 0 <= line < len(lines):
        return None
    for found in _ADDRESS.finditer(words_only(lines[line], dialect)):
        if found.start() <= character < found.end():
            return found[1].upper(), Span(line, found.start(), found.end())
    return None


def completions(lines: list[str], line: int, character: int, dialect: Dialect) -> list[Completion]:
    """Return the codes of the dialect with the letter that has been begun before a place."""
    if not 0 <= line < len(lines):
        return []
    begun = _BEGUN.search(words_only(lines[line][:character], dialect))
    if begun is None:
        return []
    if begun[1].upper() == "G":
        return [Completion(f"G{code:g}", each.sentence) for code, each in sorted(dialect.g_codes().items())]
    codes = sorted({int(code) for code in dialect.m})
    return [Completion(f"M{code}", _plain(dialect.m_action(code))) for code in codes]


def _described(letter: str, code: float, dialect: Dialect) -> str:
    name = f"**{letter}{code:g}**"
    if letter == "M":
        action = dialect.m_action(int(code)) if code.is_integer() else None
        if action is None:
            return f"{name}: no M code of dialect {dialect.name}"
        group = f"  \nGroup: {action.group}" if action.group else ""
        return f"{name} ({dialect.name}): {_plain(action)}{group}"
    row = dialect.g_action(code)
    if row is None:
        return f"{name}: no G code of dialect {dialect.name}"
    words = " ".join(_word(each, dialect) for each in row.takes)
    taken = f"  \nWords: {words}" if words else ""
    return f"{name} ({dialect.name}): {row.sentence}  \nGroup: {row.group}{taken}"


def _word(word: str, dialect: Dialect) -> str:
    if word == "time":
        return " ".join(f"{address} ({unit})" for address, unit in dialect.dwell.items())
    return word


def _plain(action: MAction | None) -> str:
    return "" if action is None else action.title.replace("_", " ")
