"""Time whole runs of programs with S, M, T and D in each block against the same path without, each in turn."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable
from pathlib import Path

from _measure import Figure, at_most, in_turn, polycnc_command
from _report import run_script

BLOCKS = 180_585
RUNS = 3
RATIO = 2.0
AXES = "".join(f'[[axis]]\nname = "{name}"\nvmax_mm_s = 400\namax_mm_s2 = 4000\n' for name in "XYZ")
MACHINES = {
    "laser": f'name = "laser"\n[spindle]\nlaser = true\nmax_rpm = 1000\n{AXES}',
    "mill": f'name = "mill"\n[spindle]\nmax_rpm = 1000\n{AXES}',
}
WORDS: dict[str, Callable[[int], str]] = {
    "plain": lambda n: "",
    "S": lambda n: f" S{n * 37 % 1000}",
    "S, M3 or M4, T, D": lambda n: f" S{n * 37 % 1000} M{3 + n % 2} T{n % 30} D{n % 9}",
    "M7, M8 or M9": lambda n: f" M{7 + n % 3}",
}


def write(path: Path, kind: str, blocks: int) -> Path:
    """Write a program of a kind with so many blocks: rows of a picture that waver."""
    words = WORDS[kind]
    with path.open("w", encoding="ascii") as file:
        file.write("G21 G90 G94\nM4 S100\nG1 F3000\n")
        for n in range(blocks):
            x, y = 50.0 + 40.0 * math.cos(n * 0.003), 50.0 + 40.0 * math.sin(n * 0.003) + 0.05 * (n % 7)
            file.write(f"X{x:.3f} Y{y:.3f}{words(n)}\n")
        file.write("M5\nM2\n")
    return path


def figures(quick: bool) -> list[Figure]:
    """Measure and return the figures."""
    blocks = BLOCKS // 4 if quick else BLOCKS
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        commands: dict[str, list[str | Path]] = {}
        for machine, text in MACHINES.items():
            file = folder / f"{machine}.toml"
            file.write_text(text)
            for number, kind in enumerate(WORDS):
                for part, count in (("few", 10), ("many", blocks)):
                    path = write(folder / f"{number}{part}.nc", kind, count)
                    command = polycnc_command("run", path, "-d", "grbl", "-m", file)
                    commands[f"{machine} {kind} {part}"] = command
        in_turn(commands, 1)  # compiles, if nothing has compiled yet
        found = in_turn(commands, 1 if quick else RUNS)
    report = []
    for machine in MACHINES:
        seconds = {
            kind: found[f"{machine} {kind} many"].cpu_s - found[f"{machine} {kind} few"].cpu_s
            for kind in WORDS
        }
        what = f"{machine}, plain: a block beyond a small program"
        report.append(Figure(what, seconds["plain"] / blocks * 1e6, "us"))
        for kind in [*WORDS][1:]:
            ratio = seconds[kind] / seconds["plain"]
            note = f"{blocks:,} blocks in {found[f'{machine} {kind} many'].wall_s:.1f} s"
            what = f"{machine}, {kind} in each block, against plain"
            report.append(at_most(what, ratio, "x", RATIO, note))
    return report


if __name__ == "__main__":
    run_script("Laser programs", figures)
