"""``polycnc machine``: show a machine."""

from __future__ import annotations

from typing import Annotated

import typer

from polycnc.cli._output import console, print_json


def machine_command(
    machine: Annotated[
        str | None, typer.Argument(help="Preset or TOML file (default: mill3).", metavar="[FILE|PRESET]")
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object instead of a table.")
    ] = False,
) -> None:
    """Show the axes, limits and settings of a machine."""
    from polycnc.machine import AXIS_COLUMNS, axis_rows, describe_machine, load_machine

    config = load_machine(machine)
    if as_json:
        print_json(describe_machine(config))
        return
    from rich.markup import escape
    from rich.table import Table

    out = console()
    out.print(f"[bold]{escape(config.name)}[/]  {escape(config.description)}", highlight=False)
    out.print(
        f"control cycle {config.cycle_s * 1000.0:g} ms, highest spindle speed {config.spindle.max_rpm:g} rpm",
        highlight=False,
    )
    table = Table()
    for name in AXIS_COLUMNS:
        table.add_column(name)
    for row in axis_rows(config):
        table.add_row(*row)
    out.print(table)
