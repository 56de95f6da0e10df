"""Time posting: the macros of a control file alone, tool paths from file to file, and the memory of their proof."""

from __future__ import annotations

import math
import sys
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path

from _measure import Figure, at_least, at_most, median_s, run_process
from _report import run_script
from polycnc.post import CONTROLS, ControlFile, load_control, parse_control, program_file, shipped_text
from polycnc.runner import post_file

BLOCKS = 200_000
RUNS = 5
BUDGET = 100_000
POINTS = 200_000
MILLION = 1_000_000
MEMORY_MB = 330
_PROVE = """
import sys
from polycnc.runner import post_file

post_file(sys.argv[1], "fanuc-mill", sys.argv[2], verify=True)
"""

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
    with tempfile.TemporaryDirectory() as folder:
        found += from_file_to_file(Path(folder), POINTS // 5 if quick else POINTS)
    seconds = median_s(partial(load_anew, "fanuc-mill"), RUNS)
    found.append(Figure("fanuc-mill, read and compile", 1000.0 * seconds, "ms"))
    return found


def write_points(points: int, file: Path) -> None:
    """Write a tool path of points along a helix, close together, as APT words."""
    lines = ["LOADTL/1", "SPINDL/RPM,5000,CLW", "FEDRAT/6000,MMPM", "RAPID", "GOTO/5,0,0"]
    lines += [
        f"GOTO/{5.0 * math.cos(0.01 * n):.4f},{5.0 * math.sin(0.01 * n):.4f},{-0.00001 * n:.4f}"
        for n in range(1, points + 1)
    ]
    file.write_text("\n".join([*lines, "FINI\n"]))


def from_file_to_file(folder: Path, points: int) -> list[Figure]:
    """Time a tool path from its file to that of the program, and see what its proof needs for each point."""
    few, many, program = folder / "few.cl", folder / "many.cl", folder / "a.tap"
    write_points(points // 2, few)
    write_points(points, many)
    seconds = median_s(partial(post_file, many, "fanuc-mill", program), RUNS)
    small, large = (run_process([sys.executable, "-c", _PROVE, path, program]) for path in (few, many))
    each_mb = (large.peak_mb - small.peak_mb) / (points - points // 2)
    whole = small.peak_mb + each_mb * (MILLION - points // 2)
    return [
        at_least("fanuc-mill, from file to file", points / seconds, "points/s", BUDGET),
        at_most("--verify of a million points, by the slope", whole, "MB", MEMORY_MB),
    ]


def load_anew(name: str) -> ControlFile:
    """Read, check and compile a control file."""
    return parse_control(shipped_text(name), f"{name}.toml")


if __name__ == "__main__":
    run_script("Post-processor macros", figures)
