"""The speed over one segment: any entry, cap, end and acceleration, integrated and looked at point by point."""

from __future__ import annotations

import math

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import assume, example, given, settings

from polycnc.kernel._path import (
    REGISTERS,
    SPEED_IN,
    SPEED_OUT,
    SPEED_PEAK,
    TIME_CRUISE,
    TIME_IN,
    TIME_OUT,
    ramps_duration,
)
from polycnc.kernel._ramps import (
    halting_distance,
    plan_pause,
    plan_ramps,
    ramps_at,
    set_one_piece,
    set_pieces,
)
from support.often import share

speeds = st.one_of(st.just(0.0), st.floats(1e-3, 1e3))
positive = st.floats(1e-3, 1e3)


@settings(max_examples=share(300))
@given(
    speed_in=speeds,
    length=positive,
    cap=positive,
    accel=positive,
    out=speeds,
    jerkrel=st.sampled_from((0.0, 0.3, 1.0)),
)
@example(
    speed_in=10.0, length=50.0, cap=10.0, accel=1.0, out=0.0, jerkrel=0.0
)  # brakes to rest at the very end
@example(speed_in=10.0, length=1.0, cap=2.0, accel=1.0, out=0.0, jerkrel=0.0)  # cannot brake in time
def test_a_segment_is_gone_along_once_and_within_its_limits(
    speed_in: float, length: float, cap: float, accel: float, out: float, jerkrel: float
) -> None:
    ramps = np.zeros(REGISTERS)
    set_one_piece(ramps, length, accel)
    plan_ramps(ramps, speed_in, length, cap, accel, out, 2.0)
    duration = ramps_duration(ramps)
    assert duration > 0.0
    assert ramps_at(ramps, 0.0, jerkrel) == pytest.approx((2.0, speed_in), rel=1e-9, abs=1e-9)
    assert ramps_at(ramps, duration, jerkrel) == (2.0 + length, ramps[SPEED_OUT])
    # Never faster than the cap, unless it came in faster or is asked to leave faster.
    assert ramps[SPEED_PEAK] <= max(cap, speed_in, out) * (1.0 + 1e-12)
    for change, time in (
        (ramps[SPEED_PEAK] - speed_in, ramps[TIME_IN]),
        (ramps[SPEED_OUT] - ramps[SPEED_PEAK], ramps[TIME_OUT]),
    ):
        assert abs(change) <= accel * time * (1.0 + 1e-6) + 1e-12
    times = np.linspace(0.0, duration, 701)
    places, planned = np.array([ramps_at(ramps, t, jerkrel) for t in times]).T
    assert np.all(np.diff(places) >= -1e-12 * length)
    assert np.all(planned >= -1e-12)
    # The place is the integral of the speed.
    travelled = np.concatenate([[0.0], np.cumsum(0.5 * (planned[1:] + planned[:-1]) * np.diff(times))])
    fastest = max(float(planned.max()), 1e-12)
    assert np.allclose(places - 2.0, travelled, rtol=0.0, atol=fastest * duration / 500.0)
    step = accel * (1.0 + jerkrel) * (times[1] - times[0])
    assert np.all(np.abs(np.diff(planned)) <= step * (1.0 + 1e-6) + 1e-9 * fastest)


@settings(max_examples=share(300))
@given(
    speed_in=speeds,
    length=positive,
    cap=positive,
    accel=positive,
    out=speeds,
    zone=st.floats(0.0, 1.5),
    share=st.sampled_from((0.0, 0.2, 0.75)),
    last=st.sampled_from((0.0, 0.3, 0.75)),
    jerkrel=st.sampled_from((0.0, 0.5)),
)
def test_beside_a_corner_the_acceleration_given_up_is_not_used(
    speed_in: float,
    length: float,
    cap: float,
    accel: float,
    out: float,
    zone: float,
    share: float,
    last: float,
    jerkrel: float,
) -> None:
    dt = 0.05
    ramps = np.zeros(REGISTERS)
    slowest = math.sqrt(max(0.0, speed_in * speed_in - 0.5 * accel * length))  # reached with a quarter of it
    through = min(max(out, slowest), math.sqrt(speed_in * speed_in + 2.0 * accel * length))
    assume(through > 0.0 or last == 0.0)
    set_pieces(
        ramps, speed_in, length, accel, through, zone * length, share, last / through if last else 0.0, dt
    )
    plan_ramps(ramps, speed_in, length, cap, accel, through, 0.0)
    duration = ramps_duration(ramps)
    assert ramps[SPEED_OUT] <= through * (1.0 + 1e-9)
    times = np.linspace(0.0, duration, 701)
    step = times[1] - times[0]
    places, planned = np.array([ramps_at(ramps, t, jerkrel) for t in times]).T
    assert places[-1] == length
    fastest = max(float(planned.max()), 1e-12)
    travelled = np.concatenate([[0.0], np.cumsum(0.5 * (planned[1:] + planned[:-1]) * step)])
    assert np.allclose(places, travelled, rtol=0.0, atol=fastest * duration / 500.0)
    used = np.abs(np.diff(planned)) / step
    allowed = np.full(used.shape, accel)
    allowed[places[1:] <= zone * length] *= 1.0 - share
    beside = times[:-1] >= duration - dt
    allowed[beside] = np.minimum(allowed[beside], accel * (1.0 - last))
    assert np.all(used <= allowed * (1.0 + jerkrel) * (1.0 + 1e-6) + 1e-9 * fastest / step)


def test_the_wanted_end_speed_is_met_where_it_can_be() -> None:
    ramps = np.zeros(REGISTERS)
    set_one_piece(ramps, 100.0, 10.0)
    plan_ramps(ramps, 0.0, 100.0, 20.0, 10.0, 5.0, 0.0)
    # 20 mm up to 20 mm/s, 18.75 mm down to 5 mm/s, 61.25 mm between.
    assert ramps[[SPEED_IN, SPEED_PEAK, SPEED_OUT]].tolist() == [0.0, 20.0, 5.0]
    assert ramps[[TIME_IN, TIME_CRUISE, TIME_OUT]].tolist() == [2.0, 61.25 / 20.0, 1.5]
    set_one_piece(ramps, 0.2, 10.0)
    plan_ramps(ramps, 0.0, 0.2, 20.0, 10.0, 5.0, 0.0)
    assert ramps[SPEED_OUT] == 2.0  # sqrt(2 * 10 * 0.2): what is reached
    set_one_piece(ramps, 0.6, 10.0)
    plan_ramps(ramps, 4.0, 0.6, 20.0, 10.0, 0.0, 0.0)
    assert ramps[SPEED_OUT] == 2.0  # sqrt(16 - 12): what is left


def test_a_halt_needs_its_way_with_what_a_corner_leaves() -> None:
    assert halting_distance(10.0, 50.0, 0.0, 0.7) == 1.0
    assert halting_distance(10.0, 50.0, 0.5, 0.0) == 1.0
    # With 30 of 50 mm/s2 for 0.7 mm: 100 - 42 are left, which 0.58 mm take off.
    assert halting_distance(10.0, 50.0, 0.7, 0.4) == pytest.approx(1.28)
    assert halting_distance(6.0, 50.0, 0.7, 0.4) == pytest.approx(0.6)


def test_a_pause_stands_still() -> None:
    ramps = np.zeros(REGISTERS)
    plan_pause(ramps, 0.25)
    assert ramps_duration(ramps) == 0.25
    assert ramps_at(ramps, 0.1, 0.0) == (0.0, 0.0)
    assert not math.isnan(float(ramps.sum()))
