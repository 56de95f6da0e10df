"""``polycnc warmup``: compile beforehand what would be compiled at first use."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Annotated, TypeAlias

import typer

from polycnc.cli._output import say
from polycnc.errors import UsageError, did_you_mean

Progress: TypeAlias = Callable[[str, float], None]

# What a program uses on the way from its text to its motion; long programs go another way (`nc.fast`).
_MANY = 2_100
_PROGRAM = """%
G17 G90 G0 X1 Y2
G1 X10 Y3 F600
G2 X20 Y3 I5 J0
G3 X10 Y3 R5
G4 F0.1
G91 G1 X1.5
X-1.5 Y0.5
G90 G0 Z1
"""
_PLATE = """(T1 D=10. CR=0. - flat end mill)
T1 M6
S5000 M3
G17 G90 G54 G0 X1 Y2
G1 Z-2 F600
X20 Y3
M30
"""
_TURNED = """(T1 D=4. - flat end mill)
T1 M6
S500 M3
G1 A5 Z8 F300
M30
"""
_SHAFT = """(T1 CNMG120408)
T1 M6
S500 M4
G18 G90 G0 X8 Z2
G1 Z-7 F300
M30
"""


def _warm_run(progress: Progress) -> None:
    from polycnc import runner
    from polycnc.jit import compile_entries
    from polycnc.kernel import make_state

    compile_entries("polycnc.kernel", [make_state(3)], progress)
    progress("a program", 0.8)
    runner.run(_PROGRAM + "G1 X1 F600\nX2\n" * (_MANY // 2), check=False)
    runner.run(_PROGRAM, check=False, servo=True, rows=lambda _: None)
    runner.check(_PROGRAM)


def _warm_apci(progress: Progress) -> None:
    from polycnc.controllers.apci import Board, BoardTasks, parse_system_file, sap
    from polycnc.jit import compile_entries

    board = Board(parse_system_file("number_of_axes = 3"))
    compile_entries("polycnc.controllers.apci", [board.state, board.kernel], progress)
    compile_entries("polycnc.kernel", [board.kernel], progress)
    progress("a stand-alone program", 0.9)
    tasks = BoardTasks(board)
    tasks.load(sap.compile_program("CI0 := 1;"))
    tasks.startcnct(0)
    board.advance(1)


def _warm_imc(progress: Progress) -> None:
    from polycnc.controllers.imc import Card
    from polycnc.jit import compile_entries

    card = Card()
    compile_entries("polycnc.controllers.imc", [card.state, card.kernel], progress)


def _warm_post(progress: Progress) -> None:
    import polycnc.post  # noqa: F401  (has the entries)
    from polycnc.jit import compile_entries

    compile_entries("polycnc.post", [], progress)


def _warm_stock(progress: Progress) -> None:
    from pathlib import Path
    from tempfile import TemporaryDirectory

    from polycnc import runner

    with TemporaryDirectory() as folder:
        part = Path(folder, "part.stl")
        progress("a plate", 0.3)
        done = runner.run(_PLATE, dialect="fanuc", check=False, stock="auto", resolution_mm=1.0)
        if done.stock is not None:
            done.stock.mesh().write_stl(part)
        progress("a body from a file", 0.6)
        body = str(part)
        runner.run(_PLATE, dialect="fanuc", check=False, stock=body, resolution_mm=1.0, target=body)
        progress("the same on a table that turns", 0.65)
        runner.run(_TURNED, "mill5", "din", check=False, stock=body, resolution_mm=1.0, target=body)
    progress("a table that turns", 0.7)
    runner.run(_TURNED, "mill5", "din", check=False, stock="box=-9,-9,-9,9,9,9", resolution_mm=1.0)
    progress("a shaft", 0.8)
    runner.run(_SHAFT, "lathe2", "din", check=False, stock="cylinder=20,-9,0", resolution_mm=1.0)


_JOBS = {"run": _warm_run, "stock": _warm_stock, "post": _warm_post, "apci": _warm_apci, "imc": _warm_imc}


@contextmanager
def _shown(job: str) -> Iterator[Progress]:
    """Show on a terminal what is being compiled."""
    from rich.console import Console

    console = Console(stderr=True)
    if not console.is_terminal:
        yield lambda name, part: None
        return
    with console.status(f"{job} ...") as status:
        yield lambda name, part: status.update(f"{job}: {part:.0%}, {name}")


def warmup_command(
    job: Annotated[
        str,
        typer.Argument(
            help="run (part programs), stock (what they cut), post (long tool paths), apci, imc or all.",
            metavar="[JOB]",
        ),
    ] = "all",
) -> None:
    """Compile what the job needs, so that its first use does not wait; what is there already is left as it is."""
    import time

    from polycnc.jit import compile_at_once

    if job not in (*_JOBS, "all"):
        raise UsageError(
            f"unknown job '{job}'", hint=f"{did_you_mean(job, _JOBS)}Jobs are: {', '.join(_JOBS)}, all."
        )
    compile_at_once()  # what is run here to be compiled is small work
    for name, warm in _JOBS.items():
        if job in (name, "all"):
            begin_s = time.monotonic()
            with _shown(name) as progress:
                warm(progress)
            say(f"{name:5} ready after {time.monotonic() - begin_s:.0f} s")
