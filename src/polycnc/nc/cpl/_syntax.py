"""The tree of a CPL program: what the reader builds and the compiler walks. Places are offsets into the text."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeAlias

from polycnc.language import Choice, Jump, Loop, Mark, Tree
from polycnc.nc.cpl._variables import Variable

# Expressions


@dataclass(slots=True)
class Number:
    """A constant; whether it has a decimal point is its Python type."""

    at: int
    value: int | float


@dataclass(slots=True)
class Text:
    """A character string constant."""

    at: int
    value: str


@dataclass(slots=True)
class Word:
    """TRUE, FALSE or NUL."""

    at: int
    value: bool | None


@dataclass(slots=True)
class Name:
    """A variable, with indices where it is written with some."""

    at: int
    variable: Variable
    indices: tuple[Expression, ...] = ()


@dataclass(slots=True)
class Call:
    """A function or command with its arguments, None for one left out; `open`: a semicolon ends them."""

    at: int
    function: str
    arguments: tuple[Expression | None, ...] = ()
    open: bool = False


@dataclass(slots=True)
class Parentheses:
    """An expression in parentheses, kept so that their depth can be counted."""

    at: int
    inner: Expression


Leaf: TypeAlias = Number | Text | Word | Name | Call | Parentheses
Expression: TypeAlias = Tree[Leaf]

# Statements


@dataclass(slots=True)
class Assign:
    """``target = value``; a target that is a call is a system value that can be set, or MID$."""

    at: int
    target: Name | Call
    value: Expression


@dataclass(slots=True)
class Command:
    """A function or command that stands by itself."""

    at: int
    call: Call


@dataclass(slots=True)
class Dim:
    """DIM, or PDIM of a parameter."""

    at: int
    variable: Variable
    sizes: tuple[int, ...]
    parameter: bool = False


@dataclass(slots=True)
class SubCall:
    """A sub-program call: by CALL, or by an address of an NC block."""

    at: int
    line: int
    address: str
    name: str
    arguments: tuple[Expression, ...] = ()
    unlinked: bool = False
    skip: int = 0


@dataclass(slots=True)
class Wait:
    """WAIT; `condition` is the IC call of it, `state` what it is compared with."""

    at: int
    line: int
    condition: Call | None = None
    state: Expression | None = None
    negated: bool = False
    duration_ms: Expression | None = None
    result: Name | None = None
    skip: int = 0


@dataclass(slots=True)
class If(Choice):
    """IF: a condition and two routines."""

    at: int
    condition: Expression
    then: list[Statement] = field(default_factory=list)
    otherwise: list[Statement] = field(default_factory=list)
    has_else: bool = False

    @property
    def bodies(self) -> tuple[list[Statement], ...]:
        """The two routines."""
        return self.then, self.otherwise


@dataclass(slots=True)
class Case(Choice):
    """CASE: a selector and the routines of its labels; an empty tuple of labels is OTHERWISE."""

    at: int
    selector: Expression
    branches: list[tuple[tuple[int, ...], list[Statement]]] = field(default_factory=list)

    @property
    def bodies(self) -> tuple[list[Statement], ...]:
        """The routines."""
        return tuple(body for _, body in self.branches)


@dataclass(slots=True)
class For(Loop):
    """FOR: a counting loop."""

    closes = True

    at: int
    counter: Name
    start: Expression
    step: Expression | None
    end: Expression
    body: list[Statement] = field(default_factory=list)


@dataclass(slots=True)
class While(Loop):
    """WHILE: a loop tested before."""

    at: int
    condition: Expression
    body: list[Statement] = field(default_factory=list)


@dataclass(slots=True)
class Repeat(Loop):
    """REPEAT: a loop tested after."""

    closes = True

    at: int
    condition: Expression | None = None
    body: list[Statement] = field(default_factory=list)


@dataclass(slots=True)
class NcLine:
    """NC blocks that the control reads where they stand, from line `line` to `last`.

    There is no CPL in them but the variables `names`, each where it stands first.
    """

    at: int
    line: int
    last: int
    names: dict[Variable, Name] = field(default_factory=dict)


@dataclass(slots=True)
class NcWord:
    """A word of an NC block: an address with a value; without an address, text or AXP() that gives whole words."""

    at: int
    address: str
    value: Expression | float
    index: int | None = None


@dataclass(slots=True)
class NcBlock:
    """An NC block with CPL in it."""

    at: int
    line: int
    number: int | None
    skip: int
    words: tuple[NcWord, ...]
    message: str = ""


Statement: TypeAlias = (
    Assign
    | Command
    | Dim
    | Jump
    | Mark
    | SubCall
    | Wait
    | If
    | Case
    | For
    | While
    | Repeat
    | NcLine
    | NcBlock
)
