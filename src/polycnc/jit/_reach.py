"""What a compiled function is made from, as one number: its own code and that of all it reaches.

Code counts as the interpreter has it: bytecode, constants, and the values of the global names in it. Comments,
docstrings, line numbers and the place of the file are no part of that.
"""

from __future__ import annotations

import enum
import hashlib
from collections.abc import Callable, Iterator
from types import BuiltinFunctionType, CodeType, FunctionType, ModuleType
from typing import Any, TypeAlias

import numpy as np

from polycnc.jit._marks import Mark

_OURS = __name__.partition(".")[0]
_MISSING = object()

Follow: TypeAlias = Callable[[Any], str]  # called with a compiled function that is met on the way: its digest


class NotKnownError(TypeError):
    """A compiled function refers to something whose content cannot be told."""


class Fingerprints:
    """Digests of compiled functions, each worked out once, when it is first asked for."""

    def __init__(self) -> None:
        self._known: dict[int, tuple[Any, str]] = {}
        self._open: list[Any] = []

    def of(self, mark: Any) -> str:
        """Return 32 hexadecimal digits for the code of a compiled function and of all that it reaches.

        Raises:
            NotKnownError: The code refers to a value whose content cannot be told.
        """
        mark = mark.inner
        known = self._known.get(id(mark))
        if known is not None:
            return known[1]
        if self._open and self._open[-1] is mark:
            return "itself"
        if any(each is mark for each in self._open):
            raise NotKnownError(f"{mark.py_func.__qualname__} calls itself by way of another function")
        self._open.append(mark)
        try:
            lines = [f"counted {mark.counted}", *_function(mark.py_func, self.of)]
        except NotKnownError as error:
            error.add_note(f"in {mark.py_func.__module__}.{mark.py_func.__qualname__}")
            raise
        finally:
            self._open.pop()
        digest = hashlib.blake2b(
            "\n".join(lines).encode("utf-8", "surrogatepass"), digest_size=16
        ).hexdigest()
        self._known[id(mark)] = mark, digest
        return digest


def _function(function: Any, follow: Follow) -> Iterator[str]:
    yield f"{function.__module__}.{function.__qualname__}"
    yield _value((function.__defaults__, function.__kwdefaults__), follow)
    for cell in function.__closure__ or ():
        yield _value(cell.cell_contents, follow)
    reached = list(codes(function.__code__))
    for code in reached:
        yield from _code(code, function.__doc__, follow)
    names = sorted({name for code in reached for name in code.co_names})
    for name in names:
        value = function.__globals__.get(name, _MISSING)
        if value is _MISSING:
            continue  # a builtin, or an attribute of something else
        yield f"{name} = {_value(value, follow)}"
        if isinstance(value, ModuleType) and _is_ours(value.__name__):
            parts = {each: getattr(value, each) for each in names if hasattr(value, each)}
            yield from (f"{name}.{each} = {_value(part, follow)}" for each, part in parts.items())


def _is_ours(module: str) -> bool:
    return module.partition(".")[0] == _OURS


def codes(code: CodeType) -> Iterator[CodeType]:
    """Yield a code and those within it."""
    yield code
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from codes(constant)


def _code(code: CodeType, doc: str | None, follow: Follow) -> Iterator[str]:
    yield code.co_code.hex()
    yield code.co_exceptiontable.hex()
    yield repr((code.co_argcount, code.co_posonlyargcount, code.co_kwonlyargcount, code.co_flags))
    yield repr((code.co_names, code.co_varnames, code.co_freevars, code.co_cellvars))
    for index, constant in enumerate(code.co_consts):
        if isinstance(constant, CodeType):
            yield "code"
        elif index > 0 or doc is None or constant != doc:
            yield _value(constant, follow)


def _value(value: Any, follow: Follow) -> str:
    """Return a text that is the same in every process where the value is the same."""
    for kinds, text in _TEXTS:
        if isinstance(value, kinds):
            return text(value, follow)
    raise NotKnownError(f"the content of {value!r} cannot be told")


def _plain(value: Any, _: Follow) -> str:
    return f"{type(value).__name__} {value!r}"


def _member(value: Any, _: Follow) -> str:
    return f"{type(value).__module__}.{type(value).__qualname__}.{value.name} {value.value!r}"


def _array(value: Any, _: Follow) -> str:
    return f"{value.dtype.descr} {value.shape} {value.tobytes().hex()}"


def _dtype(value: Any, _: Follow) -> str:
    return f"{value!r} {value.descr} {value.itemsize} {value.alignment}"


def _ordered(value: Any, follow: Follow) -> str:
    return f"{type(value).__qualname__} {[_value(each, follow) for each in value]}"


def _unordered(value: Any, follow: Follow) -> str:
    return f"{type(value).__qualname__} {sorted(_value(each, follow) for each in value)}"


def _mapping(value: Any, follow: Follow) -> str:
    return _ordered(tuple(value.items()), follow)


def _class(value: Any, follow: Follow) -> str:
    content = ""  # compiled code can make named tuples and look into enumerations; other classes are but names to it
    if issubclass(value, enum.Enum):
        content = f"{[(name, each.value) for name, each in value.__members__.items()]}"
    elif issubclass(value, tuple) and hasattr(value, "_fields"):
        content = f"{value._fields} {_value(value._field_defaults, follow)}"
    return f"{value.__module__}.{value.__qualname__} {content}"


def _named(value: Any, _: Follow) -> str:
    return f"{getattr(value, '__module__', '')}.{getattr(value, '__qualname__', value.__name__)}"


def _plain_function(value: Any, follow: Follow) -> str:
    # Compiled code cannot call a plain function. Its name may be that of an attribute, or numba was taught what it is.
    return _named(value, follow)


_TEXTS: tuple[tuple[tuple[type, ...], Callable[[Any, Follow], str]], ...] = (
    ((enum.Enum,), _member),
    ((Mark,), lambda value, follow: follow(value)),
    ((bool, int, float, complex, str, bytes, type(None), type(Ellipsis)), _plain),
    ((np.ndarray, np.generic), _array),
    ((np.dtype,), _dtype),
    ((tuple, list), _ordered),
    ((frozenset, set), _unordered),
    ((dict,), _mapping),
    ((type,), _class),
    ((BuiltinFunctionType, ModuleType, np.ufunc), _named),
    ((FunctionType,), _plain_function),
)
