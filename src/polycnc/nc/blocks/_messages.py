"""What the operator should know: each message once, with the line where it first came up."""

from __future__ import annotations

from dataclasses import dataclass, field

_SHOWN = "MSG: "


@dataclass(frozen=True, slots=True)
class Message:
    """A remark on a program: text, and the first line (0: the whole program) and how often it came up."""

    text: str
    line: int
    count: int = 1


@dataclass
class Messages:
    """Collect messages about the present `line`, each text once with a count. `latest` is what was shown last."""

    line: int = 0
    latest: str = ""
    _found: dict[str, Message] = field(default_factory=dict)

    def add(self, text: str) -> None:
        """Add a message about the present line."""
        self.note(text, self.line)

    def note(self, text: str, line: int) -> None:
        """Add a message about any line."""
        old = self._found.get(text)
        self._found[text] = Message(text, line) if old is None else Message(text, old.line, old.count + 1)
        self._show(text)

    def _show(self, text: str) -> None:
        if text.startswith(_SHOWN):
            self.latest = text.removeprefix(_SHOWN)

    def snapshot(self) -> tuple[dict[str, Message], str]:
        """Return all messages and the one shown last, to go back to."""
        return dict(self._found), self.latest

    def restore(self, saved: tuple[dict[str, Message], str]) -> None:
        """Go back to a snapshot."""
        found, self.latest = saved
        self._found = dict(found)

    def all(self) -> list[Message]:
        """Return all messages in the order in which they first came up."""
        return list(self._found.values())
