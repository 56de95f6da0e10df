"""What has been read of a program: its statements, and the structures that are open."""

from __future__ import annotations

from typing import TypeAlias

from polycnc.language import Flaw, Mark
from polycnc.nc.cpl._faults import NESTING_TOO_DEEP
from polycnc.nc.cpl._syntax import Case, For, If, Repeat, Statement, While

Structure: TypeAlias = If | For | While | Repeat | Case
_CLOSERS = {If: "ENDIF", For: "NEXT", While: "END", Repeat: "UNTIL", Case: "ENDCASE"}
_STRUCTURES = 100


class Structures:
    """The statements at the `top` of a program; the next one goes into `body`."""

    def __init__(self) -> None:
        self.top: list[Statement] = []
        self.open: list[Structure] = []
        self.flaws: list[Flaw] = []
        self.body = self.top
        self._bodies: list[list[Statement]] = []

    def begin(self, structure: Structure, body: list[Statement]) -> None:
        """Open a structure, whose first statements go into a body of it.

        Raises:
            Flaw: Too many are open.
        """
        self.body.append(structure)
        if len(self.open) >= _STRUCTURES:
            raise Flaw(structure.at, NESTING_TOO_DEEP.what, f"at most {_STRUCTURES} structures", code="2153")
        self.open.append(structure)
        self._bodies.append(self.body)
        self.body = body

    def top_of(self, kind: type[Structure], keyword: str, at: int) -> Structure:
        """Return the innermost open structure, which `keyword` belongs to.

        Raises:
            Flaw: It is of another kind.
            Consequence: That may come from a line that could not be read.
        """
        if not self.open or not isinstance(self.open[-1], kind):
            if self.flaws:
                raise Consequence
            inside = f"; open is {type(self.open[-1]).__name__.upper()}" if self.open else ""
            raise Flaw(at, f"{keyword} without its {kind.__name__.upper()}{inside}")
        return self.open[-1]

    def finish(self, kind: type[Structure], keyword: str, at: int) -> Structure:
        """Close the innermost structure.

        Raises:
            Flaw, Consequence: As `top_of`.
        """
        structure = self.top_of(kind, keyword, at)
        self.open.pop()
        self.body = self._bodies.pop()
        return structure

    def ended(self) -> list[Flaw]:
        """Return what is wrong at the end of the program: also what is open, where every line could be read."""
        if not self.flaws:
            self.flaws += [
                Flaw(each.at, f"the {type(each).__name__.upper()} has no {_CLOSERS[type(each)]}")
                for each in self.open
            ]
        return self.flaws


class Consequence(Exception):  # noqa: N818 (never leaves the reader)
    """Something is wrong that may come from what was wrong before."""


class Unreachable(list[Statement]):
    """Between CASE and its first LABEL: only places to jump to may stand there."""

    def __init__(self, flaws: list[Flaw]) -> None:
        super().__init__()
        self._flaws = flaws

    def append(self, statement: Statement) -> None:
        """Take a place to jump to; another statement is noted as wrong."""
        if not isinstance(statement, Mark):
            self._flaws.append(Flaw(statement.at, "an instruction between CASE and its first LABEL"))
