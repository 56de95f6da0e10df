"""Permanent variables: @1 to @100, @_R, and those that wmhperm.dat and anwperm.dat declare (Manual 003, 2.4.3)."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any, NamedTuple

from polycnc.errors import ProgramError
from polycnc.language import Flaw, Source
from polycnc.nc.cpl._faults import INVALID_FIELD_LIMIT
from polycnc.nc.cpl._fields import Field
from polycnc.nc.cpl._strings import LONGEST, CharacterField
from polycnc.nc.cpl._variables import (
    MARKS,
    PERMANENT_FIELD,
    PERMANENT_NUMBERS,
    SIGNIFICANT_PERMANENT,
    Kind,
    variable_at,
)

MEMORY = 102_400
"""Bytes of memory for permanent variables."""
FREE = MEMORY - 800 - 24 - 823 - 40 - 35
"""What of it is left for variables that are declared."""
_ADMINISTRATION = 20
_SIZES: dict[Kind, int] = {"I": 4, "R": 4, "D": 8, "B": 1, "S": 1}
_TYPES: dict[str, Kind] = {"INT": "I", "REAL": "R", "DOUBLE": "D", "BOOL": "B", "CHAR": "S"}
_HIGHEST_INDEX = 65_535
_DECLARATION = re.compile(
    r"[ \t]*DEF[ \t]+(?P<type>[A-Z]+)[ \t]+(?P<name>@[A-Z][A-Z0-9_]*)[ \t]*"
    r"(?:\([ \t]*(?P<first>[0-9]+)[ \t]*(?:,[ \t]*(?P<second>[0-9]+)[ \t]*)?\))?[ \t]*;.*"
)


class Declaration(NamedTuple):
    """A declared variable: name with the mark of its type, type, sizes (none for a simple one), bytes that it costs."""

    name: str
    kind: Kind
    sizes: tuple[int, ...]
    cost: int


class PermanentMemory(dict[str, Any]):
    """The permanent variables of a control by name; what is declared anew keeps its value if its type stays."""

    def __init__(self) -> None:
        super().__init__(dict.fromkeys(f"@{number}" for number in range(1, PERMANENT_NUMBERS + 1)))
        self[PERMANENT_FIELD] = Field("D", (100,))
        self._declared: dict[str, Declaration] = {}

    @property
    def free(self) -> int:
        """Bytes that are left for declared variables."""
        return FREE - sum(each.cost for each in self._declared.values())

    def declare(self, files: Iterable[tuple[str, str]]) -> list[ProgramError]:
        """Read the declarations of files (name, text): make what is new, delete what is declared no more.

        Returns what is wrong with them: a line that declares nothing, a size, a name declared twice, no memory left.
        """
        errors: list[ProgramError] = []
        old, self._declared = self._declared, {}
        for file, text in files:
            source = Source(text, file)
            for line in range(1, source.line_count + 1):
                try:
                    self._declare(source.line(line), source.begin(line), old)
                except Flaw as flaw:
                    errors.append(source.error(flaw))
        for name in old:
            if name not in self._declared:
                del self[name]
        return errors

    def _declare(self, line: str, begin: int, old: dict[str, Declaration]) -> None:
        if not line.strip(" \t"):
            return
        found = _DECLARATION.fullmatch(line)
        if found is None or found["type"] not in _TYPES:
            hint = "DEF, one of INT REAL DOUBLE BOOL CHAR, @NAME, sizes in parentheses, and a semicolon"
            raise Flaw(begin, "the line declares no permanent variable", hint)
        declared = _declaration(found, begin)
        if declared.name in self._declared:
            raise Flaw(
                begin + found.start("name"),
                f"{declared.name} is declared twice",
                "16 characters of a name count",
            )
        if declared.cost > self.free:
            what = f"{declared.name} not installed. Memory full"
            raise Flaw(
                begin + found.start("name"),
                what,
                f"{self.free} bytes are free, {declared.cost} needed",
                code="1869",
            )
        self._declared[declared.name] = declared
        if old.get(declared.name) != declared:
            self[declared.name] = _initial(declared)


def _declaration(found: re.Match[str], begin: int) -> Declaration:
    kind = _TYPES[found["type"]]
    longest = LONGEST if kind == "S" else _HIGHEST_INDEX
    sizes: list[int] = []
    for group in ("first", "second"):
        if digits := found[group]:
            if len(digits.lstrip("0")) > 5 or not 1 <= int(digits) <= longest:
                raise Flaw(
                    begin + found.start(group), INVALID_FIELD_LIMIT.what, f"an index is at most {longest}"
                )
            sizes.append(int(digits))
    name = variable_at(begin + found.start("name"), found["name"] + MARKS.get(kind, "")).name
    elements = sizes[0] * (sizes[1] if len(sizes) == 2 else 1) if sizes else 1
    length = min(len(found["name"]), SIGNIFICANT_PERMANENT)
    return Declaration(name, kind, tuple(sizes), length + _ADMINISTRATION + elements * _SIZES[kind])


def _initial(declared: Declaration) -> object:
    kind, sizes = declared.kind, declared.sizes
    if kind == "S" and len(sizes) < 2:
        return CharacterField(sizes[0] if sizes else 1)
    return Field(kind, sizes) if sizes else None
