"""What happens around every call, the same for every library: `Facade` makes its functions, `Session` is one client."""

from __future__ import annotations

import inspect
import threading
from collections.abc import Callable, Hashable, Iterable
from functools import partial
from typing import Any, ClassVar, Concatenate, Generic, ParamSpec, TypeVar, get_type_hints

from polycnc.controllers.library._c_types import Number, Real
from polycnc.controllers.library._codes import Refused
from polycnc.controllers.library._functions import Argument, BadArgument, Function, function_of, passed
from polycnc.errors import UsageError

_PLAIN = (int, float, str)

P = ParamSpec("P")
R = TypeVar("R")
H = TypeVar("H")  # what a program passes first
T = TypeVar("T")  # what the function gets for it
F = TypeVar("F", bound=Callable[..., Any])


class Session:
    """One client of a library: what is attached, what is open, and how time passes.

    The functions of the module belong to a session of their own; every other session has them as its attributes.
    Calls may come from several threads; one at a time is carried out.
    """

    calls: ClassVar[dict[str, Callable[..., Any]]]
    packed_calls: ClassVar[dict[str, Callable[[Any, list[Any]], Any]]]
    """The same for arguments in a list whose numbers are of the types in C, and within their limits."""

    def __init_subclass__(cls) -> None:
        """Give every library its own functions."""
        cls.calls, cls.packed_calls = {}, {}

    def __init__(self) -> None:
        self.lock = threading.RLock()
        self.asked: Hashable = (
            ""  # the call that is being carried out, with its plain arguments: see `Polling`
        )
        self.refused = False  # whether the last call was answered with a code and changed nothing

    def __getattr__(self, name: str) -> Callable[..., Any]:
        """Return a function of the library for this session."""
        try:
            call = type(self).calls[name]
        except KeyError:
            raise AttributeError(f"{type(self).__name__!r} has no attribute {name!r}") from None
        return partial(call, self)

    def __dir__(self) -> Iterable[str]:
        return [*super().__dir__(), *type(self).calls]


S = TypeVar("S", bound=Session)


class Handles(Generic[T]):
    """What is open, by number: numbers count from `first` and are not used again before `last`."""

    def __init__(self, refusal: int, first: int = 1, last: int = 0x7FFF) -> None:
        self._refusal = refusal
        self._first, self._last = first, last
        self._next = first
        self._open: dict[int, T] = {}

    def __len__(self) -> int:
        return len(self._open)

    def items(self) -> list[tuple[int, T]]:
        """Return all handles and what they stand for."""
        return list(self._open.items())

    def add(self, what: T) -> int:
        """Return a new handle.

        Raises:
            Refused: There are no more.
        """
        if len(self._open) > self._last - self._first:
            raise Refused(self._refusal)
        while self._next in self._open:
            self._step()
        handle = self._next
        self._step()
        self._open[handle] = what
        return handle

    def _step(self) -> None:
        self._next = self._next + 1 if self._next < self._last else self._first

    def find(self, handle: int) -> T:
        """Return what is open under a handle.

        Raises:
            Refused: There is no such handle.
        """
        try:
            return self._open[handle]
        except KeyError:
            raise Refused(self._refusal) from None

    def free(self, handle: int) -> T:
        """Let a handle go and return what it stood for.

        Raises:
            Refused: There is no such handle.
        """
        found = self.find(handle)
        del self._open[handle]
        return found

    def clear(self) -> None:
        """Let all handles go."""
        self._open.clear()


class Facade(Generic[S]):
    """The functions of a library: the table, and the makers of what stands in it.

    `module` is where programs find them, `code` the C type of the codes, `default` the session of the module's
    functions.
    """

    def __init__(self, module: str, default: S, *, code: str) -> None:
        self.functions: dict[str, Function] = {}
        self.default = default
        self._calls = type(default).calls
        self._packed_calls = type(default).packed_calls
        self._module = module
        self._code = code

    def on(
        self, find: Callable[[S], T], *, refused: int | None = None
    ) -> Callable[[Callable[Concatenate[T, P], R]], Callable[P, R]]:
        """Return the maker of functions whose first argument is not the program's: `find` brings it.

        A call that is refused answers with the code that it is refused with, or with `refused`.
        """

        def make(body: Callable[Concatenate[T, P], R]) -> Callable[P, R]:
            return self._made(body, lambda session, given: find(session), None, None, refused)

        return make

    def through(
        self, find: Callable[[S, H], T], hint: Any, *, name: str = "", refused: int | None = None
    ) -> Callable[[Callable[Concatenate[T, P], R]], Callable[Concatenate[H, P], R]]:
        """Return the maker of functions that reach something through their first argument, as a handle.

        The program passes what `hint` says, the function gets what `find` makes of it; `name` is its name in C.
        """

        def make(body: Callable[Concatenate[T, P], R]) -> Callable[Concatenate[H, P], R]:
            first = passed(name or next(iter(inspect.signature(body).parameters)), hint)
            return self._made(body, lambda session, given: find(session, given[0]), first, hint, refused)

        return make

    def alias(self, name: str, function: F) -> F:
        """Return `function`, which has this name too."""
        self._calls[name] = self._calls[function.__name__]
        return function

    def _made(
        self,
        body: Callable[..., Any],
        reach: Callable[[S, list[Any]], Any],
        first: Argument | None,
        hint: Any,
        refused: int | None,
    ) -> Callable[..., Any]:
        function = function_of(body, first, self._code)
        signature = _public(body, first, hint)
        count = len(signature.parameters)
        carrier = partial(_carrier, body, function, reach, 0 if first is None else 1, refused)
        default, name = self.default, body.__name__

        arguments = [*enumerate(function.passed)]
        carry_out = carrier([(place, each.take) for place, each in arguments])

        def call(session: S, /, *given: Any, **named: Any) -> Any:
            if named or len(given) != count:
                try:
                    bound = signature.bind(*given, **named)
                except TypeError as error:
                    raise UsageError(f"{name}: {error}", hint=function.prototype) from None
                bound.apply_defaults()
                given = bound.args
            return carry_out(session, [*given])

        def public(*given: Any, **named: Any) -> Any:
            return call(default, *given, **named)

        public.__name__ = public.__qualname__ = name
        public.__module__ = self._module
        public.__doc__ = body.__doc__
        public.__signature__ = signature  # type: ignore[attr-defined]
        public.__annotations__ = {
            **{each.name: each.annotation for each in signature.parameters.values()},
            "return": signature.return_annotation,
        }
        self.functions[name] = function
        self._calls[name] = call
        self._packed_calls[name] = carrier(
            [(place, each.take) for place, each in arguments if type(each.type) not in (Number, Real)]
        )
        return public


def _carrier(
    body: Callable[..., Any],
    function: Function,
    reach: Callable[[Any, list[Any]], Any],
    skipped: int,
    refused: int | None,
    takes: list[tuple[int, Callable[[Any, Any], Any]]],
) -> Callable[[Any, list[Any]], Any]:
    """Return what carries a call out with a list of arguments, of which `takes` are converted.

    The first `skipped` say what the call is for, and `body` does not get them.
    """
    before = [each for each in takes if each[0] < skipped]
    after = takes[len(before) :]
    name = body.__name__

    def carry_out(session: Session, values: list[Any]) -> Any:
        with session.lock:
            session.refused = False
            session.asked = (name, *[each for each in values if isinstance(each, _PLAIN)])
            try:
                for place, take in before:
                    values[place] = take(values[place], session)
                to = reach(session, values)
                for place, take in after:
                    values[place] = take(values[place], to)
                return body(to, *values[skipped:])
            except Refused as refusal:
                session.refused = True
                return function.answer(refusal.code if refused is None else refused, values)
            except BadArgument as error:
                raise UsageError(f"{name}: {error}", hint=function.prototype) from None

    return carry_out


def _public(body: Callable[..., Any], first: Argument | None, hint: Any) -> inspect.Signature:
    """Return the signature as programs see it, its annotations looked up."""
    signature = inspect.signature(body)
    hints = get_type_hints(body, include_extras=True)
    parameters = [
        each.replace(annotation=hints.get(each.name, each.annotation))
        for each in signature.parameters.values()
    ]
    if first is None:
        del parameters[0]
    else:
        parameters[0] = parameters[0].replace(annotation=hint)
    return signature.replace(parameters=parameters, return_annotation=hints.get("return"))


# fmt: off
__all__ = [
    "Facade", "Handles", "Session",
]
# fmt: on
