"""The machine's own time, counted in cycles; what lets it pass is in `_ways`."""

from __future__ import annotations

import math
from datetime import datetime, timedelta

from polycnc.errors import UsageError
from polycnc.machine._config import EPOCH

MOST_CYCLES = 1 << 62
"""As many cycles never pass."""


class Clock:
    """Count control cycles and tell the time from them, never from the computer.

    `cycles` is the whole truth; seconds and dates are computed from it and so never drift. `changes` counts what
    commands change between two cycles: whoever keeps what was read at one cycle compares both.
    """

    __slots__ = ("_epoch", "changes", "cycle_s", "cycles")

    def __init__(self, cycle_s: float, epoch: datetime = EPOCH) -> None:
        self.cycle_s = cycle_s
        self.cycles = 0
        self.changes = 0
        self._epoch = epoch

    def tick(self, cycles: int) -> None:
        """Let `cycles` control cycles pass.

        Raises:
            UsageError: `cycles` is negative.
        """
        if cycles < 0:
            raise UsageError(f"time does not run back: {cycles} cycles", hint="give 0 or more cycles")
        self.cycles += cycles

    @property
    def now_s(self) -> float:
        """Return the time since cycle 0 (s)."""
        return self.cycles * self.cycle_s

    @property
    def now(self) -> datetime:
        """Return the machine's date and time, to the microsecond."""
        try:
            return self._epoch + timedelta(microseconds=round(self.now_s * 1e6))
        except OverflowError:
            return datetime.max  # the calendar ends there

    def set_now(self, now: datetime) -> None:
        """Set the machine's date and time; `cycles` and `now_s` stay.

        Raises:
            UsageError: `now` has a time zone.
        """
        if now.tzinfo is not None:
            raise UsageError(
                "the machine's date and time have no time zone", hint="give a datetime without tzinfo"
            )
        self._epoch += now - self.now
        self.changes += 1

    @property
    def epoch(self) -> datetime:
        """Return the machine's date and time at cycle 0."""
        return self._epoch

    def go_back(self, cycles: int, epoch: datetime) -> None:
        """Stand where a snapshot was taken."""
        self.cycles, self._epoch = cycles, epoch
        self.changes += 1

    def cycles_for(self, duration_s: float) -> int:
        """Return the least number of cycles that last `duration_s`, at most `MOST_CYCLES`; 1e-9 cycles are forgiven."""
        cycles = duration_s / self.cycle_s - 1e-9
        return max(0, math.ceil(cycles)) if cycles < MOST_CYCLES else MOST_CYCLES
