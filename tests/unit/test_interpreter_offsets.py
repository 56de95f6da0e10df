"""Where program zero is: work offsets, G92, machine coordinates, the way home."""

from __future__ import annotations

import pytest

from support.programs import (
    AXIS,
    FIVE,
    LINEAR,
    MILL,
    OFFSETS,
    accepted,
    machine_config,
    moves,
    notes,
    refusal,
)

OFFSET = machine_config(LINEAR, OFFSETS)


def test_work_offsets_shift_absolute_positions() -> None:
    assert moves("G0 X1\nG55 X1 Y1 Z1\nG56 X1\nG54 X1\n", config=OFFSET) == [
        "rapid X1 stop",
        "rapid X101 Y51 Z-19 stop",
        "rapid X-9.5 stop",
        "rapid X1 stop",
    ]


def test_selecting_an_offset_does_not_move_and_incremental_moves_ignore_it() -> None:
    assert moves("G55\nG91 G0 X1\nG90 X0\n", config=OFFSET) == ["rapid X1 stop", "rapid X100 stop"]


def test_g54_is_in_force_from_the_start() -> None:
    config = machine_config(LINEAR, "[offsets]\nG54 = { X = 7 }\n")
    assert moves("G0 X1\n", config=config) == ["rapid X8 stop"]


def test_offsets_are_in_mm_whatever_the_unit_of_the_program() -> None:
    assert moves("G20 G55 G0 X1\n", config=OFFSET) == ["rapid X125.4 stop"]


def test_g54_without_a_table_is_zero_and_no_matter() -> None:
    assert notes("G54 G0 X1\n", config=MILL) == []


@pytest.mark.parametrize("code", ["G55", "G59"])
def test_any_other_offset_without_a_table_is_said_once(code: str) -> None:
    assert notes(f"{code} G0 X1\n{code} X2\n", config=MILL) == [
        f"{code}: the machine has no such work offset; zero is used"
    ]


def test_an_offset_that_the_table_lacks() -> None:
    assert notes("G57\n", config=OFFSET) == ["G57: the machine has no such work offset; zero is used"]


def test_the_three_groups_of_bosch_add_up() -> None:
    program = "G0 X0\nG154 X0\nG254 X0\nG55 X0\nG153 X0\nG53 X0\nG253 X0\n"
    assert moves(program, config=OFFSET, dialect="bosch") == [
        "rapid X1 stop",
        "rapid X1.25 stop",
        "rapid X101.25 stop",
        "rapid X100.25 stop",
        "rapid X0.25 stop",
        "rapid X0 stop",
    ]


# --- G92


def test_set_position_shifts_program_zero_and_moves_nothing() -> None:
    assert moves("G0 X100 Y200\nG92 X75 Y125\nX75\nX0 Y0\n") == ["rapid X100 Y200 stop", "rapid X25 Y75 stop"]


def test_the_shift_is_the_difference_of_both_positions() -> None:
    """The example of manual 003, AXO: X100 Y200, then G92 X75 Y125, shifts by 25 and 75."""
    channel = accepted("N10 G1 G90 X100 Y200 F1000\nN20 G92 X75 Y125\n", dialect="bosch")
    assert channel.state.coordinates.shift.tolist() == [25.0, 75.0, 0.0]


def test_set_position_again_and_with_a_work_offset() -> None:
    assert moves("G55 G0 X0\nG92 X10\nX0\nG92 X5\nX0\nG54 X0\nG92.1\nX0\n", config=OFFSET) == [
        "rapid X100 stop",
        "rapid X90 stop",
        "rapid X85 stop",
        "rapid X-15 stop",
        "rapid X0 stop",
    ]


def test_set_position_in_inch_and_incremental() -> None:
    assert moves("G20 G91 G0 X1\nG92 X2\nG90 X0\n") == ["rapid X25.4 stop", "rapid X-25.4 stop"]


def test_set_position_of_an_axis_that_turns_over() -> None:
    assert moves("G0 C350\nG92 C0\nC20\n", config=FIVE) == ["rapid C-10 stop", "rapid C10 stop"]


# --- machine coordinates


def test_a_move_in_machine_coordinates_holds_for_its_block() -> None:
    assert moves("G55 G0 X0\nG53 X5 Z-1\nX1\n", config=OFFSET) == [
        "rapid X100 stop",
        "rapid X5 Z-1 stop",
        "rapid X101 stop",
    ]


def test_machine_coordinates_are_absolute_with_g91_too() -> None:
    assert moves("G91 G0 X5\nG53 X2\n") == ["rapid X5 stop", "rapid X2 stop"]


def test_machine_coordinates_without_an_axis_are_no_move() -> None:
    assert moves("G1 G53 G90 G40\nG53 F60 X2\n") == ["line X2 F60"]


def test_machine_coordinates_of_an_axis_that_turns_over() -> None:
    assert moves("G0 C10\nG53 C350\n", config=FIVE) == ["rapid C10 stop", "rapid C-10 stop"]


def test_machine_coordinates_with_feed() -> None:
    assert moves("G20 F10 G1 X1\nG53 X2\n") == ["line X25.4 F254", "line X50.8 F254"]


@pytest.mark.parametrize("block", ["G53 G2 X1 I1", "G53 G81 X1 Z-1 R1"])
def test_machine_coordinates_go_with_straight_moves_only(block: str) -> None:
    assert refusal(f"F100\n{block}\n") == "2:1: G53 goes with G0 or G1 only"


def test_machine_coordinates_inside_a_drilling_cycle() -> None:
    assert refusal("F100 G81 X1 Z-1 R1\nG53 Z0\n") == "2:1: G53 goes with G0 or G1 only"
    assert moves("F100 G81 X1 Z-1 R1\nG53 G0 Z9\n")[-1] == "rapid Z9 stop"


# --- home

HOMES = machine_config(
    AXIS.format(name="X", low=-300, high=300) + "home_mm = 10\n",
    AXIS.format(name="Y", low=-300, high=300) + "home_mm = 20\n",
    AXIS.format(name="Z", low=-300, high=300) + "home_mm = 30\n",
)


def test_home_by_way_of_a_point_with_the_axes_that_are_named() -> None:
    assert moves("G0 X0 Y0 Z0\nG28 Z5\nG91 G28 X0 Y0\n", config=HOMES)[1:] == [
        "rapid Z5 stop",
        "rapid Z30 stop",
        "rapid X10 Y20 stop",
    ]


def test_home_without_an_axis_is_all_axes() -> None:
    assert moves("G0 X0 Y0 Z0\nG28\n", config=HOMES)[1:] == ["rapid X10 Y20 Z30 stop"]


def test_a_motion_word_beside_it_stays_in_force() -> None:
    assert moves("F100 G1 X0\nG0 G28 X5\nX7\n", config=HOMES)[1:] == [
        "rapid X5 stop",
        "rapid X10 stop",
        "rapid X7 stop",
    ]


def test_the_point_on_the_way_home_keeps_the_limits() -> None:
    assert refusal("G28 X301\n") == "1:5: axis X would pass 301.000 mm, past its soft limit of 300.000 mm"
    assert refusal("G0 Z1\nG91 G28 Z-302\n").startswith("2:9: axis Z would pass -301.000 mm")


def test_home_itself_keeps_the_limits() -> None:
    config = machine_config(AXIS.format(name="X", low=0, high=9) + "home_mm = 12\n", "[start]\nX = 1\n")
    assert refusal("G28\n", config=config).startswith(
        "1:1: axis X would go home to 12.000 mm, past its soft limit"
    )


def test_home_of_an_axis_that_turns_over_is_the_short_way() -> None:
    assert moves("G91 G0 C725\nG90 G28\n", config=FIVE)[1:] == ["rapid C720 stop"]


@pytest.mark.parametrize(
    ("block", "text"),
    [
        ("G92", "2:1: G92 without an axis"),
        ("G92 G1 X1", "2:5: G92 and G1 exclude each other: both use the axis words"),
        ("G28 G2 X1", "2:5: G28 and G2 exclude each other: both use the axis words"),
        ("G28 G81 X1", "2:5: G28 and G81 exclude each other: both use the axis words"),
        ("G28 G92 X1", "2:5: G28 and G92 exclude each other (group 'non modal')"),
        ("G28 G53 X1", "2:5: G28 and G53 exclude each other (group 'non modal')"),
        ("G4 P1 G28", "2:7: G4 and G28 exclude each other: both need their own block"),
        ("G92.1 X1", "2:7: 'X' cannot be combined with this function"),
        ("G54 G55", "2:5: G54 and G55 exclude each other (group 'work offset')"),
    ],
)
def test_contradictions(block: str, text: str) -> None:
    assert refusal(f"F100\n{block}\n") == text
