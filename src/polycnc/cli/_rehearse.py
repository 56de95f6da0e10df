"""``polycnc rehearse``: what happens in a scenario, without waiting for it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from polycnc.cli._output import say

_MOST_S = 86_400.0


def rehearse_command(
    scenario: Annotated[Path, typer.Argument(help="The file of the scenario.", metavar="SCENARIO.toml")],
    fanuc: Annotated[bool, typer.Option("--fanuc", help="It happens to a FANUC control.")] = False,
    plain: Annotated[
        str, typer.Option(help="The machine of a control without a vendor.", metavar="MACHINE")
    ] = "mill3",
    program: Annotated[
        Path | None, typer.Option(help="A program that runs again and again.", metavar="FILE")
    ] = None,
    seconds: Annotated[
        float, typer.Option(help="Machine seconds that pass.", min=0.0, max=_MOST_S, metavar="S")
    ] = 60.0,
) -> None:
    """Say what happens in a scenario and when, in machine time; requests of doors do not come."""
    from polycnc.servers.process import Machinery, rehearse
    from polycnc.servers.scenarios import load_script

    script = load_script(scenario)
    machinery = Machinery(file=None if fanuc else plain)
    for time_s, each in rehearse("fanuc" if fanuc else "plain", machinery, script, seconds, program):
        say(f"{time_s:9.3f} s  {each.step}: {each.what}")
