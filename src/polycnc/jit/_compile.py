"""Decorators for functions that numba compiles: internal ones, and the entries from Python, which are kept on disk."""

from __future__ import annotations

import functools
import inspect
import os
from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar, cast, overload

import numba
from numba.core.compiler_lock import global_compiler_lock
from numba.core.dispatcher import OmittedArg
from numba.core.registry import CPUDispatcher
from numba.core.types import Omitted

from polycnc.jit._cache import ContentCache
from polycnc.jit._pipeline import pipelines
from polycnc.jit._plain import ALLOWANCE, PlainEntry, values_of
from polycnc.jit._reference import by_reference

P = ParamSpec("P")
R = TypeVar("R")
F = TypeVar("F", bound=Callable[..., Any])

# numba's own annotations leave out the options and settings that are used here.
_config: Any = numba.config
_njit: Any = numba.njit
_Omitted: Any = Omitted
_INTERNAL, _ENTRY = pipelines()

OPEN_INTERNALS = bool(os.environ.get("POLYCNC_OPEN_INTERNALS"))
"""Whether Python may call functions that are not entries: tests may."""


class _Entry(CPUDispatcher):
    """A compiled function that Python may call, and that is kept on disk."""

    _cache: ContentCache
    _inner: Any
    _steps: Callable[..., int] | None = None
    _spared: Callable[..., int] | None = None
    _plain: PlainEntry | None = None

    def _compile_for_args(self, *args: Any, **kws: Any) -> Any:
        """Return what is called with these arguments, of types that are not loaded: plain Python for little work."""
        numbas: Any = super()
        values = values_of(args)
        if not ALLOWANCE.take(lambda: 1 if self._steps is None else self._steps(*values)):
            return numbas._compile_for_args(*args, **kws)
        if self._plain is None:
            types = tuple(map(self._type_of, args))
            if self._cache.is_kept(types, self.targetctx):
                return numbas._compile_for_args(*args, **kws)
            self._plain = PlainEntry(self._inner)
        return functools.partial(self._do_plainly, self._plain, values)

    def _do_plainly(self, plain: PlainEntry, values: list[Any], *_: object) -> object:
        result = plain(*values)
        if self._spared is not None:
            ALLOWANCE.give_back(self._spared(result, *values))
        return result

    def _type_of(self, argument: Any) -> Any:
        if isinstance(argument, OmittedArg):
            return _Omitted(argument.value)
        return self.typeof_pyval(argument)

    def compile(self, sig: Any) -> Any:
        """Load or compile the function for these types of arguments."""
        with global_compiler_lock:
            try:
                return super().compile(sig)
            finally:
                self._cache.release()

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """Let compiled callers call the internal function, without the detour."""
        return self._inner.get_call_template(args, kws)

    def get_overload(self, sig: Any) -> Any:
        """Return what compiled callers call."""
        return self._inner.get_overload(sig)


class _Internal(CPUDispatcher):
    """A compiled function without a wrapper: numba would crash if Python called it."""

    _compiler: Any
    _twin: Callable[..., object] | None = None

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """Resolve a call by a compiled function: it passes states by reference."""
        args = self._compiler.fold_argument_types(args, kws)[1]
        return super().get_call_template(tuple(map(by_reference, args)), {})

    def __call__(self, *args: object, **kwargs: object) -> object:
        if not OPEN_INTERNALS:
            raise TypeError(
                f"{self.py_func.__name__} is internal to compiled code: decorate it with `entry`, "
                "or set POLYCNC_OPEN_INTERNALS=1 in tests"
            )
        if self._twin is None:  # so that the functions that users run are the same with and without tests
            self._twin = _as_entry(self)
        return self._twin(*args, **kwargs)


_entries: dict[str, _Entry] = {}  # by "module.name"


def entries() -> list[tuple[str, _Entry]]:
    """Return "module.name" and dispatcher of the entries of all modules imported so far."""
    return sorted(_entries.items())


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
    internal = _internal(function, counted=True)
    if not isinstance(internal, _Internal):
        return internal
    found = _as_entry(internal)
    found._steps, found._spared = steps, spared
    register_entry(function, found)
    return found


def _internal(function: Callable[P, R], *, counted: bool) -> Callable[P, R]:
    # A state is hundreds of words, which a real call puts on the stack one by one. That costs more than most
    # functions do, so they all become part of their callers. It changes no result.
    options = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True, "forceinline": True, **_INTERNAL}
    dispatcher = _njit(error_model="numpy", fastmath=False, _nrt=counted, **options)(function)
    if not _config.DISABLE_JIT:
        dispatcher.__class__ = _Internal
    return cast("Callable[P, R]", dispatcher)


def _as_entry(internal: _Internal) -> _Entry:
    """Make what Python calls: it takes the arguments as they come, and passes states on by reference."""
    dispatcher = as_detour(internal, _Entry)
    dispatcher._inner = internal
    return cast("_Entry", dispatcher)


def as_detour(internal: Any, kind: type, **options: object) -> Any:
    """Return a kept function of this kind that does nothing but call an internal one."""
    function = internal.py_func
    names = ", ".join(inspect.signature(function).parameters)
    namespace: dict[str, Any] = {"__name__": function.__module__, "internal": internal}
    exec(f"def entry({names}):\n    return internal({names})\n", namespace)
    detour = namespace["entry"]
    detour.__defaults__ = function.__defaults__
    functools.update_wrapper(detour, function)
    counted = internal.targetoptions["_nrt"]
    dispatcher = _njit(error_model="numpy", fastmath=False, _nrt=counted, **options, **_ENTRY)(detour)
    dispatcher.__class__ = kind
    dispatcher._cache = ContentCache(dispatcher)
    return dispatcher


def register_entry(function: Callable[..., object], dispatcher: Any) -> None:
    """Have a kept function among those that are compiled beforehand."""
    _entries[f"{function.__module__}.{function.__qualname__}"] = dispatcher
