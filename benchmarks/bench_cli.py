"""Time the command: help, a small program, and the first run on a new machine, which compiles the kernel."""

from __future__ import annotations

import tempfile
from pathlib import Path

from _measure import Figure, at_most, in_turn, median_process, polycnc_command, run_process
from _programs import write_program
from _report import run_script

RUNS = 7


def figures(quick: bool) -> list[Figure]:
    """Measure and return the figures."""
    runs = 3 if quick else RUNS
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        program = write_program(folder / "small.ngc", 200)
        small = polycnc_command("run", program, "--json")
        environment = {"POLYCNC_CACHE_DIR": str(folder / "cache")}
        first = run_process(small, {**environment, "POLYCNC_COMPILE_AT_ONCE": ""})
        compiling = run_process(small, environment)
        warm = in_turn({"help": polycnc_command("--help"), "run": small}, runs, environment)
        every_cycle = polycnc_command("run", program, "--json", "--servo")
        first_cycles = run_process(every_cycle, environment)
        warm_cycles = median_process([run_process(every_cycle, environment) for _ in range(runs)])
    return [
        at_most("polycnc --help", warm["help"].wall_s, "s", 0.3, _cpu(warm["help"].cpu_s)),
        at_most("warm polycnc run, small program", warm["run"].wall_s, "s", 1.0, _cpu(warm["run"].cpu_s)),
        at_most("first polycnc run on a new machine", first.wall_s, "s", 8.0, _cpu(first.cpu_s)),
        Figure("first polycnc run that compiles", compiling.wall_s, "s", note=_cpu(compiling.cpu_s)),
        Figure("warm polycnc run --servo", warm_cycles.wall_s, "s", note=_cpu(warm_cycles.cpu_s)),
        Figure(
            "first polycnc run --servo after that", first_cycles.wall_s, "s", note=_cpu(first_cycles.cpu_s)
        ),
        Figure("warm polycnc run, peak memory", warm["run"].peak_mb, "MB"),
    ]


def _cpu(seconds: float) -> str:
    return f"processor {seconds:.2f} s"


if __name__ == "__main__":
    run_script("Command", figures)
