"""``polycnc calls``: one machine for C programs alone, with a trace of all that they ask for."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

KINDS = ("fanuc", "imc", "apci")


def calls_command(
    kind: Annotated[str, typer.Argument(help="fanuc, imc or apci.", metavar="KIND")],
    machine: Annotated[
        Path | None, typer.Option(help="The card or system file; absent: the kind's own.", metavar="FILE")
    ] = None,
    trace: Annotated[
        Path | None, typer.Option(help="Append every call to this file, as JSON.", metavar="FILE")
    ] = None,
    replay: Annotated[
        Path | None,
        typer.Option(
            help="Serve nobody: carry out the calls of a trace, and say which answer otherwise.",
            metavar="FILE",
        ),
    ] = None,
    port: Annotated[int, typer.Option(help="Port to listen on, 0 for a free one.", min=0, max=65535)] = 8194,
    axes: Annotated[int, typer.Option(help="How many axes a FANUC control has.", min=1, max=6)] = 3,
    rate: Annotated[
        float, typer.Option(help="Machine seconds that pass in a second.", min=0.0, max=1000.0, metavar="X")
    ] = 1.0,
) -> None:
    """Serve a machine to programs that use its C library, until Ctrl-C ends it."""
    import asyncio
    from dataclasses import replace

    from polycnc.cli._serve import serve_plan
    from polycnc.errors import UsageError, did_you_mean
    from polycnc.servers.setup import Flags, plan_of

    if kind not in KINDS:
        raise UsageError(
            f"there is no C library of '{kind[:40]}'",
            hint=f"{did_you_mean(kind, KINDS)}There are {', '.join(KINDS)}.",
        )
    if trace is not None:
        try:
            trace.open("a").close()
        except OSError as error:
            raise UsageError(
                f"{trace}: cannot be written: {error.strerror}", hint="Name another file."
            ) from None
    if replay is not None:
        _replay(kind, machine, axes, replay)
        return
    file = str(machine) if machine is not None else ""
    plan = plan_of(Flags(file=None, kinds={kind: file}, doors=f"calls={port}", axes=axes, rate=rate))
    shared = tuple((row, replace(at, path=str(trace or ""))) for row, at in plan.shared)
    asyncio.run(serve_plan(replace(plan, shared=shared)))


def _replay(kind: str, machine: Path | None, axes: int, trace: Path) -> None:
    """Say which calls of a trace answer otherwise on a new machine; status 1 if any does."""
    import sys

    from polycnc.cli._errors import PROGRAM
    from polycnc.cli._output import say
    from polycnc.servers.calls import LIBRARIES, replay
    from polycnc.servers.process import KINDS, Machinery

    made = KINDS[kind](Machinery(file=machine, axes=axes))
    served = LIBRARIES[kind]
    library = served.load()
    count = other = 0
    try:
        for each in replay(trace, made.device, lambda: served.make(library, [made.device], None)):
            count += 1
            if not each.is_equal:
                other += 1
                (was, wrote), (code, writes) = each.expected, each.came
                say(f"line {each.line}: {each.call} was {was} {wrote}, is {code} {writes}")
    finally:
        made.end()
    say(f"{count} calls, of which {other} answer otherwise")
    if other:
        sys.exit(PROGRAM)
