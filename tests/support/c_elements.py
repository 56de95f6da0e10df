"""Elements of C structures: their types, found by their names as a manual writes them."""

from __future__ import annotations

import ctypes
from typing import Any


def type_of(structure: Any, path: str) -> Any:
    """Return the type of an element; of arrays that of one value."""
    kind = structure
    for name in path.split("."):
        kind = dict(_one(kind)._fields_)[name]
    return _one(kind)


def is_signed(structure: Any, path: str) -> bool:
    """Tell whether all bits of a number are -1."""
    return bool(type_of(structure, path)(-1).value == -1)


def _one(kind: Any) -> Any:
    while issubclass(kind, ctypes.Array):
        kind = kind._type_
    return kind
