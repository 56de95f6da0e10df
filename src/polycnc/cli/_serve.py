"""``polycnc serve``: machines that live, and answer clients over the network."""

from __future__ import annotations

import gc
import ipaddress
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

from polycnc.cli import _serve_options as _options
from polycnc.cli._errors import INTERRUPTED
from polycnc.cli._output import flush, say, say_error

if TYPE_CHECKING:
    from polycnc.servers.setup import Plan

_MOST_END_S = 0.85  # after a signal
_MOST_LINES = 20  # of doors that are named one by one


def serve_command(
    file: _options.File = None,
    fanuc: _options.Fanuc = False,
    plain: _options.Plain = None,
    bosch: _options.Bosch = None,
    apci: _options.Apci = None,
    imc: _options.Imc = None,
    doors: _options.Doors = None,
    expose: _options.Expose = None,
    token: _options.Token = None,
    insecure: _options.Insecure = None,
    log: _options.Log = None,
    profile: _options.Profile = "31i",
    port: _options.Port = 8193,
    address: _options.Address = "127.0.0.1",
    count: _options.Count = 1,
    program: _options.Program = None,
    axes: _options.Axes = 3,
    rate: _options.Rate = 1.0,
    memory: _options.Memory = None,
    characters: _options.Characters = None,
    faults: _options.Faults = None,
    scenario: _options.Scenario = None,
    mtconnect_version: _options.MTConnectVersion = "2.7",
    opcua_nodesets: _options.NodeSets = None,
    part: _options.Part = None,
) -> None:
    """Serve simulated machines that run, until Ctrl-C ends it."""
    with _without_collections():
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
            characters=characters,
            rate=rate,
            memory=memory,
            faults=faults,
            scenario=scenario,
            mtconnect=mtconnect_version,
            node_sets=opcua_nodesets,
            part=part,
        )
    )
    with _without_collections():
        from polycnc.servers.process import run

    run(serve_plan(plan, is_part=part is not None) if plan.processes == 1 else serve_fleet(plan))


@contextmanager
def _without_collections() -> Iterator[None]:
    """Load what stays: a collection would look through all of it again and again."""
    gc.disable()
    try:
        yield
    finally:
        gc.enable()


def _leave(status: int) -> NoReturn:
    """End the process at once: doors and memories are closed, taking compiled code apart takes long under load."""
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)


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


async def serve_fleet(plan: Plan) -> None:
    """Let several processes serve what a plan says until a signal ends them, or one of them has ended."""
    import asyncio
    import signal

    from polycnc.servers.fleets import Fleet, FleetError, this_command

    ended = _end_on_signals(signal.SIGTERM, signal.SIGINT)
    plan.log.close()
    fleet = Fleet(this_command(), plan.processes, _say_line, plan.metrics)
    try:
        await fleet.run()
    except asyncio.CancelledError:
        if not ended:
            raise
    except FleetError as error:
        await fleet.close()
        say_error(f"{error.what}\n{error.hint}")
        _leave(error.status)
    finally:
        await fleet.close()
    if ended:
        _leave_after(ended[0])


async def serve_plan(plan: Plan, *, is_part: bool = False) -> None:
    """Serve what a plan says until a signal ends it; `is_part`: as one of several processes."""
    import asyncio
    import signal

    from polycnc import runner
    from polycnc.servers.process import Serving

    ended = _end_on_signals(signal.SIGTERM, signal.SIGINT)
    serving = Serving(runner.WallClock(), plan.log, _Late().say, say_error)
    try:
        for why in plan.lasting:
            say_error(why)
        with _without_collections():
            await serving.open(plan.machines, plan.shared)
        for warning in plan.warnings:
            say_error(warning)
        if is_part:
            from polycnc.servers.fleets import Part

            part = Part(sys.stdout, lambda: signal.raise_signal(signal.SIGTERM))
            part.tell_doors(serving.doors)
        else:
            _say_doors([(name, door.said) for name, door, _ in serving.doors])
        await asyncio.sleep(0)  # whoever wants it to end already
        gc.collect()
        await serving.begin()
        gc.freeze()  # what has been made until now lasts: no collection goes through it again
        if is_part:
            part.begin(serving.machines)
        await serving.run()
    except asyncio.CancelledError:
        if not ended:
            raise
    finally:
        await serving.close()
    if ended:
        _leave_after(ended[0])


def _leave_after(number: int) -> NoReturn:
    """End the process after a signal."""
    if _status_of(number) == INTERRUPTED:
        say_error("interrupted")
    _leave(_status_of(number))


def _say_line(line: str) -> None:
    say(line)
    flush()


def _status_of(number: int) -> int:
    """Return the exit status after a signal."""
    import signal

    return INTERRUPTED if number == signal.SIGINT else 128 + number


def _end_on_signals(*numbers: int) -> list[int]:
    """Let signals end what runs where it waits, never in the middle of something; return the list that tells of them.

    What does not wait in time (a program that is being compiled, a computer that has no time) is broken off: what was
    acknowledged is kept already.
    """
    import asyncio
    import signal
    import threading

    task, loop, came = asyncio.current_task(), asyncio.get_running_loop(), list[int]()
    assert task is not None
    cancel = task.cancel

    def end(number: int, _: object) -> None:
        came.append(number)
        if len(came) > 1:  # who asks twice does not break off the closing
            return
        loop.call_soon_threadsafe(cancel)
        late = threading.Timer(_MOST_END_S, os._exit, [_status_of(number)])
        late.daemon = True
        late.start()

    for number in numbers:
        signal.signal(number, end)
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
