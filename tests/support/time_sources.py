"""Devices that only count cycles, and wall clocks that pass when a test says so."""

from __future__ import annotations

from polycnc.machine import Clock


class Counter:
    """A device that stops at given cycles if it is told to look at them, and for good at `end`."""

    def __init__(self, stops: tuple[int, ...] = (), end: int = 10**9, cycle_s: float = 0.001) -> None:
        self.clock = Clock(cycle_s)
        self.stops = (*stops, end)
        self.end = end
        self.asked: list[int] = []

    def advance(self, cycles: int, *, until: int | None = None) -> int:
        self.asked.append(cycles)
        stops = self.stops if until else (self.end,)
        stop = min((each for each in stops if each > self.clock.cycles), default=self.clock.cycles)
        done = min(cycles, stop - self.clock.cycles)
        self.clock.tick(done)
        return done


class FakeWall:
    """A wall clock that passes while somebody sleeps, each time a little too long, or when a test moves it."""

    def __init__(self, oversleep_s: float = 0.0) -> None:
        self.time_s = 100.0
        self.oversleep_s = oversleep_s
        self.naps_s: list[float] = []

    def now_s(self) -> float:
        return self.time_s

    def sleep_s(self, duration_s: float) -> None:
        assert duration_s > 0.0
        self.naps_s.append(duration_s)
        self.time_s += duration_s + self.oversleep_s
