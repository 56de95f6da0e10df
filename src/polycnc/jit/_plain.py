"""Small work is done by the interpreter: compiling a function takes seconds, and pays when there is much to do.

Compiled functions are plain Python, with the same results to the last bit. As long as little has been asked of what is
not kept on disk, Python runs it as it is written. What counts is steps, not time: the same calls always do the same.
numba is loaded when the first function has to be compiled, or looked for among those that are kept.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from types import FunctionType
from typing import Any, get_args, get_origin, get_type_hints

import numpy as np

from polycnc.jit._marks import Kept, Mark

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
        return self.take(steps, self._floor)

    def take(self, steps: Callable[[], int], floor: int = 0) -> bool:
        """Tell whether a call of so many steps is left to the interpreter, with `floor` remaining, and count them."""
        left = self._begun()
        if left <= floor:
            return False
        left -= steps()
        if left < floor:
            return False
        self.left = left
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


_PLAIN = PlainFunctions()


class Entry(Kept):
    """A function that Python may call: plain while there is little to do, then by way of numba."""

    def __init__(
        self,
        inner: Mark,
        steps: Callable[..., int] | None = None,
        spared: Callable[..., int] | None = None,
    ) -> None:
        super().__init__(inner)
        self.steps, self.spared = steps, spared
        code = inner.py_func.__code__
        self._names = code.co_varnames[: code.co_argcount]
        self._defaults = inner.py_func.__defaults__ or ()
        self._plain: Callable[..., object] | None = None
        self._result: object = None  # the type of what it returns

    @property
    def stats(self) -> Any:
        """How often numba found the function kept, and how often not."""
        return self.compiled().stats

    @property
    def signatures(self) -> list[object]:
        """The types of arguments for which the function is loaded."""
        return [] if self.dispatcher is None else list(self.dispatcher.signatures)

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        """Do the work."""
        if self.dispatcher is None:
            values = self._values(args, kwargs)
            if values is not None and ALLOWANCE.take_unasked(lambda: self.wanted(values)):
                return self.plainly(values)
            self.compiled()
        return self.dispatcher(*args, **kwargs)

    def compiled(self) -> Any:
        """Return what numba makes of the function, which loads numba."""
        if self.dispatcher is None:
            from polycnc.jit._compile import make_entry

            ALLOWANCE.ask()
            make_entry(self)
        return self.dispatcher

    def is_little(self, values: tuple[Any, ...]) -> bool:
        """Take the steps of a call from the allowance, if there are as many left."""
        return ALLOWANCE.take(lambda: self.wanted(values))

    def wanted(self, values: tuple[Any, ...]) -> int:
        """Return how many steps a call may take."""
        return 1 if self.steps is None else self.steps(*values)

    def plainly(self, values: tuple[Any, ...]) -> object:
        """Do the work as it is written and return what compiled code would; its steps are counted already.

        That is plain numbers, and infinity where something is divided by zero.
        """
        if self._plain is None:
            self._plain, self._result = _PLAIN.of(self), get_type_hints(self.py_func).get("return")
        with np.errstate(all="ignore"):
            result = _as_compiled(self._plain(*values), self._result)
        if self.spared is not None:
            ALLOWANCE.give_back(self.spared(result, *values))
        return result

    def _values(self, args: tuple[Any, ...], kwargs: dict[str, Any]) -> tuple[Any, ...] | None:
        """Return the arguments with the defaults in their places; None where they do not fit."""
        missing = len(self._names) - len(args)
        if missing == 0 and not kwargs:
            return args
        given = dict(zip(self._names[len(self._names) - len(self._defaults) :], self._defaults, strict=True))
        given.update(kwargs)
        try:
            return (*args, *(given[name] for name in self._names[len(args) :]))
        except KeyError:
            return None  # numba says what is wrong


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
