"""Programs that poll: a task that runs in a circle until something on its board changes needs no turn until then.

A task is tried out on a board that stands still. If its turns come back to where they began without having done
anything but read, they will do so again and again while what it reads stays the same, and where it stands after any
number of turns is known.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias

from polycnc.controllers.apci.sap._host import Call, Host

Read: TypeAlias = tuple[str, Any, Any]
"""What was read: kind ("system", "axis", "ended", "buffer"), name, and index or axis."""

TURNS_MOST = 128  # that a task is tried out for
CELLS_MOST = 512  # of memory and stack: one that uses more is not tried out
_PATIENCE_MOST = 4096  # scans between two trials


class Observer:
    """A board as the tasks of it see it, which can note what they read, and pretend to be some scans ahead."""

    def __init__(self, host: Host) -> None:
        self.host = host
        self.noted: dict[Read, Any] | None = None
        self.ahead = 0
        self.scan_s = host.scan_s
        self.axis_index = host.axis_index
        self.call: Callable[[Call], None] = host.call
        self.write_system = host.write_system
        self.write_axis = host.write_axis

    @property
    def scan(self) -> int:
        """Number of the present scan."""
        return self.host.scan + self.ahead

    def _note(self, read: Read, value: Any) -> Any:
        if self.noted is not None:
            self.noted[read] = value
        return value

    def read_system(self, name: str, index: int | None) -> float:
        """Return a system variable."""
        value: float = self._note(("system", name, index), self.host.read_system(name, index))
        return value

    def read_axis(self, axis: int, name: str, index: int | None) -> float:
        """Return an axis qualifier."""
        value: float = self._note(("axis", name, (axis, index)), self.host.read_axis(axis, name, index))
        return value

    def profile_ended(self, axes: tuple[int, ...]) -> bool:
        """Tell whether all of `axes` have reached the end of their profiles."""
        return bool(self._note(("ended", "", axes), self.host.profile_ended(axes)))

    def common_buffer(self, task: int) -> bytearray:
        """Return the common buffer of a task."""
        buffer = self.host.common_buffer(task)
        if self.noted is not None:
            self.noted["buffer", "", task] = bytes(buffer)
        return buffer

    def now(self, read: Read) -> Any:
        """Return what a read gives now."""
        kind, name, where = read
        if kind == "system":
            return self.host.read_system(name, where)
        if kind == "axis":
            return self.host.read_axis(where[0], name, where[1])
        if kind == "ended":
            return self.host.profile_ended(where)
        return bytes(self.host.common_buffer(where))

    def is_unchanged(self, reads: dict[Read, Any]) -> bool:
        """Tell whether all of `reads` still give the same."""
        return all(_is_same(value, self.now(read)) for read, value in reads.items())


def _is_same(before: Any, now: Any) -> bool:
    if isinstance(before, float) and before == 0.0 == now:
        return math.copysign(1.0, before) == math.copysign(1.0, now)
    return bool(before == now)


@dataclass(frozen=True, slots=True)
class Circle:
    """The states that a polling task goes through, by turn, beginning with that of scan `since`; what it reads."""

    since: int
    states: tuple[Any, ...]
    reads: dict[Read, Any]


class Patience:
    """When to try out a task again: the later, the less that has been good for."""

    def __init__(self, scan: int = 0) -> None:
        self.scans = 1
        self.next = scan

    def failed(self, scan: int) -> None:
        """Note that a trial was of no use."""
        self.scans = min(2 * self.scans, _PATIENCE_MOST)
        self.next = scan + self.scans

    def ended(self, scan: int, circle: Circle) -> None:
        """Note that a circle has ended, one that was worth finding or not."""
        if scan - circle.since > 4 * len(circle.states):
            self.scans = 1
            self.next = scan + 1
        else:
            self.failed(scan)
