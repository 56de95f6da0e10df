"""One process of a fleet: it tells the first process where its doors are, and how its machines do when it is asked."""

from __future__ import annotations

import asyncio
import json
import sys
from collections.abc import Callable, Sequence
from typing import Any, TextIO

from polycnc.servers.machines import Door, ServedMachine

ASK = b"figures\n"
"""What the first process writes to be told how machines do."""


class Part:
    """Talk to the first process: lines of JSON there, questions from there; `ended` is called when it has gone."""

    def __init__(self, out: TextIO, ended: Callable[[], object]) -> None:
        self._out = out
        self._ended = ended
        self._machines: Sequence[ServedMachine] = ()
        self._task: asyncio.Task[None] | None = None

    def tell_doors(self, doors: Sequence[tuple[str, Door, Sequence[ServedMachine]]]) -> None:
        """Tell where each machine has its doors."""
        for name, door, machines in doors:
            for machine in machines:
                self._tell("door", [machine.name, name, door.said])

    def begin(self, machines: Sequence[ServedMachine]) -> None:
        """Say that all doors are open, and answer from now on."""
        self._machines = machines
        self._tell("ready", None)
        self._task = asyncio.ensure_future(self._answer())

    async def _answer(self) -> None:
        reader = asyncio.StreamReader()
        await asyncio.get_running_loop().connect_read_pipe(
            lambda: asyncio.StreamReaderProtocol(reader), sys.stdin
        )
        while await reader.readline() == ASK:
            self._tell("figures", list(map(_figures, self._machines)))
        self._ended()

    def _tell(self, kind: str, value: Any) -> None:
        print(json.dumps([kind, value]), file=self._out, flush=True)


def _figures(machine: ServedMachine) -> dict[str, Any]:
    return {
        "machine": machine.name,
        "time_s": machine.served.clock.now_s,
        "late_s": machine.keeper.take_lateness_s(),
        "lives": not machine.keeper.failed.done(),
    }
