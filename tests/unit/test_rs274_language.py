"""RS274/NGC: parameters, expressions, O-words, files of sub-programs, and what is refused where."""

from __future__ import annotations

from pathlib import Path

import pytest

import polycnc
from polycnc.runner import RunSettings, run_program

ENDS = [
    ("#1=3 #2=[#1+1]\nG0 X#2", 1.0),  # settings count after their line
    ("#<a>=2\n#<_B c>=3\nG0 X[#<A>**#<_bc> + 2 * 3]", 14.0),
    ("#5=6\nG0 X[#[2+3] / 4 + 7 mod 4]", 4.5),
    ("G0 X[-[2] ** 2]", 4.0),
    ("G0 X[FUP[COS[90]] + FUP[COS[-90]] + 3*FUP[COS[270]] + 5*FUP[SIN[180]] + FIX[SIN[360]]]", 3.0),
    ("G0 X[2 + 1 gt 2 and 0 or 5]", 1.0),
    ("G0 X[ATAN[1]/[1] + ROUND[2.5] + FIX[-1.5] + FUP[1.2] + ABS[-1]]", 49.0),
    ("G0 X[EXISTS[#<no>] + EXISTS[#<_metric>]]", 1.0),
    ("G0 X5\nG92 X2\nG0 X[#5420 + 1]\nG0 X[#<_abs_x> + #<_x>]", 12.0),
    ("G20\nG0 X1\nG21\nG0 X[#<_x> + 1]", 26.4),
    ("o1 sub\no1 endsub [#1+#2]\no1 call [3] [4]\nG0 X#<_value>", 7.0),
    ("o<f> sub\no2 if [#1 le 1]\no<f> return [1]\no2 endif\no<f> call [#1-1]\no<f> endsub [#1*#<_value>]\n"
     "o<f> call [5]\nG0 X#<_value>", 120.0),
    ("#1=0\no1 while [#1 lt 5]\n#1=[#1+1]\no2 if [#1 eq 3]\no1 continue\no2 endif\nG91 G0 X#1\no1 endwhile", 12.0),
    ("#1=0\no1 do\n#1=[#1+1]\no2 if [#1 lt 3]\no1 continue\no2 endif\nG91 G0 X#1\no1 while [#1 lt 5]", 12.0),
    ("#1=0\no1 while [1]\no2 while [1]\n#1=[#1+1]\no3 if [#1 gt 3]\no1 break\no3 endif\n"
     "o2 endwhile\no1 endwhile\nG0 X#1", 4.0),
    ("#1=0\no1 while [#1 lt 3]\n#1=[#1+1]\no2 while [1]\no1 continue\no2 endwhile\nG0 X99\no1 endwhile\nG0 X#1", 3.0),
    ("o1 repeat [3]\nG91 G0 X2\no1 endrepeat", 6.0),
    ("#1=2\no1 if [#1 eq 1]\nG0 X1\no1 elseif [#1 eq 2]\nG0 X2\no1 else\nG0 X3\no1 endif", 2.0),
    ("o9 sub\nG0 X#1\nM2\no9 endsub\no[4+5] call [8]\nG0 X1", 8.0),  # M2 ends everything
    ("/ #1=5\nG0 X[#1+1]", 6.0),
    ("%\n#1=5\nG0 X#1\n%\nG0 X1", 5.0),
    ("#1=2\nM98 P70 L3\nG0 X[#1+#<_call_level>]\nM2\nO70\n#1=[#1*2+#<_call_level>]\nM99", 23.0),
    ("M66 P1 L0\n#1=#5399\nM66 P2 L3 Q.02\n#1=[#1*10+#5399]\nM66 P2 L4 Q1\nM66 E3\nG0 X[#1+#5399+7]", 6.0),
    ("G91 M66 P1 L2 Q.03 G0 X3\nG0 X[#5399-1]", 1.0),
]  # fmt: skip


@pytest.mark.parametrize(("program", "end"), ENDS)
def test_where_it_goes(program: str, end: float, tmp_path: Path) -> None:
    path = tmp_path / "part.ngc"
    path.write_text(program + "\n")
    assert polycnc.run(path).end_position_mm["X"] == pytest.approx(end, abs=1e-9)


def test_lines_with_a_skip_mark_are_left_out_with_block_delete(tmp_path: Path) -> None:
    path = tmp_path / "part.ngc"
    path.write_text("/ #1=5\nG0 X[#1+1]\n")
    assert polycnc.run(path, skip_levels=[1]).end_position_mm["X"] == 1.0


def test_a_sub_program_in_a_file_beside_the_program(tmp_path: Path) -> None:
    (tmp_path / "square.ngc").write_text("o<square> sub\nG1 X#1 F600\no<square> endsub\nM2\n")
    (tmp_path / "part.ngc").write_text("o<square> call [7]\nG1 Y2\nM2\n")
    result = polycnc.run(tmp_path / "part.ngc", trace=True)
    assert (result.end_position_mm["X"], result.end_position_mm["Y"]) == (7.0, 2.0)
    assert result.trace.program is not None
    assert {Path(str(name)).name for name in result.trace.program} == {"square.ngc", "part.ngc"}


@pytest.mark.parametrize("rest", ["", "#1=3\nG0 X#1\n"])
def test_comments_that_would_write_files_are_remarked(rest: str, tmp_path: Path) -> None:
    (tmp_path / "part.ngc").write_text(
        "G21\n(LogOpen,found.txt)\nG0 X2 (LOG,#5420)\n( log,again)\n; (PROBEOPEN x.txt)\n(a logbook)\n"
        f"{rest}(logclose)\nM2\n"
    )
    found = [each for each in polycnc.run(tmp_path / "part.ngc").messages if "no file" in str(each)]
    assert [(each.text, each.line) for each in found] == [
        (f"({word}) writes no file here", line)
        for word, line in (("LOGOPEN", 2), ("LOG", 3), ("LOGCLOSE", 7 + rest.count("\n")))
    ]


def test_messages_show_parameters(tmp_path: Path) -> None:
    (tmp_path / "part.ngc").write_text("#1=2.5\n(DEBUG,depth #1)\n(msg,hello)\nG0 X1\n")
    texts = [message.text for message in polycnc.run(tmp_path / "part.ngc").messages]
    assert "MSG: depth 2.500000" in texts
    assert "MSG: hello" in texts


def test_texts_write_parameters_as_they_say(tmp_path: Path) -> None:
    """As LinuxCNC 2.9 does: a form counts up to the end of its text, and what has no value is shown as that."""
    (tmp_path / "part.ngc").write_text(
        "#1=2.123456789 #<a b>=3.5\n(DEBUG,%d#1 %f#1 #<ab>)\n(PRINT,%.7f#1 50% %x #<none> #9999 # #<_line>)\n"
        "(DEBUG,#<_ini[a]b> #<_value>)\n#5599=0\n(DEBUG,not shown)\nG0 X1\n"
    )
    texts = [message.text for message in polycnc.run(tmp_path / "part.ngc").messages]
    assert [text.removeprefix("MSG: ") for text in texts if text.startswith("MSG")] == [
        "2 2.1235 3.5000",
        "2.1234568 50% %x ###### ###### # 3.0000000",
        "###### 0.000000",
    ]


REFUSED = [
    ("G0 X1\n#1=2\n(ABORT, no tool %d#1)", "no tool 2", 3),
    ("G0 X1\nG0 X[1/#1]", "division by zero", 2),
    ("G0 X#<none>", "#<none> has no value", 1),
    ("#<_x>=1", "can only be read", 1),
    ("#5420=1", "can only be read", 1),
    ("#9999=1", "no parameter #9999", 1),
    ("G0 X[SQRT[-1]]", "SQRT", 1),
    ("\no1 if [1]\nG0 X1", "has no end", 2),
    ("o1 endif", "without its beginning", 1),
    ("o1 while [1]\no2 break\no1 endwhile", "outside its loop", 2),
    ("o1 repeat [2]\no1 break\no1 endrepeat", "of a REPEAT", 2),
    ("o<none> call", "no sub-program O<none>", 1),
    ("o1 sub\no1 call\no1 endsub\no1 call", "nested more than 10 deep", 2),
    ("G0 X[1", "']' is missing", 1),
    ("o1 while [1]\no1 endwhile", "without a block", 1),
    ("G0 X#<_ini[a]b>", "is not there", 1),
    ("#1=1\nG1 X[#1] Q5x", "a number is missing", 2),
    ("G0 X1\nM98 P70", "no sub-program O70 that ends with M99", 2),
    ("G0 X1\nM98 P70\nM2\nO70\nG0 X2", "no sub-program O70 that ends with M99", 2),
    ("G0 X1 M98 P70\nM2\nO70\nM99", "M98 or M99 with other words", 1),
    ("M98\nM2", "M98 without P", 1),
    ("M98 P1.5\nM2", "P1.5 is no whole number", 1),
    ("M98 P70 L-1\nM2\nO70\nM99", "L-1 is no whole number", 1),
    ("o1 sub\nM99\no1 endsub\no1 call", "M99 in a sub-program of SUB", 2),
    ("M98 P70\nM2\nO70\nM98 P70\nM99", "nested more than 10 deep", 4),
    ("M66 L3", "M66 without an input", 1),
    ("G0 X1\nM66 P1 E2", "two inputs", 2),
    ("M66 P1 L3", "L3 without a time", 1),
    ("M66 P1 L3 Q0", "L3 without a time", 1),
    ("M66 E1 L1 Q2", "read at once", 1),
    ("M66 P1 L5 Q2", "no such way to wait", 1),
    ("M66 P64 L0", "there are 64 such inputs", 1),
    ("M66 P1.5 L0", "no whole number", 1),
    ("M66 P1 M66 P2", "M66 twice", 1),
]


@pytest.mark.parametrize(("program", "what", "line"), REFUSED)
def test_what_is_refused_where(
    program: str, what: str, line: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("polycnc.nc.rs274._source.LONGEST_LOOP_PAUSES", 3)
    path = tmp_path / "part.ngc"
    path.write_text(program + "\n")
    (alarm,) = run_program(path, RunSettings(), check=False).alarms
    assert what in alarm.text
    assert alarm.line == line


@pytest.mark.parametrize("number", ["O1000", "O1000 (SURFACE)", "N5 o 7", "/O1000 ; a text"])
@pytest.mark.parametrize("words", ["X4", "X[2+2]"])
def test_an_o_number_by_itself_is_the_number_of_a_program(number: str, words: str) -> None:
    program = f"%\n{number}\nG21 G90 G0 {words}\nO2000\nG0 X6\nM2\n%\n"
    result = polycnc.run(program, "mill3", dialect="linuxcnc")
    assert result.blocks == 3
    assert result.rapid_path_mm == pytest.approx(6.0)
