"""Time statements of custom macros, and the same ones with O-words in LinuxCNC's rs274 where it is installed."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
import time
from pathlib import Path

from _measure import Figure, at_least, median_s
from _report import run_script
from polycnc.machine import Machine, load_machine
from polycnc.nc import Channel, ProgramText, load_dialect
from polycnc.nc.macro import MacroLanguage

RUNS = 5
STATEMENTS_PER_ROUND = 6
FLOOR = 1e6


def _macro(rounds: int) -> str:
    return (
        f"#1=0\n#2=0\nWHILE [#1 LT {rounds}] DO1\n#2=#2+#1*0.5\n#3=SIN[#1]\n"
        "IF [#3 GT 0.5] THEN #2=#2-1\n#1=#1+1\nEND1\nM30\n"
    )


def _jumps(rounds: int) -> str:
    return f"#1=0\nN1 #1=#1+1\n#2=#2+2\nIF [#1 LT {rounds}] GOTO 1\nM30\n"


def _o_words(rounds: int) -> str:
    return (
        f"#1=0\n#2=0\no1 while [#1 LT {rounds}]\n#2=[#2+#1*0.5]\n#3=SIN[#1]\no2 if [#3 GT 0.5]\n#2=[#2-1]\n"
        "o2 endif\n#1=[#1+1]\no1 endwhile\nM2\n"
    )


def _prepare(text: str) -> None:
    machine = Machine(load_machine(None))
    program = ProgramText.from_text(text)
    channel = Channel(program, load_dialect("fanuc"), machine, language=MacroLanguage())
    while not channel.done:
        channel.machine.clock.tick(1)  # a control prepares so much in a cycle
        channel.fill()
    assert channel.error is None


def figures(quick: bool) -> list[Figure]:
    """Measure and return the figures."""
    rounds = 30_000 if quick else 200_000
    loop, jumps = _macro(rounds), _jumps(rounds)
    here = STATEMENTS_PER_ROUND * rounds / median_s(lambda: _prepare(loop), RUNS)
    found = [
        at_least("loop with a sine, statements", here, "statements/s", FLOOR),
        at_least(
            "GOTO, statements", 3 * rounds / median_s(lambda: _prepare(jumps), RUNS), "statements/s", FLOOR
        ),
    ]
    command = shutil.which("rs274")
    if command is not None:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "words.ngc"
            path.write_text(_o_words(rounds))
            before = time.perf_counter()
            subprocess.run([command, "-g", str(path)], capture_output=True, check=False)
            there = STATEMENTS_PER_ROUND * rounds / (time.perf_counter() - before)
        found.append(Figure("rs274, the loop with O-words", there, "statements/s"))
        found.append(Figure("ratio to rs274", here / there, ""))
    return found


if __name__ == "__main__":
    run_script("Custom macros", figures)
