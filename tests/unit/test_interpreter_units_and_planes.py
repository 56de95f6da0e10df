"""Inch and metric words, decimal points, and what the dialects call them."""

from __future__ import annotations

import math

import pytest

from polycnc.nc import Dialect, load_dialect
from support.programs import FIVE, MILL, accepted, moves, refusal

INCH = {"din": "G20", "fanuc": "G20", "bosch": "G70"}
METRIC = {"din": "G21", "fanuc": "G21", "bosch": "G71"}


@pytest.mark.parametrize("dialect", ["din", "fanuc", "bosch"])
def test_inch_words_and_feeds(dialect: str) -> None:
    program = f"{INCH[dialect]} F10 G1 X1\nG91 Y.5\n{METRIC[dialect]} X1 F50\nG2 I1\n"
    assert moves(program, dialect=dialect) == [
        "line X25.4 F254",
        "line Y12.7 F254",
        "line X26.4 F50",
        "arc X26.4 Y12.7 about X27.4 Y12.7 by -360 F50",
    ]


def test_din_knows_both_pairs() -> None:
    assert moves("G70 G0 X1\nG71 X1\nG20 X1\n") == ["rapid X25.4 stop", "rapid X1 stop", "rapid X25.4 stop"]


@pytest.mark.parametrize("code", ["G70", "G71"])
def test_fanuc_does_not_know_the_codes_of_din(code: str) -> None:
    assert refusal(f"{code}\n", dialect="fanuc") == f"1:1: {code} is not known in dialect 'fanuc'"


def test_a_unit_holds_for_all_words_of_its_block_wherever_it_stands() -> None:
    assert moves("F10 X1 G20\n") == ["line X25.4 F254"]


def test_the_feed_stays_what_it_was_when_the_unit_changes() -> None:
    assert moves("F100 X1\nG20 X2\n") == ["line X1 F100", "line X50.8 F100"]


def test_arcs_in_inch() -> None:
    assert moves("G20 F10\nG2 X2 R1\nG3 I-1\nG90.1 G2 X4 I3 J0\n") == [
        "arc X50.8 Y0 about X25.4 Y0 by -180 F254",
        "arc X50.8 Y0 about X25.4 Y0 by 360 F254",
        "arc X101.6 Y0 about X76.2 Y0 by -180 F254",
    ]


def test_rotary_axes_are_in_degrees_whatever_the_unit_is() -> None:
    assert moves("G20 G0 A90\nG1 F100 A80\nX1 A70\nX0 A70\n", config=FIVE) == [
        "rapid A90 stop",
        "line A80 F100",  # degrees per minute, for only a rotary axis moves
        "line X25.4 A70 F2540",
        "line X0 F2540",
    ]
    assert moves("G20 M3 S100\nG95 F2 G1 A90\n", config=FIVE)[-1] == "line A90 F200"


# --- increments


@pytest.fixture
def increments() -> Dialect:
    """Return FANUC as set up for numbers that count increments where they have no decimal point."""
    fanuc = load_dialect("fanuc")
    numbers = fanuc.numbers.model_copy(update={"decimal_point": "least_input"})
    return fanuc.model_copy(update={"numbers": numbers})


def test_lengths_without_a_point_are_increments(increments: Dialect) -> None:
    program = "F100 G1 X10000\nX10.\nG2 X12000 I1000 J0\nG3 X14. R1000\nG0 C90000\n"
    assert moves(program, config=FIVE, dialect=increments) == [
        "line X10 F100",
        "arc X12 Y0 about X11 Y0 by -180 F100",
        "arc X14 Y0 about X13 Y0 by 180 F100 stop",
        "rapid C90 stop",
    ]
    assert moves("G91 G0 Y-500\n", dialect=increments) == ["rapid Y-0.5 stop"]


def test_in_inch_an_increment_is_a_tenth_of_the_number(increments: Dialect) -> None:
    assert moves("G20 G0 X10000\nX1.\n", dialect=increments) == ["rapid X25.4 stop"]
    assert moves("G20 F10 G1 X10000 A1000\n", config=FIVE, dialect=increments) == ["line X25.4 A0.1 F254"]


def test_what_is_no_length_counts_as_it_stands(increments: Dialect) -> None:
    program = "S1000 M3 T1\nG4 P500\nG4 X1500\nG4 X2.5\nG1 F200 X1.\nG98 G83 R2. Z-3000 Q1500 K2 F100\n"
    channel = accepted(program + "X2.\n", dialect=increments)
    listed = moves(program + "X2.\n", dialect=increments)
    assert listed[:5] == ["M3 S1000", "wait 0.5", "wait 1.5", "wait 2.5", "line X1 F200 stop"]
    # Two holes at X 1 (K2), one at X 2; each peck is 1.5 mm from R.
    depths = [item for item in listed if item.startswith("line Z")]
    assert (
        depths
        == ["line Z0.5 F100 stop", "line Z-1 F100 stop", "line Z-2.5 F100 stop", "line Z-3 F100 stop"] * 3
    )
    assert channel.state.tool == 0


def test_the_fast_path_hands_increments_over(increments: Dialect) -> None:
    program = "G1 F100 X1000\nX2.\nY500 X3.\nG2 X4. I500\n"
    fast, ordinary = (
        moves(program, dialect=increments, config=MILL, ordinary_blocks=blocks) for blocks in (0, math.inf)
    )
    assert (
        fast
        == ordinary
        == ["line X1 F100", "line X2 F100", "line X3 Y0.5 F100", "arc X4 Y0.5 about X3.5 Y0.5 by -180 F100"]
    )
