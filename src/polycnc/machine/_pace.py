"""How fast a device's time follows a wall clock that is passed in; the pace can change while the device runs."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable
from typing import Protocol

from polycnc.errors import UsageError
from polycnc.jit import compile_at_once

_FORGIVEN = 1e-9  # cycles that rounding may be short of


class Wall(Protocol):
    """The wall clock of the outside, for what is below it."""

    def now_s(self) -> float:
        """Return a time that never runs back (s)."""
        ...


class Pacer(Wall, Protocol):
    """A wall clock that one can also wait by."""

    def sleep_s(self, duration_s: float) -> None:
        """Wait for about `duration_s`."""
        ...


class Pace:
    """How many cycles are due by a wall clock: `rate` seconds of the device for each second of it.

    Rate 0 freezes the device where it is, `math.inf` lets it run as fast as it can. `step` and `jump_to_event` add
    time of their own, at any rate. All of it may be called from any thread; `changed` is called after each change.
    Cycles are counted from the last change of the rate on, so errors of waiting do not add up; a device that is too
    slow lags behind.
    """

    def __init__(self, wall: Wall, rate: float = 1.0, *, changed: Callable[[], None] | None = None) -> None:
        compile_at_once()  # rather than in the middle of a motion
        self._wall = wall
        self._changed = changed or (lambda: None)
        self._lock = threading.Lock()
        self._rate = _checked(rate)
        self._since_s = wall.now_s()
        self._before = 0.0  # cycles that were due at `_since_s`
        self._done = 0  # of those that have become due since
        self._steps = 0
        self._jump = 0
        self._cycle_s = 1e-9  # that is counted in; of the device, once it has asked

    @property
    def rate(self) -> float:
        """Seconds of the device for each second of the wall clock.

        Raises:
            UsageError: On writing: the rate is negative or not a number.
        """
        return self._rate

    @rate.setter
    def rate(self, rate: float) -> None:
        with self._lock:
            _checked(rate)
            late = self._late(self._cycle_s)
            self._before = late if rate > 0.0 else min(late, late % 1.0)  # what is frozen does not catch up
            self._since_s, self._done, self._rate = self._wall.now_s(), 0, rate
        self._changed()

    @property
    def steps_left(self) -> int:
        """How many cycles of those that `step` made due have not passed yet."""
        return self._steps

    def forget(self) -> None:
        """Let what is late not be caught up with."""
        with self._lock:
            self._since_s, self._before, self._done = self._wall.now_s(), 0.0, 0

    def drop_lag(self, most_s: float) -> float:
        """Let what is late by more than `most_s` of the wall clock not be caught up with; return how much that was."""
        with self._lock:
            if self._rate in (0.0, math.inf):
                return 0.0
            late_s = self._late(self._cycle_s) * self._cycle_s / self._rate
            if late_s <= most_s:
                return 0.0
            self._since_s, self._before, self._done = self._wall.now_s(), 0.0, 0
            return late_s

    def step(self, cycles: int) -> None:
        """Make `cycles` more cycles due at once, frozen or not.

        Raises:
            UsageError: `cycles` is negative.
        """
        if cycles < 0:
            raise UsageError(f"time does not run back: {cycles} cycles", hint="give 0 or more cycles")
        with self._lock:
            self._steps += cycles
        self._changed()

    def jump_to_event(self, limit_cycles: int = 100_000) -> None:
        """Let the next run go on at once to the next event of the device, at most so many cycles.

        Raises:
            UsageError: `limit_cycles` is not above zero.
        """
        if limit_cycles <= 0:
            raise UsageError(f"a jump of {limit_cycles} cycles", hint="give 1 or more cycles")
        with self._lock:
            self._jump = limit_cycles
        self._changed()

    def due(self, cycle_s: float, most: int) -> int:
        """Return how many cycles of `cycle_s` are due, at most `most`."""
        with self._lock:
            self._count_in(cycle_s)
            return min(self._steps + max(math.floor(self._late(cycle_s, most) + _FORGIVEN), 0), most)

    def take_jump(self) -> int:
        """Return how many cycles a jump may take, 0 if none is wanted, and forget it."""
        with self._lock:
            jump, self._jump = self._jump, 0
            return jump

    def count(self, cycles: int) -> None:
        """Note that `cycles` cycles that were due have been run."""
        with self._lock:
            steps = min(cycles, self._steps)
            self._steps -= steps
            self._done += cycles - steps

    def wait_s(self, cycle_s: float, most: int) -> float:
        """Return after how many seconds of the wall clock `most` cycles will be due; infinity while frozen."""
        with self._lock:
            self._count_in(cycle_s)
            if self._steps or self._jump or self._rate == math.inf:
                return 0.0
            if self._rate == 0.0:
                return math.inf
            return max((most - self._late(cycle_s)) * cycle_s / self._rate, 0.0)

    def _count_in(self, cycle_s: float) -> None:
        """Count from now on in cycles of this length: one pace may serve devices of different cycles."""
        if cycle_s != self._cycle_s:
            self._before = (self._before - self._done) * self._cycle_s / cycle_s
            self._done = 0
            self._cycle_s = cycle_s

    def _late(self, cycle_s: float, unpaced: float = 0.0) -> float:
        """Return cycles that are due by the wall clock and have not been run."""
        if self._rate == math.inf:
            return unpaced
        passed_s = self._wall.now_s() - self._since_s
        return self._before + passed_s * self._rate / cycle_s - self._done


def _checked(rate: float) -> float:
    if not rate >= 0.0:
        raise UsageError(f"a rate of {rate}", hint="0 freezes, 1 is real time, math.inf as fast as possible")
    return rate
