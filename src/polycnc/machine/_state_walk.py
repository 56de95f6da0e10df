"""State as trees of dataclasses, arrays, collections: one walk that copies, compares, writes back, and describes it.

A device keeps its state in dataclasses. `copied` takes them for a snapshot, `restore_state` writes a copy back into the
living ones, so that references to their arrays and lists remain valid.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Mapping, MutableMapping
from collections.abc import Set as AbstractSet
from dataclasses import fields, is_dataclass
from enum import Enum
from typing import Any, TypeVar

import numpy as np
from pydantic import BaseModel

T = TypeVar("T")
_BARE: Any = object.__repr__


def _is_record(value: object) -> bool:
    return is_dataclass(value) and not isinstance(value, type)


def _is_frozen(value: object) -> bool:
    return bool(getattr(type(value), "__dataclass_params__").frozen)  # noqa: B009  known to dataclasses alone


def _named(value: Any) -> Iterator[tuple[str, Any]]:
    return ((each.name, getattr(value, each.name)) for each in fields(value))


def copied(state: T) -> T:
    """Return a copy of a state that shares nothing with it that can change."""
    return _copied(state)  # type: ignore[no-any-return]


def _copied(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return value.copy()
    if _is_record(value):
        return type(value)(**{name: _copied(each) for name, each in _named(value)})
    if isinstance(value, tuple):
        parts = [_copied(each) for each in value]
        return type(value)(*parts) if hasattr(value, "_fields") else tuple(parts)
    if isinstance(value, deque):
        return deque(map(_copied, value), value.maxlen)
    if isinstance(value, list):
        return [_copied(each) for each in value]
    if isinstance(value, MutableMapping):
        return {key: _copied(each) for key, each in value.items()}
    if isinstance(value, set | bytearray):
        return value.copy()
    return value


def restore_state(state: T, saved: T) -> T:
    """Bring a state back to a copy of it, in place where it can change; return it, or the copy where it cannot.

    Arrays have to have the shapes of the copy: what a device is made from says so.
    """
    return _put(state, saved)  # type: ignore[no-any-return]


def _put(value: Any, saved: Any) -> Any:
    if type(value) is not type(saved):
        return _copied(saved)
    if isinstance(value, np.ndarray):
        value[...] = saved
        return value
    if _is_record(value) and not _is_frozen(value):
        for name, each in _named(saved):
            setattr(value, name, _put(getattr(value, name), each))
        return value
    if isinstance(value, list | deque):
        same = len(value) == len(saved)
        parts = list(map(_put, value, saved)) if same else [_copied(each) for each in saved]
        value.clear()
        value.extend(parts)
        return value
    if isinstance(value, bytearray):
        value[:] = saved
        return value
    if isinstance(value, MutableMapping):
        mapping = {key: _put(value.get(key), each) for key, each in saved.items()}
        value.clear()
        value.update(mapping)
        return value
    return _copied(saved)


def is_same(one: object, other: object) -> bool:
    """Tell whether two states are the same, bit for bit; the order of a dictionary does not count."""
    return described(one) == described(other)


def described(value: object) -> str:
    """Return a text that is the same for equal values in every process, and another one for all others.

    Functions count by their names, models by their JSON, sets and dictionaries in sorted order.

    Raises:
        TypeError: Something of it shows its address alone.
    """
    return "".join(_described(value))


def _described(value: Any) -> Iterator[str]:
    if isinstance(value, np.ndarray):
        yield f"{value.dtype.str}{value.shape}{value.tobytes().hex()}"
    elif isinstance(value, BaseModel):
        yield f"{type(value).__name__}{value.model_dump_json()}"
    elif isinstance(value, Enum):
        yield f"{type(value).__name__}.{value.name}"
    elif _is_record(value):
        yield from _joined(
            type(value).__name__, (f"{name}={described(each)}" for name, each in _named(value))
        )
    elif isinstance(value, Mapping):
        pairs = (f"{described(key)}:{described(each)}" for key, each in value.items())
        yield from _joined("map", sorted(pairs))
    elif isinstance(value, AbstractSet):
        yield from _joined("set", sorted(map(described, value)))
    elif isinstance(value, tuple | list | deque):
        yield from _joined("", map(described, value))
    elif isinstance(value, np.generic):
        yield repr(value.item())
    elif callable(value):
        yield f"{value.__module__}.{value.__qualname__}"
    elif type(value).__repr__ is _BARE:
        raise TypeError(f"a {type(value).__name__} has no text of its own")
    else:
        yield repr(value)


def _joined(name: str, parts: Iterable[str]) -> Iterator[str]:
    yield f"{name}({','.join(parts)})"
