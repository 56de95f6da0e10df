"""A record on the wire, declared once as text: it packs, unpacks and says what stands where.

A record is `name:code` for each field. Codes are those of `struct` (big-endian, `<i` excepted), `8` for a number of
eight bytes, `sN` for a text of N bytes, `s-` for one as long as was asked for, `s*` and `*` for the rest, `?N` for N
bytes of which nothing is known, `4*` and `8*` for one value for each axis that the series has room for.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import lru_cache
from typing import Any

from polycnc.controllers.fanuc.wire._numbers import VALUE8_SIZE, Value8
from polycnc.errors import ProtocolError

_NUMBERS = {code: struct.Struct(f">{code}") for code in "BHhIid"} | {"<i": struct.Struct("<i")}
_UNSIGNED = {"B": 0xFF, "H": 0xFFFF, "I": 0xFFFFFFFF}
_LONG = (-(1 << 31), (1 << 31) - 1)


class Part:
    """A field of a record: `pack` makes bytes of a value, `size` is None where a request or what is left says it.

    Signed numbers that do not fit become the nearest that does, unsigned ones are cut. `slot` is the size of the value
    of one axis, 0 if the field is not repeated for each axis.
    """

    __slots__ = ("code", "name", "pack", "size", "slot")

    def __init__(self, name: str, code: str) -> None:
        self.name, self.code = name, code
        self.slot = int(code[0]) if code in ("4*", "8*") else 0
        self.size = int(code[1:]) if code[1:].isdigit() else VALUE8_SIZE if code == "8" else None
        if code in _NUMBERS:
            self.size = _NUMBERS[code].size
        self.pack = _packer(code, self.size)

    def unpack(self, data: bytes) -> Any:
        """Return the value that bytes hold: a number, a `Value8`, a list of them, or bytes.

        Raises:
            ProtocolError: They hold none.
        """
        if self.code in _NUMBERS:
            return _NUMBERS[self.code].unpack(data)[0]
        if self.code == "8":
            return Value8.from_wire(data)
        if self.slot:
            each = Part(self.name, "8" if self.slot == VALUE8_SIZE else "i")
            return [each.unpack(data[at : at + self.slot]) for at in range(0, len(data), self.slot)]
        return data

    def shown(self, data: bytes) -> str:
        """Return the value as a reader wants it."""
        if self.code[0] == "s":
            return repr(data.split(b"\0")[0].decode("latin-1"))
        try:
            value = self.unpack(data)
        except ProtocolError:
            return "no number"
        if isinstance(value, Value8):
            return "vacant" if value.number is None else f"{value.number:.{max(value.exponent, 0)}f}"
        return str(value)


def _packer(code: str, size: int | None) -> Callable[[Any], bytes]:
    if code == "8":
        return _value8
    if code in ("4*", "8*"):
        each = _packer("8" if code == "8*" else "i", None)
        return lambda values: b"".join(map(each, values))
    if code[0] == "?":
        return lambda value: bytes(size or 0)
    if code[0] in "s*":
        return lambda value: _sized(
            value.encode("ascii", "replace") if isinstance(value, str) else value, size
        )
    pack = _NUMBERS[code].pack
    if code in ("i", "<i"):
        low, high = _LONG
        return lambda value: pack(low if value < low else high if value > high else value)
    if code in _UNSIGNED:
        mask = _UNSIGNED[code]
        return lambda value: pack(value & mask)
    return pack


def _value8(value: Value8 | int) -> bytes:
    return bytes(Value8(value) if isinstance(value, int) else value) if value else _ZERO


def _sized(value: bytes, size: int | None) -> bytes:
    return bytes(value) if size is None else value[:size].ljust(size, b"\0")


_ZERO = bytes(Value8(0))


_UNKNOWN = "?"


class Record:
    """Fields that lie one after the other."""

    def __init__(self, declared: str) -> None:
        self.parts = tuple(Part(*each.split(":")) for each in declared.split())
        self._packers = [(each.name if each.code[0] != "?" else _UNKNOWN, each.pack) for each in self.parts]
        sizes = [each.size for each in self.parts]
        self.size = None if None in sizes else sum(each for each in sizes if each is not None)

    def pack(self, values: Mapping[str, Any]) -> bytes:
        """Return the bytes of a record.

        Raises:
            KeyError: A field has no value.
        """
        return b"".join([pack(None if name == _UNKNOWN else values[name]) for name, pack in self._packers])

    def pack_all(self, rows: Sequence[Any]) -> bytes:
        """Return the bytes of records one after the other: of mappings, or of values where there is one field."""
        if len(self.parts) == 1 and rows and not isinstance(rows[0], Mapping):
            return b"".join(map(self.parts[0].pack, rows))
        return b"".join(map(self.pack, rows))

    def cut(self, data: bytes, at: int = 0, text_size: int | None = None) -> Iterator[tuple[Part, bytes]]:
        """Yield the fields with their bytes, as far as there are whole ones; `text_size` is what `s-` stands for."""
        for part in self.parts:
            left = len(data) - at
            size = (
                text_size
                if part.code == "s-"
                else left
                if part.code[1:] == "*" or part.code == "*"
                else part.size
            )
            if size is None or size > left or not left:
                return
            yield part, data[at : at + size]
            at += size

    def unpack(self, data: bytes, at: int = 0) -> dict[str, Any]:
        """Return the values by name.

        Raises:
            ProtocolError: There are too few bytes, or they hold no values.
        """
        pieces = list(self.cut(data, at))
        if any(each.size for each in self.parts[len(pieces) :]):
            raise ProtocolError(f"a record of {len(data) - at} bytes is too short")
        return {part.name: part.unpack(piece) for part, piece in pieces}


record = lru_cache(maxsize=None)(Record)
"""The record of a declaration; the same one for the same text."""
