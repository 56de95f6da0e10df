"""Texts of DEBUG, PRINT and ABORT with the values of parameters in them.

Source: LinuxCNC G-code manual, Overview, "Debug Messages", "Print Messages", "Abort Messages", "Comment Parameters".
"""

from __future__ import annotations

import re
from functools import partial

from polycnc.nc.rs274._functions import NumberError
from polycnc.nc.rs274._line import bare
from polycnc.nc.rs274._parameters import DEBUGS, Parameters

_PART = re.compile(r"%(?:d|f|\.[0-9]f)|#<[^>]*>|#[0-9]+")
_FORMATS = {"%d": "{:.0f}", "%f": "{:.4f}"}
_AS_THEY_ARE = "{:f}"
_UNKNOWN = "######"
_ZERO = 1e-4
_MOST_DIGITS = 9


def text_python(text: str, line: int) -> str:
    """Return Python of a text: `%d`, `%f` and `%.3f` say how the parameters after them are written."""
    parts: list[str] = []
    at, form = 0, _AS_THEY_ARE
    for found in _PART.finditer(text):
        parts.append(repr(text[at : found.start()]))
        at = found.end()
        part = found[0]
        if part[0] == "%":
            form = _FORMATS.get(part, f"{{:{part[1:]}}}")
        elif part[1] != "<":
            parts.append(f"shown({int(part[1 : 1 + _MOST_DIGITS])}, L, {form!r})")
        elif (name := bare(part[2:-1])) == "_line":
            parts.append(repr(form.format(line)))
        else:
            parts.append(f"shown({name!r}, N, {form!r})")
    return " + ".join([*parts, repr(text[at:])])


def text_functions(parameters: Parameters) -> dict[str, object]:
    """Return what the Python of texts calls."""
    return {
        "shown": partial(shown, parameters),
        "debugs": lambda: parameters.get(DEBUGS, []) > 0.0,
        "abort": aborted,
    }


def shown(parameters: Parameters, which: str | int, own: dict[str, float] | list[float], form: str) -> str:
    """Return how a parameter is written in a text; `own` are the names or the numbers of its sub-program."""
    try:
        if isinstance(own, dict):
            name = str(which)
            value = parameters.named(name) if name.startswith("_") else own[name]
        else:
            value = parameters.get(float(which), own)
    except (NumberError, KeyError):
        return _UNKNOWN
    return form.format(0.0 if abs(value) < _ZERO else value)


def aborted(text: str) -> None:
    """Refuse to go on, as an ABORT asks for.

    Raises:
        NumberError: always.
    """
    raise NumberError(text.strip() or "(ABORT,)", "The program stops itself here: (ABORT,...).")
