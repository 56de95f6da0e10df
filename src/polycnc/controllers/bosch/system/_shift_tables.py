"""FXC, FXCR, FXDEL, FXINS: tables of axis zero shifts, and external shifts (Manual 003, 4.3)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

from polycnc.controllers.bosch.system._arguments import INVALID_PARAMETER, whole
from polycnc.nc.cpl import OMITTED, Fault, text_of

MM_PER_INCH = 25.4
EXTERNAL = (160, 260, 360)
GROUPS = tuple(range(54, 60)), tuple(range(154, 160)), tuple(range(254, 260))
DATABASE = {1: "V1", 2: "V2", 3: "V3"}
_TABLE_ADDRESSES = frozenset(code for group in GROUPS for code in group)
SHIFT_CODES = _TABLE_ADDRESSES | frozenset(EXTERNAL)
"""The G functions of axis zero shifts."""
_MOST_COLUMNS = 64


@dataclass(slots=True)
class Column:
    """A column of a table: an axis, whether it turns, and its shifts by G function in the table's unit or deg."""

    name: str
    rotary: bool = False
    shifts: dict[int, float] = field(default_factory=dict)


@dataclass(slots=True)
class ShiftTable:
    """A table: whether it was made in inch (MACODA 9020 00010), and whether it is classified strictly."""

    columns: list[Column]
    inch: bool = False
    strict: bool = False


class TableFiles(Protocol):
    """Where tables with names of their own are kept."""

    def read(self, name: str) -> ShiftTable | None:
        """Return a table, None if there is none."""

    def write(self, name: str, table: ShiftTable) -> None:
        """Keep a table."""


@dataclass(slots=True)
class ZeroShifts:
    """The zero shift tables by name, V1 to V3 among them, and the external shifts of a channel.

    `active` is the table in force, `functions` the G functions of shifts that are; `axes` are all axes of the system
    as columns, `channels` the names of their axes; `inch` tells whether G70 is active, `new_inch` the unit of new
    tables. `external` shifts are mm or deg by G function and axis.
    """

    channel: int
    axes: list[Column]
    channels: Mapping[int, tuple[str, ...]]
    tables: dict[str, ShiftTable] = field(default_factory=dict)
    active: str = "V1"
    functions: frozenset[int] = frozenset()
    external: dict[tuple[int, str], float] = field(default_factory=dict)
    inch: bool = False
    new_inch: bool = False
    files: TableFiles | None = None
    revision: int = 0

    def __post_init__(self) -> None:
        for name in DATABASE.values():
            self.tables.setdefault(name, self._new(0))

    def select(self, name: str) -> None:
        """Let a table be in force."""
        self._table(name)
        self.active = name
        self.revision += 1

    def shift_mm(self, code: int) -> dict[str, float]:
        """Return a shift of every axis as it is in force (mm, degree)."""
        if code in EXTERNAL:
            return {axis: value for (each, axis), value in self.external.items() if each == code}
        table = self.tables[self.active]
        return {
            column.name: column.shifts[code] * _factor(table, column)
            for column in table.columns
            if code in column.shifts
        }

    def fxc(
        self, axis: object, address: object = OMITTED, table: object = OMITTED, unit: object = OMITTED
    ) -> float:
        """Return a shift, or with the axis alone the sum of all that are in force, in the active system's unit.

        Raises:
            Fault: There is none.
        """
        chosen, _ = _selection(axis)
        if address is OMITTED and table is OMITTED and unit is OMITTED:
            return self._sum(chosen)
        code = whole(address, "G address", _TABLE_ADDRESSES | set(EXTERNAL))
        if code in EXTERNAL:
            column = self._own(chosen, table, unit)
            return self.external.get((code, column.name), 0.0) / self._external_mm(column)
        found = self._table(table)
        column = _column(found, chosen)
        return column.shifts.get(code, 0.0) / _scale(found, column, unit)

    def set_fxc(
        self,
        value: object,
        axis: object,
        address: object = OMITTED,
        table: object = OMITTED,
        unit: object = OMITTED,
    ) -> None:
        """Set a shift; a negative axis or "-" before its name adds to it.

        Raises:
            Fault: There is none, or the value is no number.
        """
        chosen, adds = _selection(axis)
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise Fault("INVALID ASSIGNMENT", "a shift is a number")
        code = whole(address, "G address", _TABLE_ADDRESSES | set(EXTERNAL))
        if code in EXTERNAL:
            column = self._own(chosen, table, unit)
            old = self.external.get((code, column.name), 0.0) if adds else 0.0
            self.external[code, column.name] = old + value * self._external_mm(column)
            self.revision += 1
            return
        found = self._table(table)
        column = _column(found, chosen)
        old = column.shifts.get(code, 0.0) if adds else 0.0
        column.shifts[code] = old + value * _scale(found, column, unit)
        self._changed(table)

    def fxcr(self, layout: object, name: object, classification: object = OMITTED) -> int:
        """Make a table for the axes of a channel, of the system (0), or like another table; return 0.

        Raises:
            Fault: There is no such channel or layout.
        """
        strict = bool(whole(classification, "classification", range(2), 0))
        path = _name(name)
        if isinstance(layout, int | float):
            new = self._new(whole(layout, "channel", {0, *self.channels}))
        else:
            sample = self._table(layout)
            new = ShiftTable([Column(each.name, each.rotary) for each in sample.columns], self.new_inch)
        new.strict = strict
        self.tables[path] = new
        self._changed(name)
        return 0

    def fxdel(self, name: object, axis: object) -> int:
        """Delete a column; return 0.

        Raises:
            Fault: There is none.
        """
        table = self._table(name)
        table.columns.remove(_column(table, _selection(axis, names_only=True)[0]))
        self._changed(name)
        return 0

    def fxins(self, name: object, position: object, axis: object, kind: object = OMITTED) -> int:
        """Insert a column, of a linear axis (1, default) or rotary one (0), before another; return 0.

        Raises:
            Fault: There is no such column, too many are there, or the name is there already.
        """
        table = self._table(name)
        place = table.columns.index(_column(table, _selection(position, names_only=True)[0]))
        column = Column(_name(axis), rotary=not whole(kind, "axis type", range(2), 1))
        if any(each.name == column.name for each in table.columns) or len(table.columns) >= _MOST_COLUMNS:
            raise Fault(INVALID_PARAMETER, f"the table has {column.name} already, or {_MOST_COLUMNS} columns")
        table.columns.insert(place, column)
        self._changed(name)
        return 0

    def _new(self, channel: int) -> ShiftTable:
        names = {each.name for each in self.axes} if channel == 0 else set(self.channels[channel])
        columns = [Column(each.name, each.rotary) for each in self.axes if each.name in names]
        return ShiftTable(columns, self.new_inch)

    def _table(self, name: object) -> ShiftTable:
        if name is OMITTED:
            path = self.active
        elif isinstance(name, int | float):
            path = DATABASE[whole(name, "table", DATABASE.keys())]
        else:
            path = _name(name)
        if self.files is not None and path not in DATABASE.values():
            read = self.files.read(path)
            if read is not None:
                self.tables[path] = read
            else:
                self.tables.pop(path, None)
        if path not in self.tables:
            raise Fault(INVALID_PARAMETER, f"there is no table {path}")
        return self.tables[path]

    def _changed(self, name: object) -> None:
        """Take note that a table was changed; one that is a file is written."""
        self.revision += 1
        if name is OMITTED or isinstance(name, int | float):
            path = self.active if name is OMITTED else ""
        else:
            path = _name(name)
        if self.files is not None and path and path not in DATABASE.values():
            self.files.write(path, self.tables[path])

    def _own(self, chosen: int | str, table: object, unit: object) -> Column:
        whole(table, "table of external shifts", range(1), 0)
        if unit is not OMITTED:
            raise Fault(INVALID_PARAMETER, "external shifts have the unit of G70 or G71")
        names = self.channels[self.channel]
        if isinstance(chosen, int) and 1 <= chosen <= min(8, len(names)):
            chosen = names[chosen - 1]
        if chosen not in names:
            raise Fault(INVALID_PARAMETER, f"channel {self.channel} has no axis {chosen}")
        return next(each for each in self.axes if each.name == chosen)

    def _external_mm(self, column: Column) -> float:
        return MM_PER_INCH if self.inch and not column.rotary else 1.0

    def _sum(self, chosen: int | str) -> float:
        table = self.tables[self.active]
        column = _column(table, chosen)
        total = sum(column.shifts.get(code, 0.0) for code in self.functions) * _factor(table, column)
        total += sum(self.external.get((code, column.name), 0.0) for code in self.functions)
        return total / self._external_mm(column)


def _selection(axis: object, *, names_only: bool = False) -> tuple[int | str, bool]:
    if isinstance(axis, int | float):
        number = whole(axis, "axis", range(1 if names_only else -_MOST_COLUMNS, _MOST_COLUMNS + 1))
        return abs(number), number < 0
    name = _name(axis)
    return (name[1:], True) if name.startswith("-") and not names_only else (name, False)


def _name(value: object) -> str:
    text = text_of(value)
    if not text:
        raise Fault(INVALID_PARAMETER, "a name is needed")
    return text


def _column(table: ShiftTable, chosen: int | str) -> Column:
    for place, column in enumerate(table.columns, 1):
        if chosen in (place, column.name):
            return column
    raise Fault(INVALID_PARAMETER, f"the table has no column {chosen}")


def _factor(table: ShiftTable, column: Column) -> float:
    return MM_PER_INCH if table.inch and not column.rotary else 1.0


def _scale(table: ShiftTable, column: Column, unit: object) -> float:
    """Return what a value in the given unit is multiplied with for the table; exactly 1 without a conversion."""
    inch = table.inch if unit is OMITTED else whole(unit, "unit", (0, 2)) == 2
    if column.rotary or inch == table.inch:
        return 1.0
    return MM_PER_INCH if inch else 1 / MM_PER_INCH
