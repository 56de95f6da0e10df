"""Keep a path fed: prepare blocks ahead of it, take them into its look-ahead, say how far it may go."""

from __future__ import annotations

from collections import deque
from itertools import islice
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from polycnc.cnc._queued_blocks import PIECE, QueuedBlocks
from polycnc.cnc._stops import Stopper, boundaries
from polycnc.kernel import (
    NO_LIMIT,
    READY,
    WITH_SPINDLE,
    earliest_limit,
    measure_queue,
    prepare_path,
    replan_path,
)
from polycnc.machine import Machine
from polycnc.nc import Channel

Floats = npt.NDArray[np.float64]

_LOW_WATER = 1024  # final segments that stay queued: more than one cycle can pass
_NEVER = -1


class FeedSnapshot(NamedTuple):
    """What a feed holds, to go back to."""

    ends: tuple[int, ...]
    seen: int
    met_at: int | None
    low: Floats
    high: Floats
    left: int = _NEVER
    box: tuple[Floats, Floats] | None = None
    due: bool = True
    releases: bool = False


class PathFeed:
    """Feed path `channel.path` of a machine from its channel.

    With `blocks_ahead` only so many blocks are prepared beyond the one that is executed, and the path is looked
    at after every segment; without, as many as fit, and the path runs on what cannot change any more. `stopper` says
    between which blocks it rests. `low` and `high` are the box of all positions that were prepared.
    """

    def __init__(
        self, machine: Machine, channel: Channel, blocks_ahead: int | None, stopper: Stopper
    ) -> None:
        self.machine = machine
        self.channel = channel
        self.stopper = stopper
        self._ahead = blocks_ahead
        self._ends: deque[int] = deque()  # segment counts at which the prepared blocks end
        self._seen = 0  # boundaries before this count have been looked at
        self._left = _NEVER  # the count at which the path stood when it went on
        self._met_at: int | None = None  # the count at which a condition has become true
        self._due = True  # whatever the queue holds
        self._releases = False  # the stop ahead is wanted no more, if nobody wants it before time passes
        state = machine.state
        self.row = state.paths.row[channel.path]
        self.blocks = QueuedBlocks(self.row, state.seg.row["tag"], lambda: self.channel.writer.marks)
        self._low_water = _LOW_WATER + int(self.row["depth"])
        self._box: tuple[Floats, Floats] | None = None  # without a probing move that has been prepared
        self.low = state.setpoint.copy()
        self.high = state.setpoint.copy()

    @property
    def is_due(self) -> bool:
        """Whether there is anything to prepare now; the state of the path decides, not who asks how often."""
        row = self.row
        return self._due or self.channel.paused or bool(row["planned"] - row["head"] <= row["low_water"])

    @property
    def cuts_thread(self) -> bool:
        """Whether the segment that is executed, or comes next, goes with the spindle."""
        row = self.row
        head = int(row["head"])
        slot = int(row["base"]) + head % int(row["capacity"])
        return head < row["prepared"] and bool(self.machine.state.seg.row["flags"][slot] & WITH_SPINDLE)

    def wake(self) -> None:
        """Take note that what preparation has waited for has come."""
        self._due = True

    def feed(self) -> None:
        """Prepare what may be prepared, and set when the path has to be looked at again."""
        self._due = False
        if self._releases:
            self._releases = False
            self.row["limit"] = NO_LIMIT
            self.prepare()
        self.blocks.forget_passed()
        self._fill()
        self._find_stop()
        self.prepare()
        row = self.row
        last = self.channel.starved or self._ahead == 0
        if last and row["state"] == READY and row["head"] >= row["prepared"] < row["tail"]:
            row["closed"] = 1  # the path rests before a line that was held back until the next one is known
            self.prepare()
        if self.channel.done or self.channel.waits or self._met_at is not None:
            row["low_water"] = _NEVER
        elif self.channel.starved:
            # A line is held back while the path may yet leave its end by a rounded corner.
            row["low_water"] = 0 if row["prepared"] < row["tail"] else _NEVER
        elif self._ahead is not None or self.stopper.has_conditions or self.stopper.alone:
            row["low_water"] = row["planned"] - row["head"] - 1
        else:
            row["low_water"] = row["planned"] - self.target()

    def _fill(self) -> None:
        channel, row = self.channel, self.row
        conditions = self.stopper.has_conditions
        if self._ahead is None and not conditions and not self.stopper.alone:
            channel.fill()
        else:
            head = int(row["head"])
            while self._ends and self._ends[0] <= head:
                self._ends.popleft()
            while self._wants_block() and not channel.done and not channel.waits:
                if self._met_at is not None:
                    break  # variables stay as they are
                blocks, tail = channel.blocks, int(row["tail"])
                channel.fill(1, compiled=not conditions)
                if row["tail"] > tail:
                    self._ends.append(int(row["tail"]))
                elif channel.blocks == blocks:
                    break
                if conditions and self.stopper.condition_met(channel.interpreter.last_tag):
                    self._met_at = int(row["tail"])
        row["closed"] = channel.done

    def _wants_block(self) -> bool:
        """Tell whether one more block is to be prepared; alone it is the one with which the path has just gone on."""
        if self.stopper.alone:
            row, over = self.row, self.channel.text_is_over
            return over or (bool(row["head"] == row["tail"] == self._left) and not self.blocks.at_mark)
        return len(self._ends) <= (PIECE if self._ahead is None else self._ahead)

    def prepare(self) -> None:
        """Take what was appended into the look-ahead."""
        state, path = self.machine.state, self.channel.path
        row = self.row
        first = int(row["prepared"])
        prepare_path(state.seg, state.paths, path, state.limits, self.machine.config.cycle_s, state.work)
        probing = list(self.channel.writer.probes.values())
        prepared = int(row["prepared"])
        if probing and first < prepared:  # what lies after may not be traversed
            tags = self.blocks.tags(first, prepared)
            row["prepared"] = first + tags.index(probing[-1]) if probing[-1] in tags else first
            measure_queue(state.seg, state.paths, path, first, self.low, self.high)
            self._box = self._box or (self.low.copy(), self.high.copy())
            first, row["prepared"] = int(row["prepared"]), prepared
        measure_queue(state.seg, state.paths, path, first, self.low, self.high)

    def keep_box(self) -> None:
        """Take note that a probing move has been traversed to its end."""
        self._box = None

    def drop_probing(self) -> None:
        """Take back from the box of positions what a probing move has not traversed; the path stands where it ends."""
        if self._box is not None:
            here = self.machine.state.paths.position[self.channel.path]
            self.low[:], self.high[:] = np.minimum(self._box[0], here), np.maximum(self._box[1], here)
        self._box = None

    def replan(self) -> None:
        """Take over a new override, hold or limit."""
        state = self.machine.state
        cycle_s = self.machine.config.cycle_s
        replan_path(state.seg, state.paths, self.channel.path, state.limits, cycle_s, state.work)

    def target(self) -> int:
        """Return the segment count to run up to now."""
        row = self.row
        if row["closed"] or self.channel.waits:
            return int(row["tail"])
        known = int(row["prepared"]) if row["depth"] else int(row["planned"])
        until = known - self._low_water
        if until <= row["head"] and self.channel.writer.free < row["capacity"] // 8:
            # Braking takes longer than the queue is: go on with what is planned, which is always safe.
            return int(row["head"] + row["capacity"] // 4)
        return until

    def forget_records(self, executed: int) -> None:
        """Let the records go that neither the queue nor the executed block needs; now and then is enough."""
        channel, row = self.channel, self.row
        if not channel.records.crowded:
            return
        tags = self.blocks.tags(int(row["head"]), int(row["tail"]))
        tags += [executed, channel.interpreter.last_tag, int(row["tag"])]
        tags += channel.writer.events.tags()
        tags += [tag for _, tag in channel.writer.marks or ()]
        tags += [item.tag for item in channel.writer.backlog]
        channel.records.keep(tags)

    # ------------------------------------------------------------------ stops

    def go_on(self) -> None:
        """Go on from a stop between two blocks."""
        head = int(self.row["head"])
        if self._met_at is not None and self._met_at <= head:
            self._met_at = None
        self._left = head
        self._seen = 0
        self._due, self._releases = True, False
        if self.row["limit"] != NO_LIMIT:
            self.row["limit"] = NO_LIMIT
            self.prepare()
        self._find_stop()

    def look_again(self) -> None:
        """Look for stops anew: the stopper has changed.

        A stop that the path brakes for already is kept if it is still wanted: braking leaves nothing to spare. One that
        is wanted no more is let go when time passes, so it may be wanted again before.
        """
        self._seen = 0
        self._due, self._releases = True, False
        limit = int(self.row["limit"])
        if limit == NO_LIMIT or self._met_at is not None:
            self._find_stop()
            return
        wanted = self._next_stop(limit)
        if wanted is not None and wanted < limit:
            self._set_limit(wanted)
        self._releases = wanted is None or wanted > limit

    def let_pass(self) -> None:
        """Let the block that comes next begin, whatever the stopper says."""
        self._left = int(self.row["head"])

    def _find_stop(self) -> None:
        """Let the path rest at the first boundary where the stopper wants that and where it still can."""
        if self._met_at is not None and self.row["limit"] == NO_LIMIT:
            self._set_limit(max(self._met_at, self._earliest()))
        if self.row["limit"] == NO_LIMIT and (wanted := self._next_stop()) is not None:
            self._set_limit(wanted)

    def _next_stop(self, limit: int = NO_LIMIT) -> int | None:
        """Return the count of the first boundary where the stopper wants the path to rest, None if there is none.

        The path can still rest there, or brakes for it already: `limit`.
        """
        row = self.row
        head, tail = int(row["head"]), int(row["tail"])
        if head >= tail and self._stops_at_end and row["state"] == READY and head != self._left:
            return head
        if self.stopper.idle or head >= tail:
            return None
        if row["state"] == READY and head != self._left:
            tag = self.blocks.tags(head, head + 1)[0]  # nothing lay before it when it came
            begun = tag in (row["tag"], *self.blocks.tags(max(head - 1, 0), head))  # a function stood there
            if not begun and self.stopper.stops_before(tag):
                return head
        first = max(head, self._seen)
        begin = max(first - 1, head)
        tags = self.blocks.tags(begin, tail)
        marks = self.channel.writer.marks or deque()
        ahead = (mark for mark in islice(marks, None) if mark[0] >= max(first, head + 1))
        earliest = None
        for boundary in boundaries(begin + 1, tags[1:], ahead, tags[0]):
            if self.stopper.stops_before(boundary.tag):
                if earliest is None:
                    earliest = self._earliest()
                if boundary.count >= earliest or boundary.count == limit:
                    return boundary.count
        self._seen = tail
        return tail if self._stops_at_end else None

    @property
    def begins_with_mark(self) -> bool:
        """Whether the block that has just been prepared alone leaves nothing in the queue."""
        row = self.row
        return self.stopper.alone and bool(row["head"] == row["tail"] == self._left) and self.blocks.at_mark

    @property
    def stops_here(self) -> bool:
        """Whether the path stands where what is prepared ends, and the next block waits for its start."""
        return self._stops_at_end and bool(self.row["head"] >= self.row["tail"]) and not self.blocks.at_mark

    @property
    def _stops_at_end(self) -> bool:
        """Whether the path stops where what is prepared ends: the next block waits for its start."""
        channel = self.channel
        return self.stopper.alone and not (channel.done or channel.waits or channel.text_is_over)

    def _earliest(self) -> int:
        state = self.machine.state
        return int(earliest_limit(state.seg, state.paths, self.channel.path, self.machine.config.cycle_s))

    def _set_limit(self, count: int) -> None:
        row = self.row
        row["limit"] = count
        if count < row["prepared"]:
            row["prepared"] = count
            self.replan()

    def snapshot(self) -> FeedSnapshot:
        """Return what is known of the path besides its queue, to go back to."""
        box = None if self._box is None else (self._box[0].copy(), self._box[1].copy())
        return FeedSnapshot(
            tuple(self._ends),
            self._seen,
            self._met_at,
            self.low.copy(),
            self.high.copy(),
            self._left,
            box,
            self._due,
            self._releases,
        )

    def restore(self, saved: FeedSnapshot) -> None:
        """Go back to a snapshot."""
        self._ends = deque(saved.ends)
        self._seen, self._met_at, self._left = saved.seen, saved.met_at, saved.left
        self._due, self._releases = saved.due, saved.releases
        self.low[:], self.high[:] = saved.low, saved.high
        self._box = None if saved.box is None else (saved.box[0].copy(), saved.box[1].copy())

    def clear(self) -> None:
        """Forget what was prepared; the queue has been dropped."""
        self._ends.clear()
        self._left = _NEVER
        self._seen = 0
        self._met_at = None
        self._due, self._releases = True, False
