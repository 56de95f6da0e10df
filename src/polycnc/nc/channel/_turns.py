"""How much of a program is prepared in one control cycle, before time has to pass.

It is counted for each cycle of the clock, never for each call, so it does not matter how time is cut into calls.
"""

from __future__ import annotations

from typing import NamedTuple

from polycnc.machine import Clock

TURNS_PER_CYCLE = 2000
"""Blocks with something for the queue that are prepared in one control cycle at the most."""
BARREN_TURNS = 50
"""What a block counts that takes no time, or a call: of such ones there are 40 in a cycle."""
PLAIN_PER_TURN = 64
"""Plain blocks that the compiled kernel prepares in the time of one turn."""


class SavedTurns(NamedTuple):
    """What was prepared in which cycle, to go back to; see `Turns`."""

    cycle: int
    taken: int
    paused: bool
    looks: tuple[tuple[str, int], ...]


class Turns:
    """Count what is prepared in the present cycle of `clock`.

    `paused` is set while preparation has done all that it may in a cycle and wants to go on in the next one.
    """

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._cycle = -1
        self._taken = 0
        self._looks: set[tuple[str, int]] = set()
        self.paused = False

    def begin(self) -> bool:
        """Take note that preparation goes on; False where nothing more is prepared in this cycle."""
        cycle = self._clock.cycles
        if self._cycle == cycle:
            return not self.paused
        self._cycle, self._taken = cycle, 0
        if not self.paused:
            self._looks.clear()
        self.paused = False
        return True

    def take(self, turns: int = 1) -> None:
        """Count turns; after the last one of a cycle preparation pauses."""
        self._taken += turns
        if self._taken >= TURNS_PER_CYCLE:
            self.pause()

    def pause(self) -> None:
        """Let preparation go on in the next cycle."""
        self._looks.clear()
        self.paused = True

    def look(self, program: str, line: int) -> None:
        """Count a block that reads what only cycles change; where it has done so in this one, preparation pauses."""
        place = program, line
        if place in self._looks:
            self.pause()
        self._looks.add(place)  # what pauses now is read with the next cycle, and is its look

    def forget(self) -> None:
        """Begin anew, as if a cycle had passed."""
        self.restore(SavedTurns(-1, 0, False, ()))

    def snapshot(self) -> SavedTurns:
        """Return what has been counted, to go back to."""
        return SavedTurns(self._cycle, self._taken, self.paused, tuple(sorted(self._looks)))

    def restore(self, saved: SavedTurns) -> None:
        """Go back to a snapshot."""
        self._cycle, self._taken, self.paused = saved.cycle, saved.taken, saved.paused
        self._looks = set(saved.looks)
