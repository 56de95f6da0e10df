"""Time statements of CPL and its link step, and the same statements with O-words in rs274 where it is installed."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
import time
from pathlib import Path

from _measure import Figure, at_least, at_most, median_s
from _report import run_script
from polycnc.controllers.bosch import BoschSystem, ChannelHost
from polycnc.machine import Clock, load_machine
from polycnc.nc.cpl import Linker, Run

RUNS = 5
STATEMENTS_PER_ROUND = 6
FLOOR = 1e6
LINK_S = 0.5
LINES = 10_000


def _loop(rounds: int) -> str:
    return (
        f"1 I%=0 : X=0\n2 WHILE I%<{rounds} DO\n3 X=X+I%*0.5\n4 Y=SIN(I%)\n5 IF Y>0.5 THEN X=X-1 ENDIF\n"
        "6 I%=I%+1\n7 END\n"
    )


def _o_words(rounds: int) -> str:
    return (
        f"#1=0\n#2=0\no1 while [#1 LT {rounds}]\n#2=[#2+#1*0.5]\n#3=SIN[#1]\no2 if [#3 GT 0.5]\n#2=[#2-1]\n"
        "o2 endif\n#1=[#1+1]\no1 endwhile\nM2\n"
    )


def _long(lines: int) -> str:
    block = (
        "{0} X{1}=SIN({1})*12.5+Y{1}/3", "{0} IF X{1}>2.75 THEN I%=I%+{1} ELSE I%=I%-3 ENDIF",
        "N{0} G1 X[X{1}] Y[Y{1}*2] F[1000+I%]", "N{0} G0 Z5", "{0} FOR K%=1 TO 5", "{0} F(K%)=K%*2.5+F(K%)",
        "N{0} X[F(K%)]", "{0} NEXT K%", "{0} REM remark", '{0} A$="TEXT" : B%=LEN(A$)',
    )  # fmt: skip
    text = "\n".join(block[line % 10].format(line + 1, line // 10 % 50) for line in range(lines))
    return f"1 DIM F(9) : DIM A$(20)\n{text}"


def figures(quick: bool) -> list[Figure]:
    """Measure and return the figures."""
    rounds = 30_000 if quick else 200_000
    text, lines = _loop(rounds), _long(LINES)
    with tempfile.TemporaryDirectory() as folder:
        host = ChannelHost(BoschSystem(Path(folder), Clock(0.001), load_machine(None)))

        def run() -> None:
            linker = Linker(host.program)
            main, errors = linker.link(text, "loop.npg")
            assert main is not None, errors
            execution = Run(main, linker, host)
            while execution.step() is not None:
                pass

        def link() -> None:
            main, errors = Linker(host.program).link(lines, "long.npg")
            assert main is not None, errors

        def begin() -> None:
            main, errors = Linker(host.program).link(lines, "long.npg")
            assert main is not None, errors
            Run(main, Linker(host.program), host)

        here = STATEMENTS_PER_ROUND * rounds / median_s(run, RUNS)
        found = [
            at_least("CPL loop with a sine, statements", here, "statements/s", FLOOR),
            at_most(f"linking {LINES:,} lines", median_s(link, RUNS), "s", LINK_S),
            Figure(f"linking {LINES:,} lines and beginning to run them", median_s(begin, RUNS), "s"),
        ]
        command = shutil.which("rs274")
        if command is not None:
            path = Path(folder) / "words.ngc"
            path.write_text(_o_words(rounds))
            before = time.perf_counter()
            subprocess.run([command, "-g", str(path)], capture_output=True, check=False)
            there = STATEMENTS_PER_ROUND * rounds / (time.perf_counter() - before)
            found.append(Figure("rs274, the loop with O-words", there, "statements/s"))
            found.append(Figure("ratio to rs274", here / there, ""))
    return found


if __name__ == "__main__":
    run_script("CPL", figures)
