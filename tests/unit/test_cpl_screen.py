"""Dialogs and graphics of CPL programs on a screen without a device (Manual 003, chapters 7 and 8)."""

from __future__ import annotations

import math
import struct
from pathlib import Path

import numpy as np
import pytest

from polycnc.errors import UsageError
from polycnc.runner import read_keys
from support.cpl_rows import rows_of
from support.cpl_runs import Root
from support.cpl_screens import Shown

# ---------------------------------------------------------------------- text


@pytest.mark.covers("cpl.dialog.screen")
def test_the_window_has_46_lines_of_79_characters_on_633_by_415_pixels(tmp_path: Path) -> None:
    shown = Shown('1 DSP(46,78,"ABC")\n2 DSP(1,1,"X")', tmp_path)
    assert [len(line) for line in shown.lines] == [79] * 46
    assert shown.surface.pixels.shape == (415, 633)
    assert (shown[1], shown[46]) == ("X", " " * 77 + "AB")


@pytest.mark.covers("cpl.ex.4565")
def test_dsp_writes_a_table_of_roots(tmp_path: Path) -> None:
    shown = Shown(
        '10 LIN%=4 : COL%=1\n20 FOR I%=1 TO 10\n30 DSP(LIN%+I%,COL%,"###.### IS ROOT OF ##",SQRT(I%),I%)\n40 NEXT I%',
        tmp_path,
    )
    assert shown[5] == "  1.000 IS ROOT OF  1"
    assert shown[7] == "  1.732 IS ROOT OF  3"
    assert shown[14] == "  3.162 IS ROOT OF 10"


@pytest.mark.covers("cpl.DSP", "cpl.ex.4579", "cpl.ex.4587", "cpl.ex.4603")
def test_dsp_puts_numbers_into_formats_wherever_they_stand(tmp_path: Path) -> None:
    shown = Shown(
        '10 A=25 : B=SQRT(A) : Z=5.4 : S=10\n20 DSP(Z,S,"A=",A," B=",B," C= ",A+B)\n'
        '30 FA$=" A= ###.#" : FB$=" B= #.#" : FC$=" C= ##"\n40 DSP(6,10,FA$,FB$,FC$,A,B,B+A)\n'
        '50 X=1.5:Y=2.5:B?=TRUE:I%=200:T1$=" MEAS.PROBE=":T2$=" NO.="\n'
        '60 DSP(7,5,"XPOS ###.### YPOS ###.###",T1$,B?,X,Y,T2$,I%)',
        tmp_path,
    )
    assert shown[5] == " " * 9 + "A=  25.000 B=   5.000 C=   30.000"
    assert shown[6] == " " * 9 + " A=  25.0 B= 5.0 C= 30"
    assert shown[7] == " " * 4 + "XPOS   1.500 YPOS   2.500 MEAS.PROBE=TRUE NO.=      200"


PLACE = "1: Invalid line or column number in CPL command"
WRONG = "1: INVALID PARAMETER"
NO_KEY = "1: the program waits for a key, and none is pressed"
REFUSED = [
    ('1 DSP(47,1,"A")', PLACE, "cpl.err.INVALID_LINE_COLUMN"),
    ('1 DSP(0,1,"A")', PLACE, "cpl.err.INVALID_LINE_COLUMN"),
    ('1 DSP(1,0,"A")', PLACE, "cpl.err.INVALID_LINE_COLUMN"),
    ('1 DSP(1,80,"A")', PLACE, "cpl.err.INVALID_LINE_COLUMN"),
    ('1 PRN(47,1,"A")', PLACE, "cpl.PRN"),
    ('1 PRN(1,80,"A")', PLACE, "cpl.PRN"),
    ('1 DSP(0.4,1,"A")', PLACE, "cpl.err.INVALID_LINE_COLUMN"),
    ('1 DSP(1,1,"' + "A" * 78 + '")', "1: maximum string length exceeded", "cpl.err.MAX_STRING_LENGTH"),
    ('1 DSP(1,1,"#.#",123.5)', "1: format not permitted", "cpl.err.FORMAT_NOT_PERMITTED"),
    *(
        (f"1 GWD({edges})", WRONG)
        for edges in ("0,633,0,374", "5,5,0,374", "0,632,0,375", "-1,632,0,374", "0,632,-1,374", "0,632,7,7")
    ),
    *((f"1 MWD({edges})", WRONG) for edges in ("5,5,0,9", "5,4,0,9", "0,9,3,3", "0,9,4,3")),
    *((f'1 GPR({place},"A")', WRONG) for place in ("633,0", "-1,0", "0,415", "0,-1")),
    *((f'1 BMP({place},"A")', WRONG, "cpl.BMP") for place in ("633,0", "-1,0", "0,375", "0,-1")),
    ('1 BMP(0,0,"A",9)', WRONG, "cpl.BMP"),
    ('1 BMP(0,0,"A",-1)', WRONG, "cpl.BMP"),
    (f'1 BMP(0,0,"{"m" * 71}")', "1: INVALID FILE NAME", "cpl.BMP"),
    ("1 GMD(5)", WRONG),
    ("1 GMD(-1)", WRONG),
    ("1 COL(8)", WRONG),
    ("1 COL(-1)", WRONG),
    ("1 COL(,,,4)", WRONG),
    ("1 COL(,,,2)", WRONG),
    ("1 COL(,,,TRUE)", WRONG),
    ("1 RGB(3,256,0,0)", WRONG),
    ("1 RGB(3,0,-1,0)", WRONG),
    ("1 RGB(8,0,0,0)", WRONG),
    ("1 TFO(11)", WRONG),
    ("1 TFO(-1)", WRONG),
    ("1 TFO(,501)", WRONG, "cpl.TFO.size.hw"),
    ("1 TFO(,501500)", WRONG, "cpl.TFO.size.hw"),
    ("1 TFO(,500000)", WRONG, "cpl.TFO.size.hw"),
    ("1 TFO(,,4)", WRONG),
    ("1 TFO(,,,361)", WRONG),
    ("1 LIN(1,2,3)", WRONG),
    ("1 CIR(,,5)", WRONG),
    ("1 CIR(5,5,0)", WRONG),
    ("1 CIR(5,5,-1)", WRONG),
    ("1 FIL(1,1,6,2)", WRONG),
    ("1 FIL(1,1,-1,2)", WRONG),
    ("1 FIL(1,1,0,8)", WRONG),
    ("1 SFK(K%)", NO_KEY, "cpl.SFK"),
    ("1 INP(X)", "1: INP WITHOUT PRN", "cpl.INP"),
    ("1 WHILE INKEY<>13 DO\n2 A=1\n3 END", NO_KEY, "cpl.INKEY"),
]


@pytest.mark.parametrize(
    ("program", "what"),
    [
        pytest.param(program, what, marks=pytest.mark.covers(*rows_of(program.partition("(")[0]), *rows))
        for program, what, *rows in REFUSED
    ],
)
def test_dialog_commands_refuse(tmp_path: Path, program: str, what: str) -> None:
    assert Root(tmp_path).error(program) == what


@pytest.mark.covers(
    "cpl.DSP", "cpl.dialog.screen", "cpl.GPR", "cpl.BMP", "cpl.TFO", "cpl.TFO.size.hw", "cpl.COL", "cpl.RGB", "cpl.GMD",
    "cpl.GWD", "cpl.MWD", "cpl.LIN", "cpl.CIR", "cpl.FIL", "cpl.CLR", "cpl.err.MAX_STRING_LENGTH", "cpl.INKEY",
    "cpl.err.INVALID_LINE_COLUMN",
)  # fmt: skip
def test_dialog_commands_take_the_last_that_is_allowed(tmp_path: Path) -> None:
    """What lies at the borders of the window, and the last of fonts, sizes, cuts, colours, patterns and copy types."""
    (tmp_path / "cplbmp").mkdir()
    (tmp_path / f"cplbmp/{'m' * 70}.bmp").write_bytes(_bmp([[RED]]))
    shown = Shown(
        f'1 DSP(46,79,"AB") : DSP(1,1,"{"T" * 77}") : GPR(0,0,"LOW") : GPR(632,414,"HIGH") : COL(7,6,1)\n'
        f'2 DSP(2,79,"C") : RGB(7,255,255,255) : RGB(0,0,0,1) : LIN(10,374,40,374) : GWD(0,632,0,374)\n'
        f'3 BMP(632,374,"{"m" * 70}",8) : MWD(0,632,0,374) : CIR(100,100,9) : LIN(40,370) : GMD(4) : LIN(0,1,632,1)\n'
        '4 GMD(0) : FIL(300,300,5,3,7) : TFO(10,500500,3,360) : GPR(5,6,"BIG") : TFO(5,9,0,90) : GPR(7,8,"FLAT")\n'
        "5 #K%=INKEY : CLG : #L%=INKEY : DLF : #M%=INKEY",
        tmp_path, "x", "y", finish=False,
    )  # fmt: skip
    assert [shown.globals[f"#{each}%"] for each in "KLM"] == [120, 0, 121]
    assert shown.surface.tables[3][7] == (255, 255, 255)
    shown = Shown(
        '1 DSP(46,79,"AB") : DSP(2,79,"C") : GPR(632,414,"H") : COL(7) : LIN(10,374,40,374) : CIR(100,100,9)\n'
        '2 LIN(40,370) : TFO(10,500500,3,360) : GPR(5,6,"BIG") : TFO(5,9,0,90) : GPR(7,8,"FLAT")',
        tmp_path, finish=False,
    )  # fmt: skip
    assert (shown[46][78:], shown[2], shown.lines[0][78:]) == ("A", " " * 78 + "C", " ")
    assert [tuple(each) for each in (text.font for text in shown.surface.texts[1:])] == [
        (10, 500, 500, 3, 0), (5, 9, 0, 0, 0),
    ]  # fmt: skip
    # the line goes on from the last line, not from the circle; it begins in the top row
    assert [shown.colour(x, y) for x, y in ((10, 374), (40, 374), (40, 372), (70, 235), (9, 374))] == [
        7,
        7,
        7,
        -1,
        -1,
    ]
    assert [Shown(f"1 COL({code}) : LIN(5,5,9,5)", tmp_path).colour(7, 5) for code in (0, 7)] == [0, 7]
    corners = Shown("1 LIN(0,0,0,374) : LIN(632,374) : LIN(632,0) : LIN(0,0)", tmp_path)
    assert [corners.colour(x, y) for x in (0, 632) for y in (0, 1, 373, 374)] == [1] * 8
    cleared = Shown("1 LIN(10,374,40,374) : LIN(0,0,0,9) : LIN(632,3,632,5) : CLR", tmp_path)
    assert int(cleared.surface.pixels.max()) == -1
    box = "1 COL(3) : LIN(10,10,20,10) : LIN(20,20) : LIN(10,20) : LIN(10,10) : FIL(15,15,5,"
    assert (Shown(box + "3)", tmp_path).colour(12, 12), Shown(box + "5,3)", tmp_path).colour(12, 12)) == (
        3,
        5,
    )
    assert (Shown(box + "5)", tmp_path).colour(9, 9), Shown(box + "5,3)", tmp_path).colour(9, 9)) == (5, -1)


@pytest.mark.covers("cpl.SFK", "cpl.INP", "cpl.PRN")
def test_softkeys_have_three_lines_of_nine_and_a_number_nine_digits(tmp_path: Path) -> None:
    shown = Shown(
        '1 SFK(K%,"A&B&C&D",,,,,,,"123456789X")\n2 #K%=K%', tmp_path, "ENTER", "SOFTKEY8", finish=False
    )
    assert shown.globals["#K%"] == 8
    assert [shown[line].split()[0] for line in (43, 44, 45)] == ["A", "B", "C"]
    assert shown[43].split()[-1] == "123456789"
    assert shown[46] == ""
    typed = '1 DLG : PRN(1,1,"N",#N%) : INP(#N%) : ENDDLG'
    assert Shown(typed, tmp_path, *"1234567890", "ENTER").globals["#N%"] == 123456789


# ---------------------------------------------------------------------- keys


@pytest.mark.covers(
    "cpl.INKEY", "cpl.key.ENTER", "cpl.key.LEVEL_RETURN", *(f"cpl.key.SOFTKEY{n}" for n in range(1, 9))
)
def test_inkey_returns_the_codes_of_keys_one_by_one(tmp_path: Path) -> None:
    keys = ("B", "LEVEL_RETURN", *(f"SOFTKEY{number}" for number in range(1, 9)), "ENTER")
    shown = Shown(
        "1 DIM K%(12) : I%=0\n2 REPEAT\n3 N%=INKEY : I%=I%+1 : #K%=#K%+0\n4 K%(I%)=N%\n5 UNTIL N%=13\n6 #I%=I%\n"
        '7 FOR J%=1 TO 11\n8 DSP(J%,1,"###",K%(J%))\n9 NEXT\n10 #L%=INKEY'.replace("#K%=#K%+0", "Z%=0"),
        tmp_path, *keys,
    )  # fmt: skip
    assert shown.globals["#I%"] == 11
    assert [int(shown[line]) for line in range(1, 12)] == [66, 139, *range(141, 149), 13]
    assert shown.globals["#L%"] == 0


@pytest.mark.covers("cpl.DLF", "cpl.CLG", "cpl.INKEY")
def test_inkey_sees_keys_only_while_the_window_is_in_front(tmp_path: Path) -> None:
    shown = Shown("1 CLG\n2 #A%=INKEY\n3 DLF\n4 #B%=INKEY", tmp_path, "x")
    assert (shown.globals["#A%"], shown.globals["#B%"]) == (0, 120)


@pytest.mark.covers("cpl.SFK")
def test_a_softkey_gives_its_number_or_its_text(tmp_path: Path) -> None:
    text = '12 #KEY%=7\n13 SFK(#KEY%,,"ABORT",,"ACTION&NOW",,,,)'
    assert Shown(text, tmp_path, "A", "SOFTKEY4").globals["#KEY%"] == 4
    assert Shown(text, tmp_path, "LEVEL_RETURN", "SOFTKEY2").globals["#KEY%"] == 7
    text = '11 DIM K$(9)\n12 SFK(K$,,"ABORT",,"ACTION")\n13 #L%=LEN(K$) : DSP(1,1,K$)'
    shown = Shown(text, tmp_path, "SOFTKEY2", finish=False)
    assert shown[1] == "ABORT"
    assert shown[43][12:].split() == ["ABORT", "ACTION"]
    assert shown[43].index("ABORT") in range(12, 21)
    assert Shown(text, tmp_path, "SOFTKEY2")[43] == ""


@pytest.mark.covers("cpl.CSF")
def test_softkeys_go_on_demand(tmp_path: Path) -> None:
    assert Shown('1 SFK(K%,"ONE")\n2 CSF', tmp_path, "SOFTKEY1", finish=False)[43] == ""


@pytest.mark.covers("cpl.DLG", "cpl.ENDDLG", "cpl.INP", "cpl.PRN")
def test_a_dialog_shows_its_texts_and_takes_numbers(tmp_path: Path) -> None:
    text = (
        '20 #DP=7.25\n30 DLG\n40 PRN(8,4,"MAX. CUTTING WIDTH: ###.### MM",#WI)\n'
        '50 PRN(10,4,"MAX. CUTTING DEPTH: ###.### MM",#DP)\n55 DSP(1,1,"-")\n60 INP(#WI):INP(#DP)\n70 ENDDLG'
    )
    shown = Shown(text, tmp_path, *"12.50", "ENTER", "CURSOR_DOWN")
    assert (shown.globals["#WI"], shown.globals["#DP"]) == (12.5, 7.25)
    assert shown[8] == "   MAX. CUTTING WIDTH:  12.500 MM"
    assert shown[10] == "   MAX. CUTTING DEPTH:   7.250 MM"
    shown = Shown(text, tmp_path, *"1234.56789", "ENTER", "DELETE", "ENTER")
    assert shown.globals["#WI"] == pytest.approx(123.567, abs=1e-4)
    assert shown.globals["#DP"] is None
    assert shown[10] == "   MAX. CUTTING DEPTH: ###.### MM"


def test_a_text_without_a_number_is_shown_and_not_asked_for(tmp_path: Path) -> None:
    text = '30 DLG\n40 PRN(8,4,"WIDTH: ###.###",#WI)\n50 PRN(10,4,"IN MM",)\n60 INP(#WI)\n70 ENDDLG'
    shown = Shown(text.replace(",)", ")"), tmp_path, *"3.5", "ENTER")
    assert shown.globals["#WI"] == 3.5
    assert (shown[8], shown[10]) == ("   WIDTH:   3.500", "   IN MM")


# ---------------------------------------------------------------------- colours, fonts, clearing


@pytest.mark.covers(
    "cpl.COL", "cpl.COL.arg.graphics", "cpl.COL.arg.text", "cpl.COL.arg.textBG", "cpl.COL.arg.SK", "cpl.COL.arg.SKBG",
    "cpl.color.default.lines_and_circles", "cpl.color.default.text", "cpl.color.default.text_background",
    "cpl.color.default.softkeys", "cpl.color.default.softkey_background",
)  # fmt: skip
def test_colours_are_those_in_force_when_something_is_drawn(tmp_path: Path) -> None:
    shown = Shown(
        '1 LIN(5,5,9,5) : DSP(1,1,"A")\n2 COL(4) : COL(,6,5)\n3 LIN(5,7,9,7) : DSP(2,1,"A")', tmp_path
    )
    assert (shown.colour(7, 5), shown.colour(7, 7), shown.colour(7, 6)) == (1, 4, -1)
    assert shown.surface.cells[1, 1] == ("A", 2, 0)
    assert shown.surface.cells[2, 1] == ("A", 6, 5)
    assert shown.surface.softkey_colours == (3, 4)
    assert Shown("1 COL(,,,,1,7)", tmp_path).surface.softkey_colours == (1, 7)


@pytest.mark.covers(
    "cpl.COL.arg.tab", "cpl.COL.tab.7", "cpl.COL.tab.10", "cpl.color.tables", "cpl.RGB", "cpl.COL"
)
def test_a_table_of_colours_erases_the_screen(tmp_path: Path) -> None:
    shown = Shown('1 DSP(1,1,"A") : LIN(5,5,9,5) : RGB(3,10,20,250)\n2 COL(,,,7)\n3 DSP(2,1,"B")', tmp_path)
    assert (shown[1], shown[2], shown.colour(7, 5)) == ("", "B", -1)
    assert (shown.surface.table, shown.surface.rgb(7)) == (2, "#000000")
    two = list(shown.surface.tables[2])
    shown = Shown("1 RGB(3,10,20,250)\n2 COL(,,,10)", tmp_path)
    assert (shown.surface.table, shown.surface.rgb(3)) == (3, "#0a14fa")
    assert shown.surface.tables[3] == [*two[:3], (10, 20, 250), *two[4:]]


@pytest.mark.covers("cpl.COL.tab.1", "cpl.color.default.graphics_background", "cpl.COL")
def test_table_1_and_its_background_are_there_at_the_start_and_on_demand(tmp_path: Path) -> None:
    shown = Shown("1 A=5", tmp_path)
    assert shown.surface.table == 1
    assert '<rect width="633" height="415" fill="#000000"/>' in shown.surface.svg()
    shown = Shown('1 COL(,,,7)\n2 DSP(1,1,"A")', tmp_path)
    assert '<rect width="633" height="415" fill="#ffffff"/>' in shown.surface.svg()
    shown = Shown('1 COL(,,,7)\n2 DSP(1,1,"A")\n3 COL(,,,1)', tmp_path)
    assert (shown.surface.table, shown[1]) == (1, "")


@pytest.mark.covers(
    "cpl.TFO", "cpl.TFO.omit", "cpl.TFO.size.h", "cpl.TFO.size.hw", "cpl.TFO.size.0", "cpl.TFO.orientation",
    *(f"cpl.TFO.cut.{n}" for n in range(4)), *(f"cpl.TFO.font.{n}" for n in range(11)),
)  # fmt: skip
@pytest.mark.parametrize(
    ("font", "family"),
    list(enumerate(["Lucida Console", "Arial", "Verdana", "Book Antiqua", "Times New Roman", "Bosch", "Impact",
               "Haettenschweiler", "Comic Sans MS", "Brush Script MT", "Wingdings"])),
)  # fmt: skip
def test_fonts_have_size_cut_and_orientation(tmp_path: Path, font: int, family: str) -> None:
    shown = Shown(
        f'1 TFO({font},20,1,30) : DSP(3,4,"A")\n2 TFO(,12+17*1000,3) : DSP(4,4,"BC")\n3 TFO(,,2,0) : GPR(9,9,"D")\n'
        '4 TFO(0,0,0,0) : DSP(5,4,"E")',
        tmp_path,
    )
    angle = 0 if font == 5 else 30
    assert [text.font for text in shown.surface.texts] == [
        (font, 20, 0, 1, angle), (font, 12, 17, 3, angle), (font, 12, 17, 2, 0)
    ]  # fmt: skip
    assert shown.surface.texts[0][:3] == (24, 415 - 27, "A")
    assert shown.surface.cells[5, 4].character == "E"
    drawn = [line for line in shown.surface.svg().splitlines() if line.startswith("<text")]
    assert [f'"{family}, monospace"' in line for line in drawn] == [font == 0, True, True, True]
    assert ['font-weight="bold"' in line for line in drawn] == [False, True, True, False]
    assert ['font-style="italic"' in line for line in drawn] == [False, False, True, True]
    assert ["rotate(-30 " in line for line in drawn] == [False, angle > 0, angle > 0, False]
    assert 'font-size="20"' in drawn[1]
    assert 'textLength="34"' in drawn[2]
    assert 'font-size="9"' in drawn[0]


@pytest.mark.covers("cpl.CLS", "cpl.CLG", "cpl.CLR")
def test_clearing_takes_all_or_the_window(tmp_path: Path) -> None:
    text = '1 DSP(1,1,"A") : DSP(30,20,"B") : LIN(10,300,10,350) : LIN(150,100,170,100) : GPR(160,150,"C")\n'
    shown = Shown(text + "2 GWD(100,250,50,200) : CLR", tmp_path)
    assert (shown[1], shown[30], shown.colour(10, 320), shown.colour(160, 100)) == ("A", "", 1, -1)
    assert shown.surface.texts == []
    for word in ("CLS", "CLG"):
        shown = Shown(text + f"2 {word}", tmp_path)
        assert "".join(shown.lines).strip() == ""
        assert (shown.surface.pixels < 0).all()


# ---------------------------------------------------------------------- graphics


@pytest.mark.covers("cpl.LIN", "cpl.GWD")
def test_lines_go_on_from_the_last_point_within_the_window(tmp_path: Path) -> None:
    shown = Shown(
        "1 LIN(20,30,50,30) : LIN(,60) : LIN(70,)\n2 GWD(100,200,50,90) : LIN(90,60,210,60)", tmp_path
    )
    on = [(20, 30), (50, 30), (50, 60), (70, 60), (100, 60), (200, 60)]
    off = [(19, 30), (51, 30), (50, 61), (71, 60), (99, 60), (201, 60)]
    assert [shown.colour(*place) for place in on] == [1] * 6
    assert [shown.colour(*place) for place in off] == [-1] * 6


@pytest.mark.covers("cpl.MWD", "cpl.CIR", "cpl.FIL", "cpl.ex.5049")
def test_the_arrow_of_the_manual_is_drawn(tmp_path: Path) -> None:
    shown = Shown(
        "1 DLF\n2 COL(7,,,7)\n3 GWD(100,500,100,350)\n4 MWD(0,400,-150,100)\n5 LIN(50,-100,100,-50)\n"
        "6 CIR(100,-50,200,-50,150,-50)\n7 LIN(200,-50)\n8 LIN(,0)\n10 CIR(200,0,,,200,10)\n11 LIN(300,)\n13 GMD(3)\n"
        "14 CIR(300,0,300,-100,300,-50)\n15 GMD(0)\n16 LIN(50,-100)\n21 #XX=195 : #YY=-50 : #WI=30\n"
        "22 LIN(#XX,#YY,#XX+15*COS(#WI+165),#YY+15*SIN(#WI+165))\n"
        "23 LIN(#XX+15*COS(#WI+195),#YY+15*SIN(#WI+195)):LIN(#XX,#YY)\n"
        "25 FIL(#XX-10*COS(#WI),#YY-10*SIN(#WI),0,7,7)",
        tmp_path,
    )  # fmt: skip

    def at(x: float, y: float) -> int:
        return shown.colour(100 + round(x), 250 + round(y))

    assert [at(75, -75), at(100, -50), at(200, -50), at(200, -25), at(250, 0), at(175, -100)] == [7] * 6
    assert (at(150, 0), at(150, -99)) == (7, -1)  # the half circle goes over the top: clockwise
    assert [at(200 + 10 * math.cos(a), 10 + 10 * math.sin(a)) for a in (0.5, 2.0, 3.0, 5.0)] == [7] * 4
    arc = [at(300 + 50 * math.sin(a / 40), -50 + 50 * math.cos(a / 40)) for a in range(126)]
    assert {7, -1} == set(arc)
    assert [at(180.51, -53.88), at(184.4, -60.6), at(187, -54.5)] == [7, 7, 7]  # the tip and what fills it
    assert at(170, -50) == -1


@pytest.mark.covers("cpl.GPR", "cpl.ex.5106")
def test_labels_of_a_sine_lie_beside_their_crosses(tmp_path: Path) -> None:
    shown = Shown(
        "1 NR%=49\n2 FOR W%=0 STEP 45 TO 360\n3 X=75+W% : Y=175+100*SIN(W%)\n4 N$=CHR$(NR%) : NR%=NR%+1\n"
        '5 LIN(X,Y+10,X,Y-10) : LIN(X-10,Y,X+10,Y)\n6 GPR(X+16,Y+40,"pixel") : GPR(X+64,Y+40,N$)\n7 NEXT W%',
        tmp_path,
    )
    places = [(75 + w, math.floor(175 + 100 * math.sin(math.radians(w)) + 0.5)) for w in range(0, 361, 45)]
    for number, (x, y) in enumerate(places):
        assert [shown.colour(x + dx, y + dy) for dx, dy in ((0, 10), (0, -10), (10, 0), (-10, 0))] == [1] * 4
        assert shown.colour(x + 5, y + 5) == -1
        label, digit = shown.surface.texts[2 * number : 2 * number + 2]
        assert label[:3] == (x + 16, y + 40, "pixel")
        assert digit[:3] == (x + 64, y + 40, str(number + 1))
        assert shown.lines[45 - (y + 40) // 9][(x + 64) // 8] == str(number + 1)


@pytest.mark.covers("cpl.GMD", *(f"cpl.GMD.type.{n}" for n in range(5)))
def test_line_types_draw_erase_and_toggle(tmp_path: Path) -> None:
    shown = Shown(
        "1 LIN(10,10,90,10) : LIN(10,20,90,20) : LIN(10,30,50,30)\n2 GMD(1) : LIN(30,10,60,10)\n"
        "3 GMD(2) : LIN(10,20,90,20) : LIN(10,30,90,30)\n4 GMD(3) : LIN(10,40,90,40)\n5 GMD(4) : LIN(10,50,90,50)\n"
        "6 GMD(0) : LIN(10,60,90,60)",
        tmp_path,
    )
    rows = {
        y: "".join("#" if shown.colour(x, y) == 1 else "." for x in range(10, 91)) for y in range(10, 61, 10)
    }
    assert rows[10] == "#" * 20 + "." * 31 + "#" * 30
    assert [shown.colour(x, 10) for x in (29, 30, 60, 61)] == [
        1,
        -1,
        -1,
        1,
    ]  # nothing is drawn there, not black
    assert rows[20] == "." * 81
    assert rows[30] == "." * 41 + "#" * 40
    assert rows[40] == ("########..#.." * 7)[:81]
    assert rows[50] == ("######...." * 9)[:81]
    assert rows[60] == "#" * 81


@pytest.mark.covers("cpl.ex.4756")
def test_the_grid_of_circles_of_the_manual_ends_by_key_or_size(tmp_path: Path) -> None:
    text = "10 M=2\n20 WHILE ((INKEY<>66) AND (M<150)) DO\n30 CIR(250,160,M) : M=M+1\n40 END\n50 #M=M"
    assert Shown(text, tmp_path).globals["#M"] == 150
    shown = Shown(text, tmp_path, "A", "x", "B")
    assert shown.globals["#M"] == 4
    assert [shown.colour(250 + r, 160) for r in (1, 2, 3, 4)] == [-1, 1, 1, -1]


# ---------------------------------------------------------------------- the manual's dialogs


@pytest.mark.covers("cpl.ex.4635")
def test_pressed_keys_are_shown_until_enter(tmp_path: Path) -> None:
    text = (
        '1 NEW%=0 : OLD%=0\n2 CLS\n3 DSP(10,10,"Press any key! ABORT WITH ENTER")\n4 WHILE NEW%<>13 DO\n5 NEW%=INKEY\n'
        '6 IF (OLD%<>NEW%) AND (NEW%>0) THEN\n7 DSP(12,10,"KEY NUMBER:###",NEW%) : OLD%=NEW%\n8 ENDIF\n9 END'
    )
    shown = Shown(text, tmp_path, "x", "SOFTKEY7", "ENTER")
    assert (shown[10], shown[12]) == (" " * 9 + "Press any key! ABORT WITH ENTER", " " * 9 + "KEY NUMBER: 13")
    assert Shown(text + "\n10 CLG", tmp_path, "x", "ENTER")[12] == ""


@pytest.mark.covers("cpl.ex.4752")
@pytest.mark.parametrize(("keys", "last"), [((), 301), (("A", "C", "B"), 13)])
def test_drawing_goes_on_until_a_key_is_pressed(tmp_path: Path, keys: tuple[str, ...], last: int) -> None:
    text = "10 M=10\n20 REPEAT\n30 KEY%=INKEY\n40 LIN(250,10,M,M)\n45 M=M+1\n50 UNTIL ((KEY%=66) OR (M>300))\n55 #M=M"
    shown = Shown(text, tmp_path, *keys)
    assert shown.globals["#M"] == last
    assert [shown.colour(at, at) for at in (10, last - 1, last + 1)] == [1, 1, -1]


@pytest.mark.covers("cpl.ex.4780")
def test_the_dialog_of_a_cycle_writes_its_call(tmp_path: Path) -> None:
    root = Root(tmp_path)
    result = root.run(
        '30 DLG\n40 PRN(8,4,"MAX.CUTTING WIDTH: ###.### MM",WI)\n50 PRN(10,4,"MAX. CUTTING DEPTH: ###.### MM",DP)\n'
        '60 INP(WI):INP(DP)\n70 ENDDLG\n80 PRN#(0,"Q900[",WI,",",DP,"]")',
        keys=(*"42.25", "ENTER", *"7.5", "ENTER"),
    )
    assert result.messages[-1].text == "MSG: Q900[  42.250,   7.500]"


@pytest.mark.covers("cpl.ex.4822", "cpl.key.LEVEL_RETURN")
@pytest.mark.parametrize(
    ("keys", "end", "bars"),
    [(("SOFTKEY2",), 40, 1), (("SOFTKEY4",), 30, 1), (("LEVEL_RETURN", "SOFTKEY1", "SOFTKEY4"), 30, 3)],
)
def test_softkeys_branch(tmp_path: Path, keys: tuple[str, ...], end: int, bars: int) -> None:
    shown = Shown(
        '1 .SOFTKEY1\n10 .SOFTKEY2\n11 KEY%=0\n12 B%=0 : IF #N%=NUL THEN #N%=0 ENDIF:\n#N%=#N%+1\n'
        '13 SFK(KEY%,,"ABORT",,"ACTION",,,,)\n14 IF KEY%=2 THEN GOTO .END ENDIF\n'
        "15 IF KEY%=4 THEN GOTO .ACTION ENDIF\n16 IF KEY%=0 THEN GOTO .SOFTKEY1 ELSE GOTO .SOFTKEY2 ENDIF\n"
        "30 .ACTION\n31 #E%=30\n32 GOTO .OUT\n40 .END\n41 #E%=40\n50 .OUT",
        tmp_path, *keys,
    )  # fmt: skip
    assert (shown.globals["#E%"], shown.globals["#N%"]) == (end, bars)


@pytest.mark.covers("cpl.ex.4942")
def test_the_manual_s_choices_of_colours(tmp_path: Path) -> None:
    shown = Shown(
        '5 DSP(9,9,"GONE")\n10 COL(,,,7)\n20 DSP(8,9,"GONE")\n30 COL(,,,10)\n50 COL(,,,,1,4)\n70 COL(4)\n'
        '90 COL(,6,5)\n95 DSP(7,9,"T") : LIN(3,3,8,3)',
        tmp_path,
    )
    assert (shown[8], shown[9], shown.surface.table) == ("", "", 3)
    assert shown.surface.softkey_colours == (1, 4)
    assert (shown.colour(5, 3), shown.surface.cells[7, 9]) == (4, ("T", 6, 5))


# ---------------------------------------------------------------------- bitmaps


def _bmp(rows: list[list[tuple[int, int, int]]]) -> bytes:
    """Return a file of 24 bits a pixel; `rows` from the top, red green blue."""
    lines = b"".join(
        b"".join(bytes(pixel[::-1]) for pixel in row).ljust((len(row) * 3 + 3) // 4 * 4, b"\0")
        for row in rows[::-1]
    )
    head = struct.pack("<2sIIIIiiHHIIiiII", b"BM", 54 + len(lines), 0, 54, 40, len(rows[0]), len(rows), 1, 24, 0, 0,
                       0, 0, 0, 0)  # fmt: skip
    return head + lines


RED, GREEN, YELLOW = (255, 0, 0), (0, 255, 0), (250, 255, 9)


@pytest.mark.covers("cpl.BMP", *(f"cpl.BMP.copy.{n}" for n in range(9)), "cpl.graphics.functions")
@pytest.mark.parametrize(
    ("copy", "first", "second"),
    # on what is drawn in cyan (6) and where nothing is: red, green above; yellow (3) below
    [("", (1, 2), 3), (",0", (1, 2), 3), (",1", (7, 7), 7), (",2", (0, 0), 0), (",3", (7, 6), 3), (",4", (0, 2), 0),
     (",5", (7, 4), 3), (",6", (1, 0), 3), (",7", (6, 5), 4), (",8", (0, 1), 4)],
)  # fmt: skip
def test_bitmaps_are_copied_and_linked(
    tmp_path: Path, copy: str, first: tuple[int, int], second: int
) -> None:
    (tmp_path / "cplbmp").mkdir()
    (tmp_path / "cplbmp/mark.bmp").write_bytes(_bmp([[RED, GREEN], [YELLOW, YELLOW]]))
    shown = Shown(f'1 COL(6) : LIN(20,50,30,50)\n2 BMP(22,50,"mark"{copy})', tmp_path)
    assert (shown.colour(22, 50), shown.colour(23, 50)) == first
    assert (shown.colour(22, 49), shown.colour(23, 49)) == (second, second)
    assert (shown.colour(21, 50), shown.colour(24, 50), shown.colour(24, 49), shown.colour(22, 48)) == (
        6,
        6,
        -1,
        -1,
    )


@pytest.mark.covers("cpl.err.BMP_NOT_EXISTING")
def test_a_bitmap_that_is_not_there_is_told_and_the_program_goes_on(tmp_path: Path) -> None:
    (tmp_path / "secret.bmp").write_bytes(_bmp([[RED]]))
    (tmp_path / "cplbmp").mkdir()
    (tmp_path / "cplbmp/bad.bmp").write_bytes(b"BM")
    root = Root(tmp_path)
    said = root.said('1 BMP(0,0,"none")\n2 BMP(0,0,"../secret")\n3 BMP(0,0,"bad")\n4 PRN#(0,"on")')
    assert said == [
        "cplbmp\\none.bmp is not existing", "cplbmp\\../secret.bmp is not existing", "cplbmp\\bad.bmp is not existing",
        "on",
    ]  # fmt: skip
    assert root.error('1 BMP(0,375,"mark")') == "1: INVALID PARAMETER"
    assert root.error('1 BMP(0,0,"mark",9)') == "1: INVALID PARAMETER"
    assert root.error(f'1 BMP(0,0,"{"m" * 71}")') == "1: INVALID FILE NAME"


# ---------------------------------------------------------------------- files


def test_the_screen_is_written_as_text_and_as_drawing(tmp_path: Path) -> None:
    root = Root(tmp_path)
    program = '1 DSP(2,3,"A<B & ",2.5) : LIN(0,0,632,374)\n2 COL(,,5) : DSP(3,1," ")'
    root.run(program, screen="screen.txt")
    lines = root.read("screen.txt").decode().split("\n")
    assert ([len(line) for line in lines], lines[1].rstrip()) == ([79] * 46 + [0], "  A<B &    2.500")
    root.run(program, screen="screen.svg")
    drawing = root.read("screen.svg").decode()
    assert drawing.startswith("<svg ")
    assert "&lt;</text>" in drawing
    assert "M0 374h" in drawing
    assert 'y="18" width="8" height="9" fill="#ff00ff"' in drawing
    pyplot = pytest.importorskip("matplotlib.pyplot")
    root.run('1 COL(,,5) : DSP(3,11," ")', screen="screen.png")
    assert root.read("screen.png").startswith(b"\x89PNG")
    image = pyplot.imread(tmp_path / "screen.png")
    rows, columns = np.nonzero(np.all(np.abs(image[:, :, :3] - [1.0, 0.0, 1.0]) < 0.1, axis=2))
    # The third line from above, the eleventh column; cells are 8 wide and 9 high.
    assert (rows.min(), columns.min()) == pytest.approx((18, 80), abs=2)
    assert (rows.max(), columns.max()) == pytest.approx((26, 87), abs=2)


@pytest.mark.parametrize(
    ("program", "screen", "what"),
    [
        ("N10 X5\n", "shown.txt", "main.npg has no screen"),
        ("10 A=5\n", "shown.gif", "'.gif' is none of its formats"),
        ("10 A=5\n", "none/shown.txt", "there is no folder"),
    ],
)
def test_a_screen_that_cannot_be_kept_is_refused_before_the_run(
    tmp_path: Path, program: str, screen: str, what: str
) -> None:
    with pytest.raises(UsageError, match=what):
        Root(tmp_path).run(program + '20 OPENW(1,"P1")\n' * ("A=" in program), screen=screen)
    assert list(tmp_path.iterdir()) == []


def test_a_key_that_is_none_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="there is no key 'RETURN'"):
        Root(tmp_path).run("10 A=INKEY\n", keys=("RETURN",))
    with pytest.raises(UsageError, match="no keys can be read"):
        read_keys(tmp_path / "none")


def test_keys_come_from_a_file(tmp_path: Path) -> None:
    (tmp_path / "keys").write_text("SOFTKEY2\nA\n \n\nENTER\n")
    assert read_keys(tmp_path / "keys") == ("SOFTKEY2", "A", " ", "ENTER")
    result = Root(tmp_path).run('1 SFK(#K%,"A","B")\n2 #L%=INKEY', keys=("SOFTKEY2", "A"))
    assert (result.variables["#K%"], result.variables["#L%"]) == (2, 65)
