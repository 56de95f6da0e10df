"""What the manual of CPL shows beside its chapters: examples, older controls, start and link (Manual 003)."""

from __future__ import annotations

from pathlib import Path

import pytest

from polycnc.nc.cpl import Linker
from support.cpl_host import Ran, RecordingHost
from support.cpl_runs import Root
from support.cpl_screens import Shown

END = b"\x03\n"


@pytest.fixture
def root(tmp_path: Path) -> Root:
    return Root(tmp_path)


def link_errors(text: str) -> list[str]:
    found = Linker(RecordingHost().program).link(text, "main.cpl")[1]
    return [f"{error.position.line}: {error.what}" for error in found if error.position]


# ---------------------------------------------------------------------- examples


@pytest.mark.covers("cpl.ex.3360")
@pytest.mark.parametrize(("name", "size"), [("VWX$", 14), ("ABC$", 1), ("BCDE$", 10)])
def test_a_field_holds_as_many_characters_as_its_dim_says(name: str, size: int) -> None:
    text = "ZYXWVUTSRQPONMLK"
    ran = Ran(f'1 DIM {name}({size})\n2 #L%=LEN({name})\n3 {name}="{text}"\n4 #T$={name} : #M%=LEN({name})')
    assert (ran["#L%"], ran["#M%"]) == (-1, size)
    assert Ran(f'1 DIM {name}({size})\n2 {name}="{text}"\n3 #E?={name}="{text[:size]}"')["#E?"] is True


@pytest.mark.covers("cpl.ex.3775")
def test_texts_are_chained_in_prn(root: Root) -> None:
    root.run(
        '1 DIM A$(3)\n2 DIM B$(3)\n3 A$="ABC"\n4 B$="DEF"\n5 C$="GH"\n6 D$="JKL"\n'
        '7 OPENW(1,"P2",130,"CHAINING TEST",10)\n8 PRN#(1,A$+B$)\n9 PRN#(1,A$+C$)\n10 PRN#(1,C$+D$)\n'
        '11 PRN#(1,A$+C$+"TEST")\n12 PRN#(1,"UVW"+"XYZ")\n13 CLOSE(1)'
    )
    assert root.read("P2") == b"ABCDEF    \nABCGH     \nGHJKL     \nABCGHTEST \nUVWXYZ    \n" + END


@pytest.mark.covers("cpl.ex.3854")
def test_the_manual_s_file_names_are_three_files(root: Root) -> None:
    names = ("P123456789.PRG", "P12_Data_Dial", "P12_DATA_DIAL")
    for number, name in enumerate(names, 2):
        root.run(f'1 OPENW(1,"{name}")\n2 PRN#(1,"#",{number})')
    assert [root.read(name) for name in names] == [b"%d\n" % number + END for number in (2, 3, 4)]


KEY_BAR = """\
Z%=0 : COL(0,7,0)
DSP(41,4,P1$) : DSP(41,13,P2$) : DSP(41,22,P3$)
DSP(41,31,P4$) : DSP(41,40,P5$) : DSP(41,49,P6$) : DSP(41,58,P7$) : DSP(41,67,P8$)
REPEAT
REPEAT
K%=INKEY
UNTIL ((K%=141) OR (K%=142) OR (K%=143) OR (K%=144) OR (K%=145) OR (K%=146) OR (K%=147) OR (K%=148) OR (K%=139))
JZ%=Z%-140 : JK%=K%-140
IF ((JZ%>0) AND (JZ%<9)) THEN COL(0,7,0)
FOR I%=0 TO 2
DSP(41+I%,(JZ%-1)*8+JZ%+1,"        ")
NEXT I%
IF Z%=141 THEN DSP(41,4,P1$) ENDIF
IF Z%=146 THEN DSP(41,49,P6$) ENDIF
ENDIF
IF ((JK%>0) AND (JK%<9)) THEN COL(0,0,7)
FOR I%=0 TO 2
DSP(41+I%,(JK%-1)*8+JK%+1,"        ")
NEXT I%
IF K%=141 THEN DSP(41,4,P1$) ENDIF
IF K%=146 THEN DSP(41,49,P6$) ENDIF
ENDIF
Z%=K%
UNTIL K%=139"""


@pytest.mark.covers("cpl.ex.4659")
@pytest.mark.parametrize(("last", "ink", "paper"), [("139", 7, 0), ("146", 0, 7)])
def test_softkeys_are_drawn_and_read_by_inkey(tmp_path: Path, last: str, ink: int, paper: int) -> None:
    """The key pressed last is inverse, all three lines of it, until the next is pressed."""
    bar = KEY_BAR.replace("UNTIL K%=139", f"UNTIL K%={last}").split("\n")
    lines = [f"{number} {line}" for number, line in enumerate(bar, 1)]
    (tmp_path / "UNTPR").write_text("\n".join(lines) + "\nM30\n", encoding="utf-8")
    texts = ",".join(f'"SOFT{number}"' for number in range(1, 9))
    keys = ("x", "SOFTKEY1", "SOFTKEY6", "LEVEL_RETURN")
    shown = Shown(f"1 CALL UNTPR [{texts}]\n2 #DONE%=3", tmp_path, *keys)
    assert shown[41].split() == [f"SOFT{number}" for number in range(1, 9)]
    cells = shown.surface.cells
    assert [cells[41, column] for column in (4, 58)] == [("S", 7, 0)] * 2
    assert cells[41, 49] == ("S", ink, paper)
    assert cells[43, 47] == (" ", ink, paper)
    assert shown.globals["#DONE%"] == 3


# ---------------------------------------------------------------------- older controls


@pytest.mark.covers("cpl.removed.TD_TDR", "cpl.removed.FIX_FIXB_FIXE", "cpl.removed.MIC", "cpl.removed.TXT$")
@pytest.mark.parametrize("word", ["TD", "TDR", "FIX", "FIXB", "FIXE", "MIC", "TXT$"])
def test_words_of_older_controls_have_no_function(word: str) -> None:
    assert link_errors(f"1 {word}(3)") == [f"1: {word} has no function"]
    assert link_errors(f"1 A={word}(3)") == [f"1: {word} has no function"]


@pytest.mark.covers("cpl.removed.CLX")
def test_the_background_is_no_longer_set_by_clx() -> None:
    assert link_errors("1 CLX(3)") == ["1: = MISSING"]


@pytest.mark.covers("cpl.removed.OPENR_TTY", "cpl.removed.OPENW_TTY")
@pytest.mark.parametrize(("word", "most"), [("OPENR", 3), ("OPENW", 5)])
def test_no_serial_interface_is_opened(root: Root, word: str, most: int) -> None:
    assert link_errors(f'1 {word}("TTY")') == [f"1: {word} takes 2 to {most} arguments, not 1"]
    assert root.error(f'1 {word}("TTY",2)') == "1: INVALID LOGICAL NUMBER"


@pytest.mark.covers("cpl.changed.REM")
def test_nothing_follows_a_rem_in_its_block() -> None:
    ran = Ran('10 #A=2 : REM, this is a comment: DSP(1,1,"A"): #A=3\n20 #B=#A*2')
    assert (ran["#A"], ran["#B"]) == (2.0, 4.0)


@pytest.mark.covers("cpl.changed.COL")
def test_col_has_background_table_and_softkeys_from_its_third_argument_on(tmp_path: Path) -> None:
    shown = Shown('1 COL(,,5,7,6)\n2 DSP(2,3,"A")', tmp_path)
    assert shown.surface.cells[2, 3] == ("A", 2, 5)
    assert shown.surface.table == 2
    assert shown.surface.softkey_colours == (6, 4)


@pytest.mark.covers("cpl.changed.SFK", "cpl.changed.control_panel")
def test_the_panel_has_eight_softkeys_below_46_lines(tmp_path: Path) -> None:
    names = ",".join(f'"KEY{number}"' for number in range(1, 9))
    shown = Shown(f'1 DSP(46,79,"Z")\n2 SFK(#K%,{names})', tmp_path, "SOFTKEY8", finish=False)
    assert shown.globals["#K%"] == 8
    assert shown[43].split() == [f"KEY{number}" for number in range(1, 9)]
    assert shown[46][78] == "Z"
    assert shown.surface.pixels.shape == (415, 633)
    assert link_errors(f'1 SFK(#K%,{names},"KEY9")')[0].startswith("1: SFK takes 1 to 9 arguments")


@pytest.mark.covers("cpl.changed.key_codes")
def test_level_return_and_softkeys_have_codes_above_the_characters(tmp_path: Path) -> None:
    text = "1 #A%=INKEY : #B%=INKEY : #C%=INKEY : #D%=INKEY"
    found = Shown(text, tmp_path, "LEVEL_RETURN", "SOFTKEY3", "SOFTKEY8", "~").globals
    assert [found[f"#{name}%"] for name in "ABCD"] == [139, 143, 148, 126]


@pytest.mark.covers("cpl.changed.key_codes", "cpl.INKEY")
@pytest.mark.parametrize(
    ("key", "code"),
    [
        pytest.param("CURSOR_UP", 131, marks=pytest.mark.covers("cpl.key.CURSOR_UP")),
        pytest.param("CURSOR_DOWN", 132, marks=pytest.mark.covers("cpl.key.CURSOR_DOWN")),
        pytest.param("CURSOR_RIGHT", 133, marks=pytest.mark.covers("cpl.key.CURSOR_RIGHT")),
        pytest.param("CURSOR_LEFT", 134, marks=pytest.mark.covers("cpl.key.CURSOR_LEFT")),
    ],
)
def test_cursor_keys_have_codes_of_their_own(tmp_path: Path, key: str, code: int) -> None:
    """The manual's table has lost the codes; these are ruled."""
    found = Shown("1 #A%=INKEY : #B%=INKEY : #C%=INKEY", tmp_path, "a", key, "b").globals
    assert [found[f"#{name}%"] for name in "ABC"] == [97, code, 98]


@pytest.mark.covers("cpl.ASC")
@pytest.mark.covers("cpl.ascii")
@pytest.mark.parametrize("code", range(128))
def test_characters_have_their_standard_codes(code: int) -> None:
    ran = Ran(f"1 DIM A$(3) : A$=CHR$({code}) : #A%=ASC(A$) : #L%=LEN(A$)")
    assert (ran["#A%"], ran["#L%"]) == (code, 1)
    if chr(code) in '\n\r"':
        return
    assert Ran(f'1 #B%=ASC("{chr(code)}")')["#B%"] == code


# ---------------------------------------------------------------------- start and link


@pytest.mark.covers("cpl.start")
@pytest.mark.parametrize("lines", ["1 @5=7\n2 @6=@5*3", "N5 G1 X2.5 F1000\n1 @5=7\nN6 X[@5]\n2 @6=21"])
def test_a_program_is_all_cpl_or_a_mixture(root: Root, lines: str) -> None:
    found = root.run(lines).variables
    assert (found["@5"], found["@6"]) == (7, 21)


@pytest.mark.parametrize(
    ("wrong", "what"),
    [
        ("30 A=(2", "5: ')' is missing before the end"),
        ("30 GOTO .NOWHERE", "5: there is no jump destination .NOWHERE"),
        ("30 CALL NONE", "5: there is no sub-program NONE"),
    ],
)
def test_a_program_that_does_not_link_is_not_started(root: Root, wrong: str, what: str) -> None:
    text = f"10 @7=3\nN20 G1 X40 F6000\n21 @7=4\nN22 X50\n{wrong}"
    run = root.run(text, check=False)
    assert [f"{alarm.line}: {alarm.text}" for alarm in run.alarms] == [what]
    assert run.variables.get("@7") is None
    assert root.run("1 #A=MPOS(1) : #B%=@7").variables["#B%"] is None


@pytest.mark.covers("cpl.programcheck")
def test_functions_refer_to_the_number_as_the_control_holds_it() -> None:
    """16777217 has no REAL of its own: the function sees its neighbour, and so does who looks at the variable."""
    ran = Ran(
        "1 X=16777217 : #I%=INT(X) : #R%=ROUND(X) : X!=16777217 : #J%=INT(X!) : #A=ABS(-X)\n"
        "2 S!=0.1 : S=0.1 : #E?=S!=S"
    )
    assert [ran[name] for name in ("#I%", "#R%", "#J%", "#A")] == [16777216, 16777216, 16777217, 16777216.0]
    assert ran["#E?"] is False


@pytest.mark.covers("cpl.annex.A2")
@pytest.mark.parametrize(
    "line",
    [
        "N10 G1 [AXP(1,5)]", "N10 G1 [AXP(1,5,0)]", "10 A$=CHR$(65)", "10 E%=MCODS(32,2,V,B%,2)",
        "10 E%=MCOPS(2,2,2,1,0,0)", '10 PRN(1,1,"A")', '10 PRN(1,1,"A",X)', "10 A=VAL(B$)", "10 B$=TRIM$(A$)",
        '10 S=SCS(1,"S",51)', '10 S%=SCSL(1,"S",51,"F",E%)', "10 A?=IC(5,1,2)", "10 A?=IC(5)",
    ],
)  # fmt: skip
def test_the_overview_s_shorter_forms_are_read(line: str) -> None:
    assert link_errors(line) == []


@pytest.mark.covers("cpl.TRIM$.none", "cpl.TRIM$")
def test_trim_without_a_side_takes_blanks_from_both() -> None:
    ran = Ran(
        '1 DIM A$(20)\n2 A$="  AB C   "\n3 #L%=LEN(TRIM$(A$)) : #E?=TRIM$(A$)="AB C" : #N%=LEN(TRIM$("   "))'
    )
    assert (ran["#L%"], ran["#E?"], ran["#N%"]) == (4, True, 0)


# ---------------------------------------------------------------------- errors


@pytest.mark.covers("cpl.FILEPOS", "cpl.INSTR")
@pytest.mark.covers("cpl.err.INVALID_PARAMETER")
@pytest.mark.parametrize(
    "wrong",
    [
        "T$=MID$(A$,0)", "T$=MID$(A$,1025)", "T$=MID$(A$,1,0)", "T$=MID$(A$,1,1025)", "MID$(A$,0,2)=A$",
        "I%=INSTR(A$,A$,0)", "I%=INSTR(A$,A$,1025)", "I%=FILEPOS(1,0)", "I%=FILEPOS(1,4)", "I%=FILESIZE(3,0)",
        "I%=FILESIZE(3,5)", "SEEK(1,1,0)", "SEEK(1,1,10)", "SEEK(3,1,1)",
    ],
)  # fmt: skip
def test_a_parameter_outside_its_range_is_named_so(root: Root, wrong: str) -> None:
    begin = '1 DIM A$(9) : A$="ABCDEFGHI" : OPENW(1,"P1",200,8) : PRN#(1,"A") : OPENR(3,"P2")\n'
    assert root.error(f"{begin}2 {wrong}") == "2: INVALID PARAMETER"
    assert root.run(
        f"{begin}2 I%=FILEPOS(1,3) : SEEK(1,1,9) : T$=MID$(A$,1,1024) : I%=INSTR(A$,A$,1024)"
    ).variables


@pytest.mark.covers("cpl.err.PRN_FORMAT_INCORRECT")
def test_what_does_not_fit_its_format_is_starred_and_told(root: Root) -> None:
    said = root.said('1 OPENW(1,"P1") : PRN#(1,"A #.# ##",31.5,7)\n2 PRN#(0,"on")')
    assert said == ["PRN FORMAT INCORRECT: #.#", "on"]
    assert root.read("P1") == b"A ***  7\n" + END
