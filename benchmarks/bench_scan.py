"""Time the block scanners on programs in memory: blocks and words per second, best and median of runs.

Run it as a script. The first scan, which compiles or loads the scanner, is not counted.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable

import numpy as np

from polycnc.nc._program import ProgramText, TextRules
from polycnc.nc._scan import scan, scan_rules, word_columns
from polycnc.nc._scan_plain import scan_blocks

BLOCKS = 1_000_000
SLOW_BLOCKS = 20_000
RUNS = 7
CHUNK_BLOCKS = 1 << 14

Shape = Callable[[int, float, float], str]
SHAPES: dict[str, Shape] = {
    "full blocks": lambda n, x, y: f"N{10 * n} G1 X{x:.3f} Y{y:.3f} F1000",
    "short blocks": lambda n, x, y: f"X{x:.3f} Y{y:.3f}",
    "with a comment": lambda n, x, y: f"G1 X{x:.3f} Y{y:.3f} (cut {n})",
    "blanks after letters": lambda n, x, y: f"N {n} G 1 X {x:.3f} Y {y:.3f}",
    "every tenth a statement": lambda n, x, y: "#1=[#1+1]" if n % 10 == 0 else f"G1 X{x:.3f} Y{y:.3f}",
}


def make_program(shape: Shape, blocks: int) -> ProgramText:
    """Return a program of `blocks` lines of one shape, the same at every run."""
    points = np.random.default_rng(1).uniform(-300.0, 300.0, (blocks, 2))
    return ProgramText.from_text("".join(f"{shape(n, x, y)}\n" for n, (x, y) in enumerate(points)))


def scan_all(text: ProgramText) -> tuple[int, int]:
    """Scan all of the text with the compiled scanner; return blocks and words."""
    rules = scan_rules(TextRules())
    columns = word_columns(CHUNK_BLOCKS)
    offset, line, blocks, words = 0, 1, 0, 0
    while offset < len(text):
        offset = scan(text.data, offset, line, rules, columns)
        line = columns.next_line
        blocks += columns.n_blocks
        words += columns.n_words
    return blocks, words


def scan_all_plain(text: ProgramText) -> tuple[int, int]:
    """Scan all of the text with the ordinary scanner; return blocks and words."""
    words = [len(block.words) for block in scan_blocks(text, TextRules())]
    return len(words), sum(words)


def report(
    name: str, text: ProgramText, scanner: Callable[[ProgramText], tuple[int, int]], runs: int
) -> None:
    """Print one line of figures."""
    times = []
    for _ in range(runs):
        start = time.perf_counter()
        blocks, words = scanner(text)
        times.append(time.perf_counter() - start)
    best, median = min(times), statistics.median(times)
    print(
        f"{name:32} {blocks / best / 1e6:8.2f} M blocks/s best, {blocks / median / 1e6:8.2f} median,"
        f" {words / median / 1e6:8.2f} M words/s, {len(text) / median / 1e6:8.1f} MB/s"
    )


def main() -> None:
    """Print the figures of every shape of program."""
    scan_all(ProgramText.from_text("G1 X1\n"))
    for name, shape in SHAPES.items():
        report(name, make_program(shape, BLOCKS), scan_all, RUNS)
    report(
        "full blocks, ordinary scanner", make_program(SHAPES["full blocks"], SLOW_BLOCKS), scan_all_plain, 3
    )


if __name__ == "__main__":
    main()
