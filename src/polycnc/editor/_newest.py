"""Work on the newest of several texts, one at a time: what has been overtaken is left out or not told."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from typing import TypeVar

R = TypeVar("R")


class Newest:
    """Run work in threads, one at a time; for each key the last work given wins.

    A thread does not keep the process from ending.
    """

    def __init__(self) -> None:
        self._turn: dict[str, int] = {}
        self._lock: asyncio.Lock | None = None

    async def run(self, key: str, work: Callable[[], R]) -> R | None:
        """Return what `work` gives, None where other work for the same key was given since."""
        turn = self._turn[key] = self._turn.get(key, 0) + 1
        self._lock = self._lock or asyncio.Lock()  # made within the loop that it belongs to
        async with self._lock:
            if self._turn[key] != turn:
                return None
            result = await _in_thread(work)
        return result if self._turn[key] == turn else None

    def drop(self, key: str) -> None:
        """Let work that was given for a key tell nothing any more."""
        self._turn[key] = self._turn.get(key, 0) + 1


async def _in_thread(work: Callable[[], R]) -> R:
    loop = asyncio.get_running_loop()
    future: asyncio.Future[R] = loop.create_future()

    def run() -> None:
        tell: Callable[[], None]
        try:
            tell = partial(future.set_result, work())
        except Exception as error:
            tell = partial(future.set_exception, error)
        with suppress(RuntimeError):  # the loop has ended
            loop.call_soon_threadsafe(tell)

    threading.Thread(target=run, daemon=True).start()
    return await future
