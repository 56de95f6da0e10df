"""Tables of zero shifts and tool compensations as ASCII files in the control's root (Manual 003, 4.3 and 4.4).

A line says what the table is, MM or INCH and maybe STRICT; a table of shifts then has a line AXES, a rotary axis as
`B:ROTARY`, and a line for each G function; one of tools a line with group, length H and radius D for each group.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from pathlib import Path

from polycnc.controllers.bosch.files import Directory
from polycnc.controllers.bosch.system import Column, ShiftTable, ToolTable
from polycnc.nc.cpl import Fault

_SHIFTS = "ZERO SHIFT TABLE"
_TOOLS = "TOOL COMPENSATION TABLE"
_ROTARY = ":ROTARY"
_GROUPS = (*range(54, 60), *range(154, 160), *range(254, 260))
_END = "\x03\n"
_LENGTH, _RADIUS = 1, 2


class TableFiles:
    """Read and write tables in a root; what a file holds is what a program gets, whoever wrote it."""

    def __init__(self, directory: Directory) -> None:
        self._directory = directory

    def read(self, name: str) -> ShiftTable | None:
        """Return a table of zero shifts, None if there is no such file.

        Raises:
            Fault: The file is none.
        """
        lines = self._lines(name, _SHIFTS)
        if lines is None:
            return None
        inch, strict = _head(lines[0])
        names = lines[1].split()[1:] if len(lines) > 1 and lines[1].startswith("AXES ") else []
        columns = [Column(each.removesuffix(_ROTARY), each.endswith(_ROTARY)) for each in names]
        for number, words in _numbers(name, lines, 2, len(columns) + 1):
            code = int(number[1:]) if number[:1] == "G" and number[1:].isdigit() else 0
            if code not in _GROUPS:
                raise _broken(name, number)
            for column, value in zip(columns, words, strict=True):
                column.shifts[code] = value
        return ShiftTable(columns, inch, strict)

    def write(self, name: str, table: ShiftTable) -> None:
        """Write a table of zero shifts.

        Raises:
            Fault: It cannot be written; what the file held is as it was.
        """
        axes = " ".join(each.name + (_ROTARY if each.rotary else "") for each in table.columns)
        rows = [
            f"G{code} " + " ".join(repr(column.shifts.get(code, 0.0)) for column in table.columns)
            for code in _GROUPS
        ]
        strict = " STRICT" if table.strict else ""
        self._write(name, [f"{_SHIFTS} {_unit(table.inch)}{strict}", f"AXES {axes}", *rows])

    def read_tools(self, name: str) -> ToolTable | None:
        """Return a table of tool compensations, None if there is no such file.

        Raises:
            Fault: The file is none.
        """
        lines = self._lines(name, _TOOLS)
        if lines is None:
            return None
        table = ToolTable(_head(lines[0])[0])
        for number, (length, radius) in _numbers(name, lines, 1, 3):
            if not number.isdigit():
                raise _broken(name, number)
            table.values[int(number), _LENGTH] = length
            table.values[int(number), _RADIUS] = radius
        return table

    def write_tools(self, name: str, table: ToolTable) -> None:
        """Write a table of tool compensations.

        Raises:
            Fault: It cannot be written; what the file held is as it was.
        """
        groups = sorted({group for group, _ in table.values})
        rows = [
            f"{group} {table.values.get((group, _LENGTH), 0.0)!r} {table.values.get((group, _RADIUS), 0.0)!r}"
            for group in groups
        ]
        self._write(name, [f"{_TOOLS} {_unit(table.inch)}", *rows])

    def _lines(self, name: str, head: str) -> list[str] | None:
        text = self._directory.text(name)
        if text is None:
            return None
        lines = text.splitlines()
        if not lines or not lines[0].startswith(head):
            raise _broken(name, lines[0] if lines else "nothing")
        return lines

    def _write(self, name: str, lines: Sequence[str]) -> None:
        self.write_lines(self._directory, name, lines)

    @staticmethod
    def write_lines(directory: Directory, name: str, lines: Sequence[str]) -> None:
        """Write a file anew, as the control ends its files.

        Raises:
            Fault: It cannot be written; what the file held is as it was.
        """
        path = directory.path(name)
        new = path.with_name(f".{path.name}.new")
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            new.write_bytes(("\n".join(lines) + "\n" + _END).encode("latin-1", "replace"))
            os.replace(new, path)
        except OSError as error:
            Path(new).unlink(missing_ok=True)
            raise Fault("FILE CANNOT BE WRITTEN", error.strerror or str(error)) from None


def _head(line: str) -> tuple[bool, bool]:
    words = line.split()
    return "INCH" in words, "STRICT" in words


def _unit(inch: bool) -> str:
    return "INCH" if inch else "MM"


def _numbers(name: str, lines: list[str], first: int, count: int) -> Iterator[tuple[str, list[float]]]:
    for line in lines[first:]:
        words = line.split()
        if not words:
            continue
        try:
            values = [float(each) for each in words[1:]]
        except ValueError:
            raise _broken(name, line) from None
        if len(words) != count or any(each - each for each in values):
            raise _broken(name, line)
        yield words[0], values


def _broken(name: str, line: str) -> Fault:
    return Fault("inconsistent data", f"the table {name} is damaged: '{line[:40]}'")
