"""A file of RS274/NGC as Python: a generator for its main program, and one for each sub-program in it.

Runs of plain lines stay text. A loop is a loop of Python; `j` names the loop that BREAK (above 0) or CONTINUE (below)
is for, where that is not the innermost one.
"""

from __future__ import annotations

from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, replace

from polycnc.errors import ProgramError
from polycnc.language import Emitter, Flaw, Traced
from polycnc.nc.rs274._inputs import takes
from polycnc.nc.rs274._kept_modes import KEEPING
from polycnc.nc.rs274._line import Expression, Line, OWord
from polycnc.nc.rs274._structure import (
    CALLS,
    HAS_PROFILES,
    PROFILES,
    RETURNS,
    TEXTS,
    WAITS,
    Block,
    Item,
    Row,
    Span,
    Structure,
    read_row,
    rows_of,
    rows_within,
)
from polycnc.nc.rs274._texts import text_python
from polycnc.nc.text._program import ProgramText
from polycnc.nc.text._silent import is_silent

_MOST_ARGUMENTS = 30
PAUSE_ROUNDS = 20_000


@dataclass(slots=True)
class Program:
    """A translated file: its main program under the name "" and its sub-programs, each a function `program`.

    A sub-program of M98, which begins at an O number, is there under `numbered_label`.
    """

    text: ProgramText
    offset: int
    functions: dict[str, Traced[int]]
    plain: bool


def numbered_label(number: str) -> str:
    """Return the name of the sub-program of M98 that begins at an O number."""
    return f"M98 {number}"


def profile_label(label: str) -> str:
    """Return the name of a sub-program that is read as a profile."""
    return f"profile {label}"


def translate(text: ProgramText, offset: int) -> Program:
    """Return the program of a file from byte `offset` on.

    Raises:
        ProgramError: it is not as the language wants it.
    """
    try:
        rows = rows_of(text, offset)
        structure = Structure(text)
        items, subs = structure.read(rows)
        program = _Writer(text, offset).write(items, subs, structure.numbered(items))
        return replace(program, plain=program.plain and not structure.has_name)
    except Flaw as flaw:
        raise ProgramError(flaw.what, position=text.position(flaw.at), hint=flaw.hint) from None


class _Writer:
    """Write the Python of a file; the place of each line is a byte offset."""

    def __init__(self, text: ProgramText, offset: int) -> None:
        self._text = text
        self._offset = offset
        self._out: Emitter[int] = Emitter(0)
        self._loops: list[tuple[str, int, bool]] = []  # label, number, whether it is a REPEAT
        self._numbers = 0
        self._changes = 0  # lines so far that change something
        self._crossed: set[int] = set()
        self._in_sub = False
        self._is_profile = False  # lines of plain words are written out, too

    def write(self, items: list[Item], subs: dict[str, Block], numbered: dict[str, list[Item]]) -> Program:
        functions = {"": self._function("", items, None)}
        for number, body in numbered.items():
            functions[numbered_label(number)] = self._function(numbered_label(number), body, None)
        self._in_sub = True
        for label, block in subs.items():
            functions[label] = self._function(label, block.bodies[0][2], block)
        if HAS_PROFILES.search(self._text.content):
            self._is_profile = True
            for label, block in subs.items():
                functions[profile_label(label)] = self._function(label, block.bodies[0][2], block)
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
            if isinstance(item, Span) and self._is_profile:
                for row in rows_within(self._text, item):
                    self._line(row, read_row(row))
            elif isinstance(item, Span):
                text = self._text.content[item.begin.offset : item.end]
                self._changes += not is_silent(text.decode("latin-1"))
                self._at(item.begin)
                self._out.put(f"yield span({item.begin.offset}, {item.begin.number}, {item.end})")
            elif isinstance(item, Block):
                self._block(item)
            else:
                self._line(*item)

    def _line(self, row: Row, line: Line) -> None:
        self._at(row)
        with self._unless_skipped(line):
            self._statement(row, line)

    def _unless_skipped(self, line: Line) -> AbstractContextManager[None]:
        """Write what stands inside so that a line with a skip mark can be left out."""
        return self._out.block(f"if not skips({line.skip}):") if line.skip else nullcontext()

    def _statement(self, row: Row, line: Line) -> None:
        put = self._out.put
        self._changes += 1
        put(*self._texts(row, line))
        codes = {code.python for letter, code, _ in line.words if letter == "M"}
        if codes & {CALLS, RETURNS}:
            self._numbered(row, line)
            return
        if WAITS in codes:
            self._waits(row, line)
        keeping = [word for word in line.words if word[0] == "M" and word[1].python in KEEPING]
        words = ", ".join(
            f"({letter!r}, {value.python}, {row.offset + at})"
            for letter, value, at in line.words
            if (letter, value, at) not in keeping
        )
        self._settings(line, words)
        if words:
            given = "w" if line.settings else f"({words},)"
            profile = ""
            if any(letter == "G" and code.python in PROFILES for letter, code, _ in line.words):
                if not line.settings:
                    put(f"w = ({words},)")
                given, profile = "w", ", profile(w)"
            put(f"yield block({row.number}, {row.offset}, {given}, {self._message(line)}{profile})")
        for _, code, at in keeping:
            put(f"yield modes({KEEPING[code.python]}, {row.number}, {row.offset + at})")
        if line.o_word is not None:
            self._o_word(row, line.o_word)

    def _settings(self, line: Line, words: str) -> None:
        """Write the settings of a line, all values of the line, those of its words too, before any of them."""
        put = self._out.put
        for target, _ in line.settings:  # a name is there, with 0, as soon as its line is read
            own = target.removesuffix(" = {}")
            if own.startswith("N[") and any(own in each.python for _, each in line.settings):
                put(f"if {own[2:-1]} not in N:", f"    {own} = 0.0")
        if len(line.settings) == 1 and not words:
            target, value = line.settings[0]
            put(target.replace("{}", value.python, 1) if "{}" in target else target)
        elif line.settings:
            put(f"t = ({''.join(value.python + ', ' for _, value in line.settings)})")
            if words:
                put(f"w = ({words},)")
            put(*(target.replace("{}", f"t[{n}]", 1) for n, (target, _) in enumerate(line.settings)))

    def _waits(self, row: Row, line: Line) -> None:
        """Write the wait of an M66; its line is a block of words after that."""
        codes = [at for letter, code, at in line.words if letter == "M" and code.python == WAITS]
        if len(codes) > 1:
            raise Flaw(row.offset + codes[1], "M66 twice in a line", "Write one in a line.")
        words = "".join(f"({letter!r}, {value.python}), " for letter, value, _ in line.words if takes(letter))
        self._out.put(
            f"q = asked(({words}))",
            f"yield drain({row.number})",
            "q = look(begun(q))",
            "while q:",
            "    yield WAIT",
            "    q = look(q)",
        )

    def _numbered(self, row: Row, line: Line) -> None:
        """Write a call of a sub-program by M98, or the return from one by M99."""
        (code, called, at), *others = line.words
        letters = [letter for letter, _, _ in others]
        calls = called.python == CALLS
        if (
            code != "M"
            or line.settings
            or len(set(letters)) < len(letters)
            or set(letters) - set("PL" * calls)
        ):
            raise Flaw(
                row.offset + at,
                "M98 or M99 with other words",
                "Write M98 P100 L2 or M99 in a line of its own.",
            )
        if not calls:
            if self._in_sub:
                raise Flaw(row.offset + at, "M99 in a sub-program of SUB", "Write RETURN or ENDSUB.")
            self._out.put("return None")
            return
        given = {letter: value.python for letter, value, _ in others}
        if "P" not in given:
            raise Flaw(row.offset + at, "M98 without P", "Add P and the number of the sub-program.")
        self._numbers += 1
        number, rounds = f"p{self._numbers}", f"r{self._numbers}"
        self._out.put(f"{number}, {rounds} = whole(P={given['P']}), whole(L={given.get('L', '1.0')})")
        with self._out.block(f"while {rounds} > 0:"):
            self._out.put(f"{rounds} -= 1", f"yield call_number({number}, {row.number})")

    def _message(self, line: Line) -> str:
        for comment in line.comments:
            if (found := TEXTS.match(comment)) and found[1].lower() == "msg":
                return repr(found[2].strip())
        return "''"

    @staticmethod
    def _texts(row: Row, line: Line) -> list[str]:
        """Return Python of what MSG, DEBUG, PRINT and ABORT say."""
        put: list[str] = []
        for comment in line.comments:
            found = TEXTS.match(comment)
            if found is None or (found[1].lower() == "msg" and (line.words or line.settings)):
                continue
            kind = found[1].lower()
            if kind == "abort":
                put.append(f"abort({text_python(found[2], row.number)})")
                continue
            text = repr(found[2]) if kind == "msg" else text_python(found[2], row.number)
            says = f"yield says({row.number}, {row.offset}, {text})"
            put.append(says if kind != "debug" else f"if debugs(): {says}")
        return put

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
        with self._unless_skipped(block.line):
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
        changes = self._changes
        with self._out.block(head):
            if first:
                self._out.put(f"{first} = False")
            if rounds:
                self._out.put(f"{rounds} -= 1")
            self._out.put("c -= 1")
            with self._out.block("if c < 0:"):
                self._out.put("yield PAUSE", f"c = {PAUSE_ROUNDS}")
            self._items(block.bodies[0][2])
            if self._changes == changes and not rounds:
                self._out.put("c = 0")  # it waits: a round more is one of the next cycle
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
