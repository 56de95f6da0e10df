"""A tool path from any input format: records to go through, remarks, and places for errors."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

from polycnc.errors import SourcePosition
from polycnc.post.tool_path._cl_reader import read_cl
from polycnc.post.tool_path._cl_reading import ArcAxis
from polycnc.post.tool_path._json_path import read_json
from polycnc.post.tool_path._records import Points, Record, one_by_one
from polycnc.post.tool_path._source import Remarks, Source
from polycnc.post.tool_path._turned import turned_from_xy

_Reader = Callable[[Source, Remarks], Iterator[Record | Points]]


class ToolPath:
    """Records in the order of the tool path. Every iteration reads them anew, and forgets older remarks."""

    def __init__(self, source: Source, read: _Reader) -> None:
        self.name = source.name
        self.remarks = Remarks()
        self._source = source
        self._read = read

    def __iter__(self) -> Iterator[Record]:
        return one_by_one(self.runs())

    def runs(self) -> Iterator[Record | Points]:
        """Return the records, where many points lie one after another together."""
        self.remarks = Remarks()
        return self._read(self._source, self.remarks)

    def turned_from_xy(self) -> ToolPath:
        """Return a path of turning in XY as a lathe's: X becomes Z, Y the radius X."""
        return ToolPath(self._source, turned_from_xy(self._read))

    @property
    def is_long(self) -> bool:
        """Whether it is worth while to compile what takes many of its points at once."""
        return self._source.is_long

    @property
    def part_read(self) -> float:
        """How far the last iteration is, 0 to 1."""
        return self._source.part_read

    def position(self, line: int) -> SourcePosition:
        """Return the place of a line, for errors."""
        return self._source.position(line)


def open_tool_path(path: str | Path, arc_axis: ArcAxis = "auto") -> ToolPath:
    """Return the tool path of a file: JSON if its name ends with .json, else APT words.

    `arc_axis` says what the axis of CIRCLE/ is for: "counterclockwise" by the right-hand rule, "clockwise" against it,
    "auto" clockwise in a CLSF of NX (TOOL PATH/, TLDATA/, MSYS/, PAINT/) and else counterclockwise. JSON is always
    by the right-hand rule.

    Raises:
        UsageError: there is no such file.
    """
    reader = read_json if Path(path).suffix.lower() == ".json" else partial(read_cl, arc_axis=arc_axis)
    return ToolPath(Source.from_path(path), reader)


def parse_tool_path(text: str, name: str = "<text>", arc_axis: ArcAxis = "auto") -> ToolPath:
    """Return the tool path of a text: JSON if it begins with a brace, else APT words; `arc_axis` as for files."""
    reader = read_json if text.lstrip().startswith("{") else partial(read_cl, arc_axis=arc_axis)
    return ToolPath(Source.from_text(text, name), reader)
