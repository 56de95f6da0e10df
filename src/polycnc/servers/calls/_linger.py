"""A moment's wait for the next call of a client that has just been answered, without a turn of the event loop."""

from __future__ import annotations

import asyncio
import contextlib
import os
import select
import socket
from collections.abc import Iterator

_MOST_CALLS = 16  # then the event loop has its turn, whoever calls
_TRIES = 50  # about a tenth of a millisecond in all, in which most clients call again
_WAIT_MS = 1


class Linger:
    """What a connection receives while nothing else is to be done, in its `buffer`.

    A turn of the event loop takes longer than a frame that comes over the loopback, and so does being woken: it is
    looked for a few times before it is waited for. Whatever else the loop has to look at ends the wait at once; its
    timers come late by a millisecond at most. Where the system cannot wait for an event loop, nothing is ever received
    here.
    """

    def __init__(self, transport: asyncio.Transport, buffer: memoryview) -> None:
        self._transport, self._buffer = transport, buffer
        selector = getattr(asyncio.get_running_loop(), "_selector", None)
        self._line: socket.socket | None = None
        if hasattr(select, "epoll") and selector is not None:
            self._line = socket.socket(fileno=os.dup(transport.get_extra_info("socket").fileno()))
            self._poll = select.poll()
            self._poll.register(self._line, select.POLLIN)
            self._poll.register(selector.fileno(), select.POLLIN)

    def received(self) -> Iterator[int]:
        """Go through how many bytes have come, each time as long as the connection is read at all."""
        if self._line is None:
            return
        for _ in range(_MOST_CALLS):
            if not self._transport.is_reading() or not (count := self._take(self._line)):
                return
            yield count

    def _take(self, line: socket.socket) -> int:
        """Return how many bytes have come, 0 if there are none for now."""
        try:
            for _ in range(_TRIES):
                with contextlib.suppress(BlockingIOError):
                    return line.recv_into(self._buffer)
                os.sched_yield()  # there may be no other core for the client
            here = (line.fileno(), select.POLLIN)
            return line.recv_into(self._buffer) if here in self._poll.poll(_WAIT_MS) else 0
        except OSError:  # the event loop hears of it too
            return 0

    def close(self) -> None:
        """Wait no more."""
        if self._line is not None:
            self._line.close()
            self._line = None
