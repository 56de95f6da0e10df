"""Tools and work offsets that can change while a program runs: the machine file's, overlaid by what was set since.

Both are mappings with the shape of the machine file's tables, so whoever prepares blocks reads them in its place.
`revision` grows with every change: who prepared with an older one knows it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, fields, replace
from types import MappingProxyType
from typing import Any

from polycnc.cnc._refusal import ControlError, Refusal
from polycnc.errors import shown
from polycnc.machine import MachineConfig, Store
from polycnc.units import is_finite, is_number

_TOOLS = "cnc.tools"
_OFFSETS = "cnc.offsets"
_REMOVED = {"removed": True}
MOST_TOOLS = 99_999_999
_TIPS = 9
_RENAMED = {"orientation": "tip"}  # fields as stores of earlier versions call them
_OFFSET_NAME = re.compile(r"[A-Z][A-Z0-9]{0,7}(\.[A-Z0-9]{1,8})?")


@dataclass(frozen=True, slots=True)
class Tool:
    """One tool: geometry and wear, which add up; of a turning tool offsets too, and where its tip lies (0 to 9)."""

    length_mm: float = 0.0
    radius_mm: float = 0.0
    wear_length_mm: float = 0.0
    wear_radius_mm: float = 0.0
    description: str = ""
    tip: int = 0
    x_mm: float = 0.0
    z_mm: float = 0.0
    wear_x_mm: float = 0.0
    wear_z_mm: float = 0.0
    y_mm: float = 0.0


_FIELDS = tuple(field.name for field in fields(Tool))
_NUMBERS = tuple(name for name in _FIELDS if name.endswith("_mm"))


class ToolTable(Mapping[int, Tool]):
    """The tools by number, durable with every change."""

    def __init__(self, store: Store, config: MachineConfig) -> None:
        self._area = store.area(_TOOLS, dict)
        self.revision = 0
        self._tools = {
            number: Tool(**{name: getattr(tool, name) for name in _FIELDS})
            for number, tool in config.tools.items()
        }
        for number, row in self._area.load().items():
            if row == _REMOVED:
                self._tools.pop(int(number), None)
            else:
                self._tools[int(number)] = Tool(**{_RENAMED.get(name, name): row[name] for name in row})

    def __getitem__(self, number: int) -> Tool:
        """Return a tool; KeyError if there is none."""
        return self._tools[number]

    def __iter__(self) -> Iterator[int]:
        return iter(sorted(self._tools))

    def __len__(self) -> int:
        return len(self._tools)

    def set(self, number: int, **changes: float | str) -> Tool:
        """Change fields of a tool, which is made if it is not there; return it as it is now.

        Raises:
            ControlError: A field that a tool does not have, a number or value out of range; nothing has changed.
        """
        if not 1 <= number <= MOST_TOOLS:
            raise ControlError(
                Refusal.DATA, f"{number} is not a tool number", hint=f"Give 1 to {MOST_TOOLS}."
            )
        for name, value in changes.items():
            if name not in _FIELDS:
                raise ControlError(
                    Refusal.DATA, f"a tool has no '{name}'", hint=f"It has {', '.join(_FIELDS)}."
                )
            _check_field(name, value)
        values: dict[str, Any] = {
            name: float(value) if name in _NUMBERS else value for name, value in changes.items()
        }
        tool = replace(self._tools.get(number, Tool()), **values)
        self._area[number] = asdict(tool)
        self._tools[number] = tool
        self.revision += 1
        return tool

    def remove(self, number: int) -> None:
        """Take a tool out of the table, one of the machine file as well.

        Raises:
            ControlError: There is no such tool.
        """
        if number not in self._tools:
            raise ControlError(
                Refusal.NOT_FOUND, f"there is no tool {number}", hint="See the tools in the table."
            )
        self._area[number] = _REMOVED
        del self._tools[number]
        self.revision += 1


class OffsetTable(Mapping[str, Mapping[str, float]]):
    """The work offsets by name (G54, G54.P3, ...), each with its axes in mm or degree; durable with every change."""

    def __init__(self, store: Store, config: MachineConfig) -> None:
        self._area = store.area(_OFFSETS, dict)
        self._axes = config.axis_names
        self.revision = 0
        self.by_name = {name: dict(values) for name, values in config.offsets.items()}
        """The offsets as they are held, to be read; `set` changes them."""
        for name, row in self._area.load().items():
            self.by_name[str(name)] = {axis: value for axis, value in row.items() if axis in self._axes}

    def __getitem__(self, name: str) -> Mapping[str, float]:
        """Return the offset per axis, axes without one left out; KeyError if there is none."""
        return MappingProxyType(self.by_name[name])

    def __iter__(self) -> Iterator[str]:
        return iter(sorted(self.by_name))

    def __len__(self) -> int:
        return len(self.by_name)

    def set(self, name: str, values: Mapping[str, float], *, add: bool = False) -> None:
        """Set, or with `add` shift, an offset of some axes (mm or degree); the other axes stay.

        Raises:
            ControlError: A name that cannot be one, an axis that is not there, a value that is not finite; nothing
                has changed.
        """
        if not _OFFSET_NAME.fullmatch(name):
            raise ControlError(
                Refusal.DATA, f"'{name}' cannot name a work offset", hint="Write it like G54 or G54.P3."
            )
        row = dict(self.by_name.get(name, {}))
        for axis, value in values.items():
            if axis not in self._axes:
                raise ControlError(
                    Refusal.DATA, f"there is no axis '{axis}'", hint=f"The axes are {', '.join(self._axes)}."
                )
            _check_number(f"{name} {axis}", value)
            total = (row.get(axis, 0.0) if add else 0.0) + value
            if not is_finite(total):
                raise ControlError(
                    Refusal.DATA,
                    f"{name} {axis} cannot be {total}",
                    hint="Give a finite value in mm or degree.",
                )
            row[axis] = float(total)
        self._area[name] = row
        self.by_name[name] = row
        self.revision += 1


def _check_number(name: str, value: object) -> float:
    """Return a value that is a finite number; refuse another."""
    if not is_number(value):
        raise ControlError(Refusal.DATA, f"{name} cannot be {shown(value)}", hint="Give a finite number.")
    return value


def _check_field(name: str, value: object) -> None:
    """Refuse a value that a field of a tool cannot have."""
    if name == "description":
        if not isinstance(value, str):
            raise ControlError(Refusal.DATA, f"a description is text, not {shown(value)}", hint="Give text.")
        return
    number = _check_number(name, value)
    if name == "radius_mm" and number < 0.0:
        raise ControlError(
            Refusal.DATA, f"the radius {number:g} mm is negative", hint="Give a radius from 0 mm."
        )
    if name == "tip" and not (isinstance(value, int) and 0 <= value <= _TIPS):
        raise ControlError(Refusal.DATA, f"{value} is no place of a tool's tip", hint="Give 0 to 9.")
