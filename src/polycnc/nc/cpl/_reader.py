"""Read expressions and calls of a CPL line."""

from __future__ import annotations

import struct

from polycnc.language import END, Flaw, Tokens, read_expression, real_value
from polycnc.nc.cpl._faults import ASSIGNMENT_MISSING, NESTING_TOO_DEEP
from polycnc.nc.cpl._functions import FUNCTIONS
from polycnc.nc.cpl._lexicon import LEXICON, OPERATORS, RESERVED, UNUSED
from polycnc.nc.cpl._syntax import Call, Expression, Name, Number, Parentheses, Text, Word
from polycnc.nc.cpl._variables import variable

PARENTHESES = 7
"""How deep parentheses may be nested where no function is in between (Manual 003, 2.5.1)."""
_NESTING = 40
_CONSTANTS = {"TRUE": True, "FALSE": False, "NUL": None}
_LARGEST_WHOLE_DIGITS = 10


class Reader:
    """Read expressions from the tokens of a stretch of one line."""

    def __init__(self, text: str, start: int, end: int) -> None:
        self.tokens = Tokens(LEXICON, text, start, end, nesting=_NESTING)
        self._parentheses = 0

    def expression(self) -> Expression:
        """Read an expression.

        Raises:
            Flaw: There is none, or it is nested too deeply.
        """
        return read_expression(self.tokens, OPERATORS, self._operand)

    def name(self, what: str) -> Name:
        """Read a variable.

        Raises:
            Flaw: Something else stands there.
        """
        token = self.tokens.token
        if token.kind != "name" or token.word in RESERVED:
            raise Flaw(token.at, f"{what} is missing before {token}")
        self.tokens.step()
        indices = self._indices() if self.tokens.token.word == "(" else ()
        return Name(token.at, variable(token), indices)

    def arguments(self, closing: str) -> tuple[tuple[Expression | None, ...], bool]:
        """Read arguments up to the closing bracket; tell whether a semicolon ends them.

        Raises:
            Flaw: They are wrong, or not closed.
        """
        tokens = self.tokens
        found: list[Expression | None] = []
        tokens.enter(tokens.token.at, "brackets inside each other")
        outside, self._parentheses = self._parentheses, 0
        while True:
            left_out = tokens.token.word in (",", ";", closing)
            found.append(None if left_out else self.expression())
            if not tokens.take(","):
                break
        ends_open = tokens.take(";")
        tokens.expect(closing, f"arguments are separated by commas and closed by {closing}")
        self._parentheses = outside
        tokens.leave()
        if found == [None]:
            found = []
        return tuple(found), ends_open

    def call(self) -> Call:
        """Read a function or command with its arguments.

        Raises:
            Flaw: There is no such function, or its arguments are wrong.
        """
        token = self.tokens.step()
        if token.word in UNUSED or token.word not in FUNCTIONS:
            what = f"{token.word} has no function" if token.word in UNUSED else f"{token} makes no value"
            raise Flaw(token.at, what, "choose another name if it is meant as a variable")
        function = FUNCTIONS[token.word]
        arguments: tuple[Expression | None, ...] = ()
        ends_open = False
        if self.tokens.token.word == "(":
            self.tokens.step()
            arguments, ends_open = self.arguments(")")
        low, high = function.count
        if not low <= len(arguments) <= high:
            wanted = f"{low}" if low == high else f"{low} to {high}"
            raise Flaw(
                token.at, f"{token.word} takes {wanted} arguments, not {len(arguments)}", function.usage
            )
        if ends_open and not function.listed:
            raise Flaw(token.at, f"no semicolon ends the arguments of {token.word}", function.usage)
        return Call(token.at, token.word, arguments, ends_open)

    def _operand(self) -> Expression:
        token = self.tokens.token
        if token.kind == "name" and token.word not in RESERVED:
            return self.name("a value")
        if token.kind == "number":
            self.tokens.step()
            if "." in token.text or len(token.text.lstrip("0")) > _LARGEST_WHOLE_DIGITS:
                return Number(token.at, real_value(token))
            value = int(token.text[-_LARGEST_WHOLE_DIGITS - 1 :])
            return Number(token.at, value if value <= 1 << 31 else float(value))
        if token.kind == "text":
            self.tokens.step()
            return Text(token.at, token.text[1:-1])
        if token.word == "(":
            return self._in_parentheses()
        if token.kind != "name" or token.word in OPERATORS.infix:
            raise Flaw(token.at, f"a value is missing before {token}")
        if token.word in _CONSTANTS:
            self.tokens.step()
            return Word(token.at, _CONSTANTS[token.word])
        return self.call()

    def _in_parentheses(self) -> Expression:
        opening = self.tokens.step()
        if self._parentheses >= PARENTHESES:
            hint = f"at most {PARENTHESES} parentheses may be nested; keep a part in a variable"
            raise Flaw(opening.at, NESTING_TOO_DEEP.what, hint, code=NESTING_TOO_DEEP.code)
        self._parentheses += 1
        self.tokens.enter(opening.at)
        inner = self.expression()
        self.tokens.expect(")", "close the parenthesis")
        self.tokens.leave()
        self._parentheses -= 1
        return Parentheses(opening.at, inner)

    def _indices(self) -> tuple[Expression, ...]:
        tokens = self.tokens
        opening = tokens.step()
        found: list[Expression] = []
        tokens.enter(opening.at, "brackets inside each other")
        outside, self._parentheses = self._parentheses, 0
        found.append(self.expression())
        if tokens.take(","):
            found.append(self.expression())
        tokens.expect(")", "a field has one index or two, in parentheses")
        self._parentheses = outside
        tokens.leave()
        return tuple(found)


def assignment_missing(reader: Reader) -> Flaw:
    """Return the flaw of a word that stands where an assignment is expected."""
    token = reader.tokens.token
    shown = "the end of the line" if token.kind == END else str(token)
    hint = f"a variable is followed by = and its value, not by {shown}; keywords are separated from numbers: GOTO 10"
    return Flaw(token.at, ASSIGNMENT_MISSING.what, hint, code=ASSIGNMENT_MISSING.code)


def single(value: float) -> float:
    """Return a number in single precision.

    Raises:
        OverflowError: It is too large.
    """
    return float(struct.unpack("<f", struct.pack("<f", value))[0])
