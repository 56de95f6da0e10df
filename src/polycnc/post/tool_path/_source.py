"""Where a tool path comes from: a file that is read line by line, or a text; and remarks on what was left out."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from polycnc.errors import SourcePosition, UsageError

_PIECE_BYTES = 1 << 18
_LONG_BYTES = 1 << 21


class Source:
    """The lines of a tool path, as bytes."""

    def __init__(self, name: str, content: bytes | Path) -> None:
        self.name = name
        self._content = content
        self._size = len(content) if isinstance(content, bytes) else content.stat().st_size
        self._file: BinaryIO | None = None

    @classmethod
    def from_path(cls, path: str | Path) -> Source:
        """Return the source of a file.

        Raises:
            UsageError: there is no such file.
        """
        path = Path(path)
        try:
            with path.open("rb"):
                return cls(str(path), path)
        except FileNotFoundError:
            raise UsageError(f"no such file: {path}", hint="Check the name and the folder.") from None
        except (OSError, ValueError) as error:  # ValueError: no file can have this name
            why = error.strerror if isinstance(error, OSError) else error
            raise UsageError(f"cannot read {path}: {why}", hint="Give a readable file.") from None

    @classmethod
    def from_text(cls, text: str, name: str = "<text>") -> Source:
        """Return the source of a text."""
        return cls(name, text.encode())

    def pieces(self) -> Iterator[bytes]:
        """Yield the content in pieces of whole lines, each of which ends with a line feed, the last one maybe not."""
        if isinstance(self._content, bytes):
            yield _with_line_feeds(self._content)
            return
        with self._content.open("rb") as self._file:
            while piece := self._file.read(_PIECE_BYTES):
                yield _with_line_feeds(piece + self._file.readline())

    def lines(self) -> Iterator[bytes]:
        """Yield the lines, from the first."""
        for piece in self.pieces():
            yield from piece.splitlines(keepends=True)

    @property
    def is_long(self) -> bool:
        """Whether it has two megabytes and more."""
        return self._size >= _LONG_BYTES

    @property
    def part_read(self) -> float:
        """How far the last reading of a file is, 0 to 1; 1 for a text."""
        if self._file is None or self._file.closed or not self._size:
            return 1.0
        return min(self._file.tell() / self._size, 1.0)

    def text(self) -> str:
        """Return the whole text."""
        return "".join(decoded(line) + "\n" for line in self.lines())

    def position(self, number: int, column: int = 0) -> SourcePosition:
        """Return the place of a line, at its first character that is no blank if no column is given."""
        text = next((decoded(raw) for at, raw in enumerate(self.lines(), 1) if at == number), "")
        return SourcePosition(self.name, number, column or len(text) - len(text.lstrip()) + 1, text)


def _with_line_feeds(text: bytes) -> bytes:
    """Return a text whose lines end with LF, where they ended with CR LF or CR."""
    return text.replace(b"\r\n", b"\n").replace(b"\r", b"\n") if b"\r" in text else text


def decoded(raw: bytes) -> str:
    """Return a line without its newline: UTF-8, else Shift-JIS, else Latin-1."""
    raw = raw.rstrip(b"\r\n").removeprefix(b"\xef\xbb\xbf")
    for encoding in ("utf-8", "cp932"):
        try:
            return raw.decode(encoding)
        except UnicodeDecodeError:
            pass
    return raw.decode("latin-1")


@dataclass(frozen=True, slots=True)
class Remark:
    """Something that was left out or is doubtful: the first line it is about, and how often it came up."""

    line: int
    text: str
    count: int = 1


class Remarks:
    """Collect remarks; equal texts count as one."""

    def __init__(self) -> None:
        self._found: dict[str, tuple[int, int]] = {}

    def add(self, line: int, text: str) -> None:
        """Add a remark."""
        first, count = self._found.get(text, (line, 0))
        self._found[text] = (first, count + 1)

    def all(self) -> list[Remark]:
        """Return all remarks, in the order in which they first came up."""
        return [Remark(line, text, count) for text, (line, count) in self._found.items()]
