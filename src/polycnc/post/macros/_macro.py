"""A macro as a tree: lines that become blocks, and IFs around lines (Manual 001, 8)."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import TypeAlias

from polycnc.language import Flaw
from polycnc.post.macros._elements import Element, Text, read_elements
from polycnc.post.macros._expression import Condition, read_condition

NESTED_IFS = 10
"""How deep IFs may be nested (Manual 001, 8)."""


@dataclass(frozen=True, slots=True)
class Line:
    """A line that may become a block; `number` counts the macro's lines from 1."""

    number: int
    elements: tuple[Element, ...]


@dataclass(slots=True)
class Branch:
    """What runs if a condition holds; ELSE has none."""

    number: int
    condition: Condition | None
    body: list[Statement] = field(default_factory=list)


@dataclass(slots=True)
class If:
    """The branches of an IF: the first whose condition holds runs."""

    branches: list[Branch]


Statement: TypeAlias = Line | If

_UNREAD = Condition(0, ())
_CONTROL = re.compile(r"[ \t]*(IF|ELSE[ \t]*IF|ELSE|ENDIF)(?=[ \t(]|$)", re.IGNORECASE)


def read_macro(text: str) -> tuple[list[Statement], list[Flaw]]:
    """Return the statements of a macro and all that is wrong with its lines."""
    reader = _Reader()
    for number, line in enumerate(text.split("\n"), 1):
        try:
            reader.line(number, line.removesuffix("\r"))
        except Flaw as flaw:
            flaw.line = number
            reader.flaws.append(flaw)
    for opened in reader.open:
        number = opened.branches[0].number
        reader.flaws.append(Flaw(0, "the IF has no ENDIF", "write ENDIF after its last line", line=number))
    return reader.top, reader.flaws


def elements_of(statements: Iterable[Statement]) -> Iterable[Element]:
    """Yield every element of statements, those within branches too."""
    for statement in statements:
        if isinstance(statement, Line):
            yield from statement.elements
        else:
            for branch in statement.branches:
                yield from elements_of(branch.body)


def is_blank(element: Element) -> bool:
    """Tell whether an element is blanks without quotes: written as they stand, but no block alone."""
    return isinstance(element, Text) and not element.quoted and not element.text.strip(" \t")


class _Reader:
    def __init__(self) -> None:
        self.top: list[Statement] = []
        self.open: list[If] = []
        self.flaws: list[Flaw] = []

    def line(self, number: int, line: str) -> None:
        control = _CONTROL.match(line)
        if control is None:
            if line.strip(" \t"):
                self._body().append(Line(number, read_elements(line)))
            return
        word = control[1].upper()
        if word == "IF":
            self._if(number, line, control)
            return
        if not self.open:
            raise Flaw(
                control.start(1), f"{word} has no IF before it", "to output the word, put it in quotes"
            )
        if word in ("ELSE", "ENDIF") and line[control.end() :].strip(" \t"):
            raise Flaw(
                control.end(), f"{word} needs a line of its own", "put what follows into the next line"
            )
        if word == "ENDIF":
            self.open.pop()
        else:
            self._next_branch(number, line, control)

    def _if(self, number: int, line: str, control: re.Match[str]) -> None:
        branch = Branch(number, _UNREAD)
        statement = If([branch])
        self._body().append(statement)
        self.open.append(statement)
        if len(self.open) == NESTED_IFS + 1:
            raise Flaw(control.start(1), f"IFs are nested more than {NESTED_IFS} deep")
        branch.condition = read_condition(line, control.end())

    def _next_branch(self, number: int, line: str, control: re.Match[str]) -> None:
        branches = self.open[-1].branches
        closed = len(branches) > 1 and branches[-1].condition is None
        branch = Branch(number, None)
        branches.append(branch)
        if closed:
            raise Flaw(control.start(1), "an ELSE came before", "ELSE is the last branch of its IF")
        if control[1].upper() != "ELSE":
            branch.condition = _UNREAD  # so that it is no ELSE, whatever is wrong with the condition
            branch.condition = read_condition(line, control.end())

    def _body(self) -> list[Statement]:
        return self.open[-1].branches[-1].body if self.open else self.top
