"""Requests before time: what machines of one event loop may do between two looks at its connections."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Callable

from polycnc.machine import Wall

_SHARE_S = 0.005  # for the beats together, and as much for the requests together
_HARDLY = 1e-3  # of a tick
_TICK_S = 0.02  # between two times at which beats are due: many machines wake the process no oftener than one


class Turns:
    """Share the time between two looks at the connections among the machines of an event loop.

    Beats that are due wait in a queue. After each look the first of them is carried out, and others as long as their
    share of the wall clock lasts; the rest have their turn after the next look. `may_catch_up` tells requests the same.
    """

    def __init__(self, wall: Wall, share_s: float = _SHARE_S) -> None:
        self._wall = wall
        self._share_s = share_s
        self._waiting: dict[Callable[[], None], None] = {}
        self._planned = False
        self._asked_until_s: float | None = None
        self._begun = 0

    def first_s(self, now_s: float, beat_s: float) -> float:
        """Return when the first beat of one more machine is due: those that begin together take turns."""
        ticks = max(1, round(beat_s / _TICK_S))
        self._begun += 1
        return self.next_s(now_s, now_s + _TICK_S * (1 + self._begun % ticks))

    def next_s(self, now_s: float, due_s: float) -> float:
        """Return the tick after now, by the event loop, at which a beat comes that is due at this time."""
        ticks = math.ceil(due_s / _TICK_S - _HARDLY)
        return max(ticks, math.floor(now_s / _TICK_S + _HARDLY) + 1) * _TICK_S

    def wait(self, beat: Callable[[], None]) -> None:
        """Carry out `beat` when it has its turn."""
        self._waiting[beat] = None
        self._plan()

    def forget(self, beat: Callable[[], None]) -> None:
        """Do not carry out `beat`, if it waits."""
        self._waiting.pop(beat, None)

    def may_catch_up(self) -> bool:
        """Whether a request may let time pass, or finds its machine as it is because others have let enough pass."""
        now_s = self._wall.now_s()
        if self._asked_until_s is None:
            self._asked_until_s = now_s + self._share_s
            asyncio.get_running_loop().call_soon(self._look)  # carried out after the next look
        return now_s < self._asked_until_s

    def _look(self) -> None:
        self._asked_until_s = None

    def _plan(self) -> None:
        if not self._planned:
            self._planned = True
            asyncio.get_running_loop().call_later(0.0, self._go)  # timers come after what was received

    def _go(self) -> None:
        self._planned = False
        end_s = self._wall.now_s() + self._share_s
        for _ in range(len(self._waiting)):
            if not self._waiting:
                return
            beat = next(iter(self._waiting))
            del self._waiting[beat]
            beat()
            if self._wall.now_s() >= end_s:
                break
        if self._waiting:
            self._plan()
