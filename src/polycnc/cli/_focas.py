"""``polycnc focas``: tools around the protocol of FANUC controls."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from polycnc.cli._command import add_command, group
from polycnc.cli._output import echo

focas_app = group("Tools around FOCAS, the Ethernet protocol of FANUC controls.")


def dissect_command(
    file: Annotated[Path, typer.Argument(help="Hex as text, raw bytes, pcap or pcapng.", metavar="FILE")],
    port: Annotated[
        int, typer.Option(help="The control's port, in files of packets.", min=1, max=65535)
    ] = 8193,
) -> None:
    """Explain captured bytes: every field of every frame, with its offset."""
    from polycnc.errors import UsageError
    from polycnc.servers.focas import explain_capture

    try:
        data = file.read_bytes()
    except OSError as error:
        raise UsageError(
            f"{file}: {error.strerror or error}", hint="Give a file of captured bytes."
        ) from None
    for line in explain_capture(data, str(file), port):
        echo(line)


add_command(focas_app, "dissect", dissect_command, "Explain captured bytes of the protocol.")
