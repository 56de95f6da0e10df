"""A block is searched by calculation in plain programs and in those with statements, with a language and without."""

from __future__ import annotations

from pathlib import Path

import pytest

from polycnc.cnc import Control, ControlError, RunState
from polycnc.controllers.bosch import Pnc
from polycnc.nc import ProgramText
from support.often import often

MOVES = ["G90", "G1 F60000 X1 Z2", "G91", "X2", "Y3.5", "X4 Z-1", "G90", "X20", "Y-6"]
STATEMENTS = {"fanuc": "#101=1", "bosch": "", "linuxcnc": "", "grbl": ""}
WITHOUT = (None,)


def program(dialect: str, statement: bool) -> list[str]:
    """Return moves with sequence numbers, after a statement of the dialect's language."""
    first = [STATEMENTS[dialect] if statement else "N1"]
    return [*first, *(f"N{10 * number} {move}" for number, move in enumerate(MOVES, 1)), "M30"]


def made(dialect: str, *, language: bool = True) -> Control:
    return Control(dialect=dialect, languages=() if language else WITHOUT)


def reached(control: Control, cycles: int = 3000) -> list[tuple[float, ...]]:
    """Start and return where the axes are in each cycle."""
    control.cycle_start()
    way = []
    for _ in range(cycles):
        control.advance(1)
        way.append(tuple(round(axis.setpoint, 6) for axis in control.status().axes.values()))
        if control.channels[0].run_state is not RunState.ACTIVE:
            break
    assert control.channels[0].run_state is RunState.COMPLETED, control.status().alarms
    return way


CASES = [
    (dialect, language, statement)
    for dialect in STATEMENTS
    for language in (True, False)
    for statement in (False, True)
    if not statement or (language and STATEMENTS[dialect])
]


@pytest.mark.parametrize(
    ("dialect", "language", "statement", "line"),
    often([(*case, line) for case in CASES for line in (1, 2, 5, 8, 10)], 2 * len(CASES) - 1),
)
def test_a_searched_block_begins_where_the_whole_program_would(
    dialect: str, language: bool, statement: bool, line: int
) -> None:
    text = "\n".join(program(dialect, statement)) + "\n"
    whole = made(dialect, language=language)
    whole.select_program(ProgramText.from_text(text, "whole"))
    end = reached(whole)[-1]
    part = made(dialect, language=language)
    part.select_program(ProgramText.from_text(text, "part"))
    assert part.search(line=line, calculate=line > 1) == line
    assert reached(part)[-1] == end
    # where it begins is where the program up to there would have ended
    before = made(dialect, language=language)
    before.select_program(ProgramText.from_text(text, "before"))
    if line > 1 and not statement:
        before.search(line=1, last=line - 1)
        begin = reached(before)[-1]
        part = made(dialect, language=language)
        part.select_program(ProgramText.from_text(text, "part"))
        part.search(line=line, calculate=True)
        run = part.channels[0].run
        assert run is not None
        assert run.selection.searched is not None
        assert tuple(round(each, 6) for each in run.selection.searched) == begin


@pytest.mark.parametrize(("dialect", "language", "statement"), [each for each in CASES if not each[2]])
def test_a_program_ends_behind_the_last_block_that_is_wanted(
    dialect: str, language: bool, statement: bool
) -> None:
    lines = program(dialect, statement)
    for last in (2, 6):
        text = "\n".join(lines) + "\n"
        part = made(dialect, language=language)
        part.select_program(ProgramText.from_text(text, "part"))
        part.search(line=1, last=last)
        cut = made(dialect, language=language)
        cut.select_program(ProgramText.from_text("\n".join(lines[:last]) + "\n", "cut"))
        assert reached(part) == reached(cut)
        assert reached(part)[-1] != reached(cut)[-1]  # the next start is one of the whole program


def test_long_plain_programs_are_searched_beyond_what_is_read_at_once() -> None:
    """A language that leaves the program to the reader has it scanned beyond the block that is sought."""
    text = "G91 G1 F60000\n" + "X1\n" * 1000 + "M30\n"
    for dialect in ("fanuc", "bosch"):
        for line in (2, 3, 255, 258, 700):
            control = made(dialect)
            control.select_program(ProgramText.from_text(text, "long"))
            control.search(line=line, calculate=True)
            run = control.channels[0].run
            assert run is not None
            assert run.selection.searched is not None
            assert run.selection.searched[0] == line - 2


def test_custom_macros_do_not_end_at_a_block_that_is_given() -> None:
    control = made("fanuc")
    control.select_program(ProgramText.from_text("#1=1\nG1 X1 F6000\nX2\nM30\n", "macro"))
    with pytest.raises(ControlError, match="a program with statements cannot end at a block"):
        control.search(line=1, last=2)
    control.cycle_start()
    control.advance(2000)
    assert control.status().axes["X"].setpoint == 2


def test_a_search_that_finds_nothing_is_refused() -> None:
    for dialect in ("fanuc", "bosch"):
        control = made(dialect)
        control.select_program(ProgramText.from_text("G1 X1 F60000\nM30\nX3\n", "short"))
        with pytest.raises(ControlError, match="the program ends before line 3"):
            control.search(line=3, calculate=True)


STEPS = """1 #A%=1
N10 G1 F60000 X10
15 #A%=2
N20 X20
25 #A%=3
N30 X30
35 #A%=4
N40 P SIDE
45 #A%=5
M30
"""


@pytest.mark.parametrize(
    ("start", "end", "x", "seen"),
    [
        ("N20", "N30", 30, 3),  # nothing after the last block is executed, statements neither
        ("", "N10", 10, 1),
        ("N20", "", 45, 5),
        ("N30", "N30", 30, 3),
        ("25", "35", 30, 4),  # a block may be one of statements alone
        ("20", "N40", 45, 4),  # the sub-program that it calls belongs to it
        ("", "", 45, 5),
    ],
)
@pytest.mark.covers("cpl.MCOPS.3")
@pytest.mark.covers("cpl.MCOPS")
def test_the_operator_searches_a_part_of_a_program(
    tmp_path: Path, start: str, end: str, x: float, seen: int
) -> None:
    pnc = Pnc(tmp_path)
    (tmp_path / "main.npg").write_text(STEPS)
    (tmp_path / "SIDE").write_text("N1 G91 G1 X15 F6000\nN2 G90\n")
    pnc.select_program("main.npg")
    pnc.search_block(start, end)
    pnc.cycle_start()
    pnc.advance(5000, until=lambda: pnc.run_state() is not RunState.ACTIVE)
    assert (pnc.run_state(), pnc.axes["X"].setpoint) == (RunState.COMPLETED, x)
    assert pnc.variables()["#A%"] == seen
    pnc.close()


def test_bytes_that_are_no_line_ends_do_not_move_the_block(tmp_path: Path) -> None:
    pnc = Pnc(tmp_path)
    (tmp_path / "main.npg").write_bytes(b"(a\x0cb\x0b)\nN1 G1 X1 F60000\nN2 X2\n")
    pnc.select_program("main.npg")
    assert pnc.search_block("N2") == 3
    pnc.close()
