"""``polycnc lsp``: what an editor asks while a program is written."""

from __future__ import annotations

import sys

from polycnc.cli import _options as options
from polycnc.cli._errors import PROGRAM


def lsp_command(machine: options.Machine = None, dialect: options.Dialect = None) -> None:
    """Serve an editor by the Language Server Protocol, on standard input and output."""
    from polycnc.editor import serve_editor
    from polycnc.machine import load_machine
    from polycnc.nc import load_dialect

    served = serve_editor(
        None if machine is None else load_machine(machine), None if dialect is None else load_dialect(dialect)
    )
    if not served:
        sys.exit(PROGRAM)
