"""A program that is still coming: whole lines wait here until the channel that executes it reads them."""

from __future__ import annotations

import re
from collections import deque
from typing import NamedTuple

from polycnc.nc.text._program import ProgramText

ROOM_BYTES = 1 << 16
"""How much of a program may wait to be read."""

_LINE_END = re.compile(rb"\r\n|\n|\r")


class Arrived(NamedTuple):
    """What a piece of text adds: the whole lines, what stands after the last newline, whether that was a bare CR."""

    lines: tuple[bytes, ...]
    rest: bytes
    after_return: bool


class IncomingText(ProgramText):
    """Hold what has come of a program and has not been read yet, at most `room_bytes`.

    Where it is cut makes no difference: a line counts when its newline has come, or the end. Line numbers go on from
    piece to piece; what has been read is not kept.
    """

    def __init__(self, name: str, room_bytes: int = ROOM_BYTES) -> None:
        super().__init__(name, b"")
        self.room_bytes = room_bytes
        self.ended = False
        """Whether nothing more comes."""
        self.closed = False
        """Whether it has been executed to its end, or broken off."""
        self._waiting: deque[bytes] = deque()
        self._bytes = 0
        self._rest = b""
        self._after_return = False
        self._taken = 0

    @property
    def opening(self) -> ProgramText:
        """An empty text of the same name: what comes are others."""
        return ProgramText(self.name, b"")

    @property
    def room(self) -> int:
        """How many bytes may come now."""
        return max(0, self.room_bytes - self._bytes - len(self._rest))

    @property
    def lines(self) -> int:
        """How many whole lines have come."""
        return self._taken + len(self._waiting)

    @property
    def waiting(self) -> int:
        """How many whole lines have come and have not been read."""
        return len(self._waiting)

    @property
    def over(self) -> bool:
        """Whether all of it has been read and nothing more comes."""
        return self.ended and not self._waiting

    def arrived(self, data: bytes) -> Arrived:
        """Return what a piece of text would add; nothing changes."""
        if self._after_return:
            data = data.removeprefix(b"\n") if data else data
        whole = self._rest + data
        ends = [found.end() for found in _LINE_END.finditer(whole)]
        begins = [0, *ends[:-1]]
        lines = tuple(whole[begin:end] for begin, end in zip(begins, ends, strict=bool(ends)))
        rest = whole[ends[-1] :] if ends else whole
        bare = self._after_return and not data
        return Arrived(lines, rest, bare or (bool(ends) and not rest and whole.endswith(b"\r")))

    def piece(self, lines: tuple[bytes, ...]) -> ProgramText:
        """Return lines that come next as a text of their own, with the numbers that they will have."""
        return ProgramText(self.name, b"".join(lines), self.lines + 1)

    def put(self, arrived: Arrived) -> None:
        """Let lines wait to be read."""
        self._waiting.extend(arrived.lines)
        self._bytes += sum(map(len, arrived.lines))
        self._rest, self._after_return = arrived.rest, arrived.after_return

    def take(self, *, one_line: bool) -> ProgramText | None:
        """Take what waits, or one line of it, as a text of its own; None if nothing does."""
        if not self._waiting:
            return None
        taken = [self._waiting.popleft()] if one_line else list(self._waiting)
        if not one_line:
            self._waiting.clear()
        self._bytes -= sum(map(len, taken))
        first = self._taken + 1
        self._taken += len(taken)
        return ProgramText(self.name, b"".join(taken), first)

    def close(self) -> None:
        """Drop what waits; nothing more comes."""
        self.ended = self.closed = True
        self._waiting.clear()
        self._bytes, self._rest = 0, b""
