"""``polycnc conformance``: how much of each manual is covered by tests."""

from __future__ import annotations

from typing import Annotated

import typer

from polycnc.cli._output import print_json, say


def conformance_command(
    system: Annotated[
        str | None,
        typer.Argument(help="fanuc, apci, imc, cpl or post (default: all).", metavar="SYSTEM"),
    ] = None,
    state: Annotated[
        str | None,
        typer.Option(
            "--list", help="Which rows of SYSTEM: tested, not_applicable or open (default).", metavar="STATE"
        ),
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object instead of a table.")
    ] = False,
) -> None:
    """Count the statements of the manuals that tests prove, that do not apply, and that are open.

    With a SYSTEM, list its open rows, or those in another state.
    """
    from polycnc.conformance import load_conformance, row_listing, summary_table
    from polycnc.errors import UsageError, did_you_mean

    found = load_conformance()
    counts = found.counts()
    if system is not None and system not in counts:
        raise UsageError(
            f"unknown system '{system}'",
            hint=f"{did_you_mean(system, counts)}Systems are: {', '.join(counts)}",
        )
    if state is not None and system is None:
        raise UsageError("--list needs a system", hint=f"Name one of {', '.join(counts)}.")
    if as_json:
        data = found.as_json()
        if system is not None:
            data["systems"] = {system: data["systems"][system]}
        print_json(data)
    elif system is None:
        say(summary_table(found))
    else:
        say(row_listing(found, system, state or "open"))
