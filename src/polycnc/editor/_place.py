"""Places in a text as editors count them: lines and characters from 0; and which characters are no words."""

from __future__ import annotations

import re
from dataclasses import dataclass

from polycnc.nc import Dialect

MOST_LINE = 1 << 14
"""A longer line is nothing that anybody writes, and is not looked through."""

LINE_END = re.compile(r"\r\n|\r|\n")
_WORD = re.compile(r"[A-Za-z][ \t]*[-+]?[0-9.]+|\w+|\S")
_STATEMENT = re.compile(r"[ \t]*[0-9]+[ \t]")
_IN_ANGLES = re.compile(r"<[^>]*>")
_CPL_COMMENT = re.compile(r"\"[^\"]*\"?|\bREM\b.*", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Span:
    """A part of a line: its number, and its first character and the one after its last, all from 0."""

    line: int
    begin: int
    end: int


def lines_of(text: str) -> list[str]:
    """Return the lines of a text without their ends."""
    return LINE_END.split(text) if "\r" in text else text.split("\n")


def word_at(line: str, begin: int) -> int:
    """Return where the word that begins at a character ends, at least one character on."""
    found = _WORD.match(line, begin)
    return found.end() if found else begin + 1


def is_statement(line: str, dialect: Dialect) -> bool:
    """Tell whether a line is a statement of CPL: it begins with a bare number."""
    return dialect.language == "cpl" and _STATEMENT.match(line) is not None


def words_only(line: str, dialect: Dialect) -> str:
    """Return a line with blanks in place of comments, names in angle brackets and statements of a language."""
    if is_statement(line, dialect):
        return " " * len(line)
    return _IN_ANGLES.sub(_blanks, without_comments(line, dialect))


def without_comments(line: str, dialect: Dialect) -> str:
    """Return a line with blanks in place of comments and of texts in quotes."""
    if is_statement(line, dialect):
        return _CPL_COMMENT.sub(_blanks, line)
    rules = dialect.text
    patterns = []
    if rules.parenthesis_comments:
        patterns.append(r"\([^)]*\)?")
    if rules.semicolon_comments:
        patterns.append(r";.*")
    return re.sub("|".join(patterns), _blanks, line) if patterns else line


def _blanks(found: re.Match[str]) -> str:
    return " " * len(found[0])
