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
    """Let tools cut a body along the rows of a course; a tool that is not among `tools` cuts nothing."""

    def __init__(self, stock: Stock, tools: Mapping[int, Tool]) -> None:
        self._stock = stock
        self._outlines = {
            number: (
                tool.cutting_profile().rows,
                # The edge of a boring bar is free at rapid.
                (tool.core_profile() if tool.kind is ToolKind.BORING else tool.cutting_profile()).rows,
            )
            for number, tool in tools.items()
        }
        self._tip, self._tool = np.zeros((0, 3)), np.zeros(0, np.int64)

    def add(self, rows: Rows) -> None:
        """Take the next rows; the tool comes from where the last ones ended."""
        begun = len(self._tool)
        tip, tool = np.concatenate((self._tip, rows.tip)), np.concatenate((self._tool, rows.tool))
        self._tip, self._tool = tip[-1:], tool[-1:]
        # Another tool has not come that way.
        number, rapid = np.where(tool[1:] == tool[:-1], tool[1:], -1), rows.rapid[1 - begun :]
        for first, last in runs(2 * number + rapid):
            outlines = self._outlines.get(int(number[first]))
            if outlines is not None:
                places = np.ascontiguousarray(tip[first : last + 1])
                cutter, figures = outlines[int(rapid[first])], np.zeros((last - first, FIGURES))
                sweep(self._stock.grid, places, cutter, cutter[:0], figures, figures)
