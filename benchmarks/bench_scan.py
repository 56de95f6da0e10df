"""Time the block scanners on programs in memory."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from _measure import Figure, median_s
from _report import run_script
from polycnc.nc.text._program import ProgramText, TextRules
from polycnc.nc.text._scan import scan, scan_rules, word_columns
from polycnc.nc.text._scan_plain import scan_blocks

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


def figures(quick: bool) -> list[Figure]:
    """Measure and return the figures."""
    blocks = BLOCKS // 10 if quick else BLOCKS
    found = []
    for name, shape in SHAPES.items():
        text = make_program(shape, blocks)
        seconds = median_s(partial(scan_all, text), RUNS)
        words = scan_all(text)[1] / seconds / 1e6
        found.append(Figure(name, blocks / seconds, "blocks/s", note=f"{words:.1f} M words/s"))
    text = make_program(SHAPES["full blocks"], SLOW_BLOCKS)
    seconds = median_s(partial(scan_all_plain, text), 3)
    return [*found, Figure("full blocks, ordinary scanner", SLOW_BLOCKS / seconds, "blocks/s")]


if __name__ == "__main__":
    run_script("Block scanner", figures)
