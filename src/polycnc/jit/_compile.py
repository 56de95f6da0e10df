"""Decorators for functions that numba compiles: internal ones, and the entries from Python, which are kept on disk."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar, cast

import numba
from numba.core.compiler_lock import global_compiler_lock
from numba.core.registry import CPUDispatcher

from polycnc.jit._cache import FILES, ContentCache

P = ParamSpec("P")
R = TypeVar("R")

# numba's own annotations leave out the options and settings that are used here.
_config: Any = numba.config
_njit: Any = numba.njit

OPEN_INTERNALS = bool(os.environ.get("POLYCNC_OPEN_INTERNALS"))
"""Whether Python may call functions that are not entries: tests may."""


class _Entry(CPUDispatcher):
    """A compiled function that Python may call, and that is kept on disk."""

    _cache: ContentCache

    def compile(self, sig: Any) -> Any:
        """Load or compile the function for these types of arguments."""
        with global_compiler_lock:
            try:
                return super().compile(sig)
            finally:
                self._cache.release()


class _Internal(CPUDispatcher):
    """A compiled function without a wrapper: numba would crash if Python called it."""

    _twin: Callable[..., object] | None = None

    def __call__(self, *args: object, **kwargs: object) -> object:
        if not OPEN_INTERNALS:
            raise TypeError(
                f"{self.py_func.__name__} is internal to compiled code: decorate it with `entry`, "
                "or set POLYCNC_OPEN_INTERNALS=1 in tests"
            )
        if self._twin is None:  # so that the functions that users run are the same with and without tests
            self._twin = _as_entry(self.py_func, counted=self.targetoptions["_nrt"])
        return self._twin(*args, **kwargs)


_entries: dict[str, _Entry] = {}  # by "module.name"


def is_cold(name: str) -> bool:
    """Tell whether the entry "module.name" is still to be compiled here; its module must have been imported."""
    found = _entries.get(name)
    return found is not None and not FILES.exists(found._cache.version())


def versions() -> list[str]:
    """Return, sorted, name and content of the entries of all modules imported so far."""
    return sorted(each._cache.version() for each in _entries.values())


def compiled(function: Callable[P, R]) -> Callable[P, R]:
    """Compile `function` for compiled callers; IEEE arithmetic, so it equals its uncompiled self exactly.

    Python cannot call it: the wrapper for that costs more compile time than most functions do (see `entry`).
    It cannot allocate arrays: without numba's reference counts a control cycle takes a tenth of the time (see
    `allocating`).
    """
    return _internal(function, counted=False)


def allocating(function: Callable[P, R]) -> Callable[P, R]:
    """Compile `function` for compiled callers, as `compiled` does, but allowed to allocate arrays."""
    return _internal(function, counted=True)


def entry(function: Callable[P, R]) -> Callable[P, R]:
    """Compile `function` for Python and compiled callers, and keep the result on disk."""
    dispatcher = _as_entry(function, counted=True)
    if isinstance(dispatcher, _Entry):
        _entries[f"{function.__module__}.{function.__qualname__}"] = dispatcher
    return dispatcher


def _internal(function: Callable[P, R], *, counted: bool) -> Callable[P, R]:
    # A state is hundreds of words, which a real call puts on the stack one by one. That costs more than most
    # functions do, so they all become part of their callers. It changes no result.
    options = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True, "forceinline": True}
    dispatcher = _njit(error_model="numpy", fastmath=False, _nrt=counted, **options)(function)
    if not _config.DISABLE_JIT:
        dispatcher.__class__ = _Internal
    return cast("Callable[P, R]", dispatcher)


def _as_entry(function: Callable[P, R], *, counted: bool) -> Callable[P, R]:
    dispatcher = _njit(error_model="numpy", fastmath=False, _nrt=counted)(function)
    if not _config.DISABLE_JIT:
        dispatcher.__class__ = _Entry
        dispatcher._cache = ContentCache(dispatcher)
    return cast("Callable[P, R]", dispatcher)
