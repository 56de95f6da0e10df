"""Character fields, references to their parts, and the functions of texts (Manual 003, chapter 5)."""

from __future__ import annotations

import re
from typing import TypeAlias

from polycnc.nc.cpl._faults import (
    CHARACTER_FIELD_NOT_ASSIGNED,
    INADMISSIBLE_STRING,
    INVALID_ASSIGNMENT,
    INVALID_FIELD_LIMIT,
    INVALID_PARAMETER,
    INVALID_VARIABLE,
    Fault,
)
from polycnc.nc.cpl._formats import default_format, in_format
from polycnc.nc.cpl._function import Takes, function
from polycnc.nc.cpl._numbers import HIGHEST, not_assigned

LONGEST = 1024
_VALUE = re.compile(r" *([+-]?)[ 0]*([0-9]*)(\.?)([0-9]*)")


class CharacterField:
    """A dimensioned string: up to `size` characters, of which `text` are assigned (None: none ever was)."""

    __slots__ = ("size", "text")

    def __init__(self, size: int) -> None:
        self.size = size
        self.text: str | None = None

    def assign(self, text: str | None) -> None:
        """Take a text, as far as it fits."""
        self.text = text if text is None else text[: self.size]

    def overwrite(self, start: int, number: int | None, text: str | None) -> None:
        """Write a text over the characters from `start` on, at most `number` of them.

        Raises:
            Fault: The place lies after the assigned characters and the one that follows.
        """
        if text is None:
            raise not_assigned()
        old = self.text or ""
        if start > len(old) + 1:
            raise Fault(
                CHARACTER_FIELD_NOT_ASSIGNED,
                f"{len(old)} characters are assigned; write from the next one on",
            )
        part = text if number is None else text[:number]
        self.text = (old[: start - 1] + part + old[start - 1 + len(part) :])[: self.size]


class Part:
    """What a string variable without dimension holds: a place and a length in a character field."""

    __slots__ = ("begin", "field", "length")

    def __init__(self, field: CharacterField, begin: int, length: int) -> None:
        self.field = field
        self.begin = begin
        self.length = length


class Section:
    """A part of a character field that a command fills: from character `start` on, `length` of them."""

    __slots__ = ("_start", "field", "length")

    def __init__(self, field: CharacterField, start: int, length: int) -> None:
        self.field = field
        self._start = start
        self.length = length

    def write(self, text: str) -> None:
        """Write a text over it.

        Raises:
            Fault: The field has fewer characters before it.
        """
        self.field.overwrite(self._start, self.length, text)


class Unlinked:
    """A text from a program that was not linked: only PDIM makes room for it."""

    __slots__ = ("text",)

    def __init__(self, text: str) -> None:
        self.text = text


Stored: TypeAlias = CharacterField | Part | Unlinked | str | None


def text_of(value: object) -> str | None:
    """Return the text that a variable or expression has now, None for NUL.

    Raises:
        Fault: It is no text.
    """
    if value is None or value.__class__ is str:
        return value
    if value.__class__ is CharacterField:
        return value.text
    if value.__class__ is Part:
        whole: str | None = value.field.text
        part = (whole or "")[value.begin : value.begin + value.length]
        return part or (None if value.length else "")
    if value.__class__ is Unlinked:
        raise _no_room()
    raise Fault(INVALID_ASSIGNMENT, "a text is needed")


def put(old: Stored, value: Stored) -> Stored:
    """Return what a string variable holds after a text that exists already is assigned to it."""
    if isinstance(old, CharacterField):
        old.assign(text_of(value))
        return old
    if isinstance(value, CharacterField):
        return None if value.text is None else Part(value, 0, len(value.text))
    if isinstance(value, Unlinked):
        raise _no_room()
    return value


def put_new(old: Stored, value: str | None) -> Stored:
    """Return what a string variable holds after a text is assigned to it that needs room of its own.

    Raises:
        Fault: The variable has no dimension, so it has no room.
    """
    if not isinstance(old, CharacterField):
        raise Fault(INADMISSIBLE_STRING, "dimension it with DIM before")
    old.assign(value)
    return old


def put_part(target: Stored, start: object, number: object, value: str | None) -> None:
    """Write into a character field by MID$.

    Raises:
        Fault: The target has no dimension, or the place is outside.
    """
    if not isinstance(target, CharacterField):
        raise Fault(INADMISSIBLE_STRING, "dimension it with DIM before")
    target.overwrite(_place(start), None if number is None else _place(number), value)


def dimension(old: object, size: int) -> CharacterField:
    """Return a character field of a size; one that has this size already is kept.

    Raises:
        Fault: Another size is in force.
    """
    if not isinstance(old, CharacterField):
        return CharacterField(size)
    if old.size != size:
        raise Fault(INVALID_FIELD_LIMIT, f"it was dimensioned with {old.size} before")
    return old


@function("MID$(text,start[,number])", "S", Takes.STORED, Takes.PLACE, Takes.PLACE, settable=True)
def middle(value: Stored, start: object, number: object = None) -> Stored:
    """Return a part of a text: of a character field as a reference to it."""
    begin = _place(start) - 1
    length = LONGEST if number is None else _place(number)
    if isinstance(value, CharacterField):
        length = min(length, len(value.text or "") - begin)
        return Part(value, begin, length) if length > 0 else None
    if isinstance(value, Part):
        length = min(length, value.length - begin)
        return Part(value.field, value.begin + begin, length) if length > 0 else None
    return (text_of(value) or "")[begin : begin + length] or None


def section(target: Stored, start: object, number: object = None) -> Section:
    """Return a part of a text to be set (MID$ as a variable of INP#).

    Raises:
        Fault: The target has no dimension, or the place is outside.
    """
    if not isinstance(target, CharacterField):
        raise Fault(INADMISSIBLE_STRING, "dimension it with DIM before")
    return Section(target, _place(start), target.size if number is None else _place(number))


@function('TRIM$(text[,"L" or "R"])', "S", Takes.STORED, Takes.LETTER)
def trimmed(value: Stored, side: object = None) -> Stored:
    """Return a text without blanks at its ends, or at the left or right one: of a character field as a reference to it.

    Raises:
        Fault: The side is neither "L" nor "R".
    """
    if side not in (None, "L", "R"):
        raise Fault(INVALID_PARAMETER, 'TRIM$ takes "L" or "R"')
    text = text_of(value)
    if text is None:
        return None
    first = 0 if side == "R" else len(text) - len(text.lstrip(" "))
    last = len(text) if side == "L" else len(text.rstrip(" "))
    length = max(last - first, 0)
    if isinstance(value, CharacterField):
        return Part(value, first, length)
    if isinstance(value, Part):
        return Part(value.field, value.begin + first, length)
    return text[first : first + length]


@function("LEN(text)", "I", Takes.TEXT)
def length(text: str | None) -> int:
    """Return the number of characters, -1 for NUL."""
    return -1 if text is None else len(text)


@function("INSTR(wanted,text[,start])", "I", Takes.TEXT, Takes.TEXT, Takes.PLACE)
def position(wanted: str | None, text: str | None, start: object = None) -> int:
    """Return where a text is found in another from a place on, 0 if it is not."""
    begin = 0 if start is None else _place(start) - 1
    if wanted is None or text is None:
        return 0
    return text.find(wanted, begin) + 1


@function("ASC(text)", "I", Takes.TEXT)
def code(text: str | None) -> int:
    """Return the code of the first character, -1 if there is none."""
    return ord(text[0]) if text else -1


@function("CHR$(code)", "S", Takes.INTEGER)
def character(value: object) -> str:
    """Return the character of a code.

    Raises:
        Fault: No character has this code.
    """
    if value is None:
        raise not_assigned()
    if value.__class__ is not int or not 0 <= value <= 255:
        raise Fault(INVALID_PARAMETER, "codes of characters are INTEGER, 0 to 255")
    return chr(value)


@function("STR$([format,]value)", "S", Takes.TEXT, Takes.PRINTED, new_text=True)
def written(form: str | None, kind: str, value: float | None) -> str:
    """Return a number as text.

    Raises:
        Fault: It does not fit the format, or there is none in it.
    """
    if value is None:
        raise not_assigned()
    text = default_format(kind, value) if form is None else in_format(form, value)
    if text is None:
        raise Fault("FORMAT NOT PERMITTED", "use # for the digits, with a decimal point where there is one")
    return text


@function("VAL(text)", "X", Takes.TEXT)
def number(text: str | None) -> int | float | None:
    """Return the number at the beginning of a text, NUL if there is none.

    Raises:
        OverflowError: It is too large.
    """
    found = _VALUE.match(text or "")
    if found is None:
        return None
    sign, digits, point, decimals = found.groups()
    zeros = "0" in found[0][: found.end(2)]
    if not (digits or decimals or zeros):
        return None
    if point:
        value = float(f"{sign}{digits or '0'}.{decimals or '0'}")
        if value - value:
            raise OverflowError
        return value
    if len(digits) > 10 or int(digits or "0") > HIGHEST + (sign == "-"):
        raise OverflowError
    return int(f"{sign}{digits or '0'}")


def added(*texts: str | None) -> str:
    """Return texts as one.

    Raises:
        Fault: One of them is NUL.
    """
    found = [text for text in texts if text is not None]
    if len(found) < len(texts):
        raise not_assigned()
    return "".join(found)


def _no_room() -> Fault:
    what = INVALID_VARIABLE._replace(what="invalid variable")
    return Fault(what, "write PDIM before: the caller is not linked")


def _place(value: object) -> int:
    if value is None:
        raise not_assigned()
    if value.__class__ is not int or not 1 <= value <= LONGEST:
        raise Fault(INVALID_PARAMETER, f"places and numbers of characters are INTEGER, 1 to {LONGEST}")
    return value
