"""What holds a path: a feed hold, a stop, a function without an answer, a probe, and too many rests in one cycle."""

from __future__ import annotations

from polycnc import kernel
from polycnc.cnc._path_feed import PathFeed
from polycnc.cnc._run_progress import RunProgress
from polycnc.cnc._run_state import RunState
from polycnc.machine import Machine


class PathHold:
    """Hold the path of `feed` as `moment` says."""

    def __init__(self, machine: Machine, feed: PathFeed, moment: RunProgress) -> None:
        self.machine = machine
        self.feed = feed
        self.row = feed.row
        self.moment = moment

    def brake(self, *, at_once: bool = False) -> None:
        """Brake and stand, now or when the program lets it."""
        moment = self.moment
        if moment.state is RunState.ACTIVE and moment.suppressed.hold and not at_once:
            moment.held_back = True
        elif moment.state is RunState.ACTIVE:
            moment.hold, moment.hold_later = True, not at_once
            moment.state = RunState.HOLD
            self.apply()
        elif at_once and moment.hold_later:
            moment.hold_later = False
            self.apply()

    def apply(self) -> None:
        """Hold the path while anything holds it; take it over where it moves."""
        # The path stops before a segment that is in the look-ahead already.
        stands = self.moment.state is RunState.STOPPED_AT_BLOCK
        met = self.moment.probing is not None and self.moment.probing.met and self.moment.probing.deletes
        stops = stands or met or self.moment.stop is not None or self.has_met_enough
        hold = kernel.HOLD if self.moment.hold or stops or self.moment.unanswered else 0
        if hold and self.moment.hold_later and not stops and not self.moment.unanswered:
            hold = kernel.HOLD_LATER
        if self.row["hold"] != hold:
            self.row["hold"] = hold
            if self.row["state"] == kernel.RUNNING:
                self.feed.replan()

    @property
    def has_met_enough(self) -> bool:
        """Whether the path has left all the points of rest that it leaves in this cycle."""
        return self.moment.enough_at == self.machine.clock.cycles

    def let_more(self) -> None:
        """Let points of rest pass again once a cycle is over that had enough of them."""
        if self.moment.enough_at is not None and not self.has_met_enough:
            self.moment.enough_at = None
            self.apply()

    def count_rest(self) -> None:
        """Let time pass once enough points of rest have been left in a cycle, however long the queue of them is."""
        cycle, count = self.moment.rests
        count = count + 1 if cycle == self.machine.clock.cycles else 1
        self.moment.rests = self.machine.clock.cycles, count
        if count >= kernel.RESTS_PER_CYCLE:
            self.moment.enough_at = self.machine.clock.cycles
            self.apply()
