"""Setpoint sources that couple axes or are given cycle by cycle: gears, curves, tables."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from scipy.interpolate import CubicHermiteSpline

from polycnc.errors import UsageError
from polycnc.kernel._curve import (
    AFTER,
    BEFORE,
    INSIDE,
    REPEAT,
    Curve,
    curve_cycle,
    curve_value,
    make_curve,
    set_curve,
)
from polycnc.kernel._follower import (
    ACTUAL,
    FixedFollower,
    Follower,
    fixed_follower_cycle,
    follower_cycle,
    make_fixed_follower,
    make_follower,
)
from polycnc.kernel._table import make_table, table_clear, table_cycle, table_push

ZERO = np.zeros(2)


def gear(ratio: float, **settings: int) -> Follower:
    follower = make_follower(1)
    follower.row["master"][0] = 1
    follower.row["ratio"][0] = ratio
    follower.row["engaged"][0] = 1
    for name, value in settings.items():
        follower.row[name] = value
    return follower


def turn(follower: Follower, *masters: float) -> list[float]:
    return [follower_cycle(0, follower, np.array([99.0, m]), np.array([99.0, -m])) for m in masters]


def test_gear_adds_ratio_times_what_the_master_moves_after_engagement() -> None:
    assert turn(gear(-2.5), 10.0, 12.0, 11.0, 10.0) == [0.0, -5.0, -2.5, 0.0]


def test_gear_on_the_actual_position_reads_the_other_array() -> None:
    assert turn(gear(2.0, source=ACTUAL), 10.0, 12.0) == [0.0, -4.0]


def test_released_gear_keeps_its_contribution_and_ignores_what_passes_meanwhile() -> None:
    follower = gear(2.0)
    assert turn(follower, 0.0, 3.0) == [0.0, 6.0]
    follower.row["engaged"][0] = 0
    assert turn(follower, 50.0, 100.0) == [6.0, 6.0]
    follower.row["engaged"][0] = 1
    assert turn(follower, 200.0, 201.0) == [6.0, 8.0]


def test_new_ratio_acts_from_the_next_movement_on() -> None:
    follower = gear(1.0)
    assert turn(follower, 0.0, 100.0) == [0.0, 100.0]
    follower.row["ratio"][0] = 3.0
    assert turn(follower, 100.0, 101.0, 102.0) == [100.0, 103.0, 106.0]
    follower.row["ratio"][0] = 0.0
    assert turn(follower, 500.0) == [106.0]


def test_gear_does_not_drift_in_many_small_steps() -> None:
    follower = gear(1.0 / 3.0)
    masters = np.cumsum(np.full(20_000, 0.1))
    last = turn(follower, 0.0, *masters)[-1]
    assert last == (1.0 / 3.0) * masters[-1]


def fixed_gear(ratio: int, at: int) -> FixedFollower:
    follower = make_fixed_follower(1)
    follower.row["master"][0] = 1
    follower.row["ratio"][0] = ratio
    follower.row["engaged"][0] = 1
    turn_fixed(follower, at)
    return follower


def turn_fixed(follower: FixedFollower, *masters: int) -> list[int]:
    return [fixed_follower_cycle(0, follower, np.array([7, m]), np.array([7, -m])) for m in masters]


@pytest.mark.parametrize(
    "ratio", [-(1 << 47), -(1 << 32) // 3, -1, 0, 1, (1 << 32) // 3, 1 << 32, (1 << 47) - 1]
)
def test_fixed_gear_equals_exact_integers(ratio: int) -> None:
    rng = np.random.default_rng(11)
    moves = np.concatenate([rng.integers(-50, 50, 200), [0, 2**31 - 1, 1 - 2**31, 1, -1]])
    start = 5_000
    follower = fixed_gear(ratio, start)
    at = start
    for move in moves.tolist():
        at += move
        assert turn_fixed(follower, at) == [((at - start) * ratio) >> 32]
        assert follower.row["fraction"][0] == ((at - start) * ratio) & 0xFFFFFFFF


def test_fixed_gear_has_no_drift_after_a_million_turns() -> None:
    """1,000,000 turns of 10,000 counts at 1/3, in steps of 99,991 counts (a prime), and back again."""
    ratio, target, step = (1 << 32) // 3, 10_000_000_000, 99_991
    follower = fixed_gear(ratio, 0)
    setpoint = np.zeros(2, np.int64)
    whole = 0
    while setpoint[1] < target:
        setpoint[1] = min(int(setpoint[1]) + step, target)
        whole = fixed_follower_cycle(0, follower, setpoint, setpoint)
    assert whole == (target * ratio) >> 32
    assert turn_fixed(follower, target - 2**30, 0)[-1] != 0, (
        "a way back beyond 2**31 counts in one cycle is too long"
    )


def test_fixed_gear_releases_and_engages_anew() -> None:
    follower = fixed_gear(3 << 31, 0)
    assert turn_fixed(follower, 1, 2, 3) == [1, 3, 4]
    follower.row["engaged"][0] = 0
    assert turn_fixed(follower, 900) == [4]
    follower.row["engaged"][0] = 1
    assert turn_fixed(follower, 1000, 1001) == [4, 6]
    follower.row["source"][0] = ACTUAL
    assert turn_fixed(follower, -1001) == [6]


MASTER = np.array([10.0, 12.0, 17.0, 20.0])
SLAVE = np.array([1.0, -3.0, 4.0, 6.0])
SLOPES = np.array([0.5, 0.0, -2.0, 1.0])


def cam(slopes: npt.NDArray[np.float64] | None = None, outside: int = 0, start: int = 2) -> Curve:
    curve = make_curve(2, 8)
    curve.row["engaged"][1] = 1
    set_curve(curve, 1, start, MASTER, SLAVE, slopes, outside)
    return curve


def test_linear_curve_equals_interpolation_and_stands_still_outside() -> None:
    curve = cam()
    for x in np.linspace(5.0, 25.0, 401):
        assert curve_value(1, curve, x) == pytest.approx(np.interp(x, MASTER, SLAVE), abs=1e-13)


def test_cubic_curve_equals_the_hermite_spline() -> None:
    curve = cam(SLOPES)
    spline = CubicHermiteSpline(MASTER, SLAVE, SLOPES)
    for x in np.linspace(10.0, 20.0, 401):
        assert curve_value(1, curve, x) == pytest.approx(float(spline(x)), abs=1e-12)


@pytest.mark.parametrize("slopes", [None, SLOPES])
def test_curve_meets_its_points_exactly(slopes: npt.NDArray[np.float64] | None) -> None:
    curve = cam(slopes)
    assert [curve_value(1, curve, x) for x in MASTER.tolist()] == SLAVE.tolist()


def test_repeated_curve_goes_on_where_it_ended() -> None:
    curve = cam(outside=REPEAT)
    for x in np.linspace(10.0, 19.99, 50):
        for turns in (-3, -1, 1, 1000):
            shifted = curve_value(1, curve, x + turns * 10.0)
            assert shifted == pytest.approx(np.interp(x, MASTER, SLAVE) + turns * 5.0, abs=1e-10)


def run_curve(curve: Curve, *masters: float) -> list[float]:
    return [curve_cycle(1, curve, np.array([m, 0.0]), ZERO) for m in masters]


def test_absolute_curve_takes_positions_as_they_are_and_keeps_the_last_one() -> None:
    curve = cam()
    assert run_curve(curve, 0.0, 11.0, 30.0) == [1.0, -1.0, 6.0]
    curve.row["engaged"][1] = 0
    assert run_curve(curve, 11.0) == [6.0]


def test_curve_tells_on_which_side_of_the_table_the_master_is() -> None:
    curve = cam()
    seen = []
    for x in (9.9, 10.0, 20.0, 20.1):
        run_curve(curve, x)
        seen.append(int(curve.row["side"][1]))
    assert seen == [BEFORE, INSIDE, INSIDE, AFTER]
    repeated = cam(outside=REPEAT)
    run_curve(repeated, 500.0)
    assert repeated.row["side"][1] == INSIDE


def test_relative_curve_starts_from_here_each_time_it_is_engaged() -> None:
    curve = cam()
    curve.row["relative"][1] = 1
    assert run_curve(curve, 700.0, 702.0, 710.0) == [0.0, -4.0, 5.0]
    curve.row["engaged"][1] = 0
    assert run_curve(curve, 800.0) == [5.0]
    curve.row["engaged"][1] = 1
    assert run_curve(curve, 900.0, 902.0) == [5.0, 1.0]


def test_gear_engaged_over_a_distance_is_a_cubic_with_the_ratio_as_end_slope() -> None:
    """Over 10 units of the master a slave at rest comes to ratio 2: half of 10 x 2 is covered."""
    curve = make_curve(2, 2)
    set_curve(curve, 1, 0, np.array([0.0, 10.0]), np.array([0.0, 10.0]), np.array([0.0, 2.0]))
    assert [curve_value(1, curve, x) for x in (2.0, 5.0, 10.0)] == pytest.approx([0.4, 2.5, 10.0], abs=1e-14)


@pytest.mark.parametrize(
    ("master", "slave", "start", "message"),
    [
        ([0.0], [0.0], 0, "1 master positions"),
        ([0.0, 1.0], [0.0], 0, "1 slave positions"),
        ([0.0, 0.0], [0.0, 1.0], 0, "do not rise"),
        ([0.0, 1.0], [0.0, 1.0], 7, "do not fit"),
    ],
)
def test_impossible_curve_is_refused(
    master: list[float], slave: list[float], start: int, message: str
) -> None:
    curve = make_curve(1, 8)
    with pytest.raises(UsageError, match=message):
        set_curve(curve, 0, start, np.array(master), np.array(slave))
    assert curve.length[0] == 0


def test_absolute_rows_come_out_one_per_cycle_on_all_axes() -> None:
    table = make_table(2, 2, 8)
    assert table_push(1, table, np.array([[1.0, 10.0], [2.0, 20.0]])) == 2
    assert table_cycle(1, table) == 0, "not running"
    table.running[1] = 1
    seen = [
        (table_cycle(1, table), *table.value[1].tolist(), int(table.row["underflow"][1])) for _ in range(3)
    ]
    assert seen == [(1, 1.0, 10.0, 0), (1, 2.0, 20.0, 0), (0, 2.0, 20.0, 1)]
    assert table.row["taken"][1] == 2
    assert table.value[0].tolist() == [0.0, 0.0]


def test_relative_rows_add_up() -> None:
    table = make_table(1, 1, 4)
    table.row["relative"][0] = 1
    table.running[0] = 1
    table_push(0, table, np.array([[0.5], [0.25], [-1.0]]))
    seen = []
    while table_cycle(0, table):
        seen.append(float(table.value[0, 0]))
    assert seen == [0.5, 0.75, -0.25]


def test_ring_takes_what_fits_and_runs_round() -> None:
    table = make_table(1, 1, 3)
    table.running[0] = 1
    numbers = np.arange(1.0, 21.0).reshape(-1, 1)
    sent, seen = 0, []
    while sent < 20:
        sent += table_push(0, table, numbers[sent : sent + 5])
        assert table.row["fill"][0] <= 3
        table_cycle(0, table)
        seen.append(float(table.value[0, 0]))
    while table_cycle(0, table):
        seen.append(float(table.value[0, 0]))
    assert seen == list(range(1, 21))


def test_cleared_ring_is_empty_and_the_contribution_stays() -> None:
    table = make_table(1, 1, 3)
    table.running[0] = 1
    table_push(0, table, np.array([[4.0], [5.0]]))
    table_cycle(0, table)
    table_clear(0, table)
    assert table.row["fill"][0] == 0
    assert table_cycle(0, table) == 0
    assert table.value[0, 0] == 4.0
    assert table_push(0, table, np.array([[6.0], [7.0], [8.0], [9.0]])) == 3
