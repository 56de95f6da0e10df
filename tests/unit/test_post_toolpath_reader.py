"""Tool paths in APT words: each statement in the forms that CAM systems write, and what is refused."""

from __future__ import annotations

from pathlib import Path as FilePath

import pytest

from polycnc.errors import ProgramError, UsageError
from polycnc.post import open_tool_path, parse_tool_path
from polycnc.post.tool_path._records import (
    Circle,
    Compensation,
    Coolant,
    Cycle,
    CycleOff,
    Delta,
    Dwell,
    End,
    Feed,
    From,
    Goto,
    Home,
    Path,
    Rapid,
    Record,
    Spindle,
    Stop,
    Text,
    Tool,
    ToolShape,
    Word,
)
from support.post_controls import posted


def records(text: str) -> list[Record]:
    """Return the records of a text."""
    return list(parse_tool_path(text, "part.cl"))


def only(text: str) -> Record:
    """Return the only record of a text, its line being 1."""
    (record,) = records(text)
    return record


STATEMENTS: dict[str, Record] = {
    "PARTNO BRACKET 7, REV B": Text(1, "part", "BRACKET 7, REV B"),
    "PARTNO/bracket": Text(1, "part", "bracket"),
    "MACHIN/ MILL , 3": Text(1, "machine", "MILL"),
    "PPRINT watch the (clamp)": Text(1, "comment", "watch the (clamp)"),
    "PPRINT/ OP 10 / A": Text(1, "comment", "OP 10 / A"),
    "INSERT G65 P9010 A1.": Text(1, "insert", "G65 P9010 A1."),
    "TPRINT/DRILL 8,X": ToolShape(1, "DRILL 8"),
    "CUTTER/ 12.5, 1.0": ToolShape(1, diameter=12.5),
    "TLDATA/MILL,50.0,3.0,75.0,0.0,0.0": ToolShape(1, None, 50.0, 75.0),
    "LOADTL/3": Tool(1, 3),
    "LOADTL / 12, LENGTH, 100.5, OSETNO, 31": Tool(1, 12, None, 100.5, 31),
    "LOAD/TOOL,4,ADJUST,14": Tool(1, 4, None, None, 14),
    "TURRET/5,CUTCOM,6": Tool(1, 5, None, None, None, 6),
    "TOOLNO/7": Tool(1, 7),
    "SPINDL/RPM,1500,CLW": Spindle(1, "cw", 1500.0),
    "SPINDL/ 2000.0 , RPM , CCLW": Spindle(1, "ccw", 2000.0),
    "SPINDL/900": Spindle(1, "cw", 900.0),
    "SPINDL/SMM,180,CLW": Spindle(1, "cw", 180.0, True),
    "SPINDL/OFF": Spindle(1, "off"),
    "SPINDL/RANGE,2,RPM,500": Spindle(1, "cw", 500.0),
    "SPINDL/SMM,180,CLW,MAXRPM,2600": Spindle(1, "cw", 180.0, True, 2600.0),
    "SPINDL/MAXRPM,2600,SMM,180,CCLW": Spindle(1, "ccw", 180.0, True, 2600.0),
    "SPINDL/ON": Spindle(1, "on"),
    "FEDRAT/250": Feed(1, 250.0),
    "FEDRAT/250,MMPM": Feed(1, 250.0),
    "FEDRAT / MMPR, 0.25": Feed(1, 0.25, True),
    "RAPID": Rapid(1),
    "goto/1,2,3": Goto(1, 1.0, 2.0, 3.0),
    "GOTO / 1., -.5, +2.5E-1": Goto(1, 1.0, -0.5, 0.25),
    "GOTO/1,2,3,0,0,2": Goto(1, 1.0, 2.0, 3.0, (0.0, 0.0, 1.0)),
    "  GOTO/1.5D1,2,3": Goto(1, 15.0, 2.0, 3.0),
    "FROM/0,0,100": From(1, 0.0, 0.0, 100.0),
    "GODLTA/1,2,-3": Delta(1, 1.0, 2.0, -3.0),
    "GODLTA/-5": Delta(1, -5.0, 0.0, 0.0, along_axis=True),
    "GOHOME": Home(1),
    "COOLNT/FLOOD": Coolant(1, "flood"),
    "COOLNT/ON": Coolant(1, "flood"),
    "COOLNT/MIST": Coolant(1, "mist"),
    "COOLNT/THRU": Coolant(1, "through"),
    "COOLNT/OFF": Coolant(1, "off"),
    "CUTCOM/LEFT,21": Compensation(1, "left", 21),
    "CUTCOM/RIGHT": Compensation(1, "right"),
    "CUTCOM/OFF": Compensation(1, "off"),
    "DELAY/1.5": Dwell(1, seconds=1.5),
    "DELAY/3,REV": Dwell(1, revolutions=3.0),
    "STOP": Stop(1),
    "OPSTOP": Stop(1, optional=True),
    "END": End(1),
    "FINI": End(1),
    "END-OF-PATH": Path(1, None),
}


@pytest.mark.parametrize("text", STATEMENTS)
def test_a_statement(text: str) -> None:
    assert only(text) == STATEMENTS[text]
    assert only(text + "   $$ a remark") == STATEMENTS[text]


def test_feeds_in_inches_where_the_unit_of_lengths_is_said() -> None:
    for unit in ("UNITS/MM", "UNITS/INCHES"):
        text = f"{unit}\nFEDRAT/10,IPM\nFEDRAT/IPR,.01\nFEDRAT/5,FPM\n"
        found = list(parse_tool_path(text))
        assert found == [Feed(2, 254.0), Feed(3, 0.254, True), Feed(4, 5.0 * (12.0 * 25.4))]


CYCLES: dict[str, Cycle] = {
    "DRILL,DEPTH,10,MMPM,100,CLEAR,2": Cycle(1, "drill", 10.0, 2.0, 2.0, 100.0),
    # RAPTO goes on from CLEAR towards the point, and RETURN names the level to leave to.
    "DRILL,DEPTH,10,MMPM,254,CLEAR,5,RAPTO,3,RETURN,20": Cycle(1, "drill", 10.0, 2.0, 20.0, 254.0),
    "DRILL,DEPTH,10,CLEAR,5,RETURN,0": Cycle(1, "drill", 10.0, 5.0, None),
    # Without CLEAR, RAPTO is the level; depths may be written downwards.
    "DRILL,RAPTO,3.0,FEDTO,-20.0,RTRCTO,10,MMPM,250": Cycle(1, "drill", 20.0, 3.0, 10.0, 250.0),
    # By place: depth, feed and its unit, clearance; the feed may stand before its unit or after.
    "DRILL,12,180,MMPM,3": Cycle(1, "drill", 12.0, 3.0, 3.0, 180.0),
    "DRILL, 12, MMPM, 180, 3, RAPTO, 1, DWELL, 0.5": Cycle(1, "dwell", 12.0, 2.0, 3.0, 180.0, dwell_s=0.5),
    "TAP,10,400,MMPM,20,3": Cycle(1, "tap", 10.0, 3.0, 3.0, 400.0),
    "DEEP,30,100,MMPM,2,5": Cycle(1, "deep", 30.0, 2.0, 2.0, 100.0, peck=5.0),
    "CSINK,DEPTH,3,MMPM,80,CLEAR,1,DWELL,0.2": Cycle(1, "dwell", 3.0, 1.0, 1.0, 80.0, dwell_s=0.2),
    "FACE,DEPTH,3,MMPM,80,CLEAR,1": Cycle(1, "dwell", 3.0, 1.0, 1.0, 80.0),
    "DEEP,DEPTH,30,STEP,5,4,3,MMPR,0.1,CLEAR,2": Cycle(1, "deep", 30.0, 2.0, 2.0, 0.1, True, 3.0),
    "DRILL,DEEP,STEP,6,FEDTO,-30,RAPTO,2": Cycle(1, "deep", 30.0, 2.0, 2.0, peck=6.0),
    "BRKCHP,DEPTH,20,STEP,4,CLEAR,1": Cycle(1, "chip_break", 20.0, 1.0, 1.0, peck=4.0),
    "TAP,DEPTH,12,PITCH,1.5,CLEAR,5": Cycle(1, "tap", 12.0, 5.0, 5.0, 1.5, True),
    "TAP,DEPTH,12,TPI,20,CLEAR,5": Cycle(1, "tap", 12.0, 5.0, 5.0, 1.27, True),
    "REAM,DEPTH,12,MMPM,60,CLEAR,5": Cycle(1, "bore", 12.0, 5.0, 5.0, 60.0),
    "BORE,DEPTH,12,PERREV,.1,CLEAR,5": Cycle(1, "bore", 12.0, 5.0, 5.0, 0.1, True),
}


@pytest.mark.parametrize("text", CYCLES)
def test_a_cycle(text: str) -> None:
    assert only(f"CYCLE/{text}") == CYCLES[text]


def test_cycle_off_and_on() -> None:
    assert records("CYCLE/OFF\nCYCLE/NOMORE\nCYCLE/ON\n") == [CycleOff(1), CycleOff(2), CycleOff(3, on=True)]


def test_inches_become_mm_and_a_unit_of_the_feed_wins() -> None:
    text = (
        "UNITS/INCHES\nGOTO/1,2,3\nFEDRAT/10\nFEDRAT/100,MMPM\nCYCLE/DRILL,DEPTH,1,IPM,2,CLEAR,.1,DWELL,2\n"
    )
    point, feed, other, cycle = records(text)
    assert point == pytest.approx((2, 25.4, 50.8, 76.2, None))
    assert (feed, other) == (Feed(3, 254.0), Feed(4, 100.0))
    assert isinstance(cycle, Cycle)
    assert cycle[2:6] == pytest.approx((25.4, 2.54, 2.54, 50.8))
    assert cycle.dwell_s == 2.0


def test_an_arc_is_the_circle_and_the_point_behind_it() -> None:
    text = "GOTO/10,0,5\nCIRCLE/0,0,5,0,0,-2,10,0.05,0.5\nGOTO/0,-10,5\n"
    assert records(text)[1] == Circle(2, 0.0, -10.0, 5.0, (0.0, 0.0, 5.0), (0.0, 0.0, -1.0))


def test_turns_come_from_times_or_from_the_angle() -> None:
    start = "GOTO/10,0,0\n"
    for circle in (
        "CIRCLE/0,0,0,0,0,1,10,TIMES,3\nGOTO/10,0,-6",
        "MOVARC/0,0,0,0,0,1,10,ANGLE,1080\nGOTO/10,0,-6",
    ):
        arc = records(start + circle)[1]
        assert isinstance(arc, Circle)
        assert arc.turns == 3
    short = records(start + "MOVARC/0,0,0,0,0,1,10,ANGLE,90\nGOTO/0,10,0")[1]
    long = records(start + "MOVARC/0,0,0,0,0,1,10,ANGLE,450\nGOTO/0,10,0")[1]
    assert isinstance(short, Circle)
    assert isinstance(long, Circle)
    assert (short.turns, long.turns) == (1, 2)


def test_a_circle_to_follow_turns_in_the_direction_given() -> None:
    text = "GOTO/0,-25,0\nINDIRV/{},0,0\nTLON,GOFWD/ (CIRCLE/ 0,0,0,$\n 25),ON,2,INTOF,(LINE/ 0,0,0,$\n 25,0,0)\n"
    counter = records(text.format(1))[1]
    clockwise = records(text.format(-1))[1]
    assert counter == Circle(3, 25.0, 0.0, 0.0, (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    assert clockwise == Circle(3, 25.0, 0.0, 0.0, (0.0, 0.0, 0.0), (0.0, 0.0, -1.0))


def test_a_statement_goes_on_behind_a_dollar() -> None:
    assert only("GOTO/1,$\n2,$ \n  3\n") == Goto(1, 1.0, 2.0, 3.0)
    assert only("GOTO/1, 2, $ $$ remark\n 3,$\n0,0,1\n") == Goto(1, 1.0, 2.0, 3.0, (0.0, 0.0, 1.0))


def test_operations_have_names() -> None:
    text = "TOOL PATH/ROUGH,TOOL,MILL_10\nEND-OF-PATH\n"
    assert records(text) == [Path(1, "ROUGH"), ToolShape(1, name="MILL_10"), Path(2, None)]


def test_unknown_statements_are_remarked_and_harmless_ones_not() -> None:
    path = parse_tool_path("MULTAX\nFOO/1\nPAINT/COLOR,3\n\n$$ x\nBAR\nFOO/2\nREMARK nothing\n")
    assert [record.name for record in path if isinstance(record, Word)] == ["FOO", "BAR", "FOO"]
    summary = posted(path)[1]
    found = [(remark.line, remark.text, remark.count) for remark in summary.remarks]
    assert found == [(2, "FOO is not known and was left out", 2), (6, "BAR is not known and was left out", 1)]


def test_reading_twice_gives_the_same_remarks() -> None:
    path = parse_tool_path("FOO\nRAPID\nGOTO/1,2,3\n")
    for _ in range(2):
        remarks = posted(path)[1].remarks
        assert [remark.count for remark in remarks] == [1]


@pytest.mark.parametrize(
    ("text", "what", "line", "column"),
    [
        ("\nGOTO/1,2", "GOTO needs 3 numbers, or 6 with a tool axis, and has 2", 2, 1),
        ("GOTO/1,2,A", "has 2 and 'A'", 1, 10),
        ("  GOTO/1,2,3,0,0,0", "a direction without a length", 1, 3),
        ("GOTO/1,2,1E12", "further than any machine", 1, 1),
        ("GOTO/1,2,nan", "GOTO needs 3 numbers", 1, 10),
        ("GOTO/1,2,1_0", "GOTO needs 3 numbers", 1, 10),
        ("GOTO/1,$\n2,X", "has 2 and 'X'", 2, 3),
        ("FROM/1", "FROM needs 3 numbers", 1, 1),
        ("GODLTA/1,2", "GODLTA needs 1 or 3 numbers and has 2", 1, 1),
        ("LOADTL", "LOADTL needs a tool number", 1, 1),
        ("LOADTL/X", "'X' is no number", 1, 8),
        ("LOADTL/1.5", "whole number, not 1.5", 1, 1),
        ("LOADTL/1,LENGTH", "LENGTH needs a length", 1, 10),
        ("SPINDL/SMM,180,MAXRPM", "MAXRPM needs a highest speed", 1, 16),
        ("FEDRAT/MMPM", "FEDRAT needs a feed", 1, 1),
        ("FEDRAT/0", "a feed of 0", 1, 1),
        ("FEDRAT/5,INVERS", "an inverse time feed", 1, 1),
        ("UNITS/FURLONGS", "UNITS without a unit", 1, 1),
        ("CIRCLE/1,2,3", "needs a centre, an axis and a radius", 1, 1),
        ("CIRCLE/0,0,0,0,0,1,5", "an arc without an end point", 1, 1),
        ("CIRCLE/0,0,0,0,0,1,5\nGOTO/1,2,3", "an arc without a start point", 1, 1),
        ("GOTO/5,0,0\nCIRCLE/0,0,0,0,0,1,5\nGOTO/0,6,0", "lies 1 mm off the circle", 2, 1),
        ("INDIRV/1", "INDIRV needs 3 numbers", 1, 1),
        ("TLON,GOFWD/(CIRCLE/0,0,0,5),TO,(LINE/0,0,0,5,0,0)", "'TO' in a move along a circle", 1, 29),
        ("GOTO/0,5,0\nTLON,GOFWD/(CIRCLE/0,0,0,5),ON,(LINE/0,0,0,5,0,0)", "without its circle", 2, 1),
        ("CYCLE/NOSUCH", "the cycle 'NOSUCH' is not known", 1, 7),
        ("CYCLE/", "a cycle without a kind", 1, 1),
        ("CYCLE/DRILL,CLEAR,2", "a cycle without a depth", 1, 1),
        ("CYCLE/DEEP,DEPTH,20,CLEAR,2", "how deep they are", 1, 1),
        ("CYCLE/DRILL,DEPTH,1,CLEAR,2,RAPTO,9", "begins below its depth", 1, 1),
        ("CYCLE/DRILL,DEPTH,CLEAR,2", "'CLEAR' is no number", 1, 19),
        ("CYCLE/DRILL,DEPTH,5,MMPM,-1", "a feed of -1", 1, 1),
        ("CUTCOM/UP", "CUTCOM without a side", 1, 1),
        ("DELAY/X", "DELAY needs a time", 1, 1),
        ("TRACUT/1", "TRACUT moves the tool", 1, 1),
    ],
)
def test_what_is_refused(text: str, what: str, line: int, column: int) -> None:
    with pytest.raises(ProgramError) as caught:
        records(text)
    assert what in caught.value.what
    assert caught.value.hint
    assert caught.value.position is not None
    assert (caught.value.position.file, caught.value.position.line) == ("part.cl", line)
    assert caught.value.position.column == column


def test_names_may_be_japanese(tmp_path: FilePath) -> None:
    for encoding in ("utf-8", "cp932"):
        file = tmp_path / "part.cl"
        file.write_bytes("PARTNO 部品\r\nGOTO/1,2,3\r\n".encode(encoding))
        path = open_tool_path(file)
        assert list(path) == [Text(1, "part", "部品"), Goto(2, 1.0, 2.0, 3.0)]
        assert path.part_read == 1.0
        assert str(path.position(2)) == f"{file}:2:1"


def test_no_such_file(tmp_path: FilePath) -> None:
    with pytest.raises(UsageError, match="no such file"):
        open_tool_path(tmp_path / "nothing.cl")
    with pytest.raises(UsageError, match="cannot read"):
        open_tool_path(tmp_path)
