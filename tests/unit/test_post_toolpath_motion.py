"""Points, arcs, holes and tilted tools as the words of macros, with numbers worked out by hand."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import pytest

from polycnc.errors import ProgramError
from polycnc.post.output._rotary import axis_of, table_angles
from polycnc.post.tool_path._arcs import Arc, cuts
from support.post_controls import control, posted
from support.post_recorder import moves_of, points_of

START = "FROM/10,0,0\nFEDRAT/600\n"


def arc(circle: str, end: str, **parameters: Any) -> list[tuple[str, dict[str, float]]]:
    """Return what an arc from 10, 0, 0 calls."""
    return moves_of(f"{START}CIRCLE/{circle}\nGOTO/{end}\n", **parameters)


def test_a_point_is_a_move_with_the_feed_and_behind_rapid_one_without() -> None:
    rapid, line = moves_of("FROM/1,2,3\nRAPID\nGOTO/10,20,30\nFEDRAT/.2,MMPR\nGOTO/10,20,25\n")
    start = {"STARTX": 1.0, "STARTY": 2.0, "STARTZ": 3.0}
    assert rapid == ("RAPID", {"X": 10.0, "Y": 20.0, "Z": 30.0, **start})
    assert line[0] == "LINEAR"
    assert (line[1]["F"], line[1]["FEEDMODE"], line[1]["STARTZ"]) == (0.2, 95.0, 30.0)


def test_lengths_and_feeds_in_inch() -> None:
    (_, words), *_ = moves_of("FROM/12.7,38.1,63.5\nFEDRAT/254\nGOTO/25.4,50.8,-2.54\n", units="inch")
    assert (words["X"], words["Y"], words["Z"], words["F"]) == pytest.approx((1.0, 2.0, -0.1, 10.0))
    assert (words["STARTX"], words["STARTY"], words["STARTZ"]) == pytest.approx((0.5, 1.5, 2.5))


def test_a_move_without_a_way_is_left_out() -> None:
    assert points_of(moves_of("FEDRAT/1\nGOTO/1,2,3\nGOTO/1,2,3\nGOTO/1,2,4\n")) == [
        ("LINEAR", 1.0, 2.0, 3.0),
        ("LINEAR", 1.0, 2.0, 4.0),
    ]


def test_distances_and_home() -> None:
    text = "FROM/1,2,3\nFEDRAT/1\nGODLTA/1,0,-1\nGODLTA/5\nGOHOME\n"
    assert points_of(moves_of(text)) == [
        ("LINEAR", 2.0, 2.0, 2.0),
        ("LINEAR", 2.0, 2.0, 7.0),
        ("RAPID", 1.0, 2.0, 3.0),
    ]
    for bad, what in (("GODLTA/1,2,3\n", "from an unknown point"), ("GOHOME\n", "GOHOME without a FROM")):
        with pytest.raises(ProgramError, match=what):
            moves_of(bad)


def test_a_feed_move_needs_a_feed() -> None:
    with pytest.raises(ProgramError, match="a feed move without a feed") as caught:
        moves_of("GOTO/1,2,3\n")
    assert str(caught.value.position) == "part.cl:1:1"


@pytest.mark.parametrize(
    ("circle", "end", "macro", "plane", "center", "sweep"),
    [
        ("0,0,0,0,0,1,10", "0,10,0", "ARC_CCW", 17.0, (-10.0, 0.0, 0.0), 90.0),
        ("0,0,0,0,0,-1,10", "0,10,0", "ARC_CW", 17.0, (-10.0, 0.0, 0.0), 270.0),
        ("0,0,0,0,1,0,10", "0,0,-10", "ARC_CCW", 18.0, (-10.0, 0.0, 0.0), 90.0),
        ("0,0,0,0,-1,0,10", "0,0,10", "ARC_CW", 18.0, (-10.0, 0.0, 0.0), 90.0),
        ("10,5,0,1,0,0,5", "10,5,-5", "ARC_CCW", 19.0, (0.0, 5.0, 0.0), 90.0),
        ("0,0,0,0,0,1,10", "10,0,0", "ARC_CCW", 17.0, (-10.0, 0.0, 0.0), 360.0),
    ],
)
def test_an_arc_in_each_plane(
    circle: str, end: str, macro: str, plane: float, center: tuple[float, float, float], sweep: float
) -> None:
    ((name, words),) = arc(circle, end)
    assert (name, words["PLANE"]) == (macro, plane)
    assert (words["I"], words["J"], words["K"]) == center
    assert words["SWEEP"] == pytest.approx(sweep)
    radius = 5.0 if plane == 19.0 else 10.0
    assert words["R"] == pytest.approx(radius if sweep <= 180.0 else -radius)
    assert words["F"] == 600.0


def test_the_centre_as_a_position() -> None:
    ((_, words),) = arc("0,3,7,0,0,1,10", "10,6,0", arc_center="absolute")
    assert (words["I"], words["J"], words["K"]) == (0.0, 3.0, 0.0)


def test_centres_count_from_rounded_positions() -> None:
    text = "FROM/10.0004,0.0004,0\nFEDRAT/1\nCIRCLE/0.0006,0.0004,0,0,0,1,10\nGOTO/0.0006,10.0002,0\n"
    ((_, words),) = moves_of(text)
    # The start is written as 10.000, 0.000 and the centre is 0.001, 0.000: the difference, not -9.9998.
    assert (words["I"], words["J"]) == (pytest.approx(-9.999, abs=1e-12), 0.0)


def test_arcs_split_at_the_axes() -> None:
    pieces = arc("0,0,0,0,0,1,10", "6,-8,0", arc_split="quadrant")
    assert [name for name, _ in pieces] == ["ARC_CCW"] * 4
    ends = [(words["X"], words["Y"]) for _, words in pieces]
    assert [pytest.approx(end, abs=1e-12) for end in ends] == [(0, 10), (-10, 0), (0, -10), (6, -8)]
    assert sum(words["SWEEP"] for _, words in pieces) == pytest.approx(360.0 - math.degrees(math.atan2(8, 6)))
    back = arc("0,0,0,0,0,-1,10", "6,8,0", arc_split="quadrant")
    assert [(round(words["X"], 9), round(words["Y"], 9)) for _, words in back] == [
        (0, -10),
        (-10, 0),
        (0, 10),
        (6, 8),
    ]


def test_arcs_split_in_halves_have_positive_radii() -> None:
    pieces = arc("0,0,0,0,0,1,10", "10,0,0", arc_split="half")
    assert [(round(words["X"], 9), words["R"]) for _, words in pieces] == [(-10.0, 10.0), (10.0, 10.0)]
    (whole,) = arc("0,0,0,0,0,1,10", "-10,0,0", arc_split="half")
    assert whole[1]["SWEEP"] == pytest.approx(180.0)


def test_a_helix_of_several_turns_is_several_arcs() -> None:
    pieces = moves_of(f"{START}CIRCLE/0,0,0,0,0,1,10,TIMES,3\nGOTO/0,10,-6.5\n")
    assert [round(words["SWEEP"], 6) for _, words in pieces] == [360.0, 360.0, 90.0]
    assert [round(words["Z"], 6) for _, words in pieces] == [-2.888889, -5.777778, -6.5]
    lines = moves_of(f"{START}CIRCLE/0,0,0,0,0,1,10\nGOTO/10,0,-6\n", helix="lines", tolerance_mm=0.01)
    assert {name for name, _ in lines} == {"LINEAR"}
    assert lines[-1][1]["Z"] == -6.0


@pytest.mark.parametrize(
    "parameters",
    [{"arcs": "lines"}, {"arc_planes": [18, 19]}, {"arc_min_radius_mm": 11.0}, {"arc_max_radius_mm": 9.0}],
)
def test_arcs_that_become_lines_stay_within_the_tolerance(parameters: dict[str, object]) -> None:
    if "arc_planes" in parameters:
        parameters = {"arc_planes": (18, 19)}
    lines = arc("0,0,0,0,0,1,10", "0,10,0", tolerance_mm=0.01, **parameters)
    assert {name for name, _ in lines} == {"LINEAR"}
    points = [(10.0, 0.0), *((words["X"], words["Y"]) for _, words in lines)]
    # 2 acos(1 - 0.01 / 10) is 5.126 degree, so a quarter has 18 chords.
    assert len(lines) == 18
    for a, b in pairwise(points):
        middle = math.hypot(0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]))
        assert 10.0 - 0.01 <= middle <= 10.0
        assert math.hypot(*b) == pytest.approx(10.0)


def test_arcs_without_macros_or_in_tilted_planes_become_lines() -> None:
    text = f"{START}CIRCLE/0,0,0,0,0,1,10\nGOTO/0,10,0\n"
    assert {name for name, _ in moves_of(text, ("ARC_CW",), tolerance_mm=0.01)} == {"LINEAR"}
    tilted = f"{START}CIRCLE/0,0,0,0,-.6,.8,10\nGOTO/0,8,6\n"
    lines = moves_of(tilted, tolerance_mm=0.01)
    assert {name for name, _ in lines} == {"LINEAR"}
    assert all(math.hypot(w["X"], w["Y"], w["Z"]) == pytest.approx(10.0) for _, w in lines)


def test_an_arc_too_flat_to_tell_from_a_line_is_one() -> None:
    # A chord of 0.1 mm on a radius of 10 mm bulges by 0.000125 mm.
    angle = 0.01
    end = f"{10 * math.cos(angle)},{10 * math.sin(angle)},0"
    assert [name for name, _ in arc("0,0,0,0,0,1,10", end)] == ["LINEAR"]


def test_an_arc_from_nowhere_is_refused() -> None:
    with pytest.raises(ProgramError, match="an arc without a start point"):
        moves_of("FEDRAT/1\nCIRCLE/0,0,0,0,0,1,10\nGOTO/0,10,0\n")
    with pytest.raises(ProgramError, match="an arc within a drilling cycle"):
        moves_of(f"{START}CYCLE/DRILL,DEPTH,1,CLEAR,1\nCIRCLE/0,0,0,0,0,1,10\nGOTO/0,10,0\n")


def test_an_arc_whose_ends_differ_in_radius_is_a_spiral_in_between() -> None:
    arc = Arc((10.0, 0.0, 0.0), (0.0, 10.01, 2.0), (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 0.5 * math.pi)
    half = arc.point(0.25 * math.pi)
    assert math.hypot(half[0], half[1]) == pytest.approx(10.005)
    assert half[2] == pytest.approx(1.0)
    assert arc.point(9.0) == arc.end
    assert cuts(arc, "none") == []


HOLES = "FROM/0,0,50\nFEDRAT/100\nCYCLE/{}\nGOTO/10,0,0\nGOTO/20,0,0\nCYCLE/OFF\n"


def test_holes_call_the_macro_of_their_cycle() -> None:
    first, second, off = moves_of(HOLES.format("DEEP,DEPTH,12,STEP,5,MMPM,150,CLEAR,2"))
    assert first[0] == second[0] == "CYCLE_DEEP"
    assert first[1] == {
        "X": 10.0, "Y": 0.0, "Z": -12.0, "STARTX": 0.0, "STARTY": 0.0, "STARTZ": 50.0, "SURFACE": 0.0, "R": 2.0,
        "OUT": 2.0, "RETRACT": 99.0, "HOLE": 1.0, "P": 0.0, "Q": 5.0, "F": 150.0, "FEEDMODE": 94.0,
    }  # fmt: skip
    assert (second[1]["HOLE"], second[1]["STARTX"], second[1]["STARTZ"]) == (2.0, 10.0, 2.0)
    assert off == ("CYCLE_OFF", {})


def test_a_cycle_that_leaves_to_a_level_goes_there_first() -> None:
    moves = moves_of(HOLES.format("DRILL,DEPTH,12,CLEAR,2,RETURN,10"))
    assert points_of(moves) == [
        ("RAPID", 10.0, 0.0, 50.0),
        ("RAPID", 10.0, 0.0, 10.0),
        ("CYCLE_DRILL", 10.0, 0.0, -12.0),
        ("CYCLE_DRILL", 20.0, 0.0, -12.0),
    ]
    assert moves[2][1]["RETRACT"] == 98.0
    assert moves[2][1]["F"] == 100.0
    low = HOLES.replace("FROM/0,0,50", "FROM/0,0,5").format("DRILL,DEPTH,12,CLEAR,2,RETURN,10")
    assert points_of(moves_of(low))[:2] == [("RAPID", 0.0, 0.0, 10.0), ("CYCLE_DRILL", 10.0, 0.0, -12.0)]


def test_return_0_is_the_level_before_the_cycle() -> None:
    first, *_ = moves_of(HOLES.format("DRILL,DEPTH,12,CLEAR,2,RETURN,0"))
    assert (first[1]["OUT"], first[1]["RETRACT"]) == (50.0, 98.0)


def test_another_level_to_leave_to_begins_the_cycle_anew() -> None:
    text = "FROM/0,0,10\nFEDRAT/100\nCYCLE/DRILL,DEPTH,5,CLEAR,2,RETURN,10\nGOTO/10,0,0\nGOTO/20,0,5\nCYCLE/OFF\n"
    names = [(name, words.get("HOLE"), words.get("Z")) for name, words in moves_of(text)]
    assert names == [
        ("CYCLE_DRILL", 1.0, -5.0),
        ("CYCLE_OFF", None, None),
        ("RAPID", None, 15.0),
        ("CYCLE_DRILL", 1.0, 0.0),
        ("CYCLE_OFF", None, None),
    ]


def test_tapping_has_pitch_and_speed() -> None:
    text = "SPINDL/RPM,400,CLW\n" + HOLES.format("TAP,DEPTH,12,MMPR,1.5,CLEAR,5")
    words = moves_of(text)[0][1]
    assert (words["PITCH"], words["S"], words["F"], words["FEEDMODE"]) == (1.5, 400.0, 600.0, 94.0)
    per_minute = moves_of(text.replace("MMPR,1.5", "MMPM,500"))[0][1]
    assert (per_minute["PITCH"], per_minute["F"]) == (1.25, 500.0)
    with pytest.raises(ProgramError, match="tapping before the spindle has a speed"):
        moves_of(HOLES.format("TAP,DEPTH,12,MMPR,1.5,CLEAR,5"))


@pytest.mark.parametrize("how", ["no macro", "moves"])
def test_cycles_become_moves(how: str) -> None:
    text = HOLES.format("DEEP,DEPTH,12,STEP,5,MMPM,150,CLEAR,2,RETURN,6")
    without = ("CYCLE_DEEP",) if how == "no macro" else ()
    cycles = "macros" if how == "no macro" else "moves"
    moves = points_of(moves_of(text, without, cycles=cycles, reentry_mm=0.5))
    at = [(name, z) for name, x, _, z in moves if x == 10.0]
    assert at == [
        *(("RAPID", 50.0), ("RAPID", 6.0), ("RAPID", 2.0)),
        *(("LINEAR", -3.0), ("RAPID", 2.0), ("RAPID", -2.5)),
        *(("LINEAR", -8.0), ("RAPID", 2.0), ("RAPID", -7.5)),
        *(("LINEAR", -12.0), ("RAPID", 6.0)),
    ]
    assert moves[len(at)] == ("RAPID", 20.0, 0.0, 6.0)


def test_chip_breaking_backs_up_a_little() -> None:
    text = HOLES.format("BRKCHP,DEPTH,7,STEP,5,MMPM,150,CLEAR,2")
    moves = points_of(moves_of(text, cycles="moves", chip_break_mm=0.25))
    assert [(n, z) for n, x, _, z in moves if x == 20.0] == [
        *(("RAPID", 2.0), ("LINEAR", -3.0), ("RAPID", -2.75), ("LINEAR", -7.0), ("RAPID", 2.0))
    ]


def test_tapping_and_boring_by_moves() -> None:
    text = "SPINDL/RPM,400,CCLW\n" + HOLES.format("TAP,DEPTH,12,MMPR,1.5,CLEAR,5")
    blocks, _ = posted(text, control({"cycles": "moves"}))
    names = [block for block in blocks if block.startswith(("M05", "S", "M04", "M03"))]
    assert names == ["S400M04", "M05", "M03", "M05", "M04", "M05", "M03", "M05", "M04"]
    bore = HOLES.format("BORE,DEPTH,12,MMPM,80,CLEAR,5,DWELL,0.5")
    moves = points_of(moves_of(bore, cycles="moves"))
    assert [(n, z) for n, x, _, z in moves if x == 20.0] == [
        ("RAPID", 5.0),
        ("LINEAR", -12.0),
        ("LINEAR", 5.0),
    ]
    # The feed of the cycle is the cycle's own: the feed before is in force again after it.
    after = moves_of(bore + "GOTO/0,0,0\n", cycles="moves")[-1]
    assert after[1]["F"] == 100.0


def test_a_hole_with_too_many_pecks_is_refused() -> None:
    with pytest.raises(ProgramError, match="too many pecks"):
        moves_of(HOLES.format("DEEP,DEPTH,1000,STEP,.001,CLEAR,2"))
    with pytest.raises(ProgramError, match="CYCLE/ON without a cycle"):
        moves_of("CYCLE/ON\n")


def test_cycle_on_takes_the_cycle_up_again() -> None:
    text = HOLES.format("DRILL,DEPTH,12,CLEAR,2") + "RAPID\nGOTO/0,0,50\nCYCLE/ON\nGOTO/30,0,0\nCYCLE/OFF\n"
    assert [name for name, *_ in points_of(moves_of(text))] == [
        "CYCLE_DRILL",
        "CYCLE_DRILL",
        "RAPID",
        "CYCLE_DRILL",
    ]


TILTED = "FEDRAT/100\nGOTO/0,0,0\nGOTO/1,2,3,{}\n"


def test_a_tilted_tool_needs_rotary_axes() -> None:
    with pytest.raises(ProgramError, match="the tool is tilted, and the control file has no rotary axes"):
        moves_of(TILTED.format("0,-.6,.8"))
    assert "A" not in moves_of(TILTED.format("0,0,1"))[-1][1]
    words = moves_of(TILTED.format("0,-.6,.8"), rotary="vector")[-1][1]
    assert (words["TOOLI"], words["TOOLJ"], words["TOOLK"]) == (0.0, -0.6, 0.8)
    assert "A" not in words


def test_rotary_positions_of_a_tilted_tool() -> None:
    words = moves_of(TILTED.format("0,-.6,.8"), rotary="ac_table")[-1][1]
    # A positive turn about X tips the upright axis towards -Y.
    assert (words["A"], words["C"]) == (pytest.approx(math.degrees(math.asin(0.6))), pytest.approx(0.0))
    words = moves_of(TILTED.format(".6,0,.8"), rotary="bc_table")[-1][1]
    assert (words["B"], words["C"]) == (pytest.approx(math.degrees(math.asin(0.6))), pytest.approx(0.0))
    # A new axis in the same place is a move too.
    text = TILTED.format("0,-.6,.8") + "GOTO/1,2,3,.6,0,.8\nGOTO/1,2,4\n"
    turned, along = moves_of(text, rotary="ac_table")[-2:]
    assert (turned[1]["X"], turned[1]["C"]) == (1.0, pytest.approx(90.0))
    assert along[1]["C"] == pytest.approx(90.0)


@pytest.mark.parametrize("table", ["ac_table", "bc_table"])
def test_angles_give_the_axis_back_and_take_the_short_way(table: str) -> None:
    tilt = turn = 0.0
    for step in range(400):
        around, lean = 0.1 * step, 0.4 + 0.3 * math.sin(0.05 * step)
        axis = (math.sin(lean) * math.cos(around), math.sin(lean) * math.sin(around), math.cos(lean))
        new_tilt, new_turn = table_angles(axis, table, tilt, turn)  # type: ignore[arg-type]
        assert axis_of(table, new_tilt, new_turn) == pytest.approx(axis, abs=1e-12)  # type: ignore[arg-type]
        if step:
            assert abs(new_turn - turn) < 6.0
            assert abs(new_tilt - tilt) < 2.0
        tilt, turn = new_tilt, new_turn
    assert table_angles((0.0, 0.0, 1.0), table, tilt, turn) == (0.0, turn)  # type: ignore[arg-type]


def test_tilted_holes_are_drilled_along_the_tool() -> None:
    text = "FROM/0,0,50\nFEDRAT/100\nCYCLE/DRILL,DEPTH,10,CLEAR,5\nGOTO/10,0,0,.6,0,.8\nCYCLE/OFF\n"
    moves = points_of(moves_of(text, rotary="vector"))
    # The tool stands at 34 above the point along the axis, so it goes there at that height.
    assert [name for name, *_ in moves] == ["RAPID", "RAPID", "LINEAR", "RAPID"]
    assert moves[1][1:] == pytest.approx((13.0, 0.0, 4.0))
    assert moves[2][1:] == pytest.approx((4.0, 0.0, -8.0))
    assert moves[3][1:] == pytest.approx((13.0, 0.0, 4.0))


TILTED_HOLES = (
    "FROM/20,-1,53,3,4,12\nFEDRAT/100\nCYCLE/{},DEPTH,26,MMPM,150,CLEAR,13,RETURN,39\n"
    "GOTO/11,-13,17,3,4,12\nGOTO/37,29,28,3,4,12\nCYCLE/OFF\n"
)


@pytest.mark.parametrize("cycles", ["macros", "moves"])
def test_holes_of_a_tilted_tool_lie_along_its_axis_and_it_rises_before_it_goes_to_a_higher_one(
    cycles: str,
) -> None:
    # (3, 4, 12) / 13 is the tool axis: 13 above a hole is 3, 4, 12 away from it, 26 below -6, -8, -24.
    moves = points_of(moves_of(TILTED_HOLES.format("DRILL"), cycles=cycles, rotary="vector"))
    first: list[tuple[str, float, float, float]] = [("RAPID", 20, -1, 53)]  # where the tool is, to turn it
    first += [("RAPID", 14, -9, 29), ("LINEAR", 5, -21, -7), ("RAPID", 20, -1, 53)]
    # The tool stands 129 / 13 above the second point and goes up to 39 first: by 378 / 13 along its axis.
    rise = [("RAPID", 20 + 1134 / 169, -1 + 1512 / 169, 53 + 4536 / 169)]
    second = [("RAPID", 46, 41, 64), ("RAPID", 40, 33, 40), ("LINEAR", 31, 21, 4), ("RAPID", 46, 41, 64)]
    whole = [*first, *rise, *second]
    assert [macro for macro, *_ in moves] == [macro for macro, *_ in whole]
    for (_, *found), (_, *expected) in zip(moves, whole, strict=True):
        assert found == pytest.approx(expected)


def test_a_deep_hole_of_a_tilted_tool_is_pecked_along_its_axis() -> None:
    text = TILTED_HOLES.format("DEEP").replace("MMPM", "STEP,16.9,MMPM")
    moves = points_of(moves_of(text, rotary="vector", reentry_mm=1.3))[1:9]
    levels = [13, -3.9, 13, -2.6, -20.8, 13, -19.5, -26]  # along the axis, above the point at 11, -13, 17
    expected = [(11 + 3 * level / 13, -13 + 4 * level / 13, 17 + 12 * level / 13) for level in levels]
    assert [macro == "LINEAR" for macro, *_ in moves] == [False, True, False, False, True, False, False, True]
    for (_, *found), place in zip(moves, expected, strict=True):
        assert found == pytest.approx(place)


def test_the_control_is_told_of_a_rise_between_holes_of_different_heights() -> None:
    text = (
        "FROM/5,6,30\nFEDRAT/100\nCYCLE/DRILL,DEPTH,7,MMPM,90,CLEAR,3,RETURN,9\nGOTO/11,13,4\nGOTO/29,17,21\n"
    )
    moves = points_of(moves_of(text))
    assert moves == [
        *(("RAPID", 11.0, 13.0, 30.0), ("RAPID", 11.0, 13.0, 13.0), ("CYCLE_DRILL", 11.0, 13.0, -3.0)),
        *(("RAPID", 11.0, 13.0, 30.0), ("CYCLE_DRILL", 29.0, 17.0, 14.0)),
    ]
    as_moves = points_of(moves_of(text, cycles="moves"))
    assert as_moves[3:] == [
        *(("LINEAR", 11.0, 13.0, -3.0), ("RAPID", 11.0, 13.0, 13.0)),
        *(("RAPID", 11.0, 13.0, 30.0), ("RAPID", 29.0, 17.0, 30.0), ("RAPID", 29.0, 17.0, 24.0)),
        *(("LINEAR", 29.0, 17.0, 14.0), ("RAPID", 29.0, 17.0, 30.0)),
    ]


def test_a_cycle_that_leaves_to_one_level_goes_on_from_hole_to_hole() -> None:
    moves = moves_of(HOLES.format("DRILL,DEPTH,12,CLEAR,2,RETURN,10"))
    assert [(macro, words.get("HOLE")) for macro, words in moves[2:]] == [
        ("CYCLE_DRILL", 1.0),
        ("CYCLE_DRILL", 2.0),
        ("CYCLE_OFF", None),
    ]
    # From a low start to the level of the cycle, then a cycle without one: the control needs it anew.
    text = "FROM/3,4,5\nFEDRAT/90\nCYCLE/DRILL,DEPTH,7,CLEAR,2,RETURN,9\nGOTO/11,13,0\nCYCLE/DRILL,DEPTH,7,CLEAR,2\n"
    found = [(macro, words.get("RETRACT")) for macro, words in moves_of(f"{text}GOTO/17,19,0\n")]
    assert found == [
        *(("RAPID", None), ("CYCLE_DRILL", 98.0), ("CYCLE_OFF", None)),
        *(("CYCLE_DRILL", 99.0), ("CYCLE_OFF", None)),
    ]


def test_every_length_of_a_hole_is_in_the_unit_of_the_control() -> None:
    text = "FROM/12.7,38.1,50.8\nCYCLE/DEEP,DEPTH,25.4,STEP,6.35,MMPM,381,CLEAR,2.54\nGOTO/63.5,76.2,10.16\n"
    (macro, words), _ = moves_of(text, units="inch")
    assert macro == "CYCLE_DEEP"
    assert words == pytest.approx({
        "X": 2.5, "Y": 3.0, "Z": -0.6, "STARTX": 0.5, "STARTY": 1.5, "STARTZ": 2.0, "SURFACE": 0.4, "R": 0.5,
        "OUT": 0.5, "RETRACT": 99.0, "HOLE": 1.0, "P": 0.0, "Q": 0.25, "F": 15.0, "FEEDMODE": 94.0,
    })  # fmt: skip
    tapped = f"SPINDL/RPM,500,CLW\n{text.replace('DEEP', 'TAP').replace('STEP,6.35,MMPM,381', 'MMPR,1.27')}"
    ((_, words), _) = moves_of(tapped, units="inch")
    assert (words["PITCH"], words["F"], words["S"]) == pytest.approx((0.05, 25.0, 500.0))


def test_holes_by_moves_have_the_feed_of_their_cycle_and_leave_the_other_alone() -> None:
    text = "FROM/3,4,50\nSPINDL/RPM,500,CLW\nFEDRAT/170\nCYCLE/DRILL,DEPTH,7,MMPR,.3,CLEAR,2\nGOTO/11,13,0\nCYCLE/OFF\n"
    moves = moves_of(f"{text}GOTO/17,19,5\n", cycles="moves")
    feeds = [(words["Z"], words["F"], words["FEEDMODE"]) for macro, words in moves if macro == "LINEAR"]
    assert feeds == [(-7.0, 0.3, 95.0), (5.0, 170.0, 94.0)]


@pytest.mark.parametrize(("units", "scale"), [("mm", 1.0), ("inch", 25.4)])
def test_an_arc_begins_where_the_tool_is_in_the_unit_of_the_control(units: str, scale: float) -> None:
    text = "FROM/10,3,7\nFEDRAT/600\nCIRCLE/4,-5,7,0,0,1,10\nGOTO/-4,1,7\n"
    (_, words), *_ = moves_of(text, units=units)
    starts = [words[name] * scale for name in ("STARTX", "STARTY", "STARTZ", "X", "Y", "Z")]
    assert starts == pytest.approx([10.0, 3.0, 7.0, -4.0, 1.0, 7.0])
