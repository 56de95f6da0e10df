"""Decorators for functions that numba compiles: internal ones, and the entries from Python, which are kept on disk."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar, cast, overload

from polycnc.jit._marks import DISABLED, OPEN_INTERNALS, Kept, Mark
from polycnc.jit._plain import Entry

P = ParamSpec("P")
R = TypeVar("R")
F = TypeVar("F", bound=Callable[..., Any])


class Internal(Mark):
    """A function for compiled callers: numba would crash if Python called what it makes of it."""

    _twin: Entry | None = None

    def __call__(self, *args: object, **kwargs: object) -> object:
        """Call an entry of its own, where internals are open."""
        if not OPEN_INTERNALS:
            raise TypeError(
                f"{self.__name__} is internal to compiled code: decorate it with `entry`, "
                "or set POLYCNC_OPEN_INTERNALS=1 in tests"
            )
        if self._twin is None:  # so that the functions that users run are the same with and without tests
            self._twin = Entry(self)
        return self._twin(*args, **kwargs)


_entries: dict[str, Kept] = {}  # by "module.name"


def entries() -> list[tuple[str, Kept]]:
    """Return "module.name" and mark of what is kept, of all modules imported so far."""
    return sorted(_entries.items())


def versions() -> list[str]:
    """Return, sorted, name and content of the entries of all modules imported so far."""
    from polycnc.jit._cache import version

    return sorted(version(each) for each in _entries.values())


def register(mark: Kept) -> None:
    """Have a kept function among those that are compiled beforehand."""
    _entries[f"{mark.py_func.__module__}.{mark.py_func.__qualname__}"] = mark


def compiled(function: Callable[P, R]) -> Callable[P, R]:
    """Compile `function` for compiled callers; IEEE arithmetic, so it equals its uncompiled self exactly.

    Python cannot call it: the wrapper for that costs more compile time than most functions do (see `entry`).
    It cannot allocate arrays: without numba's reference counts a control cycle takes a tenth of the time (see
    `allocating`).
    """
    return function if DISABLED else cast("Callable[P, R]", Internal(function, counted=False))


def allocating(function: Callable[P, R]) -> Callable[P, R]:
    """Compile `function` for compiled callers, as `compiled` does, but allowed to allocate arrays."""
    return function if DISABLED else cast("Callable[P, R]", Internal(function, counted=True))


def apart(function: Callable[P, R]) -> Callable[P, R]:
    """Keep a long compiled function that is called from many places from becoming part of each of them."""
    mark: object = function
    if isinstance(mark, Mark):
        mark.inner.apart = True
    return function


@overload
def entry(function: Callable[P, R]) -> Callable[P, R]: ...
@overload
def entry(*, steps: Callable[..., int], spared: Callable[..., int] | None = None) -> Callable[[F], F]: ...
def entry(function: Any = None, *, steps: Any = None, spared: Any = None) -> Any:
    """Compile `function` for Python and compiled callers, and keep the result on disk.

    `steps` tells from the arguments of a call how many steps it may take, of some 20 µs uncompiled each; without it
    every call is one. `spared` tells from the result and the arguments how many of them it did not take. Few steps are
    not worth compiling (see `_plain`).
    """
    if function is None:
        return functools.partial(entry, steps=steps, spared=spared)
    if DISABLED:
        return function
    made = Entry(Internal(function, counted=True), steps, spared)
    register(made)
    return made
