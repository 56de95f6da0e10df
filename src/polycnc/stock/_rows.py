"""A record of where the tool was, one row a cycle."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]

ARM_MM = 50.0
"""How far up its axis a tool is looked at where it turns."""


@dataclass(frozen=True, eq=False)
class Rows:
    """Hold a piece of a record, one row a cycle: `tip` is the end of the tool (mm).

    `axis` points from the tip to the holder. `turns` are those of the spindle in a minute: above zero clockwise (M3),
    below the other way; 0: it is at rest.
    """

    t_s: Floats
    tip: Floats  # [rows, 3]
    block: Integers
    tool: Integers
    rapid: npt.NDArray[np.bool_]
    turns: Floats
    axis: Floats = field(default_factory=lambda: np.array([[0.0, 0.0, 1.0]]))  # [rows, 3], or one for all

    def columns(self) -> tuple[npt.NDArray[Any], ...]:
        """Return the columns in their order."""
        axis = np.broadcast_to(self.axis, self.tip.shape)
        return self.t_s, self.tip, self.block, self.tool, self.rapid, self.turns, axis

    def guides(self) -> Floats:
        """Return where the tool is by its tip, and where it turns by a point up its axis too [rows, 3 or 6]."""
        if len(self.axis) < 2 or np.all(self.axis == self.axis[0]):
            return np.ascontiguousarray(self.tip)
        return np.concatenate((self.tip, self.tip + ARM_MM * self.axis), axis=1)

    def at(self, places: Integers | slice) -> Rows:
        """Return the rows at these places."""
        return Rows(*(column[places] for column in self.columns()))

    def keys(self) -> Integers:
        """Return a number for each row that changes where one chord must not go on."""
        changed = np.zeros(len(self.block), np.bool_)
        for column in (self.block, self.tool, self.rapid, self.turns):
            changed[1:] |= column[1:] != column[:-1]
        changed[2:] |= self.tool[1:-1] != self.tool[:-2]  # where another tool is first is the end of a chord
        return np.cumsum(changed)


def joined(pieces: list[Rows]) -> Rows:
    """Return pieces of a record as one."""
    whole, flags = np.zeros(0, np.int64), np.zeros(0, np.bool_)
    empty = Rows(np.zeros(0), np.zeros((0, 3)), whole, whole, flags, np.zeros(0))
    columns: Any = zip(*(each.columns() for each in [empty, *pieces]), strict=True)
    return Rows(*(np.concatenate(column) for column in columns))
