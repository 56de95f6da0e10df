"""Read expressions by a table of operators and their powers.

A language reads its own operands (numbers, names, calls, brackets); what comes back is a tree of these, of signs and
of chains. A chain is a row of operators of the same precedence: a sum of a thousand terms is one node.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Generic, TypeAlias, TypeVar, Union

from polycnc.language._source import Flaw
from polycnc.language._tokens import Tokens

Leaf = TypeVar("Leaf")


@dataclass(slots=True)
class Unary(Generic[Leaf]):
    """A sign or another operator before its operand."""

    at: int
    operator: str
    operand: Tree[Leaf]


@dataclass(slots=True)
class Link(Generic[Leaf]):
    """An operator of a chain, with what stands after it."""

    at: int
    operator: str
    operand: Tree[Leaf]


@dataclass(slots=True)
class Chain(Generic[Leaf]):
    """Operators of the same precedence between operands, computed from left to right."""

    at: int
    first: Tree[Leaf]
    links: tuple[Link[Leaf], ...]


Tree: TypeAlias = Union[Leaf, Unary[Leaf], Chain[Leaf]]  # noqa: UP007 (a recursive alias needs it)


@dataclass(frozen=True, slots=True)
class Infix:
    """An operator between two operands: how tightly it binds; `single`: at most one of its power in a row."""

    power: int
    single: bool = False


@dataclass(frozen=True, slots=True)
class Prefix:
    """An operator before its operand: how tightly it binds; `repeats`: another one may follow."""

    power: int
    repeats: bool = False


@dataclass(frozen=True, slots=True)
class Operators:
    """The operators of a language by their words. Powers are above 0; equal powers are computed from the left."""

    infix: Mapping[str, Infix]
    prefix: Mapping[str, Prefix] = field(default_factory=dict)
    longest: int = 500
    """How many operands a chain may have."""


def read_expression(
    tokens: Tokens, operators: Operators, operand: Callable[[], Tree[Leaf]], least: int = 0
) -> Tree[Leaf]:
    """Read an expression as far as it goes, of operators that bind at least as tightly as `least`.

    `operand` reads one operand at the present token, and raises a Flaw if there is none; for what it finds between
    brackets it calls this function, inside `tokens.nested`.

    Raises:
        Flaw: An operand is missing, or something is nested too deeply or too long.
    """
    prefix = operators.prefix.get(tokens.token.word)
    left: Tree[Leaf]
    if prefix is not None and prefix.power >= least:
        sign = tokens.step()
        tokens.enter(sign.at, "operators inside each other")
        inner = prefix.power if prefix.repeats else prefix.power + 1
        left = Unary(sign.at, sign.word, read_expression(tokens, operators, operand, inner))
        tokens.leave()
    else:
        left = operand()
    infixes = operators.infix
    while (infix := infixes.get(tokens.token.word)) is not None and infix.power >= least:
        left = Chain(_place(left), left, _links(tokens, operators, operand, infix))
    return left


def _links(
    tokens: Tokens, operators: Operators, operand: Callable[[], Tree[Leaf]], infix: Infix
) -> tuple[Link[Leaf], ...]:
    links: list[Link[Leaf]] = []
    infixes, power = operators.infix, infix.power
    while (found := infixes.get(tokens.token.word)) is not None and found.power == power:
        sign = tokens.step()
        if links and infix.single:
            raise Flaw(sign.at, f"a second {sign} in a row", "write parentheses around the first one")
        if len(links) + 2 > operators.longest:
            raise Flaw(
                sign.at, f"more than {operators.longest} operands in a row", "keep a part in a variable"
            )
        links.append(Link(sign.at, sign.word, read_expression(tokens, operators, operand, power + 1)))
    return tuple(links)


def _place(tree: object) -> int:
    return int(getattr(tree, "at", 0))
