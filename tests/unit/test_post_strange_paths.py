"""Tool paths that say odd things: an error at its place, or the right part, and never a program of another part."""

from __future__ import annotations

import pytest

from polycnc.errors import ProgramError
from polycnc.post import load_control, parse_tool_path
from polycnc.runner import post_file

HEAD = "LOADTL/3\nSPINDL/RPM,900,CLW\nFEDRAT/300,MMPM\nRAPID\nGOTO/11,12,30\n"


@pytest.mark.parametrize(
    ("text", "what", "line"),
    [
        ("FROM/5,57,-19\nGODLTA/-18,-39,-38\n", "a feed move from where FROM on line 6 says the tool is", 7),
        ("FROM/5,57,-19\nGOTO/-18,-39,-38\n", "a feed move from where FROM on line 6 says the tool is", 7),
        ("FROM/5,57,30\nCIRCLE/0,57,30,0,0,1,5\nGOTO/-5,57,30\n", "a feed move from where FROM on line 6", 7),
        ("END\nPPRINT more\nGOTO/1,2,3\n", "a move after END", 8),
        ("END\nGOHOME/7,8,9\nFINI\n", "a move after END", 7),
        ("END\n" + "GOTO/1,2,3\n" * 20, "a move after END", 7),
        ("CUTCOM/LEFT,1e400\n", "the number 1E400 is beyond all others", 6),
        ("CUTCOM/LEFT,4.5\n", "the number of an offset must be a whole number, not 4.5", 6),
        ("LOADTL/4,ADJUST,2.5\n", "the number of an offset must be a whole number, not 2.5", 6),
        (f"GOTO/{'9' * 50_000}X,2,3\n", "GOTO", 6),  # looked at digit by digit, once
        ("SPINDL/-800,CLW\n", "a spindle speed of -800", 6),
        ("FEDRAT/1e400,MMPM\n", "the number 1E400 is beyond all others", 6),
        ("UNITS/INCHES\nGOTO/1,2,3\n", "the unit changes after the first move", 6),
    ],
)
def test_what_would_be_another_part_is_refused_at_its_place(text: str, what: str, line: int) -> None:
    with pytest.raises(ProgramError, match=what) as caught:
        post_file(parse_tool_path(HEAD + text, "part.cl"), "fanuc-mill")
    assert caught.value.position is not None
    assert caught.value.position.line == line


@pytest.mark.parametrize(
    "control", ["fanuc-mill", "grbl", "haas-mill", "linuxcnc-mill", "din", "bosch-pnc", "bosch-pnc-cpl"]
)
def test_from_elsewhere_then_a_rapid_is_written_and_proven(control: str) -> None:
    text = HEAD + "FROM/-36.5,16.25,24\nGOHOME\nGOTO/5,6,7\nEND\nPPRINT all\nFINI\nGOTO/1,1,1\n"
    result = post_file(parse_tool_path(text), control, verify=True)
    assert result.ok
    assert "X-36.5" in (result.text or "")
    # A FROM at the place where the tool is says nothing new.
    again = HEAD + "FROM/11,12,30\nGOTO/5,6,7\nFINI\n"
    assert post_file(parse_tool_path(again), control, verify=True).ok


def test_the_same_unit_may_be_said_again() -> None:
    result = post_file(parse_tool_path("UNITS/MM\n" + HEAD + "UNITS/MM\nGOTO/5,6,7\n"), "fanuc-mill")
    assert "G01 X5. Y6. Z7. F300." in (result.text or "")


@pytest.mark.parametrize("points", [1, 30])
def test_points_off_the_plane_of_a_lathe_are_refused(points: int) -> None:
    text = HEAD.replace("11,12,30", "11,0,30") + "".join(f"GOTO/{9 - 0.1 * n},0,3\n" for n in range(points))
    assert post_file(parse_tool_path(text), load_control("fanuc-lathe")).text
    with pytest.raises(ProgramError, match=r"the point lies 0\.25 mm off the plane") as caught:
        post_file(parse_tool_path(text + "GOTO/4,0.25,3\n"), "fanuc-lathe")
    assert caught.value.position is not None
    assert caught.value.position.line == 6 + points


@pytest.mark.parametrize("speed", ["SPINDL/SMM,120,CLW", "SPINDL/SFM,400,CCLW"])
def test_a_mill_without_surface_speed_refuses_it(speed: str) -> None:
    with pytest.raises(ProgramError, match="a surface speed, and SPINDLE_C") as caught:
        post_file(parse_tool_path(HEAD.replace("SPINDL/RPM,900,CLW", speed), "part.cl"), "haas-mill")
    assert caught.value.position is not None
    assert caught.value.position.line == 2
