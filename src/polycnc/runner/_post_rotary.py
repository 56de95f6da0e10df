"""Where the tool is on the part of a five-axis machine: from the positions of all its axes, many at a time.

The way round is that of a machine, from its axes to the part; nothing of it comes from how the post-processor went
from the part to the axes.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
import numpy.typing as npt

from polycnc.machine import MachineConfig
from polycnc.machine import RotaryAxis as MachineRotary
from polycnc.post import Parameters, RotaryAxis
from polycnc.runner._post_geometry import Floats, Indices, to_segments
from polycnc.runner._rotation import turned

_Z = (0.0, 0.0, 1.0)
_TURNS = RotaryAxis(letter="C", on="table", direction=_Z)
_LETTERS: tuple[Literal["A"], Literal["B"], Literal["C"]] = ("A", "B", "C")
_TABLES = {
    "ac_table": (_TURNS, RotaryAxis(letter="A", on="table", direction=(1.0, 0.0, 0.0))),
    "bc_table": (_TURNS, RotaryAxis(letter="B", on="table", direction=(0.0, 1.0, 0.0))),
}


class PartFrame:
    """The rotary axes that a control file names, from the part to the tool; there may be none.

    A head that the machine knows by itself (`carries = "tool"`) is that of the machine.
    """

    def __init__(self, parameters: Parameters, machine: MachineConfig | None = None) -> None:
        five_axis = parameters.five_axis
        self.axes: tuple[RotaryAxis, ...] = () if five_axis is None else five_axis.axis
        self.on_machine = five_axis is not None and five_axis.output == "machine"
        self.axes = _TABLES.get(parameters.rotary, self.axes)
        heads = _heads_of(machine) if machine is not None and self.on_machine else ()
        if heads and {axis.letter for axis in heads} <= {axis.letter for axis in self.axes}:
            known = {axis.letter for axis in heads}
            self.axes = (*(axis for axis in self.axes if axis.letter not in known), *heads)
        else:
            heads = ()
        self.letters = tuple(axis.letter for axis in self.axes)
        self.has_head = self.on_machine and any(axis.on == "head" for axis in self.axes)
        self.compared = "X Y Z"
        if self.axes:
            self.compared += f", tool axis by {' and '.join(self.letters)}"
        if self.on_machine:
            whose = "the control file"
            if heads:
                whose = "the machine" if len(heads) == len(self.axes) else f"the machine's head and {whose}"
            self.compared += f", tip by the geometry of {whose}"
        elif parameters.rotary == "vector":
            self.compared += "; not the tool axis"

    def tips(self, points: Floats, angles: Floats, lengths: Floats) -> Floats:
        """Return where the tip is on the part: from positions in mm, angles in degree, lengths of the tools in mm."""
        if not self.on_machine:
            return points
        found = points
        if self.has_head:
            nose = np.zeros_like(points)
            nose[:, 2] = -lengths
            hangs = nose
            for axis, angle in reversed(self._with_angles(angles)):
                if axis.on == "head":
                    hangs = turned(hangs, axis.direction, angle, axis.point_mm)
            found = found + hangs - nose
        for axis, angle in reversed(self._with_angles(angles)):
            if axis.on == "table":
                found = turned(found, axis.direction, angle, axis.point_mm)
        return found

    def tool_axes(self, angles: Floats) -> Floats:
        """Return the tool axes on the part."""
        found = np.tile(_Z, (len(angles), 1))
        for axis, angle in reversed(self._with_angles(angles)):
            found = turned(found, axis.direction, angle)
        return found

    def _with_angles(self, angles: Floats) -> list[tuple[RotaryAxis, Floats]]:
        return [(axis, angles[:, place]) for place, axis in enumerate(self.axes)]


def _heads_of(machine: MachineConfig) -> tuple[RotaryAxis, ...]:
    """Return the axes that swivel the tool of a machine, from the machine to the tool."""
    return tuple(
        RotaryAxis(letter=letter, on="head", direction=axis.about, point_mm=axis.center_mm)
        for axis in machine.axes
        for letter in _LETTERS
        if isinstance(axis, MachineRotary) and axis.carries == "tool" and axis.name.startswith(letter)
    )


class ToolAxisCheck:
    """How far the tool axis is off where each record of the tool path ends."""

    def __init__(self, frame: PartFrame, records: int) -> None:
        self._frame = frame
        self._best = np.full(records, np.nan)
        self._record = 0

    def add(self, begin: Floats, end: Floats, records: Indices, wanted: Floats) -> None:
        """Take rows: angles in degree before and at each row, its record, and the tool axis of each record."""
        first, axes = self._frame.tool_axes(begin), self._frame.tool_axes(end)
        before = np.concatenate(([self._record], records[:-1]))
        off = to_segments(wanted[records], first, axes)
        last = np.append(records[1:] != records[:-1], True)
        self._best[records[last]] = off[last]
        # A record ends between its last row and the first one after it.
        crossing = records != before
        behind = to_segments(wanted[before[crossing]], first[crossing], axes[crossing])
        ended = before[crossing]
        self._best[ended] = np.fmin(self._best[ended], behind)
        self._record = int(records[-1])

    def worst(self, moving: npt.NDArray[np.bool_]) -> tuple[float, int]:
        """Return the greatest angle in degree among the records that move, and its record, -1 if there is none."""
        if not self._frame.axes:
            return 0.0, -1
        off = np.where(moving & ~np.isnan(self._best), self._best, 0.0)
        place = int(np.argmax(off)) if len(off) else -1
        if place < 0 or off[place] == 0.0:
            return 0.0, -1
        return float(np.degrees(2.0 * np.arcsin(min(0.5 * off[place], 1.0)))), place


def angle_columns(frame: PartFrame, names: Sequence[str]) -> list[int]:
    """Return the column of each rotary axis among the machine's axes, -1 for one that it has not."""
    return [names.index(letter) if letter in names else -1 for letter in frame.letters]
