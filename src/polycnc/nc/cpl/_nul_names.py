"""Which variable has no value where a program needs one: asked for when that has gone wrong."""

from __future__ import annotations

import re
from collections.abc import Mapping
from types import FrameType
from typing import Any

from polycnc.nc.cpl._program import Program
from polycnc.nc.cpl._variables import Variable

_TARGET = re.compile(r"^\s*([\w.]+(?:\[[^=]*?\])?) = (?:put\(\1, )?")
"""What is assigned to may have no value; a text is put into it."""
_SHARED = {"global": "G", "permanent": "M"}


def nul_name(error: BaseException, program: Program) -> str:
    """Return the first variable without a value on the line of Python that an error came from, "" if there is none."""
    found = _frame(error, program.traced.name)
    if found is None:
        return ""
    frame, number = found
    line = _TARGET.sub("", program.traced.lines[number - 1])
    places = {each: re.search(rf"(?<!\w){re.escape(each.python)}(?!\w)", line) for each in program.variables}
    named = sorted((place.start(), each) for each, place in places.items() if place is not None)
    return next((each.name for _, each in named if _is_nul(each, frame.f_locals)), "")


def _frame(error: BaseException, name: str) -> tuple[FrameType, int] | None:
    found, trace = None, error.__traceback__
    while trace is not None:
        if trace.tb_frame.f_code.co_filename == name:
            found = trace.tb_frame, trace.tb_lineno
        trace = trace.tb_next
    return found


def _is_nul(variable: Variable, names: Mapping[str, Any]) -> bool:
    if variable.scope in _SHARED:
        return names.get(_SHARED[variable.scope], {}).get(variable.name) is None
    return names.get(variable.python) is None
