"""What numba makes of marked functions: internal ones, and entries, which do nothing but call an internal one."""

from __future__ import annotations

import functools
import inspect
import threading
from collections.abc import Callable, Sequence
from types import CodeType, FunctionType
from typing import Any

import numba
import numpy as np
from numba.core.compiler_lock import global_compiler_lock
from numba.core.dispatcher import OmittedArg
from numba.core.registry import CPUDispatcher
from numba.core.types import Array, BaseTuple, Omitted
from numba.np.numpy_support import from_dtype, map_layout

from polycnc.jit._cache import ContentCache
from polycnc.jit._calls import call
from polycnc.jit._marks import Mark, call_in_python
from polycnc.jit._pipeline import pipelines
from polycnc.jit._reach import codes
from polycnc.jit._reference import by_reference

# numba's own annotations leave out the options and settings that are used here.
_njit: Any = numba.njit
_typeof: Any = numba.typeof
_Omitted: Any = Omitted
_Array: Any = Array
_Tuple: Any = BaseTuple
_from_dtype: Any = from_dtype
_map_layout: Any = map_layout
_Function: Any = FunctionType  # takes the namespace as it is
_INTERNAL, _ENTRY = pipelines()
_making = threading.RLock()


class _Own(CPUDispatcher):
    """A compiled function of types that numba has: what other packages add to it is not looked for."""

    def _compilation_chain_init_hook(self) -> None:
        """Load no extensions, which takes as long as loading a function."""

    def typeof_pyval(self, value: Any) -> Any:
        """Return the type of an argument; numba's way to those of arrays in tuples loads masked arrays."""
        found = _type_of_arrays(value)
        if found is None:
            numbas: Any = super()
            return numbas.typeof_pyval(value)
        return found


def _type_of_arrays(value: Any) -> Any:
    """Return the type of an array, or of a tuple of arrays and numbers; None of all else."""
    if type(value) is np.ndarray and value.dtype.kind in "biuf":
        dtype, layout = _from_dtype(value.dtype), _map_layout(value)
        return _Array(dtype, value.ndim, layout, readonly=not value.flags.writeable)
    if isinstance(value, tuple):
        members = [_type_of_arrays(each) or _typeof(each) for each in value]
        return _Tuple.from_types(members, type(value))
    return None


class _Entry(_Own):
    """A compiled function that Python may call, and that is kept on disk."""

    _cache: ContentCache
    _mark: Any

    def _compile_for_args(self, *args: Any, **kws: Any) -> Any:
        """Return what is called with these arguments, of types that are not loaded: plain Python for little work."""
        numbas: Any = super()
        values = tuple(_values_of(args))
        if not self._mark.is_little(values):
            return numbas._compile_for_args(*args, **kws)
        if self._cache.is_kept(tuple(map(self._type_of, args)), self.targetctx):
            return numbas._compile_for_args(*args, **kws)
        return functools.partial(self._do_plainly, values)

    def _do_plainly(self, values: tuple[Any, ...], *_: object) -> object:
        return self._mark.plainly(values)

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


class _Detached(_Own):
    """A function that is called through its address alone, and that is kept on disk."""

    _cache: ContentCache

    def compile(self, sig: Any) -> Any:
        """Load or compile the function for these types of arguments."""
        with global_compiler_lock:
            try:
                return super().compile(tuple(by_reference(each) for each in sig))
            finally:
                self._cache.release()


class _Internal(_Own):
    """A compiled function without a wrapper, for compiled callers."""

    _compiler: Any

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """Resolve a call by a compiled function: it passes states by reference."""
        args = self._compiler.fold_argument_types(args, kws)[1]
        return super().get_call_template(tuple(map(by_reference, args)), {})


def _values_of(arguments: Sequence[object]) -> list[Any]:
    """Return arguments as numba hands them on, with the defaults in their places."""
    return [each.value if isinstance(each, OmittedArg) else each for each in arguments]


def make_entry(mark: Mark) -> None:
    """Make what takes the arguments as they come, and passes states on by reference."""
    _make_detour(mark, _Entry)


def make_detached(mark: Mark) -> None:
    """Make what is called through its address, with the numbers of `Ready`."""
    _make_detour(mark, _Detached, no_cpython_wrapper=True, no_cfunc_wrapper=True)


def _make_detour(mark: Mark, kind: type, **options: object) -> None:
    with _making:
        if mark.dispatcher is not None:
            return
        function: Any = mark.py_func
        names = ", ".join(inspect.signature(function).parameters)
        namespace: dict[str, Any] = {"__name__": function.__module__}
        exec(f"def entry({names}):\n    return internal({names})\n", namespace)
        detour = namespace["entry"]
        detour.__defaults__ = function.__defaults__
        functools.update_wrapper(detour, function)
        made: Any = _njit(error_model="numpy", fastmath=False, _nrt=mark.counted, **options, **_ENTRY)(detour)
        made.__class__ = kind
        made._mark = mark
        # What is called is made when it has to be compiled: a kept entry has all of it.
        missing = functools.partial(_set_internal, namespace, mark)
        made._cache = ContentCache(mark, kind.__name__, missing)
        mark.dispatcher = made


def _set_internal(namespace: dict[str, Any], mark: Mark) -> None:
    with _making:
        namespace["internal"] = _internal(mark.inner)


def _internal(mark: Mark) -> Any:
    """Return the dispatcher of an internal function, in a namespace where those that it calls have theirs."""
    if mark.dispatcher is None:
        # A state is hundreds of words, which a real call puts on the stack one by one. That costs more than most
        # functions do, so they become part of their callers, but for those that are marked. It changes no result.
        options = {
            "no_cpython_wrapper": True,
            "no_cfunc_wrapper": True,
            "forceinline": not mark.apart,
            **_INTERNAL,
        }
        written: Any = mark.py_func
        namespace: dict[str, Any] = {}
        function = _in_namespace(written, namespace)
        mark.dispatcher = _njit(error_model="numpy", fastmath=False, _nrt=mark.counted, **options)(function)
        mark.dispatcher.__class__ = _Internal
        # Afterwards, since a function may call itself.
        namespace.update(_names(written.__code__, written.__globals__))
    return mark.dispatcher


def _in_namespace(written: Any, namespace: dict[str, Any]) -> Callable[..., Any]:
    function = _Function(
        written.__code__, namespace, written.__name__, written.__defaults__, written.__closure__
    )
    functools.update_wrapper(function, written)
    function.__kwdefaults__ = written.__kwdefaults__
    return function  # type: ignore[no-any-return]


def _names(code: CodeType, given: dict[str, Any]) -> dict[str, Any]:
    names = {"__name__", *(name for each in codes(code) for name in each.co_names)}
    return {name: _for_numba(given[name]) for name in names if name in given}


def _for_numba(value: Any) -> Any:
    if isinstance(value, Mark):
        return _internal(value.inner)
    return call if value is call_in_python else value
