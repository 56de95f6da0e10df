"""Tools: selection and change, length and radius compensation, and tools that are not in the table."""

from __future__ import annotations

import pytest

from support.programs import AXIS, FIVE, MILL, accepted, machine_config, moves, notes, refusal

NO_TABLE = "the machine has no tool table: lengths and radii of all tools are 0 mm"


def test_a_tool_is_selected_by_t_and_changed_by_m6() -> None:
    assert moves("T2\nM6\nT1 M6\nM6 T2\n", config=FIVE) == [
        "M6 T2",
        "wait 5",
        "M6 T1",
        "wait 5",
        "M6 T2",
        "wait 5",
    ]
    channel = accepted("T2\nM6 T1\nT2\n", config=FIVE)
    assert (channel.state.tool, channel.state.selected_tool) == (1, 2)


@pytest.mark.parametrize(
    ("block", "text"),
    [
        ("T-1", "1:1: T-1 is not a tool number"),
        ("T1.5 M6", "1:1: T1.5 is not a tool number"),
        ("G43 H-1", "1:5: H-1 is not a tool offset number"),
        ("G41 D0.5", "1:5: D0.5 is not a tool offset number"),
        ("D99999999999", "1:1: D99999999999 is not a tool offset number"),
        ("G43 G49", "1:5: G43 and G49 exclude each other (group 'length compensation')"),
        ("G41 G42", "1:5: G41 and G42 exclude each other (group 'radius compensation')"),
    ],
)
def test_words_that_are_no_tools(block: str, text: str) -> None:
    assert refusal(f"{block}\n") == text


def test_a_second_t_beside_a_change_is_the_next_tool() -> None:
    program = "T01T02M06\nG0 X1\nM06\n"
    assert [each for each in moves(program, config=FIVE, dialect="fanuc") if "T" in each] == [
        "M6 T1",
        "M6 T2",
    ]
    state = accepted("T02T01M06\n", config=FIVE, dialect="fanuc").state
    assert (state.tool, state.selected_tool) == (2, 1)
    assert refusal("T1 T2\n", dialect="fanuc") == "1:4: 'T' is given twice without a tool change"
    assert refusal("T1 T2 T3 M6\n", dialect="fanuc") == "1:7: 'T' is given twice in this block"
    assert refusal("T1 T2 M6\n") == "1:4: 'T' is given twice in this block"


# --- length


def test_length_compensation_shifts_z_by_the_length_and_its_wear() -> None:
    program = "G0 Z0\nG43 H1 Z10\nZ20\nG43 H2 Z20\nG44 Z20\nG49 Z20\n"
    # Tool 1 is 80 mm, tool 2 50 - 0.1 mm long; G44 without H takes the tool in the spindle, which is none.
    assert moves(program, config=FIVE) == [
        "rapid Z90 stop",
        "rapid Z100 stop",
        "rapid Z69.9 stop",
        "rapid Z20 stop",
    ]
    assert moves("T2 M6\nG0 Z0\nG44 Z100\n", config=FIVE)[-1] == "rapid Z50.1 stop"
    assert moves("T1 M6\nG0 G43 Z1\n", config=FIVE)[-1] == "rapid Z81 stop"


def test_g43_alone_does_not_move_and_incremental_moves_ignore_it() -> None:
    assert moves("G0 Z1\nG43 H1\nG91 Z1\nG90 Z1\n", config=FIVE) == [
        "rapid Z1 stop",
        "rapid Z2 stop",
        "rapid Z81 stop",
    ]


def test_h_alone_changes_the_length_while_compensation_is_active() -> None:
    assert moves("G0 G43 H1 Z0\nH2 Z0\nH0 Z0\n", config=FIVE) == [
        "rapid Z80 stop",
        "rapid Z49.9 stop",
        "rapid Z0 stop",
    ]
    assert notes("G0 H1 Z1\n", config=FIVE) == ["'H' has no effect here and is ignored"]


def test_length_is_in_mm_in_inch_programs_too() -> None:
    assert moves("G20 G0 G43 H1 Z1\n", config=FIVE) == ["rapid Z105.4 stop"]


def test_a_machine_without_z() -> None:
    config = machine_config(AXIS.format(name="X", low=-9, high=9))
    assert refusal("G43 H1\n", config=config) == "1:1: tool length compensation on a machine without a Z axis"
    assert moves("G49 G0 X1\n", config=config) == ["rapid X1 stop"]


# --- tools without data


def test_without_a_tool_table_everything_is_zero_and_said_once() -> None:
    program = "T5 M6\nG0 G43 H5 Z1\nG41 D5\nG1 F100 X10\nX20\nG40 X30\n"
    assert moves(program, config=MILL)[1:] == [
        "rapid Z1 stop",
        "line X10 F100",
        "line X20 F100",
        "line X30 F100",
    ]
    assert notes(program, config=MILL) == [NO_TABLE]


def test_no_tool_is_no_matter() -> None:
    assert notes("M6 T0\nG43 H0\nG41 D0\nG40 G49\n", config=MILL) == []


def test_a_tool_that_the_table_lacks_is_named() -> None:
    text = "tool {} is not in the machine's tool table: its length and radius are 0 mm"
    assert notes("T7 M6\nG43 H7\nG43 H8\n", config=FIVE) == [text.format(7), text.format(8)]


# --- radius


def test_the_tool_goes_beside_the_contour_by_its_radius() -> None:
    # Tool 1 has 5 mm. Left of a path in +X is +Y; the corner to +Y is an inside one.
    left = moves("G1 F100 Y-10\nG41 D1 Y0\nX20\nY20\nG40 X0\n", config=FIVE)
    assert left == ["line Y-10 F100", "line Y5 F100", "line X15 F100", "line Y20 F100", "line X0 F100"]
    # Right of it is -Y, and the corner an outside one: round it on an arc.
    right = moves("G1 F100 Y-20\nG42 D1 Y0\nX20\nY20\nG40 X0\n", config=FIVE)
    assert right == [
        "line Y-20 F100",
        "line Y-5 F100",
        "line X20 F100",
        "arc X25 Y0 about X20 Y0 by 90 F100",
        "line Y20 F100",
        "line X0 F100",
    ]


def test_radius_and_wear_add_up() -> None:
    assert moves("G1 F100 Y-10\nG41 D2 Y0\nX20\nG40 X30\n", config=FIVE)[1] == "line Y3.25 F100"


def test_without_d_the_tool_in_the_spindle_counts_and_d_is_modal() -> None:
    assert moves("T1 M6\nG1 F100 Y-10\nG41 Y0\nX20\nG40 X30\n", config=FIVE)[3] == "line Y5 F100"
    assert moves("T1 M6\nD2\nG1 F100 Y-10\nG41 Y0\nX20\nG40 X30\n", config=FIVE)[3] == "line Y3.25 F100"


def test_arcs_are_compensated_in_radius() -> None:
    steps = moves("G1 F100 X-10\nG41 D1 X0\nG3 X40 I20\nG40 G1 Y-10\n", config=FIVE)
    assert steps[2] == "arc X35 Y0 about X20 Y0 by 180 F100"


def test_the_last_compensated_move_is_not_lost_at_the_end() -> None:
    steps = moves("G1 F100 Y-10\nG41 D1 Y0\nX20\nM30\n", config=FIVE)
    assert steps[-2:] == ["line X20 F100 stop", "M30"]


def test_waits_keep_their_place() -> None:
    steps = moves("G1 F100 Y-10\nG41 D1 Y0\nX20\nM8\nG4 P1\nX40\nG40 X50\n", config=FIVE)
    assert steps == [
        "line Y-10 F100",
        "line Y5 F100",
        "line X20 F100 stop",
        "M8",
        "wait 0.25",
        "wait 1",
        "line X40 F100",
        "line X50 Y0 F100",
    ]


@pytest.mark.parametrize(
    ("program", "text"),
    [
        ("G41 D1\nG2 X20 I10", "3:1: radius compensation starts with an arc"),
        ("G41 D1 X10\nX20\nG42 X30", "4:1: radius compensation changes sides while active"),
        ("G41 D1 X10\nX20\nD2 X30", "4:1: the tool radius changes while radius compensation is active"),
        ("G41 D1 X10\nX20\nG18 X30", "4:1: the plane changes while radius compensation is active"),
        ("G41 D1 X10\nX20\nG92 X0", "4:1: G92 while radius compensation is active"),
        ("G41 D1 X10\nX20\nG92.1", "4:1: G92.1 while radius compensation is active"),
        ("G41 D1 X10\nX20\nG28", "4:1: G28 while radius compensation is active"),
        ("G41 D1 X10\nX20\nG53 X0", "4:1: G53 while radius compensation is active"),
        ("G41 D1 X10\nX20\nG81 X30 Z-1 R1", "4:1: G81 while radius compensation is active"),
        ("G41 D1 X10\nX20\nG2 X20 Y2 R1", "4:1: the arc radius 1 mm is smaller than the tool radius 5 mm"),
    ],
)
def test_what_radius_compensation_refuses(program: str, text: str) -> None:
    # Arcs to the right of the path turn away from the tool at its left.
    program = program.replace("G2 X20 Y2 R1", "G3 X20 Y2 R1")
    assert refusal(f"G1 F100\n{program}\n", config=FIVE) == text


def test_an_error_about_the_move_before_shows_that_move() -> None:
    """A pocket that is too narrow is seen one block later."""
    program = "G1 F100 Y-10\nG41 D1 Y0\nX20\nY3\nX0\nG40 X-10\n"
    found = refusal(program, config=FIVE)
    assert (
        found
        == "4:1: the compensated move would run backwards: the tool is too large for this part of the contour"
    )


def test_a_plane_that_the_machine_lacks() -> None:
    config = machine_config(AXIS.format(name="X", low=-9, high=9), AXIS.format(name="Z", low=-9, high=9))
    assert (
        refusal("G41\n", config=config)
        == "1:1: radius compensation in the plane XY, which this machine does not have"
    )


def test_limits_count_for_the_compensated_path() -> None:
    past = "axis Y would go to 304.000 mm, past its soft limit of 300.000 mm"
    assert (
        refusal("G1 F100 Y-10\nG41 D1 Y299\nX20\nG40 X30\n", config=FIVE)
        == f"2:1: with radius compensation {past}"
    )
    assert refusal("G1 F100 Y-10\nG41 D1 Y0\nX20 Z301\n", config=FIVE) == (
        "3:5: axis Z would go to 301.000 mm, past its soft limit of 300.000 mm"
    )
    inside = moves("G1 F100 Y-10\nG42 D1 Y304\nX20\nG40 X30 Y0\n", config=FIVE)
    assert inside[1:3] == ["line Y299 F100", "line X20 F100"]
    bulge = "G1 F100 X280\nG42 D1 X{}\nG3 Y20 J10\nG40 G1 X0\n"
    assert moves(bulge.format(285), config=FIVE)[2] == "arc X285 Y25 about X285 Y10 by 180 F100"  # up to 300
    assert refusal(bulge.format(286), config=FIVE) == (
        "3:1: with radius compensation axis X would pass 301.000 mm, past its soft limit of 300.000 mm"
    )
