"""``polycnc serve``: machines that live, and answer clients over the network."""

from __future__ import annotations

import contextlib
import ipaddress
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from polycnc.cli._output import say, say_error

if TYPE_CHECKING:
    from polycnc.servers.setup import Plan

_MOST = 4000
_MOST_LINES = 20  # of doors that are named one by one


def serve_command(
    file: Annotated[
        Path | None, typer.Argument(help="A TOML file of machines and their doors.", metavar="[FILE.toml]")
    ] = None,
    fanuc: Annotated[bool, typer.Option("--fanuc", help="Serve a FANUC control: FOCAS over TCP.")] = False,
    plain: Annotated[
        str | None, typer.Option(help="Serve a control without a vendor on this machine.", metavar="MACHINE")
    ] = None,
    bosch: Annotated[
        str | None, typer.Option(help="Serve a Bosch control; --memory is its folder.", metavar="MACHINE")
    ] = None,
    apci: Annotated[
        Path | None, typer.Option(help="Serve an APCI board with this system file.", metavar="MACHINE")
    ] = None,
    imc: Annotated[
        Path | None, typer.Option(help="Serve an iMC card with this card file.", metavar="MACHINE")
    ] = None,
    doors: Annotated[
        str | None,
        typer.Option(
            help="Doors to open, separated by commas; 0 takes a free port.", metavar="NAME[=PORT],..."
        ),
    ] = None,
    expose: Annotated[
        str | None, typer.Option(help="Listen for other computers on this address.", metavar="ADDRESS")
    ] = None,
    token: Annotated[
        Path | None, typer.Option(help="The secret that clients of HTTP have to show.", metavar="FILE")
    ] = None,
    insecure: Annotated[
        str | None, typer.Option(help="Doors without a secret that may be exposed.", metavar="NAME,...")
    ] = None,
    log: Annotated[
        Path | None, typer.Option(help="Append events and requests to this file, as JSON.", metavar="FILE")
    ] = None,
    profile: Annotated[
        str, typer.Option(help="The series that clients see: power-mate, 16i, 0i-d or 31i.", metavar="NAME")
    ] = "31i",
    port: Annotated[int, typer.Option(help="TCP port of FOCAS, 0 for a free one.", min=0, max=65535)] = 8193,
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
    faults: Annotated[
        Path | None,
        typer.Option(help="A script of what goes wrong, and when: connections, alarms, ...", metavar="FILE"),
    ] = None,
) -> None:
    """Serve simulated machines that run, until Ctrl-C ends it."""
    import asyncio

    from polycnc.servers.setup import Flags, plan_of

    _check_addresses(address, count, port, memory)
    plan = plan_of(
        Flags(
            file=file,
            kinds={"fanuc": "" if fanuc else None, "plain": plain, "bosch": bosch, "apci": apci, "imc": imc},
            profile=profile,
            port=port,
            addresses=tuple(_addresses(address, count)),
            doors=doors,
            expose=expose,
            token=token,
            insecure=insecure,
            log=log,
            program=program,
            axes=axes,
            rate=rate,
            memory=memory,
            faults=faults,
        )
    )
    asyncio.run(_serve(plan))


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


async def _serve(plan: Plan) -> None:
    import asyncio
    import signal

    from polycnc import runner
    from polycnc.servers.process import Serving

    ended = _end_on_signal(signal.SIGTERM)
    serving = Serving(runner.WallClock(), plan.log, _Late().say)
    try:
        await serving.open(plan.machines, plan.shared)
        for warning in plan.warnings:
            say_error(warning)
        _say_doors([(name, door.said) for name, door in serving.doors])
        await asyncio.sleep(0)  # whoever wants it to end already
        serving.begin()
        await serving.run()
    except asyncio.CancelledError:
        if ended:
            sys.exit(128 + ended[0])
        raise
    finally:
        await serving.close()


def _end_on_signal(number: int) -> list[int]:
    """Let a signal end what runs where it waits, never in the middle of something; return the list that tells of it."""
    import asyncio

    task, came = asyncio.current_task(), list[int]()
    assert task is not None

    def end() -> None:
        came.append(number)
        task.cancel()

    with contextlib.suppress(NotImplementedError):  # Windows: the process ends as others do
        asyncio.get_running_loop().add_signal_handler(number, end)
    return came


def _say_doors(doors: list[tuple[str, str]]) -> None:
    """Say where each door is; of a long row of doors the first and the last."""
    if len(doors) > _MOST_LINES:
        (first, at), (_, last) = doors[0], doors[-1]
        say(f"{first}: {at} to {last}")
    else:
        for name, at in doors:
            say(f"{name}: {at}")
    sys.stdout.flush()
