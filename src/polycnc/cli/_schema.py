"""``polycnc schema``: what the JSON output and the files look like, for other programs."""

from __future__ import annotations

from typing import Annotated

import typer

from polycnc.cli._output import print_json, say


def schema_command(
    name: Annotated[
        str | None,
        typer.Argument(
            help="run, check, compare, batch, machine or dialect; absent: list them.", metavar="[NAME]"
        ),
    ] = None,
) -> None:
    """Print the JSON schema of what a command prints with --json, or of a machine or dialect file."""
    from polycnc.runner import SCHEMAS, json_schema

    if name is None:
        for each in SCHEMAS:
            say(f"{each:8}  {json_schema(each)['title']}")
        return
    print_json(json_schema(name))
