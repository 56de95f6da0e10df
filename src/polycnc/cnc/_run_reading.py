"""What a program run shows at one cycle: its block, its calls, where its path stands, what is left of it."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from polycnc.cnc._path_feed import PathFeed
from polycnc.cnc._queued_blocks import PIECE
from polycnc.cnc._run_progress import RunProgress
from polycnc.cnc._run_state import RunState
from polycnc.cnc._tool_times import ToolTime, path_times
from polycnc.kernel import HELD, READY, RUNNING
from polycnc.machine import Machine
from polycnc.nc import BlockRecord, Call, ModalWords

Floats: TypeAlias = npt.NDArray[np.float64]


class RunReading:
    """Read what a path does with the program that `feed` supplies it with, as `moment` says."""

    def __init__(self, machine: Machine, path: int, feed: PathFeed, moment: RunProgress) -> None:
        self._machine = machine
        self._path = path
        self._feed = feed
        self._row = feed.row
        self._moment = moment

    @property
    def state(self) -> RunState:
        """What the run is doing."""
        return self._moment.state

    @property
    def locked(self) -> bool:
        """Whether the path is executed without its axes."""
        return self._moment.locked

    @property
    def at_rest(self) -> bool:
        """Whether the path stands; a thread goes on where its spindle turns round, though a hold waits for its end."""
        if self._row["state"] == RUNNING:
            return False
        moment = self._moment
        return not (moment.state is RunState.HOLD and moment.hold_later and self._feed.cuts_thread)

    @property
    def starved(self) -> bool:
        """Whether the path rests because nothing more of a program that is still coming has come."""
        row, moment = self._row, self._moment
        if moment.state is not RunState.ACTIVE or moment.unanswered or not self.at_rest:
            return False
        return bool(row["head"] >= row["tail"]) and self._feed.channel.starved

    @property
    def tag(self) -> int:
        """The tag of the block that is executed, or was last."""
        row, met = self._row, self._moment.met
        if met is not None and row["state"] == READY and row["head"] == met[0]:
            return met[1]
        return int(row["tag"])

    @property
    def block(self) -> BlockRecord | None:
        """The block that is executed, or was last; None before the first."""
        return self._feed.channel.records.block(self.tag)

    @property
    def tool(self) -> int:
        """The tool in the spindle with the executed block, 0 where that is not known."""
        return self._feed.channel.records.tool(self.tag)

    @property
    def programs(self) -> tuple[str, ...]:
        """The names of the program that the executed block is in, and of those that led there by calls."""
        return self._feed.channel.records.programs(self.tag)

    @property
    def stack(self) -> tuple[Call, ...]:
        """The calls that led to the executed block, the outermost first."""
        record = self.block
        return () if record is None else record.stack

    @property
    def modal(self) -> ModalWords | None:
        """The modal words in force with the executed block."""
        record = self.block
        return None if record is None else record.modal

    @property
    def blocks_done(self) -> int:
        """How many blocks have been executed since the start, of those that move, dwell or hand out functions."""
        return int(self._row["blocks"])

    @property
    def queued(self) -> int:
        """How many moves and waits are queued that have not been executed."""
        return int(self._row["tail"] - self._row["head"])

    @property
    def position(self) -> dict[str, float]:
        """Where the path stands (machine coordinates, mm or degree)."""
        return self._by_axis(self._machine.state.paths.position[self._path])

    @property
    def distance_to_go(self) -> dict[str, float]:
        """What is left to the end of the executed block (mm or degree); 0 where none is being executed."""
        return self._by_axis(self.to_go)

    @property
    def to_go(self) -> Floats:
        """What `distance_to_go` tells, by the place of the axis."""
        state, row = self._machine.state, self._row
        here = state.paths.position[self._path]
        if row["state"] not in (RUNNING, HELD):
            return np.zeros_like(here)
        k = int(row["base"]) + (self._block_end() - 1) % int(row["capacity"])
        left: Floats = state.seg.end[k] - here
        return left

    def _block_end(self) -> int:
        """Return the count after the last segment of the block that is being executed, as far as known."""
        row, tags = self._row, self._machine.state.seg.row["tag"]
        count, tail, base, capacity = map(int, (row["head"], row["tail"], row["base"], row["capacity"]))
        tag = tags[base + count % capacity]
        count += 1
        if count < tail and tags[base + count % capacity] != tag:
            return count
        while count < tail:
            for other in self._feed.blocks.tags(count, min(count + PIECE, tail)):
                if other != tag:
                    return count
                count += 1
        return count

    @property
    def tool_times(self) -> dict[int, ToolTime]:
        """How long each tool has cut and positioned so far; tool 0 is an empty spindle."""
        return self._moment.tool_times.until(self.path_times)

    @property
    def path_times(self) -> ToolTime:
        """How long the path has cut and positioned so far, with whatever tool."""
        return path_times(self._machine, self._path)

    def _by_axis(self, values: Floats) -> dict[str, float]:
        return {
            name: float(value) for name, value in zip(self._machine.config.axis_names, values, strict=True)
        }
