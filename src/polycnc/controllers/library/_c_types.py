"""The types of C that arguments and elements of structures have, and what a call makes of a value of Python.

An argument is annotated with one of these, as `Annotated[int, Number("short", ctypes.c_int16)]`; the common ones have
names. `long` has 32 bits, as on the systems that the libraries were made for.
"""

from __future__ import annotations

import ctypes
import math
from dataclasses import dataclass
from typing import Annotated, Any, Protocol, TypeAlias, TypeVar

from polycnc.controllers.library._codes import Refused
from polycnc.errors import shown

T_co = TypeVar("T_co", covariant=True)


class Elements(Protocol[T_co]):
    """A list, or an array of C."""

    def __len__(self) -> int: ...

    def __getitem__(self, index: int, /) -> T_co: ...


class CType(Protocol):
    """A type of C."""

    @property
    def c(self) -> str:
        """Return its name in C; that of a pointer ends in a star or is the name of a pointer."""
        ...

    @property
    def ctype(self) -> Any:
        """Return the type of ctypes; of a pointer that of what it points to, None if that is not known."""
        ...

    def take(self, value: Any, to: Any) -> Any:
        """Return what the call is given for `value`; `to` is what the call is for: a session, an open device.

        Raises:
            Refused: The call is not carried out with this value.
            TypeError, ValueError: No C compiler would take it.
        """
        ...


@dataclass(frozen=True, slots=True)
class Number:
    """A whole number; what does not fit is cut to the width of the type, as C does it."""

    c: str
    ctype: Any

    def take(self, value: Any, to: Any) -> int:
        """Convert as C does: towards zero, then to the width."""
        return int(self.ctype(whole(value)).value)


@dataclass(frozen=True, slots=True)
class Whole:
    """A whole number within limits; others are refused."""

    c: str
    ctype: Any
    low: int
    high: int
    refusal: int

    def take(self, value: Any, to: Any) -> int:
        """Refuse what is beyond the limits."""
        if not self.low <= (number := whole(value)) <= self.high:
            raise Refused(self.refusal)
        return number


@dataclass(frozen=True, slots=True)
class Real:
    """A floating-point number."""

    c: str = "double"
    ctype: Any = ctypes.c_double

    def take(self, value: Any, to: Any) -> float:
        """Convert to a float."""
        return float(value)


@dataclass(frozen=True, slots=True)
class Text:
    """A text that ends in a zero; null is `None` where it is allowed."""

    c: str = "char *"
    ctype: Any = ctypes.c_char
    null: bool = False

    def take(self, value: Any, to: Any) -> str | None:
        """Return a text, of bytes too."""
        if value is None and self.null:
            return None
        if isinstance(value, (bytes, bytearray)):
            return value.split(b"\0", 1)[0].decode("latin-1")
        if not isinstance(value, str):
            raise TypeError(f"a text, not {shown(value)}")
        return value


@dataclass(frozen=True, slots=True)
class Opaque:
    """A handle, of 32 bits in C, that no program looks into; null is refused with `refusal`."""

    c: str
    refusal: int
    ctype: Any = ctypes.c_uint32

    def take(self, value: Any, to: Any) -> Any:
        """Refuse null."""
        if value is None:
            raise Refused(self.refusal)
        return value


@dataclass(frozen=True, slots=True)
class Bytes:
    """Memory of any content: bytes, a text, a structure, or a list of structures that lie one after another."""

    c: str = "void *"
    ctype: Any = ctypes.c_char

    def take(self, value: Any, to: Any) -> bytes:
        """Return the content."""
        if isinstance(value, str):
            return value.encode("latin-1")
        if isinstance(value, (list, tuple)):
            return b"".join(map(bytes, value))
        if value is None or isinstance(value, int):
            raise TypeError(f"memory, not {shown(value)}")
        return bytes(value)


@dataclass(frozen=True, slots=True)
class Pointer:
    """A structure or an array, passed as it is, so that a call can fill it; with `refusal` null is refused so.

    `ctype` is the structure; `of` is what an array holds, a list among them, or `callable` for a routine.
    """

    c: str
    ctype: Any = None
    refusal: int | None = None
    of: Any = None

    def take(self, value: Any, to: Any) -> Any:
        """Refuse a null pointer."""
        if value is None and self.refusal is not None:
            raise Refused(self.refusal)
        if value is None or (self.ctype is not None and kind_of(type(value)) is not self.ctype):
            raise TypeError(f"it is {self.c}")
        if self.of is callable and not callable(value):
            raise TypeError(f"it is a routine: {self.c}")
        if self.of not in (None, callable) and not _is_array(value, self.of):
            raise TypeError(f"it is an array: {self.c}")
        return value


def _is_array(value: Any, of: Any) -> bool:
    """Tell whether a value is an array of these elements, of Python or of ctypes."""
    if isinstance(value, (str, bytes, bytearray, dict)) or not hasattr(value, "__getitem__"):
        return False
    try:
        return all(
            isinstance(each, int | float) if of is int else kind_of(type(each)) is of for each in value
        )
    except TypeError:
        return False


def kind_of(cls: Any) -> Any:
    """Return the structure that a class is, or is a variant of."""
    return getattr(cls, "variant_of", cls)


def whole(value: Any) -> int:
    """Return a number as C converts it to a whole one: towards zero.

    Raises:
        ValueError: It is infinite or no number.
        TypeError: It is no number at all.
    """
    if isinstance(value, float):
        if not math.isfinite(value):
            raise ValueError(f"{value} is no whole number")
        return int(value)
    return value.__index__()  # type: ignore[no-any-return]


SHORT: TypeAlias = Annotated[int, Number("short", ctypes.c_int16)]
USHORT: TypeAlias = Annotated[int, Number("unsigned short", ctypes.c_uint16)]
INT: TypeAlias = Annotated[int, Number("int", ctypes.c_int32)]
LONG: TypeAlias = Annotated[int, Number("long", ctypes.c_int32)]
DOUBLE: TypeAlias = Annotated[float, Real()]
TEXT: TypeAlias = Annotated[str, Text()]
"""`long` has 32 bits."""

# fmt: off
__all__ = [
    "DOUBLE", "INT", "LONG", "SHORT", "TEXT", "USHORT", "Bytes", "CType",
    "Elements", "Number", "Opaque", "Pointer", "Real", "Text", "Whole", "whole",
]
# fmt: on
