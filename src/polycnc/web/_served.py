"""Modules and libraries as a server gives them: every import names a file that the server has, too."""

from __future__ import annotations

import re
from functools import cache

from polycnc.web._page import module_text
from polycnc.web._vendor import BARE, VENDOR, folder, libraries

_BARE_IMPORT = re.compile(rf"""\b(from|import)(\s*)(["'])({"|".join(BARE)})\3""")
_MODULES = (
    "body.js",
    "chart.js",
    "field.js",
    "format.js",
    "lines.js",
    "stage.js",
    "theme.js",
    "tool_shape.js",
)


@cache
def served_files() -> frozenset[str]:
    """Return the names of the files that a server can give, flat in one folder."""
    return frozenset(_MODULES) | {each.file for each in libraries()}


@cache
def served_text(name: str) -> str:
    """Return such a file; a library that is imported by its bare name is imported by its file's name."""
    if name.endswith(".css"):
        return (folder(VENDOR) / name).read_text("utf-8")
    return _BARE_IMPORT.sub(
        lambda found: f"{found[1]}{found[2]}{found[3]}./{BARE[found[4]]}{found[3]}", module_text(name)
    )
