"""Compare this tree with another one: both trees' benchmarks in turn, figures of the same name side by side.

    python benchmarks/compare.py ../before [--rounds 3] [--only bench_profile.py ...]

Each tree runs its own scripts with this interpreter, its own package and a cache of its own. Medians stand beside their
ratio, which is fair also when other work shares the machine, since the trees take turns.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

HERE = Path(__file__).parent


def measure(tree: Path, script: str, cache: Path) -> dict[str, tuple[float, str]]:
    """Return value and unit of each figure of a script, by name; nothing where a tree does not have it."""
    path = tree / "benchmarks" / script
    if not path.exists():
        return {}
    environment = {**os.environ, "PYTHONPATH": str(tree / "src"), "POLYCNC_CACHE_DIR": str(cache)}
    done = subprocess.run(
        [sys.executable, str(path), "--json", "--quick"],
        stdout=subprocess.PIPE,
        text=True,
        check=False,
        env=environment,
    )
    if done.returncode:
        print(f"{path} failed", file=sys.stderr)
        return {}
    return {figure["name"]: (figure["value"], figure["unit"]) for figure in json.loads(done.stdout)}


def main() -> int:
    """Print the table; return the exit status."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("before", type=Path, help="the other tree")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--only", nargs="*", help="scripts")
    options = parser.parse_args()
    scripts = options.only or sorted(path.name for path in HERE.glob("bench_*.py"))
    trees = {"before": options.before.resolve(), "after": HERE.parent}
    with TemporaryDirectory() as name:
        for script in scripts:
            found: dict[str, dict[str, list[float]]] = {"before": {}, "after": {}}
            units: dict[str, str] = {}
            for _ in range(options.rounds):
                for which, tree in trees.items():
                    for figure, (value, unit) in measure(tree, script, Path(name) / which).items():
                        found[which].setdefault(figure, []).append(value)
                        units[figure] = unit
            print(f"\n{script}")
            for figure, unit in units.items():
                medians = [
                    statistics.median(found[which].get(figure, [])) if found[which].get(figure) else None
                    for which in trees
                ]
                before, after = medians
                ratio = f"{after / before:8.3f}" if before and after is not None else " " * 8
                shown = "".join(f"{'-' if each is None else f'{each:,.4g}':>14s}" for each in medians)
                print(f"  {figure:58s}{shown}  {ratio}  {unit}", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
