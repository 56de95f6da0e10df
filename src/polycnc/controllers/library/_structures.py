"""Structures of C as annotated classes, the table of what lies where, and views of memory in place.

A structure is a class of `ctypes`: an instance is its memory, so sizes, gaps, unions, and what becomes of a number
that is too large are as in C, and what C code fills in place is filled in place. The annotations are the table::

    @structure(pack=2)
    class ODBAXIS(Structure):
        dummy: SHORT
        type: SHORT
        data: Annotated[Longs, Times(6)]

An array takes any sequence that is not longer, and is zero behind it, as in C. A text of type `str` is one in Python
too, in Latin-1. What has no place in the memory (a plain annotation, what a pointer points to) is held beside it and
begins as its type's zero.
"""

from __future__ import annotations

import ctypes
import inspect
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from operator import index
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
        if not isinstance(other, type(self)):
            return NotImplemented
        beside = _tables[type(self)].held
        return bytes(self) == bytes(other) and all(  # type: ignore[call-overload]
            getattr(self, name) == getattr(other, name) for name in beside
        )

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
"""A text: bytes up to its first zero; `Latin` is one of characters, `Texts` are arrays of texts."""
Latin: TypeAlias = Annotated[str, Number("char", ctypes.c_char)]
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
class Address:
    """Marks a pointer of 32 bits: what it points to is held in Python, and no address is in the memory."""

    c: str = "void *"
    ctype: Any = ctypes.c_uint32


class _Listed:
    """Elements that compare and show like a list."""

    def __eq__(self, other: object) -> bool:
        return list(self) == list(other) if isinstance(other, (ctypes.Array, list)) else NotImplemented  # type: ignore[call-overload]

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return repr(list(self))  # type: ignore[call-overload]


@lru_cache
def _array(ctype: Any, count: int) -> Any:
    """Return the type of an array; texts stay those of ctypes."""
    if ctype is ctypes.c_char:
        return ctype * count
    return type(f"{ctype.__name__}_{count}", (_Listed, ctypes.Array), {"_type_": ctype, "_length_": count})


@dataclass(frozen=True, slots=True)
class _Element:
    c: str
    ctype: Any
    python: Any
    counts: tuple[int, ...] = ()
    held: bool = False

    @property
    def whole(self) -> Any:
        """Return the type of ctypes with its dimensions."""
        made = self.ctype
        for count in reversed(self.counts):
            made = _array(made, count)
        return made

    @property
    def declared(self) -> str:
        return self.c + "".join(f"[{count}]" for count in self.counts)


@dataclass(frozen=True, slots=True)
class _Table:
    """A structure as its annotations say it; `beside` is what is no part of the memory."""

    elements: dict[str, _Element]
    beside: dict[str, Any]
    pack: int | None
    checked: bool

    @property
    def held(self) -> dict[str, Any]:
        """Return what is held in Python, with its type."""
        return self.beside | {name: each.python for name, each in self.elements.items() if each.held}


K = TypeVar("K", bound=type)
_tables: dict[type, _Table] = {}


def structure(*, pack: int | None = None, checked: bool = False) -> Callable[[K], K]:
    """Lay the elements of a class out in memory, as C does, or at most `pack` bytes aligned.

    A number that is too large is cut as in C; with `checked` it is a UsageError.
    """

    def lay_out(cls: K) -> K:
        elements: dict[str, _Element] = {}
        beside: dict[str, Any] = {}
        hints = get_type_hints(cls, include_extras=True)
        for name in inspect.get_annotations(cls):
            element = _element(hints[name])
            if element is None:
                beside[name] = hints[name]
            else:
                elements[name] = element
        return _laid_out(cls, cls.__bases__, _Table(elements, beside, pack, checked))

    return lay_out


def _laid_out(cls: K, bases: tuple[type, ...], table: _Table, **more: Any) -> K:
    """Make the class anew, as dataclasses do, so that there is no room for attributes that are no elements."""
    slots = tuple(f"_{name}" for name in table.held)
    left = _NOT_COPIED.union(table.elements, table.beside, slots)
    own = {name: each for name, each in vars(cls).items() if name not in left}
    made: Any = type(cls.__name__, bases, {**own, "__slots__": slots, **more})
    if table.pack is not None:
        made._pack_, made._layout_ = table.pack, "ms"
    made._fields_ = [(name, each.whole) for name, each in table.elements.items()]
    for name, each in table.elements.items():
        if each.counts:
            field = vars(made)[
                name
            ]  # getattr would keep it in a cache, from which unions do not take it away
            setattr(made, name, _Array(field, cls.__name__, name, each, table.checked))
    for name, python in table.held.items():
        setattr(made, name, _Held(getattr(made, name, None), f"_{name}", python))
    if table.checked:
        made.__setattr__ = _checked
    _tables[made] = table
    return made  # type: ignore[no-any-return]


_NOT_COPIED = {"__dict__", "__weakref__", "_fields_", "_pack_", "_layout_", "__setattr__"}


def _element(hint: Any) -> _Element | None:
    told = getattr(hint, "__metadata__", ())
    python = get_args(hint)[0] if told else hint
    inner = get_args(python)[0] if get_origin(python) is ctypes.Array else python
    counts = next((each.counts for each in told if isinstance(each, Times)), ())
    for each in told:
        if getattr(each, "ctype", None) is not None:
            return _Element(each.c, each.ctype, python, counts, isinstance(each, Address))
    if isinstance(inner, type) and issubclass(inner, (ctypes.Structure, ctypes.Union)):
        return _Element(inner.__name__, inner, python, counts)
    return None


class _Array:
    """An array or text in a structure; the descriptor of ctypes does the work."""

    def __init__(self, field: Any, owner: str, name: str, element: _Element, checked: bool) -> None:
        self._field, self._place = field, f"{owner}.{name}"
        self._element, self._checked = element, checked

    def __get__(self, memory: Any, owner: Any = None) -> Any:
        if memory is None:
            return self._field
        value = self._field.__get__(memory, owner)
        return value.decode("latin-1") if self._element.python is str else value

    def __set__(self, memory: Any, value: Any) -> None:
        try:
            made = self._made(value)
            if self._element.python is str:  # else what the last one left behind its zero would stay
                ctypes.memset(ctypes.addressof(memory) + self._field.offset, 0, self._field.size)
            self._field.__set__(memory, made)
        except (TypeError, ValueError, IndexError, OverflowError) as error:
            raise _unfit(self._place, value, error, self._element) from None

    def _made(self, value: Any) -> Any:
        counts = self._element.counts
        if self._element.python is str:
            text = str(value).encode("latin-1", "replace")
            if len(text) >= counts[0]:
                raise ValueError(f"at most {counts[0] - 1} characters and a zero")
            return text
        whole = self._element.whole
        if isinstance(value, (bytes, whole)):
            return value
        made = self._filled(value, whole, counts)
        whole_numbers = self._element.ctype not in (ctypes.c_double, ctypes.c_float)
        if self._checked and whole_numbers and len(counts) == 1 and made[: len(value)] != list(value):
            raise ValueError("a number is too large")
        return made

    def _filled(self, value: Any, whole: Any, counts: tuple[int, ...]) -> Any:
        if len(value) > counts[0]:
            raise ValueError(f"{len(value)} elements")
        if len(counts) > 1:
            value = [self._filled(each, whole._type_, counts[1:]) for each in value]
        return whole(*value)


class _Held:
    """Something beside the memory; `field` is the pointer that stands for it there."""

    def __init__(self, field: Any, slot: str, python: Any) -> None:
        self._field, self._slot, self._python = field, slot, python

    def __get__(self, memory: Any, owner: Any = None) -> Any:
        if memory is None:
            return self._field
        if not hasattr(memory, self._slot):
            setattr(memory, self._slot, self._python())
        return getattr(memory, self._slot)

    def __set__(self, memory: Any, value: Any) -> None:
        setattr(memory, self._slot, value)


def _checked(memory: Any, name: str, value: Any) -> None:
    element = _tables[type(memory)].elements.get(name)
    if element is not None and not element.counts and not element.held:
        try:
            value = index(value) if element.python is int else float(value)
            if element.ctype(value).value != value and value == value:
                raise ValueError("it is too large")
        except (TypeError, ValueError) as error:
            raise _unfit(f"{type(memory).__name__}.{name}", value, error, element) from None
    object.__setattr__(memory, name, value)


def _unfit(place: str, value: Any, error: Exception, element: _Element) -> UsageError:
    return UsageError(f"{place} does not hold {str(value)[:60]!r}: {error}", hint=f"it is {element.declared}")


def _shown(memory: Any) -> Iterator[str]:
    return (f"{name}={getattr(memory, name)!r}" for name in _tables[type(memory)].elements)


def layout(cls: type) -> Layout:
    """Return the table of a structure."""
    fields = tuple(
        Field(name, each.c, getattr(cls, name).offset, ctypes.sizeof(each.whole), each.counts)
        for name, each in _tables[cls].elements.items()
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
    table = _tables[cls]
    elements = dict(table.elements)
    for name, count in counts.items():
        elements[name] = replace(elements[name], counts=(count, *elements[name].counts[1:]))
    base = Union if issubclass(cls, ctypes.Union) else Structure
    packed = replace(table, elements=elements, pack=table.pack if pack is None else pack)
    return _laid_out(cls, (base,), packed, variant_of=cls)


# fmt: off
__all__ = [
    "Address", "Chars", "Doubles", "Field", "Latin", "Layout", "Longs", "Shorts", "Structure", "Texts",
    "Times", "UChars", "UShorts", "Union", "layout", "layouts", "structure", "variant",
]
# fmt: on
