"""Which blocks the segments in a path's queue are of, and which blocks leave no segments in it."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from polycnc.kernel import HELD, RUNNING

PIECE = 256
"""Segments looked at together for the end of a block."""


class QueuedBlocks:
    """The blocks in the queue of a path.

    Args:
        row: The path's row of the kernel's table.
        tags: The tag of each segment's block, of all paths.
        marks: Returns the blocks without segments: the segment count before which each lies, and its tag.
    """

    def __init__(
        self, row: Any, tags: npt.NDArray[np.int64], marks: Callable[[], deque[tuple[int, int]] | None]
    ) -> None:
        self.row = row
        self._tags = tags
        self._marks = marks

    def tags(self, first: int, after: int) -> list[int]:
        """Return the tags of segments `first` up to `after`."""
        counts = np.arange(first, after)
        slots = self.row["base"] + counts % self.row["capacity"]
        tags: list[int] = self._tags[slots].tolist()
        return tags

    def next_tag(self) -> int | None:
        """Return the tag of the block that comes next, None if it has not been prepared."""
        marks, head = self._marks(), int(self.row["head"])
        if marks and self.at_mark:
            return marks[0][1]
        return self.tags(head, head + 1)[0] if head < self.row["tail"] else None

    def pass_marks(self) -> None:
        """Forget the blocks without segments that lie before segments that have been traversed."""
        marks, head = self._marks(), int(self.row["head"])
        while marks and marks[0][0] < head:
            marks.popleft()

    def take_mark(self) -> int | None:
        """Take the block without segments that comes next; return its tag, None if a segment comes next."""
        marks = self._marks()
        return marks.popleft()[1] if marks and self.at_mark else None

    @property
    def at_mark(self) -> bool:
        """Whether a block without segments comes next."""
        marks = self._marks()
        return bool(marks and marks[0][0] <= self.row["head"])

    def forget_passed(self) -> None:
        """Forget the blocks without segments that the path has passed."""
        marks, row = self._marks(), self.row
        passed = int(row["head"]) - (row["state"] not in (RUNNING, HELD))
        while marks and marks[0][0] <= passed:
            marks.popleft()
