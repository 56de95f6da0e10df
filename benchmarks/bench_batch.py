"""Time batches: two processes against one, what a batch costs beyond its programs, and memory with very many."""

from __future__ import annotations

import resource
import statistics
import sys
import tempfile
import time
from pathlib import Path

import polycnc
from _measure import Figure, at_least, at_most
from _report import run_script
from polycnc.machine import load_machine

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


def _own_cpu_s(paths: list[Path]) -> float:
    """Return the processor time of the programs in this process, one after the other."""
    config = load_machine(None)
    polycnc.run(paths[0], config)
    begin = time.process_time()
    for path in paths:
        polycnc.run(path, config, check=False)
    return time.process_time() - begin


def _batch_cpu_s(paths: list[Path]) -> float:
    """Return the processor time of a batch on one process, and of that process."""

    def spent() -> float:
        both = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
        return sum(each.ru_utime + each.ru_stime for each in both)

    begin = spent()
    with polycnc.batch(paths, jobs=1) as result:
        assert result.ok
    return spent() - begin


def figures(quick: bool) -> list[Figure]:
    """Measure and return the figures."""
    count = 200 if quick else 1_000
    found = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "store"
        _write(folder, count, 40)
        rounds = 1 if quick else 3
        pairs = [(_wall_s(folder, 1), _wall_s(folder, 2)) for _ in range(rounds)]
        steady = statistics.median(one[1] / two[1] for one, two in pairs)
        whole = statistics.median(one[0] / two[0] for one, two in pairs)
        paths = sorted(folder.iterdir())
        more, fewer = paths, paths[: count // 2]  # the difference has no start of a process in it
        of_batch_s = (_batch_cpu_s(more) - _batch_cpu_s(fewer)) / (len(more) - len(fewer))
        over_ms = 1000.0 * (of_batch_s - _own_cpu_s(more) / len(more))
        found = [
            at_least(f"{count} programs, two processes against one, warm", steady, "times", 1.8),
            Figure("the same with starting the processes", whole, "times"),
            at_most("cost of a program beyond its run, warm process", over_ms, "ms", 3.0, "processor"),
        ]
        small = Path(name) / "small"
        many = 2_000 if quick else MANY
        _write(small, many, 1)
        before = _peak_mb()
        begin = time.perf_counter()
        with polycnc.batch(small, jobs=2) as result:
            result.save(Path(name) / "out.csv")
        found += [
            Figure(f"{many:,} small programs", (time.perf_counter() - begin) / many * 1000.0, "ms each"),
            at_most(f"memory of the batch with {many:,} programs", _peak_mb() - before, "MB more", 200.0),
        ]
    return found


def _peak_mb() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (2**20 if sys.platform == "darwin" else 2**10)


if __name__ == "__main__":
    run_script("Batches", figures)
