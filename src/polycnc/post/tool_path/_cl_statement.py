"""One statement of an APT tool path: its major word, what follows, and where each part stands in the file."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass

from polycnc.errors import ProgramError, SourcePosition

_TOKEN = re.compile(r"[^\s,()/]+")
# Digits are gone through once, however many they are.
_NUMBER = re.compile(r"[+-]?(?:\d++\.?\d*+|\.\d++)(?:[EeDd][+-]?\d++)?")


@dataclass(frozen=True, slots=True)
class Piece:
    """A line of a statement: its number, its whole text, and the part of it that counts."""

    line: int
    text: str
    part: str


@dataclass(frozen=True, slots=True)
class Token:
    """A word or number, in capital letters, and its place in the joined pieces."""

    text: str
    place: int

    @property
    def number(self) -> float | None:
        """The value, None if this is no number."""
        if _NUMBER.fullmatch(self.text) is None:
            return None
        return float(self.text.replace("D", "E"))


class Statement:
    """A statement in the order in which its handler takes it: words by name, numbers one by one.

    `major` is the text before the slash, without blanks; without a slash the first word.
    """

    def __init__(self, file: str, pieces: list[Piece]) -> None:
        self.file = file
        self.pieces = pieces
        self.line = pieces[0].line
        joined = "".join(piece.part for piece in pieces)
        head, slash, rest = joined.partition("/")
        if not slash:
            first = _TOKEN.search(joined)
            end = first.end() if first else len(joined)
            if first and first.start() and not joined[: first.start()].isspace():
                end = len(joined)
            head, rest = joined[:end], joined[end:]
        self.rest = rest
        self.major = "".join(head.split()).upper()
        at = len(joined) - len(rest)
        self._tokens = [
            Token(found[0].upper(), at + found.start()) for found in _TOKEN.finditer(rest)
        ]  # fmt: skip
        self._next = 0

    def __iter__(self) -> Iterator[Token]:
        """Yield the tokens that are left, and take them."""
        while self._next < len(self._tokens):
            self._next += 1
            yield self._tokens[self._next - 1]

    def words(self) -> set[str]:
        """Return the words that stand in the statement."""
        return {token.text for token in self._tokens if token.number is None}

    def peek(self) -> Token | None:
        """Return the next token, None at the end."""
        return self._tokens[self._next] if self._next < len(self._tokens) else None

    def number(self, what: str) -> float:
        """Take a number.

        Raises:
            ProgramError: there is none.
        """
        token = self.peek()
        if token is None:
            raise self.fail(f"{self.major} needs {what}", f"Write it after {self.major}/.")
        value = token.number
        if value is None:
            raise self.fail(
                f"'{token.text}' is no number: {self.major} needs {what}", "Write a number.", token
            )
        self._next += 1
        return self._sane(token, value)

    def numbers(self) -> list[float]:
        """Take the numbers up to the next word."""
        found = []
        while (token := self.peek()) is not None and (value := token.number) is not None:
            found.append(self._sane(token, value))
            self._next += 1
        return found

    def first_number(self) -> float | None:
        """Take everything up to the first number that is left, and return that; None if there is none."""
        for token in self:
            if (value := token.number) is not None:
                return self._sane(token, value)
        return None

    def whole(self, value: float | None, what: str) -> int | None:
        """Return a number that has to be whole, and not below 0; None stays None.

        Raises:
            ProgramError: it is another one.
        """
        if value is None:
            return None
        if not value.is_integer() or value < 0.0:
            raise self.fail(f"{what} must be a whole number, not {value:g}", "Check it.")
        return int(value)

    def _sane(self, token: Token, value: float) -> float:
        if math.isinf(value):
            raise self.fail(f"the number {token.text:.20} is beyond all others", "Check it.", token)
        return value

    def value_of(self, word: str, what: str) -> float | None:
        """Return the number after a word, wherever it stands; None if the word is not there.

        Raises:
            ProgramError: no number stands after the word.
        """
        for index, token in enumerate(self._tokens):
            if token.text == word:
                after = self._tokens[index + 1] if index + 1 < len(self._tokens) else None
                value = after.number if after is not None else None
                if value is None:
                    raise self.fail(f"{word} needs {what}", f"Write it after {word}, like {word},5.", token)
                return self._sane(token, value)
        return None

    def fail(self, what: str, hint: str, at: Token | None = None) -> ProgramError:
        """Return the error for a token, or for the statement."""
        return ProgramError(what, position=self._position(at.place if at else None), hint=hint)

    def _position(self, place: int | None) -> SourcePosition:
        if place is not None:
            for piece in self.pieces:
                if place < len(piece.part):
                    column = piece.text.find(piece.part) + place + 1
                    return SourcePosition(self.file, piece.line, column, piece.text)
                place -= len(piece.part)
        first = self.pieces[0]
        column = len(first.text) - len(first.text.lstrip()) + 1
        return SourcePosition(self.file, first.line, column, first.text)
