"""Values of Python as plain data and back: tuples, enumerations, dataclasses, by the classes that are named, no others.

Equal values are equal data. What comes back has been checked against the annotations of its class, so that data of
anywhere is refused and not stumbled over later.
"""

from __future__ import annotations

import types
from collections.abc import Callable, Iterable, Mapping
from collections.abc import Set as AbstractSet
from dataclasses import fields, is_dataclass
from enum import Enum
from functools import cache
from typing import Any, Literal, NamedTuple, TypeVar, Union, get_args, get_origin, get_type_hints

import numpy as np

from polycnc.machine._snapshot import SnapshotError, damaged_snapshot

_PLAIN = (type(None), bool, int, float, str, bytes)
_TUPLE, _LIST, _DICT, _SET, _ARRAY = "()", "[]", "{}", "<>", "#"


class Form(NamedTuple):
    """How values of a class, or of one derived from it, become a tuple and are made from it."""

    taken: Callable[[Any], tuple[Any, ...]]
    made: Callable[..., Any]


class _Record:
    """A dataclass or named tuple by its fields."""

    def __init__(self, cls: type) -> None:
        self.cls = cls
        self.names: tuple[str, ...] = (
            tuple(each.name for each in fields(cls)) if is_dataclass(cls) else getattr(cls, "_fields", ())
        )

    def made(self, values: list[Any]) -> Any:
        if len(values) != len(self.names):
            raise damaged_snapshot(f"{self.cls.__name__} has {len(values)} fields")
        for name, value in zip(self.names, values, strict=True):
            if not _fits(value, _hints(self.cls)[name]):
                raise damaged_snapshot(f"{self.cls.__name__} has a {name} that is none")
        return self.cls(**dict(zip(self.names, values, strict=True)))


class Values:
    """Know some classes: dataclasses, named tuples and enumerations, and others by a `Form`."""

    def __init__(self, classes: Iterable[type], forms: Mapping[type, Form] | None = None) -> None:
        known = list(classes)
        self._records = {each.__name__: _Record(each) for each in known if not issubclass(each, Enum)}
        self._enums = {each.__name__: each for each in known if issubclass(each, Enum)}
        self._forms = {each.__name__: (each, form) for each, form in (forms or {}).items()}

    def plain(self, value: object) -> Any:
        """Return a value as plain data.

        Raises:
            SnapshotError: A value of a class that is not known is in it.
        """
        if value is None or type(value) in _PLAIN:
            return value
        if isinstance(value, Enum):
            if type(value).__name__ in self._enums:
                return [type(value).__name__, value.value]
        elif type(value).__name__ in self._records and type(value) is self._records[type(value).__name__].cls:
            names = self._records[type(value).__name__].names
            return [type(value).__name__, *(self.plain(getattr(value, name)) for name in names)]
        elif isinstance(value, tuple):
            return [_TUPLE, *map(self.plain, value)]
        elif isinstance(value, list):
            return [_LIST, *map(self.plain, value)]
        elif isinstance(value, Mapping):
            return [_DICT, *([self.plain(key), self.plain(each)] for key, each in value.items())]
        elif isinstance(value, AbstractSet):
            return [_SET, *sorted(map(self.plain, value), key=repr)]
        elif isinstance(value, np.ndarray):
            return [_ARRAY, value]
        elif isinstance(value, np.generic):
            return value.item()
        for name, (cls, form) in self._forms.items():
            if isinstance(value, cls):
                return [name, *map(self.plain, form.taken(value))]
        raise SnapshotError(
            f"a {type(value).__name__} cannot be kept in a snapshot", hint="take it at another moment"
        )

    def value(self, plain: Any) -> Any:
        """Return the value of plain data.

        Raises:
            SnapshotError: It is not what `plain` gives.
        """
        if plain is None or type(plain) in _PLAIN:
            return plain
        if not isinstance(plain, list) or not plain or not isinstance(plain[0], str):
            raise damaged_snapshot("a value of no kind")
        kind, *parts = plain
        if kind in self._enums:
            try:
                return self._enums[kind](*parts)
            except (ValueError, TypeError) as error:
                raise damaged_snapshot(error) from error
        if kind == _ARRAY and len(parts) == 1 and isinstance(parts[0], np.ndarray):
            return parts[0]
        if kind == _DICT:
            if not all(isinstance(pair, list) and len(pair) == 2 for pair in parts):
                raise damaged_snapshot("a pair is missing")
            try:
                return {self.value(key): self.value(each) for key, each in parts}
            except TypeError as error:
                raise damaged_snapshot(error) from error
        return self._collected(kind, [self.value(each) for each in parts])

    def _collected(self, kind: str, values: list[Any]) -> Any:
        if kind in self._records:
            return self._records[kind].made(values)
        try:
            if kind in self._forms:
                return self._forms[kind][1].made(*values)
            return {_TUPLE: tuple, _LIST: list, _SET: frozenset}[kind](values)
        except (TypeError, ValueError, LookupError) as error:
            raise damaged_snapshot(f"{kind}: {error}") from error


@cache
def _hints(cls: type) -> dict[str, Any]:
    return get_type_hints(cls)


def _fits(value: object, hint: Any) -> bool:
    """Tell whether a value is of the kind that an annotation says, and all that it holds."""
    if hint is Any or hint is object or isinstance(hint, TypeVar | str):
        return True
    origin, inner = get_origin(hint), get_args(hint)
    if origin in (Union, types.UnionType):
        return any(_fits(value, each) for each in inner)
    if origin is Literal:
        return value in inner
    if origin is tuple:
        if not isinstance(value, tuple):
            return False
        if len(inner) == 2 and inner[1] is Ellipsis:
            return all(_fits(each, inner[0]) for each in value)
        return len(value) == len(inner) and all(map(_fits, value, inner))
    if origin is not None:
        return _is_collection_of(value, origin, inner)
    if hint is None:
        return value is None
    if hint is float:
        return isinstance(value, int | float) and not isinstance(value, bool)
    if hint is int:
        return isinstance(value, int) and not isinstance(value, bool)
    return isinstance(value, hint) if isinstance(hint, type) else True


def _is_collection_of(value: object, origin: Any, inner: tuple[Any, ...]) -> bool:
    if isinstance(origin, type) and not isinstance(value, origin):
        return False
    if isinstance(value, Mapping) and len(inner) == 2:
        return all(_fits(key, inner[0]) and _fits(each, inner[1]) for key, each in value.items())
    if isinstance(value, list | AbstractSet) and len(inner) == 1:
        return all(_fits(each, inner[0]) for each in value)
    return True
