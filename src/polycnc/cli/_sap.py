"""``polycnc sap``: stand-alone programs of the APCI board."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from polycnc.cli._command import add_command, group
from polycnc.cli._output import bold, say

sap_app = group("Compile stand-alone programs (SAP) of the APCI board.")


def compile_command(
    source: Annotated[Path, typer.Argument(help="The program in rw_SymPas.", metavar="FILE")],
    out: Annotated[
        Path | None,
        typer.Option(
            "-o", "--out", help="The file to write (default: FILE with the ending .CNC).", metavar="OUT"
        ),
    ] = None,
    task: Annotated[
        int, typer.Option("--task", help="The task that runs it, 0 to 3.", metavar="N", min=0, max=3)
    ] = 0,
) -> None:
    """Compile a stand-alone program to a .CNC file, or report every error of it."""
    from polycnc.controllers.apci import sap
    from polycnc.errors import UsageError
    from polycnc.outputs import check_output, complete_or_absent, keep_inputs

    try:
        text = source.read_text(encoding="utf-8-sig", errors="replace")
    except OSError as error:
        raise UsageError(
            f"cannot read {source}: {error.strerror}", hint="Give the path of a program."
        ) from None
    target = check_output(out or source.with_suffix(".CNC"), (), "a program")
    keep_inputs(target, (source,), "a program")
    program, errors = sap.check(text, str(source), task)
    for mistake in errors:
        say(str(mistake))
    if program is None:
        say(lead=bold(f"{len(errors)} error{'' if len(errors) == 1 else 's'}"))
        sys.exit(1)
    content = sap.write_cnc(program)
    with complete_or_absent(target, durable=True) as partial:
        partial.write_bytes(content)
    say(f"wrote {target}: task {task}, {len(program.code)} instructions")


add_command(sap_app, "compile", compile_command, "Compile a program to a .CNC file.")
