"""Lines of a file of RS274/NGC and what stands inside what: O-words with their bodies, sub-programs, plain lines."""

from __future__ import annotations

import re
from bisect import bisect_left
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TypeAlias

from polycnc.language import Flaw
from polycnc.nc.rs274._line import Line, LineReader, OWord
from polycnc.nc.text._program import ProgramText
from polycnc.units import whole

_TEXT_WITH_VALUES = re.compile(rb"\([ \t]*(?i:debug|print|abort)")
_O = re.compile(rb"[Oo]")
_OF_LANGUAGE = re.compile(rb"[Mm][ \t]*0*(?:66|7[0-3]|9[89])(?![0-9.])|[Gg][ \t]*0*7[0-2](?![0-9])")
_LONGEST_BEFORE_O = 256
_BEFORE_O = re.compile(rb"[ \t/]*(?:[Nn][0-9. \t]+)?")
_O_NUMBER = re.compile(rb"[Oo][ \t]*[0-9]+[ \t]*(?=[(;\r\n]|\Z)")
"""An O number by itself is the number of a program, and text."""
_O_WORD = re.compile(rb"[Oo][ \t]*[0-9<]")
_SPINDLE = r"\$[ \t]*-?[0-9]+(?![0-9]|[ \t]*=)"
_HAS_SPINDLE = re.compile(_SPINDLE.encode())
_IS_CODE = re.compile(
    r"[#\[@^]|"
    + _SPINDLE
    + r"|^[ \t/]*(?:[Nn][0-9.]+[ \t]*)?[Oo][ \t]*(?![0-9]+[ \t]*(?:[(;\r\n]|$))[0-9<\[#]"
    r"|M[ \t]*0*(?:66|7[0-3]|9[89])(?![0-9.])|G[ \t]*0*7[0-2](?![0-9])"
    r"|\([ \t]*(?:debug|print|abort)[ \t]*,",
    re.IGNORECASE,
)
_PROGRAM_NUMBER = re.compile(r"[ \t/]*(?:N[0-9.]+[ \t]*)?O[ \t]*(?:([0-9]+)|<[^>]*>)\s*", re.IGNORECASE)
"""The beginning of a program, by its number or its name."""
_COMMENT = re.compile(r"\([^)]*\)|;.*")
TEXTS = re.compile(r"[ \t]*(msg|debug|print|abort)[ \t]*,(.*)", re.IGNORECASE | re.DOTALL)
_ENDS = {"if": "endif", "while": "endwhile", "repeat": "endrepeat", "sub": "endsub", "do": "while"}
_MOST_IN_COMMON = 1000
CALLS, RETURNS = repr(98.0), repr(99.0)
WAITS = repr(66.0)
HAS_PROFILES = re.compile(rb"[Gg][ \t]*0*7[0-2](?![0-9])")
PROFILES = {repr(code) for code in (70.0, 71.0, 71.1, 71.2, 72.0, 72.1, 72.2)}
"""Codes by the Python of their numbers."""


def holds_language(content: bytes) -> bool:
    """Tell whether a text may hold more than plain words."""
    return (
        any(char in content for char in b"#@^")
        or b"[" in content
        or (b"$" in content and _HAS_SPINDLE.search(content) is not None)
        or any(_O_WORD.match(content, at) and not _O_NUMBER.match(content, at) for at in _o_lines(content))
        or _TEXT_WITH_VALUES.search(content) is not None
        or _OF_LANGUAGE.search(content) is not None
    )


def is_numbered_within(content: bytes) -> bool:
    """Tell whether numbers of programs stand within a text: LinuxCNC goes on there, as plain text does not."""
    numbers = (at for at in _o_lines(content) if _O_NUMBER.match(content, at))
    return next(numbers, None) is not None and next(numbers, None) is not None


def _o_lines(content: bytes) -> Iterator[int]:
    """Yield where lines have an O as their first letter, but for a number of the block."""
    for found in _O.finditer(content):
        at = found.start()
        least = max(0, at - _LONGEST_BEFORE_O)
        begin = max(content.rfind(b"\n", least, at), content.rfind(b"\r", least, at)) + 1
        if _BEFORE_O.fullmatch(content, begin, at):
            yield at


@dataclass(frozen=True, slots=True)
class Row:
    """A line of a file: where it begins, its number, its text, and where the next one begins."""

    offset: int
    number: int
    text: str
    end: int


@dataclass(slots=True)
class Block:
    """An O-word with what stands inside, up to what ends it; IF has several bodies."""

    word: OWord
    row: Row
    line: Line
    bodies: list[tuple[OWord | None, Row, list[Item]]] = field(default_factory=list)
    end: OWord | None = None
    end_row: Row | None = None


@dataclass(slots=True)
class Span:
    """Lines of plain words."""

    begin: Row
    end: int


Item: TypeAlias = "Block | Span | tuple[Row, Line]"


def rows_of(text: ProgramText, offset: int) -> list[Row]:
    rows: list[Row] = []
    number = text.position(offset).line if offset else 1
    size = len(text)
    percents = 0
    while offset < size:
        end = text.next_line(offset)
        line = text.content[offset : text.line_end(offset)].decode("latin-1")
        if line.strip() == "%":
            percents += 1
            if percents == 2 or any(row.text.strip() for row in rows):
                break
        else:
            rows.append(Row(offset, number, line, end))
        offset, number = end, number + 1
    return rows


def rows_within(text: ProgramText, span: Span) -> Iterator[Row]:
    """Yield the lines of a span."""
    row = span.begin
    while row.offset < span.end:
        yield row
        after = row.end
        content = text.content[after : text.line_end(after)].decode("latin-1")
        row = Row(after, row.number + 1, content, text.next_line(after))


class Structure:
    """Find what stands inside what."""

    def __init__(self, text: ProgramText) -> None:
        self._text = text
        self._subs: dict[str, Block] = {}
        self._open: list[Block] = []
        self._numbers: dict[str, tuple[Row, int]] = {}
        self.has_name = False  # a program begins with its name

    def numbered(self, items: list[Item]) -> dict[str, list[Item]]:
        """Return what follows each O number that stands by itself, up to the first M99 outside of everything.

        Raises:
            Flaw: the sub-programs have too much in common.
        """
        ends = [at for at, item in enumerate(items) if _returns(item)]
        found: dict[str, list[Item]] = {}
        room = 4 * len(items) + _MOST_IN_COMMON
        for number, (row, begin) in self._numbers.items():
            if (nearest := bisect_left(ends, begin)) == len(ends):
                break
            body = items[begin : ends[nearest] + 1]
            if (room := room - len(body)) < 0:
                raise Flaw(
                    row.offset, f"too many sub-programs end with the M99 of O{number}", "Add an M99 to each."
                )
            found[number] = body
        return found

    def read(self, rows: list[Row]) -> tuple[list[Item], dict[str, Block]]:
        main: list[Item] = []
        for row in rows:
            inside = self._open[-1].bodies[-1][2] if self._open else main
            if named := _PROGRAM_NUMBER.fullmatch(_COMMENT.sub("", row.text)):
                self.has_name |= not named[1]
                if not self._open and named[1]:
                    self._numbers.setdefault(str(whole(named[1])), (row, len(main)))
                continue
            if not _IS_CODE.search(row.text) or not _is_code(row.text):
                _extend(inside, row)
                continue
            line = read_row(row)
            if line.o_word is None:
                inside.append((row, line))
            else:
                self._take(row, line, line.o_word, inside)
        if self._open:
            block = self._open[-1]
            raise Flaw(
                block.row.offset + block.word.at,
                f"O{block.word.label} {block.word.keyword} has no end",
                f"Add O{block.word.label} {_ENDS[block.word.keyword]}.",
            )
        return main, self._subs

    def _take(self, row: Row, line: Line, word: OWord, inside: list[Item]) -> None:
        top = self._open[-1] if self._open else None
        same = top is not None and top.word.label == word.label
        match word.keyword:
            case "while" if same and top is not None and top.word.keyword == "do":
                self._close(row, word)
            case "if" | "while" | "repeat" | "do" | "sub":
                block = Block(word, row, line)
                block.bodies.append((word, row, []))
                if word.keyword == "sub":
                    if top is not None:
                        raise Flaw(
                            row.offset + word.at, "a sub-program inside something else", "Move it out."
                        )
                    if word.label in self._subs:
                        raise Flaw(
                            row.offset + word.at,
                            f"a second sub-program O{word.label}",
                            "Name it differently.",
                        )
                    self._subs[word.label] = block
                else:
                    inside.append(block)
                self._open.append(block)
            case "elseif" | "else":
                if not same or top is None or top.word.keyword != "if":
                    raise Flaw(
                        row.offset + word.at,
                        f"O{word.label} {word.keyword} without its IF",
                        "Numbers of O-words that belong together are equal.",
                    )
                top.bodies.append((word if word.keyword == "elseif" else None, row, []))
            case "endif" | "endwhile" | "endrepeat" | "endsub":
                if not same or top is None or _ENDS[top.word.keyword] != word.keyword:
                    raise Flaw(
                        row.offset + word.at,
                        f"O{word.label} {word.keyword} without its beginning",
                        "Numbers of O-words that belong together are equal.",
                    )
                self._close(row, word)
            case _:
                inside.append((row, line))

    def _close(self, row: Row, word: OWord) -> None:
        block = self._open.pop()
        block.end, block.end_row = word, row


def _returns(item: Item) -> bool:
    """Tell whether a line is an M99 that is never skipped."""
    return (
        isinstance(item, tuple)
        and not item[1].skip
        and any(word[0] == "M" and word[1].python == RETURNS for word in item[1].words)
    )


def _is_code(text: str) -> bool:
    """Tell whether a line holds more than words, its comments apart."""
    bare = _COMMENT.sub("", text)
    if _IS_CODE.search(bare):
        return True
    return any(
        TEXTS.match(found[0][1:]) and "msg" not in found[0].lower()[:6]
        for found in _COMMENT.finditer(text)
        if found[0][0] == "("
    )


def _extend(inside: list[Item], row: Row) -> None:
    if inside and isinstance(inside[-1], Span) and inside[-1].end == row.offset:
        inside[-1].end = row.end
    elif row.text.strip():
        inside.append(Span(row, row.end))


def read_row(row: Row) -> Line:
    """Return what a line holds.

    Raises:
        Flaw: it is not as the language wants it.
    """
    try:
        return LineReader(row.text, row.number).read()
    except Flaw as flaw:
        raise Flaw(row.offset + flaw.at, flaw.what, flaw.hint) from None
