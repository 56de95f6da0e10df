"""Who lets the time of a served machine pass and carries out what its clients ask.

A host does it in a thread of its own, for a device that is commanded from elsewhere too. A keeper does it in the event
loop: without a change of threads for every request, and a thousand machines in one process.
"""

from __future__ import annotations

import asyncio
import math
from collections.abc import Callable
from typing import Any, Protocol, TypeVar

from polycnc.machine import Clock, Host, HostError, Pace, Wall
from polycnc.servers.machines._turns import Turns

R = TypeVar("R")
_BUSY_BEAT_S = 0.1  # as watches look; whoever asks, or is told more often, lets time pass himself
_UNSEEN_BEAT_S = 0.3  # where nobody watches; well below what is dropped as late
_IDLE_BEAT_S = 1.0
_MOST_CYCLES = 20_000  # that are caught up with in one go
_MOST_LATE_S = 0.5
_REST = 9.0  # times what catching up has cost, in which requests find the device as it is
_MOST_REST_S = 0.005
_EARLY = 1.0 - 1e-6  # what rounding may make of the time to the next cycle


class Owner(Protocol):
    """Carry out what is asked between two cycles of a device."""

    def submit(self, command: Callable[[], R], done: Callable[[R], None]) -> bool:
        """Carry out `command` and give its result to `done` in the event loop; False if it cannot be carried out."""


class HostOwner:
    """Leave it to a running host."""

    def __init__(self, host: Host[Any]) -> None:
        self._host = host

    def submit(self, command: Callable[[], R], done: Callable[[R], None]) -> bool:
        """Post `command` to the host."""
        loop = asyncio.get_running_loop()
        try:
            posted = self._host.post(lambda _: command())
        except HostError:
            return False
        posted.add_done_callback(
            lambda future: None if future.exception() else loop.call_soon_threadsafe(done, future.result())
        )
        return True


class Kept(Protocol):
    """What a keeper lets the time of pass."""

    @property
    def clock(self) -> Clock:
        """The clock of the device."""

    @property
    def busy(self) -> bool:
        """Whether something happens in it, so that time has to pass often."""

    @property
    def is_followed(self) -> bool:
        """Whether somebody wants to see it as soon as it happens."""

    def advance(self, cycles: int, *, is_enough: Callable[[], bool] | None = None) -> int:
        """Let up to `cycles` control cycles pass, or until `is_enough` says so; return how many did."""


class Keeper:
    """Let the time of a device pass in the running event loop, at `rate` seconds for each second of `wall`.

    Time is let pass before a request and, from `start` on, from time to time, for at most `share_s` of the wall clock
    in one go, so that nobody waits long for others whose time is costly. Requests that follow each other closely find
    the device as it is while no cycle is due, and for nine times what catching up has cost, at most 5 ms: then it costs
    a tenth of the time, and not a cycle for each of them. Keepers of one event loop share its `turns`: requests come
    before time. A clock that is late by half a second drops its lag and tells `on_late` how much.
    `failed` ends with the error if time cannot pass.
    """

    def __init__(
        self,
        served: Kept,
        wall: Wall,
        *,
        rate: float = 1.0,
        share_s: float = 0.01,
        on_late: Callable[[float], None] | None = None,
        turns: Turns | None = None,
    ) -> None:
        self._turns = turns or Turns(wall, math.inf)
        # When nothing was left to be done before a request, if nothing has come since.
        self._asked_s = -math.inf
        self.pace = Pace(wall, rate, changed=self._soon)
        self._wall = wall
        self._share_s = share_s
        self._on_late = on_late
        self.failed: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._served = served
        self._timer: asyncio.TimerHandle | None = None
        self._due_s = math.inf  # when the next beat is planned, by the event loop
        self._latest_s = 0.0
        self._rests_until_s = -math.inf
        self._has_changed = False
        self.pace.forget()

    def start(self) -> None:
        """Let time pass from now on, without being asked; what has passed outside until now is not caught up with."""
        if self.failed.done():
            return
        self.pace.forget()
        beat_s = self._beat_s()
        self._call_at(self._turns.first_s(asyncio.get_running_loop().time(), beat_s))

    def submit(self, command: Callable[[], R], done: Callable[[R], None]) -> bool:
        """Let time pass, carry out `command`, and tell its result at once; False if time cannot pass."""
        if self.failed.done():
            return False
        try:
            if self._is_wanted():
                self._asked_s = -math.inf if self._catch_up() else self._wall.now_s()
            result = command()
        except Exception as error:
            self._fail(error)
            return False
        done(result)
        return True

    def close(self) -> None:
        """Let no more time pass."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
        self._turns.forget(self._beat)
        if not self.failed.done():
            self.failed.cancel()

    def _is_wanted(self) -> bool:
        """Whether time has to pass before a request."""
        if self._has_changed:
            self._has_changed = False
            return True
        return self._wall.now_s() >= self._rests_until_s and self._turns.may_catch_up()

    def _catch_up(self, *, whole: bool = True) -> bool:
        """Let pass what is due, within its share of the wall clock; tell whether there is more.

        Unless the `whole` is asked for, it ends at a multiple of the beat, where watches look, too: then each stretch
        of time costs its overhead once.
        """
        clock = self._served.clock
        due = self.pace.due(clock.cycle_s, _MOST_CYCLES)
        beat = clock.cycles_for(_BUSY_BEAT_S)
        if not whole and 0 < beat <= due < _MOST_CYCLES:
            due -= (clock.cycles + due) % beat
        if not due:
            wait_s = self.pace.wait_s(clock.cycle_s, 1) * _EARLY
            self._rests_until_s = self._wall.now_s() + min(wait_s, _MOST_REST_S)
            return False
        begin_s = self._wall.now_s()
        end_s = begin_s + self._share_s
        passed = self._served.advance(due, is_enough=lambda: self._wall.now_s() >= end_s)
        self.pace.count(passed)
        now_s = self._wall.now_s()
        self._rests_until_s = now_s + min(_REST * (now_s - begin_s), _MOST_REST_S)
        if passed < due and (lag_s := self.pace.drop_lag(_MOST_LATE_S)) and self._on_late is not None:
            self._on_late(lag_s)
        return passed < due or due == _MOST_CYCLES

    def take_lateness_s(self) -> float:
        """Return by how much the latest beat since this was asked last came too late, or what was due was done."""
        latest_s, self._latest_s = self._latest_s, 0.0
        return latest_s

    def _beat(self) -> None:
        """Let pass what is due; where a request has done that meanwhile, the beat comes as long after it."""
        now_s, beat_s = asyncio.get_running_loop().time(), self._beat_s()
        since_s = self._wall.now_s() - self._asked_s
        if since_s < beat_s and self._due_s <= now_s:
            self._due_s = now_s - since_s
            self._plan(now_s, beat_s)
            return
        try:
            late = self._catch_up(whole=False)
        except Exception as error:
            self._fail(error)
            return
        now_s = asyncio.get_running_loop().time()
        self._latest_s = max(self._latest_s, now_s - self._due_s)
        if late:
            self._asked_s = -math.inf
            self._due_s = min(self._due_s, now_s)
            self._turns.wait(self._beat)
        else:
            self._plan(now_s, self._beat_s())

    def _plan(self, now_s: float, beat_s: float) -> None:
        self._call_at(self._turns.next_s(now_s, min(self._due_s, now_s) + beat_s))

    def _call_at(self, due_s: float) -> None:
        self._due_s = due_s
        self._timer = asyncio.get_running_loop().call_at(due_s, self._turns.wait, self._beat)

    def _beat_s(self) -> float:
        if not self._served.busy:
            return _IDLE_BEAT_S
        return _BUSY_BEAT_S if self._served.is_followed else _UNSEEN_BEAT_S

    def _soon(self) -> None:
        """Look soon: the rate has changed, or steps are due."""
        self._has_changed = True
        self._asked_s = -math.inf
        if self._timer is not None:
            self._timer.cancel()
            self._turns.wait(self._beat)

    def _fail(self, error: Exception) -> None:
        if not self.failed.done():
            self.failed.set_exception(error)
