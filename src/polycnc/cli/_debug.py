"""``polycnc debug``: execute a program block by block and look at it."""

from __future__ import annotations

import sys
from typing import Annotated

import typer

from polycnc.cli import _options as options


def debug_command(
    program: options.Program,
    machine: options.Machine = None,
    dialect: options.Dialect = None,
    root: options.Root = None,
    rate: Annotated[
        float, typer.Option(help="Machine seconds that pass in a second.", min=0.001, max=1000.0, metavar="X")
    ] = 1.0,
) -> None:
    """Execute a part program on a simulated machine, hold it, go block by block, and look at positions and words."""
    from polycnc import runner
    from polycnc.errors import UsageError

    try:
        from polycnc.cli._debug_screen import DebugScreen
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] != "textual":
            raise
        raise UsageError(
            "the debugger needs textual", hint="Install it: pip install 'polycnc[debug]'."
        ) from None
    debugger = runner.Debugger(runner.program_text(program), machine, dialect, root=root)
    if not all(stream is not None and stream.isatty() for stream in (sys.stdin, sys.stdout)):
        raise UsageError(
            "the debugger needs a terminal to draw on and to read keys from",
            hint="Run it in a terminal window, without < > or | around it; `polycnc run` needs none.",
        )
    DebugScreen(debugger, rate=rate).run()
