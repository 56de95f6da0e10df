"""``polycnc mtconnect``: tools around MTConnect."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from polycnc.cli._command import add_command, group
from polycnc.cli._output import echo

mtconnect_app = group("Tools around MTConnect, which collectors read machines by.")


def devices_command(
    file: Annotated[
        Path | None, typer.Argument(help="A TOML file of machines, as for serve.", metavar="[FILE.toml]")
    ] = None,
    fanuc: Annotated[bool, typer.Option("--fanuc", help="Describe a FANUC control.")] = False,
    plain: Annotated[
        str | None,
        typer.Option(help="Describe a control without a vendor on this machine.", metavar="MACHINE"),
    ] = None,
    name: Annotated[str, typer.Option(help="Name of the device.")] = "machine",
    axes: Annotated[int, typer.Option(help="How many axes the FANUC control has.", min=1, max=6)] = 3,
    mtconnect_version: Annotated[str, typer.Option(help="2.7, 2.2, 1.8 or 1.3.", metavar="VERSION")] = "2.7",
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Where to write it; absent: to the terminal.")
    ] = None,
) -> None:
    """Write a Devices.xml, with which an agent reads what the door shdr sends."""
    from polycnc.outputs import check_output, complete_or_absent, keep_inputs
    from polycnc.servers.setup import describe_devices

    path = None if output is None else check_output(output, (".xml",), "the description")
    keep_inputs(path, (file, plain), "the description")
    kinds = {"fanuc": "" if fanuc else None, "plain": plain}
    document = describe_devices(file, kinds, name=name, axes=axes, version=mtconnect_version)
    if path is None:
        echo(document.decode(), nl=False)
    else:
        with complete_or_absent(path) as partial:
            partial.write_bytes(document)


add_command(mtconnect_app, "devices", devices_command, "Write the Devices.xml of a machine for an agent.")
