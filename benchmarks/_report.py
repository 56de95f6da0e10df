"""What every benchmark script shares: its options, its table for people, its JSON for `run_all`."""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Sequence

from _measure import Figure

Benchmark = Callable[[bool], list[Figure]]


def run_script(title: str, benchmark: Benchmark) -> None:
    """Run a benchmark as the command line wants it: `--quick` for less work, `--json` for programs."""
    parser = argparse.ArgumentParser(description=title)
    parser.add_argument("--quick", action="store_true", help="less work, rougher figures")
    parser.add_argument("--json", action="store_true", help="print JSON instead of a table")
    options = parser.parse_args()
    figures = benchmark(options.quick)
    if options.json:
        print(json.dumps([figure.as_dict() for figure in figures]))
    else:
        show(title, figures)


def show(title: str, figures: Sequence[Figure]) -> None:
    """Print a heading and one line per figure."""
    print(f"\n{title}")
    for figure in figures:
        mark = {None: "", True: "ok", False: "MISSED"}[figure.holds]
        value = f"{figure.value:,.0f}" if abs(figure.value) >= 1000.0 else f"{figure.value:,.3g}"
        line = (
            f"  {figure.name:50s} {value:>12s} {figure.unit:10s} {figure.budget:>14s} {mark:7s}{figure.note}"
        )
        print(line.rstrip(), flush=True)
