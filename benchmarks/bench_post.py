"""Time the macros of a control file: blocks of a tool path written into memory, and into a file."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path

from _measure import Figure, at_least, median_s
from _report import run_script
from polycnc.post import CONTROLS, ControlFile, load_control, parse_control, program_file, shipped_text

BLOCKS = 200_000
RUNS = 5
BUDGET = 100_000

Words = dict[str, float]


def moves(blocks: int) -> list[Words]:
    """Return the words of `blocks` short moves along a curve in space, as a finishing path has them."""
    feed = {"F": 1200.0, "FEEDMODE": 94}
    return [
        {
            "X": 50.0 * math.cos(0.01 * n),
            "Y": 50.0 * math.sin(0.01 * n),
            "Z": -0.001 * n if n % 3 else -0.001 * (n - 1),
            **feed,
        }
        for n in range(1, blocks + 1)
    ]


def write_path(control: ControlFile, path: list[Words], write: Callable[[str], object]) -> None:
    """Call the macro of a linear move for every point."""
    call = control.start(write).call
    for words in path:
        call("LINEAR", words)


def into_file(control: ControlFile, path: list[Words], file: Path) -> None:
    """Write a program file."""
    with program_file(file, control.parameters) as opened:
        write_path(control, path, opened.write)


def figures(quick: bool) -> list[Figure]:
    """Measure and return the figures."""
    blocks = BLOCKS // 10 if quick else BLOCKS
    path = moves(blocks)
    found = []
    for name in CONTROLS:
        control = load_control(name)
        written: list[str] = []
        write_path(control, path, written.append)
        seconds = median_s(partial(write_path, control, path, lambda block: None), RUNS)
        found.append(at_least(f"{name}, linear moves", len(written) / seconds, "blocks/s", BUDGET))
    with tempfile.TemporaryDirectory() as folder:
        seconds = median_s(partial(into_file, load_control("fanuc-mill"), path, Path(folder) / "a.nc"), RUNS)
    found.append(at_least("fanuc-mill, into a file", blocks / seconds, "blocks/s", BUDGET))
    seconds = median_s(partial(load_anew, "fanuc-mill"), RUNS)
    found.append(Figure("fanuc-mill, read and compile", 1000.0 * seconds, "ms"))
    return found


def load_anew(name: str) -> ControlFile:
    """Read, check and compile a control file."""
    return parse_control(shipped_text(name), f"{name}.toml")


if __name__ == "__main__":
    run_script("Post-processor macros", figures)
