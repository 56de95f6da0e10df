"""Expressions and conditions of macros, read once and turned into Python text.

The grammar is a subset of Python's with the same precedence, so what is read becomes a flat row of pieces: Python
text, and names that the compiler replaces by places of variables (Manual 001, sections 6 and 8).
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

FUNCTIONS = (
    *("SIN", "COS", "TAN", "ASIN", "ACOS", "ATAN", "DEG", "RAD", "SQRT", "EXP", "LOG10", "LOG", "DABS"),
    *("DMS", "ADMS"),
)
LOGICAL_OPERATORS = 5
"""How many logical operators a condition may have (Manual 001, 8)."""
EQUAL_WITHIN = 0.0001
"""Values count as equal if their difference is smaller (Manual 001, 8)."""
NESTED_PARENTHESES = 50

_TOKEN = re.compile(
    r"[ \t]*(?:([0-9]+(?:\.[0-9]*)?|\.[0-9]+)|([A-Za-z][A-Za-z0-9_]*)|(==|!=|<=|>=|&&|\|\||[-+*/()<>]))"
)
_COMPARISONS = {
    "==": ("abs((", ")-(", f"))<{EQUAL_WITHIN}"),
    "!=": ("abs((", ")-(", f"))>={EQUAL_WITHIN}"),
    "<=": ("(", ")-(", f")<{EQUAL_WITHIN}"),
    ">=": ("(", ")-(", f")>-{EQUAL_WITHIN}"),
    "<": ("(", ")-(", f")<=-{EQUAL_WITHIN}"),
    ">": ("(", ")-(", f")>={EQUAL_WITHIN}"),
}
_LOGIC = {"&&": " and ", "||": " or "}


class Flaw(Exception):  # noqa: N818 (never leaves the package: the loader makes a ConfigurationError of it)
    """Something wrong in a line of a macro, at a 0-based place of that line."""

    def __init__(self, at: int, what: str, hint: str = "", line: int = 0) -> None:
        super().__init__(what)
        self.at = at
        self.what = what
        self.hint = hint
        self.line = line


@dataclass(frozen=True, slots=True)
class Name:
    """A variable in an expression, in capitals, and its place in the line."""

    text: str
    at: int


@dataclass(frozen=True, slots=True)
class Formula:
    """An expression or condition: pieces that, joined, are Python."""

    at: int
    pieces: tuple[str | Name, ...]


Pieces: TypeAlias = list[str | Name]


def read_expression(line: str, start: int, end: int) -> Formula:
    """Read `line[start:end]` as one expression.

    Raises:
        Flaw: It is none.
    """
    reader = _Reader(line, start, end)
    pieces = reader.expression()
    reader.end("the expression")
    return Formula(reader.first, tuple(pieces))


def read_condition(line: str, start: int) -> Formula:
    """Read the rest of an IF line, which begins at the parenthesis at `start`.

    Raises:
        Flaw: It is no condition, or has too many logical operators.
    """
    reader = _Reader(line, start, len(line))
    reader.expect("(", "write the condition in parentheses, like IF(T==1)")
    first = reader.token.at
    pieces = reader.comparison()
    operators = 0
    while reader.token.text in _LOGIC:
        operators += 1
        if operators > LOGICAL_OPERATORS:
            raise Flaw(
                reader.token.at,
                f"more than {LOGICAL_OPERATORS} logical operators in one IF",
                "split the condition into nested IFs",
            )
        pieces.append(_LOGIC[reader.token.text])
        reader.step()
        pieces += reader.comparison()
    reader.expect(")", "join comparisons with && or ||, and end the condition with )")
    reader.end("the condition")
    return Formula(first, tuple(pieces))


class _Token(NamedTuple):
    kind: str  # "number", "name", "mark", "end"
    text: str
    at: int


class _Reader:
    """Step through the tokens of a line, one token ahead."""

    def __init__(self, line: str, start: int, end: int) -> None:
        self._line = line
        self._next = start
        self._stop = end
        self._depth = 0
        self.token = self._read()
        self.first = self.token.at

    def step(self) -> _Token:
        """Return the token and go to the next one."""
        token, self.token = self.token, self._read()
        return token

    def expect(self, mark: str, hint: str) -> None:
        """Step over a mark that must come next."""
        if self.token.text != mark:
            raise Flaw(self.token.at, f"'{mark}' is missing before {self._shown()}", hint)
        self.step()

    def end(self, what: str) -> None:
        """Check that nothing is left."""
        if self.token.kind != "end":
            raise Flaw(self.token.at, f"{what} does not go on with {self._shown()}")

    def comparison(self) -> Pieces:
        left = self.expression()
        form = _COMPARISONS.get(self.token.text)
        if form is None:
            raise Flaw(
                self.token.at,
                f"a comparison is missing before {self._shown()}",
                f"compare two expressions with one of {' '.join(_COMPARISONS)}",
            )
        self.step()
        return [form[0], *left, form[1], *self.expression(), form[2]]

    def expression(self) -> Pieces:
        pieces = self._term()
        while self.token.text in ("+", "-"):
            pieces.append(self.step().text)
            pieces += self._term()
        return pieces

    def _term(self) -> Pieces:
        pieces = self._factor()
        while self.token.text in ("*", "/"):
            pieces.append(self.step().text)
            pieces += self._factor()
        return pieces

    def _factor(self) -> Pieces:
        sign = [self.step().text] if self.token.text in ("+", "-") else []
        token = self.token
        if token.text == "(":
            return [*sign, "(", *self._in_parentheses(), ")"]
        if token.kind == "number":
            self.step()
            return [*sign, _constant(token)]
        if token.kind != "name":
            raise Flaw(token.at, f"a number or a variable is missing before {self._shown()}")
        self.step()
        name = token.text.upper()
        if self.token.text == "(":
            if name not in FUNCTIONS:
                raise Flaw(
                    token.at, f"there is no function {token.text}", f"functions: {', '.join(FUNCTIONS)}"
                )
            return [*sign, f"{name}(", *self._in_parentheses(), ")"]
        if name in FUNCTIONS:
            raise Flaw(token.at, f"{name} is a function", f"write its argument in parentheses: {name}(V1)")
        return [*sign, Name(name, token.at)]

    def _in_parentheses(self) -> Pieces:
        opening = self.step()
        self._depth += 1
        if self._depth > NESTED_PARENTHESES:
            raise Flaw(opening.at, f"more than {NESTED_PARENTHESES} parentheses inside each other")
        pieces = self.expression()
        self.expect(")", "close the parenthesis")
        self._depth -= 1
        return pieces

    def _read(self) -> _Token:
        found = _TOKEN.match(self._line, self._next, self._stop)
        if found is None:
            rest = self._line[self._next : self._stop]
            at = self._next + len(rest) - len(rest.lstrip(" \t"))
            if rest.strip(" \t"):
                raise Flaw(at, f"'{self._line[at]}' has no meaning in an expression")
            return _Token("end", "", at)
        self._next = found.end()
        place = int(found.lastindex or 0)
        return _Token(("number", "name", "mark")[place - 1], found[place], found.start(place))

    def _shown(self) -> str:
        return f"'{self.token.text}'" if self.token.text else "the end"


def _constant(token: _Token) -> str:
    value = float(token.text)
    if math.isinf(value):
        raise Flaw(token.at, "the number is too large")
    return repr(value)
