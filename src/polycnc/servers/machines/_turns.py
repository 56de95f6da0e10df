"""Requests before time: what machines of one event loop may do between two looks at its connections."""

from __future__ import annotations

import asyncio
from collections.abc import Callable

from polycnc.machine import Wall

_SHARE_S = 0.005  # for the beats together, and as much for the requests together


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
