"""Python source made of pieces: expressions that know when they need parentheses, lines that know where they stem from.

What a program becomes is compiled once, runs with no builtins but those that its language lends, and every error
raised in it can be led back to the place in the program that its Python line was made from.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
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
_COMPARISON = 4  # comparisons in a row mean something else in Python, so one never stands bare within another


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
    return Python(f"{left.within(least)} {operator} {right.within(power + 1)}", power)


def prefix(operator: str, operand: Python) -> Python:
    """Return an expression with a Python operator before it."""
    power = _PREFIX[operator]
    blank = " " if operator == "not" else ""
    return Python(f"{operator}{blank}{operand.within(power)}", power)


@dataclass(frozen=True, slots=True)
class Traced(Generic[Place]):
    """Compiled Python, its lines, and the place in the program that each of them stems from."""

    code: CodeType
    lines: tuple[str, ...]
    places: tuple[Place, ...]

    def load(self, names: Mapping[str, object]) -> dict[str, Any]:
        """Execute it, knowing `names` and nothing else of Python, and return what it defines."""
        scope: dict[str, Any] = {"__builtins__": {}, **names}
        exec(self.code, scope)
        return scope


class Emitter(Generic[Place]):
    """Collect lines of Python; each gets the place that was set last."""

    def __init__(self, place: Place) -> None:
        self.place = place
        self.lines: list[str] = []
        self.places: list[Place] = []
        self._indent = ""

    def put(self, *lines: str) -> None:
        """Add lines at the present indentation."""
        for line in lines:
            self.lines.append(self._indent + line)
            self.places.append(self.place)

    @contextmanager
    def block(self, head: str) -> Iterator[None]:
        """Add a line that ends with a colon; what is put inside belongs to it, `pass` if nothing is."""
        self.put(head)
        before = len(self.lines)
        self._indent += "    "
        yield
        if len(self.lines) == before:
            self.put("pass")
        self._indent = self._indent[:-4]

    def compile(self, name: str) -> Traced[Place]:
        """Return the lines compiled; `name` tells this code from other code in `frame_of`.

        Raises:
            Flaw: They are nested too deeply, or too long, for Python.
        """
        try:
            code = compile("\n".join(self.lines), name, "exec", dont_inherit=True)
        except (RecursionError, MemoryError, SyntaxError) as error:
            raise Flaw(
                0, "one expression or statement is too long or nested too deeply", "split it"
            ) from error
        return Traced(code, tuple(self.lines), tuple(self.places))


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
