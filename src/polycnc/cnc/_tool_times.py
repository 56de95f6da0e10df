"""How long each tool has cut and positioned."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from polycnc import kernel
from polycnc.machine import Machine


@dataclass(frozen=True, slots=True)
class ToolTime:
    """How long a tool has cut, and positioned, in s."""

    cutting_s: float = 0.0
    rapid_s: float = 0.0


@dataclass(slots=True)
class ToolTimes:
    """Times of a path by the tool in the spindle: `times` up to when `tool` came, at `since` of the path's times."""

    tool: int = 0
    since: ToolTime = ToolTime()
    times: dict[int, ToolTime] = field(default_factory=dict)

    def change(self, tool: int, now: ToolTime) -> None:
        """Take a tool that comes when the path's times are `now`."""
        if tool != self.tool:
            self._count(self.times, now)
            self.tool, self.since = tool, now

    def until(self, now: ToolTime) -> dict[int, ToolTime]:
        """Return the time of each tool that has moved, by number, when the path's times are `now`."""
        times = dict(self.times)
        self._count(times, now)
        return dict(sorted(times.items()))

    def copy(self) -> ToolTimes:
        """Return times that change no more with these."""
        return replace(self, times=dict(self.times))

    def _count(self, times: dict[int, ToolTime], now: ToolTime) -> None:
        before = times.get(self.tool, ToolTime())
        cutting_s = before.cutting_s + now.cutting_s - self.since.cutting_s
        rapid_s = before.rapid_s + now.rapid_s - self.since.rapid_s
        if cutting_s > 0.0 or rapid_s > 0.0:
            times[self.tool] = ToolTime(cutting_s, rapid_s)


def path_times(machine: Machine, path: int) -> ToolTime:
    """Return how long a path has cut and positioned so far, with whatever tool."""
    totals = machine.state.paths.totals[path]
    return ToolTime(float(totals[kernel.FEED_S]), float(totals[kernel.RAPID_S]))
