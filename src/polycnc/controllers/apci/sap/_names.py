"""What names mean, and what all of the compiler shares: the list of instructions and errors with a place."""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

from polycnc.controllers.apci.sap import _commands
from polycnc.controllers.apci.sap._commands import BOOLEAN, DOUBLE
from polycnc.controllers.apci.sap._lexer import SourceText
from polycnc.controllers.apci.sap._program import Instruction
from polycnc.controllers.apci.sap._syntax import Place, Routine
from polycnc.errors import ProgramError


@dataclass(frozen=True, slots=True)
class ConstantSymbol:
    """A name for a value."""

    value: int | float | bool
    kind: str


@dataclass(frozen=True, slots=True)
class VariableSymbol:
    """A variable: its first cell in the memory or in the frame; `bounds` for an array."""

    kind: str
    local: bool
    cell: int
    bounds: tuple[int, int] | None = None

    @property
    def where(self) -> str:
        """Return the letter that ends the instructions for this kind of storage."""
        return "l" if self.local else "g"


@dataclass(frozen=True, slots=True)
class RoutineSymbol:
    """A procedure or function by its index."""

    index: int
    routine: Routine


Symbol = ConstantSymbol | VariableSymbol | RoutineSymbol

PREDEFINED = {
    "true": ConstantSymbol(True, BOOLEAN),
    "false": ConstantSymbol(False, BOOLEAN),
    "pi": ConstantSymbol(math.pi, DOUBLE),
}


@dataclass
class NameCompiler:
    """Hold what is declared, and the instructions so far."""

    source: SourceText
    code: list[Instruction] = field(default_factory=list)
    globals: dict[str, Symbol] = field(default_factory=lambda: dict(PREDEFINED))
    locals: dict[str, Symbol] = field(default_factory=dict)
    line: int = 1
    in_condition: bool = False

    # Instructions

    def emit(self, operation: str, argument: Any = None) -> int:
        """Append an instruction and return where it is."""
        self.code.append((operation, argument, self.line))
        return len(self.code) - 1

    def patch(self, at: int) -> None:
        """Let the jump at `at` lead to the next instruction."""
        operation, _, line = self.code[at]
        self.code[at] = (operation, len(self.code), line)

    def error(self, at: Place, what: str, hint: str) -> ProgramError:
        """Return an error at a place of the source."""
        return self.source.error(at, what, hint)

    # Names

    def symbol(self, name: str) -> Symbol | None:
        """Return what the program has declared under a name."""
        return self.locals.get(name.lower()) or self.globals.get(name.lower())

    def is_known(self, name: str) -> bool:
        """Return whether a name stands for a value, so that it is no axis."""
        low = name.lower()
        known = self.symbol(name) is not None or low in _commands.SYSTEM_VARIABLES
        return known or _commands.common_variable(low) is not None

    def unknown(self, at: Place, name: str, what: str, candidates: Iterable[str]) -> ProgramError:
        """Return the error about a name that nobody declared, with the nearest names there are."""
        near = difflib.get_close_matches(name.lower(), sorted(set(candidates)), n=2)
        hint = (
            f"Did you mean {' or '.join(near)}?"
            if near
            else f"Correct the {what}, or declare it if it is yours."
        )
        return self.error(at, f"unknown {what} '{name}'", hint)
