"""Whole programs cut whole bodies: volumes by closed forms, and each planted fault at its block, none without it."""

from __future__ import annotations

import json
import math
from pathlib import Path

import jsonschema
import pytest
from typer.testing import CliRunner

from polycnc import runner
from polycnc.cli._app import app
from polycnc.errors import UsageError
from polycnc.machine import ToolConfig, load_machine, parse_machine, preset_text
from polycnc.stock import ContactKind, Form, Stock, Tool, ToolKind

BRACKET = Path(__file__).resolve().parents[3] / "examples" / "bracket.nc"
PLATE = """(T1 D=10. CR=0. - flat end mill)
G21 G90 G17 G94 G54
T1 M6
S5000 M3
G43 H1 G0 X-10 Y12 Z20
Z-4
G1 X70 F1500
G0 Z20
X-10 Y30
Z-4
G1 X70
G0 Z20
M30
"""
TOOLS = {1: Tool(ToolKind.FLAT, 10.0, flute_mm=12.0, holder=((30.0, 25.0),))}


def machined(
    text: str, tools: dict[int, Tool] | None = None, form: str = "box=0,0,-20,60,42,0"
) -> runner.Machined:
    config = load_machine("mill3")
    collector = runner.MachiningCollector(config)
    runner.run(text, config, "fanuc", tagged_rows=collector.add, check=False)
    found = tools if tools is not None else runner.tools_of(config, collector.texts)
    return collector.machined(Form(form, 0.25), found)


def solid(found: runner.Machined) -> Stock:
    assert isinstance(found.stock, Stock)
    return found.stock


def test_two_slots_in_a_plate() -> None:
    found = machined(PLATE)
    assert found.volume_mm3 == pytest.approx(2 * 60.0 * 10.0 * 4.0, rel=0.01)
    assert found.collisions == []
    lines = {
        found.blocks[n].line: volume for n, volume in enumerate(found.removed_mm3.tolist()) if volume > 0.0
    }
    assert sorted(lines) == [7, 11]
    assert found.by_tool_mm3 == {1: pytest.approx(found.volume_mm3)}
    assert found.messages == ["stock: box of 60 x 42 x 20 mm, 0.25 mm a cell"]


FAULTS = {
    "a rapid across the plate": ("G0 Z20\nX-10 Y30", "G0 X-10 Y30", ContactKind.RAPID, 8),
    "a rapid down into the plate": ("Z-4\nG1 X70 F1500", "X30 Z-4\nG1 X70 F1500", ContactKind.RAPID, 6),
    "no spindle": ("S5000 M3\n", "S5000\n", ContactKind.SPINDLE, 7),
    "the spindle stopped too early": ("Z-4\nG1 X70\n", "Z-4 M5\nG1 X70\n", ContactKind.SPINDLE, 11),
    "short flutes": ("Z-4\nG1 X70 F1500", "Z-12.5\nG1 X70 F1500", ContactKind.FLUTES, 7),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_planted_fault_is_found_at_its_block(fault: str) -> None:
    right, wrong, kind, line = FAULTS[fault]
    assert PLATE.count(right) == 1
    found = machined(PLATE.replace(right, wrong), TOOLS)
    first = found.collisions[0]
    assert (first.kind, first.line) == (kind, line)
    assert {each.kind for each in found.collisions} == {kind}


def test_an_auto_body_begins_where_the_tool_comes_down_at_rapid() -> None:
    found = machined(PLATE, TOOLS, "auto")
    assert found.collisions == []
    assert found.stock.box.low == pytest.approx((-5.0, 6.0, -5.0))
    assert found.stock.box.high == pytest.approx((76.0, 36.0, 0.0))
    wrong = machined(PLATE.replace("G0 Z20\nX-10 Y30", "G0 X-10 Y30"), TOOLS, "auto")
    assert [(each.kind, each.line) for each in wrong.collisions] == [(ContactKind.RAPID, 8)]


def test_a_low_holder_is_found_and_a_long_tool_is_right() -> None:
    low = {1: Tool(ToolKind.FLAT, 10.0, holder=((3.5, 25.0),))}
    found = machined(PLATE, low)
    assert {each.kind for each in found.collisions} == {ContactKind.HOLDER}
    assert found.collisions[0].line == 6
    assert machined(PLATE, TOOLS).collisions == []


def test_another_work_offset_cuts_elsewhere() -> None:
    text = PLATE.replace("X-10 Y30\nZ-4", "G55 X-10 Y10\nZ-4")
    config = load_machine("mill3").model_copy(
        update={"offsets": {"G54": {"X": 5.0}, "G55": {"X": 5.0, "Y": 20.0}}}
    )
    collector = runner.MachiningCollector(config)
    runner.run(text, config, "fanuc", tagged_rows=collector.add, check=False)
    found = collector.machined(Form("box=0,0,-20,60,42,0", 0.25), TOOLS)
    assert found.volume_mm3 == pytest.approx(2 * 60.0 * 10.0 * 4.0, rel=0.01)
    assert solid(found).height(30.0, 30.0) == -4.0
    assert solid(found).height(30.0, 36.0) == 0.0


def test_the_bracket() -> None:
    """Outline 10 mm deep, a pocket of 32 mm and two slots 6 mm deep, as its remarks say."""
    config = load_machine("mill3")
    collector = runner.MachiningCollector(config)
    runner.run(BRACKET, config, tagged_rows=collector.add)
    found = collector.machined(Form("box=0,0,-12,90,60,0", 0.1), runner.tools_of(config, collector.texts))
    assert solid(found).height(45.0, 30.0) == -6.0
    pocket = math.pi * 16.0**2 * 6.0
    by_line = {found.blocks[n].line: v for n, v in enumerate(found.removed_mm3.tolist()) if v > 0.0}
    in_pocket = sum(v for line, v in by_line.items() if found.blocks.names and 20 <= line <= 27)
    assert in_pocket == pytest.approx(pocket, rel=0.02)
    assert found.collisions == []
    assert solid(found).height(10.0, 10.0) == -12.0  # a hole through a corner
    assert found.messages[1:] == []


def test_a_longer_tool_does_not_come_along_the_way_of_the_one_before() -> None:
    change = "T2 M6\nG43 H2\nG0 X30 Y21\nM30"
    config = load_machine("mill3").model_copy(
        update={
            "tools": {1: ToolConfig(length_mm=40.0), 2: ToolConfig(length_mm=75.0)},
            "offsets": {"G54": {"Z": -130.0}},
        }
    )
    text = PLATE.replace("M30", change).replace("G0 Z20\nT2", "G0 Z40\nX30 Y21\nT2")
    collector = runner.MachiningCollector(config)
    runner.run(text, config, "fanuc", tagged_rows=collector.add, check=False)
    tools = {**TOOLS, 2: Tool(ToolKind.FLAT, 4.0)}
    found = collector.machined(Form("box=0,0,-20,60,42,0", 0.25), tools)
    assert found.collisions == []
    assert found.by_tool_mm3[1] == pytest.approx(2 * 60.0 * 10.0 * 4.0, rel=0.01)
    assert solid(found).height(30.0, 21.0) == 0.0


def test_the_length_of_another_tool_is_a_crash() -> None:
    """H is not T: the tool is longer than what is compensated."""
    config = load_machine("mill3").model_copy(
        update={
            "tools": {1: ToolConfig(length_mm=62.0), 2: ToolConfig(length_mm=40.0)},
            "offsets": {"G54": {"Z": -130.0}},
        }
    )
    collector = runner.MachiningCollector(config)
    runner.run(PLATE.replace("H1", "H2"), config, "fanuc", tagged_rows=collector.add, check=False)
    found = collector.machined(Form("box=0,0,-20,60,42,0", 0.25), TOOLS)
    kinds = {(each.kind, each.line) for each in found.collisions}
    assert (ContactKind.FLUTES, 7) in kinds
    assert (ContactKind.RAPID, 9) in kinds  # 20 mm above the part is 2 mm within it


def test_stock_lies_in_the_offset_of_the_first_cut() -> None:
    config = load_machine("mill3").model_copy(
        update={"offsets": {"G54": {"X": 300.0}, "G55": {"X": 50.0, "Y": 7.0}}}
    )
    collector = runner.MachiningCollector(config)
    text = "G4 P2\nG0 X1\n" + PLATE.replace("G43 H1", "G55 G43 H1")
    runner.run(text, config, "fanuc", tagged_rows=collector.add, check=False)
    found = collector.machined(Form("box=0,0,-20,60,42,0", 0.25), TOOLS)
    assert found.volume_mm3 == pytest.approx(2 * 60.0 * 10.0 * 4.0, rel=0.01)


def test_a_check_says_what_it_could_not_look_at() -> None:
    wrong = PLATE.replace("G0 Z20\nX-10 Y30", "G0 X-10 Y30")
    form = "box=0,0,-20,60,42,0"

    def keys(text: str, machine: str = "mill3", stock: str = form) -> list[str]:
        return [each.key for each in runner.inspect(text, machine, "fanuc", stock=stock).remarks]

    assert keys(PLATE) == []
    assert "rapid" in keys(wrong)
    assert keys(PLATE.replace("(T1 D=10. CR=0. - flat end mill)\n", "")) == ["unknown_tool"]
    assert "no_stock" in keys("G0 X10\nM30\n", stock="auto")
    assert "no_stock" in keys(PLATE, stock="box=500,0,-20,560,42,0")
    turned = (Path(__file__).resolve().parents[3] / "examples" / "five_axis.nc").read_text()
    assert keys(turned, "mill5", "auto") == []


@pytest.mark.parametrize(("text", "status"), [(PLATE, 0), (PLATE.replace("S5000 M3\n", "S5000\n"), 1)])
def test_the_command_reports_stock_as_its_schema_says(tmp_path: Path, text: str, status: int) -> None:
    program = tmp_path / "plate.nc"
    program.write_text(text)
    words = ["run", str(program), "-d", "fanuc", "--stock", "box=0,0,-20,60,42,0", "--json"]
    done = CliRunner().invoke(app, words)
    assert done.exit_code == status
    printed = json.loads(done.stdout)
    jsonschema.validate(printed, runner.json_schema("run"))
    assert printed["stock"]["removed_mm3"] == pytest.approx(2 * 60.0 * 10.0 * 4.0, rel=0.01)
    assert [each["kind"] for each in printed["stock"]["collisions"]] == ["spindle", "spindle"][: 2 * status]


def test_a_machine_without_z_is_refused() -> None:
    with pytest.raises(UsageError, match="has no axis Z"):
        runner.MachiningCollector(parse_machine(preset_text("lathe2").replace('"Z"', '"W"'), "w.toml"))


def test_a_program_that_cuts_nothing_tells_no_stock() -> None:
    with pytest.raises(UsageError, match="cuts nothing"):
        machined("G0 X10\nM30\n", TOOLS, "auto")
    stopped = runner.run("G0 X10 Q\nM30\n", "mill3", "fanuc", stock="auto", check=False)
    assert (stopped.ok, stopped.machined) == (False, None)  # the alarm is what is to be said
    assert stopped.messages[-1].text == "the program cuts nothing: no stock can be told"


def test_stock_where_no_tool_comes_is_said() -> None:
    found = runner.run(PLATE, "mill3", "fanuc", stock="box=500,0,-20,560,42,0", check=False).messages[-1]
    assert found.text.startswith(
        "no tool meets the stock: it lies at X500 to X560, Y0 to Y42, Z-20 to Z0, and they cut at"
    )


BORE = """(T1 D=18. - drill)
(T2 D=20. - TOOL)
G21 G90 G17 G94 G54
T1 M6
S900 M3
G0 X20 Y20 Z20
G81 X20 Y20 Z-30 R2 F100
G80
T2 M6
S600 M3
CYCLE
G80
M30
"""


@pytest.mark.parametrize(
    ("tool", "cycle", "lines"),
    [
        ("boring bar", "G76 X20 Y20 Z-12 R2 Q0.3 F60", []),
        ("flat end mill", "G76 X20 Y20 Z-12 R2 Q0.3 F60", [11]),
        ("boring bar", "G86 X20 Y20 Z-12 R2 F60", []),
        ("boring bar", "G0 X24 Z-12", [11]),  # the bar itself meets what the drill has left
    ],
)
def test_a_boring_bar_retracts_off_the_wall(tool: str, cycle: str, lines: list[int]) -> None:
    text = BORE.replace("TOOL", tool).replace("CYCLE", cycle)
    result = runner.run(text, None, "fanuc", stock="box=0,0,-20,40,40,0", resolution_mm=0.25, check=False)
    assert [each.line for each in result.collisions] == lines
    if not lines:  # the bore alone, not its shift
        assert result.machined is not None
        bored = math.pi * (9.0**2 * 20.0 + (10.0**2 - 9.0**2) * 12.0)
        assert result.removed_mm3 == pytest.approx(bored, rel=0.003)


HANDED = {  # how programs say the one tool that they never change: what is removed of 4 mm, along 30 mm
    "a T word alone": ("(T1  D=6 CR=0 - ZMIN=-4 - flat end mill)\nT1", 6.0),
    "a tool in a remark": (
        "(6mm Endmill003)\n( M6 T2 )\n(Compensated Tool Path. Diameter: 6.0)",
        6.0,
    ),
    "its diameter in words": ("( Tool 5: End Mill 3 Flutes, Diam = 8mm, Len = 20.00mm)", 8.0),
    "after the T word": ("T1\nM5\n(MSG, Change tool bit to cutter diameter 0.25in)\nM6\nM0", 6.35),
    "before M6 and T": ("(TC: 6mm Endmill)\nM5\nM6 T3", 6.0),
    "two tools, no word which": ("(6mm Endmill)\n(8mm Endmill)", None),
    "nothing": ("(Use a V Bit)", None),
}


@pytest.mark.parametrize("how", HANDED)
def test_programs_that_never_change_the_tool(how: str) -> None:
    said, diameter = HANDED[how]
    text = f"{said}\nG21 G90\nM3 S9000\nG0 X5 Y12\nZ5\nG1 Z-4 F300\nX35\nG0 Z5\nM30\n"
    config = load_machine("mill3")
    collector = runner.MachiningCollector(config)
    runner.run(text, config, "din", tagged_rows=collector.add, check=False)
    found = collector.machined(Form("box=0,0,-12,60,42,0", 0.1))
    area = 0.0 if diameter is None else 30.0 * diameter + math.pi * diameter**2 / 4.0
    assert found.volume_mm3 == pytest.approx(4.0 * area, rel=1e-2)
    assert found.collisions == []
    assert any(message.startswith("no tool is in the spindle") for message in found.messages) == (
        diameter is None
    )


def test_rapids_into_what_pecks_have_cut_leave_an_auto_body_whole() -> None:
    """Pecks with G0 at two corners: a hole that is there already is no place beside the body."""
    peck = "G1 Z-3 F300\nG0 Z-2\nG1 Z-6\nG0 Z3\nZ-5\nG1 Z-8\nG0 Z3\n"
    text = f"(T1 D=4 drill)\nT1 M6\nS900 M3\nG0 X70 Y40\nZ3\n{peck}X40 Y70\n{peck}M30\n"
    found = machined(text, form="auto")
    assert found.stock.box.low == pytest.approx((37.0, 37.0, -9.0))
    assert found.stock.box.high == pytest.approx((73.0, 73.0, 0.0))
    assert found.collisions == []
    depth = 8.0 - 2.0 / math.tan(math.radians(59.0)) * 2.0 / 3.0
    assert found.volume_mm3 == pytest.approx(2.0 * math.pi * 4.0 * depth, rel=0.05)


@pytest.mark.parametrize(
    ("start", "kinds"),
    [
        ("G0 X20 Y20\nZ10", []),  # where the machine was before it has come down is not known
        ("G53 G0 Z0\nG0 X20 Y20\nZ10", []),
        ("G0 Z10\nX20 Y20", []),
        ("G0 Z10\nX-20 Y20\nZ-3\nX20", [ContactKind.RAPID]),
    ],
)
def test_a_machine_that_starts_within_the_stock(start: str, kinds: list[ContactKind]) -> None:
    text = f"(T1 D=6 flat end mill)\nT1 M6\nS900 M3\n{start}\nG0 Z9\nG1 Z-2 F500\nX30\nG0 Z20\nM30\n"
    assert [each.kind for each in machined(text, form="box=-5,-5,-12,60,42,4").collisions] == kinds


def test_a_thread_mill_is_not_taken_for_a_tool_of_a_lathe() -> None:
    text = "(Thread M20, cut by a thread mill of 10 mm)\nT5 M6\nS900 M3\nG0 Z5\nG1 Z-3 F500\nM30\n"
    machined = runner.run(text, None, "fanuc", stock="box=-9,-9,-9,9,9,0").machined
    assert machined is not None
    assert any("the shape of tool 5 is not known" in each for each in machined.messages)
