"""How long each tool has cut and positioned."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class ToolTime:
    """How long a tool has cut, and positioned, in s."""

    cutting_s: float = 0.0
    rapid_s: float = 0.0


@dataclass(frozen=True, slots=True)
class ToolTimes:
    """Times of a path by the tool in the spindle: `times` up to when `tool` came, at `since` of the path's times."""

    tool: int = 0
    since: ToolTime = ToolTime()
    times: Mapping[int, ToolTime] = field(default_factory=dict)

    def changed(self, tool: int, now: ToolTime) -> ToolTimes:
        """Return the times with a tool that comes when the path's times are `now`."""
        return self if tool == self.tool else ToolTimes(tool, now, self.until(now))

    def until(self, now: ToolTime) -> dict[int, ToolTime]:
        """Return the time of each tool that has moved, by number, when the path's times are `now`."""
        before = self.times.get(self.tool, ToolTime())
        cutting_s = before.cutting_s + now.cutting_s - self.since.cutting_s
        rapid_s = before.rapid_s + now.rapid_s - self.since.rapid_s
        times = dict(self.times)
        if cutting_s > 0.0 or rapid_s > 0.0:
            times[self.tool] = ToolTime(cutting_s, rapid_s)
        return dict(sorted(times.items()))
