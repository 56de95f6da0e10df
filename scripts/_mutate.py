"""The command line of `scripts/mutate`."""

from __future__ import annotations

import argparse
import random
import sys
import time
from collections import Counter
from pathlib import Path

from support.mutation import Mutant, Outcome, Session, candidate_tests, mutants_of

ROOT = Path(__file__).resolve().parents[1]


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="scripts/mutate",
        description="Change modules in one place at a time, run the tests that reach the place, report what no test"
        " notices. The work is done in a copy; the repository is not touched.",
        epilog="The status is 0 when everything was noticed, 1 when something survived, 2 for a wrong call.",
    )
    parser.add_argument("modules", nargs="+", type=Path, help="modules or folders below src/polycnc")
    parser.add_argument(
        "--sample", type=int, metavar="N", help="take N changes of each at random instead of all"
    )
    parser.add_argument("--seed", type=int, default=1, help="which sample (default 1)")
    parser.add_argument(
        "--tests", nargs="+", type=Path, metavar="FILE", help="test files instead of those that fit"
    )
    parser.add_argument(
        "--slowest",
        type=float,
        default=0.0,
        metavar="S",
        help="leave out tests that take more processor time",
    )
    parser.add_argument(
        "--limit", type=float, default=120.0, metavar="S", help="of tests for one change (default 120)"
    )
    parser.add_argument("--lines", metavar="A-B", help="only changes in these lines")
    parser.add_argument("--kinds", nargs="+", metavar="KIND", help="only changes of these kinds")
    parser.add_argument("--jit", action="store_true", help="run compiled: slower, but what users run")
    parser.add_argument("--verbose", action="store_true", help="say of each change who noticed it, and when")
    parser.add_argument("--list", action="store_true", help="show the changes and run nothing")
    return parser.parse_args()


def modules_of(given: Path) -> list[Path]:
    path = given.resolve()
    files = sorted(path.rglob("*.py")) if path.is_dir() else [path]
    if not files or any(not file.is_file() or ROOT / "src" not in file.parents for file in files):
        sys.exit(f"scripts/mutate: {given} is no module below src\nName modules or folders there.")
    return files


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


def said(session: Session, module: Path, mutant: Mutant, outcome: Outcome, *, verbose: bool) -> str:
    place = f"{module.relative_to(ROOT)}:{mutant.lines[0]} {mutant.kind}"
    if not outcome.noticed:
        return f"{outcome.verdict}: {place} ({outcome.tests} tests)\n{mutant.diff(session.source(module))}"
    return f"{outcome.verdict}: {place} {outcome.by}" if verbose else ""


def summary(found: Counter[str]) -> str:
    noticed, count = found["killed"] + found["timeout"] + found["crash"], found.total()
    return (
        ", ".join(f"{each} {verdict}" for verdict, each in sorted(found.items()))
        + f"; kill rate {100 * noticed / max(1, count):.1f} %, "
        f"of those reached {100 * noticed / max(1, count - found['unreached']):.1f} %"
    )


def main() -> int:
    options = arguments()
    modules = {given: modules_of(given) for given in options.modules}
    pools = {given: chosen(options, files) for given, files in modules.items()}
    count = sum(map(len, pools.values()))
    if options.list:
        for pool in pools.values():
            for module, mutant in pool:
                print(f"{module.relative_to(ROOT)}:{mutant.lines[0]} {mutant.kind}")
                print(mutant.diff(module.read_bytes()))
        print(f"{count} changes")
        return 0
    everything = [module for files in modules.values() for module in files]
    tests = [path.resolve() for path in options.tests] if options.tests else candidate_tests(ROOT, everything)
    begun = time.monotonic()
    survived = False
    with Session(ROOT, jit=options.jit) as session:
        try:
            reach = session.reach(everything, tests, slowest_s=options.slowest, limit_s=options.limit)
        except RuntimeError as error:
            sys.exit(f"scripts/mutate: {error}\nRun scripts/test first.")
        if not reach.tests:
            sys.exit("scripts/mutate: these tests do not even import the modules\nName others with --tests.")
        print(
            f"{count} changes, {len(reach.times_s)} tests in {len(tests)} files, "
            f"{time.monotonic() - begun:.0f} s to see what they reach",
            flush=True,
        )
        for test in reach.failed:
            print(f"left out, it fails or is too slow with nothing changed: {test}", flush=True)
        for given, pool in pools.items():
            found = Counter[str]()
            for module, mutant in pool:
                outcome = session.outcome(module, mutant, reach)
                found[outcome.verdict] += 1
                survived |= not outcome.noticed
                if text := said(session, module, mutant, outcome, verbose=options.verbose):
                    print(text, flush=True)
            print(f"{given}: {summary(found)}, {time.monotonic() - begun:.0f} s", flush=True)
    return 1 if survived else 0


if __name__ == "__main__":
    sys.exit(main())
