"""Part programs that a command names: files, and standard input."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

from polycnc.errors import UsageError

if TYPE_CHECKING:
    from polycnc.nc import ProgramText

STANDARD_INPUT = "-"
STANDARD_INPUT_NAME = "<stdin>"


def machine_names(incomplete: str) -> list[str]:
    """Return the presets that begin so, for the completion of a shell."""
    from polycnc.machine import PRESETS

    return [name for name in PRESETS if name.startswith(incomplete)]


def dialect_names(incomplete: str) -> list[str]:
    """Return the dialects that begin so, for the completion of a shell."""
    from polycnc.nc import DIALECTS

    return [name for name in DIALECTS if name.startswith(incomplete)]


def read_program(program: Path) -> ProgramText:
    """Return a part program from a file, or from standard input if it is called "-".

    Raises:
        UsageError: the file cannot be read.
    """
    from polycnc import runner
    from polycnc.nc import ProgramText

    if str(program) == STANDARD_INPUT:
        if sys.stdin is None:
            raise UsageError("standard input is closed", hint="Name a file, or pipe the program in.")
        return ProgramText.from_text(sys.stdin.buffer.read(), STANDARD_INPUT_NAME)
    return runner.program_text(program)
