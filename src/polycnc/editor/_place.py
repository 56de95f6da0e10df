"""Places in a text as editors count them: lines and characters from 0; and which characters are no words."""

from __future__ import annotations

import re
from dataclasses import dataclass

from polycnc.nc import Dialect

LINE_END = re.compile(r"\r\n|\r|\n")
_WORD = re.compile(r"[A-Za-z][ \t]*[-+]?[0-9.]+|\w+|\S")
_STATEMENT = re.compile(r"[ \t]*[0-9]+[ \t]")


@dataclass(frozen=True, slots=True)
class Span:
    """A part of a line: its number, and its first character and the one after its last, all from 0."""

    line: int
    begin: int
    end: int


def lines_of(text: str) -> list[str]:
    """Return the lines of a text without their ends."""
    return LINE_END.split(text)


def word_at(line: str, begin: int) -> int:
    """Return where the word that begins at a character ends, at least one character on."""
    found = _WORD.match(line, begin)
    return found.end() if found else begin + 1


def words_only(line: str, dialect: Dialect) -> str:
    """Return a line with blanks in place of comments, names in angle brackets and statements of a language."""
    if dialect.language == "cpl" and _STATEMENT.match(line):
        return " " * len(line)
    rules = dialect.text
    patterns = [r"<[^>]*>"]
    if rules.parenthesis_comments:
        patterns.append(r"\([^)]*\)?")
    if rules.semicolon_comments:
        patterns.append(r";.*")
    return re.sub("|".join(patterns), lambda found: " " * len(found[0]), line)
