"""Which axes a program of a mill has words for besides X, Y and Z."""

from __future__ import annotations

import re

from polycnc.nc.dialect._dialect import Dialect
from polycnc.nc.dialect._guess import words_of
from polycnc.nc.text._program import ProgramText

_LOOKED_AT = 1 << 20  # bytes: which axes turn, a program shows early
_WORD = re.compile(
    rb"(?<![A-Za-z#,.\]])([ABCUVW])[ \t]*(?=[-+]?[ \t]*\.?[0-9]|[-+]?[ \t]*[#\[])", re.IGNORECASE
)
_OTHER_MEANINGS = re.compile(
    rb"(?<![A-Z])(?:G[ \t]*0*(?:4|6[5-8]|10[1-9]|1[1-9][0-9])(?![0-9])|M[ \t]*98)", re.IGNORECASE
)
"""Codes whose words are arguments or times."""
_Y = re.compile(rb"(?<![A-Za-z#])Y[ \t]*[-+.0-9#\[]", re.IGNORECASE)
_LINEAR = "UVW"


def further_axes(text: ProgramText, dialect: Dialect) -> str:
    """Return the letters of the axes that a program has words for besides X, Y and Z, like "A".

    U, V and W count beside Y alone: without it they are the ways of a lathe.
    """
    if dialect.diameter_axes or dialect.language == "cpl":
        return ""
    words = words_of(text, _LOOKED_AT)
    found: set[str] = set()
    for word in _WORD.finditer(words):
        letter = word[1].decode().upper()
        if letter not in found and not _OTHER_MEANINGS.search(_line(words, word)):
            found.add(letter)
    found -= set(dialect.ignored_addresses) | set(dialect.incremental)
    if not _Y.search(words):
        found -= set(_LINEAR)
    return "".join(sorted(found))


def _line(words: bytes, word: re.Match[bytes]) -> bytes:
    begin = max(words.rfind(b"\n", 0, word.start()), words.rfind(b"\r", 0, word.start()))
    end = words.find(b"\n", word.start())
    return words[begin + 1 : end if end >= 0 else len(words)]
