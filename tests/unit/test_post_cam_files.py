"""Tool paths as each CAM system writes them: arcs, cycles, coordinate systems, tools; and what is no tool path."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest

from polycnc.errors import ProgramError
from polycnc.post import parse_control, parse_tool_path, shipped_text, sweep_tool_path
from polycnc.post.tool_path._cl_words import CLSF_WORDS
from polycnc.post.tool_path._records import (
    Axis,
    Compensation,
    Coolant,
    Cycle,
    Dwell,
    From,
    Goto,
    Home,
    Rapid,
    Record,
    Retract,
    Spindle,
    Text,
    Tool,
    ToolShape,
)
from polycnc.runner import post_file
from support.post_controls import control, posted
from support.post_recorder import calls_of, moves_of, points_of
from support.tool_paths import records, senses

# A slot with round ends, 30 long and 7 across: lines meet both arcs on their tangents. Seen from above it is
# counter-clockwise, so that an axis by the right-hand rule is 0, 0, 1 and one for a clockwise direction 0, 0, -1.
SLOT = """RAPID
GOTO/0,-3.5,5
FEDRAT/700,MMPM
GOTO/0,-3.5,-2
GOTO/30,-3.5,-2
CIRCLE/30,0,-2,0,0,{0},3.5
GOTO/30,3.5,-2
GOTO/0,3.5,-2
CIRCLE/0,0,-2,0,0,{0},3.5
GOTO/0,-3.5,-2
RAPID
GOTO/0,-3.5,5
END
"""
NX = "TOOL PATH/SLOT,TOOL,MILL_6\nTLDATA/MILL,6,0,75,0,0\nMSYS/0,0,0,1,0,0,0,1,0\n"


@pytest.mark.parametrize("word", sorted(CLSF_WORDS))
def test_the_axis_of_an_arc_in_a_clsf_is_for_a_clockwise_direction(word: str) -> None:
    header = {"TOOLPATH": "TOOL PATH/SLOT,TOOL,M", "PAINT": "PAINT/PATH", "MSYS": "MSYS/0,0,0,1,0,0,0,1,0"}
    text = f"{header.get(word, word)}\n" + SLOT.format(-1)
    assert senses(text) == [1.0, 1.0]
    assert senses(text, "counterclockwise") == [-1.0, -1.0]
    assert senses(text, "clockwise") == [1.0, 1.0]


def test_the_axis_of_an_arc_in_other_apt_is_by_the_right_hand_rule() -> None:
    assert senses(SLOT.format(1)) == [1.0, 1.0]
    assert senses(SLOT.format(1), "clockwise") == [-1.0, -1.0]
    # MOVARC is not NX's: by the right-hand rule wherever it stands, unless one says otherwise.
    text = NX + SLOT.format(1).replace("CIRCLE", "MOVARC")
    assert senses(text) == [1.0, 1.0]
    assert senses(text, "clockwise") == [-1.0, -1.0]


def test_a_file_that_shows_too_late_what_it_is_is_refused() -> None:
    text = SLOT.format(1).replace("RAPID\nGOTO/0,-3.5,5\nEND", "PAINT/COLOR,3\nEND")
    with pytest.raises(ProgramError, match="PAINT is of a file with clockwise axes, but the arc on line 6"):
        records(text)
    assert senses(text, "counterclockwise") == [1.0, 1.0]


def test_a_slot_of_nx_is_posted_counter_clockwise() -> None:
    blocks, summary = posted(NX + SLOT.format(-1), control())
    text = "\n".join(blocks)
    assert "G03" in text
    assert "G02" not in text
    assert summary.remarks == ()


@pytest.mark.parametrize(("header", "right", "wrong"), [("", 1, -1), (NX, -1, 1)])
def test_arcs_that_turn_back_where_lines_meet_them_are_no_proof(header: str, right: int, wrong: int) -> None:
    good = post_file(parse_tool_path(header + SLOT.format(right), "part.cl"), control(), verify=True)
    assert good.ok
    assert good.verification is not None
    assert (good.verification.smooth_arcs, good.verification.kinked_arcs) == (2, 0)
    bad = post_file(parse_tool_path(header + SLOT.format(wrong), "part.cl"), control(), verify=True)
    proof = bad.verification
    assert proof is not None
    assert proof.deviation_mm < 1e-3  # the program does what was read, and what was read is wrong
    assert (proof.smooth_arcs, proof.kinked_arcs) == (0, 2)
    assert not bad.ok
    first = 6 + header.count("\n")
    assert [(r.line, "turn back" in r.text, "--arc-axis" in r.text) for r in bad.summary.remarks] == [
        (first, True, True)
    ]


def test_arcs_between_corners_and_arcs_decide_nothing() -> None:
    square = "FROM/0,0,0\nRAPID\nGOTO/10,0,0\nFEDRAT/500\nGOTO/20,0,0\nCIRCLE/15,0,0,0,0,1,5\nGOTO/10,0,0\nGOTO/0,0,0\n"
    proof = post_file(parse_tool_path(square), control(), verify=True).verification
    assert proof is not None
    assert (proof.smooth_arcs, proof.kinked_arcs, proof.ok) == (0, 0, True)


BETWEEN = (
    *("SPINDL/RPM,2500,CLW", "COOLNT/FLOOD", "FEDRAT/333,MMPM", "PPRINT next", "DELAY/1.5", "STOP", "OPSTOP"),
    *("INSERT M77", "CUTCOM/OFF", "PARTNO X", "TPRINT/D8", "CUTTER/8", "TLAXIS/0,0,1", "REMARK x"),
)


HOLES = """LOADTL/2
SPINDL/RPM,2000,CLW
RAPID
GOTO/5,6,40
CYCLE/DRILL,DEPTH,7,MMPM,90,CLEAR,3
GOTO/11,13,0
{}
GOTO/29,17,0
CYCLE/OFF
RAPID
GOTO/29,17,40
"""


@pytest.mark.parametrize("statement", BETWEEN)
def test_a_cycle_holds_whatever_stands_between_its_points(statement: str) -> None:
    text = HOLES.format(statement)
    feeds = [sweep for sweep in sweep_tool_path(parse_tool_path(text)) if not sweep.rapid]
    down = [((11.0, 13.0, 3.0), (11.0, 13.0, -7.0)), ((29.0, 17.0, 3.0), (29.0, 17.0, -7.0))]
    assert [(sweep.start, sweep.end) for sweep in feeds] == down
    holes = [words for macro, words in moves_of(text) if macro == "CYCLE_DRILL"]
    assert [(words["X"], words["Y"], words["Z"], words["R"]) for words in holes] == [
        (11.0, 13.0, -7.0, 3.0),
        (29.0, 17.0, -7.0, 3.0),
    ]
    as_moves = [words for macro, words in moves_of(text, cycles="moves") if macro == "LINEAR"]
    assert [(words["X"], words["Y"], words["Z"]) for words in as_moves] == [end for _, end in down]


@pytest.mark.parametrize(
    ("statement", "calls"), [("SPINDL/RPM,2500,CLW", 2), ("DELAY/1.5", 2), ("PPRINT next", 1)]
)
def test_what_the_control_might_take_for_its_cycle_is_said_outside_of_it(statement: str, calls: int) -> None:
    result = post_file(parse_tool_path(HOLES.format(statement)), control(), verify=True)
    assert result.ok
    assert result.text is not None
    assert result.text.count("G80") == calls
    assert result.verification is not None
    # The machine never feeds sideways: each feed is a hole.
    assert result.verification.run.cutting_path_mm == pytest.approx(20.0)


def test_a_tool_change_ends_a_cycle_and_a_retraction_does_not() -> None:
    text = "RAPID\nGOTO/1,2,40\nFEDRAT/80\nCYCLE/DRILL,DEPTH,7,CLEAR,3\nGOTO/5,2,0\n{}\nGOTO/9,2,0\n"
    assert [macro for macro, *_ in points_of(moves_of(text.format("LOADTL/4")))] == [
        "RAPID",
        "CYCLE_DRILL",
        "LINEAR",
    ]
    found = points_of(moves_of(text.format("CLEARP/XYPLAN,33\nRETRCT")))
    assert found == [
        ("RAPID", 1.0, 2.0, 40.0),
        ("CYCLE_DRILL", 5.0, 2.0, -7.0),
        ("RAPID", 5.0, 2.0, 33.0),
        ("CYCLE_DRILL", 9.0, 2.0, -7.0),
    ]


def test_gohome_goes_to_its_point() -> None:
    assert records("GOHOME/12,-7,85")[0] == Home(1, (12.0, -7.0, 85.0))
    text = "UNITS/INCHES\nFROM/0,0,3\nGOHOME/1,2,4\nGOHOME\n"
    (first, *there), (second, *back) = points_of(moves_of(text))
    assert (first, second) == ("RAPID", "RAPID")
    assert there == pytest.approx([25.4, 50.8, 101.6])
    assert back == pytest.approx([0.0, 0.0, 76.2])
    assert [sweep.end for sweep in sweep_tool_path(parse_tool_path(text))] == [
        pytest.approx((25.4, 50.8, 101.6)),
        pytest.approx((0.0, 0.0, 76.2)),
    ]
    with pytest.raises(ProgramError, match="GOHOME needs 3 numbers"):
        records("GOHOME/AXIS,X")


def test_the_tool_axis_stays_until_another_one_is_given() -> None:
    text = "FROM/0,0,50\nTLAXIS/0,3,4\nRAPID\nGOTO/1,2,3\nFEDRAT/100\nGOTO/4,2,3\nTLAXIS/0,0,1\nGOTO/5,2,3\n"
    axes = [(words["TOOLI"], words["TOOLJ"], words["TOOLK"]) for _, words in moves_of(text, rotary="vector")]
    assert axes == [(0.0, 0.6, 0.8), (0.0, 0.6, 0.8), (0.0, 0.0, 1.0)]
    with pytest.raises(ProgramError, match="the tool is tilted"):
        moves_of(text)
    with pytest.raises(ProgramError, match="the tool axis changes with an arc"):
        moves_of("FEDRAT/9\nGOTO/5,0,0\nTLAXIS/0,3,4\nCIRCLE/0,0,0,0,0,1,5\nGOTO/0,5,0\n", rotary="vector")


def test_the_tool_axis_of_a_start_point_is_written_with_the_next_move() -> None:
    for start in ("TLAXIS/0,3,4\nFROM/0,0,50\n", "FROM/0,0,50,0,3,4\n"):
        text = f"{start}FEDRAT/100\nGOTO/1,2,3\n"
        assert moves_of(text, rotary="vector")[0][1]["TOOLJ"] == 0.6
        with pytest.raises(ProgramError, match="the tool is tilted"):
            moves_of(text)


def test_the_tool_is_upright_again_before_the_cycle_of_the_control() -> None:
    text = "FEDRAT/90\nGOTO/1,2,30,0,3,4\nCYCLE/DRILL,DEPTH,7,CLEAR,3\nGOTO/5,6,0,0,0,1\nGOTO/9,6,0\n"
    found = [(macro, words.get("TOOLK"), words.get("Z")) for macro, words in moves_of(text, rotary="vector")]
    assert found[1] == ("RAPID", 1.0, 30.0)
    assert [(macro, z) for macro, _, z in found[2:4]] == [("CYCLE_DRILL", -7.0), ("CYCLE_DRILL", -7.0)]


def test_a_tool_that_is_in_the_spindle_already_ends_a_cycle_too() -> None:
    text = "LOADTL/4\nRAPID\nGOTO/1,2,40\nFEDRAT/80\nCYCLE/DRILL,DEPTH,7,CLEAR,3\nGOTO/5,2,0\nLOADTL/4\nGOTO/9,2,0\n"
    assert [macro for macro, *_ in points_of(moves_of(text))] == ["RAPID", "CYCLE_DRILL", "LINEAR"]
    assert sum(macro == "TOOL_CHANGE" for macro, _ in calls_of(text)[0]) == 1


def test_a_retraction_goes_up_to_the_clearance_plane() -> None:
    assert records("CLEARP/XYPLAN,27\nRETRCT\nRETRCT/XYPLAN,31\nCLEARP/0,0,1,19\nRETRCT\n") == [
        Retract(2, 27.0),
        Retract(3, 31.0),
        Retract(5, 19.0),
    ]
    text = "FEDRAT/90\nRAPID\nGOTO/3,4,6\nCLEARP/XYPLAN,27\nRETRCT\nGOTO/3,4,50\nRETRCT\n"
    assert points_of(moves_of(text)) == [
        ("RAPID", 3.0, 4.0, 6.0),
        ("RAPID", 3.0, 4.0, 27.0),
        ("LINEAR", 3.0, 4.0, 50.0),
    ]


REFUSED = {
    "RETRCT": "RETRCT without a clearance plane",
    "RETRCT/ON": "RETRCT with something else than a height",
    "CLEARP/YZPLAN,5": "CLEARP with something else than a height",
    "CLEARP/1,0,0,5": "CLEARP with something else than a height",
    "CLEARP/XYPLAN,5\nRETRCT": "RETRCT from an unknown point",
    "FROM/0,0,0\nCLEARP/XYPLAN,5\nTLAXIS/1,0,0\nRETRCT": "RETRCT with a tilted tool",
    "TLAXIS/NORMPS": "TLAXIS with something else than a direction",
    "TLAXIS/0,0,0": "a direction without a length",
    "SAFPOS/1,2,3": "SAFPOS moves the tool",
    "SET/OFSETL,12": "length offset 12 for a tool that has moved with none",
    "LOADTL/3\nRAPID\nGOTO/1,2,3\nSET/OFSETL,12": "length offset 12 for a tool that has moved with 3",
    "LOADTL/3\nSET/OFSETL,12,OFF": "SET with something else than OFSETL",
    "LOADTL/3\nSET/HOLDER,12": "SET with something else than OFSETL",
    "CYCLE81/10,0,2,-25,0": "CYCLE81 moves the tool",
    "TLCOMP/ON,LEFT": "TLCOMP moves the tool",
    "CALLSUB/1001": "CALLSUB moves the tool",
    "TRNTYP/LOCAL,0,0,0": "TRNTYP with other coordinates",
    "MODE/MILL\nRAPID\nGOTO/5,6,14\nCYCLE/DRILL,9,MMPM,120,14\nGOTO/5,6,-9": "a cycle whose clearance, 14, is",
    "LATHE/ROUGH,SH1,SH2": "LATHE moves the tool",
    "LOCAL_ORIGIN, 0.00000, 130.00000, 0.000000": "LOCAL_ORIGIN moves the tool",
    "CYCLE/TURN,2,0.5": "the cycle 'TURN' is not known",
    "CYCLE/DRILL,12,2,3,4,5": "the numbers of the cycle from 4 on are not known",
    "CYCLE/BORE,14.5,0,0,2,85,1,355,ON,0,0,1000": "ON,0 in a cycle is not known",
    "CYCLE/BORE,14.5,0,0,2,85": "the numbers of the cycle from 2 on are not known",
    "CYCLE/DRILL,DEPTH,5,CLEAR,2,FOO,7": "FOO,7 in a cycle is not known",
    "CYCLE/DRILL,126,85,1,MMPM": "which of the numbers 85 and 1 is the feed",
    "GOTO/1,2,3,0,0.6,0.8\nMULTAX/OFF\nGOTO/1,2,9": "MULTAX/OFF while the tool is tilted",
    "TLAXIS/0,0.6,0.8\nMULTAX/OFF\n" + "GOTO/1,2,9\n" * 9: "MULTAX/OFF while the tool is tilted",
    "CUTCOM/ADJUST,55": "CUTCOM/ADJUST with something else",
    "CUTCOM/ADJUST,2,PLUS,XAXIS,5": "CUTCOM/ADJUST with something else",
    "CUTCOM/ADJUST,ON": "ADJUST needs a work offset",
    "FEDRAT/90\nGOTO/1,2,3\nCUTCOM/ADJUST,2\nGODLTA/0,0,5": "a move by a distance from an unknown point",
    "GOTO/1,2,3\nCUTCOM/ADJUST,2\nCIRCLE/1,5,3,0,0,1,3\nGOTO/1,8,3": "an arc without a start point",
    "CLEARP/XYPLAN,5\nCUTCOM/ADJUST,2\nRETRCT": "RETRCT without a clearance plane",
    "UNIT/FURLONG": "UNIT without a unit",
    "PAINT/PATH\nFEDRAT/IPM,12": "a feed in inches in a tool path",
    "PAINT/PATH\nCYCLE/DRILL,RAPTO,.1,FEDTO,-1,IPR,.002": "a feed in inches in a tool path",
    "FEDRAT/12,IPM": "a feed in inches in a tool path that does not say the unit",
    "FEDRAT/IPR,.012": "a feed in inches in a tool path that does not say the unit",
    "CYCLE/DRILL,DEPTH,1,IPM,4,CLEAR,.1": "a feed in inches in a tool path that does not say the unit",
    "NURBS/3": "NURBS moves the tool",
    "MODE/INCR": "MODE/INCR is not known",
    "CUTCOM/ON\nGOTO/1,2,3": "CUTCOM/ON without a side",
    "CYCLE/BORE,BACK,DEPTH,5,CLEAR,1": "cuts from below",
    "CYCLE/TAP,DEEP,DEPTH,5,CLEAR,1,STEP,2": "a thread tapped in pecks",
    "SPINDL/ORIENT,90": "SPINDL/ORIENT is not known",
}


@pytest.mark.parametrize("text", REFUSED)
def test_what_would_be_cut_wrong_is_an_error(text: str) -> None:
    with pytest.raises(ProgramError) as caught:
        moves_of(text + "\n")
    assert REFUSED[text] in caught.value.what
    assert caught.value.hint
    assert caught.value.position is not None


def test_nurbs_names_the_setting_of_nx() -> None:
    with pytest.raises(ProgramError) as caught:
        records("NURBS/3\n")
    assert "Motion Output" in caught.value.hint


NO_TOOL_PATHS = {
    "an NC program": b"%\nO0001 (PART)\nN10 G90 G21\nN20 T1 M06\nG00 X1. Y2.\nG01 Z-1. F100\nM30\n%\n",
    "random bytes": np.random.default_rng(7).integers(0, 256, 5000, np.uint8).tobytes(),
    "nothing": b"",
    "only remarks": b"$$ nothing\n$$ here\n",
    "a letter": b"Dear Sir,\nRAPID\nplease find enclosed\nthe drawing\n",
}


@pytest.mark.parametrize("name", NO_TOOL_PATHS)
def test_what_is_no_tool_path_is_an_error_and_the_old_output_stays(name: str, tmp_path: Path) -> None:
    (tmp_path / "part.cl").write_bytes(NO_TOOL_PATHS[name])
    (tmp_path / "part.nc").write_text("old\n")
    with pytest.raises(ProgramError, match="this is no tool path"):
        post_file(tmp_path / "part.cl", "din", tmp_path / "part.nc")
    assert (tmp_path / "part.nc").read_text() == "old\n"
    assert sorted(file.name for file in tmp_path.iterdir()) == ["part.cl", "part.nc"]


BEYOND = (
    "GOTO/5,0,0\nCIRCLE/1e20,0,0,0,0,1,1e20\nGOTO/5,1,0",
    "GOTO/5,0,0\nCIRCLE/0,-2e7,0,0,0,1,2e7\nGOTO/5.001,0,0",
    "GOTO/5,0,0\nMOVARC/0,0,0,0,0,1,5,ANGLE,1e15\nGOTO/5,0,0",
    "GOTO/5,0,0\nCIRCLE/0,0,0,0,0,1,5,TIMES,1e9\nGOTO/5,0,0",
    "GOTO/0,5,0\nINDIRV/1,0,0\nTLON,GOFWD/(CIRCLE/1e20,0,0,5),ON,(LINE/0,0,0,5,0,0)",
    "GOTO/1e20,-1e20,0",
    "UNITS/INCHES\nGOTO/99999,0,0\nGOTO/999999,0,0",
    "GODLTA/1e20",
    "GODLTA/0,0,1e20",
    "GOHOME/0,0,1e20",
    "FROM/0,0,-1e20",
    "CLEARP/XYPLAN,1e20",
    "CYCLE/DRILL,DEPTH,1e20,CLEAR,2",
)


@pytest.mark.parametrize("text", BEYOND)
def test_what_is_beyond_any_machine_is_an_error(text: str) -> None:
    with pytest.raises(ProgramError) as caught:
        moves_of(f"FEDRAT/100\n{text}\n")
    assert "any machine" in caught.value.what or "turns" in caught.value.what


# ---------------------------------------------------------------------------------------- one system after another

SYSTEMS: dict[str, tuple[str, list[Record]]] = {
    "NX: the tool goes out to where it was": (
        "CYCLE/DRILL,RAPTO,3.0000,FEDTO,-33.0043,RTRCTO,AUTO,MMPM,250.0000",
        [Cycle(1, "drill", 33.0043, 3.0, None, 250.0)],
    ),
    "NX: STEP makes pecks": (
        "CYCLE/DRILL,RAPTO,3,FEDTO,-33,RTRCTO,12,STEP,4.5,MMPM,250",
        [Cycle(1, "deep", 33.0, 3.0, 12.0, 250.0, peck=4.5)],
    ),
    "NX: a turret": ("LOAD/TURRET,7,ADJUST,17", [Tool(1, 7, None, None, 17)]),
    "NX: a dwell in revolutions": ("DELAY/REV,12", [Dwell(1, revolutions=12.0)]),
    "DWELL is DELAY": ("DWELL/2.5", [Dwell(1, seconds=2.5)]),
    "UNIT is UNITS": ("UNIT/INCH\nGOTO/1,2,3", [Goto(2, 25.4, 50.8, 3.0 * 25.4)]),
    "Autodesk: texts in quotes": (
        "MODE/MILL\nPARTNO/'plate 3'\nPPRINT/'face (1)'",
        [Text(2, "part", "plate 3"), Text(3, "comment", "face (1)")],
    ),
    "Autodesk: pocket, length and offset of a tool": (
        "LOADTL/5, 0, 62.500000, 15",
        [Tool(1, 5, None, 62.5, 15)],
    ),
    "Autodesk: CUTCOM/ON comes before its side": (
        "CUTCOM/ON\nCUTCOM/LEFT, 9\nCUTCOM/OFF\nCUTCOM/ON\nCUTCOM/RIGHT, 9",
        [Compensation(2, "left", 9), Compensation(3, "off"), Compensation(5, "right", 9)],
    ),
    "CUTCOM/ON takes the last side up": (
        "CUTCOM/LEFT, 9\nCUTCOM/OFF\nCUTCOM/ON\nGOTO/1,2,3",
        [
            Compensation(1, "left", 9),
            Compensation(2, "off"),
            Compensation(4, "left", 9),
            Goto(4, 1.0, 2.0, 3.0),
        ],
    ),
    "CATIA: TOOLNO describes, LOADTL changes once": (
        "TOOLNO/3,MILL,1,0,   14.1,  100.0,$\n  100.0,,NOTE\nTPRINT/T3 END MILL,A\nLOADTL/3,1,1\nLOADTL/3,1,1",
        [ToolShape(3, "T3 END MILL"), Tool(4, 3)],
    ),
    "Creo: the tool stands in a remark": (
        "$$*  Pro/CLfile\n$$-> MFGNO / M1\n$$-> CUTTER / 12.500000\n$$-> END /  4\nGOTO / 1, 2, 3",
        [ToolShape(3, diameter=12.5), Goto(5, 1.0, 2.0, 3.0)],
    ),
    "Creo: a coordinate system over three lines": (
        "$$-> CSYS / 1.0, 0.0, 0.0, 0.0,  $\n            0.0, 1.0, 0.0, 0.0,  $\n            0.0, 0.0, 1.0, 0.0\n"
        "FROM / 1, 2, 3",
        [From(4, 1.0, 2.0, 3.0)],
    ),
    "SolidWorks CAM: the next tool is only announced": (
        "SELECT/TOOL,4\nLOAD/TOOL,3\nCOOLNT/FLOOD",
        [Tool(2, 3), Coolant(3, "flood")],
    ),
    "SolidWorks CAM: INIT announces a cycle": (
        "CYCLE/INIT\nCYCLE/DEEP2,DEPTH,17,STEP,3,MMPM,120,CLEAR,2",
        [Cycle(2, "deep", 17.0, 2.0, 2.0, 120.0, peck=3.0)],
    ),
    "SolidWorks CAM: a first peck and the others": (
        "CYCLE/INIT\nCYCLE/DEEP2,FEDTO,34.,1STPECK,6.,SUBPECK,2.5,MMPM,410.5,RAPTO,3.,RTRCTO,21.",
        [Cycle(2, "deep", 34.0, 3.0, 21.0, 410.5, peck=2.5)],
    ),
    "SolidWorks CAM: INSERT is a note": (
        "INSERT/[HOLDER=A-32] 9MM X 90DEG SPOT DRILL\nINSERT/Stock Size X9. Y8. Z7.\n"
        "INSERT/M123 (On)\nINSERT/G91 G28 Z0.",
        [
            Text(1, "comment", "[HOLDER=A-32] 9MM X 90DEG SPOT DRILL"),
            Text(2, "comment", "Stock Size X9. Y8. Z7."),
            Text(3, "insert", "M123 (On)"),
            Text(4, "insert", "G91 G28 Z0."),
        ],
    ),
    "SolidWorks CAM: what the part's coordinates are is said again": (
        "TRNTYP/WORLD,0,0,0\nCSI_SET_FLUTE_LENGTH/19.\nCSI_SET_EXTENSION_LENGTH/25.\nGOTO/1,2,3",
        [Goto(4, 1.0, 2.0, 3.0)],
    ),
    "NCL: the offset of a tool": ("LOADTL/7,LENGTH,90,OFFSET,17", [Tool(1, 7, None, 90.0, 17)]),
    "Autodesk: with FEDTO, RAPTO is a level": (
        "CYCLE/DRILL, FEDTO, 9.5, MMPM, 120, CLEAR, 14, RTRCTO, 13, RAPTO, 11",
        [Cycle(1, "drill", 9.5, 11.0, 13.0, 120.0)],
    ),
    "Autodesk: RAPTO goes down from the clearance": (
        "CYCLE/DRILL, 9.5, MMPM, 120, 14, RAPTO, 11",
        [Cycle(1, "drill", 9.5, 3.0, 14.0, 120.0)],
    ),
    "CATIA: TOOLNO of a mill without its kind": (
        "TOOLNO/7, 18.000000, 2.000000,, 110.000000,$\n\nLOADTL/7,1\nRAPID\nGOTO/1,2,3",
        [Tool(3, 7), Rapid(4), Goto(5, 1.0, 2.0, 3.0)],
    ),
    "NCL: TOOLNO/ADJUST is the length offset": (
        "LOADTL/7\nTOOLNO/ADJUST,17\nRAPID\nGOTO/1,2,3",
        [Tool(1, 7, None, None, 17), Rapid(3), Goto(4, 1.0, 2.0, 3.0)],
    ),
    "an offset after the tool change": (
        "LOADTL/3\nSPINDL/RPM,500,CLW\nSET/OFSETL,13\nRAPID\nGOTO/1,2,3\nSET/OFSETL,13,ON\nLOADTL/3",
        [Tool(1, 3, None, None, 13), Spindle(2, "cw", 500.0), Rapid(4), Goto(5, 1.0, 2.0, 3.0)],
    ),
    "the spindle is locked": ("SPINDL/LOCK", [Spindle(1, "off")]),
}


@pytest.mark.parametrize("name", SYSTEMS)
def test_a_statement_means_what_its_system_means(name: str) -> None:
    text, wanted = SYSTEMS[name]
    path = parse_tool_path(text + "\n")
    assert list(path) == wanted
    assert path.remarks.all() == []


@pytest.mark.parametrize(
    "text",
    [
        "MODE/MILL\nRAPID\nGOTO/5,6,14\nCYCLE/DRILL, 9, MMPM, 120, 14\nGOTO/5,6,0",
        "MODE/MILL\nRAPID\nGOTO/5,6,14\nCYCLE/DRILL, 9, MMPM, 120, 3\nGOTO/5,6,-9",
        "RAPID\nGOTO/5,6,3\nCYCLE/DRILL, 9, MMPM, 120, 3\nGOTO/5,6,-9",
        "MODE/MILL\nRAPID\nGOTO/5,6,3\nCYCLE/DRILL,DEPTH,9,MMPM,120,CLEAR,3\nGOTO/5,6,-9",
    ],
)
def test_levels_of_a_cycle_that_count_from_the_point_are_read(text: str) -> None:
    assert [name for name, _ in moves_of(text + "\nGOTO/9,6,-9\n")].count("CYCLE_DRILL") == 2


def test_another_mcs_is_another_coordinate_system() -> None:
    text = "MCS/1,0,0, $\n0,1,0, $\n0,0,1, $\n0,0,0\nRAPID\nGOTO/1,2,3\n"
    moves_of(text + text)
    with pytest.raises(ProgramError, match="the coordinate system changes"):
        moves_of(text + text.replace("0,0,1, $", "0,0.6,0.8, $"))


def test_clear_ends_a_cycle_that_has_had_its_points() -> None:
    text = "RAPID\nGOTO/0,0,9\nFEDRAT/50\nCYCLE/INIT\nCYCLE/DRILL,DEPTH,5,CLEAR,2\n{}GOTO/4,0,0\n"
    text += "CYCLE/CLEAR\nRAPID\nGOTO/4,0,9\n"
    for clear in ("", "CYCLE/CLEAR\n"):
        found = [macro for macro, *_ in points_of(moves_of(text.format(clear)))]
        assert found == ["RAPID", "CYCLE_DRILL", "RAPID"]


def test_spindle_and_coolant_come_back_after_a_tool_change() -> None:
    text = "LOADTL/1\nSPINDL/RPM,900,CCLW\nCOOLNT/MIST\nRAPID\nGOTO/1,2,3\nLOADTL/2\n{}RAPID\nGOTO/4,5,6\n"

    def after(between: str) -> list[tuple[str, float | str | None]]:
        calls = calls_of(text.format(between))[0]
        changes = [place for place, (macro, _) in enumerate(calls) if macro == "TOOL_CHANGE"]
        return [(macro, words.get("S")) for macro, words in calls[changes[1] + 1 :]][:-2]

    assert after("") == [("SPINDLE_CCW", 900.0), ("COOLANT_MIST", None), ("RAPID", None)]
    assert after("SPINDL/RPM,1700,CLW\n") == [("SPINDLE_CW", 1700.0), ("COOLANT_MIST", None), ("RAPID", None)]
    assert after("SPINDL/OFF\nCOOLNT/OFF\n") == [
        ("SPINDLE_OFF", None),
        ("COOLANT_OFF", None),
        ("RAPID", None),
    ]


def test_a_highest_speed_is_not_lost() -> None:
    text = "SPINDL/RPM,180,CLW,MAXRPM,2600\n"
    assert calls_of(text)[0][2] == ("SPINDLE_CW", {"S": 180.0, "SPINDLEMODE": 97.0, "MAXRPM": 2600.0})
    found = [remark.text for remark in posted(text, control())[1].remarks]
    assert found == ["the highest speed is not written: SPINDLE_CW of the control file does not use MAXRPM"]
    clamped = control(macros={"SPINDLE_CW": "<R=MAXRPM>\nG50$R$"})
    blocks, summary = posted(text, clamped)
    assert "G50R2600.000" in blocks
    assert summary.remarks == ()


def test_a_highest_speed_that_would_be_lost_with_a_surface_speed_is_an_error() -> None:
    text = "SPINDL/SMM,180,CLW,MAXRPM,2600\n"
    without = control(macros={"SPINDLE_CW": "<R=SPINDLEMODE>\n$S$"})
    with pytest.raises(ProgramError, match="a highest speed of 2600 rpm, and SPINDLE_CW"):
        posted(text, without)
    clamped = control(macros={"SPINDLE_CW": "<R=SPINDLEMODE>\n<R=MAXRPM>\nG50$R$"})
    assert "G50R2600.000" in posted(text, clamped)[0]


@pytest.mark.parametrize(
    ("text", "macro"),
    [
        ("LOADTL/1\nCUTCOM/LEFT\n", "COMP_LEFT"),
        ("LOADTL/1\nCUTCOM/RIGHT\n", "COMP_RIGHT"),
        ("INSERT M71\n", "INSERT"),
        ("LOADTL/1\nLOADTL/2\n", "TOOL_CHANGE"),
    ],
)
def test_a_macro_without_which_another_part_would_be_cut_must_be_there(text: str, macro: str) -> None:
    with pytest.raises(ProgramError, match=f"the control file has no macro {macro}"):
        posted(text + "RAPID\nGOTO/1,2,3\n", control(macros={macro: ""}))
    assert "= here" in posted(text + "RAPID\nGOTO/1,2,3\n", control(macros={macro: '"= here"'}))[0]


def test_the_way_of_an_arc_is_as_long_as_it_turns() -> None:
    text = "GOTO/30,-3.5,-2\nCIRCLE/30,0,-2,0,0,-1,3.5\nGOTO/26.5,0,-2\n"
    (quarter,) = [s for s in sweep_tool_path(parse_tool_path(text)) if s.angle]
    (rest,) = [s for s in sweep_tool_path(parse_tool_path("PAINT/PATH\n" + text)) if s.angle]
    assert (quarter.angle, rest.angle) == pytest.approx((0.5 * math.pi, 1.5 * math.pi))


# --- work offsets, coordinate systems, tools that nothing loads

FRAMES = {
    "NX": ("MSYS/0,0,0,1,0,0,0,1,0\n", "MSYS/0,0,0.5,1,0,0,0,1,0\n", "MSYS/0,0,0,1,0,0,0,0,1\n"),
    "Creo": (
        "$$-> CSYS / 1,0,0,0, $\n 0,1,0,0, $\n 0,0,1,0\n",
        "$$-> CSYS / 1,0,0,0, $\n 0,0,1,0, $\n 0,-1,0,0\n",
        "$$-> CSYS / 1,0,0,0, $\n 0,1,0,0, $\n 0,0,1,7\n",
    ),
    "CATIA": tuple(
        f"$$*CATIA0\n$$ Program.{z}\n$$ 1.0 0.0 0.0 0.0\n$$ 0.0 1.0 0.0 0.0\n$$ 0.0 0.0 1.0 {z}\n"
        for z in ("0.0", "12.5", "-3.0")
    ),
}
AWAY = "RAPID\nGOTO/4,5,30\nRAPID\nGOTO/4,5,2\nFEDRAT/200,MMPM\nGOTO/4,5,-1\nRAPID\nGOTO/4,5,30\n"


@pytest.mark.parametrize("system", FRAMES)
def test_another_coordinate_system_is_an_error_or_another_work_offset(system: str) -> None:
    first, second, third = FRAMES[system]
    text = "LOADTL/3\n" + first + AWAY + first + AWAY + second + AWAY + third + AWAY + first + AWAY
    shipped = shipped_text("fanuc-mill")
    with pytest.raises(ProgramError, match="the coordinate system changes within the tool path") as caught:
        post_file(parse_tool_path(text), "fanuc-mill")
    assert "coordinate_systems" in caught.value.hint
    several = shipped.replace("[parameters]", '[parameters]\ncoordinate_systems = "work_offsets"')
    result = post_file(parse_tool_path(text), parse_control(several, "mine.toml"), verify=True)
    assert result.ok
    assert result.text is not None
    blocks = result.text.splitlines()
    assert [block for block in blocks if block in ("G54", "G55", "G56", "G57")] == [
        "G54",
        "G55",
        "G56",
        "G54",
    ]
    at = blocks.index("G55")
    # Z goes home before, X and Y come first after, then Z with the tool's length.
    assert blocks[at - 2 : at + 4] == ["G91 G28 Z0.", "G90 G49", "G55", "G00 X4. Y5.", "G43 H03 Z30.", "Z2."]
    only_one = "LOADTL/3\n" + first + AWAY + first + AWAY
    assert "G55" not in (post_file(parse_tool_path(only_one), "fanuc-mill").text or "")


@pytest.mark.parametrize(
    ("name", "code"),
    [
        *(("fanuc-mill", "G59"), ("haas-mill", "G59"), ("bosch-pnc", "G59"), ("fanuc-5axis", "G59")),
        ("bosch-pnc-cpl", "G59"),
    ],
)
def test_a_work_offset_of_the_tool_path_is_written_and_proven(name: str, code: str) -> None:
    text = "LOADTL/3,LENGTH,80\n" + AWAY + "CUTCOM/ADJUST,6\n" + AWAY + "CUTCOM/ADJUST,1\n" + AWAY + "FINI\n"
    result = post_file(parse_tool_path(text), name, verify=True)
    assert result.ok, result.verification
    found = re.findall(r"G5[4-9]", result.text or "")
    assert found == ["G54", code, "G54"]


def test_many_work_offsets_have_numbers_of_their_own() -> None:
    text = "LOADTL/3\nCUTCOM/ADJUST,9\n" + AWAY
    assert "G54.1 P3\n" in (post_file(parse_tool_path(text), "fanuc-mill", verify=True).text or "")
    assert "G154 P3\n" in (post_file(parse_tool_path(text), "haas-mill").text or "")
    with pytest.raises(
        ProgramError, match="WORK_OFFSET of the control file writes nothing for work offset 9"
    ):
        post_file(parse_tool_path(text), "bosch-pnc")
    with pytest.raises(
        ProgramError, match="work offset 9, and no macro of the control file writes WORKOFFSET"
    ):
        post_file(parse_tool_path(text), "din")


LATHE = """TOOLNO/7,TURN
TPRINT/DNMG
FEDRAT/ 0.4000,MMPR
SPINDL/ 700.0000,RPM
RAPID
GOTO / 30.00000, 0.00000, 2.50000
GOTO / 30.00000, 0.00000, -49.50000
TOOLNO/7,TURN
RAPID
GOTO / 34.00000, 0.00000, 2.50000
TOOLNO/8,TURN
LOADTL/8,1
SPINDL/ 500.0000,RPM
RAPID
GOTO / 31.00000, 0.00000, 2.50000
"""


def test_a_tool_that_is_only_described_is_loaded_before_it_moves() -> None:
    """CATIA writes lathe paths without LOADTL where its table has none; the turret goes home before it turns."""
    result = post_file(parse_tool_path(LATHE), "fanuc-lathe", verify=True)
    assert result.ok
    blocks = (result.text or "").splitlines()
    changes = [at for at, block in enumerate(blocks) if re.search(r"T0\d0\d", block)]
    assert [blocks[at].split()[-1] for at in changes] == ["T0707", "T0808"]
    for at in changes:
        assert blocks[at - 2 : at] == ["G28 U0.", "G28 W0."]
        assert blocks[at + 1].startswith(("G97 S", "S"))
        assert blocks[at + 1].endswith("M03")
    assert result.summary.tools == 2
    mill = "TOOLNO/4,MILL,1,0,10\nSPINDL/900,RPM,CLW\nLOADTL/4,1,1\n" + AWAY
    assert post_file(parse_tool_path(mill), "fanuc-mill").summary.tools == 1
    points = "TOOLNO/4,MILL,1,0,10\nFEDRAT/90,MMPM\n" + "".join(f"GOTO/{n},2,3\n" for n in range(20))
    assert (post_file(parse_tool_path(points), "fanuc-mill").text or "").count("T04 M06") == 1


def test_a_surface_speed_without_a_highest_speed_is_remarked() -> None:
    path = "LOADTL/1\nSPINDL/{},CLW\nRAPID\nGOTO/30,0,2\n"
    for words, expected in (("180,SMM", True), ("180,SMM,MAXRPM,2500", False), ("600,RPM", False)):
        remarks = post_file(parse_tool_path(path.format(words)), "fanuc-lathe").summary.remarks
        assert any("nothing limits the spindle" in each.text for each in remarks) == expected


def test_behind_multax_off_the_tool_axis_is_known_where_it_is_said() -> None:
    text = "TLAXIS/0,0.6,0.8\nMULTAX/OFF\nTLAXIS/0,0,1\nGOTO/1,2,9\nMULTAX/OFF\nGOTO/3,2,9,0,0.6,0.8\nMULTAX/ON\n"
    assert [type(each) for each in records(text + "GOTO/4,5,6\n" * 9)][:4] == [Axis, Axis, Goto, Goto]


# --- what the shipped control files write at holes

WITH_CYCLES = ("fanuc-mill", "haas-mill", "linuxcnc-mill", "fanuc-5axis", "bosch-pnc", "bosch-pnc-cpl")
TWO_HOLES = """LOADTL/4,LENGTH,70
SPINDL/RPM,640,{sense}
RAPID
GOTO/10,10,30
CYCLE/{cycle},CLEAR,3
GOTO/10,10,0
GOTO/30,10,0
CYCLE/OFF
FEDRAT/150,MMPM
GOTO/40,10,3
"""
HOLE_KINDS = ("DRILL", "DRILL,DWELL,0.5", "DEEP,STEP,4", "BRKCHP,STEP,4", "BORE")


@pytest.mark.parametrize("kind", HOLE_KINDS)
@pytest.mark.parametrize("name", WITH_CYCLES)
def test_a_cycle_with_a_feed_per_revolution_takes_the_time_of_that_feed(name: str, kind: str) -> None:
    """0.25 mm a turn at 640 rpm are 160 mm/min; what follows is per minute again."""
    seconds = []
    for feed in ("MMPR,0.25", "MMPM,160"):
        path = TWO_HOLES.format(sense="CLW", cycle=f"{kind},DEPTH,12,{feed}")
        result = post_file(parse_tool_path(path), name, verify=True)
        assert result.verification is not None
        assert result.ok
        seconds.append(result.verification.run.time_s)
    assert seconds[0] == pytest.approx(seconds[1], abs=0.02)
    assert seconds[0] > 10.0


@pytest.mark.parametrize("name", ["fanuc-mill", "haas-mill", "fanuc-5axis"])
@pytest.mark.parametrize(("sense", "code"), [("CLW", "G84"), ("CCLW", "G74")])
@pytest.mark.parametrize("back", ["", ",RTRCTO,AUTO"])
def test_a_left_hand_thread_is_tapped_left_handed(name: str, sense: str, code: str, back: str) -> None:
    result = post_file(
        parse_tool_path(TWO_HOLES.format(sense=sense, cycle=f"TAP,DEPTH,12,MMPR,1.25{back}")),
        name,
        verify=True,
    )
    assert result.ok
    assert re.findall(r"G[78]4", result.text or "") == [code]
    assert f"{'G98' if back else 'G99'} {code} X10. Y10. Z-12. R3. F800." in (result.text or "")


def test_rapids_before_the_first_tool_change_are_left_out() -> None:
    # CATIA goes to where tools are changed; the tool in the spindle is one of which nothing is known.
    text = "COOLNT/ON\nRAPID\nGOTO/0,0,90\nRAPID\nGOTO/1,0,91\nCUTTER/8\nLOADTL/2\nRAPID\nGOTO/1,2,3\n"
    path = parse_tool_path(text)
    assert [record for record in path if not isinstance(record, ToolShape)] == [
        Coolant(1, "flood"),
        Tool(7, 2),
        Rapid(8),
        Goto(9, 1.0, 2.0, 3.0),
    ]
    assert [(remark.line, remark.count) for remark in path.remarks.all()] == [(3, 2)]


@pytest.mark.parametrize(
    "between", ["GOTO/2,0,90\n", "SPINDL/RPM,500,CLW\n", "CYCLE/DRILL,DEPTH,5,CLEAR,2\n"]
)
def test_rapids_before_work_without_a_tool_change_stay(between: str) -> None:
    text = f"FEDRAT/90\nRAPID\nGOTO/0,0,90\nRAPID\nGOTO/1,0,91\n{between}LOADTL/2\nRAPID\nGOTO/1,2,3\n"
    path = parse_tool_path(text)
    assert [record.line for record in path if isinstance(record, Goto)][:2] == [3, 5]
    assert path.remarks.all() == []
    assert [record.line for record in parse_tool_path("RAPID\nGOTO/0,0,90\n")] == [1, 2]


WORLD = "TRNTYP/WORLD,0,0,0\nLOADTL/3\n"
CSYS = "CSYS/1,0,0,{},0,1,0,{},0,0,1,0\n"


def test_points_after_trntyp_world_count_from_the_world_whatever_csys_come() -> None:
    text = WORLD + CSYS.format(0, 0) + AWAY + CSYS.format(50, 20) + AWAY.replace("4,5,", "54,25,") + "END\n"
    results = []
    for systems in ("one", "work_offsets"):
        shipped = shipped_text("fanuc-mill")
        mine = shipped.replace("[parameters]", f'[parameters]\ncoordinate_systems = "{systems}"')
        result = post_file(parse_tool_path(text), parse_control(mine, "mine.toml"), verify=True)
        assert result.ok
        assert [remark.line for remark in result.summary.remarks] == [12]
        results.append(result.text)
    assert results[0] == results[1]
    blocks = (results[0] or "").splitlines()
    assert "G55" not in blocks
    assert "X54. Y25." in (results[0] or "")


@pytest.mark.parametrize(
    "text",
    [
        WORLD + "CSYS/1,0,0,0,0,0,-1,0,0,1,0,0\n" + AWAY,
        "CSYS/1,0,0,0,0,0,-1,0,0,1,0,0\n" + WORLD + AWAY,
        WORLD + CSYS.format(0, 0) + AWAY + "CSYS/1,0,0,0,0,-1,0,0,0,0,-1,0\n" + AWAY,
    ],
)
def test_a_set_up_that_leans_against_the_world_is_refused(text: str) -> None:
    with pytest.raises(ProgramError, match="leans against the world"):
        post_file(parse_tool_path(text), "fanuc-mill")


@pytest.mark.parametrize("note", ["5MM CRB 4FL 16 LOC", "STOP change fixture", "TURN PART OVER"])
def test_words_that_no_control_reads_are_a_comment_with_a_remark(note: str) -> None:
    result = post_file(parse_tool_path(f"LOADTL/3\nINSERT/{note}\n" + AWAY), "fanuc-mill", verify=True)
    assert result.ok
    assert f"({note.upper()})" in (result.text or "").upper()
    assert [remark.line for remark in result.summary.remarks] == [2]


@pytest.mark.parametrize(
    "block", ["M77", "G91 G28 Z0.", "#100=5", "GOTO 10", "IF[#1EQ0]GOTO5", "5 A%=1", "M30 END OF PART"]
)
def test_blocks_of_a_control_stay_blocks(block: str) -> None:
    assert records(f"INSERT {block}\n") == [Text(1, "insert", block)]


@pytest.mark.parametrize("words", ["", "RAPID\nGOTO/3,0,-1\n"])
def test_a_feed_per_revolution_that_a_control_file_cannot_say_is_an_error(words: str) -> None:
    text = "LOADTL/1\nSPINDL/RPM,900,CLW\nFEDRAT/90,MMPM\nGOTO/0,0,-1\nGOTO/1,0,-1\nFEDRAT/0.1,MMPR\n"
    with pytest.raises(ProgramError, match="a feed per revolution, and no macro"):
        post_file(parse_tool_path(text + words + "GOTO/9,0,-1\nGOTO/9,9,-1\n"), "grbl")


@pytest.mark.parametrize(
    ("statement", "line", "what", "hint"),
    [
        ("ROTABL/30,INCR", 8, "ROTABL moves the tool or its coordinates", "write points with the tool axis"),
        (
            "CYCLE/DEEP,DEPTH,12,CLEAR,2",
            8,
            "pecks that does not say how deep they are",
            "Write STEP and a length.",
        ),
        (
            "TLAXIS/0,0,-1",
            9,
            "the tool is tilted, and the control file has no rotary axes",
            "keep the tool axis 0, 0, 1",
        ),
    ],
)
def test_what_a_mill_cannot_do_is_refused_at_its_line(
    statement: str, line: int, what: str, hint: str
) -> None:
    text = HOLES.split("CYCLE")[0] + f"RAPID\nGOTO/1,2,3\nFEDRAT/90\nGOTO/1,2,-3\n{statement}\nGOTO/4,5,-3\n"
    place = text[: text.index(statement)].count("\n") + 1
    with pytest.raises(ProgramError) as error:
        post_file(parse_tool_path(text), "fanuc-mill")
    assert what in error.value.what
    assert hint in (error.value.hint or "")
    assert error.value.position is not None
    assert error.value.position.line == place + line - 8
