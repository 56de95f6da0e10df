"""When the calls of one program let time pass, for all devices that it has.

A program that polls must see time go on, or its loop never ends; but what it reads together must come from one cycle.
So a read lets time pass only when the same thing is read a second time in the same cycle.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable, Iterable
from dataclasses import dataclass, field
from weakref import WeakKeyDictionary

from polycnc.machine._device import Timed
from polycnc.machine._ways import Elapsed, Step, Way


@dataclass(slots=True)
class _Seen:
    """What has been read of a device in one cycle, and the part of a cycle that it is behind the others."""

    cycle: int
    things: set[Hashable] = field(default_factory=set)
    part: float = 0.0


class Polling:
    """Let the time of devices pass by the calls that a program makes.

    `way` is what happens when time passes, None for never; `devices` tells what else there is, kept in step with the
    device that is called. With `Elapsed` every call takes over the time that has passed outside.
    """

    def __init__(self, way: Way | None, devices: Callable[[], Iterable[Timed]] = tuple) -> None:
        self.way = way
        self._devices = devices
        self._seen: WeakKeyDictionary[Timed, _Seen] = WeakKeyDictionary()

    def read(self, device: Timed, thing: Hashable, *, until: int | None = None) -> int:
        """Note that `thing` of a device is read now; return the cycles that have passed before it."""
        if isinstance(self.way, Elapsed):
            return self.let_pass(device, until=until)
        seen = self._of(device)
        passed = self.let_pass(device, until=until) if thing in seen.things else 0
        self._of(device).things.add(thing)
        return passed

    def call(self, device: Timed, *, until: int | None = None) -> int:
        """Note a call that reads nothing; only time that passes outside passes then."""
        return self.let_pass(device, until=until) if isinstance(self.way, Elapsed) else 0

    def let_pass(self, device: Timed, way: Way | None = None, *, until: int | None = None) -> int:
        """Let time pass, by `way` if given, for this device and as much for all others; return its cycles."""
        if self.way is None:
            return 0
        passed = (way or self.way).run(device, until=until)
        if way is not None and isinstance(self.way, Elapsed):
            self.way.pace.count(passed)  # not again when the wall clock gets there
        for other in self._devices() if passed else ():
            if other is not device:
                self._follow(other, passed * device.clock.cycle_s / other.clock.cycle_s)
        return passed

    def _follow(self, device: Timed, cycles: float) -> None:
        seen = self._of(device)
        whole = math.floor(seen.part + cycles + 1e-9)
        seen.part += cycles - whole
        Step(whole).run(device)

    def _of(self, device: Timed) -> _Seen:
        seen = self._seen.setdefault(device, _Seen(device.clock.cycles))
        if seen.cycle != device.clock.cycles:
            seen.cycle = device.clock.cycles
            seen.things.clear()
        return seen
