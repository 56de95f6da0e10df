"""What body is cut, and with what tools: said in texts, remarks and files, or found from the course of the tool."""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import polycnc
from polycnc.errors import UsageError
from polycnc.stock import (
    Box,
    Course,
    Cutting,
    Form,
    Mesh,
    Rows,
    Stock,
    Tool,
    ToolKind,
    Turned,
    Voxels,
    read_stl,
    stock_of_remarks,
    tool_number,
    tool_of_remark,
)

TOOLS = {3: Tool(ToolKind.FLAT, 8.0)}


def circle(rows: int = 700, level: float = -2.5) -> Rows:
    angle = np.linspace(-1.5, 5.0, rows)
    tip = np.column_stack((31.0 + 11.0 * np.cos(angle), 17.0 + 11.0 * np.sin(angle), np.full(rows, level)))
    tip[:40, 2] = np.linspace(6.0, level, 40)
    tip[:40, :2] = tip[40, :2]
    rapid = np.zeros(rows, np.bool_)
    rapid[:20] = True
    whole = np.arange(rows) // 90
    return Rows(
        0.004 * np.arange(1.0, rows + 1.0), tip, whole, np.full(rows, 3), rapid, np.ones(rows, np.bool_)
    )


@given(at=st.lists(st.integers(1, 699), max_size=5))
def test_a_course_is_the_same_however_its_record_is_cut(at: list[int]) -> None:
    record = circle()
    whole, parts = Course(), Course()
    whole.add(record)
    bounds = [0, *sorted(at), 700]
    for first, last in pairwise(bounds):
        parts.add(record.at(np.arange(first, last)))
    for one, other in zip(whole.rows().columns(), parts.rows().columns(), strict=True):
        assert np.array_equal(one, other)
    assert 10 < len(whole.rows().t_s) < 350


def test_a_course_cuts_what_its_record_cuts() -> None:
    record, course = circle(), Course()
    course.add(record)
    volumes = []
    for rows in (record, course.rows()):
        cutting = Cutting(Stock(Box((0.0, 0.0, -10.0), (60.0, 40.0, 0.0)), 0.2), TOOLS)
        cutting.add(rows)
        volumes.append(cutting.removed_mm3)
    assert volumes[1] == pytest.approx(volumes[0], rel=1e-3)


def test_an_auto_body_holds_what_is_cut() -> None:
    stock = Form("auto").body(circle(), TOOLS)
    assert stock.box.low == pytest.approx((31.0 - 11.0 - 5.0, 1.0, -3.5), abs=0.01)
    assert stock.box.high == pytest.approx((31.0 + 11.0 + 5.0, 33.0, 0.0), abs=0.01)
    assert stock.cell_mm == 0.05
    above = Form("auto", 0.5).body(circle(level=4.0), TOOLS)
    assert above.box.high[2] == 4.0 + 1.0 or above.box.high[2] == 5.0
    assert above.cell_mm == 0.5


def test_forms_in_texts() -> None:
    box = Form("box=-3,-2,-12,57,38,1.5", 0.25).body(circle(), TOOLS)
    assert box.box == Box((-3.0, -2.0, -12.0), (57.0, 38.0, 1.5))
    cylinder = Form("cylinder=30,-8,2", 0.05).body(circle(), TOOLS)
    assert cylinder.volume_mm3 == pytest.approx(np.pi * 225.0 * 10.0, rel=2e-3)


def test_a_body_goes_to_a_file_and_comes_back(tmp_path: Path) -> None:
    stock = Stock(Box((-3.0, -2.0, -12.0), (57.0, 38.0, 1.5)), 0.25)
    Cutting(stock, TOOLS).add(circle())
    file = tmp_path / "first side.stl"
    stock.mesh().write_stl(file)
    back = Form(str(file), 0.25).body(circle(), TOOLS)
    assert back.volume_mm3 == pytest.approx(stock.volume_mm3, rel=2e-3)
    assert back.box.high == (57.0, 38.0, 1.5)


@pytest.mark.parametrize(
    ("text", "wrong"),
    [
        ("ball=3", "no stock"),
        ("box=1,2,3", "6 numbers"),
        ("box=1,2,3,4,5,nan", "6 numbers"),
        ("cylinder=a,1,2", "3 numbers"),
        ("", "no stock"),
        ("cylinder=-5,0,2", "no volume"),
        ("missing.stl", "cannot read"),
        ("box=0,0,0,1e308,1,1", "corner at"),
        ("cylinder=1e308,0,1", "corner at"),
        ("cylinder=30,-1e308,1e308", "corner at"),
    ],
)
def test_wrong_forms_are_refused(text: str, wrong: str) -> None:
    with pytest.raises(UsageError) as refused:
        Form(text).body(circle(), TOOLS)
    assert wrong in f"{refused.value} {refused.value.hint}"
    assert refused.value.hint


@pytest.mark.parametrize(
    ("content", "wrong"),
    [
        (b"", "no STL"),
        (b"PK\x03\x04 or a text\n" * 9, "no STL"),
        (b"solid x\nvertex 1 2\n", "no STL|wrong numbers"),
        (b"solid x\nvertex 1 2 a\nvertex 1 2 3\nvertex 4 5 6\n", "no STL"),
        (b"solid x\nvertex 1 2 nan\nvertex 1 2 3\nvertex 4 5 6\n", "wrong numbers"),
        (b"solid x\nvertex 1 2 7\nvertex 1 8 3\nvertex 4 5 6\n", "is open"),
        (b"\0" * 80 + b"\x01\0\0\0" + b"\0" * 12 + b"\0\0\x80\x4b" * 9 + b"\0\0", "reaches 1.67772e\\+07 mm"),
        (b"\0" * 80 + b"\xff\xff\xff\xff" + b"\0" * 50, "4,294,967,295 triangles"),
    ],
)
def test_wrong_files_are_refused(tmp_path: Path, content: bytes, wrong: str) -> None:
    file = tmp_path / "body.stl"
    file.write_bytes(content)
    with pytest.raises(UsageError, match=wrong):
        Form(str(file)).body(circle(), TOOLS)


def test_a_large_file_is_refused_before_it_is_read(tmp_path: Path) -> None:
    """Ten million triangles, and as much text, with nothing in them: holes take no room on a disk."""
    large = tmp_path / "large.stl"
    for head, size, wrong in (
        (b"\0" * 80 + (10_000_000).to_bytes(4, "little"), 84 + 50 * 10_000_000, "10,000,000 triangles"),
        (b"solid part\n" + b" " * 80, 300_000_000, "300,000,000 bytes and is no binary"),
    ):
        with large.open("wb") as file:
            file.write(head)
            file.truncate(size)
        with pytest.raises(UsageError, match=wrong):
            Form(str(large)).body(circle(), TOOLS)


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="this system has no endless device")
def test_a_device_is_no_body(tmp_path: Path) -> None:
    link = tmp_path / "endless.stl"
    link.symlink_to("/dev/zero")
    with pytest.raises(UsageError, match="is no file"):
        Form(str(link)).body(circle(), TOOLS)


@pytest.mark.parametrize("width", [1e308, 1e-308, float("inf"), float("nan"), 0.0, -1.0])
def test_a_width_that_no_cell_has_is_refused(width: float) -> None:
    with pytest.raises(UsageError, match="a resolution of"):
        Form("auto", width)


def test_a_body_inside_out_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "body.stl"
    surface = Stock(Box((0.0, 0.0, 0.0), (3.0, 4.0, 5.0)), 1.0).mesh()
    type(surface)(surface.vertices, surface.faces[:, ::-1]).write_stl(file)
    with pytest.raises(UsageError, match="inside out"):
        Form(str(file)).body(circle(), TOOLS)
    type(surface)(surface.vertices * (1.0, 1.0, 0.0), surface.faces).write_stl(file)
    with pytest.raises(UsageError, match="no volume"):
        Form(str(file)).body(circle(), TOOLS)


def test_a_cell_is_not_wider_than_its_body() -> None:
    """What is left and removed was that of the cell."""
    stock = Stock(Box((0.0, 0.0, -10.0), (20.0, 30.0, 0.0)), 5_000.0)
    assert stock.cell_mm == 10.0
    assert stock.volume_mm3 == pytest.approx(20.0 * 30.0 * 10.0)
    assert Stock(Box((0.0, 0.0, -10.0), (20.0, 40.0, 0.0)), 70.0).volume_mm3 == pytest.approx(
        20.0 * 40.0 * 10.0
    )


@pytest.mark.parametrize(("wide", "deep"), [(100.1, 50.05), (30.0, 20.5), (7.3, 9.1)])
def test_cells_fit_their_body(wide: float, deep: float) -> None:
    """Those at the rim reached beyond it by up to half a cell."""
    stock = Stock(Box((2.0, 3.0, -4.0), (2.0 + wide, 3.0 + deep, 0.0)), 0.2)
    assert 0.18 < stock.cell_mm <= 0.2
    assert stock.volume_mm3 == pytest.approx(wide * deep * 4.0, rel=3e-3)


def test_a_long_strip_has_as_many_cells_as_a_square() -> None:
    assert Form("box=0,0,-2,800,5,0").body(circle(), TOOLS).cell_mm == 0.1
    assert Form("box=0,0,-2,64,62,0").body(circle(), TOOLS).cell_mm == 0.1


def test_a_file_with_a_zero_byte_in_its_name_is_refused() -> None:
    with pytest.raises(UsageError, match="zero byte"):
        read_stl(Path("part\0.stl"))


UNLIKE = ("probe", "thread mill", "T-slot mill", "dovetail mill", "lollipop mill", "radius mill", "form mill")


@pytest.mark.parametrize(
    ("remark", "tool"),
    [
        ("T1 D=10. CR=0. - ZMIN=-12. - flat end mill", Tool(ToolKind.FLAT, 10.0)),
        ("T12 D=6. CR=3. - ZMIN=-12. - ball end mill", Tool(ToolKind.BALL, 6.0)),
        ("T9 D=20. - boring bar", Tool(ToolKind.BORING, 20.0)),
        ("T9 boring head 32 mm", Tool(ToolKind.BORING, 32.0)),
        ("T2 D=8. CR=0.5 - bullnose end mill", Tool(ToolKind.BULL, 8.0, corner_mm=0.5)),
        ("T4 D=8.5 CR=0. TAPER=118deg - ZMIN=-20.6 - drill", Tool(ToolKind.DRILL, 8.5, angle_deg=118.0)),
        ("T5 D=9. CR=0. TAPER=45deg - chamfer mill", Tool(ToolKind.CHAMFER, 9.0, angle_deg=90.0)),
        ("Outline, end mill 10 mm, two depths", Tool(ToolKind.FLAT, 10.0)),
        ("Four holes, drill 5.5 mm, chip breaking", Tool(ToolKind.DRILL, 5.5, angle_deg=118.0)),
        ("T7 V-Bit 90 deg 12 mm", Tool(ToolKind.CHAMFER, 12.0, angle_deg=90.0)),
        ("T8 D=6. - left hand end mill", Tool(ToolKind.FLAT, 6.0, left_hand=True)),
        ("T9 V-Bit {60 deg 12 mm}", Tool(ToolKind.CHAMFER, 12.0, angle_deg=60.0)),
        ('T1 - 1/4" end mill', Tool(ToolKind.FLAT, 6.35)),
        ("Tool 3: 2 1/2 inch face mill", Tool(ToolKind.FLAT, 63.5)),
        ("T3 1/2 inch end mill", Tool(ToolKind.FLAT, 12.7)),
        ('1/0" end mill', None),
        ("TC: 5mm_Endmill", Tool(ToolKind.FLAT, 5.0)),
        ("End mill 10,5 mm", Tool(ToolKind.FLAT, 10.5)),
        ("T1 D=1e9 - flat end mill", None),
        ("DRILL 9/32", Tool(ToolKind.DRILL, 25.4 * 9 / 32, angle_deg=118.0)),
        ("9/64 clearance drill", Tool(ToolKind.DRILL, 25.4 * 9 / 64, angle_deg=118.0)),
        ("here is the actual usage: T1 is a 1/16th end mill", Tool(ToolKind.FLAT, 25.4 / 16)),
        ("T4 END MILL 1 1/2", Tool(ToolKind.FLAT, 25.4 * 1.5)),
        ("DRILL #4", Tool(ToolKind.DRILL, 25.4 * 0.209, angle_deg=118.0)),
        ("T2 - NO. 80 DRILL", Tool(ToolKind.DRILL, 25.4 * 0.0135, angle_deg=118.0)),
        ("#81 drill", None),
        ("#3 center drill", None),
        ("LETTER F DRILL", Tool(ToolKind.DRILL, 25.4 * 0.257, angle_deg=118.0)),
        ("TAP PULLEY 1/4-20", Tool(ToolKind.DRILL, 6.35, angle_deg=118.0)),
        ("1/4-20 pulley tap", Tool(ToolKind.DRILL, 6.35, angle_deg=118.0)),
        ("TAP M6x1", Tool(ToolKind.DRILL, 6.0, angle_deg=118.0)),
        ("M8 tap", Tool(ToolKind.DRILL, 8.0, angle_deg=118.0)),
        ("tapping with M3 and S500", None),
        ("#10-32 tap", Tool(ToolKind.DRILL, 25.4 * 0.190, angle_deg=118.0)),
        ("OP 1/2 drill holes", None),
        ("side 1/2 end mill", None),
        ("drill 4 holes", None),
        ("END MILL 0.500", None),
        ("drill on 3/4/2020", None),
        *((f"T5 D=12. CR=1. - ZMIN=-3. - {name}", None) for name in UNLIKE),
        ("Four holes of 6.6 mm through the corners", Tool(ToolKind.DRILL, 6.6, angle_deg=118.0)),
        ("Hole, end mill 8 mm on a helix", Tool(ToolKind.FLAT, 8.0)),
        ("T1 D=0. - flat end mill", None),
        ("Pocket 32 mm wide", None),
        ("T2 = End Mill {0.5 inches}", Tool(ToolKind.FLAT, 12.7)),
        ("T1 - 3/8 FLAT ENDMILL - H1", Tool(ToolKind.FLAT, 9.525)),
        ("POCKET 1/2 SLOT", None),
        ("TOOL 1 - DIA 12.", Tool(ToolKind.FLAT, 12.0)),
        ("TOOL - 4 DIA. OFF. - 4 LEN. - 4 DIA. - 6.5", Tool(ToolKind.FLAT, 6.5)),
        ("T1 offset 25 mm", None),
        ("POCKET DIA 40", None),
        ("drill a bolt hole circle for 6 bolts at diameter 3 inches", None),
        ("TOOL/MILL,3.17, 0.00, 0.00, 0.00", Tool(ToolKind.FLAT, 3.17)),
        ("TOOL/MILL,6.35, 3.17, 0.00, 0.00", Tool(ToolKind.BALL, 6.35)),
        ("TOOL/MILL,8, 1.5, 20, 0", Tool(ToolKind.BULL, 8.0, corner_mm=1.5)),
        ("TOOL/MILL,2, 0, 10, 45", Tool(ToolKind.TAPER, 22.0, angle_deg=45.0, tip_mm=2.0)),
        ("TOOL/DRILL,6,118,20", Tool(ToolKind.DRILL, 6.0, angle_deg=118.0)),
        ("TOOL/MILL,nan,0,0,0", None),
        ("T239 | 6. FLAT ENDMILL | H239", Tool(ToolKind.FLAT, 6.0)),
        ("T5 | SPOT DRILL 10 | H5 | D5", Tool(ToolKind.CHAMFER, 10.0, angle_deg=90.0)),
        ("TOOL #12 0.25 ROUGH ENDMILL", Tool(ToolKind.FLAT, 0.25)),
        ("TOOL (7) END MILL DIA 16.0 R1.5 MM", Tool(ToolKind.BULL, 16.0, corner_mm=1.5)),
        ("T3 BALL NOSE MILL D6 R3", Tool(ToolKind.BALL, 6.0)),
        ("EndMill D7.5", Tool(ToolKind.FLAT, 7.5)),
        ("T5 END MILL H5 D5", None),
        ("T5 END MILL D5", None),
        ("T4 3 FLUTE ENDMILL", None),
        ("T4 - 3 DRILL HOLES", None),
        ("T4 OP 3 DRILL", None),
        ("T4 : 3.5", Tool(ToolKind.FLAT, 3.5)),
        ("tool -> 3/16 in", Tool(ToolKind.FLAT, 25.4 * 3 / 16)),
        ('102 - 1/8" Flat end mill', Tool(ToolKind.FLAT, 3.175)),
        ('"tool_diameter": 3.2', Tool(ToolKind.FLAT, 3.2)),
        ("T8 6,5mm compression", Tool(ToolKind.FLAT, 6.5)),
        ("Schaftfr\ufffdser 6,5 mm", Tool(ToolKind.FLAT, 6.5)),
        ("T2 KUGELFRAESER D7", Tool(ToolKind.BALL, 7.0)),
        ("T6 Bohrer D8.5", Tool(ToolKind.DRILL, 8.5, angle_deg=118.0)),
        ("T6 Gewindebohrer M7", Tool(ToolKind.DRILL, 7.0, angle_deg=118.0)),
        ("T6 Gewindefräser D7", None),
        ("T6 FRESA 9mm", Tool(ToolKind.FLAT, 9.0)),
        ("Finish everything", None),
        ("T1 D=1,5 flat end mill", Tool(ToolKind.FLAT, 1.5)),
        ("T1 D=10, CR=0, flat end mill", Tool(ToolKind.FLAT, 10.0)),
        ("T1 D=-5 flat end mill", None),
        ("T1 D=10.5.5 flat end mill", None),
    ],
)
def test_tools_in_remarks(remark: str, tool: Tool | None) -> None:
    found = tool_of_remark(remark)
    assert found == (tool if found is None or tool is None else replace(tool, diameter_mm=found.diameter_mm))
    assert found is None or found.diameter_mm == pytest.approx(tool.diameter_mm if tool else 0.0)


def test_numbers_of_tools_in_remarks() -> None:
    named = {
        "5 = End Mill {0.25 inches}": 5,
        "TOOL - 4 DIA. OFF. - 4": 4,
        "T12 D=6": 12,
        "T 1/4 mill": None,
        "TOOL (7) mill": 7,
        "Tool no. 55": 55,
        "Tool: 6 mm": None,
        "Tool: 6.35": None,
        "T10 in the spindle": 10,
        "1 - t (1 - s)": None,
        "5 = 3": None,
    }
    assert {remark: tool_number(remark) for remark in named} == named


def test_remarks_in_inches() -> None:
    assert tool_of_remark("T3 D=0.5 CR=0. - flat end mill", inch=True) == Tool(ToolKind.FLAT, 12.7)
    assert tool_of_remark("MILL 0.500", inch=True) == Tool(ToolKind.FLAT, 12.7)
    assert tool_of_remark(".125 ball end mill", inch=True) == Tool(ToolKind.BALL, 25.4 * 0.125)
    assert tool_of_remark("drill 0.5 deep", inch=True) is None
    assert tool_number("T03 D=0.5") == 3
    assert tool_number("Tool #12: drill") == 12
    assert tool_number("finish") is None


@given(st.text(max_size=60))
def test_any_remark_is_a_tool_or_none(remark: str) -> None:
    found = tool_of_remark(f"T1 D=6 {remark} mill")
    assert found is None or found.diameter_mm > 0.0


VECTRIC = [
    "Material Size",
    " X= 120.000, Y= 80.000, Z= 18.000",
    " Z Origin for Material  = Material Surface",
    " XY Origin for Material = Center",
    "      XY Origin Position  = X:0.000, Y:0.000",
]


@pytest.mark.parametrize(
    ("remarks", "inch", "form"),
    [
        (["STOCK box=0, 0,-12,62,41,0"], False, "box=0,0,-12,62,41,0"),
        (["a remark", " stock cylinder=30,-60,0 "], True, "cylinder=30,-60,0"),
        (["STOCK/BLOCK,100.00, 90.00, 6.00,0.00, 10.00, 6.00"], False, "box=0,-10,-6,100,80,0"),
        (["STOCK/BLOCK, 4, 3, 1, 2, 1.5, 1"], True, "box=-50.8,-38.1,-25.4,50.8,38.1,0"),
        (
            ["stockMin:0.00mm, -2.50mm, -6.00mm", "stockMax:90.00mm, 60.00mm, 0.00mm"],
            True,
            "box=0,-2.5,-6,90,60,0",
        ),
        (["stockMin:0in, 0in, -1in", "stockMax:2in, 2in, 0in"], False, "box=0,0,-25.4,50.8,50.8,0"),
        (VECTRIC, False, "box=-60,-40,-18,60,40,0"),
        (
            [
                *VECTRIC[:2],
                "Z Origin for Material = Table Surface",
                "XY Origin for Material = Top Right Corner",
            ],
            False,
            "box=-120,-80,0,0,0,18",
        ),
        (VECTRIC[:2], False, None),  # where it lies is not said
        ([*VECTRIC[:3], "XY Origin for Material = Offset"], False, None),
        (["stockMin:0mm, 0mm, -6mm"], False, None),
        (["STOCK/BLOCK,100,90,6"], False, None),
        (
            ["STOCK/BLOCK,100,90,x,0,0,0", "STOCK/BLOCK,1e9,1,1,0,0,0", "STOCK/BLOCK,nan,1,1,0,0,0"],
            False,
            None,
        ),
        (["STOCK box of steel", "STOCK", "stock 20 mm"], False, None),
    ],
)
def test_a_body_in_remarks(remarks: list[str], inch: bool, form: str | None) -> None:
    assert stock_of_remarks(remarks, inch=inch) == form


def test_a_body_is_turned_over_where_it_lies(tmp_path: Path) -> None:
    """A wedge that is high at low x and y: about X its lower side is up and y is the other way around."""
    corners = [(0, 0, 0), (30, 0, 0), (30, 20, 0), (0, 20, 0), (0, 0, 9), (30, 0, 3), (30, 20, 1), (0, 20, 7)]
    faces = [(0, 2, 1), (0, 3, 2), (4, 5, 6), (4, 6, 7), (0, 1, 5), (0, 5, 4)]
    faces += [(1, 2, 6), (1, 6, 5), (2, 3, 7), (2, 7, 6), (3, 0, 4), (3, 4, 7)]
    path = tmp_path / "wedge.stl"
    Mesh(np.array(corners, np.float64), np.array(faces)).write(path)
    course = Rows(
        np.zeros(0), np.zeros((0, 3)), *(np.zeros(0, np.int64),) * 2, np.zeros(0, bool), np.zeros(0)
    )
    upright = Form(str(path), 0.5).body(course, {})
    assert upright.height(2.25, 2.25) == pytest.approx(9.0 - 6.0 * 2.25 / 30.0 - 2.0 * 2.25 / 20.0, abs=0.3)
    for axis in "xy":
        over = Form(f"{axis}-turned={path}", 0.5).body(course, {})
        assert (over.box.low, over.box.high) == (upright.box.low, upright.box.high)
        assert over.heights == pytest.approx(9.0)  # its flat side; below it counts as full
        turned = np.array(corners, np.float64)
        for i in (1 if axis == "x" else 0, 2):
            turned[:, i] = (30.0, 20.0, 9.0)[i] - turned[:, i]
        Mesh(turned, np.array(faces)).write(tmp_path / "over.stl")
        back = Form(f"{axis}-turned={tmp_path / 'over.stl'}", 0.5).body(course, {})
        assert back.heights == pytest.approx(upright.heights, abs=1e-5)
    with pytest.raises(UsageError, match="cannot read 'z-turned"):
        Form("z-turned=part.stl").body(course, {})


def test_a_remark_says_what_auto_is() -> None:
    text = "(T1 D=6 flat end mill)\n(STOCK box=-3,-4,-5,31,21,2)\nT1 M6\nS900 M3\nG0 Z9\nG1 Z-1 F500\nX20\nG0 Z9\nM30\n"
    machined = polycnc.run(text, "mill3", "fanuc", stock="auto", resolution_mm=1.0).machined
    assert machined is not None
    assert machined.stock.box == Box((-3.0, -4.0, -5.0), (31.0, 21.0, 2.0))
    assert machined.messages[0].endswith("1 mm a cell, as '<text>' says")
    given = polycnc.run(text, "mill3", "fanuc", stock="box=0,-4,-5,31,21,2", resolution_mm=1.0).machined
    assert given is not None
    assert given.stock.box.low[0] == 0.0


SLOT = "(T1 D=6)\nG0 X0 Y0 Z10\nT1 M6\nS1000 M3\nG1 Z-{deep} F3000\nG1 X10\nG0 Z10\nM30\n"
TILTED = "(T1 D=6)\nT1 M6\nS1000 M3\nG0 X0 Y0 Z10 A0\nG1 Z-2 F3000\nG1 X10 A10\nG0 Z20\nM30\n"
BAR = "(T1 CNMG120408)\nT0101\nM3 S500\nG0 X{x} Z2\nG1 Z-10 F3000\nG0 X50\nM30\n"


def test_the_body_of_a_run_is_cut_on_and_stays_as_it_is() -> None:
    first = polycnc.run(SLOT.format(deep=2), stock="box=-4,-4,-3,14,4,0")
    assert first.stock is not None
    left = first.stock.volume_mm3
    again = polycnc.run(SLOT.format(deep=2), stock=first.stock)
    deeper = polycnc.run(SLOT.format(deep=2.5), stock=first.stock)
    assert again.removed_mm3 == 0.0
    assert deeper.removed_mm3 == pytest.approx(first.removed_mm3 / 4.0, rel=1e-3)
    assert deeper.stock is not None
    assert first.stock.volume_mm3 == left
    assert deeper.stock.volume_mm3 == pytest.approx(left - deeper.removed_mm3)


def test_a_body_goes_from_three_axes_to_five_and_back() -> None:
    flat = polycnc.run(SLOT.format(deep=2), stock="box=-4,-4,-3,14,4,0", resolution_mm=0.1)
    tilted = polycnc.run(TILTED, "mill5", stock=flat.stock)
    assert isinstance(tilted.stock, Voxels)
    assert flat.stock is not None
    assert flat.stock.volume_mm3 - tilted.removed_mm3 == pytest.approx(tilted.stock.volume_mm3, rel=1e-3)
    assert tilted.removed_mm3 > 5.0
    back = polycnc.run(SLOT.format(deep=2), stock=tilted.stock)
    assert back.removed_mm3 < 0.01 * flat.removed_mm3


def test_a_bar_of_a_lathe_is_cut_on() -> None:
    first = polycnc.run(BAR.format(x=18), "lathe2", "fanuc-lathe", stock="cylinder=20,-30,0")
    again = polycnc.run(BAR.format(x=18), "lathe2", "fanuc-lathe", stock=first.stock)
    assert first.removed_mm3 > 100.0
    assert again.removed_mm3 == 0.0


@pytest.mark.parametrize(
    ("stock", "machine", "resolution_mm", "says"),
    [
        (Stock(Box((0, 0, 0), (9, 9, 9)), 1.0), "lathe2", None, "'box of 9 x 9 x 9 mm' as stock of a lathe"),
        (Turned(20.0, -9.0, 0.0, 0.1), "mill3", None, "as stock of a mill"),
        (Turned(20.0, -9.0, 0.0, 0.1), "mill5", None, "as stock of a mill"),
        (Stock(Box((0, 0, 0), (9, 9, 9)), 1.0), "mill3", 0.1, "a resolution for a body"),
        (5, "mill3", None, "'5' is no stock"),
    ],
)
def test_a_body_that_cannot_be_cut_there_is_refused(
    stock: Stock | Turned, machine: str, resolution_mm: float | None, says: str
) -> None:
    program = {"lathe2": BAR.format(x=18), "mill3": SLOT.format(deep=2), "mill5": TILTED}[machine]
    dialect = "fanuc-lathe" if machine == "lathe2" else None
    with pytest.raises(UsageError, match=re.escape(says)):
        polycnc.run(program, machine, dialect, stock=stock, resolution_mm=resolution_mm)


@pytest.mark.parametrize(("cell_mm", "said"), [(0.5, False), (3.0, False), (3.5, True), (20.0, True)])
def test_cells_too_wide_for_a_tool_are_said(cell_mm: float, said: bool) -> None:
    result = polycnc.run(SLOT.format(deep=2), stock="box=-40,-40,-3,40,40,0", resolution_mm=cell_mm)
    assert any("are wide for tool 1 of 6 mm" in message.text for message in result.messages) == said
