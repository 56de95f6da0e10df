"""The way from queue items into the channel queue of the kernel."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from polycnc.errors import UsageError
from polycnc.kernel import (
    RAPID,
    STOP,
    AxisLimits,
    Paths,
    Segments,
    append_arc,
    append_line,
    append_wait,
    free_slots,
)
from polycnc.nc.blocks._moves import Arc, Feed, Line, QueueItem, Wait

NO_EVENT = -1


class ExecutionStoppedError(Exception):
    """Nobody goes along the path any more, so the queue stays full and preparation is over."""


@dataclass(frozen=True, slots=True)
class Event:
    """An auxiliary function that the path has come to: its words and the program line."""

    word: str
    line: int


def _nobody_makes_room() -> None:
    raise UsageError(
        "the channel queue is full in the middle of a block",
        hint="Give `on_full_queue` something that runs part of the queue.",
    )


@dataclass
class QueueWriter:
    """Append items to path `path` of the kernel; `make_room` is called when the queue is full."""

    seg: Segments
    paths: Paths
    limits: AxisLimits
    path: int = 0
    make_room: Callable[[], None] = _nobody_makes_room
    events: list[Event] = field(default_factory=list)

    def set_tolerance(self, tolerance_mm: float) -> None:
        """Set how far the path may leave the corners of lines appended from now on."""
        self.paths.row[self.path]["tolerance"] = tolerance_mm

    def put(self, item: QueueItem) -> None:
        """Append one line, arc or wait.

        Raises:
            ExecutionStoppedError: the queue stays full.
        """
        match item:
            case Line():
                self._put_line(item)
            case Arc():
                self._put_arc(item)
            case Wait():
                self._put_wait(item)

    def _ensure_room(self) -> None:
        """See to the two slots that a line with a rounded corner needs."""
        if free_slots(self.paths, self.path) < 2:
            self.make_room()
            if free_slots(self.paths, self.path) < 2:
                raise ExecutionStoppedError

    def _put_line(self, item: Line) -> None:
        self._ensure_room()
        speed = math.inf if item.rapid else self._speed(item.feed, self._line_length(item))
        flags = (RAPID if item.rapid else 0) | (STOP if item.exact_stop else 0)
        append_line(self.seg, self.paths, self.path, self.limits, np.array(item.end), speed, flags, item.line)

    def _put_arc(self, item: Arc) -> None:
        self._ensure_room()
        p, q = item.plane[:2]
        append_arc(
            self.seg,
            self.paths,
            self.path,
            self.limits,
            np.array(item.end),
            p,
            q,
            item.center[0],
            item.center[1],
            item.sweep_rad,
            self._speed(item.feed, self._arc_length(item)),
            STOP if item.exact_stop else 0,
            item.line,
        )

    def _put_wait(self, item: Wait) -> None:
        for word in item.events:
            self.events.append(Event(word, item.line))
            self._append_wait(0.0, len(self.events) - 1, item.line)
        if item.duration_s > 0.0 or not item.events:
            self._append_wait(item.duration_s, NO_EVENT, item.line)

    def _append_wait(self, duration_s: float, event: int, line: int) -> None:
        self._ensure_room()
        append_wait(self.seg, self.paths, self.path, duration_s, event, line)

    def _line_length(self, item: Line) -> float:
        """Return the length as the kernel counts it: of the axes that count, else of the others."""
        if item.feed.duration_s <= 0.0:
            return 0.0  # nothing needs it
        squares = [(b - a) ** 2 for a, b in zip(item.start, item.end, strict=True)]
        counted = math.sqrt(
            sum(s for s, counts in zip(squares, self.limits.feed_axis, strict=True) if counts)
        )
        return counted if counted > 0.0 else math.sqrt(sum(squares))

    def _arc_length(self, item: Arc) -> float:
        if item.feed.duration_s <= 0.0:
            return 0.0
        p, q = item.plane[:2]
        radius = math.hypot(item.start[p] - item.center[0], item.start[q] - item.center[1])
        rest = [
            (end - start) ** 2
            for i, (start, end) in enumerate(zip(item.start, item.end, strict=True))
            if i not in (p, q) and self.limits.feed_axis[i]
        ]
        return math.sqrt((radius * item.sweep_rad) ** 2 + sum(rest))

    @staticmethod
    def _speed(feed: Feed, length: float) -> float:
        """Return the path speed; a feed by time needs the length of the move."""
        return length / feed.duration_s if feed.duration_s > 0.0 else feed.speed_mm_s
