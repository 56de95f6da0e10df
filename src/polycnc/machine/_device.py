"""What everything that lives in control cycles has in common, whatever it is: a machine, a board, a card, a control.

Whoever has a `Device` can let its time pass, look at it, keep its state and go back to it, without knowing which it is.
"""

from __future__ import annotations

from typing import Protocol, TypeVar

from polycnc.machine._clock import Clock
from polycnc.machine._snapshot import Snapshot

S_co = TypeVar("S_co", covariant=True)


class Timed(Protocol):
    """Something with a clock whose time passes when it is asked to; the ways to run need no more."""

    @property
    def clock(self) -> Clock:
        """Return the clock, counted in control cycles; only `advance` lets it go on."""
        ...

    def advance(self, cycles: int, *, until: int | None = None) -> int:
        """Run up to `cycles` control cycles; return how many were run, 0 if it cannot go on.

        Fewer after the cycle in which something of `until` happened: bits of the device's own list of reasons
        (`Reason` of a machine). None or 0: nothing ends it early.
        """
        ...


class Device(Timed, Protocol[S_co]):
    """A thing that is simulated cycle by cycle; `S_co` is the type of its status."""

    def status(self) -> S_co:
        """Return what it is and does in the present cycle, frozen, all of that one cycle."""
        ...

    def snapshot(self) -> Snapshot:
        """Return its whole state; two are equal if and only if the states are, bit for bit."""
        ...

    def restore(self, snapshot: Snapshot) -> None:
        """Go back to a snapshot of this device, or of one that was made alike.

        Raises:
            SnapshotError: It is of another device; nothing has changed.
        """
        ...
