"""A call as data: its name, its arguments with C type and direction, and what it returns, read from annotations.

The Python function takes the arguments that go in, in the manual's order. What C code passes a pointer for to get a
number or a structure is returned after the code, in the manual's order; `Out` says which argument that is::

    def cnc_getfigure(
        FlibHndl: Node, data_type: SHORT, size: Annotated[SHORT, INOUT]
    ) -> tuple[EW, int, Annotated[list[int], SHORT, Out("dec_fig")]]: ...

A pointer to a number that is read and written (`INOUT`) is passed as a value and returned too; a structure is passed
and filled in place, if it is not returned by `Out`.
"""

from __future__ import annotations

import ctypes
import inspect
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Annotated, Any, TypeVar, get_args, get_origin, get_type_hints

from polycnc.controllers.library._c_types import CType, Pointer
from polycnc.controllers.library._codes import Code
from polycnc.errors import shown


class Direction(Enum):
    """Which way an argument goes."""

    IN = "in"
    OUT = "out"
    INOUT = "in and out"


IN, OUT, INOUT = Direction

F = TypeVar("F", bound=Callable[..., Any])


@dataclass(frozen=True, slots=True)
class Out:
    """An argument that Python returns: its name, and the argument that follows it in C if it is not among the last.

    `c` is its type where it is not simply a pointer to what is returned.
    """

    name: str
    before: str = ""
    c: str = ""


@dataclass(frozen=True, slots=True)
class LengthOf:
    """Marks the argument that says how much there is, or is room for, in another one."""

    name: str


@dataclass(frozen=True, slots=True)
class Many:
    """Marks an array and says how many elements C passes, in terms of other arguments and constants.

    Not needed where an argument is its `LengthOf`.
    """

    count: str


class BadArgument(Exception):  # noqa: N818  becomes a UsageError
    """An argument that no C compiler would take."""


@dataclass(frozen=True, slots=True)
class Argument:
    """An argument as C sees it; `passed` and `returned` say where Python has it."""

    name: str
    c: str
    type: CType | None
    direction: Direction = Direction.IN
    passed: bool = True
    returned: bool = False
    length_of: str = ""
    zero: Callable[[], Any] = lambda: None
    many: str = ""

    def take(self, value: Any, to: Any) -> Any:
        """Return what the function is given for `value`, see `CType`.

        Raises:
            BadArgument: No C compiler would take it.
        """
        if self.type is None:
            return value
        try:
            return self.type.take(value, to)
        except (TypeError, ValueError, OverflowError, AttributeError) as error:
            raise BadArgument(f"{self.name} cannot be {shown(value)}: {error}") from None

    @property
    def declaration(self) -> str:
        """Return the argument as a prototype has it."""
        return f"{self.c}{'' if self.c.endswith('*') else ' '}{self.name}"


@dataclass(frozen=True, slots=True)
class Function:
    """A function of a library; `result` is what it returns in C, `coded` whether that is a code."""

    name: str
    result: str
    arguments: tuple[Argument, ...]
    coded: bool
    document: str
    zero: Callable[[], Any] = lambda: None

    @property
    def prototype(self) -> str:
        """Return the function as C declares it."""
        return (
            f"{self.result} {self.name}({', '.join(each.declaration for each in self.arguments) or 'void'})"
        )

    @property
    def passed(self) -> tuple[Argument, ...]:
        """Return the arguments of the Python function."""
        return tuple(each for each in self.arguments if each.passed)

    def answer(self, code: Any, given: Sequence[Any]) -> Any:
        """Return what the call answers if it is refused with `code`: nothing is read, what went in comes back."""
        places = {each.name: k for k, each in enumerate(self.passed)}
        outputs = [
            given[places[each.name]] if each.passed else each.zero()
            for each in self.arguments
            if each.returned
        ]
        if self.result != "void":
            outputs.insert(0, code if self.coded else self.zero())
        return tuple(outputs) if len(outputs) > 1 else outputs[0] if outputs else None


def function_of(body: Callable[..., Any], first: Argument | None, code: str) -> Function:
    """Return the table's entry of a function from its annotations; `first` stands for its first argument.

    Raises:
        TypeError: The annotations do not say all.
    """
    hints = get_type_hints(body, include_extras=True)
    result = hints.pop("return", type(None))
    names = list(inspect.signature(body).parameters)[1:]
    arguments = [] if first is None else [first]
    arguments += [passed(name, hints[name]) for name in names]
    elements = get_args(result) if get_origin(result) is tuple else (result,)
    void = result is type(None) or _told(elements[0], Out) is not None
    returned_types = elements[0 if void else 1 :] if result is not type(None) else ()
    for each in returned_types:
        if (out := _told(each, Out)) is not None:
            place = [argument.name for argument in arguments].index(out.before) if out.before else None
            arguments.insert(len(arguments) if place is None else place, _returned(out, each))
    made = tuple(arguments)
    if sum(each.returned for each in made) != len(returned_types):
        raise TypeError(f"{body.__name__} returns {len(returned_types)} values that are not all arguments")
    for each in made:
        if each.length_of and each.length_of not in (other.name for other in made):
            raise TypeError(f"{body.__name__}: there is no {each.length_of} that {each.name} counts")
    c, coded = ("void", False) if void else _result(elements[0], code, body.__name__)
    zero = _zero(_python(elements[0]))
    return Function(body.__name__, c, made, coded, (body.__doc__ or "").strip(), zero)


def named(body: F, name: str, text: str, arguments: dict[str, Any], returns: Any = None) -> F:
    """Give a function a name, a description, and arguments as if they had been written."""
    body.__name__ = body.__qualname__ = name
    body.__doc__ = text
    body.__annotations__ = {**arguments, "return": returns}
    parameters = [inspect.Parameter(each, inspect.Parameter.POSITIONAL_OR_KEYWORD) for each in arguments]
    body.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    return body


def _result(hint: Any, code: str, name: str) -> tuple[str, bool]:
    if isinstance(hint, type) and issubclass(hint, Code):
        return code, True
    told = _c_type(hint)
    if told is None:
        raise TypeError(f"{name} returns {hint}: a code, or a number with a C type?")
    return told.c, _told(hint, Coded) is not None


class Coded:
    """Marks a number that a function returns as its code, where codes are plain numbers."""


def passed(name: str, hint: Any) -> Argument:
    """Return an argument that the program passes.

    Raises:
        TypeError: Its annotation has no C type.
    """
    told = _c_type(hint)
    if told is None:
        raise TypeError(f"{name} has no C type: {hint}")
    direction = _told(hint, Direction) or Direction.IN
    length = _told(hint, LengthOf)
    returned = not isinstance(told, Pointer) and direction is not Direction.IN
    c = f"{told.c} *" if returned and not told.c.endswith("*") else told.c
    counted = length.name if length else ""
    return Argument(
        name.rstrip("_"), c, told, direction, returned=returned, length_of=counted, many=_many(hint)
    )


def _returned(out: Out, hint: Any) -> Argument:
    told = _c_type(hint)
    c = out.c or (told.c if told else "")
    if not out.c and not c.endswith("*"):
        c = f"{c} *"
    zero = _zero(_python(hint))
    return Argument(out.name, c, told, Direction.OUT, False, True, zero=zero, many=_many(hint))


def _many(hint: Any) -> str:
    found = _told(hint, Many)
    return found.count if found else ""


def _zero(hint: Any) -> Callable[[], Any]:
    if hint is Any or type(None) in get_args(hint):
        return lambda: None
    made = get_origin(hint) or hint
    return made if isinstance(made, type) else lambda: None


def _c_type(hint: Any) -> CType | None:
    for each in _all_told(hint):
        if hasattr(each, "take"):
            return each  # type: ignore[no-any-return]
    python = _python(hint)
    if isinstance(python, type) and issubclass(python, (ctypes.Structure, ctypes.Union)):
        return Pointer(f"{python.__name__} *", python)
    return None


def _python(hint: Any) -> Any:
    return get_args(hint)[0] if get_origin(hint) is Annotated else hint


def _told(hint: Any, kind: type) -> Any:
    return next((each for each in _all_told(hint) if isinstance(each, kind) or each is kind), None)


def _all_told(hint: Any) -> Iterator[Any]:
    """Go through what annotations say, also where one of them is itself an annotation."""
    for each in getattr(hint, "__metadata__", ()):
        yield each
        yield from _all_told(each)


# fmt: off
__all__ = [
    "IN", "INOUT", "OUT", "Argument", "Coded", "Direction", "Function", "LengthOf", "Many", "Out", "named",
]
# fmt: on
