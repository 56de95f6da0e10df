"""The parameter table: what is at an address of the memory, how wide, for whom, and whether it may be written."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias, cast

from polycnc.controllers.imc.core._parameter_rows import rows
from polycnc.errors import UsageError

WORDS = 1024  # 16-bit words of memory for an axis, and for the card

Scope: TypeAlias = Literal["A", "G"]
Access: TypeAlias = Literal["rw", "ro", "w"]

_WIDTHS = {"S16": 1, "U16": 1, "F16": 1, "R16": 1, "S32": 2, "U32": 2, "S16.16": 2, "U16.16": 2}
_WIDTHS |= {"S48": 3, "S16.32": 3, "U16.32": 3}


@dataclass(frozen=True, slots=True)
class Parameter:
    """One parameter of the card."""

    name: str
    address: int
    type: str  # one of the data types of chapter 5, or S48 for a 48-bit cell
    scope: Scope
    access: Access
    meaning: str

    @property
    def words(self) -> int:
        """Return how many 16-bit words it takes."""
        return _WIDTHS[self.type]

    @property
    def is_signed(self) -> bool:
        """Tell whether its number can be negative."""
        return self.type.startswith("S")

    @property
    def fraction_bits(self) -> int:
        """Return how many bits of the number are fraction."""
        return int(self.type.partition(".")[2] or 0)

    @property
    def least(self) -> float:
        """Return the lowest number that it can be written with; a set flag is -1 or 65535."""
        return self.from_raw(0 if self.type.startswith("U") else -(1 << 16 * self.words - 1))

    @property
    def most(self) -> float:
        """Return the highest number that it can be written with."""
        return self.from_raw((1 << 16 * self.words - self.is_signed) - 1)

    def to_raw(self, value: float) -> int:
        """Return the integer that stands for `value`, the nearest that can be represented."""
        return round(value * (1 << self.fraction_bits))

    def from_raw(self, raw: int) -> float:
        """Return the value of an integer as it is in memory."""
        return raw / (1 << self.fraction_bits) if self.fraction_bits else raw


def _parse() -> dict[str, Parameter]:
    table: dict[str, Parameter] = {}
    for line in rows().splitlines():
        if not line:
            continue
        name, address, kind, scope, access, meaning = line.split(" ", 5)
        parameter = Parameter(name, int(address), kind, cast("Scope", scope), cast("Access", access), meaning)
        table[name] = parameter
    return table


PARAMETERS: dict[str, Parameter] = _parse()


def parameter(name: str) -> Parameter:
    """Return the parameter called `name`; a trailing "Loc", as in the header's macros, does not matter.

    Raises:
        UsageError: There is no such parameter.
    """
    found = PARAMETERS.get(name) or PARAMETERS.get(name.removesuffix("Loc"))
    if found is None:
        raise UsageError(f"there is no parameter '{name}'", hint="names are those of the parameter header")
    return found


def address(name: str) -> int:
    """Return the address of the parameter called `name`."""
    return parameter(name).address


def is_listed(at: int) -> bool:
    """Tell whether a parameter begins at this address."""
    return at in _ADDRESSES


def is_read_only(at: int) -> bool:
    """Tell whether the parameter that begins at this address refuses to be written."""
    return at in _READ_ONLY


_ADDRESSES = frozenset(each.address for each in PARAMETERS.values())
_READ_ONLY = frozenset(each.address for each in PARAMETERS.values() if each.access == "ro")
