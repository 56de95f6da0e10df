"""The errors and warnings of CPL by the manual's texts, each where it comes up (Manual 003, chapters 5 to 8)."""

from __future__ import annotations

import time
from pathlib import Path

import pytest

from polycnc.controllers.bosch.system import Drives
from polycnc.nc import ProgramText
from polycnc.nc.cpl import Fault
from polycnc.runner import run
from support.cpl_runs import Root

LONG = '1 DIM A$(1024) : FOR I%=1 TO {} : MID$(A$,I%,1)="X" : NEXT I%\n'
RANDOM = '1 OPENW(2,"P3",1000,10)\n2 PRN#(2,"A")\n3 CLOSE(2)\n'
ERRORS = [
    ("INVALID_PARAMETER", '1 DIM A$(5) : A$="ABC"\n2 #B$=MID$(A$,0)', "2: INVALID PARAMETER"),
    ("INVALID_PARAMETER", '1 OPENW(1,"P1")\n2 A%=FILEPOS(1,4)', "2: INVALID PARAMETER"),
    ("INVALID_PARAMETER", '1 DIM A$(5) : A$="ABC"\n2 A%=INSTR("B",A$,1025)', "2: INVALID PARAMETER"),
    ("INVALID_LOGICAL_NUMBER", '1 OPENW(10,"P1")', "1: INVALID LOGICAL NUMBER"),
    ("INVALID_LOGICAL_NUMBER", '1 OPENR(0,"P1")', "1: INVALID LOGICAL NUMBER"),
    ("INVALID_FILE_NUMBER", "1 A%=FILEPOS(3)", "1: INVALID FILE NUMBER"),
    ("INVALID_FILE_NUMBER", "1 SEEK(3,1)", "1: INVALID FILE NUMBER"),
    ("INVALID_FILE_NUMBER", "1 A%=FILESIZE(0)", "1: INVALID FILE NUMBER"),
    ("ILLEGAL_FILE_SIZE", '1 OPENW(2,"P2",129)', "1: ILLEGAL FILE SIZE"),
    ("INVALID_FIELD_LIMIT", "1 DIM A$(1025)", "1: INVALID FIELD LIMIT"),
    ("INVALID_FIELD_LIMIT", "1 DIM A$(0)", "1: INVALID FIELD LIMIT"),
    ("INVALID_COMPONENT_LENGTH", '1 OPENW(2,"P3",1000,0)', "1: INVALID COMPONENT LENGTH"),
    ("INVALID_COMPONENT_LENGTH", '1 OPENW(2,"P3",1000,1025)', "1: INVALID COMPONENT LENGTH"),
    ("INVALID_COMPONENT_LENGTH", RANDOM + '4 OPENR(2,"P3",11)', "4: INVALID COMPONENT LENGTH"),
    ("INVALID_COMPONENT", RANDOM.replace("3 CLOSE(2)", "3 SEEK(2,3)"), "3: INVALID COMPONENT"),
    ("INVALID_FILE_NAME", '1 ERASE("A123456789012345678901234567890")', "1: INVALID FILE NAME"),
    (
        "BLOCK_EXCEEDS_1024",
        LONG.format(1024) + '2 OPENW(1,"P6")\n3 PRN#(1,A$,"Y")',
        "3: BLOCK EXCEEDS 1024 BYTES",
    ),
    (
        "INVALID_INTEGER_VALUE",
        '1 OPENW(1,"P8") : PRN#(1,"99999999999")\n2 CLOSE(1)\n3 OPENR(1,"P8")\n4 INP#(1,I%)',
        "4: INVALID INTEGER VALUE",
    ),
    (
        "INVALID_FLOAT_VALUE",
        '1 OPENW(1,"P9")\n2 FOR I%=1 TO 45 : PRN#(1,"9";) : NEXT I%\n3 CLOSE(1)\n4 OPENR(1,"P9")\n5 INP#(1,R)',
        "5: INVALID FLOAT VALUE",
    ),
    ("INVALID_LINE_COLUMN", '1 DSP(47,1,"A")', "1: Invalid line or column number in CPL command"),
    ("INVALID_LINE_COLUMN", '1 DSP(1,80,"A")', "1: Invalid line or column number in CPL command"),
    ("MAX_STRING_LENGTH", LONG.format(78) + "2 DSP(1,1,A$)", "2: maximum string length exceeded"),
    ("FORMAT_NOT_PERMITTED", '1 DSP(1,1,"##",12345)', "1: format not permitted"),
]


@pytest.mark.covers(*sorted({f"cpl.err.{name}" for name, _, _ in ERRORS}))
@pytest.mark.parametrize(("name", "program", "error"), ERRORS)
def test_errors_have_the_texts_of_the_manual_and_stop_the_program(
    tmp_path: Path, name: str, program: str, error: str
) -> None:
    root = Root(tmp_path)
    assert root.error(f"{program}\n99 @1=5\n") == error
    assert root.run("1 #A=@1").variables["#A"] is None


AT_THE_LIMIT = [
    ("INVALID_PARAMETER", '1 DIM A$(5) : A$="ABC"\n2 #B$=MID$(A$,1,1)'),
    ("INVALID_PARAMETER", '1 OPENW(1,"P1",200,8)\n2 A%=FILEPOS(1,1)+FILEPOS(1,3)'),
    ("INVALID_PARAMETER", '1 DIM A$(5) : A$="ABC"\n2 A%=INSTR("B",A$,1024)'),
    ("INVALID_LOGICAL_NUMBER", '1 OPENW(1,"P1")\n2 OPENW(9,"P2")'),
    (
        "INVALID_FILE_NUMBER",
        '1 OPENW(1,"P1") : CLOSE(1)\n2 OPENR(9,"P1")\n3 A%=FILEPOS(9) : B%=FILESIZE(9) : SEEK(9,1)',
    ),
    ("ILLEGAL_FILE_SIZE", '1 OPENW(2,"P2",130)'),
    ("INVALID_COMPONENT_LENGTH", '1 OPENW(2,"P3",1000,1)\n2 OPENW(3,"P4",1025,1024)'),
    ("INVALID_COMPONENT_LENGTH", RANDOM + '4 OPENR(2,"P3",10)'),
    ("INVALID_FIELD_LIMIT", "1 DIM A$(1024) : DIM B$(1)"),
    ("INVALID_COMPONENT", RANDOM.replace("3 CLOSE(2)", "3 SEEK(2,1) : SEEK(2,2)")),
    (
        "INVALID_FILE_NAME",
        '1 OPENW(1,"A12345678901234567890123456789") : CLOSE(1) : ERASE("A12345678901234567890123456789")',
    ),
    ("BLOCK_EXCEEDS_1024", LONG.format(1023) + '2 OPENW(1,"P6")\n3 PRN#(1,A$,"Y")'),
    (
        "INVALID_INTEGER_VALUE",
        '1 OPENW(1,"P8") : PRN#(1,"2147483647")\n2 CLOSE(1)\n3 OPENR(1,"P8")\n4 INP#(1,I%)',
    ),
    (
        "INVALID_FLOAT_VALUE",
        '1 OPENW(1,"P9")\n2 FOR I%=1 TO 38 : PRN#(1,"9";) : NEXT I%\n3 CLOSE(1)\n4 OPENR(1,"P9")\n5 INP#(1,R)',
    ),
    ("INVALID_LINE_COLUMN", '1 DSP(46,1,"A") : DSP(1,79,"A")'),
    ("MAX_STRING_LENGTH", LONG.format(77) + "2 DSP(1,1,A$)"),
    ("FORMAT_NOT_PERMITTED", '1 DSP(1,1,"#####",12345)'),
]


@pytest.mark.covers(*sorted({f"cpl.err.{name}" for name, _ in AT_THE_LIMIT}))
@pytest.mark.covers("cpl.type.CHARACTER")
@pytest.mark.parametrize(("name", "program"), AT_THE_LIMIT)
def test_what_is_just_within_the_limit_of_an_error_is_none(tmp_path: Path, name: str, program: str) -> None:
    assert Root(tmp_path).run(f"{program}\n99 #A%=5\n").variables["#A%"] == 5


@pytest.mark.covers("cpl.err.PRN_FORMAT_INCORRECT", "cpl.err.BMP_NOT_EXISTING", "cpl.err.ERASE_WARNING")
@pytest.mark.parametrize(
    ("statement", "message"),
    [
        ('OPENW(1,"P7") : PRN#(1,"##",12345)', "PRN FORMAT INCORRECT: ##"),
        ('BMP(1,1,"none")', "cplbmp\\none.bmp is not existing"),
        ('#A%=ERASE("none")', "none was not erased: it does not exist"),
    ],
)
def test_warnings_are_told_and_the_program_goes_on(tmp_path: Path, statement: str, message: str) -> None:
    root = Root(tmp_path)
    result = root.run(f"1 {statement}\n2 #B%=7")
    assert [each.text for each in result.messages] == [f"MSG: {message}"]
    assert result.variables["#B%"] == 7
    if "PRN#" in statement:
        assert root.read("P7") == b"**\n\x03\n"


REMOVED = {
    "TD_TDR": ("A=TD(1,1)", "A=TDR(1,1)"), "FIX_FIXB_FIXE": ("FIX(1)", "FIXB(1)", "FIXE(1)"), "MIC": ("A=MIC(1)",),
    "CLX": ("CLX",), "TXT$": ("A$=TXT$(1)",),
}  # fmt: skip


@pytest.mark.covers(*(f"cpl.removed.{name}" for name in REMOVED))
@pytest.mark.parametrize("statement", [each for row in REMOVED.values() for each in row])
def test_commands_of_older_controls_are_errors_before_the_program_starts(
    tmp_path: Path, statement: str
) -> None:
    root = Root(tmp_path)
    assert root.error(f"1 @1%=5\n2 {statement}").startswith("2: ")
    assert root.run("1 #A%=@1%").variables["#A%"] is None


@pytest.mark.covers("cpl.removed.OPENR_TTY", "cpl.removed.OPENW_TTY", "cpl.removed.IC", "cpl.changed.IC")
def test_the_serial_interface_is_a_file_like_any_other_and_signals_have_groups(tmp_path: Path) -> None:
    root = Root(tmp_path)
    root.run(
        '1 OPENW(1,"TTY") : PRN#(1,"X") : CLOSE(1) : OPENR(1,"TTY") : DIM A$(3) : INP#(1,A$)\n2 DIM #A$(3) : #A$=A$'
    )
    assert root.read("TTY") == b"X\n\x03\n"
    assert root.error("1 A?=IC(5,10)") == "1: INVALID PARAMETER"
    assert root.error("1 A?=IC(5,1,65)") == "1: INVALID PARAMETER"


@pytest.mark.parametrize(
    ("block", "column", "what"),
    [
        ("N20 G1 X[Q%*2] Y3", 9, "INVALID VARIABLE: Q% has no value (NUL)"),
        ("N20 G1 F600 X[A%] Y[SQRT(B)]", 20, "INVALID VARIABLE: B has no value (NUL)"),
        ("N20 G1 X5 Y[#G!+A%] F[A%]", 12, "INVALID VARIABLE: #G! has no value (NUL)"),
        ("N20 G1 X5 F[P2]", 12, "INVALID VARIABLE: P2 has no value (NUL)"),
        ("N20 G1 X[1/(A%-3)] Y[Q%]", 9, "division by zero"),
        ("N20 G1 X[A%] Y[1/(A%-3)]", 15, "division by zero"),
        ("N20 G1 X[A%] Y[F%(7)] Z[A%]", 15, "INVALID FIELD LIMIT"),
        ("N20 G1 X[A%] Y[F%(2)]", 15, "INVALID VARIABLE"),  # an element has no name of its own
        ("N20 [A$] G1 X[A%]", 5, "INVALID VARIABLE: A$ has no value (NUL)"),
        ("N20 G1 X[A%]  Y[SQRT(-A%)]", 16, "INVALID PARAMETER"),
    ],
)
def test_an_error_in_brackets_stands_at_its_bracket_and_names_the_variable(
    tmp_path: Path, block: str, column: int, what: str
) -> None:
    alarms = run(
        ProgramText.from_text(f"10 DIM F%(3) : A%=3\n{block}\n", "main"),
        "mill3",
        "bosch",
        root=tmp_path,
        check=False,
    ).alarms
    assert (alarms[0].line, alarms[0].column) == (2, column)
    assert alarms[0].text.startswith(what)


@pytest.mark.parametrize(
    "loop",
    [
        "20 WHILE X!>0 DO\n30 X!=X!+1\n40 END",
        "20 REPEAT\n30 A%=A%+2\n40 UNTIL A%=4",
        "20 A%=A%+3\n30 GOTO 20",
    ],
)
def test_a_loop_that_only_counts_is_told_after_4_million_steps(tmp_path: Path, loop: str) -> None:
    text = ProgramText.from_text(f"10 X!=1 : A%=1\n{loop}\n", "main")
    (alarm,) = run(text, "mill3", "bosch", root=tmp_path, check=False).alarms
    assert alarm.text == "the program has looped for 0.2 s without a block or a WAIT"
    assert alarm.line in (2, 3, 4)


@pytest.mark.parametrize(
    "loop",
    [
        "20 WHILE X!>0 DO\n30 X!=X!+1 : S$=STR$(X!) : B%=ASC(MID$(S$,2,1))\n40 END",
        "20 WHILE X!>0 DO\n30 X!=X!+1 : Y=CPOS(1)+MPOS(2)\n40 END",
        "20 WHILE X!>0 DO\n30 X!=X!+1\n35 CALL MADE\n40 END",
        "20 REPEAT\n30 A%=A%+2\n" + "".join(f"{50 + n} B{n}%=A%*{n}\n" for n in range(40)) + "99 UNTIL A%=4",
        "20 A%=A%+3 : Y=SQRT(A%)+SIN(A%)\n30 GOTO 20",
    ],
)
def test_what_a_loop_does_in_a_round_counts(tmp_path: Path, loop: str) -> None:
    """The machine's time is the same, and so is that of the computer: 5 to 20 s where rounds alone counted."""
    (tmp_path / "MADE").write_text("10 A%=1\n")
    text = ProgramText.from_text(f"5 DIM S$(40)\n10 X!=1 : A%=1\n{loop}\n", "main")
    before = time.process_time()
    (alarm,) = run(text, "mill3", "bosch", root=tmp_path, check=False).alarms
    assert time.process_time() - before < 3.0
    assert alarm.text == "the program has looped for 0.2 s without a block or a WAIT"


def test_a_loop_that_asks_the_clock_has_longer(tmp_path: Path) -> None:
    text = ProgramText.from_text(
        "10 T%=CLOCK\n20 WHILE CLOCK-T%<230 DO\n30 A%=3\n40 END\nN50 G1 X7 F6000\n", "main"
    )
    result = run(text, "mill3", "bosch", root=tmp_path)
    assert (result.alarms, result.end_position_mm["X"]) == ([], 7)


@pytest.mark.covers("cpl.err.SCS_LIST", "cpl.SCS", "cpl.SCSL")
@pytest.mark.parametrize("elements", [[], [7], (7, 8), ["a"]])
def test_a_list_of_a_drive_is_one_however_long_it_is(elements: list[int | str]) -> None:
    written: list[list[str]] = []
    drives = Drives(
        physical=lambda axis: 1,
        read=lambda axis, ident: elements,
        write=lambda name, lines: written.append(list(lines)),
    )
    with pytest.raises(Fault, match="INVALID PARAMETER"):
        drives.scs(1, "S", 17)
    assert drives.scsl(1, "S", 17, "LIST") == 0
    assert written == [[str(each) for each in elements]]
