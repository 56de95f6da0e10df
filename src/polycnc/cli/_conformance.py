"""``polycnc conformance``: how much of each manual is covered by tests."""

from __future__ import annotations

from typing import Annotated

import typer

from polycnc.cli._output import print_json


def conformance_command(
    system: Annotated[
        str | None, typer.Argument(help="fanuc, apci, imc, cpl or post; all if absent.", metavar="[SYSTEM]")
    ] = None,
    state: Annotated[
        str | None,
        typer.Option(
            "--list",
            help="List the rows of SYSTEM in a state: tested, not_applicable or open (default).",
            metavar="STATE",
        ),
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object instead of a table.")
    ] = False,
) -> None:
    """Show, per system, which rows of its manual are tested, which do not apply and which are open."""
    from polycnc.conformance import load_conformance, row_listing, summary_table
    from polycnc.errors import UsageError

    found = load_conformance()
    counts = found.counts()
    if system is not None and system not in counts:
        raise UsageError(f"unknown system '{system}'", hint=f"Systems are: {', '.join(counts)}")
    if as_json:
        data = found.as_json()
        if system is not None:
            data["systems"] = {system: data["systems"][system]}
        print_json(data)
    elif system is None:
        typer.echo(summary_table(found))
    else:
        typer.echo(row_listing(found, system, state or "open"))
