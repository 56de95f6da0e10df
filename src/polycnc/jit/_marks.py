"""What stands in a module in the place of a function that can be compiled; numba is not loaded for it."""

from __future__ import annotations

import functools
import os
from collections.abc import Callable
from typing import Any, cast

DISABLED = os.environ.get("NUMBA_DISABLE_JIT", "0") != "0"
"""Whether nothing is compiled, and functions stand in their modules as they are written."""

OPEN_INTERNALS = bool(os.environ.get("POLYCNC_OPEN_INTERNALS"))
"""Whether Python may call functions that are not entries: tests may."""


class Mark:
    """A function as it is written, how it is to be compiled, and what numba makes of it once that is asked for."""

    __name__: str
    __module__: str

    def __init__(self, function: Callable[..., Any], *, counted: bool) -> None:
        self.py_func: Any = function
        functools.update_wrapper(cast("Any", self), self.py_func)
        self.counted = counted  # whether it may allocate arrays, which takes numba's counts of references
        self.apart = False  # whether it stays a function of its own in compiled code
        self.dispatcher: Any = None

    @property
    def inner(self) -> Mark:
        """What compiled code calls."""
        return self


class Kept(Mark):
    """What calls an internal function, and is kept on disk."""

    def __init__(self, inner: Mark) -> None:
        super().__init__(inner.py_func, counted=inner.counted)
        self._inner = inner

    @property
    def inner(self) -> Mark:
        """What is called."""
        return self._inner

    def compiled(self) -> Any:
        """Return what numba makes of the function, which loads numba."""
        raise NotImplementedError


def call_in_python(address: int, places: tuple[int, ...], numbers: tuple[int, ...]) -> int:
    """Call a detached function where nothing is compiled: address and places are numbers of `number_of`."""
    return int(_known[address](*(_known[place] for place in places), *numbers))


def number_of(each: object) -> int:
    """Return the number by which `call_in_python` knows a function or a state."""
    for number, known in enumerate(_known):
        if known is each:
            return number
    _known.append(each)
    return len(_known) - 1


_known: list[Any] = [None]
