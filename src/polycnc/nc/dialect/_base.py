"""A dialect that is another one, but for what its file says."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from polycnc.errors import ConfigurationError, did_you_mean
from polycnc.machine import Locator

CODE = re.compile(r"([GgMm])[ \t]*([0-9]{1,5}(?:\.[0-9])?)")
_OWN = ("name", "description", "extensions")
_BY_KEY = ("g", "m", "numbers", "arcs", "sub_program", "cycles", "text", "initial")
"""Tables whose keys are taken one by one; everything else is taken as a whole."""


def on_base(data: Mapping[str, Any], base: Mapping[str, Any], locator: Locator) -> dict[str, Any]:
    """Return what a file says, on what the dialect says that it names as its base.

    Raises:
        ConfigurationError: a code that is left out is not one of the base.
    """
    found = {key: value for key, value in base.items() if key not in (*_OWN, "base", "without")}
    without = data.get("without", [])
    for k, code in enumerate(without if isinstance(without, list) else []):
        table, number = _place(code)
        if number not in base.get(table, {}):
            name = base["name"]
            known = [f"{each.upper()}{code}" for each in "gm" for code in base.get(each, {})]
            raise ConfigurationError(
                f"'{code}' is no code of dialect '{name}'",
                hint=f"{did_you_mean(str(code), known)}Leave it out here.",
                position=locator.position(("without", k)),
            )
        found[table] = {each: action for each, action in found[table].items() if each != number}
    for key, value in data.items():
        both = key in _BY_KEY and isinstance(value, dict) and isinstance(found.get(key), dict)
        found[key] = {**found[key], **value} if both else value
    return found


def _place(code: object) -> tuple[str, str]:
    """Return the table of a code, and its key there."""
    parts = CODE.fullmatch(code.strip()) if isinstance(code, str) else None
    return ("", "") if parts is None else (parts[1].lower(), f"{float(parts[2]):g}")
