"""What goes wrong in CPL: the manual's error texts with their numbers, where it prints them."""

from __future__ import annotations

from typing import NamedTuple

__all__ = ["Fault"]


class Text(NamedTuple):
    """An error text of the manual and its number."""

    what: str
    code: str = ""


class Fault(Exception):  # noqa: N818 (never leaves the package: the run makes a ProgramError of it)
    """Something that goes wrong while a program runs; who raises it need not know where in the program."""

    def __init__(self, text: Text | str, hint: str = "") -> None:
        text = Text(text) if isinstance(text, str) else text
        super().__init__(text.what)
        self.what = text.what
        self.code = text.code
        self.hint = hint


ASSIGNMENT_MISSING = Text("= MISSING", "2167")
NESTING_TOO_DEEP = Text("NESTING TOO DEEP", "2153")
INVALID_FIELD_LIMIT = Text("INVALID FIELD LIMIT")
INVALID_PARAMETER = Text("INVALID PARAMETER")
INVALID_ASSIGNMENT = Text("INVALID ASSIGNMENT")
INVALID_VARIABLE = Text("INVALID VARIABLE")
CHARACTER_FIELD_NOT_ASSIGNED = Text("CHARACTER FIELD NOT ASSIGNED (CHARACTER AREA NOT USED)")
INADMISSIBLE_STRING = Text("inadmissible assignment to a non-dimensioned STRING variable")
CPL_IN_UNLINKED = Text("CPL elements in a sub-program excluded from linking")
