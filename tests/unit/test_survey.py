"""What a program does line by line: times that add up to those of a run, and what holds before a line."""

from __future__ import annotations

from pathlib import Path

import pytest

from polycnc import runner
from polycnc.machine import load_machine
from polycnc.nc import Action, Dialect, Group, ProgramText, load_dialect
from polycnc.runner import holds_before, survey

MACHINE = load_machine("vmc3")
FANUC, LINUXCNC, BOSCH = map(load_dialect, ("fanuc", "linuxcnc", "bosch"))
PART = (
    "T1 M6\nS900 M3\n(POCKET)\nG1 X10 F600\nG91 X5 F100 M8\nG90\nG4 P2\nM98 P77 L3\nG20 T4 M6\nG1 X2.5 F90\nM30\n"
    "O77\nG1 Y3\nG1 Y0\nM99\n"
)


def _text(text: str) -> ProgramText:
    return ProgramText.from_text(text, "part.nc")


@pytest.mark.parametrize(
    ("text", "dialect"),
    [
        (PART, FANUC),
        ("#1=3\nWHILE[#1GT0]DO1\nG1X#1F500\nG4P7\n#1=#1-1\nEND1\nG0Y9\nM30\n", FANUC),
        (
            "F700\no7 repeat [5]\nG1 X3 Y[1+2]\nG2 X0 Y0 R9\no7 endrepeat\nG64 P0.3\nG1 X1\nX2 Y1\nX3\nM2\n",
            LINUXCNC,
        ),
        ("N1 G1 X7 F90\nN2 G61 X2\nN3 M30\n", BOSCH),
    ],
)
def test_the_lines_of_a_program_take_its_time(text: str, dialect: Dialect, tmp_path: Path) -> None:
    found = survey(_text(text), MACHINE, dialect, root=tmp_path)
    assert found is not None
    run = runner.run(_text(text), MACHINE, dialect, root=tmp_path)
    assert found.time_s == pytest.approx(run.time_s, abs=1e-9)
    assert found.operations == run.operations
    own_s = sum(each.time_s for each in found.lines.values())
    assert own_s == pytest.approx(run.time_s, abs=0.003)
    assert all(each.time_s > 0.0 for each in found.lines.values())


def test_a_line_has_the_time_of_its_way_and_the_number_of_its_rounds(tmp_path: Path) -> None:
    found = survey(_text(PART), MACHINE, FANUC, root=tmp_path)
    assert found is not None
    assert found.lines[7].time_s == pytest.approx(0.002, abs=1e-9)  # 2 ms, as P has no point
    assert 3.0 < found.lines[5].time_s < 3.4  # 5 mm at 100 mm/min
    assert (8 in found.lines, found.lines[13].count) == (False, 3)  # its motion stands in the sub-program
    loop = survey(_text("#1=3\nWHILE[#1GT0]DO1\nG4P700\n#1=#1-1\nEND1\nM30\n"), MACHINE, FANUC, root=tmp_path)
    assert loop is not None
    assert (loop.lines[3].count, round(loop.lines[3].time_s, 3)) == (3, 2.1)


def test_before_a_line_hold_the_words_of_all_lines_before(tmp_path: Path) -> None:
    found = holds_before(_text(PART), 6, MACHINE, FANUC, root=tmp_path)
    assert found is not None
    modal, position = found
    assert (modal.tool, modal.feed, modal.speed, modal.spindle_direction) == (1, 100.0, 900.0, 1)
    assert FANUC.g_action(float(modal.g[Group.DISTANCE][1:])) is Action.INCREMENTAL
    assert modal.coolant == (8,)
    assert position["X"] - modal.zero[0] == pytest.approx(15.0)
    after = holds_before(_text(PART), 10, MACHINE, FANUC, root=tmp_path)
    assert after is not None
    assert (after[0].tool, after[0].inch) == (4, True)
    assert holds_before(_text(PART), 12, MACHINE, FANUC, root=tmp_path) is None  # after the end


def test_a_refused_block_before_a_line_changes_nothing(tmp_path: Path) -> None:
    found = holds_before(_text("G1 X7 F30\nG777 X9\nX8\nM30\n"), 3, MACHINE, FANUC, root=tmp_path)
    assert found is not None
    assert found[1]["X"] - found[0].zero[0] == pytest.approx(7.0)


def test_statements_that_might_change_files_are_not_executed(tmp_path: Path) -> None:
    text = _text('10 OPENW(1,"KEPT")\n20 PRN#(1,"X")\nN3 G1 X7 F90\nN4 M30\n')
    assert survey(text, MACHINE, BOSCH, root=tmp_path) is None
    assert holds_before(text, 3, MACHINE, BOSCH, root=tmp_path) is None
    assert list(tmp_path.iterdir()) == []
