"""``polycnc check``: every error of a program, not only the first."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from polycnc.cli._output import bold, print_json, say
from polycnc.cli._run import DIALECT, IGNORE, MACHINE, ROOT, codes_of

if TYPE_CHECKING:
    from polycnc.errors import ProgramError


def check_command(
    programs: Annotated[list[Path], typer.Argument(help="The part programs.", metavar="PROGRAM")],
    machine: Annotated[str | None, MACHINE] = None,
    dialect: Annotated[str | None, DIALECT] = None,
    ignore: Annotated[list[str] | None, IGNORE] = None,
    root: Annotated[Path | None, ROOT] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object instead of text.")] = False,
) -> None:
    """Report every error of part programs, each with its place and what to do."""
    from polycnc import runner
    from polycnc.machine import load_machine

    texts = [runner.program_text(program) for program in programs]
    config = load_machine(machine)
    found = {
        text.name: runner.check(text, config, dialect, root=root, ignore=codes_of(ignore)) for text in texts
    }
    total = sum(map(len, found.values()))
    if as_json:
        print_json(
            {
                "errors": total,
                "programs": {name: [_plain(error) for error in errors] for name, errors in found.items()},
            }
        )
    else:
        for name, errors in found.items():
            for error in errors:
                say(str(error))
            if not errors:
                say(f"{name}: no errors")
        if total:
            say(lead=bold(runner.counted(total, "error")))
    sys.exit(1 if total else 0)


def _plain(error: ProgramError) -> dict[str, Any]:
    at = error.position
    return {
        "text": error.what,
        "hint": error.hint,
        "code": error.code,
        "file": at.file if at else "",
        "line": at.line if at else 0,
        "column": at.column if at else 0,
    }
