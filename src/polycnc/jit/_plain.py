"""Small work is done by the interpreter: compiling a function takes seconds, and pays when there is much to do.

Compiled functions are plain Python, with the same results to the last bit. As long as little has been asked of what is
not kept on disk, Python runs it as it is written. What counts is steps, not time: the same calls always do the same.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from types import FunctionType
from typing import Any, get_args, get_origin, get_type_hints

import numpy as np

from polycnc.jit._marks import Mark

ALLOWED_STEPS = 100_000
"""What a process may leave to the interpreter before it compiles: a second or two of work."""

UNASKED_STEPS = 20_000
"""What it leaves to the interpreter without looking for what is kept, since loading numba takes as long."""

_NEVER = 1 << 62
_Function: Any = FunctionType  # takes the namespace as it is


class Allowance:
    """The steps that a process may still leave to the interpreter."""

    def __init__(self) -> None:
        self.left: int | None = None  # None: nothing was asked yet
        self._floor = ALLOWED_STEPS - UNASKED_STEPS  # from here on what is kept is looked for

    def ask(self) -> None:
        """Look for what is kept from now on: numba is loaded."""
        self._floor = _NEVER

    def take_unasked(self, steps: Callable[[], int]) -> bool:
        """Tell whether a call of so many steps is left to the interpreter whatever is kept, and count them."""
        if self._begun() <= self._floor:
            return False
        wanted = steps()
        return self._begun() - wanted >= self._floor and self.take(lambda: wanted)

    def take(self, steps: Callable[[], int]) -> bool:
        """Tell whether a call of so many steps is left to the interpreter, and count them."""
        left = self._begun()
        if left <= 0:
            return False
        wanted = steps()
        if wanted > left:
            return False
        self.left = left - wanted
        return True

    def give_back(self, steps: int) -> None:
        """Let steps that were counted and not taken be taken later, unless all is compiled by now."""
        if self.left:
            self.left += steps

    def _begun(self) -> int:
        if self.left is None:
            self.left = 0 if os.environ.get("POLYCNC_COMPILE_AT_ONCE") else ALLOWED_STEPS
        return self.left


ALLOWANCE = Allowance()


def compile_at_once() -> None:
    """Leave nothing more to the interpreter: whoever follows a wall clock waits at the start, not in a motion."""
    ALLOWANCE.left = 0


class PlainFunctions:
    """Compiled functions as they are written: in namespaces where those that they call are plain too."""

    def __init__(self) -> None:
        self._functions: dict[int, tuple[Any, Callable[..., Any]]] = {}
        self._namespaces: dict[int, dict[str, Any]] = {}

    def of(self, mark: Mark) -> Callable[..., Any]:
        """Return the plain function."""
        mark = mark.inner
        known = self._functions.get(id(mark))
        if known is not None:
            return known[1]
        written: Any = mark.py_func
        namespace = self._namespace(written.__globals__)
        plain = _Function(
            written.__code__, namespace, written.__name__, written.__defaults__, written.__closure__
        )
        plain.__kwdefaults__ = written.__kwdefaults__
        self._functions[id(mark)] = mark, plain
        return plain  # type: ignore[no-any-return]

    def _namespace(self, names: dict[str, Any]) -> dict[str, Any]:
        known = self._namespaces.get(id(names))
        if known is None:
            known = self._namespaces[id(names)] = dict(names)
            for name, value in names.items():
                if isinstance(value, Mark):
                    known[name] = self.of(value)
        return known


class PlainEntry:
    """What Python calls instead of an entry while there is little to do."""

    def __init__(self, mark: Mark) -> None:
        self._plain = _PLAIN.of(mark)
        self._result = get_type_hints(mark.py_func).get("return")

    def __call__(self, *arguments: object) -> object:
        """Do the work, and return what compiled code would: plain numbers, infinity where it is divided by zero."""
        with np.errstate(all="ignore"):
            return _as_compiled(self._plain(*arguments), self._result)


_PLAIN = PlainFunctions()


def _as_compiled(value: Any, hint: Any) -> Any:
    if isinstance(value, tuple):
        hints = get_args(hint) if get_origin(hint) is tuple else ()
        parts = [
            _as_compiled(each, part) for each, part in zip(value, hints or [None] * len(value), strict=True)
        ]
        return tuple(parts)
    if isinstance(value, np.generic):
        value = value.item()
    return float(value) if hint is float else value
