"""A question that comes again: whoever polls sends the same bytes each time, which need not be read each time.

An application that can answer a question again puts what answers it into `scope["state"]`, by the name `AGAIN`. That it
is answered has been decided by then: who asks, by which name and with which secret stands in those same bytes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

from starlette.types import Scope

AGAIN = "again"
_END = b"\r\n\r\n"
_MORE = frozenset({b"content-length", b"transfer-encoding", b"expect", b"upgrade"})
"""Headers of questions that do not end with their headers."""


class Said(NamedTuple):
    """An answer with status 200."""

    headers: list[tuple[bytes, bytes]]
    body: bytes


Again: TypeAlias = Callable[[], Said | None]
"""Answer the same question once more; None where it has to be asked in full."""


def answers_again(scope: Scope, again: Again) -> None:
    """Let a question be answered by this, if it comes again on its connection."""
    scope.setdefault("state", {})[AGAIN] = again


def again_of(scope: Scope) -> Again | None:
    """Return what answers a question again, if anything does."""
    found: Again | None = scope.get("state", {}).get(AGAIN)
    return found


@dataclass(frozen=True, slots=True)
class Repeated:
    """A question, whole and alone, with what answers it."""

    question: bytes
    again: Again

    def answer(self, headers: Sequence[tuple[bytes, bytes]]) -> bytes | None:
        """Return the answer as it is sent, with these headers before its own; None where it has to be asked in full."""
        said = self.again()
        if said is None:
            return None
        lines = [b"%b: %b\r\n" % each for each in (*headers, *said.headers)]
        return b"".join((b"HTTP/1.1 200 OK\r\n", *lines, b"\r\n", said.body))


def repeated_of(question: bytes, scope: Scope) -> Repeated | None:
    """Return what a question that was answered needs to be answered again; None where it cannot be."""
    again = again_of(scope)
    if again is None or scope["method"] != "GET":
        return None
    is_whole = question.endswith(_END) and question.count(_END) == 1
    if not is_whole or any(name in _MORE for name, _ in scope["headers"]):
        return None
    return Repeated(question, again)
