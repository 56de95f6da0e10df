"""``polycnc serve``: a control that lives, and answers clients over the network."""

from __future__ import annotations

import asyncio
import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from polycnc.cli._output import say

if TYPE_CHECKING:
    from polycnc.cnc import Status
    from polycnc.machine import Host

_NUMBER = re.compile(rb"\s*O(\d{1,4})\b")
_LOOK_S = 0.5


def serve_command(
    fanuc: Annotated[bool, typer.Option("--fanuc", help="Serve a FANUC control: FOCAS over TCP.")] = False,
    profile: Annotated[
        str, typer.Option(help="The series that clients see: power-mate, 16i, 0i-d or 31i.", metavar="NAME")
    ] = "31i",
    port: Annotated[int, typer.Option(help="TCP port, 0 for a free one.", min=0, max=65535)] = 8193,
    address: Annotated[
        str, typer.Option(help="Address to listen on; only those of this computer.")
    ] = "127.0.0.1",
    program: Annotated[
        Path | None, typer.Option(help="A program that runs again and again.", metavar="FILE")
    ] = None,
    axes: Annotated[int, typer.Option(help="How many axes the control has.", min=1, max=6)] = 3,
    rate: Annotated[
        float, typer.Option(help="Machine seconds that pass in a second.", min=0.0, max=1000.0, metavar="X")
    ] = 1.0,
) -> None:
    """Serve a simulated control that runs, until Ctrl-C ends it."""
    from polycnc.errors import UsageError

    if not fanuc:
        raise UsageError("which control shall be served?", hint="Write --fanuc; others are not there yet.")
    if not address.startswith("127.") and address not in ("localhost", "::1"):
        raise UsageError(
            f"{address} is no address of this computer alone",
            hint="The protocol knows no passwords: listen on 127.0.0.1 and forward the port where it is needed.",
        )
    asyncio.run(_serve(profile, address, port, program, axes, rate))


async def _serve(profile: str, address: str, port: int, program: Path | None, axes: int, rate: float) -> None:
    from polycnc import runner
    from polycnc.controllers.fanuc import PowerMate
    from polycnc.machine import Host
    from polycnc.servers.focas import FocasServer, load_profile

    series = load_profile(profile)
    content = None if program is None else runner.program_text(program).content
    control: Any = PowerMate(axes)
    if content is not None:
        number, text = _numbered(content)
        control.programs.register(number, text)
        control.select_program(number)
        control.cycle_start()
    control.advance(1)  # what has to be compiled is compiled before anybody waits for an answer
    with Host(control, runner.WallClock(), rate=rate) as host:
        server = FocasServer(host, control, series, address=address, port=port)
        await server.start()
        say(f"serving a FANUC {profile} on {server.address}:{server.port}; Ctrl-C ends it")
        try:
            async with asyncio.TaskGroup() as tasks:
                tasks.create_task(server.serve_forever())
                if content is not None:
                    tasks.create_task(_again(host))
        finally:
            await server.close()


def _numbered(content: bytes) -> tuple[int, bytes]:
    """Return the number of a program and its text from the O word on; one without a number becomes O1."""
    text = content.replace(b"\r\n", b"\n").strip().removeprefix(b"%").lstrip().partition(b"\n%")[0] + b"\n"
    found = _NUMBER.match(text)
    return (int(found[1]), text) if found else (1, b"O1\n" + text)


async def _again(host: Host[Any]) -> None:
    """Start the program whenever it has come to its end."""
    from polycnc.cnc import RunState
    from polycnc.machine import HostError

    def is_over(status: Status) -> bool:
        return status.channel.run_state is RunState.COMPLETED

    while True:
        try:
            await asyncio.to_thread(host.wait, is_over, _LOOK_S)
        except HostError:
            if host.failure is not None:
                raise
        else:
            await asyncio.wrap_future(host.post(lambda control: control.cycle_start()))
