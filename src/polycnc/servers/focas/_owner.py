"""Who lets the time of a served control pass and carries out what its clients ask.

A host does it in a thread of its own, for a control with several doors. A keeper does it in the event loop: without a
change of threads for every request, and a thousand controls in one process.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import Any, Protocol, TypeVar

from polycnc.machine import Host, HostError, Pace, Wall
from polycnc.servers.focas._served import ServedControl

R = TypeVar("R")
_BUSY_BEAT_S = 0.05
_IDLE_BEAT_S = 1.0
_MOST_CYCLES = 20_000  # that are caught up with in one go
_MOST_LATE_S = 0.5


class Owner(Protocol):
    """Carry out what is asked between two cycles of a control."""

    def submit(self, command: Callable[[], R], done: Callable[[R], None]) -> None:
        """Carry out `command` and give its result to `done` in the event loop; nothing is told if it cannot be."""


class HostOwner:
    """Leave it to a running host."""

    def __init__(self, host: Host[Any]) -> None:
        self._host = host

    def submit(self, command: Callable[[], R], done: Callable[[R], None]) -> None:
        """Post `command` to the host."""
        loop = asyncio.get_running_loop()
        try:
            posted = self._host.post(lambda _: command())
        except HostError:
            return
        posted.add_done_callback(
            lambda future: None if future.exception() else loop.call_soon_threadsafe(done, future.result())
        )


class Keeper:
    """Let the time of a control pass in the running event loop, at `rate` seconds for each second of `wall`.

    Time is let pass before every request and from time to time, for at most `share_s` of the wall clock in one go, so
    that nobody waits long for others whose time is costly. A clock that is late by half a second drops its lag and
    tells `on_late` how much. `failed` ends with the error if time cannot pass.
    """

    def __init__(
        self,
        served: ServedControl,
        wall: Wall,
        *,
        rate: float = 1.0,
        share_s: float = 0.01,
        on_late: Callable[[float], None] | None = None,
    ) -> None:
        self.pace = Pace(wall, rate)
        self._wall = wall
        self._share_s = share_s
        self._on_late = on_late
        self.failed: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._served = served
        self._timer: asyncio.TimerHandle | None = None
        self.pace.forget()
        self._beat()

    def submit(self, command: Callable[[], R], done: Callable[[R], None]) -> None:
        """Let time pass, carry out `command`, and tell its result at once."""
        if self.failed.done():
            return
        try:
            self._catch_up()
            result = command()
        except Exception as error:
            self._fail(error)
        else:
            done(result)

    def close(self) -> None:
        """Let no more time pass."""
        if self._timer is not None:
            self._timer.cancel()
        if not self.failed.done():
            self.failed.cancel()

    def _catch_up(self) -> bool:
        """Let pass what is due, within its share of the wall clock; tell whether there is more."""
        due = self.pace.due(self._served.clock.cycle_s, _MOST_CYCLES)
        if not due:
            return False
        end_s = self._wall.now_s() + self._share_s
        passed = self._served.advance(due, is_enough=lambda: self._wall.now_s() >= end_s)
        self.pace.count(passed)
        if passed < due and (lag_s := self.pace.drop_lag(_MOST_LATE_S)) and self._on_late is not None:
            self._on_late(lag_s)
        return passed < due or due == _MOST_CYCLES

    def _beat(self) -> None:
        try:
            late = self._catch_up()
        except Exception as error:
            self._fail(error)
            return
        beat_s = 0.0 if late else _BUSY_BEAT_S if self._served.busy else _IDLE_BEAT_S
        self._timer = asyncio.get_running_loop().call_later(beat_s, self._beat)

    def _fail(self, error: Exception) -> None:
        if not self.failed.done():
            self.failed.set_exception(error)
