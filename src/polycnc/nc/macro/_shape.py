"""The shape of a program: its lines of statements, the plain text between them, its loops, and where GOTO leads."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace

from polycnc.language import Flaw, Mark
from polycnc.nc.macro._reader import LineReader
from polycnc.nc.macro._syntax import (
    End,
    Goto,
    If,
    Line,
    Number,
    Part,
    Refusal,
    Refused,
    Restart,
    Span,
    Statement,
    While,
)
from polycnc.units import whole

RESTART = "restart"
"""The key of the mark at the beginning of a program that M99 begins anew."""
_NEWLINE = re.compile(r"\r\n|\r|\n")
_LABEL = re.compile(r"(?:\A|(?<=[\r\n]))[ \t]*(?:/[1-9]?[ \t]*)?N[ \t]*0*([0-9]+)", re.IGNORECASE)
_NEXT_PROGRAM = re.compile(r"[\r\n][ \t]*(?:%|[Oo:][ \t]*[0-9])")
_NEAR_END = 4096
_HEAD = re.compile(r"(?:[ \t]*(?:%[^\r\n]*|\([^)\r\n]*\)[ \t]*)?(?:\r\n|\r|\n))*")
_NUMBER_LINE = re.compile(r"[ \t]*[Oo:][ \t]*[0-9]+[ \t]*(?:\([^)\r\n]*\)[ \t]*)*(?:\r\n|\r|\n|\Z)")


@dataclass(frozen=True, slots=True)
class Shape:
    """Hold a program: its parts, loops and marks, its block numbers with the bytes where they are, in their order.

    With `open_jumps` a GOTO may lead to any of them. The key of a mark is its byte; the first one executed is `begin`.
    """

    body: list[Part | Mark | While]
    labels: dict[int, list[int]]
    open_jumps: bool
    begin: int | None

    def find(self, number: int, offset: int) -> int | None:
        """Return the byte that a GOTO at `offset` leads to: of the next such block, else of the first of all."""
        found = self.labels.get(number)
        return next((each for each in found if each > offset), found[0]) if found else None


def extent(text: str, offset: int, line: int) -> tuple[int, int, int]:
    """Return where the first block of a program begins, its line, and where the program ends."""
    head = _HEAD.match(text, offset)
    begin = head.end() if head else offset
    number = _NUMBER_LINE.match(text, begin)
    if number:
        begin = number.end()
    after = _NEXT_PROGRAM.search(text, max(begin - 1, 0))
    end = after.start() + 1 if after else len(text)
    return begin, line + len(_NEWLINE.findall(text, offset, begin)), max(end, begin)


def parse(
    text: str, lines: Iterator[tuple[int, int]], begin: int, line: int, end: int, reader: LineReader
) -> tuple[list[Part], list[Flaw]]:
    """Return the parts of a program, and all that is wrong in its lines."""
    parts: list[Part] = []
    flaws: list[Flaw] = []
    at = begin
    for start, stop in lines:
        if start > at:
            parts.append(Span(line, at, start))
            line += len(_NEWLINE.findall(text, at, start))
        try:
            parts.append(reader.read(start, stop, line))
        except Flaw as flaw:
            flaws.append(flaw)
        newline = _NEWLINE.match(text, stop)
        at = newline.end() if newline else stop
        line += 1
    if end > at:
        parts.append(Span(line, at, end))
    return parts, flaws


def shape(
    text: str, parts: list[Part], *, returns: bool, start: int | None = None
) -> tuple[Shape, list[Flaw]]:
    """Put parts into loops and find the targets of all jumps; the program begins at byte `start`, if one is given."""
    if start is not None:
        parts = list(_cut(text, parts, start))
    statements = [each for part in parts if isinstance(part, Line) for each in part.statements]
    wanted = _wanted(statements, returns=returns)
    if wanted is None or wanted:
        parts = list(_split(text, parts, wanted))
    nest, labels = _Nest(), dict[int, list[int]]()
    if any(isinstance(each, Restart) for each in statements):
        nest.here.append(Mark(0, RESTART))
    begin: list[Flaw] | None = (
        None if start is None else [_no_begin(start, "the program cannot begin here", "of it")]
    )
    for part in parts:
        number, at = _label(text, part), part.offset
        if number is not None:
            labels.setdefault(number, []).append(at)
        if (number is not None and (wanted is None or number in wanted)) or at == start:
            nest.here.append(Mark(at, at))
        if at == start:
            inside = _no_begin(start, "the program cannot begin inside a loop", "before it")
            begin = [inside] if nest.open else []
        nest.take(part)
    return Shape(nest.main, labels, wanted is None, start), [*nest.all_flaws(), *(begin or ())]


class _Nest:
    """The loops that are open while parts are taken one after the other."""

    def __init__(self) -> None:
        self.main: list[Part | Mark | While] = []
        self.here = self.main
        self.open: list[While] = []
        self._flaws: list[Flaw] = []

    def take(self, part: Part) -> None:
        """Put a part where it belongs; it may begin or end a loop."""
        first = part.statements[0] if isinstance(part, Line) and part.statements else None
        if isinstance(first, While):
            if any(each.loop == first.loop for each in self.open):
                what = f"DO {first.loop} inside a loop of this number"
                self._refuse(first.at, what, "Give it another number, 1 to 3.", "PS0124")
            first.line, first.label = part.line, part.label if isinstance(part, Line) else None
            self.here.append(first)
            self.open.append(first)
        elif isinstance(first, End):
            assert isinstance(part, Line)
            self._end(part, first)
        else:
            self.here.append(part)
            return
        self.here = self.open[-1].body if self.open else self.main

    def _end(self, line: Line, end: End) -> None:
        if not self.open:
            flaw = Refusal(end.at, f"END {end.loop} without DO", "Remove it.", code="PS0126")
            self.here.append(replace(line, statements=(Refused(end.at, flaw),)))
        elif (loop := self.open[-1].loop) != end.loop:
            what = f"END {end.loop} inside DO {loop}: loops cannot cross"
            self._refuse(end.at, what, f"END {loop} comes first.", "PS0124")
        else:
            self.open.pop()

    def _refuse(self, at: int, what: str, hint: str, code: str) -> None:
        self._flaws.append(Flaw(at, what, hint, code=code))

    def all_flaws(self) -> list[Flaw]:
        """Return what is wrong; loops that are still open become lines that are refused."""
        while self.open:
            loop = self.open.pop()
            around = self.open[-1].body if self.open else self.main
            flaw = Refusal(loop.at, f"DO {loop.loop} without END", f"Write END{loop.loop}.", code="PS0124")
            line = Line(loop.line, loop.at, loop.label, 0, (Refused(loop.at, flaw),))
            around[-1:] = [line, *loop.body]
        return self._flaws


def _no_begin(start: int, what: str, which: str) -> Flaw:
    return Flaw(start, what, f"Choose a block {which}.", code="PS0128")


def _wanted(statements: list[Statement], *, returns: bool) -> set[int] | None:
    """Return the block numbers that jumps lead to, None for any."""
    found = set()
    for each in _jumps(statements):
        if not isinstance(each.target, Number):
            return None
        found.add(int(each.target.value))
    return None if returns else found


def _jumps(statements: list[Statement]) -> Iterator[Goto]:
    for statement in statements:
        inner = statement.then if isinstance(statement, If) else statement
        if isinstance(inner, Goto):
            yield inner


def _label(text: str, part: Part) -> int | None:
    if isinstance(part, Line):
        return part.label
    found = _LABEL.match(text, part.offset, part.end)
    return whole(found[1]) if found else None


def last_label(text: str, part: Span) -> int | None:
    """Return the last block number in a stretch of plain text; it is mostly near its end."""
    for begin in (max(part.offset, part.end - _NEAR_END), part.offset):
        last = None
        for found in _LABEL.finditer(text, begin, part.end):
            last = found
        if last is not None:
            return whole(last[1])
    return None


def _cut(text: str, parts: list[Part], start: int) -> Iterator[Part]:
    """Cut the plain text in which a line begins in two."""
    for part in parts:
        if isinstance(part, Span) and part.offset < start < part.end:
            yield Span(part.line, part.offset, start)
            yield Span(part.line + len(_NEWLINE.findall(text, part.offset, start)), start, part.end)
        else:
            yield part


def _split(text: str, parts: list[Part], wanted: set[int] | None) -> Iterator[Part]:
    """Split plain text where a label stands that is wanted, with None where any stands."""
    for part in parts:
        if isinstance(part, Line):
            yield part
            continue
        at, line = part.offset, part.line
        for found in _LABEL.finditer(text, part.offset, part.end):
            if found.start() == at or (wanted is not None and whole(found[1]) not in wanted):
                continue
            yield Span(line, at, found.start())
            line += len(_NEWLINE.findall(text, at, found.start()))
            at = found.start()
        yield Span(line, at, part.end)
