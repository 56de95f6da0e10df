"""TC: tables of tool compensations, external and general compensations (Manual 003, 4.4)."""

from __future__ import annotations

from collections.abc import Callable, Container
from dataclasses import dataclass, field

from polycnc.controllers.bosch.system._arguments import INVALID_PARAMETER, whole
from polycnc.nc.cpl import OMITTED, Fault, text_of

MM_PER_INCH = 25.4
DATABASE = {4: "K4", 5: "K5"}
STANDARD = range(1, 49)
EXTERNAL = range(145, 846, 100)
GENERAL = range(147, 848, 100)
LENGTH, RADIUS, KIND = 1, 2, 6
_LENGTHS = range(1, 5)
_SELECTIONS = {"standard": range(1, 3), "external": range(1, 3), "general": range(1, 9)}


@dataclass(slots=True)
class ToolTable:
    """A table: H (1) and D (2) by group, in mm or inch (MACODA 9020 00010)."""

    inch: bool = False
    values: dict[tuple[int, int], float] = field(default_factory=dict)


@dataclass(slots=True)
class ToolCompensations:
    """Tool tables by name, K4 and K5 among them, and the external and general values of a channel in mm and deg.

    `selected` is the table that the part program selected last; `groups` are those in force: of lengths and radii
    in this table, and external and general ones (0: none); `inch` tells whether G70 is active.
    """

    tables: dict[str, ToolTable] = field(
        default_factory=lambda: {name: ToolTable() for name in DATABASE.values()}
    )
    selected: str = "K4"
    groups: dict[str, int] = field(default_factory=dict)
    values: dict[tuple[int, int], float] = field(default_factory=dict)
    inch: bool = False
    read_file: Callable[[str], ToolTable | None] | None = None
    write_file: Callable[[str, ToolTable], None] | None = None
    revision: int = 0

    def select(self, name: str) -> None:
        """Let a table be in force."""
        self._table(name)
        self.selected = name
        self.revision += 1

    def group_mm(self, group: int) -> tuple[float, float]:
        """Return length and radius of a group of the selected table (mm); KeyError if nothing is in it."""
        table = self.tables[self.selected]
        if (group, LENGTH) not in table.values and (group, RADIUS) not in table.values:
            raise KeyError(group)
        return (
            table.values.get((group, LENGTH), 0.0) * _factor(table.inch),
            table.values.get((group, RADIUS), 0.0) * _factor(table.inch),
        )

    def filled_groups(self) -> list[int]:
        """Return the groups of the selected table that hold something."""
        return sorted({group for group, _ in self.tables[self.selected].values})

    def read(
        self, selection: object, group: object = OMITTED, table: object = OMITTED, unit: object = OMITTED
    ) -> float:
        """Return a value, or with the selection alone what is in force, in the active system's unit.

        Raises:
            Fault: There is none.
        """
        if group is OMITTED and table is OMITTED and unit is OMITTED:
            return self._sum(abs(whole(selection, "selection", _both(range(1, 9)))))
        which, number = self._group(group)
        chosen = abs(whole(selection, "selection", _both(_SELECTIONS[which])))
        if which != "standard":
            return self.values.get((number, chosen), 0.0) / self._mm(chosen, table, unit)
        found = self._table(table)
        return found.values.get((number, chosen), 0.0) / _scale(found, unit)

    def write(
        self, value: object, selection: object, group: object = OMITTED, table: object = OMITTED,
        unit: object = OMITTED,
    ) -> None:  # fmt: skip
        """Set a value; a negative selection adds to it.

        Raises:
            Fault: There is none, it can only be read, or the value is no number.
        """
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise Fault("INVALID ASSIGNMENT", "a compensation is a number")
        which, number = self._group(group)
        chosen = whole(selection, "selection", _both(_SELECTIONS[which]))
        place = number, abs(chosen)
        if place[1] == KIND:
            raise Fault(INVALID_PARAMETER, "the type of compensation can only be read")
        if which == "standard":
            found = self._table(table)
            kept, new = found.values, value * _scale(found, unit)
        else:
            kept, new = self.values, value * self._mm(place[1], table, unit)
        kept[place] = (kept.get(place, 0.0) if chosen < 0 else 0.0) + new
        self.revision += 1
        if which == "standard" and self.write_file is not None:
            name = (
                self.selected
                if table is OMITTED
                else text_of(table)
                if not isinstance(table, int | float)
                else ""
            )
            if name and name not in DATABASE.values():
                self.write_file(name, found)

    def _group(self, group: object) -> tuple[str, int]:
        number = whole(group, "group", {*STANDARD, *EXTERNAL, *GENERAL})
        return "standard" if number in STANDARD else "external" if number in EXTERNAL else "general", number

    def _table(self, table: object) -> ToolTable:
        if table is OMITTED:
            name: str | None = self.selected
        elif isinstance(table, int | float):
            name = DATABASE[whole(table, "table", DATABASE.keys())]
        else:
            name = text_of(table)
        if self.read_file is not None and name and name not in DATABASE.values():
            read = self.read_file(name)
            if read is not None:
                self.tables[name] = read
        if name is None or name not in self.tables:
            raise Fault(INVALID_PARAMETER, f"there is no table {name}")
        return self.tables[name]

    def _mm(self, chosen: int, table: object, unit: object) -> float:
        whole(table, "table of external and general compensations", range(1), 0)
        if unit is not OMITTED:
            raise Fault(INVALID_PARAMETER, "external and general compensations have the unit of G70 or G71")
        return _factor(self.inch and chosen in _LENGTHS)

    def _sum(self, chosen: int) -> float:
        table = self.tables[self.selected]
        place = {LENGTH: "length", RADIUS: "radius"}.get(chosen, "")
        total = table.values.get((self.groups.get(place, 0), chosen), 0.0) * _factor(table.inch)
        total += sum(
            self.values.get((self.groups.get(which, 0), chosen), 0.0) for which in ("external", "general")
        )
        return total / _factor(self.inch and chosen in _LENGTHS)


def _both(selections: range) -> Container[int]:
    return {*selections, *(-each for each in selections)}


def _factor(inch: bool) -> float:
    return MM_PER_INCH if inch else 1.0


def _scale(table: ToolTable, unit: object) -> float:
    """Return what a value in the given unit is multiplied with for the table; exactly 1 without a conversion."""
    inch = table.inch if unit is OMITTED else whole(unit, "unit", (0, 2)) == 2
    if inch == table.inch:
        return 1.0
    return MM_PER_INCH if inch else 1 / MM_PER_INCH
