"""Switches, index pulses and software limits along an axis."""

from __future__ import annotations

import math

import pytest

from polycnc.kernel._switches import (
    LIMIT_HIGH,
    LIMIT_LOW,
    REFERENCE,
    SOFT_HIGH,
    SOFT_INSIDE,
    SOFT_LOW,
    Switches,
    index_crossings,
    make_switches,
    soft_limit,
    switches_cycle,
)


def axis() -> Switches:
    """Return two axes; the second has limits at -100 and 200 and a reference cam from 10 to 12."""
    switches = make_switches(2)
    switches.switch["on_from"][1] = (-math.inf, 200.0, 10.0)
    switches.switch["on_to"][1] = (-100.0, math.inf, 12.0)
    return switches


def pass_over(switches: Switches, last: float, now: float, j: int) -> tuple[int, int, int]:
    switches_cycle(1, switches, now, last)
    return int(switches.switch["level"][1, j]), int(switches.rising[1, j]), int(switches.falling[1, j])


@pytest.mark.parametrize(
    ("last", "now", "expected"),
    [
        (0.0, 9.9, (0, 0, 0)),
        (9.0, 10.0, (1, 1, 0)),
        (9.0, 11.0, (1, 1, 0)),
        (10.0, 11.0, (1, 0, 0)),
        (11.0, 11.0, (1, 0, 0)),
        (11.0, 12.0, (1, 0, 0)),
        (12.0, 12.5, (0, 0, 1)),
        (9.0, 13.0, (0, 1, 1)),
        (13.0, 12.0, (1, 1, 0)),
        (12.0, 10.0, (1, 0, 0)),
        (10.0, 9.0, (0, 0, 1)),
        (13.0, 9.0, (0, 1, 1)),
    ],
)
def test_reference_switch_level_and_edges(last: float, now: float, expected: tuple[int, int, int]) -> None:
    assert pass_over(axis(), last, now, REFERENCE) == expected


def test_edges_lie_where_the_switch_begins_and_ends() -> None:
    switches = axis()
    pass_over(switches, 9.0, 13.0, REFERENCE)
    assert (
        switches.switch["rising_position"][1, REFERENCE],
        switches.switch["falling_position"][1, REFERENCE],
    ) == (10.0, 12.0)
    pass_over(switches, 13.0, 9.0, REFERENCE)
    assert (
        switches.switch["rising_position"][1, REFERENCE],
        switches.switch["falling_position"][1, REFERENCE],
    ) == (12.0, 10.0)
    pass_over(switches, 9.0, 8.0, REFERENCE)
    assert switches.switch["rising_position"][1, REFERENCE] == 12.0, "the last edge is kept"


def test_limit_switches_are_on_to_the_end_of_the_axis() -> None:
    switches = axis()
    assert pass_over(switches, 0.0, -100.0, LIMIT_LOW) == (1, 1, 0)
    assert pass_over(switches, -100.0, -1e9, LIMIT_LOW) == (1, 0, 0)
    assert pass_over(switches, -1e9, -99.0, LIMIT_LOW) == (0, 0, 1)
    assert switches.switch["falling_position"][1, LIMIT_LOW] == -100.0
    assert pass_over(switches, 0.0, 200.5, LIMIT_HIGH) == (1, 1, 0)
    assert pass_over(switches, 200.5, 199.0, LIMIT_HIGH) == (0, 0, 1)
    assert switches.switch["level"][0].tolist() == [0, 0, 0]


def test_axis_without_switches_never_shows_any() -> None:
    switches = make_switches(1)
    for last, now in ((0.0, 1e12), (1e12, -1e12)):
        switches_cycle(0, switches, now, last)
        assert not switches.switch["level"].any()
        assert not switches.rising.any()
        assert not switches.falling.any()
        assert switches.marks["index_crossed"][0] == 0


@pytest.mark.parametrize(
    ("last", "now", "crossed", "first"),
    [
        (0.0, 0.9, 0, None),
        (0.0, 1.0, 1, 1.0),
        (1.0, 1.5, 0, None),
        (1.0, 5.5, 2, 3.0),
        (5.5, 1.0, -3, 5.0),
        (1.0, 0.5, 0, None),
        (1.5, 1.0, -1, 1.0),
        (-0.5, -5.0, -3, -1.0),
        (2.0, 2.0, 0, None),
    ],
)
def test_index_pulses_count_once_when_reached(
    last: float, now: float, crossed: int, first: float | None
) -> None:
    """Pulses at odd numbers."""
    count, position = index_crossings(1.0, 2.0, now, last)
    assert count == crossed
    if first is not None:
        assert position == first


@pytest.mark.parametrize(
    ("last", "now", "crossed"), [(0.0, 4.0, 0), (0.0, 5.0, 1), (5.0, 9.0, 0), (9.0, 5.0, -1), (5.0, 0.0, 0)]
)
def test_single_index_pulse(last: float, now: float, crossed: int) -> None:
    assert index_crossings(5.0, 0.0, now, last) == (crossed, 5.0)


def test_armed_latch_catches_the_first_pulse_with_its_direction_and_disarms() -> None:
    switches = axis()
    switches.marks["index_origin"][1] = 0.25
    switches.marks["index_pitch"][1] = 1.0
    switches_cycle(1, switches, 2.0, 1.0)
    assert (
        switches.marks["index_crossed"][1],
        switches.marks["index_position"][1],
        switches.marks["index_latched"][1],
    ) == (1, 1.25, 0)
    switches.marks["index_armed"][1] = 1
    switches_cycle(1, switches, 2.1, 2.0)
    assert (switches.marks["index_armed"][1], switches.marks["index_latched"][1]) == (1, 0)
    switches_cycle(1, switches, -0.5, 2.1)
    assert switches.marks["index_crossed"][1] == -2
    assert (switches.marks["index_armed"][1], switches.marks["index_latched"][1]) == (0, 1)
    assert (switches.marks["index_latch"][1], switches.marks["index_latch_direction"][1]) == (1.25, -1)
    switches_cycle(1, switches, 1.0, -0.5)
    assert switches.marks["index_position"][1] == 0.25
    assert switches.marks["index_latch"][1] == 1.25, "not armed, not overwritten"


def test_soft_limits_count_when_enabled_and_exceeded() -> None:
    switches = axis()
    switches.marks["soft_low"][1] = -5.0
    switches.marks["soft_high"][1] = 8.0
    assert soft_limit(1, switches, 99.0) == SOFT_INSIDE, "not enabled"
    switches.marks["soft_enabled"][1] = 1
    codes = [soft_limit(1, switches, x) for x in (-5.1, -5.0, 0.0, 8.0, 8.1)]
    assert codes == [SOFT_LOW, SOFT_INSIDE, SOFT_INSIDE, SOFT_INSIDE, SOFT_HIGH]
