"""Measure: whole processes by wall time, processor time and peak memory; calls by their processor time.

Processor time stays comparable while other work shares the machine.
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

# What is measured is compiled code, also where it was not compiled yet: small work would be done without.
os.environ.setdefault("POLYCNC_COMPILE_AT_ONCE", "1")


@dataclass(frozen=True)
class Process:
    """What a process cost from start to end."""

    wall_s: float
    user_s: float
    system_s: float
    peak_mb: float

    @property
    def cpu_s(self) -> float:
        """Processor time, user and system."""
        return self.user_s + self.system_s


@dataclass(frozen=True)
class Figure:
    """One line of the report: what was measured, the budget it must keep, and whether it does."""

    name: str
    value: float
    unit: str
    budget: str = ""
    holds: bool | None = None
    note: str = ""

    def as_dict(self) -> dict[str, object]:
        """Return the figure for results.json."""
        return asdict(self)


def at_least(name: str, value: float, unit: str, budget: float, note: str = "") -> Figure:
    """Return a figure that must not be below `budget`."""
    return Figure(name, value, unit, f">= {budget:,.10g}", value >= budget, note)


def at_most(name: str, value: float, unit: str, budget: float, note: str = "") -> Figure:
    """Return a figure that must not be above `budget`."""
    return Figure(name, value, unit, f"<= {budget:,.10g}", value <= budget, note)


def run_process(command: Sequence[str | Path], environment: Mapping[str, str] | None = None) -> Process:
    """Run a command to its end without any output.

    Raises:
        RuntimeError: the command failed.
    """
    begin = time.perf_counter()
    child = subprocess.Popen(
        [str(part) for part in command],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env={**os.environ, **(environment or {})},
    )
    _, status, usage = os.wait4(child.pid, 0)
    wall = time.perf_counter() - begin
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode != 0:
        raise RuntimeError(f"{command[0]} ended with status {child.returncode}")
    return Process(wall, usage.ru_utime, usage.ru_stime, usage.ru_maxrss / 1024.0)


def median_process(runs: Sequence[Process]) -> Process:
    """Return the medians of several runs, each column by itself; the peak memory is the highest."""
    return Process(
        statistics.median(run.wall_s for run in runs),
        statistics.median(run.user_s for run in runs),
        statistics.median(run.system_s for run in runs),
        max(run.peak_mb for run in runs),
    )


def in_turn(
    commands: Mapping[str, Sequence[str | Path]], runs: int, environment: Mapping[str, str] | None = None
) -> dict[str, Process]:
    """Run several commands in turn, `runs` times each, and return their medians.

    Ratios between them are fair also when the machine is busy with other work for a while.
    """
    found: dict[str, list[Process]] = {name: [] for name in commands}
    for _ in range(runs):
        for name, command in commands.items():
            found[name].append(run_process(command, environment))
    return {name: median_process(processes) for name, processes in found.items()}


def median_s(work: Callable[[], object], runs: int) -> float:
    """Return the median processor time of `work` in seconds, after one call that is not counted."""
    times = []
    for number in range(runs + 1):
        begin = time.process_time()
        work()
        if number:
            times.append(time.process_time() - begin)
    return statistics.median(times)


def polycnc_command(*arguments: str | Path) -> list[str | Path]:
    """Return the command line that runs this tree's polycnc."""
    beside = Path(sys.executable).with_name("polycnc")
    return [beside, *arguments] if beside.exists() else [sys.executable, "-m", "polycnc.cli", *arguments]
