"""Where a program run comes to rest between blocks: single block, steps, breakpoints.

Blocks are told apart by the tags of their segments; blocks that leave nothing in the queue stand there as marks. Stops
are found in the queue, ahead of the path, so it brakes for them within its limits.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import Enum
from typing import TypeAlias

from polycnc.nc import BlockRecords, line_of

Condition: TypeAlias = Callable[[], bool]


class Step(Enum):
    """How far the program goes on from where it stands at a block."""

    RUN = "run"  # to the next breakpoint
    INTO = "into"  # one block, into a sub-program
    OVER = "over"  # one block, a sub-program that it calls as a whole
    OUT = "out"  # after the sub-program


@dataclass(frozen=True, slots=True)
class Breakpoint:
    """Stop before the block on `line` of `program`, or where `condition` has become true.

    A line of 0 is every block. The condition is asked when a block has been prepared, since variables change then;
    with a line it is asked before the blocks of that line only. While there is a condition, blocks are prepared one by
    one.
    """

    program: str = ""
    line: int = 0
    condition: Condition | None = None


@dataclass(frozen=True, slots=True)
class Boundary:
    """A point between two blocks: the count of the segment after it, and the tag of the block that comes there."""

    count: int
    tag: int


@dataclass
class Stopper:
    """Decide at which boundaries a run stops.

    With `alone` (the switch of single blocks) every block is prepared when it is started, not before.
    """

    records: BlockRecords
    step: Step = Step.RUN
    alone: bool = False
    depth: int = 0  # of the block from which a step began
    breakpoints: frozenset[Breakpoint] = frozenset()

    @property
    def idle(self) -> bool:
        """Whether there is nothing to stop for."""
        return self.step is Step.RUN and not self.breakpoints

    @property
    def has_conditions(self) -> bool:
        """Whether blocks must be looked at one by one while they are prepared."""
        return any(each.condition is not None for each in self.breakpoints)

    def stops_before(self, tag: int) -> bool:
        """Tell whether the path stops before the block of a tag, whose predecessor has just ended."""
        if self.step is Step.INTO:
            return True
        if self.step is not Step.RUN and self.records.depth(tag) < self.depth + (self.step is Step.OVER):
            return True
        line = line_of(tag)
        return any(
            each.line == line and each.condition is None and self._in_program(each, tag)
            for each in self.breakpoints
        )

    def condition_met(self, tag: int) -> bool:
        """Tell whether a condition has become true with the block of a tag, which has just been prepared."""
        line = line_of(tag)
        return any(
            each.condition is not None
            and each.line in (0, line)
            and self._in_program(each, tag)
            and each.condition()
            for each in self.breakpoints
        )

    def _in_program(self, each: Breakpoint, tag: int) -> bool:
        return not each.program or self.records.program(tag) == each.program


def boundaries(
    first: int, tags: list[int], marks: Iterator[tuple[int, int]], before: int | None
) -> Iterator[Boundary]:
    """Yield the boundaries in a stretch of the queue in order: segments from count `first` on with these tags.

    `marks` lie at counts from `first` on. `before` is the tag of the segment before the first, None if there is none.
    """
    mark = next(marks, None)
    last = before
    for count, tag in enumerate(tags, first):
        while mark is not None and mark[0] <= count:
            yield Boundary(mark[0], mark[1])
            mark = next(marks, None)
            last = None
        if tag != last:
            yield Boundary(count, tag)
        last = tag
    while mark is not None:
        yield Boundary(mark[0], mark[1])
        mark = next(marks, None)
