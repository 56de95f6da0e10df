"""Events that a path passes without stopping for whoever wants them: noted by the kernel, handed on together."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from polycnc import kernel
from polycnc.cnc._run_progress import RunProgress
from polycnc.cnc._tool_times import ToolTime
from polycnc.machine import Machine
from polycnc.nc import Channel, Event, EventRun

Floats: TypeAlias = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Passed:
    """An event, when the path came to it, and how long the path had cut and positioned by then."""

    event: Event
    time_s: float
    moved: ToolTime


@dataclass(frozen=True, eq=False, slots=True)
class PassedRun:
    """Events of a run of plain blocks, with one tool: `time_s` and `moved` [events, 2] as those of `Passed`."""

    events: EventRun
    time_s: Floats
    moved: Floats

    def __getitem__(self, at: int) -> Passed:
        return Passed(self.events[at], float(self.time_s[at]), ToolTime(*self.moved[at].tolist()))


OnPassed: TypeAlias = Callable[[Passed | PassedRun], None]


def let_pass(_: Passed | PassedRun) -> None:
    """Let events pass that nobody wants to know of."""


class PassedEvents:
    """Let a path pass events for `told`, which gets them in their order; without it the path stops at each.

    Those in step with motion stop it never: without `told`, `on_event` gets them in their cycle, and its answer counts
    for nothing. The moment of the run keeps the last one, the tool times, and how many points of rest the path has left
    at once.
    """

    def __init__(self, machine: Machine, path: int) -> None:
        self._machine = machine
        self._path = path
        self._row = machine.state.paths.row[path]
        self.told: OnPassed | None = None
        self.on_event: Callable[[Event], object] | None = None

    def begin(self, moment: RunProgress) -> None:
        """Let events pass from now on."""
        if self.told is None:
            return
        self._row["passes"] = 1
        cycle, count = moment.rests
        left = count if cycle == self._machine.clock.cycles else 0
        self._row["spare"] = kernel.RESTS_PER_CYCLE - 1 - left

    @property
    def at_once(self) -> bool:
        """Whether the path stands at an event to which no time has passed since the one before."""
        cycle = self._machine.state.clock[0]["cycle"]
        return bool(self._row["event"] >= 0 and self._row["passed_at"] == cycle)

    def take(self, channel: Channel, moment: RunProgress) -> None:
        """Take note of what has been passed, and hand it on."""
        count, told = int(self._row["passed"]), self.told or self._tell_one_by_one
        if not count:
            return
        self._row["passed"] = 0
        machine = self._machine
        rows = machine.state.paths.passed[self._path, :count]
        at_rest = rows[-1, kernel.PASSED_COUNT] == 0.0
        rows = np.repeat(rows, np.maximum(rows[:, kernel.PASSED_COUNT], 1.0).astype(np.int64), axis=0)
        count = len(rows)
        cycles = rows[:, kernel.PASSED_CYCLE].astype(np.int64)
        cycles += machine.clock.cycles - int(machine.state.clock[0]["cycle"])
        _note_rests(moment, cycles[rows[:, kernel.PASSED_AT_ONCE] != 0.0])
        time_s = cycles.astype(np.float64) * machine.config.cycle_s
        moved = np.stack((rows[:, kernel.PASSED_FEED_S], rows[:, kernel.PASSED_RAPID_S]), axis=1)
        number, at, tag = int(rows[0, kernel.PASSED_EVENT]), 0, 0
        while at < count:
            found = channel.writer.take_some(number + at, count - at)
            tag = found.tag if isinstance(found, Event) else int(found.tag[0])
            now = ToolTime(*moved[at].tolist())
            moment.tool_times.change(channel.records.tool(tag), now)
            if isinstance(found, Event):
                told(Passed(found, float(time_s[at]), now))
                at += 1
            else:
                told(PassedRun(found, time_s[at : at + len(found)], moved[at : at + len(found)]))
                at += len(found)
                tag = int(found.tag[-1])
        if at_rest and cycles[-1] == machine.clock.cycles and self._row["state"] == kernel.READY:
            moment.met = int(self._row["head"]), tag

    def _tell_one_by_one(self, passed: Passed | PassedRun) -> None:
        if self.on_event is not None:
            several = (
                [passed] if isinstance(passed, Passed) else [passed[at] for at in range(len(passed.events))]
            )
            for each in several:
                self.on_event(each.event)


def _note_rests(moment: RunProgress, cycles: npt.NDArray[np.int64]) -> None:
    """Count the points of rest in the last of the cycles in which the path left any at once."""
    if len(cycles):
        cycle, count = moment.rests
        more = int(np.count_nonzero(cycles == cycles[-1]))
        moment.rests = int(cycles[-1]), more + (count if cycle == cycles[-1] else 0)
