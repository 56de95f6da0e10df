"""Rehearse a scenario: let a machine's time pass without a wall clock and without doors, and tell what happened."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from pathlib import Path

from polycnc.machine import Wall
from polycnc.servers.machines import Log, ServedMachine
from polycnc.servers.process._machinery import Machinery
from polycnc.servers.process._serving import MachineWanted, Serving
from polycnc.servers.scenarios import Happened, Script, Story


class _Still(Wall):
    """A wall clock that does not move."""

    def now_s(self) -> float:
        """Return 0."""
        return 0.0


def rehearse(
    kind: str, machinery: Machinery, script: Script, seconds: float, program: Path | None = None
) -> list[tuple[float, Happened]]:
    """Return what happens in so many machine seconds, with the machine's time; `program` runs again and again.

    Raises:
        UsageError: The machine cannot be made, or a step is not for it.
    """
    stories: list[Story] = []

    def story(machine: ServedMachine, log: Log) -> Story:
        stories.append(Story(script, machine, log))
        return stories[0]

    async def run() -> list[tuple[float, Happened]]:
        serving = Serving(_Still(), Log(), lambda lag_s: None)
        try:
            await serving.open([MachineWanted(kind, machinery, program, story=story)])
            await serving.start_programs()
            served = serving.machines[0].served
            _advance(served.advance, round(seconds / served.clock.cycle_s))
            return [(each.cycle * served.clock.cycle_s, each) for each in stories[0].happened]
        finally:
            await serving.close()

    return asyncio.run(run())


def _advance(advance: Callable[[int], int], cycles: int) -> None:
    left = cycles
    while left > 0 and (passed := advance(left)):
        left -= passed
