"""SCS and SCSL: parameters of the drives on the SERCOS ring (Manual 003, 4.8)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

from polycnc.controllers.bosch.system._arguments import INVALID_PARAMETER, whole
from polycnc.nc.cpl import OMITTED, Box, Fault, text_of

Value: TypeAlias = int | float | str
Parameter: TypeAlias = "Value | Sequence[Value]"
Ident: TypeAlias = tuple[str, int]
"""Kind and number of a parameter: ("S", 51) is S-0-0051."""

DONE, LOCKED, FILE_ERROR = 0, 1, 2
_LOCKED = "SERCOS SERVICE CHANNEL IS LOCKED"
_LARGEST = 32767


@dataclass(slots=True)
class Drives:
    """The drives of a system: `read` returns a parameter of a physical axis, None if it has none, without unit.

    `physical` finds an axis by index or name. While `locked` another application has the service channel; what is in
    `telegram`, the cyclic one, can be read nevertheless. `write` puts the elements of a list into a file.
    """

    physical: Callable[[object], int]
    read: Callable[[int, Ident], Parameter | None]
    write: Callable[[str, Sequence[str]], None]
    telegram: frozenset[Ident] = frozenset({("S", 40), ("S", 51)})
    locked: bool = False
    last: dict[tuple[int, Ident], Value] = field(default_factory=dict)

    def scs(self, axis: object, kind: object, number: object, result: object = OMITTED) -> Value | None:
        """Return a parameter, while it cannot be accessed the value that was read before.

        Raises:
            Fault: There is none, it is a list, or it cannot be accessed and there is no result variable.
        """
        physical, ident = self._ident(axis, kind, number)
        value = self._parameter(physical, ident)
        if _is_list(value):
            raise Fault(INVALID_PARAMETER, f"{_shown(ident)} is a list: read it with SCSL")
        if self.locked and ident not in self.telegram:
            if not isinstance(result, Box):
                raise Fault(_LOCKED, "another application has it; give a result variable and try again")
            result.value = LOCKED
            return self.last.get((physical, ident))
        if isinstance(result, Box):
            result.value = DONE
        assert isinstance(value, int | float | str)
        self.last[physical, ident] = value
        return value

    def scsl(self, axis: object, kind: object, number: object, name: object, result: object = OMITTED) -> int:
        """Write the elements of a list into a file, one a line; return 0, 1 while locked, 2 for a wrong file.

        Raises:
            Fault: There is no such parameter, or it cannot be accessed and there is no result variable.
        """
        physical, ident = self._ident(axis, kind, number)
        value = self._parameter(physical, ident)
        lines = [str(each) for each in (value if isinstance(value, list | tuple) else [value])]
        code, trouble = (
            DONE,
            Fault(_LOCKED, "another application has it; give a result variable and try again"),
        )
        if self.locked:
            code = LOCKED
        else:
            try:
                self.write(text_of(name) or "", lines)
            except Fault as fault:
                code, trouble = FILE_ERROR, fault
        if isinstance(result, Box):
            result.value = code
        elif code != DONE:
            raise trouble
        return code

    def _ident(self, axis: object, kind: object, number: object) -> tuple[int, Ident]:
        letter = text_of(kind) or ""
        if letter not in ("S", "P"):
            raise Fault(INVALID_PARAMETER, 'the type of a drive parameter is "S" or "P"')
        return self.physical(axis), (letter, whole(number, "number", range(_LARGEST + 1)))

    def _parameter(self, physical: int, ident: Ident) -> Parameter:
        value = self.read(physical, ident)
        if value is None:
            raise Fault(INVALID_PARAMETER, f"the drive of axis {physical} has no {_shown(ident)}")
        return value


def _is_list(value: Parameter) -> bool:
    return isinstance(value, list | tuple)


def _shown(ident: Ident) -> str:
    return f"{ident[0]}-0-{ident[1]:04}"
