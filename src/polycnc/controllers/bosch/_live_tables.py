"""The tables of zero shifts and tool compensations as the channel reads them: what a program sets there moves axes."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping

from polycnc.controllers.bosch.system import (
    DATABASE_SHIFTS,
    DATABASE_TOOLS,
    SHIFT_CODES,
    ToolCompensations,
    ZeroShifts,
)
from polycnc.machine import MachineConfig, ToolConfig

_LENGTH, _RADIUS = 1, 2
_GENERAL_LENGTHS = (1, 3, 4)  # L3, then L1 and L2: the drilling axis, then the axes of the plane


class LiveOffsets(Mapping[str, Mapping[str, float]]):
    """Zero shifts by G function: those of the table that is selected, and external ones (mm, degree)."""

    def __init__(self, shifts: ZeroShifts, at_start: bool) -> None:
        self._shifts = shifts
        self.at_start = at_start
        """Whether G54 is in force when a program begins."""

    @property
    def revision(self) -> int:
        """How often a shift has been changed."""
        return self._shifts.revision

    def select(self, number: int) -> bool:
        """Select a table of the database; tell whether there is one."""
        if number not in DATABASE_SHIFTS:
            return False
        self._shifts.select(DATABASE_SHIFTS[number])
        return True

    def __getitem__(self, name: str) -> Mapping[str, float]:
        """Return a shift of every axis; KeyError if the code is none."""
        code = int(name[1:]) if name[1:].isdigit() else 0
        if code not in SHIFT_CODES:
            raise KeyError(name)
        return self._shifts.shift_mm(code)

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and name[1:].isdigit() and int(name[1:]) in SHIFT_CODES

    def __iter__(self) -> Iterator[str]:
        return (f"G{code}" for code in sorted(SHIFT_CODES))

    def __len__(self) -> int:
        return len(SHIFT_CODES)


class LiveTools(Mapping[int, ToolConfig]):
    """Compensations by group: those of the table that is selected (mm); G145 to G847 besides."""

    def __init__(self, tools: ToolCompensations) -> None:
        self._tools = tools

    @property
    def revision(self) -> int:
        """How often a compensation has been changed."""
        return self._tools.revision

    def select(self, number: int) -> bool:
        """Select a table of the database; tell whether there is one."""
        if number not in DATABASE_TOOLS:
            return False
        self._tools.select(DATABASE_TOOLS[number])
        return True

    def shift(self, codes: Collection[int]) -> list[float]:
        """Return what external and general compensations add to the lengths: L3, L1, L2 (mm)."""
        found = [0.0, 0.0, 0.0]
        for code in codes:
            places = (_LENGTH,) if code % 100 == 45 else _GENERAL_LENGTHS
            for place, selection in enumerate(places):
                found[place] += self._tools.values.get((code, selection), 0.0)
        return found

    def radius(self, codes: Collection[int]) -> float:
        """Return what they add to the radius (mm)."""
        return sum(self._tools.values.get((code, _RADIUS), 0.0) for code in codes)

    def __getitem__(self, number: int) -> ToolConfig:
        """Return a compensation group as a tool; KeyError if nothing is in it."""
        length, radius = self._tools.group_mm(number)
        return ToolConfig(length_mm=length, radius_mm=max(radius, 0.0), wear_radius_mm=min(radius, 0.0))

    def __iter__(self) -> Iterator[int]:
        return iter(self._tools.filled_groups())

    def __len__(self) -> int:
        return len(self._tools.filled_groups())


def fill_from_machine(shifts: ZeroShifts, tools: ToolCompensations, config: MachineConfig) -> None:
    """Put work offsets and tools of the machine file into V1 and K4."""
    for column in shifts.tables["V1"].columns:
        for name, values in config.offsets.items():
            if column.name in values and name[1:].isdigit():
                column.shifts[int(name[1:])] = values[column.name]
    table = tools.tables["K4"]
    for number, tool in config.tools.items():
        table.values[number, _LENGTH] = tool.length_mm + tool.wear_length_mm
        table.values[number, _RADIUS] = tool.radius_mm + tool.wear_radius_mm
