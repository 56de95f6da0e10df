"""What a program with macro statements consists of: lines of statements, and stretches of plain text between them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypeAlias

from polycnc.language import Flaw, Loop, Mark, Tree


@dataclass(frozen=True, slots=True)
class Number:
    """A number as it stands."""

    at: int
    value: float
    point: bool = True


@dataclass(frozen=True, slots=True)
class Variable:
    """A variable by its number, or by an expression that gives the number."""

    at: int
    number: int
    index: Expression | None = None


@dataclass(frozen=True, slots=True)
class Name:
    """The number of a variable by the name that SETVN gave it, as in `#[DEPTH]`."""

    at: int
    text: str


@dataclass(frozen=True, slots=True)
class Function:
    """A function and what it is applied to."""

    at: int
    name: str
    arguments: tuple[Expression, ...]


Expression: TypeAlias = Tree[Number | Variable | Function | Name]


@dataclass(frozen=True, slots=True)
class Assignment:
    """`#1=...`; `text` is the comment after it, which is the text of an alarm or a message."""

    at: int
    target: Variable
    value: Expression
    text: str = ""


@dataclass(frozen=True, slots=True)
class Goto:
    """`GOTO n`, or M99 P n; `target` is the block number."""

    at: int
    target: Expression
    returns: bool = False


@dataclass(frozen=True, slots=True)
class If:
    """`IF [...] GOTO n` or `IF [...] THEN #1=...`."""

    at: int
    condition: Expression
    then: Assignment | Goto


@dataclass(slots=True)
class While(Loop):
    """`WHILE [...] DO m`, `DO m` without a condition; `line` and `label` are those of its block."""

    at: int
    loop: int
    condition: Expression | None
    line: int = 0
    label: int | None = None
    body: list[Part | Mark | While] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class End:
    """`END m`."""

    at: int
    loop: int


@dataclass(frozen=True, slots=True)
class Address:
    """A word of an NC block: its letter and the expression of its number, `missing` an address without one."""

    at: int
    letter: str
    value: Expression


@dataclass(frozen=True, slots=True)
class Words:
    """An NC block with something to calculate."""

    at: int
    words: tuple[Address, ...]


@dataclass(frozen=True, slots=True)
class MacroCall:
    """`G65 P...` (`modal` False) or `G66 P...`, or a code that calls `program`; `arguments` as they stand."""

    at: int
    program: Expression
    repeats: Expression | None
    arguments: tuple[Address, ...]
    before: tuple[Address, ...] = ()
    modal: bool = False
    by_code: bool = False
    each: bool = False


@dataclass(frozen=True, slots=True)
class Interrupt:
    """`M96 P...`: the program that the interrupt signal calls from now on; `M97` has none."""

    at: int
    program: Expression | None


@dataclass(frozen=True, slots=True)
class Printed:
    """A value in an output: its expression, and how many digits before and after the point are put out."""

    value: Expression
    whole: int
    decimals: int


@dataclass(frozen=True, slots=True)
class Output:
    """`DPRNT[...]` or `BPRNT[...]`: texts and values in their order."""

    at: int
    binary: bool
    pieces: tuple[str | Printed, ...]


@dataclass(frozen=True, slots=True)
class Device:
    """`POPEN` or `PCLOS`."""

    at: int
    opens: bool


@dataclass(frozen=True, slots=True)
class Names:
    """`SETVN n[...]`: names of variables from a number on."""

    at: int
    first: int
    names: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class SubCall:
    """An M or T code that calls a sub-program without arguments, after the other words of its block."""

    at: int
    program: int
    repeats: Expression | None
    words: tuple[Address, ...]
    tool: Expression | None = None


@dataclass(frozen=True, slots=True)
class Cancel:
    """`G67`, after the other words of its block."""

    at: int
    words: tuple[Address, ...]


@dataclass(frozen=True, slots=True)
class Restart:
    """M99 in a main program that repeats."""

    at: int


class Refusal(Flaw):
    """Something wrong with a statement, which the control notices when it executes it."""


@dataclass(frozen=True, slots=True)
class Refused:
    """What is left of a loop without its other end: executed it is refused."""

    at: int
    flaw: Refusal


Statement: TypeAlias = (
    Assignment
    | Goto
    | If
    | While
    | End
    | Words
    | MacroCall
    | SubCall
    | Cancel
    | Restart
    | Interrupt
    | Output
    | Device
    | Names
    | Refused
)


@dataclass(frozen=True, slots=True)
class Line:
    """One line of statements: its number, where it begins, its block number and the level of its skip mark."""

    line: int
    offset: int
    label: int | None
    skip: int
    statements: tuple[Statement, ...]

    @property
    def at(self) -> int:
        """Where it begins."""
        return self.offset


@dataclass(frozen=True, slots=True)
class Span:
    """Lines of plain text from byte `offset` to byte `end`."""

    line: int
    offset: int
    end: int

    @property
    def at(self) -> int:
        """Where they begin."""
        return self.offset


Part: TypeAlias = Line | Span
