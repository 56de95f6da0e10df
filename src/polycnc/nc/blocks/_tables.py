"""Tools and work offsets as a program sees them: those of the machine, overlaid by what the program has set (G10).

Where the machine's tables can be set themselves (those of a control), what a program sets goes there.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any, NamedTuple

from polycnc.machine import MachineConfig, ToolConfig
from polycnc.nc.modal._modal import AXIS_P, AXIS_Q, AXIS_R, NO_AXIS, Modal

COMMON_OFFSET = "EXT"
"""The work offset that counts with every other one."""
WORK_SYSTEMS = (*(f"G{number}" for number in range(54, 60)), "G59.1", "G59.2", "G59.3")
"""The work offsets that a number from 1 means."""
ADDITIONAL_OFFSETS = 300
"""How many additional work offsets (G54.1 P) there are."""


def additional_offset(number: int) -> str:
    """Return the name of an additional work offset (G54.1 P)."""
    return f"G54.P{number}"


class SavedTables(NamedTuple):
    """Hold what a program has set, to go back to: fields of tools, and work offsets."""

    tools: dict[int, dict[str, float]]
    offsets: dict[str, tuple[float, ...]]
    changes: int
    turns: dict[str, float]


class ProgramTables:
    """Hold what has been set of tools and work offsets (mm, degree); `changes` counts the work offsets set."""

    def __init__(self, machine: MachineConfig) -> None:
        self._machine = machine
        self._tools: dict[int, ToolConfig] = {}
        self._offsets: dict[str, tuple[float, ...]] = {}
        self._turns: dict[str, float] = {}
        self.changes = 0

    def save(self) -> SavedTables:
        """Return what the program has set; what it has set in the machine's tables is there."""
        tools = {number: dict(tool.__dict__) for number, tool in self._tools.items()}
        return SavedTables(tools, dict(self._offsets), self.changes, dict(self._turns))

    def restore(self, saved: SavedTables) -> None:
        """Go back to what the program had set."""
        self._tools = {
            number: ToolConfig.model_construct(**dict[str, Any](each)) for number, each in saved.tools.items()
        }
        self._offsets = dict(saved.offsets)
        self._turns = dict(saved.turns)
        self.changes = saved.changes

    def has_tool(self, number: int) -> bool:
        """Tell whether there is a tool."""
        return number in self._tools or number in self._machine.tools

    def tool(self, number: int) -> ToolConfig:
        """Return a tool, one of zeros if there is none."""
        found = self._tools.get(number)
        return found or self._machine.tools.get(number) or ToolConfig()

    def set_tool(self, number: int, **changes: float) -> None:
        """Change fields of a tool (mm), which is made if it is not there."""
        setter: Any = getattr(self._machine.tools, "set", None)
        if setter is not None:
            setter(number, **changes)
            return
        old = self.tool(number)
        values = {each: getattr(old, each) for each in ToolConfig.model_fields}
        self._tools[number] = ToolConfig.model_construct(**{**values, **changes})

    def select(self, letter: str, number: int) -> bool:
        """Select a table of tools (K) or work offsets (V); tell whether there is one of this number."""
        tables = self._machine.tools if letter == "K" else self._machine.offsets
        chosen: Any = getattr(tables, "select", None)
        return chosen is not None and bool(chosen(number))

    def tool_shift(self, codes: Collection[int], modal: Modal) -> list[float]:
        """Return what further tool data shift the axes by (mm)."""
        found: Any = getattr(self._machine.tools, "shift", None)
        values = [0.0] * len(modal.position)
        for column, length in zip((AXIS_R, AXIS_P, AXIS_Q), found(codes) if found else (), strict=False):
            if modal.whole[column] != NO_AXIS:
                values[modal.whole[column]] += length
        return values

    def tool_radius(self, codes: Collection[int]) -> float:
        """Return what further tool data add to the radius (mm)."""
        found: Any = getattr(self._machine.tools, "radius", None)
        return float(found(codes)) if found else 0.0

    def work_offset(self, name: str) -> tuple[float, ...]:
        """Return a work offset of every axis; zeros if there is none of this name."""
        found = self._offsets.get(name)
        return self._machine.work_offset(name) if found is None else found

    def turn_of(self, name: str) -> float:
        """Return by what a work offset turns the plane of X and Y (degrees)."""
        return self._turns.get(name, 0.0)

    def set_turn(self, name: str, angle_deg: float) -> None:
        """Let a work offset turn the plane of X and Y."""
        self._turns[name] = angle_deg

    def has_offset(self, name: str) -> bool:
        """Tell whether a work offset has been given by the machine or the program."""
        return name in self._offsets or name in self._machine.offsets

    def set_offset(self, name: str, values: Mapping[int, float]) -> None:
        """Set a work offset of some axes, by their index (mm or degree)."""
        setter: Any = getattr(self._machine.offsets, "set", None)
        names = self._machine.axis_names
        if setter is not None:
            setter(name, {names[axis]: value for axis, value in values.items()})
        else:
            row = list(self.work_offset(name))
            for axis, value in values.items():
                row[axis] = value
            self._offsets[name] = tuple(row)
            self.changes += 1
