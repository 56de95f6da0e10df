"""What a program run holds at one cycle, besides its channel, what feeds its path, and its machine."""

from __future__ import annotations

from dataclasses import dataclass, field, fields, replace

from polycnc.cnc._probing import Probing
from polycnc.cnc._run_state import RunAlarm, RunState
from polycnc.cnc._tool_times import ToolTimes
from polycnc.nc import Event, Suppressed


@dataclass(slots=True)
class RunProgress:
    """What a run is doing, what is switched on for it, and what it has met on the path.

    `hold` is a feed hold; a stop holds the path as well. One that comes `hold_later` lets a thread be cut to its end,
    `held_back` is one that comes when the program lets it.
    `stop` is the stop at which the program stands, `met` the segment count and the tag of the event at which the
    path rests, `unanswered` an auxiliary function at which it stands, `barrier` that preparation waits for it.
    `approach` is where a searched block begins, and its line, `searched` where a calculated search has come to.
    `suppressed` is what the program keeps from acting now. `rests` is the last cycle in which points of rest were
    left at once and how many, `enough_at` one that has no more.
    """

    block_delete: frozenset[int] = frozenset()
    single_block: bool = False
    optional_stop: bool = False
    skip_signal: bool = False
    locked: bool = False
    state: RunState = RunState.READY
    alarm: RunAlarm | None = None
    hold: bool = False
    hold_later: bool = False
    held_back: bool = False
    stop: Event | None = None
    met: tuple[int, int] | None = None
    unanswered: bool = False
    barrier: bool = False
    dropping: bool = False
    suppressed: Suppressed = field(default_factory=Suppressed)
    tool_times: ToolTimes = field(default_factory=ToolTimes)
    approach: tuple[tuple[float, ...], int] | None = None
    probing: Probing | None = None
    searched: tuple[float, ...] | None = None
    rests: tuple[int, int] = (-1, 0)
    enough_at: int | None = None

    def copy(self) -> RunProgress:
        """Return a moment that changes no more with this one."""
        return replace(
            self,
            tool_times=self.tool_times.copy(),
            probing=None if self.probing is None else replace(self.probing),
        )

    def restore(self, saved: RunProgress) -> None:
        """Go back to a moment, which does not change with this one."""
        copied = saved.copy()
        for each in fields(self):
            setattr(self, each.name, getattr(copied, each.name))
