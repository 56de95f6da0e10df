"""Python source made of pieces: expressions that know when they need parentheses, lines that know where they stem from.

What a program becomes is compiled once, runs with no builtins but those of its language, and every error
raised in it can be led back to the place in the program that its Python line was made from.
"""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from types import CodeType
from typing import Any, Generic, NamedTuple, TypeVar

from polycnc.language._source import Flaw

Place = TypeVar("Place")

ATOM = 20
"""The power of what never needs parentheses."""
_INFIX = {
    "or": 1, "and": 2, "==": 4, "!=": 4, "<": 4, "<=": 4, ">": 4, ">=": 4, "|": 5, "^": 6, "&": 7,
    "<<": 8, ">>": 8, "+": 9, "-": 9, "*": 10, "/": 10, "//": 10, "%": 10,
}  # fmt: skip
_PREFIX = {"not": 3, "-": 11, "+": 11, "~": 11}
_SHORT = 300
_FEW_CASES = 500
"""Python of lines so short and hardly indented compiles; other lines are compiled at once, to see whether they do."""
_DEEP = "\n" + 60 * " "
_COMPARISON = 4  # comparisons in a row mean something else in Python, so one never stands bare within another


@contextmanager
def without_collection() -> Iterator[None]:
    """Keep the collector of cycles away from trees: they hold none, and it would go through them again and again."""
    was = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was:
            gc.enable()


class Python(NamedTuple):
    """A Python expression, and how tightly the loosest operator in it binds."""

    text: str
    power: int = ATOM

    def within(self, least: int) -> str:
        """Return the text, in parentheses where something binds looser than `least`."""
        return self.text if self.power >= least else f"({self.text})"


def infix(left: Python, operator: str, right: Python) -> Python:
    """Return two expressions with a Python operator between them."""
    power = _INFIX[operator]
    least = power + 1 if power == _COMPARISON else power
    before = left.text if left.power >= least else f"({left.text})"
    after = right.text if right.power > power else f"({right.text})"
    return Python(f"{before} {operator} {after}", power)


def prefix(operator: str, operand: Python) -> Python:
    """Return an expression with a Python operator before it."""
    power = _PREFIX[operator]
    blank = " " if operator == "not" else ""
    return Python(f"{operator}{blank}{operand.within(power)}", power)


class Traced(Generic[Place]):
    """Python as `name`: its lines, and the place in the program that each of them stems from.

    It is compiled when it is asked for its code, so that a program that is only checked never is.
    """

    def __init__(
        self, name: str, lines: tuple[str, ...], places: tuple[Place, ...], code: CodeType | None = None
    ) -> None:
        self.name = name
        self.lines = lines
        self.places = places
        self._code = code

    @property
    def code(self) -> CodeType:
        """The compiled code."""
        if self._code is None:
            self._code = compile("\n".join(self.lines), self.name, "exec", dont_inherit=True)
        return self._code

    def load(self, names: Mapping[str, object]) -> dict[str, Any]:
        """Execute it, knowing `names` and nothing else of Python, and return what it defines."""
        scope: dict[str, Any] = {"__builtins__": {}, **names}
        exec(self.code, scope)
        return scope


class Piece(NamedTuple, Generic[Place]):
    """Lines of Python on their own, and the place that each of them stems from."""

    lines: list[str]
    places: list[Place]


class _Inside:
    """The inside of blocks: `leave` ends the innermost one. Contexts made of generators take several times as long."""

    def __init__(self, leave: Callable[[], None]) -> None:
        self._leave = leave

    def __enter__(self) -> None:
        pass

    def __exit__(self, *error: object) -> None:
        self._leave()


class Emitter(Generic[Place]):
    """Collect lines of Python; each gets the place that was set last."""

    def __init__(self, place: Place) -> None:
        self.place = place
        self.lines: list[str] = []
        self.places: list[Place] = []
        self._indent = ""
        self._heads: list[int] = []  # how many lines there were when each open block began
        self._diverted: list[tuple[list[str], list[Place], str]] = []
        self._inside = _Inside(self._leave)

    def put(self, *lines: str) -> None:
        """Add lines at the present indentation."""
        for line in lines:
            self.lines.append(self._indent + line)
            self.places.append(self.place)

    def divert(self) -> None:
        """Collect what is put from now on by itself, until `diverted` returns it."""
        self._diverted.append((self.lines, self.places, self._indent))
        self.lines, self.places, self._indent = [], [], ""

    def diverted(self) -> Piece[Place]:
        """Return what was put since `divert`; what is put next comes after what was there before."""
        piece = Piece(self.lines, self.places)
        self.lines, self.places, self._indent = self._diverted.pop()
        return piece

    def take(self, other: Piece[Place] | Emitter[Place]) -> None:
        """Add lines with their places at the present indentation."""
        indent = self._indent
        self.lines += [indent + line for line in other.lines] if indent else other.lines
        self.places += other.places

    def block(self, head: str) -> AbstractContextManager[None]:
        """Add a line that ends with a colon; what is put inside belongs to it, `pass` if nothing is."""
        self.put(head)
        self._indent += "    "
        self._heads.append(len(self.lines))
        return self._inside

    def _leave(self) -> None:
        if len(self.lines) == self._heads.pop():
            self.put("pass")
        self._indent = self._indent[:-4]

    def _may_be_refused(self) -> bool:
        """Tell whether Python may find the lines too long, too deep, or a choice to have too many cases."""
        if max(map(len, self.lines), default=0) > _SHORT:
            return True
        whole = "\n".join(self.lines)
        return _DEEP in whole or whole.count("elif ") > _FEW_CASES

    def _offset(self, error: Exception) -> int:
        """Return the place that Python has refused, as far as that is an offset; else that of the longest line."""
        line = getattr(error, "lineno", None)
        if line is None:
            line = 1 + max(range(len(self.lines)), key=lambda index: len(self.lines[index]))
        place = self.places[line - 1]
        return place if isinstance(place, int) else 0

    def compile(self, name: str) -> Traced[Place]:
        """Return the lines to be loaded; `name` tells this code from other code in `frame_of`.

        Raises:
            Flaw: They are nested too deeply, or too long, for Python.
        """
        traced = Traced(name, tuple(self.lines), tuple(self.places))
        if self._may_be_refused():
            try:
                _ = traced.code
            except (RecursionError, MemoryError, SyntaxError) as error:
                what = "one expression or statement is too long or nested too deeply"
                raise Flaw(self._offset(error), what, "split it") from error
        return traced


class Frame(NamedTuple, Generic[Place]):
    """Where an error passed through traced code: the code's name, its Python line, and the place in the program."""

    name: str
    line: str
    place: Place


def frame_of(error: BaseException, find: Callable[[str], Traced[Place] | None]) -> Frame[Place] | None:
    """Return the innermost frame of traced code that an error came through; None if it came through none.

    `find` returns the traced code of a name.
    """
    found: Frame[Place] | None = None
    trace = error.__traceback__
    while trace is not None:
        name = trace.tb_frame.f_code.co_filename
        if (traced := find(name)) is not None:
            found = Frame(name, traced.lines[trace.tb_lineno - 1], traced.places[trace.tb_lineno - 1])
        trace = trace.tb_next
    return found
