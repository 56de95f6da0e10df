"""Ramps with limited jerk against small steps of the same motion."""

from __future__ import annotations

import itertools

import pytest
import scipy

from polycnc.kernel._jerk import brake_phases, brake_way, fastest_start, moved, wanted_rate

STATES = list(
    itertools.product((7.3, 41.0, 190.0), (-310.0, -47.0, 0.0, 83.0, 290.0), (0.0, 6.1), (310.0, 470.0))
)
JERK = 7300.0


def test_a_phase_is_its_power_series() -> None:
    way, speed, rate = moved(3.7, -41.0, 530.0, 0.23)
    assert way == pytest.approx(3.7 * 0.23 - 41.0 * 0.23**2 / 2.0 + 530.0 * 0.23**3 / 6.0, rel=1e-14)
    assert speed == pytest.approx(3.7 - 41.0 * 0.23 + 530.0 * 0.23**2 / 2.0, rel=1e-14)
    assert rate == pytest.approx(-41.0 + 530.0 * 0.23, rel=1e-14)


@pytest.mark.parametrize(("speed", "rate", "to_speed", "accel"), STATES)
def test_braking_ends_at_its_speed_without_acceleration_within_its_limits(
    speed: float, rate: float, to_speed: float, accel: float
) -> None:
    first, build, hold, release = brake_phases(speed, rate, to_speed, accel, JERK)
    assert abs(first) == JERK
    assert min(build, hold, release) >= 0.0
    gone, now, then = 0.0, speed, rate
    for jerk, time in ((first, build), (0.0, hold), (JERK, release)):
        way, now, then = moved(now, then, jerk, time)
        gone += way
        assert then >= min(rate, -accel) * (1.0 + 1e-12)
    assert then == pytest.approx(0.0, abs=1e-9)
    assert gone == pytest.approx(brake_way(speed, rate, to_speed, accel, JERK), abs=1e-12)
    eased = speed + 0.5 * rate * abs(rate) / JERK
    if eased > to_speed:
        assert now == pytest.approx(to_speed, abs=1e-9)
    else:
        assert (hold, release) == (0.0, 0.0)
        assert now == pytest.approx(eased, abs=1e-9)


@pytest.mark.parametrize("way", [0.003, 0.4, 9.1])
@pytest.mark.parametrize("speed", [0.0, 0.013, 5.7, 43.0])
@pytest.mark.parametrize("accel", [70.0, 530.0])
def test_the_fastest_start_brakes_in_just_its_way(speed: float, way: float, accel: float) -> None:
    found = fastest_start(speed, way, accel, JERK)
    assert brake_way(found, 0.0, speed, accel, JERK) == pytest.approx(way, rel=1e-9)
    by_search = scipy.optimize.brentq(
        lambda begin: brake_way(begin, 0.0, speed, accel, JERK) - way, speed, speed + 400.0, xtol=1e-10
    )
    assert found == pytest.approx(by_search, abs=1e-7)
    assert fastest_start(speed, 0.0, accel, JERK) == speed


@pytest.mark.parametrize(("speed", "rate", "to_speed", "accel"), STATES)
def test_the_wanted_acceleration_can_just_be_taken_back(
    speed: float, rate: float, to_speed: float, accel: float
) -> None:
    dt = 0.007
    wanted = wanted_rate(speed, rate, to_speed, JERK, dt)
    assert abs(wanted - rate) <= JERK * dt * (1.0 + 1e-12)
    jerk = JERK if wanted > rate else -JERK
    build = (wanted - rate) / jerk
    _, after, _ = moved(speed, rate, jerk, build)
    after += wanted * (dt - build)
    eased = after + 0.5 * wanted * abs(wanted) / JERK
    side = 1.0 if speed + 0.5 * rate * abs(rate) / JERK <= to_speed else -1.0
    # On the way up it stays below, on the way down above; the farthest of what a cycle allows.
    assert side * (eased - to_speed) <= 1e-9
    farthest = abs(wanted - (rate + side * JERK * dt)) < 1e-9
    no_choice = abs(wanted - (rate - side * JERK * dt)) < 1e-9
    assert farthest or no_choice or eased == pytest.approx(to_speed, abs=1e-9)
