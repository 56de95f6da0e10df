"""A file of RS274/NGC as Python: a generator for its main program, and one for each sub-program in it.

Runs of plain lines stay text. A loop is a loop of Python; `j` names the loop that BREAK (above 0) or CONTINUE (below)
is for, where that is not the innermost one.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TypeAlias

from polycnc.errors import ProgramError
from polycnc.language import Emitter, Flaw, Traced
from polycnc.nc.rs274._kept_modes import KEEPING
from polycnc.nc.rs274._line import Expression, Line, LineReader, OWord
from polycnc.nc.text._program import ProgramText

_TEXT_WITH_VALUES = re.compile(rb"\([ \t]*(?i:debug|print)")
_O = re.compile(rb"[Oo]")
_KEEPS_MODES = re.compile(rb"[Mm][ \t]*0*7[0-3](?![0-9.])")
_LONGEST_BEFORE_O = 256
_BEFORE_O = re.compile(rb"[ \t/]*(?:[Nn][0-9. \t]+)?")
_O_NUMBER = re.compile(rb"[Oo][ \t]*[0-9]+[ \t]*(?=[(;\r\n]|\Z)")
"""An O number by itself is the number of a program, and text."""
_O_WORD = re.compile(rb"[Oo][ \t]*[0-9<]")
_IS_CODE = re.compile(
    r"[#\[@^]|^[ \t/]*(?:[Nn][0-9.]+[ \t]*)?[Oo][ \t]*(?![0-9]+[ \t]*(?:[(;\r\n]|$))[0-9<\[#]"
    r"|M[ \t]*0*7[0-3](?![0-9.])"
    r"|\([ \t]*(?:debug|print)[ \t]*,",
    re.IGNORECASE,
)
_PROGRAM_NUMBER = re.compile(r"[ \t/]*(?:N[0-9.]+[ \t]*)?O[ \t]*[0-9]+\s*", re.IGNORECASE)
_COMMENT = re.compile(r"\([^)]*\)|;.*")
_PARAMETER = re.compile(r"#(?:<[^>]*>|[0-9]+)")
_TEXTS = re.compile(r"[ \t]*(msg|debug|print)[ \t]*,(.*)", re.IGNORECASE | re.DOTALL)
_ENDS = {"if": "endif", "while": "endwhile", "repeat": "endrepeat", "sub": "endsub", "do": "while"}
_MOST_ARGUMENTS = 30
PAUSE_ROUNDS = 20_000


def holds_language(content: bytes) -> bool:
    """Tell whether a text may hold more than plain words."""
    return (
        any(char in content for char in b"#@^")
        or b"[" in content
        or any(_O_WORD.match(content, at) and not _O_NUMBER.match(content, at) for at in _o_lines(content))
        or _TEXT_WITH_VALUES.search(content) is not None
        or _KEEPS_MODES.search(content) is not None
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


@dataclass(slots=True)
class Program:
    """A translated file: its main program under the name "" and its sub-programs, each a function `program`."""

    text: ProgramText
    offset: int
    functions: dict[str, Traced[int]]
    plain: bool


def translate(text: ProgramText, offset: int) -> Program:
    """Return the program of a file from byte `offset` on.

    Raises:
        ProgramError: it is not as the language wants it.
    """
    try:
        rows = _rows(text, offset)
        items, subs = _Structure(text).read(rows)
        return _Writer(text, offset).write(items, subs)
    except Flaw as flaw:
        raise ProgramError(flaw.what, position=text.position(flaw.at), hint=flaw.hint) from None


def _rows(text: ProgramText, offset: int) -> list[Row]:
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


class _Structure:
    """Find what stands inside what."""

    def __init__(self, text: ProgramText) -> None:
        self._text = text
        self._subs: dict[str, Block] = {}
        self._open: list[Block] = []

    def read(self, rows: list[Row]) -> tuple[list[Item], dict[str, Block]]:
        main: list[Item] = []
        for row in rows:
            inside = self._open[-1].bodies[-1][2] if self._open else main
            if _PROGRAM_NUMBER.fullmatch(_COMMENT.sub("", row.text)):
                continue
            if not _IS_CODE.search(row.text) or not _is_code(row.text):
                _extend(inside, row)
                continue
            line = _read(row)
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


def _is_code(text: str) -> bool:
    """Tell whether a line holds more than words, its comments apart."""
    bare = _COMMENT.sub("", text)
    if _IS_CODE.search(bare):
        return True
    return any(
        _TEXTS.match(found[0][1:]) and "msg" not in found[0].lower()[:6]
        for found in _COMMENT.finditer(text)
        if found[0][0] == "("
    )


def _extend(inside: list[Item], row: Row) -> None:
    if not row.text.strip():
        if inside and isinstance(inside[-1], Span) and inside[-1].end == row.offset:
            inside[-1].end = row.end
        return
    if inside and isinstance(inside[-1], Span) and inside[-1].end == row.offset:
        inside[-1].end = row.end
    else:
        inside.append(Span(row, row.end))


def _read(row: Row) -> Line:
    try:
        return LineReader(row.text, row.number).read()
    except Flaw as flaw:
        raise Flaw(row.offset + flaw.at, flaw.what, flaw.hint) from None


class _Writer:
    """Write the Python of a file; the place of each line is a byte offset."""

    def __init__(self, text: ProgramText, offset: int) -> None:
        self._text = text
        self._offset = offset
        self._out: Emitter[int] = Emitter(0)
        self._loops: list[tuple[str, int, bool]] = []  # label, number, whether it is a REPEAT
        self._numbers = 0
        self._crossed: set[int] = set()
        self._in_sub = False

    def write(self, items: list[Item], subs: dict[str, Block]) -> Program:
        functions = {"": self._function("", items, None)}
        self._in_sub = True
        for label, block in subs.items():
            functions[label] = self._function(label, block.bodies[0][2], block)
        plain = not subs and all(isinstance(item, Span) for item in items)
        return Program(self._text, self._offset, functions, plain)

    def _function(self, label: str, items: list[Item], block: Block | None) -> Traced[int]:
        self._out = Emitter(0)
        with self._out.block("def program(L, N):"):
            self._out.put("j = 0", f"c = {PAUSE_ROUNDS}", "if c < 0:", "    yield PAUSE")
            self._items(items)
            if block is not None and block.end is not None and block.end_row is not None:
                self._at(block.end_row, block.end.at)
                self._return(block.end.arguments)
        return self._out.compile(f"<rs274 {self._text.name} {label}>")

    def _at(self, row: Row, column: int = 0) -> None:
        blanks = len(row.text) - len(row.text.lstrip())
        self._out.place = row.offset + max(column, min(blanks, len(row.text)))

    def _items(self, items: list[Item]) -> None:
        for item in items:
            if isinstance(item, Span):
                self._at(item.begin)
                self._out.put(f"yield span({item.begin.offset}, {item.begin.number}, {item.end})")
            elif isinstance(item, Block):
                self._block(item)
            else:
                self._line(*item)

    def _line(self, row: Row, line: Line) -> None:
        self._at(row)
        if line.skip:
            with self._out.block(f"if not skips({line.skip}):"):
                self._statement(row, line)
        else:
            self._statement(row, line)

    def _statement(self, row: Row, line: Line) -> None:
        put = self._out.put
        message = self._message(line)
        for text in self._texts(row, line):
            put(f"yield says({row.number}, {row.offset}, {text})")
        for target, _ in line.settings:  # a name is there, with 0, as soon as its line is read
            own = target.removesuffix(" = {}")
            if own.startswith("N[") and any(own in each.python for _, each in line.settings):
                put(f"if {own[2:-1]} not in N:", f"    {own} = 0.0")
        keeping = [word for word in line.words if word[0] == "M" and word[1].python in KEEPING]
        words = ", ".join(
            f"({letter!r}, {value.python}, {row.offset + at})"
            for letter, value, at in line.words
            if (letter, value, at) not in keeping
        )
        if len(line.settings) == 1 and not line.words:
            target, value = line.settings[0]
            put(target.replace("{}", value.python, 1) if "{}" in target else target)
        elif line.settings:
            put(f"t = ({''.join(value.python + ', ' for _, value in line.settings)})")
            if words:
                put(f"w = ({words},)")
            put(*(target.replace("{}", f"t[{n}]", 1) for n, (target, _) in enumerate(line.settings)))
            if words:
                put(f"yield block({row.number}, {row.offset}, w, {message})")
        elif words:
            put(f"yield block({row.number}, {row.offset}, ({words},), {message})")
        put(
            *(
                f"yield modes({KEEPING[code.python]}, {row.number}, {row.offset + at})"
                for _, code, at in keeping
            )
        )
        if line.o_word is not None:
            self._o_word(row, line.o_word)

    def _message(self, line: Line) -> str:
        for comment in line.comments:
            if (found := _TEXTS.match(comment)) and found[1].lower() == "msg":
                return repr(found[2].strip())
        return "''"

    def _texts(self, row: Row, line: Line) -> list[str]:
        """Return Python of the texts of DEBUG and PRINT, with the values of parameters in them."""
        texts: list[str] = []
        for comment in line.comments:
            found = _TEXTS.match(comment)
            if found is None or (found[1].lower() == "msg" and (line.words or line.settings)):
                continue
            parts: list[str] = []
            at = 0
            for parameter in _PARAMETER.finditer(found[2]) if found[1].lower() != "msg" else ():
                parts += [
                    repr(found[2][at : parameter.start()]),
                    f"six({LineReader(parameter[0], row.number).value().python})",
                ]
                at = parameter.end()
            texts.append(" + ".join([*parts, repr(found[2][at:])]))
        return texts

    def _o_word(self, row: Row, word: OWord) -> None:
        self._at(row, word.at)
        match word.keyword:
            case "call":
                if len(word.arguments) > _MOST_ARGUMENTS:
                    raise Flaw(
                        row.offset + word.at,
                        f"more than {_MOST_ARGUMENTS} arguments",
                        "Use named parameters.",
                    )
                label = f"label({word.label})" if word.computed else repr(word.label)
                given = "".join(f"{each.python}, " for each in word.arguments)
                self._out.put(f"yield call({label}, ({given}), {row.number})")
            case "return":
                if self._in_sub:
                    self._return(word.arguments)
            case _:
                self._leave_loop(row, word)

    def _return(self, arguments: list[Expression]) -> None:
        self._out.put(f"return {arguments[0].python}" if arguments else "return None")

    def _leave_loop(self, row: Row, word: OWord) -> None:
        found = [loop for loop in self._loops if loop[0] == word.label]
        if not found:
            raise Flaw(
                row.offset + word.at,
                f"O{word.label} {word.keyword} outside its loop",
                "Use the number of a loop around it.",
            )
        number = found[-1][1]
        if found[-1][2]:
            raise Flaw(
                row.offset + word.at,
                f"O{word.label} {word.keyword} of a REPEAT",
                "Use WHILE, or an IF around.",
            )
        if found[-1] is self._loops[-1]:
            self._out.put(word.keyword)
            return
        inner = self._loops[self._loops.index(found[-1]) + 1 :]
        self._crossed.update(loop[1] for loop in inner)
        self._out.put(f"j = {number if word.keyword == 'break' else -number}", "break")

    def _block(self, block: Block) -> None:
        self._at(block.row, block.word.at)
        if block.line.skip:
            with self._out.block(f"if not skips({block.line.skip}):"):
                self._inside(block)
        else:
            self._inside(block)

    def _inside(self, block: Block) -> None:
        keyword = block.word.keyword
        if keyword == "if":
            for number, (word, row, items) in enumerate(block.bodies):
                self._at(row)
                head = "else:" if word is None else f"{'elif' if number else 'if'} {_condition(row, word)}:"
                with self._out.block(head):
                    self._items(items)
            return
        self._numbers += 1
        number = self._numbers
        first = rounds = ""
        if keyword == "while":
            head = f"while {_condition(block.row, block.word)}:"
        elif keyword == "repeat":
            rounds = f"r{number}"
            self._out.put(f"{rounds} = times({_argument(block.row, block.word)})")
            head = f"while {rounds} > 0:"
        else:
            assert block.end is not None
            assert block.end_row is not None
            first = f"d{number}"
            self._out.put(f"{first} = True")
            head = f"while {first} or ({_condition(block.end_row, block.end)}):"
        self._loops.append((block.word.label, number, keyword == "repeat"))
        with self._out.block(head):
            if first:
                self._out.put(f"{first} = False")
            if rounds:
                self._out.put(f"{rounds} -= 1")
            self._out.put("c -= 1")
            with self._out.block("if c < 0:"):
                self._out.put("yield PAUSE", f"c = {PAUSE_ROUNDS}")
            self._items(block.bodies[0][2])
        self._loops.pop()
        if number in self._crossed:
            self._pass_on()

    def _pass_on(self) -> None:
        """Leave the loop around too, where that was asked for inside."""
        assert self._loops
        number = self._loops[-1][1]
        with self._out.block("if j:"):
            with self._out.block(f"if j == -{number}:"):
                self._out.put("j = 0", "continue")
            with self._out.block(f"if j == {number}:"):
                self._out.put("j = 0")
            self._out.put("break")


def _argument(row: Row, word: OWord) -> str:
    if len(word.arguments) != 1:
        raise Flaw(
            row.offset + word.at,
            f"O{word.label} {word.keyword} needs one expression",
            "Write it in brackets.",
        )
    return word.arguments[0].python


def _condition(row: Row, word: OWord) -> str:
    _argument(row, word)
    return word.arguments[0].condition
