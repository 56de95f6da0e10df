"""NC blocks as a partner control reads them: searched by their beginnings, their words in a row."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NamedTuple

_WORD = re.compile(r"([A-Z])([0-9]+=)?([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+))")
_MESSAGE = re.compile(r"\(MSG,([^)]*)\)")
_REMARK = re.compile(r"\([^)]*\)")


class Words(NamedTuple):
    """The words of a block: (address, value), and the text of a message or None."""

    values: tuple[tuple[str, float], ...]
    message: str | None

    def has(self, address: str, *values: float) -> bool:
        """Return whether a word with one of the values is there."""
        return any(name == address and value in values for name, value in self.values)


def read_block(text: str) -> Words | None:
    """Return the words of a block, None if it is no NC block."""
    found = _MESSAGE.search(text)
    rest = _REMARK.sub("", text).replace(" ", "").replace("\t", "")
    values: list[tuple[str, float]] = []
    at = 0
    while at < len(rest):
        word = _WORD.match(rest, at)
        if word is None:
            return None
        if word[1] != "N":
            values.append((word[1] + (word[2] or "").rstrip("="), float(word[3])))
        at = word.end()
    return Words(tuple(values), found[1] if found else None)


def find_block(blocks: Sequence[str], wanted: str, begin: int = 0) -> int | None:
    """Return the first block that begins with a text, None if there is none (MCOPS 3).

    A text that begins with a digit and is not found is looked for with N before it; after a digit at its end no
    further digit may follow, after a letter a blank has to.
    """
    for text in (wanted, "N" + wanted) if wanted[:1].isdigit() else (wanted,):
        for index in range(begin, len(blocks)):
            block = blocks[index].lstrip(" \t\n")
            follows = block[len(text) : len(text) + 1]
            if not block.startswith(text):
                continue
            if (text[-1:].isdigit() and follows.isdigit()) or (text[-1:].isalpha() and follows != " "):
                continue
            return index
    return None
