"""The tree of a SAP program: what the parser builds and the compiler walks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias


@dataclass(frozen=True, slots=True)
class Place:
    """Line and column of the source, from 1."""

    line: int
    column: int


@dataclass(frozen=True, slots=True)
class Number:
    """A literal, integer or double by its Python type."""

    value: int | float
    at: Place


@dataclass(frozen=True, slots=True)
class Text:
    """A string literal."""

    value: str
    at: Place


@dataclass(frozen=True, slots=True)
class Name:
    """A name, with an index where one is written."""

    name: str
    index: Expression | None
    at: Place


@dataclass(frozen=True, slots=True)
class Qualified:
    """``axis.qualifier`` or ``axis.qualifier[index]``; `at` is the axis, `name_at` the qualifier."""

    axis: str
    name: str
    index: Expression | None
    at: Place
    name_at: Place


@dataclass(frozen=True, slots=True)
class Argument:
    """An argument of a call: ``name := value``, ``value`` or, to be written, ``value:width:decimals``."""

    name: str
    value: Expression
    formats: tuple[Expression, ...]
    at: Place


@dataclass(frozen=True, slots=True)
class Call:
    """A call of a function, or of a procedure or command where it is a statement."""

    name: str
    arguments: tuple[Argument, ...]
    at: Place


@dataclass(frozen=True, slots=True)
class Unary:
    """A sign or NOT."""

    operator: str
    operand: Expression
    at: Place


@dataclass(frozen=True, slots=True)
class Binary:
    """An operator between two operands; `at` is the operator."""

    operator: str
    left: Expression
    right: Expression
    at: Place


Expression: TypeAlias = Number | Text | Name | Qualified | Call | Unary | Binary


@dataclass(frozen=True, slots=True)
class Assign:
    """``target := value``."""

    target: Name | Qualified
    value: Expression
    at: Place


@dataclass(frozen=True, slots=True)
class If:
    """Conditions with what to do, the first that holds counts; then what to do if none does."""

    branches: tuple[tuple[Expression, Block], ...]
    otherwise: Block
    at: Place


@dataclass(frozen=True, slots=True)
class While:
    """``WHILE condition DO``."""

    condition: Expression
    body: Block
    at: Place


@dataclass(frozen=True, slots=True)
class Repeat:
    """``REPEAT ... UNTIL condition``."""

    body: Block
    condition: Expression
    at: Place


@dataclass(frozen=True, slots=True)
class For:
    """``FOR variable := first TO last DO``; `step` is 1 or -1."""

    variable: Name
    first: Expression
    last: Expression
    step: int
    body: Block
    at: Place


@dataclass(frozen=True, slots=True)
class Case:
    """``CASE selector OF``: ranges of constants with what to do."""

    selector: Expression
    branches: tuple[tuple[tuple[tuple[Expression, Expression], ...], Block], ...]
    otherwise: Block
    at: Place


Statement: TypeAlias = Assign | Call | If | While | Repeat | For | Case
Block: TypeAlias = tuple[Statement, ...]


@dataclass(frozen=True, slots=True)
class Constant:
    """``CONST name = value``."""

    name: str
    value: Expression
    at: Place


@dataclass(frozen=True, slots=True)
class Variable:
    """A variable of type `kind`; `bounds` are the first and last index of an array."""

    name: str
    kind: str
    bounds: tuple[Expression, Expression] | None
    at: Place


@dataclass(frozen=True, slots=True)
class Routine:
    """A procedure, a function (`result` is its type) or an event handler (`condition` is what it waits for)."""

    name: str
    parameters: tuple[Variable, ...]
    result: str | None
    condition: Expression | None
    constants: tuple[Constant, ...]
    variables: tuple[Variable, ...]
    body: Block
    at: Place


@dataclass(frozen=True, slots=True)
class Source:
    """A whole program."""

    name: str
    constants: tuple[Constant, ...]
    variables: tuple[Variable, ...]
    routines: tuple[Routine, ...]
    body: Block
    end: Place
