"""How a record lies in memory, read from its field table: 4-byte alignment, no gaps, little endian.

A record is a dataclass whose annotations say what an element is in C. Elements with a plain annotation are not
part of the memory.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Self, TypeAlias, get_type_hints

from polycnc.errors import UsageError


@dataclass(frozen=True, slots=True)
class Cell:
    """One element in C: a `struct` letter, its bytes, and how often it is repeated, by dimension."""

    c_type: str
    letter: str
    shape: tuple[int, ...] = ()

    @property
    def format(self) -> str:
        """Return the element as `struct` writes it."""
        return f"{math.prod(self.shape)}{self.letter}"


Longint: TypeAlias = Annotated[int, Cell("LONGINT", "i")]
Double: TypeAlias = Annotated[float, Cell("double", "d")]
Pointer: TypeAlias = Annotated[
    bytearray, Cell("pointer", "x", (4,))
]  # an address says nothing outside the PC


@dataclass(frozen=True, slots=True)
class Element:
    """An element of a record and where it lies."""

    name: str
    cell: Cell
    offset: int


class Record:
    """Base of the records: fills and reads their memory."""

    __slots__ = ()
    ELEMENTS: ClassVar[tuple[Element, ...]]
    SIZE: ClassVar[int]  # bytes

    def __init_subclass__(cls) -> None:
        """Lay the elements out, in the order of their annotations."""
        cls.ELEMENTS = tuple(_laid_out(get_type_hints(cls, include_extras=True)))
        cls.SIZE = sum(struct.calcsize(f"<{each.cell.format}") for each in cls.ELEMENTS)

    def pack(self) -> bytes:
        """Return the record as it lies in memory.

        Raises:
            UsageError: A number does not fit its element, or an array has the wrong length.
        """
        return b"".join(
            _packed(type(self).__name__, each, getattr(self, each.name)) for each in self.ELEMENTS
        )

    @classmethod
    def unpack(cls, memory: bytes) -> Self:
        """Return the record that lies in `memory`.

        Raises:
            UsageError: `memory` is not `SIZE` bytes long.
        """
        if len(memory) != cls.SIZE:
            raise UsageError(
                f"{cls.__name__} has {cls.SIZE} bytes, not {len(memory)}", hint="pass exactly one record"
            )
        record = cls()
        for each in cls.ELEMENTS:
            values = struct.unpack_from(f"<{each.cell.format}", memory, each.offset)
            if values:
                setattr(record, each.name, _shaped(each.cell, values))
        return record


def _laid_out(hints: Mapping[str, Any]) -> Iterator[Element]:
    offset = 0
    for name, hint in hints.items():
        for cell in getattr(hint, "__metadata__", ()):
            if isinstance(cell, Cell):
                yield Element(name, cell, offset)
                offset += struct.calcsize(f"<{cell.format}")


def pack_all(records: Iterable[Record]) -> bytes:
    """Return records that lie directly behind each other, as the library wants its TSRP."""
    return b"".join(record.pack() for record in records)


def _packed(record: str, element: Element, value: Any) -> bytes:
    cell = element.cell
    try:
        return struct.pack(f"<{cell.format}", *_flat(cell, value))
    except (struct.error, OverflowError, TypeError) as error:
        raise UsageError(
            f"{record}.{element.name} does not hold {str(value)[:60]!r}: {error}",
            hint=f"it is {cell.c_type}" + "".join(f"[{length}]" for length in cell.shape),
        ) from None


def _flat(cell: Cell, value: Any) -> tuple[Any, ...]:
    if cell.letter == "x":
        return ()
    if cell.letter == "s":
        text = value.encode("latin-1", "replace")
        if len(text) >= cell.shape[0]:
            raise TypeError(f"at most {cell.shape[0] - 1} characters and a zero")
        return (text,)
    if len(cell.shape) == 2:
        return tuple(number for row in value for number in row)
    return tuple(value) if cell.shape else (value,)


def _shaped(cell: Cell, values: tuple[Any, ...]) -> Any:
    if cell.letter == "s":
        return values[0].split(b"\0", 1)[0].decode("latin-1")
    if len(cell.shape) == 2:
        columns = cell.shape[1]
        return [list(values[first : first + columns]) for first in range(0, len(values), columns)]
    return list(values) if cell.shape else values[0]
