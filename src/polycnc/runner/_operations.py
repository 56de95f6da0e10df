"""The operations of a program: what it does between its tool changes and remarks, and how long that takes."""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace
from itertools import pairwise

from polycnc.cnc import ToolTime
from polycnc.nc import ProgramText
from polycnc.stock import tool_number

_ALONE = re.compile(rb"[ \t]*(?:/?[Nn][0-9]+[ \t]*)?(?:\(([^)\r\n]*)\)|;([^\r\n]*))[ \t]*")


@dataclass(frozen=True, slots=True)
class Operation:
    """A part of a program: the remark before it, the line where it begins, its tool, and its times in s.

    `time_s` is all of it, with tool changes, dwells and functions.
    """

    name: str
    line: int
    tool: int
    time_s: float
    cutting_s: float
    rapid_s: float

    def with_rest(self, time_s: float, rapid_s: float) -> Operation:
        """Return the same operation with what follows it and cuts nothing."""
        return replace(self, time_s=self.time_s + time_s, rapid_s=self.rapid_s + rapid_s)


@dataclass(frozen=True, slots=True)
class _Mark:
    line: int
    name: str
    tool: int
    time_s: float
    moved: ToolTime


@dataclass(slots=True)
class OperationCollector:
    """Collect the operations of the main program: one begins at a tool change, or at a function after a remark."""

    text: ProgramText
    _marks: list[_Mark] = field(default_factory=list)
    _behind: int = 0  # offset after the last function seen

    def function(self, line: int, tool: int, changes_tool: bool, time_s: float, moved: ToolTime) -> None:
        """Take an auxiliary function on a line of the main program, before it has taken any time.

        `tool` is in the spindle after it, `moved` are the times of the path so far.
        """
        offset = self.text.line_start(line)
        name = self._remark(self._behind, offset, tool) if offset > self._behind else ""
        self._behind = max(self._behind, offset)
        if not self._marks or changes_tool or name:
            self._marks.append(_Mark(line, name, tool, time_s, moved))

    def has_remark(self, line: int) -> bool:
        """Tell whether anything stands between the last function and a line that may be a remark."""
        content, end = self.text.content, self.text.line_start(line)
        return any(content.find(sign, self._behind, end) >= 0 for sign in (b"(", b";"))

    def operations(self, time_s: float, moved: ToolTime) -> list[Operation]:
        """Return the operations; what cuts nothing belongs to the next, at the end to the last."""
        marks = [*self._marks, _Mark(0, "", 0, time_s, moved)]
        if self._marks and self._marks[0].moved != ToolTime():
            marks.insert(0, _Mark(1, "", 0, 0.0, ToolTime()))
        found: list[Operation] = []
        begin: _Mark | None = None
        name = ""
        for mark, after in pairwise(marks):
            begin = begin or mark
            name = mark.name or name
            cutting = after.moved.cutting_s - begin.moved.cutting_s
            rapid = after.moved.rapid_s - begin.moved.rapid_s
            if cutting <= 0.0 and after is not marks[-1]:
                continue
            if cutting <= 0.0 and found:
                found[-1] = found[-1].with_rest(after.time_s - begin.time_s, rapid)
                continue
            found.append(Operation(name, begin.line, mark.tool, after.time_s - begin.time_s, cutting, rapid))
            begin, name = None, ""
        return found

    def _remark(self, begin: int, end: int, tool: int) -> str:
        """Return the last remark that stands alone in a line between two offsets and is about no other tool."""
        content = self.text.content
        places = {sign: content.rfind(sign, begin, end) for sign in (b"(", b";")}
        while (at := max(places.values())) >= 0:
            start = content.rfind(b"\n", begin, at) + 1 or begin
            if found := _ALONE.fullmatch(content, start, self.text.line_end(start)):
                remark = (found[1] or found[2] or b"").decode("utf-8", "replace").strip()
                if remark and not (tool and tool_number(remark) not in (None, tool)):
                    return remark
            for sign, place in places.items():
                if place >= start:
                    places[sign] = content.rfind(sign, begin, start)
        return ""
