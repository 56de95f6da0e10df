"""The NC block that is selected in the editor: what INP#(0,...) reads and PRN#(0,...) writes (Manual 003, 7.2)."""

from __future__ import annotations

import re

from polycnc.nc.cpl import Box, Fault

CALL = re.compile(
    r"[ \t]*(?:N[ \t]*[0-9]+)?[ \t]*(?:P[ \t]*([A-Z_][\w.]*)|([A-Z][ \t]*[0-9]+))[ \t]*(?:\[(.*)\])?",
    re.IGNORECASE,
)
"""A block that calls a sub-program: name after P, or code; arguments."""
_ARGUMENT = re.compile(r'(?:"[^"]*"|[^,"])*')
_LOGICAL = {"TRUE": True, "FALSE": False}


class SelectedBlock:
    """The block that is selected in the editor while a dialog program runs for it; PRN#(0,...) changes `text`."""

    def __init__(self, text: str) -> None:
        self.text = text

    def read(self, *variables: object) -> None:
        """Put the arguments of its call into numeric and logical variables; one that has none becomes NUL.

        Raises:
            Fault: A variable is a text.
        """
        found = CALL.match(self.text)
        arguments = [] if found is None or not found[3] else _separated(found[3])
        for place, variable in enumerate(variables):
            if not isinstance(variable, Box) or variable.kind == "S":
                raise Fault("INVALID PARAMETER", "INP#(0,...) reads into numeric and logical variables")
            variable.value = _value(arguments[place], variable.kind) if place < len(arguments) else None


def _separated(text: str) -> list[str]:
    """Return what commas separate, texts in quotes as a whole."""
    found, at = [], 0
    while at <= len(text):
        match = _ARGUMENT.match(text, at)
        end = match.end() if match else at
        found.append(text[at:end].strip())
        at = max(end, text.find(",", end) if "," in text[end:] else len(text)) + 1
    return found


def _value(argument: str, kind: str) -> int | float | bool | None:
    if kind == "B":
        return _LOGICAL.get(argument.upper())
    if not re.fullmatch(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)", argument):
        return None
    return float(argument) if kind != "I" else int(argument) if argument.lstrip("+-").isdigit() else None


NO_BLOCK = SelectedBlock("")
