"""The way from queue items into the channel queue of the kernel."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from polycnc.kernel import (
    GEO_WAIT_S,
    NOT_MERGED,
    NOT_SMALL,
    RAPID,
    STOP,
    WAIT,
    WITH_SPINDLE,
    AxisLimits,
    Paths,
    Segments,
    append_arc,
    append_line,
    append_small_arc,
    append_spline,
    append_wait,
    close_line,
    free_slots,
    merge_line,
)
from polycnc.nc.blocks._events import Event, EventRun, PendingEvents
from polycnc.nc.blocks._moves import Arc, Feed, Line, QueueItem, Spline, Stop, Wait

NO_EVENT = -1
_LOOKED_AT = 8


class WriterSnapshot(NamedTuple):
    """What a writer holds, to go back to."""

    events: dict[int, Event]
    stops: int
    next_event: int
    backlog: tuple[QueueItem, ...]
    marks: tuple[tuple[int, int], ...] | None


@dataclass
class QueueWriter:
    """Append items to path `path` of the kernel; what finds no room waits in `backlog`.

    `events` holds what the path has yet to come to, by number, `probes` the tags of probing among it. `stops` counts
    those among them after which preparation waits: drains, with `stands_at_stops` program stops, and with `answers`
    auxiliary functions, at which the path does not wait by itself: whoever runs it holds it until they are answered.
    `marks` takes the blocks that leave nothing in the queue: the segment count that they stand before, and their tag.
    """

    seg: Segments
    paths: Paths
    limits: AxisLimits
    path: int = 0
    backlog: deque[QueueItem] = field(default_factory=deque)
    events: PendingEvents = field(default_factory=PendingEvents)
    stands_at_stops: bool = False
    answers: bool = False
    stops: int = 0
    marks: deque[tuple[int, int]] | None = None
    probes: dict[int, int] = field(default_factory=dict)
    _next_event: int = 0

    def set_tolerance(self, tolerance_mm: float, merge_mm: float) -> None:
        """Set how far the path may leave the corners, and the points, of lines appended from now on."""
        self._close_line()
        row = self.paths.row[self.path]
        row["tolerance_mm"], row["merge_mm"] = tolerance_mm, merge_mm

    def put_block(self, items: list[QueueItem]) -> None:
        """Append what a block gives; one that gives nothing after all, a move without length, is marked."""
        if self.marks is None:
            for item in items:
                self.put(item)
            return
        row = self.paths.row[self.path]
        if items and isinstance(items[0], Wait) and items[0].passes and not self.backlog:
            self._close_line()
        before = int(row["tail"])
        marked = len(self.marks)
        for item in items:
            self.put(item)
        if items and row["tail"] == before and len(self.marks) == marked and not self.backlog:
            self.mark(items[0].tag)

    def put(self, item: QueueItem) -> None:
        """Append one move or wait, after what waits for room."""
        if self.backlog or not self._has_room(item):
            self.backlog.append(item)
        else:
            self._append(item)

    def catch_up(self) -> bool:
        """Append what waits, as far as there is room; return whether nothing waits any more."""
        while self.backlog and self._has_room(self.backlog[0]):
            self._append(self.backlog.popleft())
        return not self.backlog

    def clear(self) -> None:
        """Forget what has been put and not been come to."""
        self.backlog.clear()
        self.events.clear()
        self.probes.clear()
        self.paths.row[self.path]["next_events"] = 0
        self.stops = 0
        if self.marks is not None:
            self.marks.clear()

    def put_again(self) -> None:
        """Append the events that have not been come to anew, because the queue that they were in has been dropped."""
        events = self.events.values()
        self.events.clear()
        self.probes.clear()
        for event in events:
            self._append_wait(0.0, self._next_event, event.tag, passes=event.passes)
            self._note(event)

    def take(self, number: int) -> Event:
        """Return an event that the path has come to, which is pending no more."""
        self.probes.pop(number, None)
        return self.events.pop(number)

    def take_some(self, number: int, most: int) -> Event | EventRun:
        """Return an event that the path has come to, or up to `most` of a run of plain blocks from it on."""
        found = self.events.pop_some(number, most)
        if isinstance(found, Event):
            self.probes.pop(number, None)
        return found

    def snapshot(self) -> WriterSnapshot:
        """Return what has been put and not been come to, to go back to; the queue itself is the kernel's."""
        marks = None if self.marks is None else tuple(self.marks)
        return WriterSnapshot(
            self.events.snapshot(), self.stops, self._next_event, tuple(self.backlog), marks
        )

    def restore(self, saved: WriterSnapshot) -> None:
        """Go back to a snapshot."""
        self.events.restore(saved.events)
        self.probes = {n: event.tag for n, event in saved.events.items() if event.stop is Stop.PROBE}
        self.stops = saved.stops
        self._next_event = saved.next_event
        self.backlog = deque(saved.backlog)
        self.marks = None if saved.marks is None else deque(saved.marks)

    def mark(self, tag: int) -> None:
        """Note a block that has been carried out without anything for the queue."""
        if self.marks is not None:
            self.marks.append((int(self.paths.row[self.path]["tail"]), tag))

    @property
    def free(self) -> int:
        """How many segments the queue still takes."""
        return free_slots(self.paths, self.path)

    def has_room(self, reserve: int) -> bool:
        """Tell whether blocks may be prepared: nothing waits for room, and no stop for its execution."""
        return not self.backlog and not self.stops and self.free > reserve

    def takes_time(self, since: int) -> bool:
        """Tell whether what has been queued since the queue had this end takes time: waits of no length take none."""
        row = self.paths.row[self.path]
        end = int(row["tail"])
        for count in range(end - 1, max(since, end - _LOOKED_AT) - 1, -1):
            k = row["base"] + count % row["capacity"]
            if self.seg.row[k]["kind"] != WAIT or self.seg.geo[k, GEO_WAIT_S] > 0.0:
                return True
        return end - since > _LOOKED_AT

    def _append(self, item: QueueItem) -> None:
        if not isinstance(item, Line | Arc):
            self._close_line()
        match item:
            case Line():
                self._put_line(item)
            case Arc():
                self._put_arc(item)
            case Spline():
                self._put_spline(item)
            case Wait():
                self._put_wait(item)

    def _has_room(self, item: QueueItem) -> bool:
        """Tell whether there is room: a line with a rounded corner takes two slots, a wait one and one per event.

        One more is for the corner of a line that is complete, three for an arc that becomes two lines.
        """
        needed = 2 + (len(item.events) if isinstance(item, Wait) else 1)
        if isinstance(item, Arc) and self.paths.row[self.path]["merge_mm"] > 0.0:
            needed += 3
        return self.free >= needed

    def _put_line(self, item: Line) -> None:
        speed = math.inf if item.rapid else _speed(item.feed, self._line_length(item))
        flags = (
            (RAPID if item.rapid else 0)
            | (STOP if item.exact_stop else 0)
            | (WITH_SPINDLE if item.feed.with_spindle else 0)
        )
        row, end = self.paths.row[self.path], np.array(item.end)
        if row["merged"] > 0:
            before = merge_line(self.seg, self.paths, self.path, self.limits, end, speed, flags, item.tag)
            if before != NOT_MERGED:
                if self.marks is not None:
                    self.marks.append((int(row["tail"]) - 1, before))
                return
        append_line(self.seg, self.paths, self.path, self.limits, end, speed, flags, item.tag)

    def _put_arc(self, item: Arc) -> None:
        seg, paths, g, limits = self.seg, self.paths, self.path, self.limits
        end, (p, q) = np.array(item.end), item.plane[:2]
        of = p, q, item.center[0], item.center[1], item.sweep_rad
        speed, flags = _speed(item.feed, self._arc_length(item)), STOP if item.exact_stop else 0
        row = paths.row[g]
        if row["merge_mm"] > 0.0:
            last = int(row["tail"]) - 1
            before = append_small_arc(seg, paths, g, limits, end, *of, speed, flags, item.tag)
            if before not in (NOT_SMALL, NOT_MERGED) and self.marks is not None:
                self.marks.append((last, before))
            if before != NOT_SMALL:
                return
        self._close_line()
        append_arc(seg, paths, g, limits, end, *of, speed, flags, item.tag)

    def _put_spline(self, item: Spline) -> None:
        append_spline(
            self.seg,
            self.paths,
            self.path,
            np.array(item.end),
            *item.plane,
            np.array(item.span),
            item.length_mm,
            _speed(item.feed, item.length_mm),
            STOP if item.exact_stop else 0,
            item.tag,
        )

    def _put_wait(self, item: Wait) -> None:
        if item.passes:
            self._put_in_step([Event(word, item.line, tag=item.tag) for word in item.events])
            return
        in_step = self.withdraw_in_step()
        flags = WITH_SPINDLE if item.with_spindle else 0
        words = item.events or (("",) if item.stop is not None else ())
        answered = self.answers and bool(item.events)
        stands = self.stands_at_stops and item.stop in (Stop.PROGRAM, Stop.OPTIONAL)
        stops = item.stop is Stop.DRAIN or stands
        for word in words:
            time_s = item.duration_s if answered and word is words[-1] else 0.0
            barrier = answered and not stops and word is words[-1]
            event = Event(word, item.line, item.stop, time_s, item.tag, item.message, barrier)
            self._append_wait(0.0, self._next_event, item.tag, passes=event.passes, flags=flags)
            self._note(event)
        if stops or answered:
            self.stops += 1
        if (item.duration_s > 0.0 or not words) and not answered:
            self._append_wait(item.duration_s, NO_EVENT, item.tag, flags=flags)
        self._put_in_step(in_step)

    def _put_in_step(self, events: list[Event]) -> None:
        """Let events come when the next motion begins, after those that wait for it already."""
        row = self.paths.row[self.path]
        for event in events:
            if not row["next_events"]:
                row["next_event"] = self._next_event
            row["next_events"] += 1
            self._note(event)

    def withdraw_in_step(self) -> list[Event]:
        """Take back the events that wait for the next motion, whose numbers are the last ones."""
        row = self.paths.row[self.path]
        waiting, row["next_events"] = int(row["next_events"]), 0
        self._next_event -= waiting
        return [self.events.pop(self._next_event + place) for place in range(waiting)]

    @property
    def put_count(self) -> int:
        """How many segments have been put, as far as is known of those that wait for room."""
        return int(self.paths.row[self.path]["tail"]) + len(self.backlog)

    @property
    def next_event(self) -> int:
        """The number of the next event."""
        return self._next_event

    def note_run(self, run: EventRun) -> None:
        """Take the events of a run of plain blocks, from `next_event` on; the last ones may wait for a motion yet."""
        queued = len(run) - min(int(self.paths.row[self.path]["next_events"]), len(run))
        self.events.add_run(self._next_event, run.part(0, queued))
        self._next_event += queued
        for at in range(queued, len(run)):
            self._note(run[at])

    def _note(self, event: Event) -> None:
        self.events[self._next_event] = event
        if event.stop is Stop.PROBE:
            self.probes[self._next_event] = event.tag
        self._next_event += 1

    def _close_line(self) -> None:
        if self.paths.row[self.path]["merged"] > 0:
            close_line(self.seg, self.paths, self.path, self.limits)

    def _append_wait(
        self, duration_s: float, event: int, tag: int, *, passes: bool = False, flags: int = 0
    ) -> None:
        append_wait(self.seg, self.paths, self.path, duration_s, event, tag, int(passes))
        if flags:
            row = self.paths.row[self.path]
            self.seg.row["flags"][row["base"] + (row["tail"] - 1) % row["capacity"]] |= flags

    def with_speed(self, item: QueueItem) -> QueueItem:
        """Return an item whose feed is the speed that its duration gives it."""
        if not isinstance(item, Line | Arc) or item.feed.duration_s <= 0.0:
            return item
        length = self._line_length(item) if isinstance(item, Line) else self._arc_length(item)
        return replace(item, feed=Feed(speed_mm_s=length / item.feed.duration_s))

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


def _speed(feed: Feed, length: float) -> float:
    """Return the path speed; a feed by time needs the length of the move."""
    return length / feed.duration_s if feed.duration_s > 0.0 else feed.speed_mm_s
