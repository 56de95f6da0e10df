"""Straight moves: words, modal motion, absolute and incremental, exact stop, soft limits, rotary axes."""

from __future__ import annotations

import pytest

from support.programs import (
    AXIS,
    FIVE,
    LINEAR,
    ROTARY,
    SPINDLE,
    accepted,
    machine_config,
    moves,
    notes,
    refusal,
)


def test_rapids_and_feed_moves_by_modal_motion() -> None:
    assert moves("G0 X1 Y2\nZ3\nG1 X4 F120\nY5\nM30\n") == [
        "rapid X1 Y2 stop",
        "rapid Z3 stop",
        "line X4 F120",
        "line Y5 F120 stop",
        "M30",
    ]


def test_without_a_motion_word_moves_are_straight_feed_moves() -> None:
    assert moves("F50 X1\n") == ["line X1 F50"]


@pytest.mark.parametrize(
    "block",
    ["g1x10y-2.5f100", "N5 G01 X+10. Y-2.5 F100", "X=10 Y=-2.5 F=100 G1", "G1 X10 (note) Y-02.50 F0100"],
)
def test_ways_to_write_the_same_block(block: str) -> None:
    assert moves(block + "\n") == ["line X10 Y-2.5 F100"]


def test_block_numbers_blank_lines_and_percent_lines_do_nothing() -> None:
    program = "%\n\nN10 G0 X1\n   \nX2 N7\nN5\n(only a remark)\n; and another\nN5 X3\n%\nX9\n"
    assert moves(program) == ["rapid X1 stop", "rapid X2 stop", "rapid X3 stop"]


def test_a_leading_comment_does_not_make_the_first_percent_the_last() -> None:
    assert moves("(from a CAM system)\n%\nG0 X1\n%\n") == ["rapid X1 stop"]


def test_a_file_that_simply_ends_is_a_program() -> None:
    assert moves("G0 X1") == ["rapid X1 stop"]
    assert moves("") == []


def test_incremental_moves_count_from_the_last_position() -> None:
    assert moves("G91 G0 X10 Y1\nX10\nG90 X5\nG91 X-1\n") == [
        "rapid X10 Y1 stop",
        "rapid X20 stop",
        "rapid X5 stop",
        "rapid X4 stop",
    ]


def test_a_move_to_where_the_machine_stands_is_no_item() -> None:
    assert moves("G1 F100 X1\nX1\nG91 Y0\n") == ["line X1 F100"]


def test_a_feed_move_before_a_rapid_comes_to_rest() -> None:
    assert moves("G1 F100 X1\nX2\nG0 X3\nG1 X4\n") == [
        "line X1 F100",
        "line X2 F100 stop",
        "rapid X3 stop",
        "line X4 F100",
    ]


@pytest.mark.parametrize("code", ["G61", "G60"])
def test_exact_stop_is_modal_until_continuous(code: str) -> None:
    assert moves(f"F100 X1\n{code} X2\nX3\nG64 X4\n") == [
        "line X1 F100",
        "line X2 F100 stop",
        "line X3 F100 stop",
        "line X4 F100",
    ]


def test_exact_stop_of_one_block() -> None:
    assert moves("F100 X1\nG9 X2\nX3\n") == ["line X1 F100", "line X2 F100 stop", "line X3 F100"]


def test_g64_with_p_rounds_corners_and_without_takes_the_machines_tolerance() -> None:
    sharp = ["line X10 F100", "line X20 F100", "line Y10 F100"]
    program = "F100 X10\nX20\n{} Y10\n"
    assert moves(program.format("")) == sharp
    assert moves(program.format("G64")) == sharp
    assert moves(program.format("G64 P0")) == sharp
    rounded = moves(program.format("G64 P0.1"))
    assert [item.split()[0] for item in rounded] == ["line", "line", "round", "line"]
    tolerant = machine_config(LINEAR, "[path]\npath_tolerance_mm = 0.1\n")
    assert moves(program.format(""), config=tolerant) == rounded
    assert moves(program.format("G64 P0"), config=tolerant) == sharp
    assert moves("G64 P0\n" + program.format("G64"), config=tolerant) == rounded


# --- limits


@pytest.mark.parametrize(
    ("block", "text"),
    [
        ("G0 X300.01", "2:4: axis X would go to 300.010 mm, past its soft limit of 300.000 mm"),
        ("G1 F100 X1 Y-301", "2:12: axis Y would go to -301.000 mm, past its soft limit of -300.000 mm"),
        ("G91 G0 Z-400", "2:8: axis Z would go to -400.000 mm, past its soft limit of -300.000 mm"),
    ],
)
def test_a_move_past_a_soft_limit(block: str, text: str) -> None:
    assert refusal(f"(first)\n{block}\n") == text


def test_a_position_on_a_limit_but_for_rounding_is_on_it() -> None:
    exact = machine_config(AXIS.format(name="X", low=0, high=0.3))
    assert moves("G91 G0 X0.1\nX0.2\n", config=exact) == ["rapid X0.1 stop", "rapid X0.3 stop"]
    assert refusal("G0 X0.30001\n", config=exact).startswith("1:4: axis X would go to 0.300 mm")


def test_numbers_beyond_any_machine_are_refused_where_there_is_no_limit() -> None:
    endless = machine_config('[[axis]]\nname = "X"\nvmax_mm_s = 500\namax_mm_s2 = 5000\n', ROTARY)
    assert moves("G0 X999999999\n", config=endless) == ["rapid X999999999 stop"]
    for word in ("X10000000000", "C10000000000", f"X1{'0' * 300}"):
        assert "further than any machine" in refusal(f"G0 {word}\n", config=endless)


# --- rotary axes


@pytest.mark.parametrize(
    ("start", "target", "end"),
    [(0, 350, -10), (0, 180, 180), (0, -180, 180), (0, 181, -179), (-10, 10, 10), (350, 5, 5), (0, 725, 5)],
)
def test_an_axis_whose_positions_repeat_goes_the_short_way(start: int, target: int, end: int) -> None:
    # 350 is reached as -10, so the second position is next to that.
    first = -10 if start == 350 else start
    steps = moves(f"G0 C{start}\nC{target}\n", config=FIVE)
    assert steps[-1] == f"rapid C{end} stop" if end != first else not steps[1:]


def test_it_goes_on_from_where_it_really_is() -> None:
    assert moves("G0 C170\nC-170\nC0\n", config=FIVE) == [
        "rapid C170 stop",
        "rapid C190 stop",
        "rapid C360 stop",
    ]


def test_incremental_it_turns_as_often_as_it_is_told() -> None:
    assert moves("G91 G0 C725\nC-10\n", config=FIVE) == ["rapid C725 stop", "rapid C715 stop"]


def test_a_rotary_axis_with_ends_goes_where_it_is_told() -> None:
    assert moves("G0 A110\nA-110\n", config=FIVE) == ["rapid A110 stop", "rapid A-110 stop"]
    assert refusal("G0 A350\n", config=FIVE).startswith("1:4: axis A would go to 350.000 deg, past its soft")


def test_an_axis_with_a_long_name() -> None:
    config = machine_config(LINEAR, AXIS.format(name="X2", low=-10, high=10))
    assert moves("G0 X1 X2=5\nX2=-3\n", config=config) == ["rapid X1 X25 stop", "rapid X2-3 stop"]
    assert refusal("G0 X3=5\n", config=config).startswith("1:4: there is no axis 'X3' on machine 'test'")


def test_an_axis_r_is_no_radius() -> None:
    config = machine_config(LINEAR, AXIS.format(name="R", low=-100, high=100))
    assert moves("G0 R5\nG2 X10 I5 F100 R6\n", config=config) == [
        "rapid R5 stop",
        "arc X10 Y0 R6 about X5 Y0 by -180 F100",
    ]


# --- messages


def test_what_is_ignored_is_said_once() -> None:
    assert notes("G1 X1 F100 Q5\nX2 Q6\nX3 L2\n") == [
        "'Q' has no effect here and is ignored",
        "'L' has no effect here and is ignored",
    ]
    messages = accepted("G1 X1 F100 Q5\nX2 Q6\n").messages.all()
    assert [(message.line, message.count) for message in messages] == [(1, 2)]


def test_a_plain_cam_program_says_nothing() -> None:
    program = "%\nO1000\nG21\nG0 G17 G40 G49 G80 G90 G54\nG0 X0 Y0 S1000 M3\nG1 Z-1 F100\nG28 Z0\nM30\n%\n"
    homed = machine_config(LINEAR + "home_mm = 250\n", SPINDLE)
    assert notes(program, config=homed) == []


def test_messages_of_the_program() -> None:
    assert notes("(MSG, hello there)\nG0 X1 (MSG,bye)\n") == ["MSG: hello there", "MSG: bye"]
