"""Compile entries before they are called: for the types that their annotations say."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Annotated, Any, get_type_hints

import numba
import numpy as np
import numpy.typing as npt
from numba.core.errors import TypingError

from polycnc.jit._entry import entries

_typeof: Any = numba.typeof  # not annotated
_PLAIN: dict[object, object] = {
    **{type(value): value for value in (3, 2.5, True)},
    # An array that is not part of a state is a row.
    npt.NDArray[np.float64]: np.zeros(2),
    npt.NDArray[np.int64]: np.zeros(2, np.int64),
    npt.NDArray[np.uint8]: np.zeros(2, np.uint8),
    Annotated[npt.NDArray[np.float64], 2]: np.zeros((2, 2)),  # of as many dimensions as it says
}


def _with_members(state: object) -> Iterator[object]:
    yield state
    if isinstance(state, tuple) and hasattr(state, "_fields"):
        for member in state:
            yield from _with_members(member)


def compile_all(package: str, states: Iterable[object], progress: Callable[[str, float], None]) -> int:
    """Do what `compile_entries` says."""
    types: dict[object, object] = {kind: _typeof(value) for kind, value in _PLAIN.items()}
    for state in states:
        for member in _with_members(state):
            if hasattr(member, "_fields"):
                types.setdefault(type(member), _typeof(member))
    wanted = [each for name, each in entries() if name.startswith(f"{package}.")]
    left_out = 0
    for number, each in enumerate(wanted):
        progress(each.py_func.__name__, number / len(wanted))
        try:
            each.compiled().compile(_signature(each.py_func, types))
        except TypingError:  # not known what it takes, or not a row after all
            left_out += 1
    return left_out


def _signature(function: Any, types: dict[object, object]) -> tuple[object, ...]:
    hints = get_type_hints(function, include_extras=True)
    hints.pop("return", None)
    unknown = [hint for hint in hints.values() if hint not in types]
    if unknown:
        raise TypingError(f"{function.__name__} takes {unknown}")
    return tuple(types[hint] for hint in hints.values())
