"""Time whole runs of programs with a variable in each block against the same programs without."""

from __future__ import annotations

import tempfile
from pathlib import Path

from _measure import Figure, at_most, in_turn, polycnc_command
from _report import run_script

BLOCKS = 80_000
RUNS = 3
BLOCK_US, BYTES_PER_BYTE = 20.0, 40.0
KINDS = {
    "plain": ("fanuc", "", "F1200.", "M30"),
    "F#101": ("fanuc", "#101=1200.\n", "F#101", "M30"),
    "F[A]": ("bosch", "10 A=1200.0\n", "F[A]", "M30"),
}


def write(path: Path, kind: str, blocks: int) -> Path:
    """Write a program of a kind with so many blocks."""
    _, head, feed, end = KINDS[kind]
    lines = (f"N{n + 1} G1 X{n * 7 % 90}.{n % 10} Y{n * 3 % 60}.{n % 7} {feed}" for n in range(blocks))
    path.write_text(f"{head}G90 G94 G17\n" + "\n".join(lines) + f"\n{end}\n")
    return path


def figures(quick: bool) -> list[Figure]:
    """Measure and return the figures."""
    blocks = BLOCKS // 4 if quick else BLOCKS
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        commands: dict[str, list[str | Path]] = {}
        sizes: dict[tuple[str, str], int] = {}
        for kind, (dialect, *_) in KINDS.items():
            own = folder / dialect
            own.mkdir(exist_ok=True)
            for part, count in (("few", 10), ("many", blocks)):
                path = write(own / f"{len(sizes)}.nc", kind, count)
                sizes[kind, part] = path.stat().st_size
                commands[f"{kind} {part}"] = polycnc_command("run", path, "-d", dialect, "--json")
        in_turn(commands, 1)  # compiles, if nothing has compiled yet
        found = in_turn(commands, 1 if quick else RUNS)
    report = []
    for kind in KINDS:
        few, many = found[f"{kind} few"], found[f"{kind} many"]
        block_us = (many.cpu_s - few.cpu_s) / blocks * 1e6
        memory = (many.peak_mb - few.peak_mb) * 2**20 / (sizes[kind, "many"] - sizes[kind, "few"])
        report += [
            at_most(f"{kind}: a block beyond a small program", block_us, "us", BLOCK_US),
            at_most(f"{kind}: memory for each byte of text", memory, "bytes", BYTES_PER_BYTE),
        ]
    return report


if __name__ == "__main__":
    run_script("Programs with variables", figures)
