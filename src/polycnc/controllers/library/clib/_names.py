"""The module definition file of a library: its exports by their plain names."""

from __future__ import annotations

from polycnc.controllers.library.clib._slots import CLibrary


def write_definitions(library: CLibrary) -> str:
    """Return the file."""
    names = sorted((*library.functions, *library.aliases))
    return "\n".join((f"LIBRARY {library.name}.dll", "EXPORTS", *(f"    {name}" for name in names), ""))
