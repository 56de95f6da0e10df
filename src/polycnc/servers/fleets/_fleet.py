"""The first process of a fleet: it starts the others, says where all doors are, and ends when one of them ends."""

from __future__ import annotations

import asyncio
import contextlib
import json
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

from polycnc.errors import PolycncError
from polycnc.servers.asgi import AsgiDoor, refused_in_text
from polycnc.servers.fleets._figures import figures_app
from polycnc.servers.fleets._part import ASK
from polycnc.servers.machines import LOOPBACK

_MOST_LINE_BYTES = 1 << 20
_ANSWER_S = 2.0
_END_S = 0.75
"""Before the first process leaves, which is broken off itself soon after a signal: none of the others outlives it."""


class FleetError(PolycncError):
    """A process of a fleet that has ended; `status` is its exit status."""

    def __init__(self, what: str, *, hint: str, status: int) -> None:
        super().__init__(what, hint=hint)
        self.status = status


@dataclass(slots=True, eq=False)
class _Process:
    """One of the others, and what it was asked last."""

    number: int
    process: asyncio.subprocess.Process
    ready: asyncio.Future[None]
    asked: list[asyncio.Future[list[dict[str, Any]]]] = field(default_factory=list)


class Fleet:
    """Start `command` once for each process, with `--part K/N`; `say` gets a line for each door of each machine."""

    def __init__(
        self, command: Sequence[str], processes: int, say: Callable[[str], object], metrics: int | None = None
    ) -> None:
        self._command = command
        self._count = processes
        self._say = say
        self._metrics = metrics
        self._page: AsgiDoor | None = None
        self._processes: list[_Process] = []
        self._tasks: list[asyncio.Task[None]] = []

    async def run(self) -> None:
        """Serve until one of the processes ends, or this is cancelled.

        Raises:
            FleetError: One of them has ended; the others are ended, too.
            UsageError: The page of figures cannot be opened.
        """
        loop = asyncio.get_running_loop()
        if self._metrics is not None:
            self._page = AsgiDoor(
                "metrics", figures_app(self.figures), LOOPBACK, self._metrics, refused_in_text
            )
            await self._page.start()
            self._say(f"metrics: {self._page.said}/metrics")
        for number in range(self._count):
            process = await asyncio.create_subprocess_exec(
                *self._command, "--part", f"{number + 1}/{self._count}",
                stdin=asyncio.subprocess.PIPE, stdout=asyncio.subprocess.PIPE, limit=_MOST_LINE_BYTES,
                start_new_session=True,
            )  # fmt: skip
            self._processes.append(_Process(number + 1, process, loop.create_future()))
        self._tasks = [asyncio.ensure_future(self._read(each)) for each in self._processes]
        done, _ = await asyncio.wait(self._tasks, return_when=asyncio.FIRST_COMPLETED)
        for task in done:
            task.result()

    async def close(self) -> None:
        """End all processes."""
        for each in self._processes:
            if each.process.returncode is None:
                each.process.terminate()
        waiting = [asyncio.ensure_future(each.process.wait()) for each in self._processes]
        if waiting:
            _, late = await asyncio.wait(waiting, timeout=_END_S)
            for each in self._processes if late else ():
                if each.process.returncode is None:
                    each.process.kill()
        for task in self._tasks:
            task.cancel()
        if self._page is not None:
            await self._page.close()

    async def figures(self) -> list[tuple[int, dict[str, Any]]]:
        """Return how each machine does, with the number of its process; those that do not answer are left out."""
        loop = asyncio.get_running_loop()
        waiting = []
        for each in self._processes:
            answer: asyncio.Future[list[dict[str, Any]]] = loop.create_future()
            each.asked.append(answer)
            assert each.process.stdin is not None
            with contextlib.suppress(ConnectionError):
                each.process.stdin.write(ASK)
            waiting.append((each.number, answer))
        if waiting:
            await asyncio.wait([answer for _, answer in waiting], timeout=_ANSWER_S)
        return [(number, row) for number, answer in waiting if answer.done() for row in answer.result()]

    async def _read(self, one: _Process) -> None:
        """Take what a process tells, until it ends."""
        assert one.process.stdout is not None
        while line := await one.process.stdout.readline():
            kind, value = json.loads(line)
            if kind == "door":
                self._say("{} {}: {}".format(*value))
            elif kind == "ready":
                one.ready.set_result(None)
                if all(each.ready.done() for each in self._processes):
                    self._say(f"ready: {self._count} processes")
            elif one.asked:
                answer = one.asked.pop(0)
                if not answer.done():
                    answer.set_result(value)
        status = await one.process.wait()
        raise FleetError(
            f"process {one.number} of the fleet has ended with status {status}",
            hint="Its own messages are above; the other processes are ended.",
            status=status if status > 0 else 1,
        )


def this_command() -> list[str]:
    """Return what starts this program anew, with the same arguments."""
    return [sys.executable, "-m", "polycnc.cli", *sys.argv[1:]]
