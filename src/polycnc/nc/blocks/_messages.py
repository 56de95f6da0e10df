"""What the operator should know: each message once, with the line where it first came up."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeAlias

NOT_EXECUTED = ", which is an alarm where it is executed"
"""The end of the message on a statement that has not been executed, and would be an alarm."""
CODE_SYSTEM = ": this program is read in G code system A, --dialect fanuc-lathe-b reads system B"
"""The end of the message on a code that means something else in other code systems."""
_SHOWN = "MSG: "


@dataclass(frozen=True, slots=True)
class Message:
    """A remark on a program: text, and the first line (0: the whole program) and how often it came up."""

    text: str
    line: int
    count: int = 1


SavedMessages: TypeAlias = tuple[dict[str, Message], str, tuple[tuple[int, str], ...]]


def _at_once() -> int:
    return 0


@dataclass
class Messages:
    """Collect messages about the present `line`, each text once with a count.

    `ahead` counts the segments before the block that is being prepared: its message is shown where the path has got
    to it.
    """

    line: int = 0
    ahead: Callable[[], int] = _at_once
    _latest: str = ""
    _coming: deque[tuple[int, str]] = field(default_factory=deque)
    _found: dict[str, Message] = field(default_factory=dict)

    def add(self, text: str) -> None:
        """Add a message about the present line."""
        self._note(text, self.line, self.ahead())

    def note(self, text: str, line: int) -> None:
        """Add a message about any line, which is shown at once."""
        self._note(text, line, 0)

    def latest(self, head: int) -> str:
        """Return what was shown last where the path has traversed `head` segments."""
        while self._coming and self._coming[0][0] <= head:
            self._latest = self._coming.popleft()[1]
        return self._latest

    def _note(self, text: str, line: int, ahead: int) -> None:
        old = self._found.get(text)
        self._found[text] = Message(text, line) if old is None else Message(text, old.line, old.count + 1)
        if not text.startswith(_SHOWN):
            return
        if ahead:
            self._coming.append((ahead, text.removeprefix(_SHOWN)))
        else:
            self._latest = text.removeprefix(_SHOWN)

    def snapshot(self) -> SavedMessages:
        """Return all messages, the one shown last and those to come, to go back to."""
        return dict(self._found), self._latest, tuple(self._coming)

    def restore(self, saved: SavedMessages) -> None:
        """Go back to a snapshot."""
        found, self._latest, coming = saved
        self._found, self._coming = dict(found), deque(coming)

    def all(self) -> list[Message]:
        """Return all messages in the order in which they first came up."""
        return list(self._found.values())
