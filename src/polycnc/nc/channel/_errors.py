"""The errors of a program: each once, and when there are enough of them."""

from __future__ import annotations

from collections.abc import Iterable

from polycnc.errors import ProgramError
from polycnc.nc.blocks._interpreter import Unread
from polycnc.nc.blocks._messages import Messages

_MOST_ERRORS = 1000


class Errors:
    """Keep the errors that preparation has met in `all`; `over` is set when nothing more is to be prepared.

    With `collects` that is after very many, else after the first.
    """

    def __init__(self, messages: Messages, *, collects: bool) -> None:
        self.all: list[ProgramError] = []
        self.collects = collects
        self.over = False
        self._messages = messages
        self._known: set[str] = set()

    def note(self, error: ProgramError) -> None:
        """Note an error once, however often its block is repeated; none that follows from another one."""
        if isinstance(error, Unread) and self.all:
            return
        text = str(error)
        if text not in self._known:
            self._known.add(text)
            self.all.append(error)
        if len(self.all) >= _MOST_ERRORS:
            self._messages.note(f"the program was checked up to its error number {_MOST_ERRORS}", 0)
            self.over = True
        self.over = self.over or not self.collects

    def restore(self, errors: Iterable[ProgramError]) -> None:
        """Go back to the errors that there were."""
        self.all[:] = errors
        self._known = {str(error) for error in self.all}
        self.over = False
