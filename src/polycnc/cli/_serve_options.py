"""The options of ``polycnc serve``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, TypeAlias

import typer

_MOST = 4000
_CHARACTERS = "Size of the program memory; absent: as of the series."

File: TypeAlias = Annotated[
    Path | None, typer.Argument(help="A TOML file of machines and their doors.", metavar="[FILE.toml]")
]
Fanuc: TypeAlias = Annotated[bool, typer.Option("--fanuc", help="Serve a FANUC control: FOCAS over TCP.")]
Plain: TypeAlias = Annotated[
    str | None, typer.Option(help="Serve a control without a vendor on this machine.", metavar="MACHINE")
]
Bosch: TypeAlias = Annotated[
    str | None, typer.Option(help="Serve a Bosch control; --memory is its folder.", metavar="MACHINE")
]
Apci: TypeAlias = Annotated[
    Path | None, typer.Option(help="Serve an APCI board with this system file.", metavar="MACHINE")
]
Imc: TypeAlias = Annotated[
    Path | None, typer.Option(help="Serve an iMC card with this card file.", metavar="MACHINE")
]
Doors: TypeAlias = Annotated[
    str | None,
    typer.Option(help="Doors to open, separated by commas; 0 takes a free port.", metavar="NAME[=PORT],..."),
]
Expose: TypeAlias = Annotated[
    str | None, typer.Option(help="Listen for other computers on this address.", metavar="ADDRESS")
]
Token: TypeAlias = Annotated[
    Path | None, typer.Option(help="The secret that clients of HTTP have to show.", metavar="FILE")
]
Insecure: TypeAlias = Annotated[
    str | None, typer.Option(help="Doors without a secret that may be exposed.", metavar="NAME,...")
]
Log: TypeAlias = Annotated[
    Path | None, typer.Option(help="Append events and requests to this file, as JSON.", metavar="FILE")
]
Profile: TypeAlias = Annotated[
    str, typer.Option(help="The series that clients see: power-mate, 16i, 0i-d or 31i.", metavar="NAME")
]
Port: TypeAlias = Annotated[int, typer.Option(help="TCP port of FOCAS, 0 for a free one.", min=0, max=65535)]
Address: TypeAlias = Annotated[str, typer.Option(help="Address to listen on; only those of this computer.")]
Count: TypeAlias = Annotated[
    int,
    typer.Option(
        help="So many controls, each at an address of its own: 127.0.0.1, 127.0.0.2, ...", min=1, max=_MOST
    ),
]
Program: TypeAlias = Annotated[
    Path | None, typer.Option(help="A program that runs again and again.", metavar="FILE")
]
Axes: TypeAlias = Annotated[int, typer.Option(help="How many axes the control has.", min=1, max=6)]
Rate: TypeAlias = Annotated[
    float, typer.Option(help="Machine seconds that pass in a second.", min=0.0, max=1000.0, metavar="X")
]
Memory: TypeAlias = Annotated[
    Path | None,
    typer.Option(help="Keep programs, parameters, macros and offsets in this file.", metavar="FILE"),
]
Characters: TypeAlias = Annotated[int | None, typer.Option(help=_CHARACTERS, min=1, max=10**9, metavar="N")]
Scenario: TypeAlias = Annotated[
    Path | None,
    typer.Option(help="What happens to the machine and its doors, and when.", metavar="FILE"),
]
NodeSets: TypeAlias = Annotated[
    Path | None,
    typer.Option(
        "--opcua-nodesets",
        help="A folder of official node sets for the door opcua; without it, it brings the types it needs.",
        metavar="DIR",
    ),
]
Faults: TypeAlias = Annotated[
    Path | None,
    typer.Option(help="A script of what goes wrong, and when: connections, alarms, ...", metavar="FILE"),
]
Part: TypeAlias = Annotated[
    str | None, typer.Option(hidden=True, help="Which process of a fleet this is.", metavar="K/N")
]
MTConnectVersion: TypeAlias = Annotated[
    str, typer.Option(help="What clients of mtconnect and shdr see: 2.7, 2.2, 1.8 or 1.3.", metavar="VERSION")
]
