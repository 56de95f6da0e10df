"""Tools and work offsets as a program sees them: those of the machine, overlaid by what the program has set (G10).

Where the machine's tables can be set themselves (those of a control), what a program sets goes there.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from polycnc.machine import MachineConfig, ToolConfig

COMMON_OFFSET = "EXT"
"""The work offset that counts with every other one."""
ADDITIONAL_OFFSETS = 300
"""How many additional work offsets (G54.1 P) there are."""


def additional_offset(number: int) -> str:
    """Return the name of an additional work offset (G54.1 P)."""
    return f"G54.P{number}"


class ProgramTables:
    """Hold what has been set of tools and work offsets (mm, degree); `revision` grows with every change."""

    def __init__(self, machine: MachineConfig) -> None:
        self._machine = machine
        self._tools: dict[int, ToolConfig] = {}
        self._offsets: dict[str, tuple[float, ...]] = {}
        self._changes = 0

    @property
    def revision(self) -> int:
        """How often the tables of work offsets have been changed."""
        return self._changes + int(getattr(self._machine.offsets, "revision", 0))

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

    def work_offset(self, name: str) -> tuple[float, ...]:
        """Return a work offset of every axis; zeros if there is none of this name."""
        found = self._offsets.get(name)
        return self._machine.work_offset(name) if found is None else found

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
            self._changes += 1
