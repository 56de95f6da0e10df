"""Structures of C in memory, made by a `Header` from C text: what lies where, and views of memory in place.

A structure is a class of `ctypes`: an instance is its memory, so sizes, gaps, unions, and what becomes of a number
that is too large are as in C, and what C code fills in place is filled in place.

An array takes any sequence that is not longer, and is zero after it, as in C. A text of type `str` is one in Python
too, in Latin-1. What has no place in the memory (what a pointer points to, what stands in `NAME_beside`) is held beside
it and begins as its type's zero.
"""

from __future__ import annotations

import ctypes
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from operator import index
from typing import Any, ClassVar, Self, TypeVar

from polycnc.errors import UsageError


class _Memory:
    """What structures and unions have in common."""

    __slots__ = ()
    _table_: ClassVar[Table]

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
        beside = type(self)._table_.held
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


@dataclass(frozen=True, slots=True)
class Field:
    """An element of a structure and where it lies; `counts` are its dimensions, `counted_by` as in `Element`."""

    name: str
    c: str
    offset: int
    size: int
    counts: tuple[int, ...] = ()
    counted_by: str = ""

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


class _Listed:
    """Elements that compare and show like a list."""

    def __eq__(self, other: object) -> bool:
        return list(self) == list(other) if isinstance(other, (ctypes.Array, list)) else NotImplemented  # type: ignore[call-overload]

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return repr(list(self))  # type: ignore[call-overload]


@cache  # the type that a structure was laid out with is the only one that it takes
def _array(ctype: Any, count: int) -> Any:
    """Return the type of an array; texts stay those of ctypes."""
    if ctype is ctypes.c_char:
        return ctype * count
    return type(f"{ctype.__name__}_{count}", (_Listed, ctypes.Array), {"_type_": ctype, "_length_": count})


@dataclass(frozen=True, slots=True)
class Element:
    """An element of a structure as C declares it; `held` ones are pointers, and what they point to is in Python.

    `counted_by` says in terms of other elements how many of an array count, or how much a pointer points to.
    """

    c: str
    ctype: Any
    python: Any
    counts: tuple[int, ...] = ()
    held: bool = False
    counted_by: str = ""

    @property
    def whole(self) -> Any:
        """Return the type of ctypes with its dimensions."""
        made = self.ctype
        for count in reversed(self.counts):
            made = _array(made, count)
        return made

    @property
    def declared(self) -> str:
        """Return type and dimensions as C has them."""
        return self.c + "".join(f"[{count}]" for count in self.counts)


@dataclass(frozen=True, slots=True)
class Table:
    """The elements of a structure by name; `beside` is what is no part of the memory."""

    elements: Mapping[str, Element]
    beside: Mapping[str, Any] = field(default_factory=dict)
    pack: int = 0
    checked: bool = False

    @property
    def held(self) -> dict[str, Any]:
        """Return what is held in Python, with its type."""
        return {**self.beside, **{name: each.python for name, each in self.elements.items() if each.held}}


K = TypeVar("K", bound=type)


def lay_out(name: str, union: bool, table: Table, **more: Any) -> Any:
    """Return the class of a structure or union, its elements laid out as C does, at most `table.pack` bytes aligned.

    A number that is too large is cut as in C; in a checked one it is a UsageError. There is no room for attributes that
    are no elements.
    """
    fields = [(each, element.whole) for each, element in table.elements.items()]
    packed = {"_pack_": table.pack, "_layout_": "ms"} if table.pack else {}
    slots = tuple(f"_{each}" for each in table.held)
    space = {"__slots__": slots, **packed, "_fields_": fields, "_table_": table, **more}
    made: Any = type(name, (Union if union else Structure,), space)
    for each, element in table.elements.items():
        if element.counts:
            place = vars(made)[
                each
            ]  # getattr would keep it in a cache, from which unions do not take it away
            setattr(made, each, _Array(place, name, each, element, table.checked))
    for each, python in table.held.items():
        setattr(made, each, _Held(vars(made).get(each), f"_{each}", python))
    if table.checked:
        made.__setattr__ = _checked
    return made


class _Array:
    """An array or text in a structure; the descriptor of ctypes does the work."""

    def __init__(self, field: Any, owner: str, name: str, element: Element, checked: bool) -> None:
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
            if self._element.python is str:  # else what the last one left after its zero would stay
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
    element = type(memory)._table_.elements.get(name)
    if element is not None and not element.counts and not element.held:
        try:
            value = index(value) if element.python is int else float(value)
            if element.ctype(value).value != value and value == value:
                raise ValueError("it is too large")
        except (TypeError, ValueError) as error:
            raise _unfit(f"{type(memory).__name__}.{name}", value, error, element) from None
    object.__setattr__(memory, name, value)


def _unfit(place: str, value: Any, error: Exception, element: Element) -> UsageError:
    return UsageError(f"{place} does not hold {str(value)[:60]!r}: {error}", hint=f"it is {element.declared}")


def _shown(memory: Any) -> Iterator[str]:
    return (f"{name}={getattr(memory, name)!r}" for name in type(memory)._table_.elements)


def layout(cls: type) -> Layout:
    """Return the table of a structure."""
    table: Table = cls._table_  # type: ignore[attr-defined]
    fields = tuple(
        Field(
            name, each.c, getattr(cls, name).offset, ctypes.sizeof(each.whole), each.counts, each.counted_by
        )
        for name, each in table.elements.items()
    )
    return Layout(cls.__name__, ctypes.sizeof(cls), fields, issubclass(cls, ctypes.Union))


def layouts(*classes: type) -> dict[str, Layout]:
    """Return the tables of structures by name."""
    return {cls.__name__: layout(cls) for cls in classes}


@cache  # the type that a structure was laid out with is the only one that it takes
def variant(cls: K, **counts: int) -> K:
    """Return a structure with the same elements and another number in arrays.

    `variant(ODBAXIS, data=2)` has two elements in `data`, for what has no fixed length; it is a kind of `cls`, but a
    memory of its own. What lies inside structures inside, and packing, is varied by `Header.make`.
    """
    table: Table = cls._table_  # type: ignore[attr-defined]
    elements = dict(table.elements)
    for name, count in counts.items():
        elements[name] = replace(elements[name], counts=(count, *elements[name].counts[1:]))
    varied = replace(table, elements=elements)
    return lay_out(cls.__name__, issubclass(cls, ctypes.Union), varied, variant_of=cls)  # type: ignore[no-any-return]


@cache  # the type that a structure was laid out with is the only one that it takes
def repacked(cls: K, pack: int) -> K:
    """Return a structure with the same elements, packed otherwise, what is inside too; it is a kind of `cls`."""
    table: Table = cls._table_  # type: ignore[attr-defined]
    elements = {
        name: replace(each, ctype=(inner := repacked(each.ctype, pack)), python=inner)
        if hasattr(each.ctype, "_table_")
        else each
        for name, each in table.elements.items()
    }
    kind = getattr(cls, "variant_of", cls)
    made = replace(table, elements=elements, pack=pack)
    return lay_out(cls.__name__, issubclass(cls, ctypes.Union), made, variant_of=kind)  # type: ignore[no-any-return]


# fmt: off
__all__ = [
    "Element", "Field", "Layout", "Structure", "Table", "Union", "lay_out", "layout", "layouts", "repacked", "variant",
]
# fmt: on
