"""What ways remove and what goes wrong on them, added up."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from polycnc.stock._contacts import Contacts, Idle
from polycnc.stock._engagement import EngagementLog
from polycnc.stock._insert import Insert
from polycnc.stock._sweep import VOLUME_MM3
from polycnc.stock._tool import Tool
from polycnc.stock._ways import Ways

Floats = npt.NDArray[np.float64]


class Tally:
    """Add up what blocks and tools remove, and keep what goes wrong."""

    def __init__(self) -> None:
        self.by_block_mm3 = np.zeros(0)
        self.by_tool_mm3: dict[int, float] = {}
        self.contacts = Contacts()
        self.unknown_tools: set[int] = set()
        self.idle: list[Idle] = []
        self.idle_s = 0.0
        self.engaged = EngagementLog()

    def miss(self, ways: Ways) -> None:
        """Keep the number of a tool whose shape is not known, if it is fed along the ways."""
        if not ways.rapid and np.any(ways.places[1:] != ways.places[:-1]):
            self.unknown_tools.add(ways.number)

    def count(self, ways: Ways, figures: Floats, tool: Tool | Insert) -> None:
        """Count what each way has removed."""
        self.engaged.add(ways, figures, tool)
        blocks, volume_mm3 = ways.block, figures[:, VOLUME_MM3]
        if len(self.by_block_mm3) <= blocks.max():
            self.by_block_mm3 = np.concatenate((self.by_block_mm3, np.zeros(int(blocks.max()) + 1)))
        np.add.at(self.by_block_mm3, blocks, volume_mm3)
        self.by_tool_mm3[ways.number] = self.by_tool_mm3.get(ways.number, 0.0) + float(volume_mm3.sum())
