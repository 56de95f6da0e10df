"""What runs on the workers of a Dask cluster: chunks of programs, in processes that may hang without harm."""

from __future__ import annotations

import threading
from collections.abc import Sequence
from typing import Any

import distributed

from polycnc.runner.batches._child import Child, Limits
from polycnc.runner.batches._job import Answer, Job, Setup


class ChildrenPlugin(distributed.WorkerPlugin):
    """Hold the processes of one worker: one for each of its threads that has run a chunk; end them with the batch."""

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._free: list[Child] = []
        self._all: list[Child] = []
        self._gate: Any = None

    def setup(self, worker: Any) -> None:
        """Begin on a worker."""
        self._gate = threading.Lock()

    def teardown(self, worker: Any) -> None:
        """End all processes."""
        for child in self._all:
            child.close()

    def take(self) -> Child:
        """Return a process that nobody uses."""
        with self._gate:
            if self._free:
                return self._free.pop()
            child = Child(self._limits)
            self._all.append(child)
            return child

    def give_back(self, child: Child) -> None:
        """Let others use a process."""
        with self._gate:
            self._free.append(child)


def run_chunk(jobs: Sequence[Job], setups: Sequence[Setup], limits: Limits) -> list[tuple[str, Answer]]:
    """Run a chunk of jobs on this worker, and return their reports by key."""
    plugin = distributed.get_worker().plugins["polycnc-batch"]
    assert isinstance(plugin, ChildrenPlugin)
    child = plugin.take()
    try:
        return list(zip([job.key for job in jobs], child.answers(jobs, setups), strict=True))
    finally:
        plugin.give_back(child)
