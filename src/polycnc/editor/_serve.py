"""Serve an editor on standard input and output; whether the package for that is there."""

from __future__ import annotations

import logging
import os
import sys

from polycnc.errors import UsageError
from polycnc.machine import MachineConfig
from polycnc.nc import Dialect

_NEEDED = ("pygls", "lsprotocol")


def serve_editor(machine: MachineConfig | None = None, dialect: Dialect | None = None) -> bool:
    """Speak the Language Server Protocol on standard input and output; return whether the editor ended it in order.

    Whatever else is printed meanwhile goes to standard error, as it would be no message of the protocol.

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
    logging.getLogger("pygls").addHandler(logging.NullHandler())  # what is refused is answered, and no fault
    server = editor_server(machine, dialect)
    sys.stdout.flush()
    out = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    with out:
        server.start_io(sys.stdin.buffer, out)
    return server.was_shut_down
