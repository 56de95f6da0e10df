"""Bytes of a sender: real-time commands, which act wherever they stand, and lines."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from typing import NamedTuple

RX_BYTES = 128
"""What a sender that counts characters believes to be there for its lines."""
MOST_WAITING = 1 << 16
"""Bytes beyond this are dropped, as a full receive buffer does."""
MOST_CHARACTERS = 79
LINE = ord("\n")
"""What reading gives where a line is complete."""

_REAL_TIME = frozenset(b"?!~\x18")
_FIRST_EXTENDED = 0x80
_ENDS = frozenset(b"\r\n")


class Line(NamedTuple):
    """A line without blanks and comments, in capitals; `size` is what it takes in the receive buffer."""

    text: str
    size: int
    overflows: bool = False


class LineReader:
    """Take lines apart from real-time bytes, however the bytes are cut; `lines` wait to be executed."""

    def __init__(self) -> None:
        self.lines: deque[Line] = deque()
        self._waiting = 0
        self.clear()

    @property
    def free(self) -> int:
        """How many bytes of the receive buffer are free, as a status report says."""
        return max(0, RX_BYTES - self._waiting - self._size)

    def clear(self) -> None:
        """Forget all that waits."""
        self.lines.clear()
        self._waiting = 0
        self._begin()

    def _begin(self) -> None:
        self._text: list[str] = []
        self._size = 0
        self._comment = ""
        self._overflows = False

    def read(self, data: bytes) -> Iterator[int]:
        """Take bytes; yield each real-time command, and LINE where a line is complete."""
        for byte in data:
            if byte in _REAL_TIME or byte >= _FIRST_EXTENDED:
                yield byte
            elif self._waiting + self._size < MOST_WAITING and self._take(byte):
                yield LINE

    def take(self) -> Line:
        """Take the line that comes next."""
        line = self.lines.popleft()
        self._waiting -= line.size
        return line

    def _take(self, byte: int) -> bool:
        """Take a byte of a line; tell whether it is complete."""
        self._size += 1
        if byte in _ENDS:
            self.lines.append(Line("".join(self._text), self._size, self._overflows))
            self._waiting += self._size
            self._begin()
            return True
        char = chr(byte)
        if self._comment:
            if self._comment == "(" and char == ")":
                self._comment = ""
        elif char in "(;":
            self._comment = char
        elif char > " " and char != "/" and char != "\x7f":
            self._overflows |= len(self._text) >= MOST_CHARACTERS
            if not self._overflows:
                self._text.append(char.upper())
        return False
