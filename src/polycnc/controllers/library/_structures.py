"""Structures of C as annotated classes, the table of what lies where, and views of memory in place.

A structure is a class of `ctypes`: an instance is its memory, so sizes, gaps, unions, and what becomes of a number
that is too large are as in C, and what C code fills in place is filled in place. The annotations are the table::

    @structure(pack=2)
    class ODBAXIS(Structure):
        dummy: SHORT
        type: SHORT
        data: Annotated[Longs, Times(6)]
"""

from __future__ import annotations

import ctypes
import inspect
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Annotated, Any, Self, TypeAlias, TypeVar, get_args, get_origin, get_type_hints

from polycnc.controllers.library._c_types import Number, Real
from polycnc.errors import UsageError


class _Memory:
    """What structures and unions have in common."""

    __slots__ = ()

    def pack(self) -> bytes:
        """Return the memory."""
        return bytes(self)  # type: ignore[call-overload,no-any-return]

    @classmethod
    def unpack(cls, memory: bytes) -> Self:
        """Return what lies in `memory`, as a copy.

        Raises:
            UsageError: `memory` has another size.
        """
        size = ctypes.sizeof(cls)  # type: ignore[arg-type]
        if len(memory) != size:
            raise UsageError(
                f"{cls.__name__} has {size} bytes, not {len(memory)}", hint="pass exactly one structure"
            )
        return cls.from_buffer_copy(memory)  # type: ignore[attr-defined,no-any-return]

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(_shown(self))})"

    def __eq__(self, other: object) -> bool:
        return bytes(self) == bytes(other) if isinstance(other, type(self)) else NotImplemented  # type: ignore[call-overload]

    def __hash__(self) -> int:
        return hash(bytes(self))  # type: ignore[call-overload]


class Structure(_Memory, ctypes.LittleEndianStructure):
    """Base of structures; `from_buffer` of ctypes views memory in place."""

    __slots__ = ()


class Union(_Memory, ctypes.LittleEndianUnion):
    """Base of unions."""

    __slots__ = ()


class Times:
    """How often an element is repeated, by dimension: `Times(16, 5)` is `[16][5]`."""

    def __init__(self, *counts: int) -> None:
        self.counts = counts


Shorts: TypeAlias = Annotated[ctypes.Array[ctypes.c_int16], Number("short", ctypes.c_int16)]
UShorts: TypeAlias = Annotated[ctypes.Array[ctypes.c_uint16], Number("unsigned short", ctypes.c_uint16)]
Longs: TypeAlias = Annotated[ctypes.Array[ctypes.c_int32], Number("long", ctypes.c_int32)]
Doubles: TypeAlias = Annotated[ctypes.Array[ctypes.c_double], Real()]
UChars: TypeAlias = Annotated[ctypes.Array[ctypes.c_uint8], Number("unsigned char", ctypes.c_uint8)]
Chars: TypeAlias = Annotated[bytes, Number("char", ctypes.c_char)]
"""A text: read up to its first zero, written as bytes. Arrays of texts are `Texts`."""
Texts: TypeAlias = Annotated[Any, Number("char", ctypes.c_char)]


@dataclass(frozen=True, slots=True)
class Field:
    """An element of a structure and where it lies; `counts` are its dimensions."""

    name: str
    c: str
    offset: int
    size: int
    counts: tuple[int, ...] = ()

    @property
    def declaration(self) -> str:
        """Return the element as C declares it."""
        return f"{self.c} {self.name}" + "".join(f"[{count}]" for count in self.counts)


@dataclass(frozen=True, slots=True)
class Layout:
    """A structure as it lies in memory."""

    name: str
    size: int
    fields: tuple[Field, ...]
    union: bool = False


@dataclass(frozen=True, slots=True)
class _Element:
    c: str
    ctype: Any
    counts: tuple[int, ...] = ()

    @property
    def whole(self) -> Any:
        """Return the type of ctypes with its dimensions."""
        made = self.ctype
        for count in reversed(self.counts):
            made = made * count
        return made


K = TypeVar("K", bound=type)
_elements: dict[type, dict[str, _Element]] = {}  # of each structure, as its annotations say


def structure(*, pack: int | None = None) -> Callable[[K], K]:
    """Lay the elements of a class out in memory, as C does, or at most `pack` bytes aligned.

    Elements with a plain annotation of Python are no part of the memory; other attributes there are none.
    """

    def lay_out(cls: K) -> K:
        elements = _annotated(cls)
        beside = tuple(name for name in inspect.get_annotations(cls) if name not in elements)
        space = {name: each for name, each in vars(cls).items() if name not in ("__dict__", "__weakref__")}
        made: Any = type(cls.__name__, cls.__bases__, {**space, "__slots__": beside})
        return _laid_out(made, elements, pack)  # type: ignore[no-any-return]

    return lay_out


def _laid_out(cls: K, elements: dict[str, _Element], pack: int | None) -> K:
    if pack is not None:
        cls._pack_, cls._layout_ = pack, "ms"  # type: ignore[attr-defined]
    cls._fields_ = [(name, each.whole) for name, each in elements.items()]  # type: ignore[attr-defined]
    _elements[cls] = elements
    return cls


def _annotated(cls: type) -> dict[str, _Element]:
    hints = get_type_hints(cls, include_extras=True)
    made = {}
    for name in inspect.get_annotations(cls):
        element = _element(hints[name])
        if element is not None:
            made[name] = element
    return made


def _element(hint: Any) -> _Element | None:
    told = getattr(hint, "__metadata__", ())
    python = get_args(hint)[0] if told else hint
    if get_origin(python) is ctypes.Array:
        python = get_args(python)[0]
    counts = next((each.counts for each in told if isinstance(each, Times)), ())
    for each in told:
        if getattr(each, "ctype", None) is not None:
            return _Element(each.c, each.ctype, counts)
    if isinstance(python, type) and issubclass(python, (ctypes.Structure, ctypes.Union)):
        return _Element(python.__name__, python, counts)
    return None


def _shown(memory: Any) -> Iterator[str]:
    for name, element in _elements[type(memory)].items():
        value = getattr(memory, name)
        yield f"{name}={list(value) if len(element.counts) == 1 and not isinstance(value, bytes) else value!r}"


def layout(cls: type) -> Layout:
    """Return the table of a structure."""
    fields = tuple(
        Field(name, each.c, getattr(cls, name).offset, ctypes.sizeof(each.whole), each.counts)
        for name, each in _elements[cls].items()
    )
    return Layout(cls.__name__, ctypes.sizeof(cls), fields, issubclass(cls, ctypes.Union))


def layouts(*classes: type) -> dict[str, Layout]:
    """Return the tables of structures by name."""
    return {cls.__name__: layout(cls) for cls in classes}


@lru_cache
def variant(cls: K, *, pack: int | None = None, **counts: int) -> K:
    """Return a structure with the same elements, packed otherwise, or with another number in arrays.

    `variant(ODBAXIS, data=2)` has two elements in `data`, for what has no fixed length; it is a kind of `cls`, but a
    memory of its own. Structures inside stay as they are.
    """
    elements = dict(_elements[cls])
    for name, count in counts.items():
        each = elements[name]
        elements[name] = _Element(each.c, each.ctype, (count, *each.counts[1:]))
    base = Union if issubclass(cls, ctypes.Union) else Structure
    methods = {name: each for name, each in vars(cls).items() if callable(each) and not name.startswith("__")}
    made: Any = type(
        cls.__name__, (base,), {"__slots__": (), "__module__": cls.__module__, "variant_of": cls, **methods}
    )
    return _laid_out(made, elements, pack if pack is not None else getattr(cls, "_pack_", None))  # type: ignore[no-any-return]
