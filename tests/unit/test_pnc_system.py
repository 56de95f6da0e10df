"""What programs read of their control while it runs, written by them into a file (Manual 003, 4.2 to 4.14)."""

from __future__ import annotations

from pathlib import Path

import pytest

from polycnc.nc import ProgramText
from polycnc.runner import RunResult, run

MACHINE = """name = "cell"
[[axis]]
name = "X"
vmax_mm_s = 500
amax_mm_s2 = 5000
soft_limits_mm = [-350.5, 812.25]
[[axis]]
name = "Y"
vmax_mm_s = 450
amax_mm_s2 = 5000
[[axis]]
name = "Z"
vmax_mm_s = 333
amax_mm_s2 = 4000
[[axis]]
name = "B"
kind = "rotary"
vmax_deg_s = 100
amax_deg_s2 = 400
[tools.3]
length_mm = 42.5
radius_mm = 6.25
[offsets]
G154 = { X = 2.5 }
"""


class Cell:
    """A control with axes X, Y, Z and B; `report` runs a program and returns what it has put into the file R."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.machine = folder / "cell.toml"
        self.machine.write_text(MACHINE)
        self.last: RunResult

    def run(self, program: str, *, check: bool = True) -> RunResult:
        text = ProgramText.from_text(program, str(self.folder / "main.npg"))
        self.last = run(text, self.machine, "bosch", root=self.folder, check=check)
        return self.last

    def report(self, program: str) -> list[str]:
        self.run(f'1 OPENW(1,"R",5000) : REWRITE(1) : LJUST\n{program}\n')
        return (self.folder / "R").read_text("latin-1").partition("\x03")[0].splitlines()

    def values(self, before: str, *expressions: str) -> list[float]:
        """Return the values of expressions after some blocks."""
        printed = "\n".join(
            f'{900 + place} DUMMY{place}!={each} : PRN#(1,"######.######",DUMMY{place}!)'
            for place, each in enumerate(expressions)
        )
        return [float(each) for each in self.report(f"{before}\n{printed}")]

    def error(self, program: str) -> str:
        alarms = self.run(program, check=False).alarms
        assert alarms, "the program ran to its end"
        return f"{alarms[0].line}: {alarms[0].text}"


@pytest.fixture
def cell(tmp_path: Path) -> Cell:
    return Cell(tmp_path)


# ---------------------------------------------------------------------- coordinate systems and shifts


@pytest.mark.covers("cpl.nc.G168_G268", "cpl.cs.PCS", "cpl.cs.WCS", "cpl.units.pos")
def test_shifts_of_the_program_lie_between_program_and_workpiece_coordinates(cell: Cell) -> None:
    found = cell.values(
        "N1 G168 X10 Y5\nN2 G268 X1.5\nN3 G1 X2 Y-7 F1000\n20 WAIT",
        "CPOS(1)", "WPOS(1)", "MPOS(1)", "MPOS(2)", "SDR(68,1,1)", "SDR(168,2,2)", "SDR(268,1,1)", "SD(68,2,1)",
    )  # fmt: skip
    assert found == [2, 13.5, 13.5, -2, 11.5, 5, 1.5, 12]
    assert cell.values("N1 G168 X10\nN2 G268 X4\nN3 G269\nN4 G1 X1 F900\n5 WAIT", "MPOS(1)") == [11]
    assert cell.values("N1 G168 X10\nN2 G268 X4\nN3 G169\nN4 G1 X1 F900\n5 WAIT", "MPOS(1)") == [1]
    # G92 lies nearest to the program: where X shows 5 it shows -3 from then on.
    found = cell.values(
        "N1 G168 X10\nN2 G1 X5 F900\nN3 G92 X-3\nN4 G1 X4\n5 WAIT", "AXO(1)", "CPOS(1)", "WPOS(1)"
    )
    assert found == [8, 4, 22]


@pytest.mark.covers("cpl.nc.G60_G67")
def test_a_contour_shift_moves_the_contour_until_it_is_off(cell: Cell) -> None:
    found = cell.values(
        "N1 G60 X3 Y-2.5\nN2 G1 X10 Y10 F1000\n3 WAIT", "MPOS(1)", "MPOS(2)", "COF(1)", 'COF("Y")'
    )
    assert found == [13, 7.5, 3, -2.5]
    found = cell.values("N1 G60 X3\nN2 G67\nN3 G1 X10 F900\n4 WAIT", "MPOS(1)", "COF(1)", "SD(1,20,2)")
    assert found == [10, 0, 67]


@pytest.mark.covers("cpl.SCL")
@pytest.mark.covers("cpl.nc.G37_G38")
def test_contours_are_scaled_turned_and_mirrored_about_the_pole(cell: Cell) -> None:
    found = cell.values(
        "N1 G37 X1 Y2\nN2 G38 X2 Y-1.5 R90\nN3 G1 X4 Y4 F1000\n4 WAIT",
        "MPOS(1)", "MPOS(2)", "SCL(0)", "SCL(1,2)", "SCL(2,1)", "SCL(2,2)", "CPOS(1)", "CPOS(2)",
    )  # fmt: skip
    assert found == pytest.approx([1 + 3, 2 + 6, 90, 2, 2, -1.5, 4, 4])
    assert cell.values("N1 G38 X2\nN2 G39\nN3 G1 X4 F900\n4 WAIT", "MPOS(1)", "SCL(2,1)") == [4, 1]


@pytest.mark.covers("cpl.DPC")
@pytest.mark.covers("cpl.nc.G138", "cpl.cs.BCS", "cpl.cs.ACS", "cpl.cs.MCS")
def test_a_turned_workpiece_lies_behind_the_workpiece_coordinates(cell: Cell) -> None:
    found = cell.values(
        "N1 G154\nN2 G138 X7 Y1 R90\nN3 G168 X10\nN4 G1 X2 Y3 F1000\n5 WAIT",
        "CPOS(1)", "WPOS(1)", "WPOS(2)", "MPOS(1)", "MPOS(2)", "DPC(1)", 'DPC("Y")', "DPC(0)",
    )  # fmt: skip
    # workpiece (12, 3), turned by 90 degrees (-3, 12), put at (7, 1), zero shift 2.5 in X
    assert found == pytest.approx([2, 12, 3, -3 + 7 + 2.5, 12 + 1, 7, 1, 90])
    assert cell.values("N1 G138 X7 R30\nN2 G139\nN3 G1 X4 F900\n4 WAIT", "MPOS(1)", "DPC(0)", "DPC(1)") == [
        4,
        0,
        0,
    ]


@pytest.mark.covers("cpl.nc.G92", "cpl.AXO")
def test_g92_shifts_the_program_and_axo_tells_by_how_much(cell: Cell) -> None:
    found = cell.values(
        "N10 G1 G90 X100 Y200 F1000\nN20 G92 X75 Y125", 'AXO("X")', "AXO(2,0)", "AXO(3)", "CPOS(1)", "CPOS(2)"
    )
    assert found == [25, 75, 0, 75, 125]


@pytest.mark.covers("cpl.nc.G70_G71", "cpl.units.pos")
def test_units_are_those_of_the_channel_angles_stay_degrees(cell: Cell) -> None:
    found = cell.values(
        "N1 G1 X50.8 B30 F1000\nN2 G60 X25.4\nN3 G70\n4 WAIT",
        "CPOS(1)",
        'CPOS("B")',
        "MPOS(1)",
        "MPOS(4)",
        "COF(1)",
    )
    assert found == pytest.approx([1, 30, 2, 30, 1])


# ---------------------------------------------------------------------- tables act on motion


@pytest.mark.covers("cpl.nc.G54_G59_G154_G254_FXC", "cpl.zs.overview")
def test_a_shift_that_a_program_sets_moves_the_axes_from_the_next_block_on(cell: Cell) -> None:
    blocks = 'N1 G55\nN2 G1 X10 F900\n3 WAIT\n4 A=MPOS(1)\n5 FXC("X",55,1)=4.25\nN6 G1 X10\n7 WAIT'
    found = cell.values(blocks, "A", "MPOS(1)", "WPOS(1)", 'FXC("X")')
    assert found == [10, 14.25, 10, 4.25]
    # the next run on the same root sees it, a plain program too
    assert cell.run("N1 G55\nN2 G1 X1 F900\nN3 M30\n").end_position_mm["X"] == 5.25
    assert cell.run("N1 G54\nN2 G1 X1 F900\nN3 M30\n").end_position_mm["X"] == 1


def test_the_groups_add_up_and_tables_are_selected(cell: Cell) -> None:
    blocks = (
        'N1 G154\n2 FXC("X",54,1)=10 : FXC("X",254,1)=0.25 : FXC("X",54,2)=20\nN3 G54 G0\nN4 G254\n'
        "N5 G1 X1 F900\n6 WAIT\n7 A=MPOS(1)\nN8 G22 V2\nN9 G1 X1\n10 WAIT"
    )
    assert cell.values(blocks, "A", "MPOS(1)", 'FXC("X")') == [13.75, 21, 20]
    assert "there is no table V7" in cell.error("N1 G22 V7\n1 A=1")


@pytest.mark.covers("cpl.nc.G160_G260_G360", "cpl.nc.G53_G59_G153_G159_G253_G259")
def test_external_shifts_hold_while_they_are_on(cell: Cell) -> None:
    blocks = (
        '1 FXC("X",160,0)=40 : FXC("X",360,0)=0.5 : FXC("X",54,1)=3\nN2 G54\nN3 G160\nN4 G360\nN5 G1 X1 F900\n'
        '6 WAIT\n7 A=MPOS(1) : B=FXC("X") : C%=SD(1,30,1)\nN8 G167\nN9 G53\nN10 G1 X1\n11 WAIT'
    )
    assert cell.values(blocks, "A", "B", "C%", "MPOS(1)", 'FXC("X")', "SD(1,30,1)", "SD(1,17,1)") == [
        44.5, 43.5, 160, 1, 0, 167, 53,
    ]  # fmt: skip


@pytest.mark.covers("cpl.nc.G53_G59_G153_G159_G253_G259")
def test_each_group_of_zero_shifts_is_switched_off_by_itself(cell: Cell) -> None:
    shifts = '1 FXC("X",59,1)=10 : FXC("X",159,1)=20 : FXC("X",259,1)=40\nN2 G59 G0\nN3 G159\nN4 G259\n'
    for off, left in (("", 70), ("G53", 60), ("G153", 50), ("G253", 30)):
        assert cell.values(f"{shifts}N5 {off}\nN6 G1 X1 F900\n7 WAIT", "MPOS(1)") == [left + 1]


@pytest.mark.covers("cpl.nc.G145_G845", "cpl.nc.G147_G847")
def test_tool_compensations_add_up(cell: Cell) -> None:
    blocks = (
        "1 TC(1,745,0)=1.5 : TC(1,347,0)=0.25 : TC(3,347,0)=7 : TC(4,347,0)=-2\nN2 H3\nN3 G745\nN4 G347\n"
        "N5 G1 X10 Y20 Z5 F900\n6 WAIT\n7 A=MPOS(1) : B=MPOS(2) : C=MPOS(3) : D=TC(1) : E=SD(1,28,1)\n"
        "N8 H0\nN9 G146\nN10 G148\nN11 G1 X10 Y20 Z5\n12 WAIT"
    )
    assert cell.values(blocks, "A", "B", "C", "D", "E", "MPOS(1)", "MPOS(2)", "MPOS(3)", "TC(1)", "SD(1,28,1)") == [
        17, 18, 5 + 42.5 + 1.75, 42.5 + 1.75, 745, 10, 20, 5, 0, 146,
    ]  # fmt: skip


def test_what_a_program_sets_in_the_tool_table_is_the_length_of_the_next_h(cell: Cell) -> None:
    found = cell.values("1 TC(1,9,4)=31.25\nN2 H9\nN3 G1 Z1 F900\n4 WAIT", "MPOS(3)", "TC(1)")
    assert found == [32.25, 31.25]
    assert cell.run("N1 H9\nN2 G1 Z1 F900\nN3 M30\n").end_position_mm["Z"] == 32.25
    assert cell.values("1 TC(1,9,5)=2\nN2 G22 K5\nN3 H9", "TC(1)") == [2]


@pytest.mark.covers("cpl.param.9020_00010", "cpl.param.3080_00200")
def test_tables_with_a_name_are_files_in_the_root(cell: Cell) -> None:
    cell.report(
        '10 DIM N$(30) : N$="/usr/user/NPV_TAB.npv"\n11 IF FILEACCESS(N$)=-1 THEN\n12 FXCR(1,N$)\n13 ENDIF\n'
        '14 FXDEL(N$,2)\n15 FXINS(N$,2,"U",0)\n16 FXC("U",254,N$)=33.5 : FXC(-1,54,N$)=2 : FXC("X",54,N$,2)=1'
    )
    lines = (cell.folder / "usr/user/NPV_TAB.npv").read_text("latin-1").splitlines()
    assert lines[:3] == ["ZERO SHIFT TABLE MM", "AXES X U:ROTARY Z B:ROTARY", "G54 25.4 0.0 0.0 0.0"]
    assert lines[-1] == "\x03"
    assert cell.values("", 'FXC("X",54,"/usr/user/NPV_TAB.npv",2)', 'FXC(2,254,"/usr/user/NPV_TAB.npv")') == [
        1,
        33.5,
    ]
    (cell.folder / "macoda.dat").write_text("9020 00010 = 2\n")
    cell.report('10 FXCR(1,"I.npv")')
    assert (cell.folder / "I.npv").read_text().startswith("ZERO SHIFT TABLE INCH\n")
    (cell.folder / "I.npv").write_text("ZERO SHIFT TABLE MM\nAXES X\nG54 nan\n")
    assert cell.error('1 A=FXC("X",54,"I.npv")') == "1: inconsistent data"
    assert cell.error('1 A=FXC("X",54,"../I.npv")') == "1: INVALID FILE NAME"
    (cell.folder / "GK33").write_text("TOOL COMPENSATION TABLE INCH\n39 1.5 0.25\n")
    assert cell.values("", 'TC(2,39,"GK33")', 'TC(1,39,"GK33",0)') == [0.25, pytest.approx(38.1)]


@pytest.mark.covers("cpl.TDA")
def test_tables_and_tool_data_are_permanent(cell: Cell) -> None:
    cell.report(
        '1 TC(2,40,5)=1.25 : FXC(2,59,3)=-4 : FXC("Y",260,0)=6 : TDA(2,3,8)="MILL" : TDA(2,3,9)=312000'
    )
    found = cell.report(
        '1 DIM N$(31) : N$=TDA(2,3,8)\n2 PRN#(1,TC(2,40,5)," ",FXC(2,59,3)," ",FXC("Y",260,0)," ",N$)'
    )
    assert [found[0].split(), found[0].split()[-1]] == [["1.25", "-4", "6", "MILL"], "MILL"]
    assert cell.values("", "TDA(2,3,9)") == [312000]


def test_the_machine_file_counts_where_nothing_was_set(cell: Cell) -> None:
    cell.report('1 FXC("X",55,2)=1')
    cell.machine.write_text(MACHINE.replace("X = 2.5", "X = 3.5").replace("42.5", "43.5"))
    assert cell.values("", 'FXC("X",154,1)', "TC(1,3,4)") == [3.5, 43.5]


# ---------------------------------------------------------------------- SD, SDR, NCF


@pytest.mark.covers("cpl.ex.2298", "cpl.nc.G63")
def test_active_functions_feeds_and_positions_are_read(cell: Cell) -> None:
    blocks = "N1 G1 G91 X5 F613.5\n2 WAIT\n3 A%=SD(1,2,1) : B%=SD(1,4,1) : C%=SD(2,1) : D%=SD(5,1,1)\nN4 G2 X3 R9\n"
    assert cell.values(blocks, "A%", "B%", "C%", "D%", "SD(1,2,2)", "SD(5,1,2)") == [1, 91, 100, 614, 2, 614]
    blocks = "N1 G18\nN2 G63\nN3 G41 D3 G1 X9 F80\nN4 G40 G1 X20"
    assert cell.values(blocks, "SD(1,10,2)", "SD(1,5,2)", "SD(1,8,2)", "SD(11,1,1)", "SD(11,2,1)") == [
        18,
        63,
        40,
        3,
        1,
    ]


@pytest.mark.covers(
    *(f"cpl.SD.{row}" for row in (
        "5.1.1", "5.1.2", "5.3.1", "5.3.2", "5.3.3", "11.1.1", "11.1.2", "11.2.1", "11.2.2", "12.1", "12.2", "12.3",
        "12.val.-1", "12.val.3", "12.val.4", "14", "68.1.n", "68.2.n", "168.1.n", "168.2.n", "268.1.n", "268.2.n",
        "202.s", "205.1.s", "205.2.s", "205.3.s", "212.1.s", "212.2.s",
    )),
    *(f"cpl.SDR.{row}" for row in ("68.1.n", "68.2.n", "168.1.n", "168.2.n", "268.1.n", "268.2.n", "202.s")),
    "cpl.ex.2298",
)  # fmt: skip
@pytest.mark.covers("cpl.SD", "cpl.SDR")
def test_what_is_programmed_and_what_is_active_are_told_apart(cell: Cell) -> None:
    (cell.folder / "macoda.dat").write_text("6010 00010 = 33\n")
    blocks = (
        "N1 G18\nN2 M4 S600\nN3 G168 X1.5 Y2\nN4 G268 Y0.25\nN5 G1 X5 F300\n6 WAIT\n"
        "N7 G17\nN8 G168 X7.25\nN9 G268 Y4.5\nN10 M3 S700\nN11 G1 X300 F900"
    )
    wanted = {
        "SD(5,1,1)": 300, "SD(5,1,2)": 900, "SD(5,3,1)": 600, "SD(5,3,2)": 700, "SD(5,3,3)": 600, "SD(11,1,1)": 1,
        "SD(11,2,1)": 2, "SD(11,1,2)": 3, "SD(11,2,2)": 1, "SD(12,1)": 4, "SD(12,2)": 3, "SD(12,3)": -1, "SD(14)": 33,
        "SDR(168,1,1)": 7.25, "SDR(168,2,1)": 1.5, "SDR(268,1,2)": 4.5, "SDR(268,2,2)": 0.25, "SDR(68,2,2)": 2.25,
        "SDR(68,1,1)": 7.25, "SD(168,1,1)": 7, "SD(168,2,2)": 2, "SD(268,1,2)": 5, "SD(268,2,2)": 0, "SD(68,1,1)": 7,
        "SD(68,2,1)": 2, "SD(202,1)": 100, "SDR(202,2)": 0, "SD(205,1,1)": 600, "SD(205,2,1)": 700,
        "SD(205,3,1)": 600, "SD(212,1,1)": 4, "SD(212,2,1)": 3, "SD(212,2,2)": -1,
    }  # fmt: skip
    assert dict(zip(wanted, cell.values(blocks, *wanted), strict=True)) == wanted


GROUPS = {
    3: ("G70", "G71"), 4: ("G91", "G90"), 5: ("G63", "G66"), 7: ("G95", "G94"), 8: ("G42 D3 G1 X50 F500", "G40"),
    9: ("G7", "G6"), 10: ("G18", "G19"), 11: ("G9", "G8"), 13: ("G15", "G14"), 17: ("G59", "G53"),
    18: ("G157", "G153"), 19: ("G258", "G253"), 20: ("G60 X1", "G67"), 21: ("G38 X2", "G39"), 22: ("G61", "G62"),
    25: ("G65", "G64"), 26: ("G68", "G69"), 28: ("G645", "G146"), 29: ("G114", "G115"), 30: ("G160", "G167"),
}  # fmt: skip


@pytest.mark.covers(*(f"cpl.SD.group.{group}" for group in GROUPS), "cpl.SD.1.i.1", "cpl.SD.1.i.2")
@pytest.mark.covers("cpl.SD")
def test_g_functions_of_each_group_are_told_while_they_hold(cell: Cell) -> None:
    lines, wanted = ["1 WAIT", "N1 M3 S100"], []
    for group, words in GROUPS.items():
        for word in words:
            lines += [f"N5 {word}", f"N6 G1 Y{len(lines)} F1000", "7 WAIT"]
            lines += [f'8 A={ask} : PRN#(1,"###",A)' for ask in (f"SD(1,{group},1)", f"SD(1,{group},2)")]
            wanted += [int(word.split()[0][1:])] * 2
    assert [int(each) for each in cell.report("\n".join(lines))] == wanted


def test_what_holds_for_one_block_is_seen_in_the_next(cell: Cell) -> None:
    assert cell.values("N1 G4 F0.25\n2 A%=SD(1,1,2)\nN3 G1 X1 F100", "A%", "SD(1,1,2)") == [4, 0]


def test_the_block_that_is_executed_is_not_the_one_that_is_prepared(cell: Cell) -> None:
    blocks = "N1 G1 X400 F120\n2 WAIT(,1000)\nN3 G0 X500\n"
    assert cell.values("N1 G1 X1 F120\n2 WAIT\nN3 G0 X300\nN4 G2 Y3 R200", "SD(1,2,1)", "SD(1,2,2)") == [1, 2]
    assert cell.values(blocks, "SD(1,2,1)") == [1]


@pytest.mark.covers("cpl.NCF")
@pytest.mark.covers("cpl.ex.2108")
def test_a_function_is_programmed_again_by_its_name(cell: Cell) -> None:
    lines = cell.report(
        '10 DIM A$(4) : DIM B$(4)\nN15 G2 X10 Y0 R5 F500\n20 A$=NCF("G1") : PRN#(1,A$)\nN40 G1 Y0\n'
        '41 B$=NCF("G2") : PRN#(1,B$)\nN80 [A$] X20 Y0 R5\n'
        '81 A$=NCF("G0") : PRN#(1,A$)\n82 A$=NCF("M3") : PRN#(1,A$)\n83 A$=NCF("G153") : PRN#(1,A$)\nN84 M4 S50\n'
        '85 A$=NCF("M3") : PRN#(1,A$)'
    )
    assert lines == ["G2", "G1", "G2", "M5", "G153", "M4"]
    assert cell.last.path_mm == pytest.approx(2 * 15.70796, abs=1e-4)
    assert cell.error('1 DIM A$(4)\n2 A$=NCF("G999")') == "2: INVALID PARAMETER"


@pytest.mark.covers("cpl.err.SDR_AXIS")
def test_search_positions_are_of_axes_that_machine(cell: Cell) -> None:
    assert cell.values("N1 G1 X5 F100", "SDR(1,4)") == [0]
    assert cell.error("1 A=SDR(1,5)") == "1: INVALID PARAMETER"


# ---------------------------------------------------------------------- AXP


@pytest.mark.covers("cpl.CPOS")
@pytest.mark.covers("cpl.AXP", "cpl.ex.2367", "cpl.axistype.0", "cpl.axistype.1")
def test_axes_are_addressed_by_their_index(cell: Cell) -> None:
    (cell.folder / "P2367").write_text(
        "10 A%=P1% : B%=P2%\n20 C=P3:D=P4:RA=P5\n30 E=0\nN40G20 [AXP(A%,E)] [AXP(B%,E)]\n"
        "N50 G2 [AXP(A%,C)] [AXP(B%,D)] R[RA] F1000\n"
    )
    result = cell.run("10 CALL P2367[3,1,8,4,10]\n")
    assert (result.end_position_mm["Z"], result.end_position_mm["X"]) == (8, 4)
    assert cell.values("N1 G20 X0 Y0\n", "SD(11,1,1)", "SD(11,2,1)", "SD(1,10,2)") == [1, 2, 20]
    assert cell.values("N1 G20 Y0 X0\nN2 G2 X5 Y5 R5 F500", "SD(11,1,1)", "SD(11,2,1)", "CPOS(2)") == [
        2,
        1,
        5,
    ]
    assert cell.values("N1 G1 [AXP(2,7.5,0)] [AXP(4,30,1)] F500\n2 WAIT", "MPOS(2)", "MPOS(4)") == [7.5, 30]
    assert cell.error("N1 G1 [AXP(5,1)] F500\n1 A=1") == "1: INVALID PARAMETER"
    assert cell.error("N1 G1 [AXP(1,1,2)] F500\n1 A=1") == "1: INVALID PARAMETER"


def test_a_reversed_plane_turns_the_other_way(cell: Cell) -> None:
    def top(program: str) -> tuple[float, float]:
        extent = cell.run(program).extents_mm["Y"]
        return round(extent[0], 6), round(extent[1], 6)

    assert top("N1 G17\nN2 G2 X10 Y0 R5 F900\n1 A=1") == (0, 5)
    assert top("N1 G20 Y0 X0\nN2 G2 X10 Y0 R5 F900\n1 A=1") == (-5, 0)


# ---------------------------------------------------------------------- SCS, SCSL


@pytest.mark.covers("cpl.SCS", "cpl.ex.2154", "cpl.SCS.result.0", "cpl.SCS.idtype.S", "cpl.err.SCS_LIST")
def test_drives_tell_their_parameters(cell: Cell) -> None:
    blocks = 'N1 G1 X1.2345 Y-3 F900\n2 WAIT\n10 POSITION%=SCS(1,"S",51,ERROR%)\n11 Q%=SCS("Y","S",47)'
    assert cell.values(blocks, "POSITION%", "ERROR%", "Q%") == [12345, 0, -30000]
    assert cell.error('1 A=SCS(1,"S",17)') == "1: INVALID PARAMETER"
    assert cell.error('1 A=SCS(1,"S",17,E%)') == "1: INVALID PARAMETER"
    assert cell.error('1 A=SCS(1,"X",51)') == "1: INVALID PARAMETER"
    assert cell.error('1 A=SCS(5,"S",51)') == "1: INVALID PARAMETER"
    assert cell.error('1 A=SCS(1,"S",999)') == "1: INVALID PARAMETER"


@pytest.mark.covers("cpl.SCSL", "cpl.SCSL.result.0", "cpl.SCSL.result.2", "cpl.SCS.idtype.P", "cpl.SCS")
def test_lists_of_drives_go_into_a_file(cell: Cell) -> None:
    assert cell.values('10 SCSL(1,"S",187,"LIST",E%)', "E%") == [0]
    assert (cell.folder / "LIST").read_bytes() == b"40\n51\n\x03\n"
    (cell.folder / "DIR").mkdir()
    assert cell.values('10 SCSL(1,"S",187,"DIR",E%)', "E%") == [2]
    assert cell.error('1 SCSL(1,"S",187,"DIR")') == "1: FILE CANNOT BE WRITTEN"
    assert cell.error('1 SCSL(1,"P",187,"LIST",E%)') == "1: INVALID PARAMETER"


# ---------------------------------------------------------------------- machine parameters

PARAMETERS = {
    "1003 00001": (2, '"Z"'), "1003 00002": (2, "1"), "1003 00012": (3, "1"), "1015 00100": (1, "0"),
    "1020 00001": (0, "812.25"), "2060 00100": (0, "0"), "2060 00110": (0, "0"), "3080 00001": (0, '"/"'),
    "3080 00004": (0, '"/"'), "3080 00005": (0, "1"), "3080 00006": (0, '""'), "3080 00007": (0, '"cpldlg05.dlg"'),
    "3080 00200": (0, '".npv"'), "6001 00020": (0, "0"), "6010 00010": (0, "44"), "7010 00010": (3, '"B"'),
    "7010 00020": (1, '"Y"'), "7060 00010": (4, '"G71"'), "7060 00020": (0, '"G1"'), "7080 00010": (0, '""'),
    "9020 00010": (0, "0"), "9030 00002": (0, "0"), "5010 00001": (15, "0"), "5010 00002": (0, "0"),
}  # fmt: skip


@pytest.mark.covers(
    *(f"cpl.param.{number.replace(' ', '_')}" for number in PARAMETERS), "cpl.changed.MP_4017"
)
@pytest.mark.parametrize("number", PARAMETERS)
def test_machine_parameters_are_read_and_the_root_may_say_otherwise(cell: Cell, number: str) -> None:
    index, value = PARAMETERS[number]
    kind = "$" if value.startswith('"') else "!"
    program = f"2 DIM V$(40)\n3 V{kind}=MCA({number.replace(' ', '')},{index})\n4 PRN#(1,V{kind})"
    [shown] = cell.report(program)
    assert shown == value.strip('"') if kind == "$" else float(shown) == float(value)
    values = ",".join(['"OTHER"' if kind == "$" else "7"] * (index + 1))
    channel = "[1] " if number == "7010 00010" else ""
    (cell.folder / "macoda.dat").write_text(f"; of the maker\n{number} {channel}= {values}\n")
    [shown] = cell.report(program)
    assert shown == "OTHER" if kind == "$" else float(shown) == 7


@pytest.mark.covers("cpl.param.7060_00010", "cpl.param.7060_00020")
def test_the_power_up_condition_is_a_list_of_functions(cell: Cell) -> None:
    for number in (706000010, 706000020):
        read = "".join(f"{100 + k} V$=MCA({number},{k}) : PRN#(1,V$)\n" for k in range(7))
        assert cell.report(f"2 DIM V$(9)\n{read}") == ["G1", "G17", "G40", "G53", "G71", "G90", "G94"]


@pytest.mark.covers("cpl.MCA")
@pytest.mark.covers("cpl.ex.2077", "cpl.param.1001_00004")
def test_the_type_of_axis_movement_is_an_integer(cell: Cell) -> None:
    assert cell.values(
        "10 BLOCKNR%=100300004\n20 ERG%=MCA(BLOCKNR%,0) : B%=MCA(BLOCKNR%,3)", "ERG%", "B%"
    ) == [1, 2]
    assert cell.error("1 A%=MCA(100300001,0)") == "1: INVALID ASSIGNMENT"


def test_a_wrong_parameter_file_is_an_error_at_its_line(cell: Cell) -> None:
    (cell.folder / "macoda.dat").write_text("5010 00001 = 1\n\n5010 = 3\n")
    alarms = cell.run("1 A=1\n", check=False).alarms
    assert [(alarm.file, alarm.line) for alarm in alarms] == [("macoda.dat", 3)]


def test_parameters_say_which_data_modules_a_program_may_write(cell: Cell) -> None:
    assert cell.error("1 PLC(4,98,2,2)=5") == "1: INVALID PARAMETER"
    (cell.folder / "macoda.dat").write_text("2060 00100 = 98\n2060 00110 = 1\n")
    assert cell.values("1 PLC(4,98,2,2)=4711", "PLC(4,98,2,2)", "PLC(4,98,2,1)", "PLC(1,,10,1)") == [
        4711,
        103,
        0,
    ]
    assert cell.error("1 PLC(4,99,2,2)=5") == "1: INVALID PARAMETER"


@pytest.mark.covers(
    "cpl.SD.200.1", "cpl.SD.200.1.i", "cpl.SD.200.3.i",
)  # fmt: skip
@pytest.mark.covers("cpl.SD")
def test_a_control_without_areas_and_couplings_says_so(cell: Cell) -> None:
    areas = ["SD(200,1)", *(f"SD(200,{index},{area})" for index in (1, 3) for area in (1, 10))]
    couplings = [
        f"{name}(581,{slave},{index})" for name in ("SD", "SDR") for slave in (0, 1, 8) for index in (1, 2, 3)
    ]
    masters = [f"{name}(581,{slave},0)" for name in ("SD", "SDR") for slave in (1, 8)]
    assert set(cell.values("N1 G0 X2", *areas, *couplings, *masters)) == {0}
    for nothing in ("SD(200,1,11)", "SD(200,2,1)", "SD(581,9,0)", "SD(581,1,4)", "SDR(581,0,9)"):
        assert cell.error(f"10 A={nothing}") == "1: INVALID PARAMETER"


@pytest.mark.parametrize(
    "data", ["SD(131,1)", "SD(131,2)", "SDR(131,4)", "SD(328)", "SDR(328,2)", "SD(200,11,1)"]
)
def test_system_data_of_functions_that_no_program_can_program_are_0(cell: Cell, data: str) -> None:
    assert cell.values("N1 G0 X2", data) == [0]


# ---------------------------------------------------------------------- NCS coupling, MMC


@pytest.mark.covers("cpl.ex.2627")
def test_a_program_asks_its_own_control(cell: Cell) -> None:
    blocks = (
        "10 DIM BUF%(2)\n20 VERSION=0\nN25 G1 X12.5 Y3 F640\n26 WAIT\n30 ERR_VAR% = MCODS(32,1,VERSION,BUF%,2)\n"
        "40 DIM P!(4) : V2=0 : E%=MCODS(1,-1,V2,P!,4)\n50 ERR_VAR2% = MCOPS(6,9)\n60 E3%=MCOPS(6,1)\n"
        "70 V2=0 : E4%=MCODS(32,7,V2,BUF%,2) : E5%=MCODS(17,1,V2,BUF%,2)"
    )
    asked = "ERR_VAR%", "BUF%(1)", "BUF%(2)", "P!(1)", "P!(2)", "ERR_VAR2%", "E3%", "E4%", "E5%"
    assert cell.values(blocks, *asked) == [0, 3, 1, 12.5, 3, 1, 9, 1, 102]
    names = cell.report(
        "1 DIM A$(80) : V=0\n2 E%=MCODS(33,-1,V,A$,80) : DIM B$(2) : B$=MID$(A$,28,1) : PRN#(1,B$)"
    )
    assert names == ["B"]
    assert cell.values("1 A%=3 : E%=MMC(A%)", "E%") == [1]


def test_what_mcods_shows_is_what_the_program_does(cell: Cell) -> None:
    blocks = (
        '1 FXC("X",55,1)=4\nN2 G55\nN3 H3\nN4 S1500 M4\nN5 (MSG,TOOL 7 IS WORN)\nN6 G1 X10 Z1 F800\n7 WAIT\n'
        "8 DIM D!(4) : DIM R(12) : DIM I%(8) : DIM S$(80)\n10 V=0 : E%=MCODS(37,-1,V,D!,4) : A!=D!(1)\n"
        "20 V=0 : E%=MCODS(10,1,V,R,1) : B=R(1)\n30 V=0 : E%=MCODS(9,1,V,I%,1) : C%=I%(1)\n"
        "40 V=0 : E%=MCODS(24,1,V,R,1) : D=R(1)\n50 V=0 : E%=MCODS(5,-1,V,R,1) : F=R(1)\n"
        "60 V=0 : E%=MCODS(63,-1,V,I%,1) : G%=I%(1)\n70 V=0 : E%=MCODS(15,1,V,R,12) : H=R(1)\n"
        "80 V=0 : E%=MCODS(71,1,V,R,4) : J=R(1)\n90 V=0 : E%=MCODS(28,1,V,S$,80) : PRN#(1,S$)"
    )
    message, *rest = cell.report(
        blocks
        + "\n100 PRN#(1,A!) : PRN#(1,B) : PRN#(1,C%) : PRN#(1,D) : PRN#(1,F) : PRN#(1,G%) : PRN#(1,H) : PRN#(1,J)"
    )
    assert message == "TOOL 7 IS WORN"
    assert [float(each) for each in rest] == [10, 42.5, 3, 800, 1500, 3, 4, 10]


# ---------------------------------------------------------------------- functions of older controls

REMOVED = {
    "SD_1_3": "SD(1,2,3)", "SD_2_2": "SD(2,2)", "SD_3_tool": "SD(3,1)", "SD_3_zero": "SD(3,2)", "SD_6": "SD(6,1)",
    "SD_7": "SD(7,1)", "SD_16": "SD(16,1)", "SD_17": "SD(17,1)", "SD_23_old": "SD(23)", "SD_24_old": "SD(24)",
    "SD_30": "SD(30)", "SD_31": "SD(31)", "SD_32": "SD(32)", "SD_33": "SD(33)", "SD_34": "SD(34)", "SD_2_5": "SD(2,5)",
    "SD_5_5_1": "SD(5,5,1)", "SD_5_5_2": "SD(5,5,2)", "SD_101_104": "SD(103)", "SD_105": "SD(105)", "SD_110": "SD(110)",
    "SD_111": "SD(111)", "SD_140_142": "SD(141)", "SD_143_144": "SD(144)", "SD_145": "SD(145)", "SD_146": "SD(146)",
    "SD_147": "SD(147)", "SDR_4": "SDR(4)", "SDR_5": "SDR(5)", "SDR_12": "SDR(12)",
}  # fmt: skip


@pytest.mark.covers(*(f"cpl.removed.{name}" for name in REMOVED))
@pytest.mark.parametrize("name", REMOVED)
def test_data_that_only_older_controls_have_are_refused(cell: Cell, name: str) -> None:
    assert cell.error(f"10 A=1\n20 A={REMOVED[name]}") == "2: INVALID PARAMETER"


@pytest.mark.covers(
    "cpl.changed.SD_8",
    "cpl.changed.SD_14",
    "cpl.changed.SD_22",
    "cpl.removed.SD_20_old",
    "cpl.removed.SD_21_old",
)
def test_numbers_that_older_controls_used_otherwise(cell: Cell) -> None:
    assert cell.values("", "SD(8)", "SD(14)", "SD(22,4)", "SD(20)", "SD(21,1)") == [1, 44, 4, 4, 4]
    (cell.folder / "macoda.dat").write_text("6010 00010 = 33\n")
    assert cell.values("", "SD(14)") == [33]


# ---------------------------------------------------------------------- probe

PLATE = "[[surface]]\nhigh = { Z = -12.345 }\n[[surface]]\nlow = { X = 99.5 }\n"


@pytest.fixture
def measuring(cell: Cell) -> Cell:
    cell.machine.write_text(MACHINE + PLATE)
    return cell


@pytest.mark.covers("cpl.cs.WCS")
@pytest.mark.covers("cpl.ex.1451", "cpl.CPROBE", "cpl.param.1003_00012", "cpl.SD.9", "cpl.PROBE", "cpl.PPOS")
@pytest.mark.covers("cpl.SD")
def test_a_coordinate_is_measured(measuring: Cell) -> None:
    blocks = (
        "N5 G168 X10\nN6 G1 X20 Y1 F900\nN10 G75 X20 Y1 Z-50\n20 IF SD(9) = 1 THEN\n"
        "N30 (MSG, Measuring probe was not deflected!)\n40 GOTO .ERROR\n50 ELSE\n60 ZMEAS = CPROBE(3)\n70 ENDIF\n"
        "80 .ERROR"
    )
    found = measuring.values(blocks, "ZMEAS", "SD(9)", "CPROBE(1)", "PROBE(1)", "PPOS(1)", 'PROBE("Z")')
    assert found == pytest.approx([-12.345, 0, 20, 30, 20, -12.345], abs=1e-5)
    added = blocks.replace("N6", "N6 G268 X1.5\nN7")
    found = measuring.values(added, "ZMEAS", "SD(9)", "CPROBE(1)", "PROBE(1)", "PPOS(1)", 'PROBE("Z")')
    assert found == pytest.approx([-12.345, 0, 20, 31.5, 20, -12.345], abs=1e-5)
    assert not any("deflected" in message.text for message in measuring.last.messages)


@pytest.mark.covers("cpl.CPOS")
@pytest.mark.covers("cpl.ex.2307", "cpl.nc.MSG_text", "cpl.SD.9")
@pytest.mark.covers("cpl.SD")
def test_no_contact_is_told_and_no_position_is_given(measuring: Cell) -> None:
    blocks = (
        "N1 G1 X5 F9000\nN4 G75 X90\n60 IF SD(9) = 1 THEN\nN7 (MSG, PROBE WAS NOT DEFLECTED)\n80 GOTO .ERROR\n90 ELSE\n"
        "100 XMEAS = PPOS(1)\n110 ENDIF\n120 .ERROR"
    )
    assert measuring.values(blocks, "SD(9)", "CPOS(1)") == [1, 90]
    assert [message.text.strip() for message in measuring.last.messages] == ["MSG: PROBE WAS NOT DEFLECTED"]
    for call in ("PPOS(1)", "PROBE(1)", "CPROBE(1)"):
        assert measuring.error(f"N4 G75 X90 F9000\n1 A={call}") == "2: NO PROBE POSITION"
        assert measuring.error(f"N4 G1 X9 F9000\n1 A={call}") == "2: NO PROBE POSITION"


@pytest.mark.covers("cpl.PPOS", "cpl.PROBE")
def test_what_measured_values_consider(measuring: Cell) -> None:
    shifts = (
        '1 FXC("X",55,1)=4 : FXC("X",160,0)=1 : FXC("Z",55,1)=0.5\nN2 G55\nN3 G160\nN4 H3\nN5 G168 X10\nN6 G268 X2\n'
        "N7 G60 X0.75\nN8 G37 X1\nN9 G38 X1.5\nN11 G1 X3 Z1 F900\nN12 G75 X200"
    )
    machine, zero_shifts, program = 99.5, 4 + 1, 10 + 2
    workpiece = machine - zero_shifts
    coordinate = 1 + (workpiece - program - 0.75 - 1) / 1.5
    found = measuring.values(shifts, "PROBE(1)", "PPOS(1)", "CPROBE(1)", "PROBE(3)", "PPOS(3)")
    assert found == pytest.approx([machine, workpiece - program, coordinate, 44, 1], abs=1e-4)
    found = measuring.values("N1 G70\nN2 G1 X1 F90\nN3 G75 X5", "PROBE(1)", "PPOS(1)", "CPROBE(1)")
    assert found == pytest.approx([99.5 / 25.4] * 3, abs=1e-6)


@pytest.mark.covers("cpl.CPROBE", "cpl.PPOS", "cpl.SD.9", "cpl.PROBE", "cpl.nc.G275", "cpl.nc.G375")
@pytest.mark.covers("cpl.SD")
def test_one_axis_is_measured_in_passing_and_a_stop_is_reached(measuring: Cell) -> None:
    found = measuring.values("N1 G1 Y3 F900\nN2 G275 Z-20 F900", "SD(9)", "PROBE(3)", "PPOS(3)", "CPOS(3)")
    assert found == pytest.approx([0, -12.345, -12.345, -20], abs=1e-5)
    assert measuring.error("N2 G275 Z-20 F900\n1 A=CPROBE(3)") == "2: NO PROBE POSITION"
    assert measuring.error("N2 G275 Z-20 F900\n1 A=PPOS(1)") == "2: NO PROBE POSITION"
    found = measuring.values("N2 G375 Z-20 F900", "SD(9)", "PROBE(3)", "PPOS(3)", "CPOS(3)")
    assert found == pytest.approx([0, -12.345, -12.345, -12.345], abs=1e-5)
    assert measuring.values("N2 G375 Z-2 F900", "SD(9)", "CPOS(3)") == [1, -2]


@pytest.mark.parametrize("word", ["G131", "G192 S500", "G292 S50", "G328", "G352", "G354", "G510", "G511"])
def test_words_that_are_not_simulated_are_refused(cell: Cell, word: str) -> None:
    assert word.split()[0] in cell.error(f"1 A=1\nN10 {word}")


@pytest.mark.covers("cpl.SD.12.val.0", "cpl.SD.12.val.3", "cpl.SD.12.val.4")
@pytest.mark.covers("cpl.SD")
def test_the_sense_of_the_spindle_is_that_of_its_last_word(cell: Cell) -> None:
    found = cell.values(
        "N1 S700 M4\nN2 G1 X1 F900\n3 WAIT\n4 A%=SD(12,2)\nN5 M3\n6 B%=SD(12,2)\nN7 M5\n8 C%=SD(12,2)",
        "A%",
        "B%",
        "C%",
    )
    assert found == [4, 3, 0]
