"""The shape of a program: its lines of statements, the plain text between them, its loops, and where GOTO leads."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from polycnc.language import Flaw
from polycnc.nc.macro._calls import MacroCalls
from polycnc.nc.macro._plain_lines import OpenLines
from polycnc.nc.macro._reader import LineReader
from polycnc.nc.macro._syntax import End, Goto, If, Line, Number, Part, Span, While
from polycnc.units import whole

_B = r"[ \t]*"
_ANYWHERE = r"[#\[\]=]|(?<![A-Z])(?:GOTO|DPRNT|BPRNT|POPEN|PCLOS|SETVN|(?:DO|END)[ \t]*[0-9])"
_MACRO_CODES = rf"G{_B}0*6[567](?![0-9])|M{_B}0*9[67](?![0-9.])"
_RETURNS = ("M99", "M099", "M0099", "M 99", "M 099", "M\t99")
_SUB_CALL = rf"M{_B}0*98(?![0-9.])"
_NEWLINE = re.compile(r"\r\n|\r|\n")
_COMMENT = re.compile(r"\([^)\r\n]*\)")
_LABEL = re.compile(r"(?:\A|(?<=[\r\n]))[ \t]*(?:/[1-9]?[ \t]*)?N[ \t]*0*([0-9]+)", re.IGNORECASE)
_NEXT_PROGRAM = re.compile(r"[\r\n][ \t]*(?:%|[Oo:][ \t]*[0-9])")
_NEAR_END = 4096
_HEAD = re.compile(r"(?:[ \t]*(?:%[^\r\n]*|\([^)\r\n]*\)[ \t]*)?(?:\r\n|\r|\n))*")
_NUMBER_LINE = re.compile(r"[ \t]*[Oo:][ \t]*[0-9]+[ \t]*(?:\([^)\r\n]*\)[ \t]*)*(?:\r\n|\r|\n|\Z)")


@dataclass(frozen=True, slots=True)
class Special:
    """What is found in lines that are more than plain words: a pattern, and texts without which it is not there.

    `codes` are patterns of the words among it.
    """

    pattern: re.Pattern[str]
    needles: tuple[bytes, ...]
    codes: list[str]

    def lines(
        self, text: str, folded: bytes, begin: int, end: int, without: OpenLines | None = None
    ) -> Iterator[tuple[int, int]]:
        """Yield begin and end of such lines but those that `without` tells; `folded` is the text in capitals."""
        places = dict.fromkeys(self.needles, -1)
        at = begin
        while at < end:
            for needle, place in places.items():
                if place < at:
                    found = folded.find(needle, at, end)
                    places[needle] = end if found < 0 else found
            first = min(places.values())
            if first >= end:
                return
            start = max(text.rfind("\n", at, first) + 1, text.rfind("\r", at, first) + 1, at)
            if without is not None and (behind := without.end(text, start, end)) > start:
                at = behind
                continue
            newline = _NEWLINE.search(text, first, end)
            stop = newline.start() if newline else end
            bare = without_comments(text[start:stop])
            if self.pattern.search(bare) or _returns_to(bare):
                yield start, stop
            at = newline.end() if newline else end


def special(calls: MacroCalls, *, restarts: bool = False, returns: bool = False) -> Special:
    """Return what makes a line special; with `returns` callers are to be returned into."""
    codes = [_MACRO_CODES]
    needles = ["#", "[", "=", "O", "D", "G6", "G06", "G006", "G 6", "G\t6", *_RETURNS, "M96", "M096", "M 96"]
    needles += ["M97", "M097", "M 97"]
    for code in calls.g:
        codes.append(rf"G{_B}0*{re.escape(f'{code:g}')}(?![0-9.])")
        needles += _written("G", code)
    for code in (*calls.m, *calls.m_sub):
        codes.append(rf"M{_B}0*{code}(?![0-9.])")
        needles += _written("M", code)
    if calls.t is not None:
        codes.append(rf"T{_B}[0-9]")
        needles.append("T")
    if restarts:
        codes.append(rf"M{_B}0*99(?![0-9.])")
    if returns:
        codes.append(_SUB_CALL)
        needles += _written("M", 98)
    pattern = re.compile("|".join((_ANYWHERE, *codes)), re.IGNORECASE)
    return Special(pattern, tuple(dict.fromkeys(needle.encode() for needle in needles)), codes)


def _written(letter: str, code: float) -> list[str]:
    return [f"{letter}{code:g}", f"{letter}0{code:g}", f"{letter} {code:g}"]


_M99 = re.compile(rf"M{_B}0*99(?![0-9.])", re.IGNORECASE)
_CALLS = re.compile(
    rb"(?:M[ \t]*0*98|G[ \t]*0*6[56](?:\.1)?)(?![0-9.])[^\r\n]{0,200}?P[ \t]*(?:0*([0-9]+)|[#\[])",
    re.IGNORECASE,
)
_CALL_NEEDLES = tuple(
    each.encode() for code in ("M98", "G65", "G66") for each in _written(code[0], int(code[1:]))
)
_PROGRAM_DIGITS = 10_000


def without_comments(line: str) -> str:
    """Return a line with blanks in place of its comments; its cost grows with its length alone."""
    last = line.rfind(")") + 1
    return _COMMENT.sub(lambda match: " " * len(match[0]), line[:last]) + line[last:]


def _returns_to(bare: str) -> bool:
    """Tell whether a line without comments returns to a block of the calling program."""
    return ("P" in bare or "p" in bare) and _M99.search(bare) is not None


def returns_to_a_block(content: bytes) -> bool:
    """Tell whether a text has a line that returns to a block of the calling program."""
    text = content.decode("latin-1")
    at = 0
    while found := _M99.search(text, at):  # a line once, whatever it repeats
        begin = text.rfind("\n", at, found.start()) + 1 or at
        begin = text.rfind("\r", begin, found.start()) + 1 or begin
        newline = _NEWLINE.search(text, found.end())
        at = newline.end() if newline else len(text)
        if _returns_to(without_comments(text[begin:at])):
            return True
    return False


def called_programs(content: bytes, calls: MacroCalls) -> set[int] | None:
    """Return the numbers of the programs that a text calls, None where it calculates one."""
    found = {*calls.g.values(), *calls.m.values(), *calls.m_sub.values()}
    found |= set() if calls.t is None else {calls.t}
    if any(needle in content or needle.lower() in content for needle in _CALL_NEEDLES):
        for match in _CALLS.finditer(content):
            if match[1] is None:
                return None
            number = whole(match[1])
            found |= {number, number % _PROGRAM_DIGITS}  # the digits before are how often
    return found


@dataclass
class Region:
    """A stretch that is executed in order: the program or the body of a loop. Targets are parts that GOTO leads to."""

    number: int
    outer: Region | None
    head: While | None = None
    line: int = 0
    label: int | None = None
    parts: list[Part | Region] = field(default_factory=list)
    targets: dict[int, int] = field(default_factory=dict)
    """The place of each target: index in `parts` -> number of the piece that begins there."""

    def chain(self) -> Iterator[Region]:
        """Yield the region and all around it."""
        region: Region | None = self
        while region is not None:
            yield region
            region = region.outer


@dataclass(frozen=True, slots=True)
class Label:
    """A block number: where it stands (byte offset), in which region, and the part there."""

    offset: int
    region: Region
    part: int


@dataclass
class Shape:
    """Hold a program: its regions, its labels, and whether a GOTO may lead to any of them."""

    main: Region
    regions: list[Region]
    labels: dict[int, list[Label]]
    open_jumps: bool
    start: int = 0
    """The piece of the main region that is executed first."""

    def find(self, number: int, offset: int) -> Label | None:
        """Return the label that a GOTO at `offset` finds: the next one behind it, else the first of all."""
        found = self.labels.get(number)
        if not found:
            return None
        return next((each for each in found if each.offset > offset), found[0])


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
    jumps = [each for part in parts if isinstance(part, Line) for each in _jumps(part)]
    open_jumps = returns or any(not isinstance(each.target, Number) for each in jumps)
    wanted = {int(each.target.value) for each in jumps if isinstance(each.target, Number)}
    parts = list(_split(text, parts, None if open_jumps else wanted)) if jumps or open_jumps else parts
    flaws: list[Flaw] = []
    regions = [Region(0, None)]
    stack = [regions[0]]
    labels: dict[int, list[Label]] = {}
    begin: tuple[Region, int] | None = None
    for part in parts:
        here = stack[-1]
        if part.offset == start and start is not None:
            begin = here, len(here.parts)
        for number, offset in _labels(text, part):
            labels.setdefault(number, []).append(Label(offset, here, len(here.parts)))
        own_label = part.label if isinstance(part, Line) else None
        first = part.statements[0] if isinstance(part, Line) and part.statements else None
        if isinstance(first, While):
            if any(each.head is not None and each.head.loop == first.loop for each in stack):
                flaws.append(
                    Flaw(
                        first.at,
                        f"DO {first.loop} inside a loop of this number",
                        "Give it another number, 1 to 3.",
                        code="PS0124",
                    )
                )
            inner = Region(len(regions), here, first, part.line, own_label)
            regions.append(inner)
            here.parts.append(inner)
            stack.append(inner)
        elif isinstance(first, End):
            if here.head is None:
                flaws.append(Flaw(first.at, f"END {first.loop} without DO", "Take it out.", code="PS0126"))
            elif here.head.loop != first.loop:
                flaws.append(
                    Flaw(
                        first.at,
                        f"END {first.loop} inside DO {here.head.loop}: loops cannot cross",
                        f"END {here.head.loop} comes first.",
                        code="PS0124",
                    )
                )
            else:
                stack.pop()
        else:
            here.parts.append(part)
    flaws += [
        Flaw(each.head.at, f"DO {each.head.loop} without END", f"Write END{each.head.loop}.", code="PS0124")
        for each in stack
        if each.head is not None
    ]
    made = Shape(regions[0], regions, labels, open_jumps)
    if start is not None and begin is None:
        flaws.append(Flaw(start, "the program cannot begin here", "Choose a block of it.", code="PS0128"))
    elif begin is not None and begin[0] is not regions[0]:
        flaws.append(
            Flaw(
                start or 0,
                "the program cannot begin inside a loop",
                "Choose a block before it.",
                code="PS0128",
            )
        )
    elif begin is not None:
        regions[0].targets[begin[1]] = 0
    for number, found in labels.items():
        if open_jumps or number in wanted:
            for label in found:
                label.region.targets[label.part] = 0
    for region in regions:
        region.targets = {part: index for index, part in enumerate(sorted(region.targets), 1)}
    if begin is not None and begin[0] is regions[0]:
        made.start = regions[0].targets[begin[1]]
    return made, flaws


def _jumps(line: Line) -> Iterator[Goto]:
    for statement in line.statements:
        inner = statement.then if isinstance(statement, If) else statement
        if isinstance(inner, Goto):
            yield inner


def _labels(text: str, part: Part) -> Iterator[tuple[int, int]]:
    if isinstance(part, Line):
        if part.label is not None:
            yield part.label, part.offset
        return
    found = _LABEL.match(text, part.offset, part.end)
    if found:
        yield whole(found[1]), part.offset


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
