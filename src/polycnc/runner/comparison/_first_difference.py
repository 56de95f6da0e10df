"""The first block in which two programs differ; block numbers, comments, blanks and empty lines make no difference."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import zip_longest

from polycnc.errors import ProgramError
from polycnc.nc import Dialect, ProgramText, scan_block

_NUMBERS = ("N",)


@dataclass(frozen=True, slots=True)
class BlockDifference:
    """The lines (from 1) and texts of the first blocks that differ; line 0 where one program has ended."""

    line_a: int
    text_a: str
    line_b: int
    text_b: str


def first_difference(
    a: ProgramText, b: ProgramText, read_a: Dialect, read_b: Dialect
) -> BlockDifference | None:
    """Return the first blocks that differ in words, values or decimal points; None where no block does."""
    if a.content == b.content:
        return None
    line, offset = _same_lines(a.content, b.content)
    blocks = zip_longest(_blocks(a, read_a, offset, line), _blocks(b, read_b, offset, line))
    end: tuple[int, str, object] = (0, "", None)
    for one, other in blocks:
        one, other = one or end, other or end
        if one[2] != other[2]:
            return BlockDifference(one[0], one[1], other[0], other[1])
    return None


def _same_lines(a: bytes, b: bytes) -> tuple[int, int]:
    """Return number and offset of the line up to which both texts are the same byte for byte."""
    low, high = 0, min(len(a), len(b))
    while low < high:
        middle = (low + high + 1) // 2
        if a[low:middle] == b[low:middle]:
            low = middle
        else:
            high = middle - 1
    offset = a.rfind(b"\n", 0, low) + 1
    if b"\r" in a[:offset].replace(b"\r\n", b""):
        return 1, 0  # lines end in several ways: from the beginning
    return a.count(b"\n", 0, offset) + 1, offset


def _blocks(text: ProgramText, dialect: Dialect, offset: int, line: int) -> Iterator[tuple[int, str, object]]:
    """Yield line, text and what counts of each block."""
    rules = dialect.text
    while offset < len(text):
        end = text.next_line(offset)
        try:
            block = scan_block(text, offset, line, rules)
        except ProgramError:
            shown = text.line(offset).strip()
            yield line, shown, shown
        else:
            words = tuple(
                (word.letter, word.index, word.value, word.point)
                for word in block.words
                if word.letter not in _NUMBERS or word.index is not None
            )
            statement = " ".join(block.statement.split())
            if words or statement or block.message or block.skip_level:
                counts = (words, block.skip_level, statement, block.message)
                yield line, text.line(offset).strip(), counts
        line += text.content.count(b"\n", offset, end) or 1
        offset = end
