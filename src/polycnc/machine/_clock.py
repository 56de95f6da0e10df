"""The machine's own time, counted in cycles, and the four ways to let it run.

A way to run is an object with `run(advance)`: it decides how many cycles to ask for and when to stop.
`advance(n)` runs up to n cycles and returns how many it did: fewer when something happened that the caller
should see, 0 when the machine cannot go on. No way reads the wall clock; `RealTime` is given one.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Protocol, TypeAlias

from polycnc.errors import UsageError
from polycnc.machine._config import EPOCH

Condition: TypeAlias = Callable[[], bool]


class Clock:
    """Count control cycles and tell the time from them, never from the computer.

    `cycles` is the whole truth; seconds and dates are computed from it and so never drift.
    """

    __slots__ = ("_epoch", "cycle_s", "cycles")

    def __init__(self, cycle_s: float, epoch: datetime = EPOCH) -> None:
        self.cycle_s = cycle_s
        self.cycles = 0
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
        return self._epoch + timedelta(microseconds=round(self.now_s * 1e6))

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

    @property
    def epoch(self) -> datetime:
        """Return the machine's date and time at cycle 0."""
        return self._epoch

    def go_back(self, cycles: int, epoch: datetime) -> None:
        """Stand where a snapshot was taken."""
        self.cycles, self._epoch = cycles, epoch

    def cycles_for(self, duration_s: float) -> int:
        """Return the least number of cycles that last `duration_s`; rounding of 1e-9 cycles is forgiven."""
        return max(0, math.ceil(duration_s / self.cycle_s - 1e-9))


class Advance(Protocol):
    """Run up to `cycles` control cycles and return how many were done."""

    def __call__(self, cycles: int, /) -> int: ...


class Way(Protocol):
    """A way to let a machine run."""

    def run(self, advance: Advance) -> int:
        """Let the machine run and return the number of cycles done."""
        ...


class Pacer(Protocol):
    """The wall clock of the outside, lent to `RealTime`."""

    def now_s(self) -> float:
        """Return a time that never runs back (s)."""
        ...

    def sleep_s(self, duration_s: float) -> None:
        """Wait for about `duration_s`."""
        ...


@dataclass(frozen=True, slots=True)
class Step:
    """Advance a number of cycles, over all stops on the way."""

    cycles: int

    def run(self, advance: Advance) -> int:
        """Advance; fewer cycles are done only if the machine cannot go on."""
        done = 0
        while done < self.cycles:
            moved = advance(self.cycles - done)
            if moved == 0:
                break
            done += moved
        return done


@dataclass(frozen=True, slots=True)
class Free:
    """Advance as fast as possible until a condition holds.

    The condition is looked at before the first cycle, after each stop of `advance`, and at least every
    `look_every_cycles`. `limit_cycles` ends the run without it.
    """

    until: Condition
    limit_cycles: int
    look_every_cycles: int = 1000

    def run(self, advance: Advance) -> int:
        """Advance; whether the condition holds at the end, it tells itself."""
        done = 0
        while done < self.limit_cycles and not self.until():
            moved = advance(min(self.look_every_cycles, self.limit_cycles - done))
            if moved == 0:
                break
            done += moved
        return done


@dataclass(frozen=True, slots=True)
class RealTime:
    """Advance in step with a pacer's clock, `rate` machine seconds per second of it.

    Each slice brings the machine up to date, counted from the start of the run, so errors of sleeping do not
    add up. A machine that is slower than its pacer runs without pause and lags behind.
    """

    pacer: Pacer
    cycle_s: float
    until: Condition
    rate: float = 1.0
    slice_s: float = 0.01

    def __post_init__(self) -> None:
        if not (self.rate > 0.0 and self.slice_s > 0.0 and self.cycle_s > 0.0):
            raise UsageError(
                f"rate {self.rate}, slice {self.slice_s} s and cycle {self.cycle_s} s must be greater than 0",
                hint="use Free to run as fast as possible",
            )

    def run(self, advance: Advance) -> int:
        """Advance until the condition, looked at once per slice, holds or the machine cannot go on."""
        start_s = self.pacer.now_s()
        most = max(1, math.ceil(self.slice_s * self.rate / self.cycle_s))
        done = 0
        while not self.until():
            passed_s = self.pacer.now_s() - start_s
            due = math.floor(passed_s * self.rate / self.cycle_s + 1e-9) - done
            if due <= 0:
                next_s = (done + most) * self.cycle_s / self.rate
                self.pacer.sleep_s(min(next_s - passed_s, self.slice_s))
                continue
            moved = advance(min(due, most))
            if moved == 0:
                break
            done += moved
        return done


@dataclass(frozen=True, slots=True)
class Poll:
    """Advance to the next event, at most `limit_cycles`: what one status call of a polling loop does."""

    limit_cycles: int = 1000

    def run(self, advance: Advance) -> int:
        """Advance once."""
        return advance(self.limit_cycles)
