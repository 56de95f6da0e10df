"""Drilling cycles in programs: which block drills, which words stay, where it starts and how it ends."""

from __future__ import annotations

import pytest

from support.programs import AXIS, FIVE, LINEAR, OFFSETS, machine_config, moves, refusal

# From Z 10: G81 at X 5 Y 7, down to -3 from R 2.
HOLE = ["rapid X5 Y7 stop", "rapid Z2 stop", "line Z-3 F100 stop", "rapid Z10 stop"]
START = "F100 G0 Z10\n"


def drill(program: str, **options: object) -> list[str]:
    """Return what a program does after the way to Z 10."""
    return moves(START + program, **options)[1:]


def test_a_hole() -> None:
    assert drill("G81 X5 Y7 Z-3 R2\n") == HOLE


def test_each_block_with_a_position_drills_until_g80() -> None:
    assert drill("G81 X5 Y7 Z-3 R2\nX6\nM8\nY8\nG80\nX0\n") == [
        *HOLE,
        "rapid X6 stop",
        *HOLE[1:],
        "M8",
        "rapid Y8 stop",
        *HOLE[1:],
        "rapid X0 stop",
    ]


@pytest.mark.parametrize("code", ["G0", "G1", "G2"])
def test_a_motion_word_ends_the_cycle_too(code: str) -> None:
    end = {"G0": "rapid X20 stop", "G1": "line X20 F100", "G2": "arc X20 Y7 about X12.5 Y7 by -180 F100"}[
        code
    ]
    center = " I7.5" if code == "G2" else ""
    assert drill(f"G81 X5 Y7 Z-3 R2\n{code} X20{center}\n") == [*HOLE, end]


def test_behind_g80_the_motion_from_before_the_cycle_is_in_force() -> None:
    assert drill("G81 X5 Y7 Z-3 R2\nG80 X9\n")[-1] == "rapid X9 stop"
    assert drill("G1 Y0\nG81 X5 Y7 Z-3 R2\nG80\nX9\n")[-1] == "line X9 F100"


def test_cycle_words_stay_in_force_and_can_change() -> None:
    steps = drill("G81 X5 Y7 Z-3 R2\nX6 Z-4\nX7 R1\nG82 X8 P.5\n")
    assert [step for step in steps if step.startswith(("line", "wait")) or step == "rapid Z1 stop"] == [
        "line Z-3 F100 stop",
        "line Z-4 F100 stop",
        "rapid Z1 stop",
        "line Z-4 F100 stop",
        "rapid Z1 stop",
        "line Z-4 F100 stop",
        "wait 0.5",
    ]


def test_they_are_forgotten_with_the_cycle() -> None:
    assert refusal(START + "G81 X5 Y7 Z-3 R2\nG80\nG81 X6\n") == "4:1: G81 needs a depth (Z)"


def test_words_without_a_position_are_stored() -> None:
    assert drill("G81\nG98 F100\nX5 Y7 Z-3 R2\n") == HOLE


def test_the_initial_level_is_where_the_first_cycle_began() -> None:
    steps = drill("G99 G81 X5 Y7 Z-3 R2\nX6\nG98 X7\n")
    assert steps == [
        "rapid X5 Y7 stop",
        "rapid Z2 stop",
        "line Z-3 F100 stop",
        "rapid Z2 stop",
        "rapid X6 stop",
        "line Z-3 F100 stop",
        "rapid Z2 stop",
        "rapid X7 stop",
        "line Z-3 F100 stop",
        "rapid Z10 stop",
    ]
    # Another cycle goes on with it, a new one after G80 has its own.
    assert drill("G99 G81 X5 Y7 Z-3 R2\nG98 G82 X6\n")[-1] == "rapid Z10 stop"
    assert drill("G99 G81 X5 Y7 Z-3 R2\nG80\nG98 G82 X6 Z-3 R1\n")[-1] == "rapid Z2 stop"


def test_incremental_levels_and_holes() -> None:
    # R counts from the initial level, Z from R.
    steps = drill("G91 G81 X5 Y7 Z-5 R-8 L3\n")
    assert steps == [
        *HOLE,
        "rapid X10 Y14 stop",
        *HOLE[1:],
        "rapid X15 Y21 stop",
        *HOLE[1:],
    ]
    # From X4 Y-6: the ways of both axes are the block's, not the way from zero.
    steps = drill("X4 Y-6\nG91 G81 X5 Y7 Z-5 R-8 L3\n")
    assert [each for each in steps if "X" in each] == [
        "rapid X4 Y-6 stop",
        "rapid X9 Y1 stop",
        "rapid X14 Y8 stop",
        "rapid X19 Y15 stop",
    ]


@pytest.mark.parametrize("word", ["L", "K"])
def test_repetitions(word: str) -> None:
    assert drill(f"G91 G81 X1 Z-5 R-8 {word}2\nX1\n")[4] == "rapid X2 stop"
    assert drill(f"G81 X5 Y7 Z-3 R2 {word}0\nX5 Y7\n") == HOLE
    assert len(drill(f"G81 X5 Y7 Z-3 R2 {word}2\n")) == 7  # the same hole twice


def test_levels_are_program_levels() -> None:
    config = machine_config(LINEAR, OFFSETS)
    assert moves("F100 G55 G0 Z30\nG81 X5 Y7 Z-3 R2\n", config=config)[1:] == [
        "rapid X105 Y57 stop",
        "rapid Z-18 stop",
        "line Z-23 F100 stop",
        "rapid Z10 stop",
    ]


def test_stored_levels_follow_a_new_work_offset() -> None:
    config = machine_config(LINEAR, OFFSETS)
    steps = moves("F100 G0 Z30\nG99 G81 X5 Z-3 R2\nG55 X5 Y0\n", config=config)[1:]
    assert steps == [
        *("rapid X5 stop", "rapid Z2 stop", "line Z-3 F100 stop", "rapid Z2 stop"),
        *("rapid X105 Y50 stop", "rapid Z-18 stop", "line Z-23 F100 stop", "rapid Z-18 stop"),
    ]
    assert "R -1 lies below Z 1" in refusal("F100 G55 G81 X1 Z1 R-1\n", config=config)


def test_in_inch() -> None:
    assert moves("G20 F10 G0 Z1\nG83 X1 Z-1 R.5 Q1\n")[1:] == [
        "rapid X25.4 stop",
        "rapid Z12.7 stop",
        "line Z-12.7 F254 stop",
        "rapid Z12.7 stop",
        "rapid Z-11.7 stop",
        "line Z-25.4 F254 stop",
        "rapid Z25.4 stop",
    ]


@pytest.mark.parametrize(
    ("plane", "words", "steps"),
    [
        (
            "G18",
            "X5 Z7 Y-3 R2",
            ["rapid X5 Z7 stop", "rapid Y2 stop", "line Y-3 F100 stop", "rapid Y10 stop"],
        ),
        (
            "G19",
            "Y5 Z7 X-3 R2",
            ["rapid Y5 Z7 stop", "rapid X2 stop", "line X-3 F100 stop", "rapid X10 stop"],
        ),
    ],
)
def test_a_cycle_drills_along_the_normal_of_the_plane(plane: str, words: str, steps: list[str]) -> None:
    axis = {"G18": "Y", "G19": "X"}[plane]
    assert moves(f"F100 {plane} G0 {axis}10\nG81 {words}\n")[1:] == steps


def test_other_axes_are_positioned_first() -> None:
    assert drill("G81 X5 Y7 Z-3 R2 A30\n", config=FIVE)[:2] == ["rapid A30 stop", "rapid X5 Y7 stop"]


def test_deep_hole_and_chip_breaking() -> None:
    assert drill("G83 X5 Y7 Z-3 R2 Q2\n")[2:] == [
        "line Z0 F100 stop",
        "rapid Z2 stop",
        "rapid Z1 stop",
        "line Z-2 F100 stop",
        "rapid Z2 stop",
        "rapid Z-1 stop",
        "line Z-3 F100 stop",
        "rapid Z10 stop",
    ]
    assert drill("G73 X5 Y7 Z-3 R2 Q3\n")[2:] == [
        "line Z-1 F100 stop",
        "rapid Z0 stop",
        "line Z-3 F100 stop",
        "rapid Z10 stop",
    ]


def test_tapping_reverses_the_spindle_and_back() -> None:
    assert drill("M3 S500\nG95 G84 X5 Y7 Z-3 R2 F1.5\n")[1:] == [
        "rapid X5 Y7 stop",
        "rapid Z2 stop",
        "line Z-3 F750 stop",
        "M5",
        "M4",
        "line Z2 F750 stop",
        "M5",
        "M3",
        "rapid Z10 stop",
    ]


def test_boring_cycles() -> None:
    spindle = "M3 S500\n"
    assert drill(spindle + "G85 X5 Y7 Z-3 R2\n")[3:] == [
        "line Z-3 F100 stop",
        "line Z2 F100 stop",
        "rapid Z10 stop",
    ]
    assert drill(spindle + "G86 X5 Y7 Z-3 R2 P1\n")[3:] == [
        "line Z-3 F100 stop",
        "wait 1",
        "M5",
        "rapid Z10 stop",
        "M3",
    ]
    assert drill(spindle + "G76 X5 Y7 Z-3 R2 Q1\n")[3:] == [
        "line Z-3 F100 stop",
        "M5",
        "M19",
        "rapid X6 stop",
        "rapid Z10 stop",
        "rapid X5 stop",
        "M3",
    ]
    back = drill(spindle + "G87 X5 Y7 Z-3 R2 I1 K1\n")
    assert [step for step in back if step.startswith("line")] == ["line Z1 F100 stop", "line Z-3 F100 stop"]
    assert "M0" in drill(spindle + "G88 X5 Y7 Z-3 R2\n")
    assert drill(spindle + "G89 X5 Y7 Z-3 R2 P1\n")[3:6] == [
        "line Z-3 F100 stop",
        "wait 1",
        "line Z2 F100 stop",
    ]


def test_the_dwell_counts_in_the_units_of_the_dialect() -> None:
    assert "wait 0.5" in drill("G82 X5 Z-3 R2 P.5\n")
    assert "wait 0.5" in drill("G82 X5 Z-3 R2 P500\n", dialect="fanuc")


def test_words_of_a_call_or_a_dwell_are_none_of_the_cycle() -> None:
    """P and L belong to M98, P to G4, though a cycle is active."""
    program = START + "G82 Z-3 R2 P.5 L0\nM98 P100 L2\nG4 P1\nX20\nM30\nO100\nG91 X5\nG90\nM99\n"
    steps = [step for step in moves(program) if step.startswith(("rapid X", "wait"))]
    assert steps == [
        *("rapid X5 stop", "wait 0.5"),
        *("rapid X10 stop", "wait 0.5"),
        "wait 1",
        *("rapid X20 stop", "wait 0.5"),
    ]


@pytest.mark.parametrize(
    ("block", "text"),
    [
        ("G81 X1 R1", "2:1: G81 needs a depth (Z)"),
        ("G81 X1 Z1 R-1", "2:11: G81 would drill upwards: R -1 lies below Z 1"),
        ("G83 X1 Z-1 R1", "2:1: G83 needs a peck (Q)"),
        ("G83 X1 Z-1 R1 Q0", "2:15: G83 pecks 0 mm"),
        ("G83 X1 Z-1 R1 Q.00001", "2:15: G83 would peck 200000 times"),
        ("G82 X1 Z-1 R1 P-1", "2:15: G82 dwells -1 s"),
        ("G81 X1 Z-1 R1 L-1", "2:15: L-1 is not a number of holes"),
        ("G81 X1 Z-1 R1 L1.5", "2:15: L1.5 is not a number of holes"),
        ("G81 X1 Z-1 R1 L2 K2", "2:18: L and K both say how many holes to drill"),
        ("G84 X1 Z-1 R1", "2:1: G84 needs a turning spindle"),
        ("G93 G81 X1 Z-1 R1 F10", "2:5: G81 with inverse time feed (G93)"),
        ("G80 G81 X1 Z-1 R1", "2:5: G80 and G81 exclude each other: one ends what the other begins"),
        ("G0 G81 X1 Z-1 R1", "2:4: G0 and G81 exclude each other (group 'motion')"),
        ("G98 G99", "2:5: G98 and G99 exclude each other (group 'retract')"),
        ("G81 X1 Z-301 R1", "2:8: axis Z would go to -301.000 mm, past its soft limit of -300.000 mm"),
        ("G81 X301 Z-1 R1", "2:5: axis X would go to 301.000 mm, past its soft limit of 300.000 mm"),
        ("G91 G81 X200 Z-1 R-1 L2", "2:9: axis X would go to 400.000 mm, past its soft limit of 300.000 mm"),
    ],
)
def test_cycles_that_are_refused(block: str, text: str) -> None:
    assert refusal(f"{START}{block}\n") == text


def test_the_plane_stays_while_a_cycle_is_active() -> None:
    assert (
        refusal(START + "G81 X5 Y7 Z-3 R2\nG18\n")
        == "3:1: the plane changes while a drilling cycle is active"
    )
    assert drill("G81 X5 Y7 Z-3 R2\nG80 G18\n") == HOLE


def test_a_machine_without_the_axes() -> None:
    config = machine_config(AXIS.format(name="X", low=-9, high=9), AXIS.format(name="Z", low=-9, high=9))
    assert refusal("F1 G81 X1 Z-1 R1\n", config=config) == (
        "1:4: G81 needs the axes X, Y, Z here, and the machine lacks one of them"
    )


@pytest.mark.parametrize("plane", ["G20 X0 Y0", "G20 Y0 X0"])
def test_a_cycle_drills_along_the_third_axis_whatever_comes_first_in_the_plane(plane: str) -> None:
    program = f"F500 {plane}\nS500 M3\nG81 X5 Y7 Z-3 R2\nG80\n"
    assert moves(program, dialect="bosch")[1:] == [
        *("rapid Z2 stop", "rapid X5 Y7 stop", "line Z-3 F500 stop", "rapid Z2 stop"),
    ]
