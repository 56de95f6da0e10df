"""The command line of `scripts/mutate`."""

from __future__ import annotations

import argparse
import random
import sys
import time
from collections import Counter
from pathlib import Path

from support.mutation import Mutant, Session, candidate_tests, mutants_of

ROOT = Path(__file__).resolve().parents[1]


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="scripts/mutate",
        description="Change modules in one place at a time, run the tests that reach the place, report what no test"
        " notices. The work is done in a copy; the repository is not touched.",
        epilog="The status is 0 when everything was noticed, 1 when something survived, 2 for a wrong call.",
    )
    parser.add_argument("modules", nargs="+", type=Path, help="modules or folders below src/polycnc")
    parser.add_argument("--sample", type=int, metavar="N", help="take N changes at random instead of all")
    parser.add_argument("--seed", type=int, default=1, help="which sample (default 1)")
    parser.add_argument(
        "--tests", nargs="+", type=Path, metavar="FILE", help="test files instead of those that fit"
    )
    parser.add_argument("--lines", metavar="A-B", help="only changes in these lines")
    parser.add_argument("--kinds", nargs="+", metavar="KIND", help="only changes of these kinds")
    parser.add_argument("--jit", action="store_true", help="run compiled: slower, but what users run")
    parser.add_argument("--verbose", action="store_true", help="say of each change who noticed it, and when")
    parser.add_argument("--list", action="store_true", help="show the changes and run nothing")
    return parser.parse_args()


def modules_of(given: list[Path]) -> list[Path]:
    found: list[Path] = []
    for each in given:
        path = each.resolve()
        files = sorted(path.rglob("*.py")) if path.is_dir() else [path]
        if not files or any(not file.is_file() or ROOT / "src" not in file.parents for file in files):
            sys.exit(f"scripts/mutate: {each} is no module below src\nName modules or folders there.")
        found += files
    return found


def chosen(options: argparse.Namespace, modules: list[Path]) -> list[tuple[Path, Mutant]]:
    pool = [(module, mutant) for module in modules for mutant in mutants_of(module.read_bytes())]
    if options.lines:
        first, _, last = options.lines.partition("-")
        wanted = range(int(first), int(last or first) + 1)
        pool = [(module, mutant) for module, mutant in pool if mutant.lines[0] in wanted]
    if options.kinds:
        pool = [(module, mutant) for module, mutant in pool if mutant.kind in options.kinds]
    if options.sample is not None and options.sample < len(pool):
        places = sorted(random.Random(options.seed).sample(range(len(pool)), options.sample))
        pool = [pool[place] for place in places]
    return pool


def main() -> int:
    options = arguments()
    modules = modules_of(options.modules)
    pool = chosen(options, modules)
    if options.list:
        for module, mutant in pool:
            print(
                f"{module.relative_to(ROOT)}:{mutant.lines[0]} {mutant.kind}\n{mutant.diff(module.read_bytes())}"
            )
        print(f"{len(pool)} changes")
        return 0
    tests = [path.resolve() for path in options.tests] if options.tests else candidate_tests(ROOT, modules)
    begun = time.monotonic()
    with Session(ROOT, jit=options.jit) as session:
        try:
            reach = session.reach(modules, tests)
        except RuntimeError as error:
            sys.exit(f"scripts/mutate: {error}\nRun scripts/test first.")
        print(
            f"{len(pool)} changes, {len(reach.times_s)} tests in {len(tests)} files, "
            f"{time.monotonic() - begun:.0f} s to see what they reach",
            flush=True,
        )
        for test in reach.failed:
            print(f"left out, it fails with nothing changed: {test}", flush=True)
        found = Counter[str]()
        for module, mutant in pool:
            outcome = session.outcome(module, mutant, reach)
            found[outcome.verdict] += 1
            if outcome.noticed and options.verbose:
                print(
                    f"{time.monotonic() - begun:.0f} s {outcome.verdict} {mutant.lines[0]} {outcome.by}",
                    flush=True,
                )
            if not outcome.noticed:
                place = f"{module.relative_to(ROOT)}:{mutant.lines[0]}"
                print(f"{outcome.verdict}: {place} {mutant.kind} ({outcome.tests} tests)", flush=True)
                print(mutant.diff(session.source(module)), flush=True)
    noticed = found["killed"] + found["timeout"] + found["crash"]
    reached = len(pool) - found["unreached"]
    print(", ".join(f"{count} {verdict}" for verdict, count in sorted(found.items())))
    print(
        f"kill rate {100 * noticed / max(1, len(pool)):.1f} %, "
        f"of those reached {100 * noticed / max(1, reached):.1f} %, {time.monotonic() - begun:.0f} s"
    )
    return 0 if noticed == len(pool) else 1


if __name__ == "__main__":
    sys.exit(main())
