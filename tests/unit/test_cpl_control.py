"""CPL programs on their control: what outlives a run, where the axes are, what time it is, what cannot end."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from polycnc import runner
from polycnc.cli._app import app
from polycnc.errors import UsageError
from polycnc.nc import ProgramText
from support.cpl_runs import Root
from support.programs import MILL


@pytest.fixture
def root(tmp_path: Path) -> Root:
    return Root(tmp_path)


# ---------------------------------------------------------------------- permanent variables

DECLARED = (
    b"DEF INT @WZNR(9) ;tools\nDEF REAL @WZKOR(9,2) ;\nDEF CHAR @PSTR1(3) ;\nDEF CHAR @PSTR2(9,2) ;\n"
    b"DEF DOUBLE @IJKL ;\nDEF BOOL @MNOP ;\n"
)


def test_permanent_variables_survive_to_the_next_run(root: Root) -> None:
    root.write("wmhperm.dat", DECLARED)
    root.write("anwperm.dat", b"DEF INT @ABCD ;\n")
    root.run(
        '1 @36%=3 : @ABCD%=-17 : @IJKL!=5.12345 : @MNOP?=TRUE : @PSTR1$="ABC"\n2 @WZNR%(2)=6 : @WZKOR(3,2)=7.625\n'
        '3 @PSTR2$(3)="DE" : @_R!(4)=2.75'.replace("@_R!", "@_R")
    )
    found = root.run("1 #A%=@ABCD%+1 : #B=@WZKOR(3,2) : @36%=@36%*7").variables
    assert (found["@36"], found["#A%"], found["#B"]) == (21, -16, 7.625)
    assert (found["@IJKL!"], found["@MNOP?"], found["@PSTR1$"]) == (5.12345, True, "ABC")
    wznr, pstr2, r = found["@WZNR%"], found["@PSTR2$"], found["@_R"]
    assert isinstance(wznr, list)
    assert isinstance(pstr2, list)
    assert isinstance(r, list)
    assert (wznr[2], wznr[3], pstr2[3], r[4], found["@37"]) == (6, None, "DE", 2.75, None)
    root.write("anwperm.dat", b"DEF INT @OTHER ;\n")
    assert "@ABCD%" not in root.run("1 A=1").variables


def test_a_wrong_declaration_is_the_error_of_the_run(root: Root) -> None:
    root.write("anwperm.dat", b"DEF INT @A ;\nDEF WORD @B ;\n")
    alarms = root.run("1 A=1", check=False).alarms
    assert [(alarm.file, alarm.line) for alarm in alarms] == [("anwperm.dat", 2)]


def test_nothing_permanent_leaves_no_file(root: Root) -> None:
    root.run("1 #A=5")
    assert list(root.folder.iterdir()) == []


# ---------------------------------------------------------------------- positions


def test_positions_are_of_now_or_of_the_last_prepared_block(root: Root) -> None:
    found = root.run(
        'N1 G54\nN10 G1 X20 Y-7.5 F6000\n20 #A=CPOS(1) : #B=CPOS("Y",1) : #C=MPOS(1)\n30 WAIT\n'
        '40 #D=MPOS("X") : #E=SPOS(2) : #F=APOS("Y") : #G=WPOS("Y",1,1) : #H=MPOS(2,0) : #I=MPOS(1,1,1)\n'
        "N50 G91 X2.5\n60 #J=CPOS(1)"
    ).variables
    assert [found[f"#{name}"] for name in "ABCDEFGHIJ"] == [20, -7.5, 0, 20, -7.5, -7.5, -7.5, -7.5, 20, 22.5]


def test_program_positions_have_shifts_and_inches(root: Root) -> None:
    found = root.run(
        "N10 G1 X50.8 Y5 F6000\nN20 G92 X25.4 Y2\n30 #A=CPOS(1)\n40 WAIT\n50 #B=WPOS(1) : #C=MPOS(1)\nN60 G70\n"
        "70 #D=CPOS(1) : #E=WPOS(1) : #F=MPOS(1) : #G=APOS(1)"
    ).variables
    assert [found[f"#{name}"] for name in "ABC"] == pytest.approx([25.4, 50.8, 50.8])
    assert [found[f"#{name}"] for name in "DEFG"] == pytest.approx([1, 2, 2, 2])


@pytest.mark.covers("cpl.PPOS")
@pytest.mark.parametrize(
    "call",
    [
        'MPOS("U")',
        "MPOS(9)",
        "MPOS(0)",
        "MPOS(1,0,1)",
        "MPOS(1,2)",
        "WPOS(1,1,2)",
        "CPOS(4,1)",
        "APOS(7)",
        "PPOS(1)",
    ],
)
def test_axes_that_are_not_there_are_refused(root: Root, call: str) -> None:
    error = root.error(f"1 A={call}")
    assert error == ("1: NO PROBE POSITION" if call == "PPOS(1)" else "1: INVALID PARAMETER")


# ---------------------------------------------------------------------- time and interface


@pytest.mark.covers("cpl.CLOCK", "cpl.DATE", "cpl.TIME", "cpl.ex.2494")
def test_the_clock_is_the_machine_s(root: Root) -> None:
    result = root.run(
        "1 WAIT\n2 T%=CLOCK\nN4 G1 X100 F6000\n5 WAIT\n6 #T%=CLOCK-T%\n7 DIM A$(9) : DIM B$(9)\n8 WAIT(,1500)\n"
        '9 A$=DATE : B$=TIME : PRN#(0,A$," ",B$)'
    )
    assert result.variables["#T%"] == pytest.approx(result.cutting_time_s * 1000, abs=2)
    assert result.time_s == pytest.approx(1.5 + result.cutting_time_s, abs=0.01)
    expected = MILL.epoch.strftime("%d.%m.") + " " + MILL.epoch.replace(second=2).strftime("%H.%M.%S")
    assert result.messages[-1].text == f"MSG: {expected}"


def test_inputs_are_false_and_outputs_can_be_set(root: Root) -> None:
    found = root.run(
        "1 #A?=IC(5,1,2) : IC(80,0,1)=TRUE\n2 WAIT(NOT IC(3,2,1),,#C%)\n3 WAIT(IC(4),250,#D%)"
    ).variables
    assert (found["#A?"], found["#C%"], found["#D%"]) == (False, 0, 1)
    assert root.error("1 IC(96,0,1)=TRUE") == "1: INVALID PARAMETER"
    assert root.error("1 A?=IC(8,9)") == "1: INVALID PARAMETER"


def test_a_wait_that_cannot_end_is_an_error(root: Root) -> None:
    assert root.error("N5 G1 X5 F6000\n10 WAIT(IC(4)=TRUE)") == "2: the program waits without end"


@pytest.mark.parametrize(
    ("loop", "line"),
    [
        ("10 A%=1\n20 GOTO 10", 3),
        ("10 WHILE MPOS(1)<7 DO\n20 A=COS(MPOS(1))\n30 END", 3),
        ("10 I%=0 : REPEAT\n20 I%=I%+1 : IF I%>7 THEN I%=3 ENDIF\n30 UNTIL IC(3,8)", 4),
        (
            '10 DIM F%(9) : DIM T$(9) : F%(3)=1\n20 WHILE TRUE DO\n30 F%(3)=5-F%(3) : T$=STR$("#",F%(3))\n40 END',
            4,
        ),
        ("10 X=16750000.0\n20 WHILE X>0 DO\n30 X=X+1\n40 END", 4),  # 2**24 + 1 is 2**24 in single precision
        ("10 CALL SUB", 3),
    ],
)
def test_a_loop_that_comes_back_to_where_it_was_is_an_error(root: Root, loop: str, line: int) -> None:
    root.write("SUB", b"1 #I%=5\n2 WHILE #I%=5 DO\n3 @7%=#I%*3\n4 END")
    alarms = root.run(f"N5 G1 X5 F6000\n{loop}", check=False).alarms
    assert [(alarm.text, alarm.line) for alarm in alarms] == [("the program loops without end", line)]


def test_a_loop_that_does_something_goes_on_up_to_the_limit(root: Root) -> None:
    assert root.run("10 T%=CLOCK\n20 WHILE CLOCK<T%+15 DO\n30 #A%=1\n40 END").variables["#A%"] == 1
    found = root.run("5 I%=0\n10 WHILE I%<90000 DO\n20 I%=I%+1\n30 END\n40 #I%=I%").variables
    assert found["#I%"] == 90000
    counting = "10 X!=1\n20 WHILE X!>0 DO\n30 X!=X!+1\n40 END"
    text = ProgramText.from_text(counting, str(root.folder / "main.npg"))
    alarms = runner.run(text, MILL, "bosch", root=root.folder, check=False, loop_limit_s=0.02).alarms
    assert [alarm.text for alarm in alarms] == ["the program has looped for 0.02 s without a block or a WAIT"]
    with pytest.raises(UsageError, match="a limit of 0 s for loops"):
        runner.run(text, MILL, "bosch", root=root.folder, loop_limit_s=0)


@pytest.mark.parametrize(
    ("loop", "limit"),
    [
        ("20 PRN#(1,N%)", "0.2"),
        ("20 DSP(2,3,N%)", "0.2"),
        ("20 C%=CLOCK", "0.4"),
    ],
)
def test_a_loop_that_writes_and_asks_nobody_has_half_of_the_limit(root: Root, loop: str, limit: str) -> None:
    text = f'10 OPENW(1,"out") : N%=0\n{loop}\n30 N%=N%+1\n40 GOTO 20'
    alarms = runner.run(text, MILL, "bosch", root=root.folder, check=False, loop_limit_s=0.4).alarms
    assert [alarm.text for alarm in alarms] == [
        f"the program has looped for {limit} s without a block or a WAIT"
    ]


def test_the_limit_of_loops_is_an_option(root: Root) -> None:
    root.write("main.npg", b"10 X!=1\n20 WHILE X!>0 DO\n30 X!=X!+1\n40 END\n")
    result = CliRunner().invoke(app, ["run", str(root.folder / "main.npg"), "--loop-limit", "0.03"])
    assert "the program has looped for 0.03 s without a block or a WAIT" in result.output
    assert "--loop-limit" in result.output


# ---------------------------------------------------------------------- sub-programs and plain programs


@pytest.mark.covers("cpl.sub")
def test_any_part_program_can_be_called_with_its_end(root: Root) -> None:
    root.write("SP", b"10 PDIM P1$(4) : #A$=P1$\nN20 G1 X3 F6000\nM30\n30 #N%=99")
    root.write("PLAIN", b"N10 G1 Y5 F6000\nN20 M2\nN30 Y77")
    found = root.run(
        '5 #N%=7\nN10 P SP["TEST"]\nN15 P PLAIN\n20 CALL PLAIN\n30 WAIT\n40 #X=MPOS(1) : #Y=MPOS(2)\nM30\n50 #N%=8'
    )
    assert [found.variables[name] for name in ("#N%", "#A$", "#X", "#Y")] == [7, "TEST", 3, 5]
    looped = root.run("10 FOR I%=1 TO 9\n20 #N%=I%\n30 IF I%=4 THEN\nM30\n40 ENDIF\n50 NEXT")
    assert looped.variables["#N%"] == 4


def test_sub_programs_lie_in_the_root(root: Root) -> None:
    root.write("DRILL", b"1 A=P1\nN1 G1 Z[A] F2000\n")
    root.write("P999", b"N1 Y3.5\n")
    result = root.run("10 CALL DRILL[-2.5]\n20 CALL P999\nN30 X[1.25]")
    assert result.end_position_mm == {"X": 1.25, "Y": 3.5, "Z": -2.5}


def test_a_plain_program_needs_no_control(root: Root) -> None:
    result = root.run("N10 G1 X5 F500\nN20 M30\n")
    assert result.variables == {}
    assert list(root.folder.iterdir()) == []


def test_check_links_and_reports_every_error(root: Root) -> None:
    root.write("SP", b"1 A\n2 B=\n")
    text = '10 CALL SP\n20 CALL NONE\n30 @NOPE%=5\n40 OPENW(1,"P5")\n50 GOTO 99\n'
    program = ProgramText.from_text(text, str(root.folder / "main.npg"))
    found = runner.check(program, MILL, "bosch", root=root.folder)
    assert {(Path(error.position.file).name, error.position.line) for error in found if error.position} >= {
        ("main.npg", 5)
    }
    program = ProgramText.from_text(text.replace("50 GOTO 99\n", ""), str(root.folder / "main.npg"))
    found = runner.check(program, MILL, "bosch", root=root.folder)
    places = [(Path(error.position.file).name, error.position.line) for error in found if error.position]
    assert sorted(places) == [("SP", 1), ("SP", 2), ("main.npg", 2), ("main.npg", 3)]
    assert sorted(path.name for path in root.folder.iterdir()) == ["SP"]


# ---------------------------------------------------------------------- the command


def test_the_command_runs_a_program_on_a_root(root: Root) -> None:
    program = root.folder / "main.npg"
    program.write_text(
        '10 @5=3 : #A%=5 : #B?=FALSE : #C=NUL\n20 OPENW(1,"P1") : PRN#(1,"X")\nN10 G1 X5 F600\n'
    )
    told = CliRunner().invoke(app, ["run", str(program), "--json"])
    assert told.exit_code == 0, told.output
    variables = json.loads(told.stdout)["variables"]
    assert (variables["@5"], variables["@6"], variables["#A%"], variables["#B?"]) == (3, None, 5, False)
    assert variables["#C"] is None
    assert root.read("P1") == b"X\n\x03\n"
    other = root.folder / "other"
    other.mkdir()
    told = CliRunner().invoke(app, ["run", str(program), "--root", str(other)])
    assert told.exit_code == 0
    assert sorted(path.name for path in other.iterdir()) == ["P1", "cpl.store"]
    told = CliRunner().invoke(app, ["run", str(program), "--root", str(root.folder / "none")])
    assert told.exit_code == 2
    assert "no such folder" in told.output
    program.write_text("10 A=\n20 CALL SP\n")
    told = CliRunner().invoke(app, ["check", str(program), "--root", str(other)])
    assert told.exit_code == 1
    assert "2 errors" in told.output


# ---------------------------------------------------------------------- tables


def test_tables_are_usable_without_set_up(root: Root) -> None:
    found = root.run(
        '1 TC(1,10,5)=31.5 : TC(-1,10,5)=0.25 : FXC("Y",54,1)=80 : FXC(-2,54,1)=2 : TDA(1,1,9)=20000\n'
        "2 #A=TC(1,10,5) : #B=FXC(2,54,1) : #C%=TDA(1,1,9) : DIM E%(2,3) : #D%=GETERR(1,,E%)\n"
        'N3 G70\n4 FXC("X",160,0)=2\nN5 G71\n6 #E=FXC("X",160,0)'
    ).variables
    assert [found[name] for name in ("#A", "#B", "#C%", "#D%")] == [31.75, 82.0, 20000, 0]
    assert found["#E"] == pytest.approx(50.8)
    assert root.error('1 A=FXC("Q",54,1)') == "1: INVALID PARAMETER"


# ---------------------------------------------------------------------- variables that statements set

PERMANENT = "DEF INT @WHOLE;\nDEF REAL @REAL;\nDEF CHAR @TEXT(20);\nDEF INT @ROWS(4,5);\nDEF INT @LIST(6);\n"
NUMBERS = {
    "V%": "", "#V%": "", "F%(2)": "1 DIM F%(3)", "F%(1,2)": "1 DIM F%(3,4)", "@7": "", "@WHOLE%": "",
    "@ROWS%(2,3)": "", "@LIST%(5)": "", "R": "", "D!": "",
}  # fmt: skip
STRINGS = {
    "A$": "1 DIM A$(20)", "#A$": "1 DIM #A$(20)", "R$(1)": "1 DIM R$(3,20)", "@TEXT$": "",
}  # fmt: skip
SETS_NUMBERS = {
    "INP#": ('2 OPENW(1,"P1") : PRN#(1,17) : CLOSE(1) : OPENR(2,"P1")', "INP#(2,{})", (), 17),
    "SFK": ("", 'SFK({},"A","B","C")', ("SOFTKEY3",), 3),
    "WAIT": ("", "WAIT(,20,{})", (), 1),
    "MCODS": ("2 W%=0", "#E%=MCODS(31,1,W%,{},1)", (), 5),
}
SETS_STRINGS = {
    "INP#": ('2 OPENW(1,"P1") : PRN#(1,"TEXT") : CLOSE(1) : OPENR(2,"P1")', "INP#(2,{})", (), "TEXT"),
    "SFK": ("", 'SFK({},"A","TEXT","C")', ("SOFTKEY2",), "TEXT"),
}


@pytest.mark.parametrize("statement", SETS_NUMBERS)
@pytest.mark.parametrize("variable", NUMBERS)
def test_what_sets_a_number_sets_every_kind_of_variable(root: Root, variable: str, statement: str) -> None:
    root.write("wmhperm.dat", PERMANENT.encode())
    before, text, keys, value = SETS_NUMBERS[statement]
    if statement == "WAIT" and variable in ("R", "D!"):
        assert "WAIT is INTEGER" in root.error(f"3 {text.format(variable)}")
        return
    lines = (
        NUMBERS[variable],
        before,
        f"3 {text.format(variable)}",
        f"4 #NUL?={variable}=NUL",
        f"5 #R!={variable}",
    )
    found = root.run("\n".join(filter(None, lines)), keys=keys).variables
    assert found["#NUL?"] is (value is None)
    assert found["#R!"] == value


@pytest.mark.parametrize("statement", SETS_STRINGS)
@pytest.mark.parametrize("variable", STRINGS)
def test_what_sets_a_text_sets_every_kind_of_variable(root: Root, variable: str, statement: str) -> None:
    root.write("wmhperm.dat", PERMANENT.encode())
    before, text, keys, value = SETS_STRINGS[statement]
    lines = (STRINGS[variable], before, f"3 {text.format(variable)}", f'4 #L%=INSTR({variable},"XTEXT")')
    assert root.run("\n".join(filter(None, lines)), keys=keys).variables["#L%"] == 2
    assert value == "TEXT"


def test_permanent_fields_are_buffers_too(root: Root) -> None:
    root.write("wmhperm.dat", PERMANENT.encode())
    assert root.run("1 #A%=GETERR(1,,@ROWS%,2)").variables["#A%"] == 0
    assert root.run("1 V%=0 : #A%=MCODS(31,1,V%,@LIST%,1)").variables["#A%"] == 0


def test_a_permanent_variable_without_a_value_stays_so_where_nothing_sets_it(root: Root) -> None:
    found = root.run('1 SFK(@7,"A")\n2 DLG : PRN(2,3,"X ##",@8) : ENDDLG', keys=("LEVEL_RETURN",)).variables
    assert (found["@7"], found["@8"]) == (None, None)


@pytest.mark.covers("cpl.NCF")
def test_ncf_needs_a_string_with_room(root: Root) -> None:
    assert root.error('1 A$=NCF("G1")').startswith("1: inadmissible assignment")
