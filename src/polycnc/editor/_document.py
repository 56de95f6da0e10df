"""Texts as an editor changes them: lines and UTF-16 units from 0, as the protocol counts."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate

from polycnc.editor._place import LINE_END, lines_of


@dataclass(frozen=True)
class Document:
    """A text in one version; a change makes another one."""

    text: str
    version: int | None = None

    @cached_property
    def lines(self) -> list[str]:
        """The lines without their ends."""
        return lines_of(self.text)

    @cached_property
    def starts(self) -> list[int]:
        """Where the lines begin in the text."""
        if "\r" in self.text:
            return [0, *(found.end() for found in LINE_END.finditer(self.text))]
        return list(accumulate((len(line) + 1 for line in self.lines[:-1]), initial=0))

    def start(self, line: int) -> int:
        """Return where a line begins in the text."""
        return self.starts[line]

    def offset(self, line: int, units: int) -> int:
        """Return the place in the text of a position; beyond a line it is its end, beyond the text the text's end."""
        if line >= len(self.lines):
            return len(self.text)
        return self.starts[max(line, 0)] + characters(self.lines[max(line, 0)], units)

    def place(self, offset: int) -> tuple[int, int]:
        """Return line and character of a place in the text."""
        line = bisect_right(self.starts, offset) - 1
        return line, offset - self.starts[line]

    def changed(self, begin: tuple[int, int], end: tuple[int, int], text: str) -> Document:
        """Return the document with a text in place of that between two positions (line, units)."""
        first, last = sorted((self.offset(*begin), self.offset(*end)))
        return Document(f"{self.text[:first]}{text}{self.text[last:]}", self.version)


def units(text: str) -> int:
    """Return how many UTF-16 units a text has."""
    return len(text) if text.isascii() else len(text.encode("utf-16-le", "surrogatepass")) // 2


def characters(line: str, count: int) -> int:
    """Return how many characters the first UTF-16 units of a line are, all at the most; half of one counts none."""
    count = max(count, 0)
    if line.isascii():
        return min(count, len(line))
    content = line.encode("utf-16-le", "surrogatepass")
    before, after = content[: 2 * count], content[2 * count : 2 * count + 2]
    if before and after and 0xD8 <= before[-1] <= 0xDB and 0xDC <= after[1] <= 0xDF:
        before = before[:-2]
    return len(before.decode("utf-16-le", "surrogatepass"))
