"""Run the command line as users do: a process of its own, in a folder of its own."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from polycnc.jit import COMPILING

COMMAND = (sys.executable, "-m", "polycnc.cli")


def environment(**more: str) -> dict[str, str]:
    """Return the environment of a user's process: without what tests set, and 80 columns wide."""
    kept = {name: value for name, value in os.environ.items() if name != "POLYCNC_OPEN_INTERNALS"}
    return {**kept, "COLUMNS": "80", "PYTHONUTF8": "1", **more}


def polycnc(
    *arguments: str | Path, cwd: Path | None = None, status: int = 0, **more: str
) -> subprocess.CompletedProcess[str]:
    """Run the command, hold it to an exit status, and return what it printed."""
    done = subprocess.run(
        [*COMMAND, *map(str, arguments)],
        cwd=cwd,
        env=environment(**more),
        capture_output=True,
        text=True,
        encoding="utf-8",
        timeout=240,
        stdin=subprocess.DEVNULL,
        check=False,
    )
    assert done.returncode == status, f"exit status {done.returncode}\n{done.stdout}\n{done.stderr}"
    assert "Traceback" not in done.stderr, done.stderr
    done.stderr = done.stderr.replace(f"{COMPILING}\n", "")  # said or not, depending on what ran before
    return done
