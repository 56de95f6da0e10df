"""Compiled functions with machine code of their own, which other compiled code calls through their address.

What an entry reaches becomes one function, so a long part that few need makes everybody wait for its compilation. Such
a part can be detached: it is compiled when a call of it is first made ready, and all that the caller has of it and of
the states that it works on are numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numba
import numpy as np
import numpy.typing as npt
from numba.core import types
from numba.core.compiler_lock import global_compiler_lock
from numba.core.registry import CPUDispatcher
from numba.extending import intrinsic

from polycnc.jit._cache import ContentCache
from polycnc.jit._compile import as_detour, register_entry
from polycnc.jit._reference import by_reference

# numba's own annotations leave these out.
_config: Any = numba.config
_typeof: Any = numba.typeof
_types: Any = types
_intrinsic: Any = intrinsic
_lock: Any = global_compiler_lock

_known: list[Any] = [None]  # functions and states by number, where nothing is compiled


class _Detached(CPUDispatcher):
    """A function that is called through its address alone, and that is kept on disk."""

    _cache: ContentCache

    def compile(self, sig: Any) -> Any:
        """Load or compile the function for these types of arguments."""
        with _lock:
            try:
                return super().compile(tuple(by_reference(each) for each in sig))
            finally:
                self._cache.release()


class Ready:
    """A call that is made ready: `numbers` are the address of the function and those of its states."""

    def __init__(self, address: int, places: list[npt.NDArray[np.int64]], states: tuple[object, ...]) -> None:
        self.numbers = np.array([address, *(each.ctypes.data for each in places)], np.int64)
        self._held = places, states


class Detached:
    """A function of named tuples of arrays, and integers after them, that returns an integer."""

    def __init__(self, function: Any) -> None:
        self._function = function
        self._addresses: dict[Any, int] = {}
        self._dispatcher: Any = None
        if not _config.DISABLE_JIT:
            self._dispatcher = as_detour(function, _Detached, no_cpython_wrapper=True, no_cfunc_wrapper=True)
            register_entry(self._dispatcher.py_func, self._dispatcher)

    def ready(self, *states: object, numbers: int) -> Ready:
        """Make calls with these states, and so many integers, ready; the arrays of the states stay where they are.

        Raises:
            TypeError: A state has something other than arrays in it.
        """
        places = [np.array(list(_words(each)), np.int64) for each in states]
        if self._dispatcher is None:
            ready = Ready(0, [], states)
            ready.numbers = np.array([_number(each) for each in (self._function, *states)], np.int64)
            return ready
        key = (*map(_typeof, states), *[_types.int64] * numbers)
        if key not in self._addresses:
            self._dispatcher.compile(key)
            result = self._dispatcher.overloads[tuple(map(by_reference, key))]
            self._addresses[key] = result.library.get_pointer_to_function(result.fndesc.llvm_func_name)
        return Ready(self._addresses[key], places, states)


def _number(each: object) -> int:
    for number, known in enumerate(_known):
        if known is each:
            return number
    _known.append(each)
    return len(_known) - 1


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


def _call(typing: Any, address: Any, places: Any, numbers: Any) -> Any:
    kinds = (*[_types.voidptr] * len(places), *numbers)

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        convention = context.call_conv
        function = convention.get_function_type(_types.int64, kinds).as_pointer()
        pointer = context.get_value_type(_types.voidptr)
        passed = [builder.inttoptr(builder.extract_value(values[1], n), pointer) for n in range(len(places))]
        passed += [builder.extract_value(values[2], n) for n in range(len(numbers))]
        called = builder.inttoptr(values[0], function)
        return convention.call_function(builder, called, _types.int64, kinds, passed)[1]

    return _types.int64(address, places, numbers), generate


def _call_in_python(address: int, places: tuple[int, ...], numbers: tuple[int, ...]) -> int:
    return int(_known[address](*(_known[place] for place in places), *numbers))


call_at: Callable[[int, tuple[int, ...], tuple[int, ...]], int] = (
    _call_in_python if _config.DISABLE_JIT else _intrinsic(_call)
)
"""Call a detached function with the numbers of `Ready`, and integers; for compiled code."""
