"""What holds for every connection of a client: one that has vanished is noticed, one that only waits ends."""

from __future__ import annotations

import asyncio
import contextlib
import errno
import os
import socket
from collections.abc import Callable, Iterable, Iterator
from typing import Any, Generic, TypeVar

L = TypeVar("L")

VANISHED_AFTER_S = 60
_PROBES, _BETWEEN_S = 4, 10
_OPTIONS = (
    ("TCP_KEEPIDLE", VANISHED_AFTER_S - _PROBES * _BETWEEN_S),
    ("TCP_KEEPINTVL", _BETWEEN_S),
    ("TCP_KEEPCNT", _PROBES),
    ("TCP_USER_TIMEOUT", VANISHED_AFTER_S * 1000),
)
_LAST = 4  # files, of which some may be in use for other things at the moment
_NO_MORE = frozenset({errno.EMFILE, errno.ENFILE, errno.ENOBUFS, errno.ENOMEM})


def notice_loss(transport: asyncio.BaseTransport) -> None:
    """Let the system end a connection whose client has vanished without a word, after a minute.

    The last ones that there are files for are told to the event loop: not every loop tells of those that come after.
    """
    line: socket.socket | None = transport.get_extra_info("socket")
    if line is not None and 0 <= _most_files() <= line.fileno() + _LAST:
        error = OSError(errno.EMFILE, os.strerror(errno.EMFILE))
        asyncio.get_running_loop().call_exception_handler(
            {"message": "the last connections", "exception": error}
        )
    if line is None or line.family not in (socket.AF_INET, socket.AF_INET6):
        return
    line.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    for name, value in _OPTIONS:  # what the system knows of them
        if (option := getattr(socket, name, None)) is not None:
            line.setsockopt(socket.IPPROTO_TCP, option, value)


def peers_of(transports: Iterable[asyncio.BaseTransport | None]) -> list[str]:
    """Return the addresses of the clients of these connections, as users write them."""
    names = (None if each is None else each.get_extra_info("peername") for each in transports)
    return sorted(f"{name[0]}:{name[1]}" if isinstance(name, tuple) else "local" for name in names if name)


class Crowd(Generic[L]):
    """The connections of a door, the oldest first; beyond `most` the oldest that `is_silent` makes room, by `end`."""

    def __init__(self, most: int, is_silent: Callable[[L], bool], end: Callable[[L], None]) -> None:
        self._most = most
        self._is_silent = is_silent
        self._end = end
        self._lines: dict[L, None] = {}

    def __iter__(self) -> Iterator[L]:
        return iter(tuple(self._lines))

    def __len__(self) -> int:
        return len(self._lines)

    def __contains__(self, line: object) -> bool:
        return line in self._lines

    def join(self, line: L) -> bool:
        """Note a connection; False where none makes room for it."""
        if len(self._lines) >= self._most:
            silent = next(filter(self._is_silent, self._lines), None)
            if silent is None:
                return False
            del self._lines[silent]
            self._end(silent)
        self._lines[line] = None
        return True

    def leave(self, line: L) -> None:
        """Forget a connection."""
        self._lines.pop(line, None)


class Patience:
    """End something that a client leaves half done: `expired` is called when `limit_s` have passed since `begin`."""

    def __init__(self, expired: Callable[[], None]) -> None:
        self._expired = expired
        self._timer: asyncio.TimerHandle | None = None

    def begin(self, limit_s: float) -> None:
        """Count anew."""
        self.end()
        self._timer = asyncio.get_running_loop().call_later(limit_s, self._expired)

    def end(self) -> None:
        """Wait for nothing any more."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None


def take_all_files() -> None:
    """Let the process have as many files, and so connections, as the system allows it."""
    try:
        import resource
    except ImportError:  # Windows has no such limit
        return
    _, most = resource.getrlimit(resource.RLIMIT_NOFILE)
    with contextlib.suppress(OSError, ValueError):
        resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))


def _most_files() -> int:
    """Return how many files the process may have, -1 where there is no limit."""
    try:
        import resource
    except ImportError:
        return -1
    return resource.getrlimit(resource.RLIMIT_NOFILE)[0]


def tell_errors(loop: asyncio.AbstractEventLoop, tell: Callable[[str, str], None]) -> None:
    """Let what goes wrong in the event loop be told in a word: `tell` gets its kind and text; no traceback comes."""

    def handle(_: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
        error = context.get("exception")
        if isinstance(error, OSError) and error.errno in _NO_MORE:
            tell("crowded", "no more connections can be taken: the system gives this process no more files")
        else:
            tell("internal error", f"{context.get('message', '')}: {error!r}"[:500])

    loop.set_exception_handler(handle)
