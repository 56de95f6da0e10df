"""Expressions of a SAP program with Pascal's four levels of precedence, and what all of the parser shares."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from polycnc.controllers.apci.sap._lexer import KEYWORDS, NAME, NUMBER, SYMBOL, TEXT, SourceText, Token
from polycnc.controllers.apci.sap._syntax import (
    Argument,
    Binary,
    Call,
    Expression,
    Name,
    Number,
    Qualified,
    Text,
    Unary,
)
from polycnc.errors import ProgramError

_MAX_NESTING = 40

# From the loosest to the tightest; NOT and what stands in brackets bind tighter than all.
_COMPARISONS = frozenset({"=", "<>", "<", "<=", ">", ">="})
_ADDING = frozenset({"+", "-", "or", "xor"})
_MULTIPLYING = frozenset({"*", "/", "div", "mod", "and", "shl", "shr"})


class ExpressionParser:
    """Walk over the tokens and read expressions."""

    def __init__(self, source: SourceText, found: list[Token]) -> None:
        self._source = source
        self._tokens = found
        self._position = 0
        self._depth = 0
        self._token = found[0]

    # Tokens

    def _next(self) -> Token:
        """Step over the present token and return it."""
        token = self._token
        self._position = min(self._position + 1, len(self._tokens) - 1)
        self._token = self._tokens[self._position]
        return token

    def _is(self, word: str) -> bool:
        return self._token.word == word and self._token.kind in (NAME, SYMBOL)

    def _take(self, word: str) -> bool:
        if not self._is(word):
            return False
        self._next()
        return True

    def _expect(self, word: str, hint: str) -> Token:
        if not self._is(word):
            raise self._error(f"'{word.upper()}' expected, not {self._token}", hint)
        return self._next()

    def _semicolon(self) -> None:
        if not self._take(";"):
            raise self._error(f"';' expected, not {self._token}", "End it with ';'.")

    def _keyword(self) -> bool:
        return self._token.word in KEYWORDS

    def _name(self, what: str) -> Token:
        if self._token.kind != NAME or self._keyword():
            raise self._error(
                f"{what} expected, not {self._token}", "Is something missing, or a keyword used as a name?"
            )
        return self._next()

    def _error(self, what: str, hint: str) -> ProgramError:
        return self._source.error(self._token.at, what, hint)

    @contextmanager
    def _nested(self) -> Iterator[None]:
        self._depth += 1
        try:
            if self._depth > _MAX_NESTING:
                raise self._error("nested too deeply", f"At most {_MAX_NESTING} levels; use a procedure.")
            yield
        finally:
            self._depth -= 1

    # Expressions

    def _expression(self) -> Expression:
        with self._nested():
            left = self._sum()
            if self._token.word in _COMPARISONS and self._token.kind == SYMBOL:
                sign = self._next()
                left = Binary(sign.word, left, self._sum(), sign.at)
                if self._token.word in _COMPARISONS and self._token.kind == SYMBOL:
                    hint = "Comparisons beside AND, OR need brackets: (a > 1) AND (b > 1)."
                    raise self._error(f"a second comparison, {self._token}", hint)
            return left

    def _sum(self) -> Expression:
        sign = self._next() if self._is("-") or self._is("+") else None
        left = self._term()
        if sign is not None:
            left = Unary(sign.word, left, sign.at)
        while self._token.word in _ADDING and self._token.kind != TEXT:
            operator = self._next()
            left = Binary(operator.word, left, self._term(), operator.at)
        return left

    def _term(self) -> Expression:
        left = self._factor()
        while self._token.word in _MULTIPLYING and self._token.kind != TEXT:
            operator = self._next()
            left = Binary(operator.word, left, self._factor(), operator.at)
        return left

    def _factor(self) -> Expression:
        token = self._token
        if token.kind == NUMBER and not isinstance(token.value, str):
            self._next()
            return Number(token.value, token.at)
        if token.kind == TEXT:
            self._next()
            return Text(str(token.value), token.at)
        if self._is("not") or self._is("-") or self._is("+"):
            self._next()
            with self._nested():
                return Unary(token.word, self._factor(), token.at)
        if self._take("("):
            inner = self._expression()
            self._expect(")", "A '(' is still open.")
            return inner
        return self._name_or_call()

    def _name_or_call(self) -> Name | Qualified | Call:
        name = self._name("a value")
        if self._take("."):
            qualifier = self._name("an axis qualifier")
            return Qualified(name.text, qualifier.text, self._index(), name.at, qualifier.at)
        if self._take("("):
            return Call(name.text, self._arguments(), name.at)
        return Name(name.text, self._index(), name.at)

    def _index(self) -> Expression | None:
        if not self._take("["):
            return None
        index = self._expression()
        self._expect("]", "A '[' is still open.")
        return index

    def _arguments(self) -> tuple[Argument, ...]:
        found: list[Argument] = []
        while not self._is(")"):
            found.append(self._argument())
            if not self._take(","):
                break
        self._expect(")", "Arguments are separated by ',' and closed by ')'.")
        return tuple(found)

    def _argument(self) -> Argument:
        at = self._token.at
        value = self._expression()
        name = ""
        if isinstance(value, Name) and value.index is None and self._take(":="):
            name = value.name
            value = self._expression()
        formats: list[Expression] = []
        while len(formats) < 2 and self._take(":"):
            formats.append(self._expression())
        return Argument(name, value, tuple(formats), at)
