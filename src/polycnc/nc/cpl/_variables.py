"""Names of variables: which of their characters count, and what type they have (Manual 003, 2.4.3)."""

from __future__ import annotations

import re
from functools import lru_cache
from typing import Literal, NamedTuple, TypeAlias

from polycnc.language import Flaw, Token
from polycnc.units import whole

Kind: TypeAlias = Literal["I", "R", "D", "B", "S", "X", "N"]
"""Types of values: INTEGER, REAL, DOUBLE, BOOLEAN, string, known only while the program runs, NUL."""
Scope: TypeAlias = Literal["local", "global", "permanent", "parameter"]

SUFFIXES: dict[str, Kind] = {"%": "I", "!": "D", "?": "B", "$": "S"}
MARKS: dict[Kind, str] = {kind: suffix for suffix, kind in SUFFIXES.items()}
KIND_NAMES: dict[Kind, str] = {
    "I": "INTEGER", "R": "REAL", "D": "DOUBLE", "B": "BOOLEAN", "S": "a string", "X": "a value", "N": "NUL",
}  # fmt: skip
PERMANENT_NUMBERS = 100
PERMANENT_FIELD = "@_R"
_INTERNAL = ("@_RES_DOUBLE", "@_RES_DWORD")
_SIGNIFICANT = 8
SIGNIFICANT_PERMANENT = 16
"""How many characters of a permanent name count, @ among them: so the manual computes the memory of @_R."""
_PARAMETER = re.compile(r"P([0-9]{1,3})[A-Z_]*")
_NUMBERED = re.compile(r"@([0-9]+)[A-Z_]*%?")


class Variable(NamedTuple):
    """A variable: its name with only the characters that count and the mark of its type, what it is and holds."""

    name: str
    scope: Scope
    kind: Kind

    @property
    def python(self) -> str:
        """Return the variable as Python."""
        if self.scope == "global":
            return f"G[{self.name!r}]"
        if self.scope == "permanent":
            return f"M[{self.name!r}]"
        return f"v_{self.kind}_{self.name.rstrip('%!?$')}"


def variable(token: Token) -> Variable:
    """Return the variable that a name stands for.

    Raises:
        Flaw: It is a permanent variable that does not exist or must not be used.
    """
    word = token.word
    if word[0] == "@":
        return _permanent(token, word.rstrip("%!?$"), SUFFIXES.get(word[-1], "R"))
    return _other(word)


@lru_cache(maxsize=4096)
def _other(word: str) -> Variable:
    """Return the variable of a name that does not begin with @."""
    kind: Kind = SUFFIXES.get(word[-1], "R")
    base = word.rstrip("%!?$")
    if found := _PARAMETER.fullmatch(base):
        return Variable(f"P{whole(found[1])}{MARKS.get(kind, '')}", "parameter", kind)
    name = base[:_SIGNIFICANT] + MARKS.get(kind, "")
    return Variable(name, "global" if word[0] == "#" else "local", kind)


def variable_at(at: int, word: str) -> Variable:
    """Return the variable of a name at an offset.

    Raises:
        Flaw: There is none.
    """
    return variable(Token("name", word, word, at))


def _permanent(token: Token, base: str, kind: Kind) -> Variable:
    if numbered := _NUMBERED.fullmatch(token.word):
        digits = numbered[1].lstrip("0")
        if not digits or len(digits) > 3 or int(digits) > PERMANENT_NUMBERS:
            raise Flaw(
                token.at,
                f"there is no permanent variable {token.text[:20]}",
                f"they are @1 to @{PERMANENT_NUMBERS}",
            )
        return Variable(f"@{int(digits)}", "permanent", "I")
    if base in _INTERNAL:
        raise Flaw(token.at, f"{base} is reserved for the control itself", "use a variable of your own")
    if base == PERMANENT_FIELD:
        return Variable(base, "permanent", "D")
    if not base[1:2].isalpha():
        raise Flaw(token.at, f"{token} is no variable", "a number or a capital letter follows @")
    return Variable(base[:SIGNIFICANT_PERMANENT] + MARKS.get(kind, ""), "permanent", kind)
