"""What goes wrong in CPL: the manual's error texts with their numbers, where it prints them."""

from __future__ import annotations

from typing import NamedTuple

from polycnc import language

__all__ = ["Fault"]


class Text(NamedTuple):
    """An error text of the manual and its number."""

    what: str
    code: str = ""


class Fault(language.Fault):
    """Something that goes wrong while a program runs; who raises it need not know where in the program."""

    def __init__(self, text: Text | str, hint: str = "") -> None:
        text = Text(text) if isinstance(text, str) else text
        super().__init__(text.what, hint, text.code)


ASSIGNMENT_MISSING = Text("= MISSING", "2167")
NESTING_TOO_DEEP = Text("NESTING TOO DEEP", "2153")
INVALID_FIELD_LIMIT = Text("INVALID FIELD LIMIT")
INVALID_PARAMETER = Text("INVALID PARAMETER")
INVALID_ASSIGNMENT = Text("INVALID ASSIGNMENT")
INVALID_VARIABLE = Text("INVALID VARIABLE")
CHARACTER_FIELD_NOT_ASSIGNED = Text("CHARACTER FIELD NOT ASSIGNED (CHARACTER AREA NOT USED)")
INADMISSIBLE_STRING = Text("inadmissible assignment to a non-dimensioned STRING variable")
CPL_IN_UNLINKED = Text("CPL elements in a sub-program excluded from linking")

ERRORS: dict[str, tuple[str, str]] = {
    ASSIGNMENT_MISSING.what: (
        "2167",
        "A word that is no instruction begins one, and no = follows: `GOTO10`.",
    ),
    NESTING_TOO_DEEP.what: (
        "2153",
        "Structures, parentheses or joined texts lie too deep inside each other.",
    ),
    INVALID_FIELD_LIMIT.what: (
        "",
        "A size of DIM, PDIM or a declaration, or an index, is outside its range.",
    ),
    INVALID_PARAMETER.what: ("", "An argument is outside of what the function takes."),
    INVALID_ASSIGNMENT.what: (
        "",
        "A value has not the type of its target; REAL needs INT or ROUND to become INTEGER.",
    ),
    INVALID_VARIABLE.what: (
        "",
        "A variable has no value (NUL), a field no dimension, a text handed over no room.",
    ),
    CHARACTER_FIELD_NOT_ASSIGNED.what: (
        "",
        "MID$ begins more than one character after the last assigned one.",
    ),
    INADMISSIBLE_STRING.what: ("", "A new text needs a string that DIM has given room."),
    CPL_IN_UNLINKED.what: ("", "A sub-program that DIN excludes from linking holds CPL."),
    "INVALID LOGICAL NUMBER": ("", "Files have the numbers 1 to 9, and are opened before and closed after."),
    "INVALID FILE NUMBER": ("", "FILEPOS, SEEK or FILESIZE names a file that is not open."),
    "INVALID FILE NAME": (
        "",
        "A name is none, leads out of the root, or is that of the control's own memory.",
    ),
    "FILE ALREADY OPEN": ("", "OPENW names a file that is open for writing, or a program that runs."),
    "FILE CANNOT BE READ": ("", "The system refuses it."),
    "FILE CANNOT BE WRITTEN": ("", "The system refuses it; file and records stay as they were."),
    "ILLEGAL FILE SIZE": ("", "OPENW reserves less than 130 bytes."),
    "INVALID COMPONENT LENGTH": (
        "",
        "Records have 1 to 1,024 characters, or those of the file another length.",
    ),
    "INVALID COMPONENT": ("", "There is no such byte or record."),
    "BLOCK EXCEEDS 1024 BYTES": ("", "PRN# writes a longer record."),
    "INVALID CHARACTER": ("", "A record cannot contain this character."),
    "INVALID INTEGER VALUE": ("", "INP# reads a number that is too large for INTEGER."),
    "INVALID FLOAT VALUE": ("", "INP# reads a number that is too large for REAL."),
    "FORMAT NOT PERMITTED": (
        "",
        "STR$ has a format without a place for a digit, or in which the number does not fit.",
    ),
    "format not permitted": ("", "DSP cannot show a value in its format."),
    "maximum string length exceeded": ("", "DSP shows a text of more than 77 characters."),
    "Invalid line or column number in CPL command": ("", "Lines are 1 to 46, columns 1 to 79."),
    "INP WITHOUT PRN": ("", "INP comes before the PRN that shows its place."),
    "the program waits for a key, and none is pressed": ("", "SFK or INP has no more keys (`--keys`)."),
    "NO PROBE POSITION": ("", "No probe has switched."),
    "no tool database is configured": ("", "TDA reads a table or sector that is not there."),
    "inconsistent data": ("", "A field of a tool takes another type, or a table in a file is damaged."),
    "division by zero": ("", "Test the divisor before."),
    "the value is out of the range of its type": ("", "INTEGER has 32 bits, REAL reaches 3.4E38."),
}
"""What a running program can end with: its number, "" where the manual prints none, and when."""
