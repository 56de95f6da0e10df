"""The way from queue items into the channel queue of the kernel."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

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
from polycnc.nc._moves import Arc, Feed, Line, QueueItem, Wait

NO_EVENT = -1


@dataclass(frozen=True, slots=True)
class Event:
    """An auxiliary function that the path has come to: its words and the program line."""

    word: str
    line: int


@dataclass
class QueueWriter:
    """Append items to path `path` of the kernel; `make_room` is called when the queue is full."""

    seg: Segments
    paths: Paths
    limits: AxisLimits
    path: int = 0
    make_room: Callable[[], None] = lambda: None
    events: list[Event] = field(default_factory=list)

    def set_tolerance(self, tolerance_mm: float) -> None:
        """Set how far the path may leave the corners of lines appended from now on."""
        self.paths.row[self.path]["tolerance"] = tolerance_mm

    def put(self, item: QueueItem) -> None:
        """Append one line, arc or wait."""
        if free_slots(self.paths, self.path) < 2:
            self.make_room()
        match item:
            case Line():
                self._put_line(item)
            case Arc():
                self._put_arc(item)
            case Wait():
                self._put_wait(item)

    def _put_line(self, item: Line) -> None:
        speed = math.inf if item.rapid else self._speed(item.feed, self._line_length(item.start, item.end))
        flags = (RAPID if item.rapid else 0) | (STOP if item.exact_stop else 0)
        append_line(self.seg, self.paths, self.path, self.limits, np.array(item.end), speed, flags, item.line)

    def _put_arc(self, item: Arc) -> None:
        p, q = item.plane[:2]
        radius = math.hypot(item.start[p] - item.center[0], item.start[q] - item.center[1])
        rest = [
            (end - start) ** 2
            for i, (start, end) in enumerate(zip(item.start, item.end, strict=True))
            if i not in (p, q) and self.limits.feed_axis[i]
        ]
        length = math.sqrt((radius * item.sweep_rad) ** 2 + sum(rest))
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
            self._speed(item.feed, length),
            STOP if item.exact_stop else 0,
            item.line,
        )

    def _put_wait(self, item: Wait) -> None:
        duration = item.duration_s
        if not item.events:
            append_wait(self.seg, self.paths, self.path, duration, NO_EVENT, item.line)
        for word in item.events:
            self.events.append(Event(word, item.line))
            append_wait(self.seg, self.paths, self.path, 0.0, len(self.events) - 1, item.line)
        if item.events and duration > 0.0:
            append_wait(self.seg, self.paths, self.path, duration, NO_EVENT, item.line)

    def _line_length(self, start: tuple[float, ...], end: tuple[float, ...]) -> float:
        squares = [(b - a) ** 2 for a, b in zip(start, end, strict=True)]
        counted = math.sqrt(
            sum(s for s, counts in zip(squares, self.limits.feed_axis, strict=True) if counts)
        )
        return counted if counted > 0.0 else math.sqrt(sum(squares))

    @staticmethod
    def _speed(feed: Feed, length: float) -> float:
        """Return the path speed; a feed by time needs the length of the move."""
        return length / feed.duration_s if feed.duration_s > 0.0 else feed.speed_mm_s
