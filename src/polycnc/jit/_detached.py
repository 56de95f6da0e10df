"""Compiled functions with machine code of their own, which other compiled code calls through their address.

What an entry reaches becomes one function, so a long part that few need makes everybody wait for its compilation. Such
a part can be detached: it is compiled when a call of it is first made ready, and all that the caller has of it and of
the states that it works on are numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from polycnc.jit._entry import register
from polycnc.jit._marks import DISABLED, Kept, call_in_python, number_of


class Ready:
    """A call that is made ready: `numbers` are the address of the function and those of its states."""

    def __init__(self, address: int, places: list[npt.NDArray[np.int64]], states: tuple[object, ...]) -> None:
        self.numbers = np.array([address, *(each.ctypes.data for each in places)], np.int64)
        self._held = places, states


class _Apart(Kept):
    """What calls an internal function at an address of its own."""

    def compiled(self) -> Any:
        """Return what numba makes of the function, which loads numba."""
        if self.dispatcher is None:
            from polycnc.jit._compile import make_detached

            make_detached(self)
        return self.dispatcher


class Detached:
    """A function of named tuples of arrays, and integers after them, that returns an integer."""

    def __init__(self, function: Any) -> None:
        self._function = function
        self._addresses: dict[Any, int] = {}
        if not DISABLED:
            self._mark = _Apart(function)
            register(self._mark)

    def ready(self, *states: object, numbers: int) -> Ready:
        """Make calls with these states, and so many integers, ready; the arrays of the states stay where they are.

        Raises:
            TypeError: A state has something other than arrays in it.
        """
        places = [np.array(list(_words(each)), np.int64) for each in states]
        if DISABLED:
            ready = Ready(0, [], states)
            ready.numbers = np.array([number_of(each) for each in (self._function, *states)], np.int64)
            return ready
        return Ready(self._address(states, numbers), places, states)

    def _address(self, states: tuple[object, ...], numbers: int) -> int:
        from polycnc.jit._reference import by_reference, types_of

        key = types_of(states, numbers)
        if key not in self._addresses:
            dispatcher = self._mark.compiled()
            dispatcher.compile(key)
            result = dispatcher.overloads[tuple(map(by_reference, key))]
            self._addresses[key] = result.library.get_pointer_to_function(result.fndesc.llvm_func_name)
        return self._addresses[key]


def _words(state: Any) -> Iterator[int]:
    """Return what numba has a named tuple of arrays as: the words of each array, one after the other."""
    if isinstance(state, tuple):
        for member in state:
            yield from _words(member)
    elif isinstance(state, np.ndarray):
        yield from (0, 0, state.size, state.itemsize, state.ctypes.data, *state.shape, *state.strides)
    else:
        raise TypeError(f"a state of arrays only can be handed on by its place, not {state!r}")


def detached(function: Callable[..., int]) -> Detached:
    """Give an internal function machine code of its own, for `call_at`."""
    return Detached(function)


call_at: Callable[[int, tuple[int, ...], tuple[int, ...]], int] = call_in_python
"""Call a detached function with the numbers of `Ready`, and integers; for compiled code."""
