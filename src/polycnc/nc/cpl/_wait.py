"""A WAIT under way: what it waits for, since when, and its answer."""

from __future__ import annotations

from collections.abc import Callable

from polycnc.nc.cpl._host import Waiting


class Wait:
    """A WAIT with a condition or a duration, from when the queue has been drained."""

    def __init__(
        self, wait: Waiting, milliseconds: Callable[[], int], *, began_ms: int | None = None
    ) -> None:
        self._wait = wait
        self._milliseconds = milliseconds
        self.began_ms = began_ms
        """When the queue had been drained, None before."""

    @property
    def begun(self) -> bool:
        """Whether the queue has been drained."""
        return self.began_ms is not None

    @property
    def ends_ms(self) -> int | None:
        """When it ends at the latest; None if it has no duration or has not begun."""
        if self.began_ms is None or self._wait.duration_ms is None:
            return None
        return self.began_ms + self._wait.duration_ms

    def answer(self, *, fast_forward: bool = False) -> int | None:
        """Return 0 if the condition holds at once, 2 if it came to, 1 if the time has passed, None for not yet.

        With `fast_forward`, everything waited for comes at once.
        """
        wait = self._wait
        first = self.began_ms is None
        if self.began_ms is None:
            self.began_ms = self._milliseconds() if wait.duration_ms is not None else 0
        if wait.condition is not None and wait.condition():
            return 0 if first else 2
        if fast_forward:
            return 2 if wait.duration_ms is None else 1
        if wait.duration_ms is not None and self._milliseconds() - self.began_ms >= wait.duration_ms:
            return 1
        return None
