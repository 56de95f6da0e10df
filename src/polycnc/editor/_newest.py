"""Work on the newest of several texts, one at a time: what has been overtaken ends early and is not told."""

from __future__ import annotations

import asyncio
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from typing import TypeVar

R = TypeVar("R")
GoOn = Callable[[], None]
"""To be called now and then by work; it raises `Overtaken` where nobody waits for the answer any more."""


LONGEST_S = 20.0
"""How long one text may be computed on, however busy the computer is; a program can loop without end."""


class Overtaken(Exception):  # noqa: N818  it is no error
    """Other work has been given for the same text since."""


class TooLong(Exception):  # noqa: N818  it is no error
    """A text has been looked at for as long as it may be."""


def within(time_s: float, go_on: GoOn) -> Callable[[float], None]:
    """Return what ends the work of this thread as `go_on` does, and by `TooLong` after so much computing."""
    until = time.thread_time() + time_s

    def progress(_: float) -> None:
        go_on()
        if time.thread_time() > until:
            raise TooLong

    return progress


class Newest:
    """Run work in threads, one at a time; for each key the last work given wins.

    A thread does not keep the process from ending.
    """

    def __init__(self) -> None:
        self._turn: dict[str, int] = {}
        self._lock: asyncio.Lock | None = None

    async def run(self, key: str, work: Callable[[GoOn], R]) -> R | None:
        """Return what `work` gives, None where other work for the same key was given since."""
        self.drop(key)
        turn = self._turn[key]

        def go_on() -> None:
            if self._turn[key] != turn:
                raise Overtaken

        self._lock = self._lock or asyncio.Lock()  # made within the loop that it belongs to
        async with self._lock:
            with suppress(Overtaken):
                go_on()
                result = await _in_thread(partial(work, go_on))
                go_on()
                return result
        return None

    def drop(self, key: str) -> None:
        """Let work that was given for a key end, and tell nothing any more."""
        self._turn[key] = self._turn.get(key, 0) + 1


async def _in_thread(work: Callable[[], R]) -> R:
    loop = asyncio.get_running_loop()
    future: asyncio.Future[R] = loop.create_future()

    def tell(settle: Callable[[], None]) -> None:
        if not future.done():  # it is where the loop ends
            settle()

    def run() -> None:
        settle: Callable[[], None]
        try:
            settle = partial(future.set_result, work())
        except Exception as error:
            settle = partial(future.set_exception, error)
        with suppress(RuntimeError):  # the loop has ended
            loop.call_soon_threadsafe(tell, settle)

    threading.Thread(target=run, daemon=True).start()
    return await future
