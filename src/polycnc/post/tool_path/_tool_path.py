"""A tool path from any input format: records to go through, remarks, and places for errors."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

from polycnc.errors import SourcePosition
from polycnc.post.tool_path._cl_reader import read_cl
from polycnc.post.tool_path._json_path import read_json
from polycnc.post.tool_path._records import Record
from polycnc.post.tool_path._source import Remarks, Source

_Reader = Callable[[Source, Remarks], Iterator[Record]]


class ToolPath:
    """Records in the order of the tool path. Every iteration reads them anew, and forgets older remarks."""

    def __init__(self, source: Source, read: _Reader) -> None:
        self.name = source.name
        self.remarks = Remarks()
        self._source = source
        self._read = read

    def __iter__(self) -> Iterator[Record]:
        self.remarks = Remarks()
        return self._read(self._source, self.remarks)

    @property
    def part_read(self) -> float:
        """How far the last iteration is, 0 to 1."""
        return self._source.part_read

    def position(self, line: int) -> SourcePosition:
        """Return the place of a line, for errors."""
        return self._source.position(line)


def open_tool_path(path: str | Path) -> ToolPath:
    """Return the tool path of a file: JSON if its name ends with .json, else APT words.

    Raises:
        UsageError: there is no such file.
    """
    reader = read_json if Path(path).suffix.lower() == ".json" else read_cl
    return ToolPath(Source.from_path(path), reader)


def parse_tool_path(text: str, name: str = "<text>") -> ToolPath:
    """Return the tool path of a text: JSON if it begins with a brace, else APT words."""
    reader = read_json if text.lstrip().startswith("{") else read_cl
    return ToolPath(Source.from_text(text, name), reader)
