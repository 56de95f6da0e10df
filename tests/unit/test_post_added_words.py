"""Additions to the manual's events and words: records that no event takes, and what holds in every macro."""

from __future__ import annotations

import json

import pytest

from polycnc.errors import ConfigurationError, ProgramError
from polycnc.post import parse_control, parse_tool_path
from polycnc.post.tool_path._records import Word
from support.post_controls import control, control_text, posted

STATES = '"S"$SPINDLESTATE$" C"$COOLANTSTATE$" N"$NEXTTOOL$" M"$FIRSTMOTION$" W"$WORKOFFSET$'


def told(text: str, macro: str, shown: str = STATES) -> list[str]:
    """Return what a macro writes of the words that hold everywhere."""
    blocks, _ = posted(text, control(macros={macro: f'"= "{shown}'}))
    return [block[2:] for block in blocks if block.startswith("= ")]


def written(text: str, macros: dict[str, str], strict: bool = False) -> tuple[list[str], list[str]]:
    """Return the blocks that begin with a mark, and the remarks."""
    used = control({"strict": strict} if strict else {}, macros)
    blocks, summary = posted(text, used)
    return [block[2:] for block in blocks if block.startswith("= ")], [each.text for each in summary.remarks]


def test_a_record_that_is_not_known_is_read_as_it_stands() -> None:
    assert list(parse_tool_path("auxfun / 17, ON ,2.5\nPREFUN\nGOTO/1,2,3\n"))[:2] == [
        Word(1, "AUXFUN", "ON", (17.0, 2.5), "17, ON ,2.5"),
        Word(2, "PREFUN", "", (), ""),
    ]


def test_such_a_record_calls_its_macro_with_name_and_numbers() -> None:
    macros = {"WORD": '"= "$WORD$" "$NUMBERS$" "$NUMBER1$" "$NUMBER2$" "$NUMBER9$" "$WORDTEXT$'}
    text = "AUXFUN/17,2.5\nCLAMP/ON\nFOO/11,12,13,14,15,16,17,18,19,20\nGOTO/1,2,3\n"
    assert written("FEDRAT/5,MMPM\n" + text, macros) == (
        [
            "AUXFUN 2 17 2.5 0 17,2.5",
            "CLAMP 0 0 0 0 ON",  # nothing is left of the numbers before
            "FOO 10 11 12 19 11,12,13,14,15,16,17,18,19,20",
        ],
        [],
    )


def test_the_narrowest_macro_takes_the_record() -> None:
    macros = {
        "WORD": '"= any "$WORD$',
        "WORD_OPSKIP": '"= skip"',
        "WORD_OPSKIP_ON": '"= on"\n<STARTOFLINE="/">',
        "WORD_OPSKIP_OFF": '<STARTOFLINE="">\n"= off"',
        "WORD_PREFUN": '<N=NUMBER1>\nIF(N==61)\n"= G61"\nELSE\n"= other"\nENDIF',
    }
    text = "OPSKIP/ON\nAUXFUN/1\nOPSKIP/OFF\nOPSKIP/3\nPREFUN/61\nPREFUN/64\nRAPID\nGOTO/1,2,3\n"
    blocks, _ = posted(text, control(macros=macros))
    assert blocks[3:-2] == ["= on", "/= any AUXFUN", "= off", "= skip", "= G61", "= other"]


def test_without_such_a_macro_it_is_remarked() -> None:
    assert written("SPINDL/OFF\nCOOLNT/OFF\nCLAMP/ON\nCLAMP/OFF\n", {"WORD_AUXFUN": '"= "'})[1] == [
        "CLAMP is not known and was left out"
    ]


NEEDED = {
    "AUXFUN/17": "AUXFUN/17 is an M code",
    "PREFUN/68": "PREFUN/68 is a G code",
    "OPSKIP/ON": "OPSKIP/ON says which blocks",
    "SYNC/3": "SYNC/3 waits for another channel",
    "CHANNEL/1\nCHANNEL/2": "CHANNEL/2 goes to another channel",
    "HEAD/1\nHEAD/ 2": "HEAD/2 goes to another head",
    "SWITCH/9\nRAPID\nGOTO/1,1,1\nSWITCH/3": "SWITCH/3 takes another point of the tool",
}


@pytest.mark.parametrize("text", NEEDED)
def test_what_would_change_the_part_needs_a_macro(text: str) -> None:
    path = f"{text}\nRAPID\nGOTO/1,2,3\n"
    with pytest.raises(ProgramError) as caught:
        posted(path)
    assert NEEDED[text] in caught.value.what
    assert "WORD_" in caught.value.hint
    word = text.rpartition("\n")[2].partition("/")[0]
    blocks, summary = posted(path, control(macros={f"WORD_{word}": '"= "$WORDTEXT$'}))
    assert f"= {text.rpartition('/')[2].strip()}" in [block.replace("=  ", "= ") for block in blocks]
    assert summary.remarks == ()


def test_what_says_what_holds_anyway_is_remarked() -> None:
    text = "OPSKIP/OFF\nCHANNEL/1\nSWITCH/9\nRAPID\nGOTO/1,2,3\nCHANNEL/ 1\nLOADTL/2\nSWITCH/7\nGOTO/1,2,4\n"
    _, summary = posted(text.replace("GOTO/1,2,4", "RAPID\nGOTO/1,2,4"))
    names = [remark.text.partition(" ")[0] for remark in summary.remarks]
    assert names == ["OPSKIP", "CHANNEL", "SWITCH"]


def test_a_record_that_moves_stays_an_error_whatever_macros_there_are() -> None:
    with pytest.raises(ProgramError, match="TRACUT moves the tool"):
        posted("TRACUT/1,0,0,5\nGOTO/1,2,3\n", control(macros={"WORD_TRACUT": "X", "WORD": "Y"}))


def test_the_cycle_of_the_control_is_cancelled_before_it_and_called_again() -> None:
    text = "FEDRAT/90,MMPM\nCYCLE/DRILL,DEPTH,5,CLEAR,2\nGOTO/1,2,0\nAUXFUN/17\nGOTO/4,2,0\n"
    blocks, _ = posted(text, control(macros={"WORD_AUXFUN": '"M"$NUMBER1$'}))
    place = blocks.index("M17")
    assert blocks[place - 1].startswith("G80")
    assert "G81" in "".join(blocks[place + 1 : place + 4])


def test_what_the_tool_path_has_switched() -> None:
    text = (
        "LOADTL/3\nSPINDL/RPM,900,CCLW\nCOOLNT/MIST\nFEDRAT/90,MMPM\nRAPID\nGOTO/1,2,3\nGOTO/4,2,3\n"
        "COOLNT/THRU\nLOADTL/12\nSPINDL/OFF\nGOTO/7,2,3\n"
    )
    assert told(text, "LINEAR") == ["S4 C7 N12 M0 W1", "S5 C88 N0 M2 W1"]
    assert told(text, "RAPID") == ["S4 C7 N12 M2 W1"]
    assert told(text, "TOOL_CHANGE") == ["S5 C9 N12 M2 W1", "S4 C88 N0 M2 W1"]
    assert told(text, "PROGRAM_START") == ["S5 C9 N3 M2 W1"]
    assert told(text, "SPINDLE_CCW") == ["S4 C9 N12 M2 W1"]


def test_what_the_spindle_does_next_is_known_beside_the_next_tool() -> None:
    text = (
        "LOADTL/3\nSPINDL/RPM,900,CCLW\nFEDRAT/90,MMPM\nGOTO/1,2,3\nLOADTL/12\nSPINDL/OFF\nSPINDL/1700,CLW\n"
        "GOTO/7,2,3\nSPINDL/ON\nSPINDL/80,SMM,CLW\nGOTO/8,2,3\nEND\n"
    )
    coming = '$NEXTTOOL$" "$NEXTSPINDLE$" "$NEXTSPINDLESTATE$'
    spindle = {f"SPINDLE_{sense}": "<N=SPINDLEMODE>!M03!" for sense in ("CW", "CCW")}

    def shown(macro: str) -> list[str]:
        return written(text, {**spindle, macro: f'<N=SPINDLEMODE>"= "{coming}'})[0]

    assert shown("PROGRAM_START") == ["3 900 4"]
    assert shown("TOOL_CHANGE") == ["12 900 4", "0 1700 3"]
    assert shown("SPINDLE_CCW") == ["12 1700 3"]
    assert shown("SPINDLE_CW") == ["0 1700 3", "0 0 3", "0 0 5"]  # a surface speed is no speed in rpm
    assert shown("LINEAR") == ["12 1700 3", "0 1700 3", "0 0 5"]


def test_first_motions_of_program_operation_and_tool() -> None:
    text = (
        "FEDRAT/90,MMPM\nTOOL PATH/A\nLOADTL/3\nGOTO/1,2,3\nGOTO/4,2,3\nEND-OF-PATH\nTOOL PATH/B\nGOTO/5,2,3\n"
        "GOTO/6,2,3\nEND-OF-PATH\nTOOL PATH/C\nLOADTL/5\nGOTO/6,2,3\nCYCLE/DRILL,DEPTH,5,CLEAR,2\nGOTO/1,2,0\n"
    )
    assert told(text, "LINEAR", "$FIRSTMOTION$") == ["2", "0", "1", "0", "2"]
    hole = text.replace("GOTO/6,2,3\nCYCLE", "CYCLE")
    assert told(hole, "CYCLE_DRILL", "$FIRSTMOTION$") == ["2"]
    arc = "FROM/0,5,0\nFEDRAT/90,MMPM\nCIRCLE/0,0,0,0,0,1,5\nGOTO/-5,0,0\nGOTO/-9,0,0\n"
    assert told(arc, "ARC_CCW", "$FIRSTMOTION$") == ["2"]
    assert told(arc, "LINEAR", "$FIRSTMOTION$") == ["0"]


def offsets(first: int | None, second: int | None) -> str:
    """Return a tool path whose operations name work offsets."""
    one, two = ({} if n is None else {"work_offset": n} for n in (first, second))
    point = [13.5, -7.25, 4]
    path = [
        {"do": "feed", "feed": 300},
        {"do": "operation", "name": "A", **one},
        {"do": "rapid", "to": point},
        {"do": "line", "to": point[:2] + [-3]},
        {"do": "operation", "name": "B", **two},
        {"do": "rapid", "to": point[:2] + [-3]},
    ]
    return json.dumps({"path": path})


def test_a_work_offset_is_in_path_start_and_moves_are_written_anew() -> None:
    macros = {"PATH_START": '"= G5"$WORKOFFSET$', "RAPID": '"= "$FIRSTMOTION$!-G00!$X$$Y$$Z$'}
    assert written(offsets(3, 4), macros)[0] == [
        "G53",
        "2G00X13.500Y-7.250Z4.000",
        "G54",
        "2G00X13.500Y-7.250Z-3.000",  # at the same numbers, but elsewhere
    ]
    assert written(offsets(3, None), macros)[0][2:] == ["G53"]


def test_a_work_offset_that_no_macro_writes_is_an_error() -> None:
    with pytest.raises(
        ProgramError, match="work offset 4, and no macro of the control file writes WORKOFFSET"
    ):
        posted(offsets(None, 4), control())
    assert posted(offsets(None, 1), control())[0]


@pytest.mark.parametrize(
    "name", ["SPINDLESTATE", "NEXTTOOL", "NEXTSPINDLE", "FIRSTMOTION", "NUMBER1", "WORKOFFSET"]
)
def test_a_macro_cannot_set_what_events_keep(name: str) -> None:
    with pytest.raises(ConfigurationError, match=f"{name} is set by events, not by macros"):
        control(macros={"STOP": f"<{name}=5>!M00!"})
    blocks, _ = posted("STOP\n", control({"strict": True}, {"STOP": f"<{name}=5><T={name}>$T$!M00!"}))
    assert "T5M00" in blocks


def test_additions_are_formatted_by_a_function_variable_of_their_name() -> None:
    text = control_text(macros={"TOOL_CHANGE": "$NEXTTOOL$!M06!"})
    text = text.replace("[nc_macros]", '[function_variables.NEXTTOOL]\nformat = "T%02d"\n[nc_macros]', 1)
    blocks, _ = posted("LOADTL/4\nLOADTL/7\n", parse_control(text))
    assert [block for block in blocks if "M06" in block] == ["T07M06", "T00M06"]


@pytest.mark.parametrize("macro", ["WORD", "WORD_AUXFUN", "WORD_OPSKIP_ON"])
def test_a_strict_control_file_has_no_added_events(macro: str) -> None:
    assert macro in control_text(macros={macro: "X"})
    control(macros={macro: "X"})
    with pytest.raises(ConfigurationError, match=f"the event of '{macro}' is an addition to the manual's"):
        control({"strict": True}, {macro: "X"})


@pytest.mark.parametrize("macro", ["WORD_", "WORD_A_B_C", "WORDY", "WORD_a", "WORD_1"])
def test_a_macro_that_no_record_can_call_is_refused(macro: str) -> None:
    with pytest.raises(ConfigurationError, match=f"no event calls a macro '{macro}'"):
        control(macros={macro: "X"})


@pytest.mark.parametrize("word", ["MAXRPM", "SPINDLESTATE", "COOLANTSTATE", "NUMBERS", "WORD", "WORDTEXT"])
def test_a_strict_control_file_has_no_added_words(word: str) -> None:
    with pytest.raises(ConfigurationError, match=f"there is no word {word}"):
        control({"strict": True}, {"STOP": f"${word}$!M00!"})


def test_names_of_additions_are_free_in_a_strict_control_file() -> None:
    macros = {
        "PROGRAM_START": "<MAXRPM=4321><FIRSTMOTION=77><WORD=5>",
        "STOP": "<S=MAXRPM+FIRSTMOTION+WORD>$S$!M00!",
    }
    text = "SPINDL/RPM,180,CLW,MAXRPM,2600\nGOTO/1,2,3\nSTOP\n".replace("GOTO", "RAPID\nGOTO")
    blocks, summary = posted(text, control({"strict": True}, macros))
    assert "S4403M00" in blocks
    assert [each.text for each in summary.remarks] == [
        "the highest speed is not written: SPINDLE_CW of the control file does not use MAXRPM"
    ]


@pytest.mark.parametrize(
    ("condition", "said"),
    [
        ("TOOLNAME==1", "TOOLNAME is a text"),
        ("WORD==AUXFUN", "WORD is a text"),
        ('TOOLNAME=="MILL"', "has no meaning here"),
    ],
)
def test_if_compares_numbers_only(condition: str, said: str) -> None:
    with pytest.raises(ConfigurationError, match=said):
        control(macros={"STOP": f"IF({condition})\n!M00!\nENDIF"})
