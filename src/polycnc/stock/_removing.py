"""Cut a body for who looks at it alone: nothing is noted of what goes wrong, or how hard tools cut."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from polycnc.stock._rows import Rows
from polycnc.stock._stock import Stock
from polycnc.stock._sweep import FIGURES, sweep
from polycnc.stock._tool import Tool, ToolKind
from polycnc.stock._ways import runs


class Removing:
    """Let tools cut a body along a course, as far as is asked; a tool that is not among `tools` cuts nothing."""

    def __init__(self, stock: Stock, tools: Mapping[int, Tool], course: Rows) -> None:
        self._stock = stock
        self._outlines = {
            number: (
                tool.cutting_profile().rows,
                # The edge of a boring bar is free at rapid.
                (tool.core_profile() if tool.kind is ToolKind.BORING else tool.cutting_profile()).rows,
            )
            for number, tool in tools.items()
        }
        self._tip = np.ascontiguousarray(course.tip)
        # Another tool has not come the way to its first row.
        same = course.tool[1:] == course.tool[:-1]
        way = np.where(same, 2 * course.tool[1:] + course.rapid[1:], -1)
        self._ways = [(int(way[first]), last) for first, last in runs(way)] if len(way) else []
        self._next, self._at = 0, 0

    def up_to(self, row: int) -> None:
        """Cut from where the tool is to a row of the course."""
        while self._at < row and self._next < len(self._ways):
            way, last = self._ways[self._next]
            first, last = self._at, min(last, row)
            self._at = last
            self._next += last == self._ways[self._next][1]
            outlines = self._outlines.get(way // 2)
            places = self._tip[first : last + 1]
            if outlines is not None and places[:, 2].min() < self._stock.box.high[2]:
                cutter, figures = outlines[way % 2], np.zeros((last - first, FIGURES))
                sweep(self._stock.grid, places, cutter, cutter[:0], figures, figures)
