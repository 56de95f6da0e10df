"""Where a searched program begins and ends: lines of the main program, each told before it is executed."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(slots=True)
class Bounds:
    """The block that is searched and the last one that is executed, by their lines; 0 is none."""

    first: int
    last: int
    reached: bool = False
    """Whether the last block has begun."""

    def end_before(self, line: int) -> bool:
        """Take note that a line comes next; tell whether the program ends before it."""
        if line == self.last:
            self.reached = True
        return self.reached and line != self.last
