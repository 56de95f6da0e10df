"""Numbers on the wire: a mantissa with a power of ten (or two), and the mark of a value that is not set."""

from __future__ import annotations

import struct
from dataclasses import dataclass

from polycnc.errors import ProtocolError

_VALUE8 = struct.Struct(">iHh")
_LOWEST, _HIGHEST = -(1 << 31), (1 << 31) - 1
_MARK = 0xFFFF
VALUE8_SIZE = _VALUE8.size


@dataclass(frozen=True, slots=True)
class Value8:
    """Hold mantissa / base ** exponent in eight bytes; `base` None is a value that is not set.

    A macro variable that is vacant is such a value.
    """

    mantissa: int = 0
    exponent: int = 0
    base: int | None = 10

    def __bytes__(self) -> bytes:
        if self.base is None:
            return _VALUE8.pack(0, _MARK, -1)
        return _VALUE8.pack(self.mantissa, self.base, self.exponent)

    @property
    def number(self) -> float | None:
        """The value as a float, None if it is not set."""
        return None if self.base is None else self.mantissa / self.base**self.exponent

    @classmethod
    def of(cls, value: float | None, decimals: int) -> Value8:
        """Return a value with so many decimals, with fewer where they do not fit 32 bits; None is vacant.

        A value that no exponent makes fit is the nearest that fits.
        """
        if value is None:
            return VACANT
        while decimals > 0 and not _LOWEST <= round(value * 10**decimals) <= _HIGHEST:
            decimals -= 1
        return cls(max(_LOWEST, min(_HIGHEST, round(value * 10**decimals))), decimals)

    @classmethod
    def from_wire(cls, data: bytes) -> Value8:
        """Read eight bytes.

        Raises:
            ProtocolError: there are not eight, or they are no number.
        """
        if len(data) != VALUE8_SIZE:
            raise ProtocolError(f"a number has {len(data)} bytes, not {VALUE8_SIZE}")
        return cls.checked(*_VALUE8.unpack(data))

    @classmethod
    def checked(cls, mantissa: int, base: int, exponent: int) -> Value8:
        """Return the number of these parts.

        Raises:
            ProtocolError: They are no number.
        """
        if exponent == -1 and base in (0, _MARK):
            return VACANT
        if base == 0 and exponent == 0:
            return cls(mantissa, 0, 10)  # clients that leave the base out mean whole numbers
        if base not in (2, 10) or not -32 <= exponent <= 64:
            raise ProtocolError(f"a number has base {base} and exponent {exponent}")
        return cls(mantissa, exponent, base)


VACANT = Value8(0, 0, None)


def swapped(data: bytes, width: int) -> bytes:
    """Turn values of the PMC, the low byte first, into those of the wire, and back."""
    return b"".join(data[at : at + width][::-1] for at in range(0, len(data), width))


def text(value: str, size: int, encoding: str = "ascii") -> bytes:
    """Return `value` in exactly `size` bytes, zero-padded; what does not fit is cut, what has no code becomes '?'."""
    return value.encode(encoding, "replace")[:size].ljust(size, b"\0")
