"""Run every benchmark in a process of its own, print one table and write results.json.

`--quick` does less work. The exit status is 1 if a budget was missed.
"""

from __future__ import annotations

import json
import os
import platform
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

from _measure import Figure
from _report import show

HERE = Path(__file__).parent
RESULTS = HERE / "results.json"
SCRIPTS = {
    "bench_cli.py": "Command",
    "bench_blocks.py": "Long programs",
    "bench_scan.py": "Block scanner",
    "bench_cpl.py": "CPL",
    "bench_macros.py": "Custom macros",
    "bench_variables.py": "Programs with variables",
    "bench_laser.py": "Laser programs",
    "bench_lookahead.py": "Look-ahead",
    "bench_profile.py": "Point-to-point planning",
    "bench_machine.py": "Whole virtual machine",
    "bench_apci.py": "APCI board",
    "bench_imc.py": "iMC card",
    "bench_cycle_calls.py": "One cycle per call",
    "bench_post.py": "Post-processor macros",
    "bench_focas.py": "FOCAS server",
    "bench_calls.py": "C library",
    "bench_plants.py": "MTConnect agent",
    "bench_fleet.py": "Fleets",
    "bench_served.py": "Served machine",
    "bench_batch.py": "Batches",
    "bench_stock.py": "Stock",
}


def run_benchmark(script: str, options: list[str]) -> list[Figure]:
    """Run one script and return its figures.

    Raises:
        CalledProcessError: it failed; what it said is on standard error.
    """
    command = [sys.executable, str(HERE / script), "--json", *options]
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True)
    return [Figure(**figure) for figure in json.loads(done.stdout)]


def machine() -> dict[str, object]:
    """Return what the figures depend on."""
    return {
        "processor": platform.processor() or platform.machine(),
        "cores": os.cpu_count(),
        "python": platform.python_version(),
        **{name: version(name) for name in ("numba", "numpy")},
    }


def main() -> int:
    """Run all benchmarks; return the exit status."""
    options = [option for option in sys.argv[1:] if option == "--quick"]
    results: dict[str, object] = {"machine": machine()}
    missed = []
    for script, title in SCRIPTS.items():
        figures = run_benchmark(script, options)
        show(title, figures)
        results[title] = [figure.as_dict() for figure in figures]
        missed += [f"{title}: {figure.name}" for figure in figures if figure.holds is False]
    RESULTS.write_text(json.dumps(results, indent=2) + "\n", encoding="utf-8")
    print(f"\n{len(missed)} budgets missed" + "".join(f"\n  {name}" for name in missed))
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
