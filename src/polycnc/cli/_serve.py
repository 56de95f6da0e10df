"""``polycnc serve``: controls that live, and answer clients over the network."""

from __future__ import annotations

import ipaddress
import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from polycnc.cli._output import say, say_error
from polycnc.units import whole

if TYPE_CHECKING:
    from polycnc.servers.focas import Fault, FocasServer, Keeper, Profile

_SHARE_S = 0.01  # of the wall clock that all controls together may take before a door answers
_NUMBER = re.compile(rb"\s*O(\d{1,4})\b")
_MOST = 4000
_CHARACTERS = "Size of the program memory; absent: as of the series."


def serve_command(
    fanuc: Annotated[bool, typer.Option("--fanuc", help="Serve a FANUC control: FOCAS over TCP.")] = False,
    profile: Annotated[
        str, typer.Option(help="The series that clients see: power-mate, 16i, 0i-d or 31i.", metavar="NAME")
    ] = "31i",
    port: Annotated[
        int, typer.Option(help="TCP port, 0 for a free one, which is said.", min=0, max=65535)
    ] = 8193,
    address: Annotated[
        str, typer.Option(help="Address to listen on; only those of this computer.")
    ] = "127.0.0.1",
    count: Annotated[
        int,
        typer.Option(
            help="So many controls, each at an address of its own: 127.0.0.1, 127.0.0.2, ...",
            min=1,
            max=_MOST,
        ),
    ] = 1,
    program: Annotated[
        Path | None, typer.Option(help="A program that runs again and again.", metavar="FILE")
    ] = None,
    axes: Annotated[int, typer.Option(help="How many axes the control has.", min=1, max=6)] = 3,
    rate: Annotated[
        float, typer.Option(help="Machine seconds that pass in a second.", min=0.0, max=1000.0, metavar="X")
    ] = 1.0,
    memory: Annotated[
        Path | None,
        typer.Option(help="Keep programs, parameters, macros and offsets in this file.", metavar="FILE"),
    ] = None,
    characters: Annotated[int | None, typer.Option(help=_CHARACTERS, min=1, max=10**9, metavar="N")] = None,
    faults: Annotated[
        Path | None,
        typer.Option(help="A script of what goes wrong, and when: connections, alarms, ...", metavar="FILE"),
    ] = None,
) -> None:
    """Serve a simulated control that runs, until Ctrl-C ends it."""
    from polycnc.errors import UsageError

    if not fanuc:
        raise UsageError("which control shall be served?", hint="Write --fanuc; others are not there yet.")
    _check_addresses(address, count, port, memory)
    import asyncio

    from polycnc.servers.focas import load_faults, load_profile

    wanted = _Wanted(
        profile,
        load_profile(profile),
        port,
        program,
        axes,
        rate,
        memory,
        characters,
        () if faults is None else load_faults(faults),
    )
    asyncio.run(_serve(wanted, _addresses(address, count)))


def _check_addresses(address: str, count: int, port: int, memory: Path | None) -> None:
    """Refuse addresses of other computers, and what several controls cannot share."""
    from polycnc.errors import UsageError

    if not address.startswith("127.") and address not in ("localhost", "::1"):
        raise UsageError(
            f"{address} is no address of this computer alone",
            hint="The protocol knows no passwords: listen on 127.0.0.1 and forward the port where it is needed.",
        )
    if count > 1 and memory is not None:
        raise UsageError(f"{count} controls cannot share {memory}", hint="Serve one control with a memory.")
    if count > 1 and port == 0:
        raise UsageError("several controls on port 0", hint="Say the port; they differ in their addresses.")


@dataclass(frozen=True)
class _Wanted:
    """What is to be served."""

    name: str
    profile: Profile
    port: int
    program: Path | None
    axes: int
    rate: float
    memory: Path | None
    characters: int | None
    faults: tuple[Fault, ...]


class _Late:
    """Say once that clocks are late."""

    def __init__(self) -> None:
        self._said = False

    def say(self, _lag_s: float) -> None:
        if not self._said:
            self._said = True
            say_error(
                "the clocks of the controls are late: their programs take longer than the time they have"
            )


def _addresses(first: str, count: int) -> list[str]:
    """Return so many addresses of this computer, from one on.

    Raises:
        UsageError: There are not so many.
    """
    from polycnc.errors import UsageError

    if count == 1:
        return [first]
    try:
        start = ipaddress.IPv4Address("127.0.0.1" if first == "localhost" else first)
        last = start + (count - 1)
    except ValueError:
        start = last = ipaddress.IPv4Address(0)
    if not last.is_loopback:
        raise UsageError(f"there are no {count} addresses from {first} on", hint="Begin at 127.0.0.1.")
    return [str(start + k) for k in range(count)]


async def _serve(wanted: _Wanted, addresses: list[str]) -> None:
    import asyncio

    from polycnc import runner
    from polycnc.controllers.fanuc import PowerMate
    from polycnc.servers.focas import Faults, FocasServer, Keeper, ServedControl

    content = None if wanted.program is None else runner.program_text(wanted.program).content
    servers: list[FocasServer] = []
    keepers: list[Keeper] = []
    controls: list[PowerMate] = []
    wall = runner.WallClock()
    late = _Late()
    try:
        for address in addresses:
            characters = wanted.characters or wanted.profile.program_characters
            control = PowerMate(wanted.axes, memory=wanted.memory, characters=characters)
            controls.append(control)
            if content is not None:
                number, text = _numbered(content)
                control.programs.register(number, text)
                control.select_program(number)
                control.cycle_start()
            if not servers:
                control.advance(1)  # what has to be compiled is compiled before anybody waits for an answer
            faults = Faults(wanted.faults, control.clock.now_s)
            keeper = Keeper(
                ServedControl(control, faults, again=content is not None),
                wall,
                rate=wanted.rate,
                share_s=_SHARE_S / len(addresses),
                on_late=late.say,
            )
            keepers.append(keeper)
            server = FocasServer(
                keeper, control, wanted.profile, address=address, port=wanted.port, faults=faults
            )
            await server.start()
            servers.append(server)
        say(_said(wanted.name, servers))
        await asyncio.wait([keeper.failed for keeper in keepers], return_when=asyncio.FIRST_COMPLETED)
        for keeper in keepers:
            if keeper.failed.done():
                keeper.failed.result()
    finally:
        for server in servers:
            await server.close()
        for keeper in keepers:
            keeper.close()
        for control in controls:
            control.close()


def _said(profile: str, servers: list[FocasServer]) -> str:
    first, last = (f"{server.address}:{server.port}" for server in (servers[0], servers[-1]))
    if len(servers) == 1:
        return f"serving a FANUC {profile} on {first}; Ctrl-C ends it"
    return f"serving {len(servers)} FANUC {profile} on {first} to {last}; Ctrl-C ends them"


def _numbered(content: bytes) -> tuple[int, bytes]:
    """Return the number of a program and its text from the O word on; one without a number becomes O1."""
    text = content.replace(b"\r\n", b"\n").strip().removeprefix(b"%").lstrip().partition(b"\n%")[0] + b"\n"
    found = _NUMBER.match(text)
    return (whole(found[1]), text) if found else (1, b"O1\n" + text)
