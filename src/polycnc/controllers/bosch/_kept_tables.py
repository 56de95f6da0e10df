"""Tables of a control on disk, beside its permanent variables: zero shifts, tool compensations, tool data."""

from __future__ import annotations

from typing import Any

from polycnc.controllers.bosch.system import (
    Column,
    ShiftTable,
    ToolCompensations,
    ToolDatabase,
    ToolTable,
    ZeroShifts,
)
from polycnc.machine import Store

_AREA = "cpl.tables"
Plain = dict[str, Any]


class KeptTables:
    """Put what was kept into tables, and keep what is other than at the beginning.

    `shifts`, `tools` and `data` hold what they have without it, from the machine file or nothing.
    """

    def __init__(self, shifts: ZeroShifts, tools: ToolCompensations, data: ToolDatabase) -> None:
        self._shifts = shifts
        self._tools = tools
        self._data = data
        self._before = self._plain()

    def take(self, store: Store) -> None:
        """Take over what a store holds."""
        for name, row in store.area(_AREA, dict).items():
            kind, _, table = str(name).partition(":")
            self._put(kind, table, row["value"])
        self._shifts.revision += 1
        self._tools.revision += 1
        self._before = self._plain()

    def changed(self) -> Plain:
        """Return what has changed since, by name."""
        return {name: value for name, value in self._plain().items() if self._before.get(name) != value}

    def keep(self, store: Store, changed: Plain) -> None:
        """Write what has changed; the caller has a transaction."""
        area = store.area(_AREA, dict)
        for name, value in changed.items():
            area[name] = {"value": value}

    def kept(self) -> None:
        """Take note that everything was written."""
        self._before = self._plain()

    def _plain(self) -> Plain:
        found: Plain = {}
        for name in ("V1", "V2", "V3"):
            table = self._shifts.tables[name]
            columns = [
                [each.name, each.rotary, {str(code): value for code, value in each.shifts.items()}]
                for each in table.columns
            ]
            found[f"shifts:{name}"] = {"inch": table.inch, "columns": columns}
        found["external:"] = [[code, axis, value] for (code, axis), value in self._shifts.external.items()]
        for name in ("K4", "K5"):
            tools = self._tools.tables[name]
            rows = [[*place, value] for place, value in tools.values.items()]
            found[f"tools:{name}"] = {"inch": tools.inch, "rows": rows}
        found["compensations:"] = [[*place, value] for place, value in self._tools.values.items()]
        found["data:"] = [
            [*place, field, value]
            for place, fields in self._data.data.items()
            for field, value in fields.items()
        ]
        return found

    def _put(self, kind: str, name: str, value: Any) -> None:
        match kind:
            case "shifts":
                columns = [
                    Column(each, rotary, {int(code): number for code, number in shifts.items()})
                    for each, rotary, shifts in value["columns"]
                ]
                self._shifts.tables[name] = ShiftTable(columns, value["inch"])
            case "external":
                self._shifts.external.update({(code, axis): number for code, axis, number in value})
            case "tools":
                rows = {(group, place): number for group, place, number in value["rows"]}
                self._tools.tables[name] = ToolTable(value["inch"], rows)
            case "compensations":
                self._tools.values.update({(group, place): number for group, place, number in value})
            case "data":
                for sector, place, field, content in value:
                    self._data.data.setdefault((sector, place), {})[field] = content
