"""When a machine is looked at without being asked: at cycles of its own clock that do not depend on how time is cut."""

from __future__ import annotations

from collections.abc import Callable

from polycnc.machine import Clock

BUSY_S, IDLE_S = 0.1, 1.0
"""How often, in the machine's own time: while something moves that somebody wants to see, and otherwise."""


class Watch:
    """Call `look` at multiples of a time of the machine's clock; `often` says whether the shorter one holds."""

    def __init__(self, clock: Clock, often: Callable[[], bool], look: Callable[[], object]) -> None:
        self._clock = clock
        self._often = often
        self._look = look
        self._steps = clock.cycles_for(BUSY_S), clock.cycles_for(IDLE_S)
        self._due = self._next()

    def _next(self) -> int:
        step = max(1, self._steps[0] if self._often() else self._steps[1])
        return (self._clock.cycles // step + 1) * step

    def cycles_left(self) -> int:
        """Return how many cycles may pass before it looks; something may have begun since it was last asked."""
        now = self._clock.cycles
        if self._due - now > self._steps[1]:  # time was set back
            self._due = self._next()
        elif self._often():
            self._due = min(self._due, self._next())
        return max(1, self._due - now)

    def passed(self) -> None:
        """Look, if it is time to."""
        if self._clock.cycles >= self._due:
            self._look()
            self._due = self._next()
