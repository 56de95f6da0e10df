"""The ways to let the time of a device pass: so many cycles, until something, by a wall clock, call by call.

A way has `run(device)`: it decides how many cycles to ask for and when to stop. `until` are reasons of the device that
end an `advance` early, so that the way can look. No way reads a wall clock of its own; some are given one.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, TypeAlias

from polycnc.errors import UsageError
from polycnc.machine._device import Timed
from polycnc.machine._pace import Pace, Pacer, Wall

Condition: TypeAlias = Callable[[], bool]
UNPACED_SLICE_CYCLES = 1000


class Way(Protocol):
    """A way to let time pass."""

    def run(self, device: Timed, *, until: int | None = None) -> int:
        """Let time pass and return the number of cycles done."""
        ...


@dataclass(frozen=True, slots=True)
class Step:
    """Advance a number of cycles, over all stops on the way."""

    cycles: int

    def run(self, device: Timed, *, until: int | None = None) -> int:
        """Advance; fewer cycles are done only if the device cannot go on."""
        done = 0
        while done < self.cycles:
            moved = device.advance(self.cycles - done, until=until)
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

    condition: Condition
    limit_cycles: int
    look_every_cycles: int = 1000

    def run(self, device: Timed, *, until: int | None = None) -> int:
        """Advance; whether the condition holds at the end, it tells itself."""
        done = 0
        while done < self.limit_cycles and not self.condition():
            moved = device.advance(min(self.look_every_cycles, self.limit_cycles - done), until=until)
            if moved == 0:
                break
            done += moved
        return done


def wait(
    device: Timed,
    condition: Condition,
    *,
    until: int | None = None,
    limit_s: float = 3600.0,
    look_every_cycles: int | None = None,
) -> bool:
    """Let time pass until `condition` holds, at most `limit_s` of the device; return whether it does.

    With reasons `until` it is looked at when one of them has happened, else in every cycle, if nothing else is said.

    Raises:
        UsageError: The limit is not a number of seconds.
    """
    if not 0.0 <= limit_s < math.inf:
        raise UsageError(f"a limit of {limit_s} s", hint="give a finite time")
    limit = device.clock.cycles_for(limit_s)
    every = look_every_cycles or (max(limit, 1) if until else 1)
    Free(condition, limit, every).run(device, until=until)
    return condition()


@dataclass(frozen=True, slots=True)
class RealTime:
    """Advance at a pace by a pacer's clock until a condition holds, looked at once per slice.

    What the pace allows can be changed while this runs. Waiting lasts at most `slice_s`.
    """

    pacer: Pacer
    pace: Pace
    condition: Condition
    slice_s: float = 0.01

    def __post_init__(self) -> None:
        if not 0.0 < self.slice_s < math.inf:
            raise UsageError(f"a slice of {self.slice_s} s", hint="give a time above 0")

    def run(self, device: Timed, *, until: int | None = None) -> int:
        """Advance until the condition holds or the device cannot go on; `until` are the events of jumps."""
        cycle_s = device.clock.cycle_s
        done = 0
        while not self.condition():
            jump = self.pace.take_jump()
            most = slice_cycles(self.pace.rate, cycle_s, self.slice_s)
            due = jump or self.pace.due(cycle_s, most)
            if due == 0:
                self.pacer.sleep_s(max(min(self.pace.wait_s(cycle_s, most), self.slice_s), 1e-6))
                continue
            moved = device.advance(due, until=until)
            if moved == 0:
                break
            done += moved
            if not jump:
                self.pace.count(moved)
        return done


def slice_cycles(rate: float, cycle_s: float, slice_s: float) -> int:
    """Return how many cycles belong into a slice of `slice_s`, at least 1."""
    if rate == math.inf:
        return UNPACED_SLICE_CYCLES
    return max(math.ceil(slice_s * (rate or 1.0) / cycle_s), 1)


@dataclass(frozen=True, slots=True)
class Poll:
    """Advance to the next stop, at most `limit_cycles`: what one status call of a polling loop does."""

    limit_cycles: int = 1000

    def run(self, device: Timed, *, until: int | None = None) -> int:
        """Advance once."""
        return device.advance(self.limit_cycles, until=until)


class Elapsed:
    """Advance by the time of a wall clock that has passed since the last call, `pace.rate` times.

    A program that sleeps between its calls so sees a device in real time, and one that does not, too. The first call
    of all counts from when this was made. Everything that shares one of these shares its time (see `Polling`).
    """

    def __init__(self, wall: Wall, rate: float = 1.0) -> None:
        self.pace = Pace(wall, rate)
        if rate == math.inf:
            raise UsageError("no time passes without limit", hint="use Poll")

    def run(self, device: Timed, *, until: int | None = None) -> int:
        """Catch up with the wall clock, over all stops on the way; to the next event if the pace says so."""
        jumped = device.advance(jump, until=until) if (jump := self.pace.take_jump()) else 0
        cycles = Step(self.pace.due(device.clock.cycle_s, 1 << 62)).run(device, until=until)
        self.pace.count(cycles)
        return jumped + cycles
