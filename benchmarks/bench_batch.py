"""Time batches: two processes against one, what a batch costs beyond its programs, and memory with very many."""

from __future__ import annotations

import argparse
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import polycnc
from _measure import Figure, at_least, at_most
from _report import run_script, show
from polycnc.machine import load_machine
from polycnc.nc import ProgramText

PROGRAM = "T{0} M6\nG0 X{1} Y2 Z5\nG1 Z-{2} F300\n{3}G0 Z50\nM30\n"
MANY = 100_000


def _write(folder: Path, count: int, contours: int) -> None:
    """Write programs that mill some contours each."""
    folder.mkdir()
    for number in range(count):
        lines = "".join(
            f"G1 X{70 + turn + number % 7} F{900 + number % 400}\nG1 Y{40 + turn}\n"
            f"G3 X10 Y{40 + turn} R{60 + turn}\nG1 Y2\n"
            for turn in range(contours)
        )
        (folder / f"p{number:06}.nc").write_text(PROGRAM.format(number % 9 + 1, 10, 1.5, lines))


def _wall_s(folder: Path, jobs: int) -> tuple[float, float]:
    """Return how long a batch takes, and how long from its first report to its last."""
    seen: list[float] = []

    def note(number: int, total: int) -> None:
        seen.append(time.perf_counter())

    begin = time.perf_counter()
    with polycnc.batch(folder, jobs=jobs, progress=note) as result:
        assert result.ok
    return time.perf_counter() - begin, seen[-1] - seen[0]


def _own_cpu_s(folder: Path) -> float:
    """Return the processor time of a folder's programs, one after the other in a process like those of batches."""
    environment = {"MALLOC_MMAP_THRESHOLD_": "131072", **os.environ}
    command = [sys.executable, __file__, "--alone", str(folder)]
    return float(subprocess.run(command, env=environment, stdout=subprocess.PIPE, check=True).stdout)


def _alone(folder: Path) -> None:
    """Run the programs of a folder and print their processor time in s."""
    config = load_machine(None)
    texts = [(str(path), path.read_bytes()) for path in sorted(folder.iterdir())]
    for name, content in texts[:20]:
        polycnc.run(ProgramText(name, content), config, check=False)
    begin = time.process_time()
    for name, content in texts:
        polycnc.run(ProgramText(name, content), config, check=False)
    print(time.process_time() - begin)


def _batch_cpu_s(paths: list[Path]) -> tuple[float, float]:
    """Return the processor time of a batch on one process with that of the process, and without."""

    def spent(who: int) -> float:
        used = resource.getrusage(who)
        return used.ru_utime + used.ru_stime

    own, of_child = spent(resource.RUSAGE_SELF), spent(resource.RUSAGE_CHILDREN)
    with polycnc.batch(paths, jobs=1) as result:
        assert result.ok
    own = spent(resource.RUSAGE_SELF) - own
    return own + spent(resource.RUSAGE_CHILDREN) - of_child, own


def _ratio_figures(count: int, rounds: int) -> list[Figure]:
    """Measure two processes against one, and what a program costs beyond its run."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "store"
        _write(folder, count, 40)
        pairs = [(_wall_s(folder, 1), _wall_s(folder, 2)) for _ in range(rounds)]
        steady = statistics.median(one[1] / two[1] for one, two in pairs)
        whole = statistics.median(one[0] / two[0] for one, two in pairs)
        paths = sorted(folder.iterdir())
        more, fewer = paths, paths[: count // 2]  # the difference has no start of a process in it
        (all_s, own_s), (half_s, _) = _batch_cpu_s(more), _batch_cpu_s(fewer)
        of_batch_s = (all_s - half_s) / (len(more) - len(fewer))
        over_ms = 1000.0 * (of_batch_s - _own_cpu_s(folder) / len(more))
    return [
        at_least(f"{count} programs, two processes against one, warm", steady, "times", 1.8),
        Figure("the same with starting the processes", whole, "times"),
        at_most("cost of a program beyond its run, warm process", over_ms, "ms", 3.0, "processor"),
        Figure("of it in the process that hands them out", 1000.0 * own_s / count, "ms", note="processor"),
    ]


def _count_figures(count: int) -> list[Figure]:
    """Run very many small programs and measure time and memory."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "small"
        _write(folder, count, 1)
        before = _peak_mb()
        begin = time.perf_counter()
        with polycnc.batch(folder, jobs=2) as result:
            result.save(Path(name) / "out.csv")
        each_ms = (time.perf_counter() - begin) / count * 1000.0
    return [
        Figure(f"{count:,} small programs", each_ms, "ms each"),
        at_most(f"memory of the batch with {count:,} programs", _peak_mb() - before, "MB more", 200.0),
    ]


def figures(quick: bool) -> list[Figure]:
    """Measure and return the figures."""
    ratio = _ratio_figures(200, 1) if quick else _ratio_figures(1_000, 3)
    return ratio + _count_figures(2_000 if quick else MANY)


def _peak_mb() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (2**20 if sys.platform == "darwin" else 2**10)


def _main() -> None:
    parser = argparse.ArgumentParser(description="Batches", add_help=False)
    parser.add_argument(
        "--ratio", action="store_true"
    )  # two processes against one, and the cost of a program
    parser.add_argument("--count", type=int)  # so many small programs
    parser.add_argument("--alone", type=Path)
    options, _ = parser.parse_known_args()
    if options.alone is not None:
        _alone(options.alone)
    elif options.ratio:
        show("Batches: processes", _ratio_figures(1_000, 1))
    elif options.count:
        show("Batches: many", _count_figures(options.count))
    else:
        run_script("Batches", figures)


if __name__ == "__main__":
    _main()
