"""Serve an editor on standard input and output; whether the package for that is there."""

from __future__ import annotations

from polycnc.errors import UsageError
from polycnc.machine import MachineConfig
from polycnc.nc import Dialect

_NEEDED = ("pygls", "lsprotocol")


def serve_editor(machine: MachineConfig | None = None, dialect: Dialect | None = None) -> None:
    """Speak the Language Server Protocol on standard input and output until the editor ends it.

    Raises:
        UsageError: pygls is not installed.
    """
    try:
        from polycnc.editor._shell import editor_server
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] not in _NEEDED:
            raise
        raise UsageError(
            "the language server needs pygls", hint="Install it: pip install 'polycnc[editor]'."
        ) from None
    editor_server(machine, dialect).start_io()
