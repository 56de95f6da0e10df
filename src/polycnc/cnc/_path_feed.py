"""Keep a path fed: prepare blocks ahead of it, take them into its look-ahead, say how far it may go."""

from __future__ import annotations

from collections import deque

import numpy as np
import numpy.typing as npt

from polycnc.kernel import NO_LIMIT, earliest_limit, free_slots, measure_queue, prepare_path, replan_path
from polycnc.machine import Machine
from polycnc.nc import Channel

Floats = npt.NDArray[np.float64]

_LOW_WATER = 1024  # final segments that stay queued: more than one cycle can pass
_NEVER = -1
_PIECE = 256  # segments looked at together for the end of a block


class PathFeed:
    """Feed path `channel.path` of a machine from its channel.

    With `blocks_ahead` only so many blocks are prepared beyond the one that is executed, and the path is looked
    at after every segment; without, as many as fit, and the path runs on what cannot change any more. `low` and
    `high` are the box of all positions that were prepared.
    """

    def __init__(self, machine: Machine, channel: Channel, blocks_ahead: int | None) -> None:
        self.machine = machine
        self.channel = channel
        self._ahead = blocks_ahead
        self._ends: deque[int] = deque()  # segment counts at which the prepared blocks end
        state = machine.state
        self.row = state.paths.row[channel.path]
        self._low_water = _LOW_WATER + int(self.row["depth"])
        self.low = state.setpoint.copy()
        self.high = state.setpoint.copy()

    def feed(self) -> None:
        """Prepare what may be prepared, and set when the path has to be looked at again."""
        self._fill()
        self.prepare()
        row = self.row
        if self.channel.done or self.channel.waits:
            row["low_water"] = _NEVER
        elif self._ahead is not None:
            row["low_water"] = row["planned"] - row["head"] - 1
        else:
            row["low_water"] = row["planned"] - self.target()

    def _fill(self) -> None:
        channel, row = self.channel, self.row
        if self._ahead is None:
            channel.fill()
        else:
            head = int(row["head"])
            while self._ends and self._ends[0] <= head:
                self._ends.popleft()
            while len(self._ends) <= self._ahead and not channel.done and not channel.waits:
                blocks, tail = channel.blocks, int(row["tail"])
                channel.fill(1)
                if row["tail"] > tail:
                    self._ends.append(int(row["tail"]))
                elif channel.blocks == blocks:
                    break
        row["closed"] = channel.done

    def prepare(self) -> None:
        """Take what was appended into the look-ahead."""
        state, path = self.machine.state, self.channel.path
        first = int(self.row["prepared"])
        prepare_path(state.seg, state.paths, path, state.limits, self.machine.config.cycle_s, state.work)
        measure_queue(state.seg, state.paths, path, first, self.low, self.high)

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
        if (
            until <= row["head"]
            and free_slots(self.machine.state.paths, self.channel.path) < row["capacity"] // 8
        ):
            # Braking takes longer than the queue is: go on with what is planned, which is always safe.
            return int(row["head"] + row["capacity"] // 4)
        return until

    # ------------------------------------------------------------------ blocks

    def tags(self, first: int, after: int) -> list[int]:
        """Return the tags of segments `first` up to `after`."""
        counts = np.arange(first, after)
        slots = self.row["base"] + counts % self.row["capacity"]
        tags: list[int] = self.machine.state.seg.row["tag"][slots].tolist()
        return tags

    def block_end(self, count: int) -> int:
        """Return the count behind the last segment of the block that segment `count` belongs to, as far as known."""
        tail = int(self.row["tail"])
        if count >= tail:
            return tail
        tag = self.tags(count, count + 1)[0]
        while count < tail:
            after = min(count + _PIECE, tail)
            for other in self.tags(count, after):
                if other != tag:
                    return count
                count += 1
        return count

    def stop_behind(self, count: int) -> None:
        """Let the path rest at the end of the block of segment `count`, or of the first after it where it can."""
        state, row = self.machine.state, self.row
        earliest = int(earliest_limit(state.seg, state.paths, self.channel.path, self.machine.config.cycle_s))
        end = self.block_end(count)
        while end < earliest:
            end = self.block_end(end)
        row["limit"] = end
        if end < row["prepared"]:
            row["prepared"] = end
            self.replan()

    def go_on(self) -> None:
        """Let the path go on behind the block at whose end it rests, or was to rest."""
        self.row["limit"] = NO_LIMIT

    def clear(self) -> None:
        """Forget what was prepared; the queue has been dropped."""
        self._ends.clear()
