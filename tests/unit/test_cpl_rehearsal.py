"""What `check` remarks on the motion that a CPL program makes: it is rehearsed in a copy of its folder."""

from __future__ import annotations

from pathlib import Path

import pytest

from polycnc.runner import _rehearsal, check, inspect
from support.programs import MILL

HOLES = (
    '5 @7%=3 : OPENW(1,"R",200) : PRN#(1,"REPORT")\n10 FOR I%=1 TO 4\nN20 G0 X[I%*10] Z2\n'
    "30 CALL DRILL[-3.5]\n40 NEXT\nM30\n"
)
DRILL = "1 Z=P1\nN2 G1 Z[Z] F300\nN3 G0 Z2\n"


def remarked(folder: Path, program: str = HOLES) -> list[tuple[str, str, int, int]]:
    (folder / "main.npg").write_text(program)
    report = inspect(folder / "main.npg", MILL, root=folder)
    assert report.errors == []
    return [
        (each.key, Path(each.position.file).name, each.position.line, each.count) for each in report.remarks
    ]


def test_the_motion_of_loops_and_sub_programs_is_remarked(tmp_path: Path) -> None:
    (tmp_path / "DRILL").write_text(DRILL)
    before = {path.name for path in tmp_path.iterdir()} | {"main.npg"}
    assert remarked(tmp_path) == [("spindle_off", "DRILL", 2, 1), ("no_tool", "DRILL", 2, 1)]
    assert {path.name for path in tmp_path.iterdir()} == before  # neither report nor memory nor link table
    turning = HOLES.replace("10 FOR", "N8 T3 M6\nN9 S900 M3\n10 FOR")
    assert remarked(tmp_path, turning) == []
    assert len(check(tmp_path / "main.npg", MILL, root=tmp_path, strict=True)) == 0
    (tmp_path / "main.npg").write_text(HOLES)
    assert len(check(tmp_path / "main.npg", MILL, root=tmp_path, strict=True)) == 2
    assert check(tmp_path / "main.npg", MILL, root=tmp_path) == []


COUNTING = "30 X!=1\n40 WHILE X!>0 DO\n50 X!=X!+1\n60 END"


@pytest.mark.parametrize("end", ['30 SFK(K%,"A")', "30 WAIT(IC(4)=TRUE)", "30 A=1/0", COUNTING])
def test_what_comes_before_the_end_of_a_rehearsal_is_remarked(
    tmp_path: Path, end: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(_rehearsal, "_LOOP_LIMIT_S", 0.02)
    program = f"10 A=-4\nN20 G1 Z[A] F300\n{end}\nN90 G1 X5\n"
    assert remarked(tmp_path, program) == [
        ("spindle_off", "main.npg", 2, 1),
        ("no_tool", "main.npg", 2, 1),
    ]


def test_blocks_that_are_wrong_are_errors_with_their_places(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    main = "10 A=7\nN20 G0 X[A]\nN30 G999 X1\n40 CALL DRILL\nN50 G0 Y[A*2] Q1=2\nM30\n"
    (tmp_path / "main.npg").write_text(main)
    (tmp_path / "DRILL").write_text("1 B=2\nN2 G2 X[B] Y0 I99 J0 F500\n")
    found = check(tmp_path / "main.npg", MILL, root=tmp_path, strict=True)
    places = [str(each).splitlines()[0] for each in found]
    assert [place.partition(": ")[0].rpartition("/")[2] for place in places] == [
        "main.npg:3:5", "DRILL:2:15", "main.npg:5:15",
    ]  # fmt: skip
    assert "G999" in places[0]
    assert check(tmp_path / "main.npg", MILL, root=tmp_path) == []
    assert [*map(str, inspect(tmp_path / "main.npg", MILL, root=tmp_path).errors)] == [*map(str, found)]
    assert caplog.messages == []


def test_where_a_rehearsal_ends_is_told(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    (tmp_path / "DRILL").write_text("1 A=1/0\n")
    (tmp_path / "main.npg").write_text("N1 G0 X5\n20 CALL DRILL\nN30 G999\n")
    assert check(tmp_path / "main.npg", MILL, root=tmp_path, strict=True) == []
    assert caplog.messages == ["DRILL:1:3: rehearsed up to here: division by zero"]


def test_a_program_with_errors_and_one_in_a_large_folder_are_not_rehearsed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    (tmp_path / "main.npg").write_text("10 A=\nN20 G1 Z-4 F300\n")
    report = inspect(tmp_path / "main.npg", MILL, root=tmp_path)
    assert (len(report.errors), report.remarks) == (1, [])
    (tmp_path / "DRILL").write_text(DRILL)
    monkeypatch.setattr(_rehearsal, "MOST_FILES", 1)
    assert remarked(tmp_path) == []
    monkeypatch.setattr(_rehearsal, "MOST_FILES", 5)
    monkeypatch.setattr(_rehearsal, "MOST_BYTES", 30)
    assert remarked(tmp_path) == []
    assert check(tmp_path / "main.npg", MILL, root=tmp_path, strict=True) == []
    assert [each.partition("npg: ")[2].partition(":")[0] for each in caplog.messages] == ["not rehearsed"] * 3
    assert list(tmp_path.parent.glob("polycnc-*")) == []
