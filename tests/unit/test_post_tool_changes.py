"""What the shipped control files write round a tool change: the way to it, the first move after it, and the end."""

from __future__ import annotations

import pytest

from polycnc.errors import ProgramError
from polycnc.post import parse_control, parse_tool_path, shipped_text
from polycnc.runner import PostVerification, post_file

MILLS = ("fanuc-mill", "fanuc-5axis", "haas-mill", "linuxcnc-mill", "bosch-pnc", "bosch-pnc-cpl", "din")
HOME = {
    "fanuc-mill": ["M05", "G91 G28 Z0.", "G90 G49"],
    "fanuc-5axis": ["M05", "G91 G28 Z0.", "G90 G49 G00 A0. C0."],
    "haas-mill": ["M05", "G49 G00 G53 Z0."],
    "linuxcnc-mill": ["M05", "G49 G00 G53 Z0."],
    "fanuc-lathe": ["M05", "G28 U0.", "G28 W0."],
}


def blocks_of(text: str, name: str) -> tuple[list[str], PostVerification]:
    """Return the blocks of a tool path for a shipped control, without their numbers, and the proof."""
    done = post_file(parse_tool_path(text, "part.cl"), parse_control(shipped_text(name), name), verify=True)
    assert done.text is not None
    assert done.verification is not None
    lines = [line.split(" ", 1)[-1] if line.startswith("N") else line for line in done.text.splitlines()]
    return lines, done.verification


TOOL = "LOADTL/4\nSPINDL/RPM,2100,CLW\nCOOLNT/FLOOD\n"
LAST = "FEDRAT/300,MMPM\nRAPID\nGOTO/12,0,40\nGOTO/12,0,3\nFINI\n"


@pytest.mark.parametrize("name", sorted(HOME))
def test_the_tool_goes_home_before_the_end(name: str) -> None:
    blocks, proof = blocks_of(TOOL + LAST, name)
    end = blocks.index("M30")
    home = HOME[name]
    assert blocks[end - len(home) - 1 : end] == ["M09", *home]
    assert proof.ok


@pytest.mark.parametrize("name", MILLS)
def test_a_feed_right_behind_a_tool_change_goes_across_first_and_then_down(name: str) -> None:
    text = "LOADTL/1\nRAPID\nGOTO/1,2,40\n" + TOOL + "FEDRAT/310,MMPM\nGOTO/12,23,34\nGOTO/12,23,5\nFINI\n"
    blocks, proof = blocks_of(text, name)
    words = [block.replace("G00", "G0").replace("G01", "G1").replace(".000", ".") for block in blocks]
    if name in ("bosch-pnc", "bosch-pnc-cpl"):
        words = [block.replace("X12 Y23", "X12. Y23.").replace("Z34 F310", "Z34. F310.") for block in words]
    across = words.index("G0 X12. Y23." + (" A0. C0." if "5axis" in name else ""))
    assert words[across + 1].split() in (
        ["G43", "G1", "H04", "Z34.", "F310."],  # the length only with a move of Z
        ["G1", "Z34.", "F310."],
        ["G1", "Z34.", "F310"],
    )
    assert ("H04" in words[across + 1]) == name.startswith(("fanuc", "haas", "linuxcnc"))
    assert proof.ok
    assert proof.rapid_cuts == 0


@pytest.mark.parametrize("name", MILLS)
def test_a_rapid_right_behind_a_tool_change_goes_across_first(name: str) -> None:
    blocks, proof = blocks_of(TOOL + "RAPID\nGOTO/12,23,34\nRAPID\nGOTO/1,2,3\nFINI\n", name)
    first = next(place for place, block in enumerate(blocks) if "X12" in block)
    assert "Z" not in blocks[first]
    assert "Z34" in blocks[first + 1]
    assert {"X1", "Z3"} <= {word[:2] for word in blocks[first + 2].split()}  # later ones go straight
    assert proof.ok


def test_a_feed_right_behind_a_tool_change_of_a_lathe_goes_to_its_diameter_first() -> None:
    blocks, proof = blocks_of(TOOL + "FEDRAT/0.2,MMPR\nGOTO/12,0,3\nGOTO/12,0,-9\nFINI\n", "fanuc-lathe")
    across = blocks.index("G00 X24.")
    assert blocks[across + 1] == "G99 G01 Z3. F0.2"
    assert proof.ok


def test_a_feed_that_tilts_the_tool_behind_a_tool_change_turns_the_table_by_rapid() -> None:
    text = (
        TOOL + "FEDRAT/310,MMPM\nGOTO/12,23,34,0,0,1\nGOTO/12,23,5\n"
        "LOADTL/5\nGOTO/12,23,34,0,0.6,0.8\nGOTO/13,23,34\nFINI\n"
    )
    blocks, proof = blocks_of(text, "fanuc-5axis")
    behind = blocks[blocks.index("T05 M06") :]
    across = next(block for block in behind if block.startswith("G00"))
    assert "A-36.8699" in across
    assert "Z" not in across
    down = behind[behind.index(across) + 1]
    assert down.startswith("G43 G01 H05 Z")
    assert down.endswith("F310.")  # the tool does not turn: no time of a turn, but a feed
    assert proof.ok


@pytest.mark.parametrize("start", ["", "FROM/0,0,0\n"])
def test_an_arc_right_behind_a_tool_change_is_refused(start: str) -> None:
    # The tool hangs where it was changed: there is no such arc.
    text = (
        f"LOADTL/1\nRAPID\nGOTO/0,0,0\nFEDRAT/300\nLOADTL/2\n{start}CIRCLE/5,0,0,0,0,1,5\nGOTO/10,0,0\nFINI\n"
    )
    with pytest.raises(ProgramError, match="an arc right after a tool change"):
        blocks_of(text, "fanuc-mill")
    blocks, proof = blocks_of(text.replace("CIRCLE", "RAPID\nGOTO/0,0,0\nCIRCLE"), "fanuc-mill")
    assert any(block.startswith(("G03", "G17 G03")) for block in blocks)
    assert proof.ok


def test_a_thread_that_begins_where_the_tool_was_changed_is_refused() -> None:
    text = TOOL + "PITCH/LEAD,1.5\nTHREAD/TURN\nGOTO/12,0,3\nGOTO/12,0,-9\nTHREAD/OFF\nFINI\n"
    with pytest.raises(ProgramError, match="a thread that begins where the tool was changed"):
        blocks_of(text, "fanuc-lathe")
    assert blocks_of(text.replace("PITCH", "RAPID\nGOTO/14,0,3\nPITCH"), "fanuc-lathe")[1].ok


@pytest.mark.parametrize("name", ["bosch-pnc", "bosch-pnc-cpl"])
def test_holes_behind_a_tool_change_are_the_first_move(name: str) -> None:
    text = TOOL + "CYCLE/DRILL,DEPTH,7,MMPM,90,CLEAR,3\nGOTO/11,13,0\nCYCLE/OFF\nRAPID\nGOTO/1,2,30\nFINI\n"
    blocks, proof = blocks_of(text, name)
    assert "G00 X1 Y2 Z30" in blocks
    assert proof.ok


@pytest.mark.parametrize(("name", "word"), [("fanuc-mill", "G43 H13 Z34."), ("fanuc-lathe", "T0413")])
def test_the_length_offset_of_set_ofsetl_is_written(name: str, word: str) -> None:
    text = TOOL + "SET/OFSETL,13\nRAPID\nGOTO/12,0,34\nFINI\n"
    blocks, proof = blocks_of(text, name)
    assert word in blocks or f"N10 {word}" in blocks
    assert proof.ok


@pytest.mark.parametrize("name", [*MILLS, "fanuc-lathe"])
def test_an_auxiliary_function_is_its_m_code(name: str) -> None:
    blocks, proof = blocks_of(TOOL + "RAPID\nGOTO/12,0,34\nAUXFUN/71\nRAPID\nGOTO/12,0,35\nFINI\n", name)
    assert "M71" in blocks
    assert proof.ok


def test_the_table_turns_at_the_start_while_the_tool_is_home() -> None:
    text = "RAPID\nGOTO/12,3,40,1,0,0\nRAPID\nGOTO/9,3,40\nFEDRAT/300\nGOTO/5,3,40\nFINI\n"
    blocks, proof = blocks_of(text, "fanuc-5axis")
    first = blocks.index("G90 G00 A0. C0.")
    assert blocks[first + 1 : first + 4] == ["X3. Y40. A90. C90.", "Z12.", "Z9."]
    assert proof.ok


@pytest.mark.parametrize("name", MILLS)
def test_the_plane_is_xy_before_the_control_compensates_the_radius(name: str) -> None:
    # Down along an upright arc, as many systems go in: G19 is still in force after it.
    text = (
        TOOL
        + "RAPID\nGOTO/20,-30,9\nFEDRAT/300,MMPM\nGOTO/20,-30,1\nCIRCLE/20,-29,1,1,0,0,1\nGOTO/20,-29,0\n"
        "CUTCOM/LEFT,4\nGOTO/20,10,0\nCIRCLE/15,10,0,0,0,1,5\nGOTO/10,10,0\nGOTO/10,0,0\nCUTCOM/OFF\n"
        "GOTO/15,0,0\nFINI\n"
    )
    blocks, proof = blocks_of(text, name)
    assert any("G19" in block for block in blocks)
    (compensates,) = (block for block in blocks if "G41" in block)
    assert compensates.startswith("G17 G41 D")
    assert proof.run.alarms == []
    assert proof.ok


def test_compensation_in_another_plane_is_refused_on_a_mill() -> None:
    text = TOOL + "RAPID\nGOTO/20,0,9\nFEDRAT/300,MMPM\nCUTCOM/LEFT,{}\nGOTO/20,0,0\nFINI\n"
    for plane in ("YZPLAN", "ZXPLAN", "XZPLAN"):
        with pytest.raises(ProgramError, match="radius compensation in another plane"):
            blocks_of(text.format(plane), "fanuc-mill")
    assert "G41 D04" in blocks_of(text.format("XYPLAN"), "fanuc-mill")[0]
    assert "G41" in blocks_of(text.format("ZXPLAN"), "fanuc-lathe")[0]


@pytest.mark.parametrize("name", ["fanuc-mill", "fanuc-5axis"])
@pytest.mark.parametrize("change", ["LOADTL/5", "CUTCOM/ADJUST,2"])
def test_the_plane_is_xy_before_the_length_of_a_tool(name: str, change: str) -> None:
    # Controls may compensate the length along the axis across the plane that is in force.
    text = (
        TOOL
        + "RAPID\nGOTO/20,-30,9\nFEDRAT/300,MMPM\nGOTO/20,-30,1\nCIRCLE/20,-29,1,1,0,0,1\nGOTO/20,-29,0\n"
        f"{change}\nRAPID\nGOTO/1,2,30\nFINI\n"
    )
    blocks, proof = blocks_of(text, name)
    assert "G17 G90 G49" in blocks
    assert proof.ok
