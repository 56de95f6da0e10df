"""What ways remove and what goes wrong on them, added up."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from polycnc.stock._contacts import Contacts, Idle
from polycnc.stock._engagement import EngagementLog
from polycnc.stock._insert import Insert
from polycnc.stock._sweep import VOLUME_MM3
from polycnc.stock._tool import Tool
from polycnc.stock._ways import Ways, runs

Floats = npt.NDArray[np.float64]

IDLE_S = 3.0
"""How long a block feeds through air before that is remarked."""
NEAR_CELLS = 2.0
"""How far from what it has cut a tool is in the air."""


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

    def count_idle(self, ways: Ways, figures: Floats, is_near: Callable[[int, int], bool]) -> None:
        """Count the time of feeding that removes nothing, and note blocks that feed through air for long.

        `is_near` tells whether a tool that removes nothing goes along what it has cut, on ways from one to another: it
        is not in the air then.
        """
        moves = np.any(ways.places[1:] != ways.places[:-1], axis=1)
        duration = np.where(moves & (figures[:, VOLUME_MM3] <= 0.0), ways.duration_s, 0.0)
        self.idle_s += float(duration.sum())
        block = ways.block
        for first, last in runs(block):
            whole_s = float(duration[first:last].sum())
            if whole_s < IDLE_S or figures[first:last, VOLUME_MM3].any() or is_near(first, last):
                continue
            x, y, z = ways.places[last].tolist()
            t_s = float(ways.rows.t_s[ways.begins[first]])
            self.idle.append(Idle(int(block[first]), t_s, whole_s, (x, y, z)))

    def count(self, ways: Ways, figures: Floats, tool: Tool | Insert) -> None:
        """Count what each way has removed."""
        self.engaged.add(ways, figures, tool)
        blocks, volume_mm3 = ways.block, figures[:, VOLUME_MM3]
        if len(self.by_block_mm3) <= blocks.max():
            self.by_block_mm3 = np.concatenate((self.by_block_mm3, np.zeros(int(blocks.max()) + 1)))
        np.add.at(self.by_block_mm3, blocks, volume_mm3)
        self.by_tool_mm3[ways.number] = self.by_tool_mm3.get(ways.number, 0.0) + float(volume_mm3.sum())
