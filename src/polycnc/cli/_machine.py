"""``polycnc machine``: show a machine."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from polycnc.cli._output import bold, columns, echo, print_json, say


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
    source: Annotated[
        Path | None,
        typer.Option(
            "--from",
            help="Print the machine file of a control by its configuration: grbl's $$, LinuxCNC's INI, Klipper's "
            "printer.cfg, Smoothieware, FluidNC, FANUC parameters.",
            metavar="FILE",
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Write what --from gives to this file.", metavar="FILE"),
    ] = None,
) -> None:
    """Show the axes, limits and settings of a machine."""
    from polycnc import machine as machines
    from polycnc.errors import UsageError

    if source is not None:
        if machine is not None or as_json or as_toml:
            raise UsageError(
                "--from takes a configuration only", hint="Leave out the machine, --json and --toml."
            )
        _print_from(source, output)
        return
    if output is not None:
        raise UsageError("-o belongs to --from", hint="Use --toml > FILE to copy a preset.")
    if as_json and as_toml:
        raise UsageError("--json and --toml exclude each other", hint="Give one of them.")
    if as_toml:
        echo(machines.preset_text(machine or machines.DEFAULT_MACHINE), nl=False)
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


def _print_from(source: Path, output: Path | None) -> None:
    from polycnc.outputs import check_output, complete_or_absent, keep_inputs
    from polycnc.runner import machine_from

    if output is not None:
        keep_inputs(output, [source], "the machine file")
        check_output(output, (".toml",), "the machine file")
    text = machine_from(source)
    if output is None:
        echo(text, nl=False)
        return
    with complete_or_absent(output) as partial:
        partial.write_text(text, encoding="utf-8")
    left_out = text.count("\n# - ")
    say(
        f"wrote      {output}"
        + (f"; what it has no place for is at its top ({left_out})" if left_out else "")
    )
