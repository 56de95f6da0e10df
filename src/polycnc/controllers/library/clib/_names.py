"""The module definition files of a library: its exports by their plain names."""

from __future__ import annotations

import ctypes

from polycnc.controllers.library._functions import Function
from polycnc.controllers.library.clib._slots import CLibrary, Way, slot_of

_STACK = 4


def write_definitions(library: CLibrary, *, decorated: bool = False) -> str:
    """Return the file; `decorated` with the names that a 32-bit compiler gives functions that clean their stack."""
    names = {name: name for name in library.functions} | dict(library.aliases)
    lines = [
        f"    {name}{_suffix(library, library.functions[inner]) if decorated else ''}"
        for name, inner in sorted(names.items())
    ]
    return "\n".join((f"LIBRARY {library.name}.dll", "EXPORTS", *lines, ""))


def _suffix(library: CLibrary, function: Function) -> str:
    """Return what follows a name: how many bytes the arguments take on the stack."""
    if not library.stdcall:
        return ""
    total = 0
    for each in function.arguments:
        way, element = slot_of(library, each)
        size = ctypes.sizeof(element) if way is Way.VALUE else _STACK
        total += -(-size // _STACK) * _STACK
    return f"@{total}"
