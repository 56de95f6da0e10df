"""Structures of programs that pack them otherwise than the manual: copies, and lengths, of one in the other."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping
from typing import Any, TypeAlias

Selected: TypeAlias = Mapping[str, Callable[[Any], str]]
"""By the name of a structure: which member of its union holds, by its other elements."""


def copied(source: Any, cls: Any, selected: Selected, member: str = "") -> Any:
    """Return a structure of `cls` with the elements of `source`, which is packed otherwise.

    Of a union the `member` is copied, "" if all of it lies in both alike.
    """
    made = cls()
    _copy(source, made, selected, member)
    return made


def _copy(source: Any, to: Any, selected: Selected, member: str = "") -> None:
    if isinstance(to, ctypes.Union) and not member:
        ctypes.memmove(
            ctypes.addressof(to),
            ctypes.addressof(source),
            min(ctypes.sizeof(to), ctypes.sizeof(source)),
        )
        return
    name = type(to).__name__
    chosen = selected[name](source) if name in selected else ""
    for each, element in type(to)._table_.elements.items():
        if member and each != member:
            continue
        if not hasattr(element.ctype, "_table_"):
            _move(source, to, each)
        elif element.counts:
            for one, other in zip(getattr(source, each), getattr(to, each), strict=False):
                _copy(one, other, selected)
        else:
            _copy(getattr(source, each), getattr(to, each), selected, chosen)


def _move(source: Any, to: Any, name: str) -> None:
    """Copy the bytes of an element of numbers, which are the same in any packing."""
    here, there = getattr(type(to), name), getattr(type(source), name)
    ctypes.memmove(
        ctypes.addressof(to) + here.offset,
        ctypes.addressof(source) + there.offset,
        min(here.size, there.size),
    )


def length_in(packed: Any, cls: Any, length: int) -> int:
    """Return how many bytes of `cls` the first `length` bytes of `packed` are: the elements that are whole in them."""
    most = ctypes.sizeof(packed)
    if length >= most:
        return ctypes.sizeof(cls) + length - most
    best = min(length, 0)
    for name, element in cls._table_.elements.items():
        here, there = getattr(packed, name), getattr(cls, name)
        if length >= here.offset + here.size:
            best = there.offset + there.size
            continue
        inside = length - here.offset
        if inside > 0:
            best = there.offset + _part(packed, element, name, inside, there.size)
        break
    return best


def _part(packed: Any, element: Any, name: str, inside: int, size: int) -> int:
    """Return how many bytes of an element the first `inside` bytes of the packed one are."""
    inner = packed._table_.elements[name].ctype
    if not hasattr(inner, "_table_"):
        return inside
    if not element.counts:
        return (
            min(inside, size) if issubclass(inner, ctypes.Union) else length_in(inner, element.ctype, inside)
        )
    whole, rest = divmod(inside, ctypes.sizeof(inner))
    last = min(length_in(inner, element.ctype, rest), ctypes.sizeof(element.ctype))
    return whole * ctypes.sizeof(element.ctype) + last


def alike(packed: Any, cls: Any) -> bool:
    """Tell whether a structure lies in memory as another packing has it."""
    return ctypes.sizeof(packed) == ctypes.sizeof(cls) and all(
        (getattr(packed, name).offset, getattr(packed, name).size)
        == (getattr(cls, name).offset, getattr(cls, name).size)
        and (
            not hasattr(element.ctype, "_table_") or alike(packed._table_.elements[name].ctype, element.ctype)
        )
        for name, element in cls._table_.elements.items()
    )
