"""The parameters of a Power Mate as a table: number, type, attributes, range, what each does (`parameters.tsv`).

Ruling: the manual names the parameters that its functions depend on; the others are the usual ones of this family of
controls. A parameter without an entry under `acts` is kept and has no effect.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum, IntFlag
from functools import cache
from importlib import resources
from types import MappingProxyType


class Kind(IntEnum):
    """Types of parameters, as their attribute word has them (Manual 000, cnc_rdparainfo)."""

    BIT = 0
    BYTE = 1
    WORD = 2
    TWO_WORD = 3

    @property
    def size(self) -> int:
        """Return the bytes of one value."""
        return (1, 1, 2, 4)[self]


class Attribute(IntFlag):
    """Bits of the attribute word above the type."""

    AXIS = 1 << 2
    UNSIGNED = 1 << 3
    SETTING = 1 << 4
    WRITE_PROTECTED = 1 << 5
    POWER_OFF = 1 << 6
    NOT_READABLE = 1 << 7
    SPINDLE = 1 << 8


_LETTERS = {
    "U": Attribute.UNSIGNED,
    "S": Attribute.SETTING,
    "W": Attribute.WRITE_PROTECTED,
    "P": Attribute.POWER_OFF,
    "R": Attribute.NOT_READABLE,
    "D": Attribute.SPINDLE,
}
_KINDS = {"bit": Kind.BIT, "byte": Kind.BYTE, "word": Kind.WORD, "2word": Kind.TWO_WORD}


@dataclass(frozen=True, slots=True)
class ParameterRow:
    """One parameter; `acts` says what it does, empty: it is only kept."""

    number: int
    name: str
    kind: Kind
    attributes: Attribute
    option: str
    low: int
    high: int
    default: int
    acts: str

    @property
    def per_axis(self) -> bool:
        """Whether it has one value for each axis."""
        return Attribute.AXIS in self.attributes

    @property
    def type_word(self) -> int:
        """Return the attribute word: type in bits 0 and 1, the attributes above."""
        return int(self.kind) | int(self.attributes)

    def fits(self, value: int) -> bool:
        """Tell whether the parameter takes this value."""
        return self.low <= value <= self.high


def _row(line: str) -> ParameterRow:
    number, name, kind, axis, flags, option, low, high, default, acts = line.split("\t")
    attributes = Attribute.AXIS if axis else Attribute(0)
    for letter in flags:
        attributes |= _LETTERS[letter]
    of_kind = _KINDS[kind]
    bits = 8 * of_kind.size
    unsigned = of_kind is Kind.BIT or Attribute.UNSIGNED in attributes
    return ParameterRow(
        int(number),
        name,
        of_kind,
        attributes,
        option,
        int(low) if low else 0 if unsigned else -(1 << bits - 1),
        int(high) if high else (1 << bits) - 1 if unsigned else (1 << bits - 1) - 1,
        int(default),
        acts,
    )


@cache
def parameter_rows() -> MappingProxyType[int, ParameterRow]:
    """Return the table by number, in ascending order."""
    text = (resources.files(__package__) / "parameters.tsv").read_text("utf-8")
    rows = map(_row, text.splitlines()[1:])
    return MappingProxyType({row.number: row for row in sorted(rows, key=lambda row: row.number)})
