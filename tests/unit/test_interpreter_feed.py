"""Feed per minute, per revolution and by time; the spindle after it; dwells."""

from __future__ import annotations

import math

import pytest

from support.programs import FIVE, MILL, accepted, moves, refusal


def test_feed_is_modal() -> None:
    assert moves("G1 F100 X1\nX2\nX3 F50\n") == ["line X1 F100", "line X2 F100", "line X3 F50"]


@pytest.mark.parametrize(
    ("program", "text"),
    [
        ("G1 X1", "1:1: a feed move without a feed"),
        ("N5 G0 X1\nX2\nN7 G1 X3", "3:4: a feed move without a feed"),
        ("X1", "1:1: a feed move without a feed"),
        ("G2 X2 I1", "1:1: a feed move without a feed"),
        ("G81 X1 Z-1 R1", "1:1: a feed move without a feed"),
        ("F100 X1\nG95 X2 M3 S1", "2:5: a feed move without a feed"),
        ("M3 S100\nG95 F0.1 X1\nG94 X2", "3:5: a feed move without a feed"),
        ("G93 F10 X1\nX2", "2:1: a feed move with inverse time (G93) needs its own F"),
        ("G93 F10 X1\nG94 X2", "2:5: a feed move without a feed"),
        ("G95 F0.1 G1 X1", "1:10: feed per revolution (G95) with the spindle at rest"),
        ("M3 S100 G95 F.1 X1\nM5 X2", "2:4: feed per revolution (G95) with the spindle at rest"),
        ("F0 X1", "1:1: the feed 0 is not above zero"),
        ("X1 F-1.5", "1:4: the feed -1.5 is not above zero"),
    ],
)
def test_refused_feeds(program: str, text: str) -> None:
    assert refusal(program + "\n") == text


def test_feed_per_revolution_follows_the_spindle() -> None:
    assert moves("M3 S1200\nG95 G1 F0.2 X1\nS600 X2\nM4 X3\n") == [
        "M3 S1200",
        "line X1 F240 stop",
        "S600",
        "line X2 F120 stop",
        "M4",
        "line X3 F120",
    ]


def test_feed_per_revolution_in_inch() -> None:
    assert moves("G20 M3 S100\nG95 G1 F0.01 X1\n")[-1] == "line X25.4 F25.4"


def test_the_spindle_does_not_turn_faster_than_it_can() -> None:
    channel = accepted("M3 S12000\nG95 F0.1 G1 X1\n", config=MILL)  # up to 10000 rpm
    assert [message.text for message in channel.messages.all()] == [
        "S is above the spindle's 10000 rpm: it turns at that speed"
    ]
    assert moves("M3 S12000\nG95 F0.1 G1 X1\n", config=MILL)[-1] == "line X1 F1000"


def test_constant_surface_speed_turns_by_the_mean_radius() -> None:
    # 100 m/min on a diameter of 2 * 15 mm in the mean.
    rpm = 100_000.0 / (math.pi * 30.0)
    steps = moves("G0 X10\nG96 S100 M3\nG95 F0.1 G1 X20\n")
    assert steps[-1] == f"line X20 F{rpm * 0.1:.4f}"
    # Program zero is the axis of the workpiece.
    shifted = moves("G0 X110\nG92 X10\nG96 S100 M3\nG95 F0.1 G1 X20\n")
    assert shifted[-1] == f"line X120 F{rpm * 0.1:.4f}"


def test_constant_surface_speed_in_inch_is_in_feet() -> None:
    metric = moves("G0 X25.4\nG96 S30.48 M3\nG95 F2.54 G1 Z1\n")[-1]
    inch = moves("G20 G0 X1\nG96 S100 M3\nG95 F0.1 G1 Z0.03937007874015748\n")[-1]
    assert inch == metric


def test_constant_surface_speed_is_limited_by_the_spindle() -> None:
    assert moves("G96 S100 M3\nG95 F0.1 G1 Z1\n")[-1] == "line Z1 F1000"  # X is 0


def test_back_to_revolutions_the_spindle_keeps_its_speed() -> None:
    rpm = 100_000.0 / (math.pi * 100.0)
    steps = moves("G0 X50\nG96 S100 M3\nG97\nG95 F1 G1 Z1\n")
    assert steps[-1] == f"line Z1 F{rpm:.4f}"
    assert moves("G0 X50\nG96 S100 M3\nG97 S200\nG95 F1 G1 Z1\n")[-1] == "line Z1 F200"


def test_constant_surface_speed_needs_its_number() -> None:
    assert refusal("S1000 M3\nG96\n") == "2:1: G96 without a cutting speed"
    assert refusal("S-5\n") == "1:1: the spindle speed -5 is negative"


def test_inverse_time_gives_the_whole_block_its_time() -> None:
    # F2 is half a minute: 10 mm in 30 s are 20 mm/min.
    assert moves("G93 G1 X10 F2\nX10 Y5 F10\n") == ["line X10 F20", "line Y5 F50"]
    assert moves("G93 G1 X3 Y4 A90 F1\n", config=FIVE) == ["line X3 Y4 A90 F5"]
    assert moves("G93 G1 A90 F1\n", config=FIVE) == ["line A90 F90"]
    half_circle = moves("G93 G2 X20 I10 F1\n")[0]
    assert half_circle == f"arc X20 Y0 about X10 Y0 by -180 F{math.pi * 10.0:.4f}"
    helix = moves("G93 G2 X20 I10 Z5 F1\n")[0]
    assert helix.endswith(f" F{math.hypot(math.pi * 10.0, 5.0):.4f}")


def test_inverse_time_is_a_number_of_its_own_in_inch() -> None:
    assert moves("G20 G93 G1 X1 F2\n") == ["line X25.4 F50.8"]


def test_rapids_need_no_feed_in_any_mode() -> None:
    assert moves("G93 G0 X1\nG95 X2\n") == ["rapid X1 stop", "rapid X2 stop"]


# --- dwells


@pytest.mark.parametrize(
    ("dialect", "block", "seconds"),
    [
        ("din", "G4 P1.5", "1.5"),
        ("din", "G4 X2", "2"),
        ("din", "G4 F3", "3"),
        ("fanuc", "G4 P1500", "1.5"),
        ("fanuc", "G4 X2.5", "2.5"),
        ("fanuc", "G4 U2.", "2"),
        ("bosch", "G4 F2", "2"),
        ("bosch", "G4 P0", "0"),
    ],
)
def test_dwell(dialect: str, block: str, seconds: str) -> None:
    assert moves(f"{block}\n", dialect=dialect) == [f"wait {seconds}"]


def test_the_time_of_a_dwell_is_neither_a_feed_nor_a_position() -> None:
    assert moves("G1 F100 X1\nG4 F5\nX2\nG4 X7\nX3\nG4 P1 F200\nX4\n") == [
        "line X1 F100 stop",
        "wait 5",
        "line X2 F100 stop",
        "wait 7",
        "line X3 F100 stop",
        "wait 1",
        "line X4 F200",
    ]


@pytest.mark.parametrize(
    ("program", "text"),
    [
        ("G4", "1:1: a dwell (G4) without a time"),
        ("G4 P-1", "1:4: the dwell P-1 is negative"),
        ("G4 P99999999", "1:4: the dwell P99999999 is longer than 116 days"),
        ("F100 G4 P1 X5", "1:12: a dwell (G4) and a move in one block"),
    ],
)
def test_dwells_that_are_none(program: str, text: str) -> None:
    assert refusal(f"{program}\n") == text
