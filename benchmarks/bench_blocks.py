"""Time whole runs of long programs, process start to cycle time, with LinuxCNC's `rs274` beside them."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

from _measure import Figure, Process, at_least, at_most, in_turn, polycnc_command
from _programs import write_program
from _report import run_script

RUNS = 3
MEMORY_MB = 250.0
GROWTH_MB = 100.0


def figures(quick: bool) -> list[Figure]:
    """Measure and return the figures."""
    few, many = 1_000_000, 2_000_000 if quick else 5_000_000
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        small = write_program(folder / "few.ngc", few)
        large = write_program(folder / "many.ngc", many)
        found = _measured(folder, {"few": small, "many": large}, 1 if quick else RUNS)
        grown_file_mb = (large.stat().st_size - small.stat().st_size) / 2**20
    return [*_own(found, few, many, grown_file_mb), *_against_peer(found, few, many)]


def _measured(folder: Path, programs: dict[str, Path], runs: int) -> dict[str, Process]:
    commands: dict[str, list[str | Path]] = {
        f"polycnc {name}": polycnc_command("run", path, "--dialect", "din", "--json")
        for name, path in programs.items()
    }
    peer = shutil.which("rs274")
    if peer is not None:
        (folder / "tools.tbl").write_text("T1 P1 D0 Z0 ;\n")
        for name, path in programs.items():
            commands[f"rs274 {name}"] = [peer, "-t", folder / "tools.tbl", "-g", path]
    in_turn({"warm": commands["polycnc few"]}, 1)  # compiles, if nothing has compiled yet
    return in_turn(commands, runs, {"HOME": str(folder), "POLYCNC_CACHE_DIR": _cache_folder()})


def _cache_folder() -> str:
    from polycnc.jit import CACHE_FOLDER

    assert CACHE_FOLDER is not None
    return str(CACHE_FOLDER.parents[1])


def _own(found: dict[str, Process], few: int, many: int, grown_file_mb: float) -> list[Figure]:
    small, large = found["polycnc few"], found["polycnc many"]
    further = (large.wall_s - small.wall_s) / (many - few) * 1e6
    grown = large.peak_mb - small.peak_mb - grown_file_mb
    return [
        Figure(f"{few:,} blocks, whole process", small.wall_s, "s", note=f"processor {small.cpu_s:.2f} s"),
        Figure(f"{many:,} blocks, whole process", large.wall_s, "s", note=f"processor {large.cpu_s:.2f} s"),
        Figure("each further million blocks", further, "s"),
        at_most(f"{few:,} blocks, peak memory", small.peak_mb, "MB", MEMORY_MB),
        at_most(f"{many:,} blocks, memory beyond file and that", grown, "MB", GROWTH_MB),
    ]


def _against_peer(found: dict[str, Process], few: int, many: int) -> list[Figure]:
    if "rs274 few" not in found:
        return [Figure("rs274 (LinuxCNC)", 0.0, "s", note="not installed")]
    own, peer = found["polycnc few"], found["rs274 few"]
    own_many, peer_many = found["polycnc many"], found["rs274 many"]
    wall = (peer_many.wall_s - peer.wall_s) / (own_many.wall_s - own.wall_s)
    cpu = (peer_many.cpu_s - peer.cpu_s) / (own_many.cpu_s - own.cpu_s)
    return [
        Figure(f"{few:,} blocks with rs274", peer.wall_s, "s", note=f"{few / peer.wall_s:,.0f} blocks/s"),
        at_least("ratio to rs274", peer.wall_s / own.wall_s, "x", 1.5, _cpu(peer.cpu_s / own.cpu_s)),
        at_least("ratio to rs274, each further block", wall, "x", 5.0, _cpu(cpu)),
    ]


def _cpu(ratio: float) -> str:
    return f"by processor time {ratio:.2f}"


if __name__ == "__main__":
    run_script("Long programs", figures)
