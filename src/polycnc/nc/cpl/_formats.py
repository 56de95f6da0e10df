"""How numbers are written: without a format by their type, else digit by digit (Manual 003, STR$, PRN#, DSP)."""

from __future__ import annotations

import re

_GROUP = re.compile(r"#+(?:\.#+)?|\.#+")
_WIDTHS = {"I": (9, 0), "R": (8, 3), "D": (16, 6)}


def default_format(kind: str, value: float) -> str:
    """Return a number as its type is written: INTEGER 9 places, REAL 4 and 3, DOUBLE 9 and 6."""
    width, decimals = _WIDTHS["D" if kind == "X" else kind]
    return _fixed(value, width, decimals) if decimals else f"{value:{width}d}"


def groups(form: str) -> list[tuple[int, int]]:
    """Return where the places for numbers in a text begin and end."""
    return [found.span() for found in _GROUP.finditer(form)]


def number_in(group: str, value: float) -> str | None:
    """Return a number in a group of digit places, None if it does not fit."""
    decimals = len(group) - group.index(".") - 1 if "." in group else 0
    text = _fixed(value, len(group), decimals)
    if group[0] == "." and text[0] == "0":  # no place before the point
        text = text[1:]
    return text if len(text) == len(group) else None


def in_format(form: str, value: float) -> str | None:
    """Return a text with a number in its first group of digit places, None without one or if it does not fit."""
    places = groups(form)
    if not places:
        return None
    begin, end = places[0]
    written = number_in(form[begin:end], value)
    return None if written is None else form[:begin] + written + form[end:]


def _fixed(value: float, width: int, decimals: int) -> str:
    """Return a number with decimals; what is rounded to 0 has no sign."""
    text = f"{value:{width}.{decimals}f}"
    return text if float(text) else f"{0.0:{width}.{decimals}f}"
