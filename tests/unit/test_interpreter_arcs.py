"""Arcs: centres and radii, planes, helices, whole turns, and the arcs that are none."""

from __future__ import annotations

import math

import pytest

from polycnc.kernel import segment_point
from polycnc.nc import DIALECTS, load_dialect
from polycnc.nc.dialect._arc_settings import Arcs
from support.programs import AXIS, MILL, accepted, machine_config, moves, notes, prepare, refusal


@pytest.mark.parametrize(
    ("block", "item"),
    [
        ("G2 X10 Y10 I10", "arc X10 Y10 about X10 Y0 by -90 F100"),
        ("G2 X10 Y10 I10 J0", "arc X10 Y10 about X10 Y0 by -90 F100"),
        ("G3 X10 Y10 J10", "arc X10 Y10 about X0 Y10 by 90 F100"),
        ("G2 X10 Y10 J10", "arc X10 Y10 about X0 Y10 by -270 F100"),
        ("G3 X20 I10", "arc X20 Y0 about X10 Y0 by 180 F100"),
        ("G2 I10", "arc X0 Y0 about X10 Y0 by -360 F100"),
        ("G3 X0 Y0 J-5", "arc X0 Y0 about X0 Y-5 by 360 F100"),
        ("G2 I10 P3", "arc X0 Y0 about X10 Y0 by -1080 F100"),
        ("G3 X20 I10 P2", "arc X20 Y0 about X10 Y0 by 540 F100"),
        ("G2 X20 R10", "arc X20 Y0 about X10 Y0 by -180 F100"),
        ("G2 X10 Y10 R10", "arc X10 Y10 about X10 Y0 by -90 F100"),
        ("G2 X10 Y10 R-10", "arc X10 Y10 about X0 Y10 by -270 F100"),
        ("G3 X10 Y10 R10", "arc X10 Y10 about X0 Y10 by 90 F100"),
        ("G3 X10 Y10 R-10", "arc X10 Y10 about X10 Y0 by 270 F100"),
        ("G3 X10 Y10 R10 P2", "arc X10 Y10 about X0 Y10 by 450 F100"),
        ("G2 X10 Y10 Z-4 I10", "arc X10 Y10 Z-4 about X10 Y0 by -90 F100"),
        ("G2 I10 Z-4 P2", "arc X0 Y0 Z-4 about X10 Y0 by -720 F100"),
        ("G90.1 G2 X10 Y10 I10 J0", "arc X10 Y10 about X10 Y0 by -90 F100"),
        ("G91 G2 X10 Y10 I10", "arc X10 Y10 about X10 Y0 by -90 F100"),
        ("G2 X10 Y10 I10 K0", "arc X10 Y10 about X10 Y0 by -90 F100"),
    ],
)
def test_arcs_from_the_origin(block: str, item: str) -> None:
    assert moves(f"F100 {block}\n") == [item]


@pytest.mark.parametrize(
    ("plane", "block", "item"),
    [
        # Clockwise is seen from the positive end of the third axis towards the plane.
        ("G17", "G2 X10 Y10 I10", "arc X10 Y10 about X10 Y0 by -90 F100"),
        ("G18", "G2 Z10 X10 K10", "arc X10 Z10 about Z10 X0 by -90 F100"),
        ("G18", "G3 Z10 X10 I10", "arc X10 Z10 about Z0 X10 by 90 F100"),
        ("G19", "G2 Y10 Z10 J10", "arc Y10 Z10 about Y10 Z0 by -90 F100"),
        ("G18", "G2 X10 Z10 R10", "arc X10 Z10 about Z10 X0 by -90 F100"),
        ("G18", "G2 Z10 X10 Y3 K10", "arc X10 Y3 Z10 about Z10 X0 by -90 F100"),
        ("G19", "G3 K5 X2", "arc X2 Y0 Z0 about Y0 Z5 by 360 F100"),
    ],
)
def test_planes(plane: str, block: str, item: str) -> None:
    assert moves(f"F100\n{plane} {block}\n") == [item]


def test_centres_count_from_the_start_or_from_program_zero() -> None:
    shifted = machine_config(
        *[AXIS.format(name=n, low=-300, high=300) for n in "XYZ"], "[offsets]\nG54 = { X = 100 }\n"
    )
    program = "F100 G1 X5 Y0\nG2 X15 I5\nG90.1 G2 X25 I20 J0\nG91.1 G2 X35 I5\n"
    assert moves(program, config=shifted)[1:] == [
        "arc X115 Y0 about X110 Y0 by -180 F100",
        "arc X125 Y0 about X120 Y0 by -180 F100",
        "arc X135 Y0 about X130 Y0 by -180 F100",
    ]


def test_a_rounded_end_point_is_met_exactly() -> None:
    """The end lies 3 um off the circle: the path goes there all the same."""
    channel = accepted("F100 G2 X10 Y10.003 I10\n")
    state = channel.machine.state
    out = state.setpoint.copy()
    segment_point(state.seg, 0, float(state.seg.row[0]["length"]), out)
    assert out.tolist() == [10.0, 10.003, 0.0]


def test_the_tolerance_is_the_larger_of_both() -> None:
    assert refusal("F100 G2 X10 Y10.011 I10\n").startswith("1:21: the end point is 0.011")  # 0.010 mm
    assert moves("F100 G2 X100 Y100.09 I100\n") == ["arc X100 Y100.09 about X100 Y0 by -90 F100"]  # 0.1 %
    assert "off the circle" in refusal("F100 G2 X100 Y100.2 I100\n")


def test_a_radius_that_is_nearly_too_small_makes_a_half_turn() -> None:
    assert moves("F100 G2 X20 R9.995\n") == ["arc X20 Y0 about X10 Y0 by -180 F100"]
    assert refusal("F100 G2 X20 R9.9\n") == "1:13: the radius is 0.1 mm too small to reach the end point"


@pytest.mark.parametrize(
    ("block", "text"),
    [
        ("G2 X10 Y0 I4", "1:16: the end point is 2 mm off the circle about the given centre"),
        ("G2 X10 I5 R5", "1:16: an arc has both a radius R and a centre"),
        ("G2 X10 I0 J0", "1:13: the arc has no radius"),
        ("G2 X10 R0", "1:13: the arc has no radius"),
        ("G2 R5", "1:9: an arc with R ends where it starts, so its centre is unknown"),
        ("G2 X10 Y0 K5", "1:16: 'K' is no centre word of the plane XY"),
        ("G18 G2 X10 J5", "1:17: 'J' is no centre word of the plane ZX"),
        ("G2 X10 I5 P0", "1:16: the number of turns P0 of an arc is not a whole number from 1 up"),
        ("G2 X10 I5 P1.5", "1:16: the number of turns P1.5 of an arc is not a whole number from 1 up"),
        ("G2 X10 R3000000000", "1:13: the radius of the arc is larger than any machine"),
        ("G1 X10 I5", "1:13: 'I' has no meaning in this block"),
        ("G0 X10 R5", "1:13: 'R' has no meaning in this block"),
    ],
)
def test_arcs_that_are_none(block: str, text: str) -> None:
    assert refusal(f"F100 {block}\n") == text


# --- neither centre nor radius


STRAIGHT = load_dialect("din").model_copy(update={"arcs": Arcs(no_center="line")})


@pytest.mark.parametrize("dialect", DIALECTS)
@pytest.mark.parametrize(
    ("block", "place"),
    [
        ("G2 X13.5 Y-4.25", 1),
        ("G3 X0 Y0", 1),  # no way to go is no centre either
        ("G2 Z-7.5", 1),  # a helix that has lost its centre
        ("G2 X13.5 Y-4.25 K0", 1),  # K is no centre in this plane, and 0 says nothing
        ("G2 X13.5 P2", 1),
    ],
)
def test_an_arc_without_a_centre_is_refused_in_every_dialect(dialect: str, block: str, place: int) -> None:
    """Lost centre words must not cut the chord."""
    assert refusal(f"G17 F100\n{block}\n", dialect=dialect) == f"2:{place}: an arc needs a centre or a radius"


def test_a_move_after_a_circle_without_its_own_motion_word_is_refused() -> None:
    channel = prepare("F100 G2 I-1.1\nX.75\nZ.2\n", collect_errors=True)
    assert [str(error).splitlines()[0] for error in channel.errors] == [
        f"test.nc:{line}:1: an arc needs a centre or a radius" for line in (2, 3)
    ]
    assert "G1" in channel.errors[0].hint


def test_a_dialect_can_let_it_go_straight() -> None:
    """As FANUC controls do with bit 5 (CIR) of parameter 3403 at 0."""
    program = "F100 G2 I-1.1\nX.75\nZ.2\n"
    channel = accepted(program, dialect=STRAIGHT)
    assert [message.text for message in channel.messages.all()] == [
        "an arc with neither centre nor radius goes straight to its end point"
    ]
    assert moves(program, dialect=STRAIGHT) == [
        "arc X0 Y0 about X-1.1 Y0 by -360 F100",
        "line X0.75 F100",
        "line Z0.2 F100",
    ]


def test_an_arc_word_alone_only_selects_the_motion() -> None:
    assert moves("F100 G2\nX20 I10\n") == ["arc X20 Y0 about X10 Y0 by -180 F100"]
    assert notes("F100 G2\nX20 I10\n") == []


# --- limits


def test_an_arc_that_bulges_past_a_limit_is_refused_though_its_ends_are_inside() -> None:
    assert moves("F100 G1 X295\nG3 Y10 J5\n")[-1] == "arc X295 Y10 about X295 Y5 by 180 F100"  # up to X 300
    assert refusal("F100 G1 X296\nG3 Y10 J5\n") == (
        "2:1: axis X would pass 301.000 mm, past its soft limit of 300.000 mm"
    )
    assert (
        moves("F100 G1 X296\nG2 Y10 J5\n")[-1] == "arc X296 Y10 about X296 Y5 by -180 F100"
    )  # the other side


def test_a_full_circle_may_touch_a_limit() -> None:
    assert moves("F100 G1 X299\nG2 I-1\n")[-1] == "arc X299 Y0 about X298 Y0 by -360 F100"
    assert "would pass 301.000" in refusal("F100 G1 X299\nG2 I1\n")


def test_a_helix_past_a_limit_of_its_third_axis() -> None:
    assert refusal("F100\nG2 I1 Z-301\n").startswith("2:7: axis Z would go to -301.000 mm")


def test_many_turns_take_no_time_to_check() -> None:
    assert moves("F100 G2 I1 P999999\n") == ["arc X0 Y0 about X1 Y0 by -359999640 F100"]


def test_a_machine_without_the_axes_of_the_plane() -> None:
    lathe = machine_config(AXIS.format(name="X", low=-9, high=9), AXIS.format(name="Z", low=-9, high=9))
    assert (
        refusal("F100 G2 X1 I1\n", config=lathe)
        == "1:6: an arc in the plane XY, which this machine does not have"
    )
    assert moves("F100 G18\nG2 X2 I1\n", config=lathe) == ["arc X2 Z0 about Z0 X1 by -180 F100"]


def test_the_real_program_with_arcs_without_centres_runs_to_its_end() -> None:
    """The shape of a public engraving program: full circles by I or J alone, then X with G2 in force."""
    program = (
        "G0 X.75 Y-3.4\nG1 Z-.5 F10.\nX.5 F30.\nG2 I-1.1\nX.75\nZ.2\nG0 X-4.75\nG1 X-4.5\nG2 I1.1\nG1 X-4.75"
    )
    channel = prepare(program, config=MILL, dialect=STRAIGHT)
    assert channel.error is None
    assert channel.blocks == 10
    circle = channel.machine.state.seg.row[3]
    assert circle["length"] == pytest.approx(2.0 * math.pi * 1.1, rel=1e-12)
