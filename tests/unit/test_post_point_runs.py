"""Many points one after another are read and written together: what comes of it is what comes of each by itself."""

from __future__ import annotations

import math

import numpy as np
import pytest

from polycnc.errors import ProgramError
from polycnc.post import BlockMap, parse_tool_path, post_program, sweep_tool_path
from polycnc.post.tool_path._records import Points
from polycnc.runner import post_file
from polycnc.runner._verify_post import _Skipped
from support.post_controls import control

POINTS = "".join(
    f"GOTO/{7.0 * math.cos(0.2 * n):.4f},{5.0 * math.sin(0.2 * n):.4f},{-0.03 * (n // 3):.4f}\n"
    for n in range(1, 40)
)
PART = (
    "LOADTL/3\nSPINDL/RPM,900,CLW\nFEDRAT/700\nRAPID\n"
    + POINTS
    + "GOTO/1.5,2.5,-3\n" * 9  # nothing moves
    + "GOTO/6.5,2.5,-3\nCIRCLE/6.5,4.5,-3,0,0,1,2\nGOTO/8.5,4.5,-3\n"
    + POINTS
    + "CYCLE/DRILL,DEPTH,4,MMPM,90,CLEAR,2\n"
    + "".join(f"GOTO/{3 * n},11,0\n" for n in range(10))
    + "CYCLE/OFF\nCUTCOM/LEFT\n"
    + POINTS
    + "LOADTL/4\n"
    + POINTS
    + "FINI\n"
)
CONTROLS = {
    "plain": control(),
    "where it starts": control(macros={"LINEAR": "IF(STARTX<X)\n(back)\nENDIF\n!-G01!$X$$Y$$Z$$F$"}),
    "a feed of its own": control(macros={"LINEAR": "<F=F*0.5+1>!-G01!$X$$Y$$Z$$F$"}),
    "none, one or two blocks": control(
        macros={"LINEAR": "IF(X>0)\n!-G01!$X$$Y$$Z$$F$\nENDIF\nIF(X>3)\n(far)\nENDIF"}
    ),
    "inch": control({"units": "inch"}),
}


@pytest.mark.parametrize("name", CONTROLS)
def test_points_together_are_posted_as_each_by_itself(name: str) -> None:
    found, lengths = [], []
    # With a blank before the slash a GOTO is a statement like any other.
    for text in (PART, PART.replace("GOTO/", "GOTO /")):
        path, blocks, out = parse_tool_path(text), BlockMap(), list[str]()
        summary = post_program(path, CONTROLS[name], out.append, block_map=blocks)
        found.append(
            ("".join(out), blocks.last_block, blocks.line, summary.records, summary.blocks, summary.arcs)
        )
        lengths.append((summary.feed_mm, summary.rapid_mm))
    assert found[0] == found[1]
    assert lengths[0] == pytest.approx(lengths[1])
    assert found[0][0].count("\n") == found[0][4]


def test_points_together_sweep_as_each_by_itself() -> None:
    together, single = (
        list(sweep_tool_path(parse_tool_path(text))) for text in (PART, PART.replace("GOTO/", "GOTO /"))
    )
    assert together == single
    assert list(sweep_tool_path(parse_tool_path(PART).runs())) == single
    assert len(single) > 4 * 39


def test_some_points_are_read_together() -> None:
    runs = [
        record for record in parse_tool_path("UNITS/INCHES\n" + PART).runs() if isinstance(record, Points)
    ]
    assert [len(run.xyz) for run in runs] == [39 + 9 + 1, 39, 10, 39, 39]
    x, y, z = runs[0].xyz[38]
    assert (x, y, z) == (
        25.4 * round(7.0 * math.cos(7.8), 4),
        25.4 * round(5.0 * math.sin(7.8), 4),
        25.4 * -0.39,
    )
    assert runs[1].line == 5 + 39 + 9 + 4


@pytest.mark.parametrize("name", ["plain", "none, one or two blocks"])
def test_points_together_are_proven(name: str) -> None:
    result = post_file(parse_tool_path(PART.replace("CUTCOM/LEFT\n", "")), CONTROLS[name], verify=True)
    assert result.verification is not None
    assert result.ok == (name == "plain")
    assert result.verification.path_feed_mm == pytest.approx(result.summary.feed_mm, rel=0.1)


def test_a_number_too_far_away_has_its_place() -> None:
    text = "FEDRAT/200\n" + "GOTO/1,2,3\n" * 12 + "GOTO/1,2000000,3\n" + "GOTO/1,2,3\n" * 12
    with pytest.raises(ProgramError, match="further than any machine") as caught:
        list(parse_tool_path(text))
    assert caught.value.position is not None
    assert caught.value.position.line == 14


def test_a_macro_that_fails_on_the_way_is_told() -> None:
    used = control(macros={"LINEAR": "<F=1/(X-6)>\n!-G01!$X$$Y$$Z$$F$"})
    text = "FEDRAT/200\n" + "".join(f"GOTO/{n},2,3\n" for n in range(30))
    with pytest.raises(ProgramError, match=r"LINEAR, line 1: division by zero"):
        post_file(parse_tool_path(text), used)


def test_old_line_ends_count_as_lines() -> None:
    path = parse_tool_path(POINTS.replace("\n", "\r"))
    assert [record.line for record in path] == list(range(1, 40))


def test_records_without_rows_are_held_against_the_way_on_which_the_machine_passed_them() -> None:
    skipped = _Skipped()
    before, after = np.array([2, 2, 3]), np.array([2, 3, 6])
    start = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]])
    skipped.note(before, after, start, start + [1.0, 0.0, 0.0])
    begin, here = np.array([[-1.0, 0.0, 0.0]]), np.array([[9.0, 0.0, 0.0]])
    points = np.array([[0.0, 0.0, 0.0], [2.5, 0.25, 0.0], [4.0, 0.0, 0.0], [9.0, 0.0, 0.5]])
    found = skipped.nearest(np.array([1, 4, 5, 11]), points, begin, (9, here))
    assert found.tolist() == [1.0, 0.25, 1.0, 0.5]
