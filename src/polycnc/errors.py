"""The error tree: what can go wrong, where it is, and what to do about it.

Every message has the same shape: the first line says what is wrong and where, the last line what to do.
Classes that stand for a usual Python mistake inherit from that one too, so ``except ValueError`` works.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

_EXCERPT_WIDTH = 100


@dataclass(frozen=True, slots=True)
class SourcePosition:
    """Name a place in a text file: 1-based line and column, and the line itself."""

    file: str
    line: int
    column: int
    text: str

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}"

    def excerpt(self) -> str:
        """Return the line with a caret below the column; of a long line, the part around it."""
        caret = self.column - 1
        first = max(0, min(caret - _EXCERPT_WIDTH // 2, len(self.text) - _EXCERPT_WIDTH))
        shown = self.text[first : first + _EXCERPT_WIDTH]
        lead = "".join("\t" if char == "\t" else " " for char in self.text[first:caret])
        return f"    {shown}\n    {lead}^"


class PolycncError(Exception):
    """Root of every error that polycnc raises on purpose."""

    def __init__(self, what: str, *, hint: str = "") -> None:
        super().__init__(what)
        self.what = what
        self.hint = hint
        self.result: object | None = None  # what had been done until then, where there is such a thing

    def __str__(self) -> str:
        return f"{self.what}\n{self.hint}" if self.hint else self.what


class UsageError(PolycncError, ValueError):
    """A call, an option or a configuration that cannot be meant."""


class ConfigurationError(UsageError):
    """A configuration file with an unknown key, a missing key or a value out of range.

    `parts` are all that is wrong with it, each by itself, where it is more than one thing.
    """

    def __init__(
        self,
        what: str,
        *,
        hint: str = "",
        position: SourcePosition | None = None,
        parts: tuple[ConfigurationError, ...] = (),
    ) -> None:
        super().__init__(what, hint=hint)
        self.position = position
        self.parts = parts

    def __str__(self) -> str:
        return _placed(self.what, self.position, self.hint)


class ProgramError(PolycncError):
    """A part program that cannot be run as written.

    `limit` is the axis whose soft limit a move would pass, whether that is the upper one, and whether the move is
    carried out up to it.
    """

    limit: tuple[str, bool, bool] | None = None

    def __init__(
        self, what: str, *, code: str = "", position: SourcePosition | None = None, hint: str = ""
    ) -> None:
        super().__init__(what, hint=hint)
        self.code = code
        self.position = position

    def __str__(self) -> str:
        what = f"{self.what} [{self.code}]" if self.code else self.what
        return _placed(what, self.position, self.hint)


class AlarmError(PolycncError):
    """A machine that has stopped: a limit, a following error, an emergency stop."""

    def __init__(self, what: str, *, code: str = "", time_s: float = 0.0, hint: str = "") -> None:
        super().__init__(what, hint=hint)
        self.code = code
        self.time_s = time_s


class ProtocolError(PolycncError):
    """A peer that sent something outside its protocol."""


def _placed(what: str, position: SourcePosition | None, hint: str) -> str:
    lines = [what] if position is None else [f"{position}: {what}", position.excerpt()]
    if hint:
        lines.append(hint)
    return "\n".join(lines)


def shown(value: object, most: int = 60) -> str:
    """Return a value for a message, in at most so many characters."""
    try:
        text = repr(value)
    except ValueError:  # Python writes no whole number of more than 4,300 digits
        return "a number without end"
    return text if len(text) <= most else f"{text[: most - 3]}..."


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """Return the beginning of a hint that names what a name comes nearest to; empty where nothing is near."""
    from difflib import get_close_matches

    close = get_close_matches(name[:40], list(known), n=1)
    return f"Did you mean '{close[0]}'? " if close else ""
