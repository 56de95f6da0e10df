"""What a function or command of CPL is: one row with how it is written, what it gives, and what it does."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Any, TypeVar

from polycnc.nc.cpl._variables import Kind

MANY = 1000
_AnyFunction = TypeVar("_AnyFunction", bound=Callable[..., object])


class Takes(Enum):
    """What an own function is given of an argument."""

    NUMBER = "a number"
    PRINTED = "a number and, before it, its type"
    INTEGER = "an INTEGER or NUL"
    PLACE = "an INTEGER"
    TEXT = "the characters of a text, or NUL"
    LETTER = "the characters of a text"
    STORED = "a text as a variable holds it: a field, a part of one, or characters"


@dataclass(frozen=True, slots=True)
class Function:
    """A function or command of CPL.

    Args:
        usage: As it is written: "MID$(text,start[,number])"; what stands in brackets may be left out.
        kind: The type of its value.
        sentence: What it does.
        run: The Python of a function that is CPL's own, called with what `takes` says; None for one of the control.
            Given constants, it is evaluated when the program is compiled.
        new_text: Its value is a text that needs room of its own.
        keeps_type: Its value has the type of its argument.
        least, most: The numbers of arguments where the usage does not tell them.
        results: The places of arguments that are variables, which it sets (from `results[0]` on, if `listed`).
        waiting: It may have to wait for its answer.
        listed: What it gets tells its type, and a semicolon may end it.
        settable: A value can be assigned to it.
        command: It has no value, and stands by itself.
        named: It gets the names of its variables too, as `names`.
    """

    usage: str
    kind: Kind
    sentence: str
    run: Callable[..., Any] | None = None
    takes: tuple[Takes, ...] = ()
    new_text: bool = False
    keeps_type: bool = False
    least: int | None = None
    most: int | None = None
    results: tuple[int, ...] = ()
    waiting: bool = False
    listed: bool = False
    settable: bool = False
    command: bool = False
    named: bool = False

    name: str = field(init=False)
    """Its name."""
    count: tuple[int, int] = field(init=False)
    """The least and the most of its arguments."""
    leading: int = field(init=False)
    """How many of its first arguments may be left out."""

    def __post_init__(self) -> None:
        name, _, given = self.usage.partition("(")
        least, most = _count(given) if given else (0, 0)
        object.__setattr__(self, "name", name)
        object.__setattr__(self, "count", (self.least or least, self.most or most))
        object.__setattr__(self, "leading", given.partition("]")[0].count(",") if given[:1] == "[" else 0)


def _count(given: str) -> tuple[int, int]:
    """Return the least and the most arguments of a usage: commas in brackets come with what may be left out."""
    depth = needed = 0
    for character in given:
        depth += (character in "[{") - (character in "]}")
        needed += character == "," and depth == 0
    return needed + 1, MANY if "{" in given else given.count(",") + 1


def function(
    usage: str, kind: Kind, *takes: Takes, new_text: bool = False, settable: bool = False
) -> Callable[[_AnyFunction], _AnyFunction]:
    """Make a Python function one of CPL's own; the first line of its docstring says what it does."""

    def mark(run: _AnyFunction) -> _AnyFunction:
        sentence = (run.__doc__ or "").partition("\n")[0]
        run.cpl = Function(usage, kind, sentence, run, takes, new_text, settable=settable)  # type: ignore[attr-defined]
        return run

    return mark


def functions_of(names: Mapping[str, object]) -> list[Function]:
    """Return the rows of the functions of a module, in their order."""
    return [row for each in names.values() if isinstance(row := getattr(each, "cpl", each), Function)]
