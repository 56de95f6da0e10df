"""``polycnc machine``: show a machine."""

from __future__ import annotations

from typing import Annotated

import typer

from polycnc.cli._output import bold, columns, print_json, say


def machine_command(
    machine: Annotated[
        str | None,
        typer.Argument(help="A preset or a TOML file (default: mill3).", metavar="FILE|PRESET"),
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object instead of a table.")
    ] = False,
    as_toml: Annotated[
        bool, typer.Option("--toml", help="Print the machine file of a preset, to start your own from.")
    ] = False,
) -> None:
    """Show the axes, limits and settings of a machine."""
    from polycnc import machine as machines
    from polycnc.errors import UsageError

    if as_json and as_toml:
        raise UsageError("--json and --toml exclude each other", hint="Give one of them.")
    if as_toml:
        typer.echo(machines.preset_text(machine or machines.DEFAULT_MACHINE), nl=False)
        return
    config = machines.load_machine(machine)
    if as_json:
        print_json(machines.describe_machine(config))
        return
    say(f"  {config.description}" if config.description else "", lead=bold(config.name))
    say(f"control cycle {config.cycle_s * 1000.0:g} ms, spindle up to {config.spindle.max_rpm:g} rpm")
    say()
    for line in columns([machines.AXIS_COLUMNS, *machines.axis_rows(config)]):
        say(line)
    if machine is None:
        say()
        say(f"presets: {', '.join(machines.PRESETS)}")
