"""Cut text into tokens by a table of patterns, and step over them."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import NamedTuple

from polycnc.language._source import Flaw

END = "end"
"""The kind of the token after the last one."""
_SHOWN = 30


def clipped(text: str, most: int = _SHOWN) -> str:
    """Return a text as a message shows it, without the end of a long one."""
    return text if len(text) <= most else f"{text[:most]}..."


class Token(NamedTuple):
    """A piece of text: its kind, how it is written, and its offset. `word` is what it is compared by."""

    kind: str
    word: str
    text: str
    at: int

    def __str__(self) -> str:
        if self.kind == END:
            return "the end"
        return f"'{clipped(self.text)}'"


_NONE = Token("", "", "", 0)


class Lexicon:
    """The kinds of tokens of a language, each with its pattern, in the order in which they are tried.

    `skip` matches what may stand between tokens. Kinds in `folded` are compared in capitals. A pattern has no
    groups that capture, and matches at least one character. `short` are the words that others stand for. `unfinished`
    says what a character means that begins no token: what is wrong, and what to do.
    """

    def __init__(
        self,
        kinds: Sequence[tuple[str, str]],
        *,
        skip: str = r"[ \t]*",
        folded: Sequence[str] = (),
        short: Mapping[str, str] | None = None,
        unfinished: dict[str, tuple[str, str]] | None = None,
    ) -> None:
        self._kinds = (("", False), *((kind, kind in folded) for kind, _ in kinds))
        self._pattern = re.compile(f"(?:{skip})(?:{'|'.join(f'({pattern})' for _, pattern in kinds)})")
        self._row_pattern = re.compile(f"{self._pattern.pattern}|(?:{skip})[^ \\t]", re.DOTALL)
        self._skip = re.compile(skip)
        self._short = short or {}
        self._unfinished = unfinished or {}

    def row(self, text: str, at: int, end: int) -> list[Token]:
        """Return the tokens from `at` on as far as they follow each other; the last is END if nothing else is left."""
        tokens: list[Token] = []
        kinds, short, new, put = self._kinds, self._short, tuple.__new__, tokens.append
        for found in self._row_pattern.finditer(text, at, end):
            index = found.lastindex
            if index is None:  # no token begins here
                return tokens
            kind, folded = kinds[index]
            written = found[index]
            word = written.upper() if folded else written
            word = short.get(word, word) if short else word
            put(new(Token, (kind, word, written, found.end() - len(written))))
        put(new(Token, (END, "", "", end)))
        return tokens

    def read(self, text: str, at: int, end: int) -> tuple[Token, int]:
        """Return the token at or after `at`, and the offset after it.

        Raises:
            Flaw: No token begins there.
        """
        found = self._pattern.match(text, at, end)
        if found is None:
            blank = self._skip.match(text, at, end)
            at = at if blank is None else blank.end()
            if at >= end:
                return Token(END, "", "", at), at
            what = f"{text[at]!r} has no meaning here"
            raise Flaw(at, *self._unfinished.get(text[at], (what, "")))
        index: int = found.lastindex  # type: ignore[assignment]
        kind, folded = self._kinds[index]
        written = found[index]
        word = written.upper() if folded else written
        return Token(kind, self._short.get(word, word), written, found.start(index)), found.end()


class Tokens:
    """Step through the tokens of a stretch of text, one token ahead.

    Nothing may be nested deeper than `nesting`: readers that call themselves do it inside `nested`.
    """

    def __init__(
        self, lexicon: Lexicon, text: str, start: int = 0, end: int | None = None, *, nesting: int = 50
    ) -> None:
        self._lexicon = lexicon
        self._text = text
        self._end = len(text) if end is None else end
        self._nesting = nesting
        self._depth = 0
        self._before = self.token = _NONE
        self.jump(start)

    @property
    def after(self) -> int:
        """Return the offset at which the token before the present one ends."""
        return self._before.at + len(self._before.text)

    @property
    def next_at(self) -> int:
        """Return the offset after the present token."""
        return self.token.at + len(self.token.text)

    def step(self) -> Token:
        """Return the token and go to the next one."""
        self._before = token = self.token
        self.token = next(self._row, None) or self._lexicon.read(self._text, self.after, self._end)[0]
        return token

    def jump(self, at: int) -> None:
        """Go on with the token at an offset."""
        self._before = tuple.__new__(Token, ("", "", "", at))
        self._row = iter(self._lexicon.row(self._text, at, self._end))
        self.token = next(self._row, None) or self._lexicon.read(self._text, at, self._end)[0]

    def take(self, word: str) -> bool:
        """Step over a word or mark if it comes next, and tell whether it did."""
        if self.token.word != word:
            return False
        self.step()
        return True

    def expect(self, word: str, hint: str = "") -> Token:
        """Step over a word or mark that must come next.

        Raises:
            Flaw: Something else comes.
        """
        if self.token.word != word:
            raise Flaw(self.token.at, f"'{word}' is missing before {self.token}", hint)
        return self.step()

    def end(self, what: str, hint: str = "") -> None:
        """Check that nothing is left.

        Raises:
            Flaw: `what` goes on.
        """
        if self.token.kind != END:
            raise Flaw(self.token.at, f"{what} does not go on with {self.token}", hint)

    def enter(self, at: int, what: str = "parentheses inside each other") -> None:
        """Begin something inside something else; `leave` ends it.

        Raises:
            Flaw: It is nested too deeply.
        """
        if self._depth >= self._nesting:
            raise Flaw(at, f"more than {self._nesting} {what}", "split it and keep a part in a variable")
        self._depth += 1

    def leave(self) -> None:
        """End what `enter` has begun."""
        self._depth -= 1

    @contextmanager
    def nested(self, at: int, what: str = "parentheses inside each other") -> Iterator[None]:
        """Read something inside something else.

        Raises:
            Flaw: It is nested too deeply.
        """
        self.enter(at, what)
        yield
        self.leave()


def real_value(token: Token, largest: float = math.inf) -> float:
    """Return the number that a token spells, whatever its length.

    Raises:
        Flaw: It is too large.
    """
    value = float(token.text)
    if math.isinf(value) or value > largest:
        raise Flaw(token.at, f"the number {token} is too large")
    return value


def whole_value(token: Token, largest: int, what: str = "the number") -> int:
    """Return the whole number that a token spells in decimal digits, whatever its length.

    Raises:
        Flaw: It is too large.
    """
    digits = token.text.lstrip("0") or "0"  # before int(), which refuses thousands of them
    if len(digits) > len(str(largest)) or int(digits) > largest:
        raise Flaw(token.at, f"{what} {token} is too large", f"the largest is {largest}")
    return int(digits)
