"""``polycnc check``: every error of a program, not only the first."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from polycnc.cli._output import console, print_json, say_if_cold
from polycnc.cli._run import DIALECT, MACHINE


def check_command(
    programs: Annotated[list[Path], typer.Argument(help="Part programs.", metavar="PROGRAM...")],
    machine: Annotated[str | None, MACHINE] = None,
    dialect: Annotated[str | None, DIALECT] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object instead of text.")] = False,
) -> None:
    """Report every error of part programs, each with its place and what to do."""
    say_if_cold()
    from rich.markup import escape

    from polycnc import runner

    out = console()
    found = {str(program): runner.check(program, machine, dialect) for program in programs}
    total = sum(len(errors) for errors in found.values())
    if as_json:
        print_json(
            {
                "programs": {
                    name: [
                        {
                            "text": error.what,
                            "hint": error.hint,
                            "code": error.code,
                            "line": error.position.line if error.position else 0,
                            "column": error.position.column if error.position else 0,
                        }
                        for error in errors
                    ]
                    for name, errors in found.items()
                }
            }
        )
    else:
        for name, errors in found.items():
            for error in errors:
                out.print(escape(str(error)), highlight=False)
            if not errors:
                out.print(f"{escape(name)}: no errors", highlight=False)
        if total:
            out.print(f"[bold]{total} error{'s' if total > 1 else ''}[/]", highlight=False)
    sys.exit(1 if total else 0)
