"""Which macro each event of a tool path calls, with which words: the table holds for every event."""

from __future__ import annotations

from typing import Any

import pytest

from polycnc.errors import ProgramError
from polycnc.post.macros._events import EVENTS, MACROS, STATES, WORDS, words_of
from support.post_controls import control, posted
from support.post_recorder import calls_of, points_of

EVERYTHING = """PARTNO PLATE (A)
MACHIN/MILL7,1
TOOL PATH/FIRST,TOOL,CUTTER_10
TLDATA/MILL,10,0,75
LOADTL/3,LENGTH,80,ADJUST,13,CUTCOM,23
SPINDL/RPM,1200,CLW
COOLNT/FLOOD
FROM/0,0,100
RAPID
GOTO/0,0,10
FEDRAT/300,MMPM
CUTCOM/LEFT
GOTO/10,0,0
CIRCLE/10,5,0,0,0,1,5
GOTO/15,5,0
CIRCLE/10,5,0,0,0,-1,5
GOTO/10,0,0
CUTCOM/RIGHT,9
CUTCOM/OFF
CUTCOM/ADJUST,2
RAPID
GOTO/10,0,0
COOLNT/MIST
COOLNT/THRU
CYCLE/DRILL,DEPTH,5,CLEAR,2
GOTO/20,0,0
CYCLE/DRILL,DEPTH,5,CLEAR,2,DWELL,1
GOTO/20,0,0
CYCLE/DEEP,DEPTH,5,STEP,2,CLEAR,2
GOTO/20,0,0
CYCLE/BRKCHP,DEPTH,5,STEP,2,CLEAR,2
GOTO/20,0,0
CYCLE/TAP,DEPTH,5,MMPR,1.25,CLEAR,2
GOTO/20,0,0
CYCLE/BORE,DEPTH,5,CLEAR,2
GOTO/20,0,0
CYCLE/OFF
PITCH/LEAD,1.25
THREAD/TURN
GOTO/20,0,-3
THREAD/OFF
DELAY/2
DELAY/5,REV
PPRINT now (look)
INSERT M123 (as it is)
STOP
OPSTOP
AUXFUN/17
SPINDL/CCLW,600
SPINDL/OFF
COOLNT/OFF
FINI
GOTO/99,99,99
"""


def words(text: str, macro: str, **parameters: Any) -> dict[str, float | str]:
    """Return the words of the first call of a macro."""
    return next(words for name, words in calls_of(text, **parameters)[0] if name == macro)


def test_every_event_calls_its_macro_with_the_words_of_the_table() -> None:
    calls, summary = calls_of(EVERYTHING)
    assert {macro for macro, _ in calls} == MACROS
    for macro, given in calls:
        wanted = set(words_of(macro))
        rotary = {"A", "B", "C", "TOOLI", "TOOLJ", "TOOLK"}
        assert wanted - rotary - {"Q", "P", "PITCH", "S"} <= set(given) <= wanted | {"P", "Q"}, macro
    assert (summary.records, summary.tools, summary.arcs, summary.holes) == (50, 1, 2, 6)


def test_the_table_names_each_word_and_event_once() -> None:
    names = [word.name for word in WORDS]
    everywhere = [word.name for word in STATES]
    assert len({*names, *everywhere}) == len(names) + len(everywhere)
    assert len(EVENTS) == len(MACROS)
    used = {word for event in EVENTS for word in event.words}
    assert used == set(names)
    assert all(event.when for event in EVENTS)
    assert all(word.meaning for word in WORDS)


def test_the_order_of_events() -> None:
    text = "PARTNO A\nTOOL PATH/ONE\nLOADTL/1\nEND-OF-PATH\nTOOL PATH/TWO\nSTOP\nFINI\n"
    order = [
        (macro, given.get("PATHNAME"), given.get("PATHNUMBER"))
        for macro, given in calls_of(text)[0]
    ]  # fmt: skip
    assert order == [
        ("PROGRAM_START", None, None),
        ("PATH_START", "ONE", 1.0),
        ("TOOL_CHANGE", None, None),
        ("PATH_END", "ONE", 1.0),
        ("PATH_START", "TWO", 2.0),
        ("STOP", None, None),
        ("PATH_END", "TWO", 2.0),
        ("PROGRAM_END", None, None),
    ]


def test_a_tool_path_without_operations_is_one() -> None:
    assert [macro for macro, _ in calls_of("STOP\n")[0]] == [
        *("PROGRAM_START", "PATH_START", "STOP", "PATH_END", "PROGRAM_END")
    ]
    assert [macro for macro, _ in calls_of("PARTNO A\n")[0]] == ["PROGRAM_START", "PROGRAM_END"]


def test_texts_of_the_program() -> None:
    given = words(EVERYTHING, "PROGRAM_START")
    assert given == {"PARTNAME": "PLATE [A]", "MACHINENAME": "MILL7", "UNITS": 21.0}
    assert words(EVERYTHING, "PROGRAM_START", units="inch")["UNITS"] == 20.0
    assert words(EVERYTHING, "COMMENT") == {"COMMENT": "now [look]"}
    assert words(EVERYTHING, "INSERT") == {"COMMENT": "M123 (as it is)"}


def test_words_of_a_tool_change() -> None:
    assert words(EVERYTHING, "TOOL_CHANGE") == {
        "T": 3.0, "TOOLCHANGE": "T3", "TOOLNAME": "CUTTER_10", "TOOLDIAMETER": 10.0, "TOOLLENGTH": 80.0,
        "H": 13.0, "D": 23.0,
    }  # fmt: skip
    assert words("LOADTL/4\n", "TOOL_CHANGE")["H"] == 4.0
    assert words("LOADTL/4\n", "TOOL_CHANGE")["D"] == 4.0
    inch = words(EVERYTHING, "TOOL_CHANGE", units="inch")
    assert inch["TOOLDIAMETER"] == pytest.approx(10.0 / 25.4)
    assert words(EVERYTHING, "COMP_LEFT") == {"D": 3.0}
    assert words(EVERYTHING, "COMP_RIGHT") == {"D": 9.0}


@pytest.mark.covers("post.word.TOOLCHANGE")
def test_toolchange_is_the_tool_number_as_the_control_writes_it() -> None:
    used = control({"sequence_place": 2}, {"TOOL_CHANGE": "@1@!M06!$TOOLCHANGE$"})
    blocks, _ = posted("LOADTL/3\nLOADTL/12\n", used)
    assert [block for block in blocks if "M06" in block] == ["N10M06T3", "N20M06T12"]


def test_words_of_the_spindle() -> None:
    assert words(EVERYTHING, "SPINDLE_CW") == {"S": 1200.0, "SPINDLEMODE": 97.0, "MAXRPM": 0.0}
    assert words(EVERYTHING, "SPINDLE_CCW") == {"S": 600.0, "SPINDLEMODE": 97.0, "MAXRPM": 0.0}
    again = calls_of("SPINDL/RPM,500,CCLW\nSPINDL/OFF\nSPINDL/ON\n")[0][2:5]
    assert [macro for macro, _ in again] == ["SPINDLE_CCW", "SPINDLE_OFF", "SPINDLE_CCW"]
    assert again[2][1]["S"] == 500.0
    assert words("SPINDL/SMM,180,CLW\n", "SPINDLE_CW") == {"S": 180.0, "SPINDLEMODE": 96.0, "MAXRPM": 0.0}
    assert words("SPINDL/SFM,600,CLW\n", "SPINDLE_CW")["S"] == pytest.approx(182.88)
    assert words("SPINDL/SFM,600,CLW\n", "SPINDLE_CW", units="inch")["S"] == pytest.approx(600.0)
    with pytest.raises(ProgramError, match="before its speed is known"):
        calls_of("SPINDL/ON\n")


def test_words_of_a_dwell() -> None:
    dwells = [given for macro, given in calls_of(EVERYTHING)[0] if macro == "DWELL"]
    assert dwells == [{"DWELL": 2.0, "DWELLREV": 0.0}, {"DWELL": 0.0, "DWELLREV": 5.0}]


def test_nothing_behind_fini_is_read() -> None:
    assert all(x != 99.0 for _, x, _, _ in points_of(calls_of(EVERYTHING)[0]))


def test_a_macro_that_is_missing_is_remarked() -> None:
    calls, summary = calls_of(EVERYTHING, ("COOLANT_MIST", "COMMENT", "PATH_START"))
    assert not {"COOLANT_MIST", "COMMENT", "PATH_START"} & {macro for macro, _ in calls}
    assert [(r.line, r.text) for r in summary.remarks] == [
        (23, "the control file has no macro COOLANT_MIST, so nothing was written")
    ]


@pytest.mark.parametrize("macro", ["RAPID", "LINEAR"])
def test_moves_need_their_macros(macro: str) -> None:
    with pytest.raises(ProgramError, match=f"the control file has no macro {macro}") as caught:
        calls_of(EVERYTHING, (macro,))
    assert caught.value.position is not None
    assert caught.value.position.text.startswith("GOTO")


@pytest.mark.covers(
    "post.concept.multi_path", "post.macro.tool_change", "post.code.modal_state", "post.word.F"
)
def test_modes_last_over_operations_unless_the_tool_change_initialises_them() -> None:
    path = "FEDRAT/300\nGOTO/{},0,0\n"
    text = path.format(1) + "END-OF-PATH\nTOOL PATH/B\nLOADTL/2\n" + path.format(2)
    kept, _ = posted(text, control(macros={"TOOL_CHANGE": "$T$!M06!"}))
    assert kept[-4:] == ["G01X1.000Y0.000Z0.000F300.000", "T2M06", "X2.000", "M30"]
    fresh, _ = posted(text, control(macros={"TOOL_CHANGE": "&F&\n$T$!M06!"}))
    assert fresh[-4:] == ["G01X1.000Y0.000Z0.000F300.000", "T2M06", "X2.000F300.000", "M30"]


@pytest.mark.covers("post.init.xyz", "post.concept.machining_origin")
def test_positions_begin_anew_at_the_machining_origin_behind_a_tool_change() -> None:
    macro = {"TOOL_CHANGE": "&Z&\n$T$!M06!$Z$"}
    text = "[parameters.machining_origin]\nZ = 150.0\n"
    from polycnc.post import parse_control
    from support.post_controls import control_text

    used = parse_control(control_text(macros=macro).replace("[g_code.G00]", f"{text}[g_code.G00]", 1))
    blocks, _ = posted("FEDRAT/300\nGOTO/1,2,3\nLOADTL/2\nGOTO/1,2,3\n", used)
    assert blocks[-3:-1] == ["T2M06Z150.000", "Z3.000"]


def test_a_tool_change_in_the_same_place_is_followed_by_its_position() -> None:
    text = "FEDRAT/300\nGOTO/1,2,3\nGOTO/1,2,3\nLOADTL/2\nGOTO/1,2,3\n"
    assert [macro for macro, _ in calls_of(text)[0]][2:5] == ["LINEAR", "TOOL_CHANGE", "LINEAR"]
