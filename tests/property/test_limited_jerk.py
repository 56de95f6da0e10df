"""With limited jerk: every cycle keeps it, lines take the time of an independent planner, stopping is never quicker."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
import pytest
from ruckig import InputParameter, Ruckig, Trajectory

from polycnc.kernel import (
    EXACT_PATH,
    HELD,
    PATH_RESTED,
    RECORDER_FULL,
    KernelState,
    advance,
    append_line,
    give_to_path,
    make_state,
    replan_path,
    skip,
    start_path,
)
from support.random_paths import (
    CYCLE_S,
    RECORDED,
    PathSettings,
    is_done,
    overload,
    prepare,
    random_path,
    run_recorded,
    run_with_changes,
    seeds,
)

Floats = npt.NDArray[np.float64]

ROUNDING = 1.0 + 1e-6
JERKS = (1e4, 1e5, 1e6)


def lines(ends: list[float], feed: float, acceleration: float, jerk: float) -> KernelState:
    """Return a machine that goes along X to each of `ends`."""
    state = make_state(3, cycle_s=CYCLE_S, segments=256, record_cycles=RECORDED)
    state.limits.speed[:], state.limits.acceleration[:] = 1e4, acceleration
    state.paths.row[0]["jerk_mm_s3"] = jerk
    give_to_path(state, 0)
    for tag, end in enumerate(ends, 1):
        append_line(state.seg, state.paths, 0, state.limits, np.array([end, 0.0, 0.0]), feed, 0, tag)
    prepare(state)
    start_path(state.paths, 0)
    return state


def speeds(state: KernelState) -> Floats:
    """Return the path speed of every recorded cycle, after two at rest."""
    done = state.recorder.rows[: int(state.recorder.filled[0]), 2]
    return np.concatenate([np.zeros(2), done])


def highest_jerk(state: KernelState) -> float:
    return float(np.abs(np.diff(speeds(state), 2)).max()) / CYCLE_S**2


def least_time(way: float, speed: float, acceleration: float, jerk: float) -> float:
    """Return what ruckig needs from rest to rest."""
    planner, wish, found = Ruckig(1), InputParameter(1), Trajectory(1)
    wish.max_velocity, wish.max_acceleration, wish.max_jerk = [speed], [acceleration], [jerk]
    wish.target_position = [way]
    planner.calculate(wish, found)
    return float(found.duration)


def test_lines_take_the_least_time_within_two_cycles() -> None:
    rng = np.random.default_rng(11)
    for _ in seeds(0, 120):
        way, feed = 10.0 ** rng.uniform(-3.0, 2.3), 10.0 ** rng.uniform(0.7, 2.8)
        acceleration, jerk = 10.0 ** rng.uniform(2.0, 4.0), 10.0 ** rng.uniform(3.7, 7.0)
        least = least_time(way, feed, acceleration, jerk)
        if least > 30.0:
            continue
        state = lines([way], feed, acceleration, jerk)
        cycles = run_recorded(state)
        assert -1e-6 <= cycles - least / CYCLE_S <= 2.0, (way, feed, acceleration, jerk)
        assert state.setpoint[0] == way
        assert highest_jerk(state) <= jerk * ROUNDING
        assert float(np.abs(np.diff(speeds(state))).max()) <= acceleration * CYCLE_S * ROUNDING
        assert speeds(state).max() <= feed * ROUNDING


def test_lines_that_go_straight_on_are_one_line() -> None:
    rng = np.random.default_rng(5)
    whole = skip(lines([40.0], 150.0, 2000.0, 4e4), 0, 1)
    for count in (3, 29, 240):
        ends = np.append(np.sort(rng.uniform(0.0, 40.0, count - 1)), 40.0).tolist()
        state = lines(ends, 150.0, 2000.0, 4e4)
        cycles = run_recorded(state)
        assert whole <= cycles <= whole + 4
        assert highest_jerk(state) <= 4e4 * ROUNDING


@pytest.mark.parametrize("jerk", JERKS)
@pytest.mark.parametrize("length", [None, 0.002, 0.05, 1.0])
def test_random_paths_keep_the_jerk_and_are_never_slower_than_stopping(
    jerk: float, length: float | None
) -> None:
    settings = PathSettings(jerk=jerk)
    saved = 0
    for seed in seeds(0, 12):
        most = 120 if seed % 2 else 8
        state = random_path(seed, settings, length, most=most)
        cycles = run_recorded(state)
        assert max(overload(state)) <= ROUNDING, f"seed {seed}"
        assert highest_jerk(state) <= jerk * ROUNDING, f"seed {seed}"
        if not is_done(state):
            continue
        counted, stopping, without = (
            random_path(seed, each, length, stops=stops, most=most)
            for each, stops in ((settings, False), (settings, True), (PathSettings(), False))
        )
        tail = int(state.paths.row[0]["tail"])
        assert skip(counted, 0, tail) == cycles
        assert np.array_equal(counted.setpoint, state.setpoint)
        assert np.array_equal(counted.paths.totals, state.paths.totals)
        assert cycles >= skip(without, 0, tail), f"seed {seed}"
        stopped = skip(stopping, 0, tail)
        assert cycles <= stopped, f"seed {seed}"
        saved += stopped - cycles
    assert saved > 0


@pytest.mark.parametrize("depth", [2, 16])
def test_a_limited_look_ahead_keeps_the_jerk(depth: int) -> None:
    for seed in seeds(0, 10):
        state = random_path(seed, PathSettings(jerk=2e5, depth=depth), most=60)
        run_recorded(state)
        assert max(overload(state)) <= ROUNDING, f"seed {seed}"
        assert highest_jerk(state) <= 2e5 * ROUNDING, f"seed {seed}"


@pytest.mark.parametrize(
    ("seed", "length", "jerk"), [(1, 0.002, 2e5), (7, 0.002, 2e5), (143, None, 2e5), (109, 0.002, 1e4)]
)
def test_a_short_look_ahead_does_not_creep_to_the_end_of_a_block(
    seed: int, length: float | None, jerk: float
) -> None:
    """A corner may take the acceleration of a whole block if it is passed fast, and next to none at a crawl."""
    near, stopping = (
        random_path(seed, PathSettings(jerk=jerk, depth=2), length, stops=stops, most=120)
        for stops in (False, True)
    )
    tail = int(near.paths.row[0]["tail"])
    assert skip(near, 0, tail) < skip(stopping, 0, tail)


@pytest.mark.parametrize(("jerk", "depth"), [(1e4, 0), (1e5, 0), (1e6, 0), (1e5, 3)])
def test_override_hold_and_late_blocks_keep_the_jerk_and_the_end(jerk: float, depth: int) -> None:
    for seed in seeds(0, 24):
        rng = np.random.default_rng(seed)
        state = run_with_changes(rng, PathSettings(jerk=jerk, depth=depth), late=bool(seed % 2))
        assert max(overload(state)) <= ROUNDING, f"seed {seed}"
        assert highest_jerk(state) <= jerk * ROUNDING, f"seed {seed}"
        if is_done(state):
            assert np.array_equal(state.setpoint, state.paths.queued[0])


@pytest.mark.parametrize("tolerance", [EXACT_PATH, 0.01, math.inf])
def test_rounded_and_exact_paths_keep_their_limits_whatever_changes(tolerance: float) -> None:
    for seed in range(40):
        rng = np.random.default_rng(seed)
        jerk = 10.0 ** rng.uniform(3.5, 6.5)
        state = run_with_changes(rng, PathSettings(jerk=jerk, tolerance=tolerance), late=bool(seed % 2))
        assert max(overload(state)) <= ROUNDING, f"seed {seed}"
        assert highest_jerk(state) <= jerk * ROUNDING, f"seed {seed}"


def found_at_random(
    seed: int, tolerance: float, depths: tuple[int, ...] = (0, 0, 2, 16)
) -> tuple[KernelState, float]:
    """Return a machine that has traversed a path of the campaigns, and its jerk."""
    rng = np.random.default_rng(seed)
    jerk = 10.0 ** rng.uniform(3.5, 6.5)
    depth = int(rng.choice(depths))
    rng.choice(5)
    settings = PathSettings(jerk=jerk, depth=depth, tolerance=tolerance)
    return run_with_changes(rng, settings, late=bool(rng.random() < 0.7)), jerk


BRAKING_DONE_EARLY = [(100064, EXACT_PATH), (100204, 0.01)]
"""The ramp was done before its corner, and the path went on past it."""
CARRIED_TOO_FAR = [(19, math.inf), (664, 0.1), (1386, 0.1)]
"""What was left of an acceleration took the path past the speed of the segment after a corner."""

SEEN_TOO_LATE = [(461, 0.01), (1032, 0.0)]
"""A segment that came into view made a corner of the stop that the path was braking to."""


@pytest.mark.parametrize(("seed", "tolerance"), BRAKING_DONE_EARLY + CARRIED_TOO_FAR + SEEN_TOO_LATE)
def test_paths_that_once_broke_a_limit_keep_it(seed: int, tolerance: float) -> None:
    state, jerk = found_at_random(seed, tolerance)
    assert max(overload(state)) <= ROUNDING
    assert highest_jerk(state) <= jerk * ROUNDING


FEW_AHEAD = [(70, 0.1), (395, 0.1), (441, 0.01), (698, math.inf), (726, 0.01), (1148, 0.01)]
"""What came into view, or another override, took what the braking under way had counted on: jerks of up to 31 times."""


@pytest.mark.parametrize(("seed", "tolerance"), FEW_AHEAD)
def test_what_comes_into_view_late_breaks_no_limit(seed: int, tolerance: float) -> None:
    state, jerk = found_at_random(seed, tolerance, (2, 2, 3, 5))
    assert max(overload(state)) <= ROUNDING
    assert highest_jerk(state) <= jerk * ROUNDING
    assert is_done(state)


def test_a_hold_in_any_phase_comes_to_rest_and_goes_on_to_the_same_end() -> None:
    held_at = set()
    whole = skip(lines([30.0, 42.0], 120.0, 2500.0, 6e4), 0, 2)
    for cycle in range(1, whole, 3):
        state = lines([30.0, 42.0], 120.0, 2500.0, 6e4)
        row = state.paths.row[0]
        state.clock[0]["mask"] = RECORDER_FULL
        advance(state, cycle)
        row["hold"] = 1
        replan_path(state.seg, state.paths, 0, state.limits, CYCLE_S, state.work)
        advance(state, 300)
        assert np.ptp(state.recorder.rows[cycle + 290 : cycle + 300, 4]) == 0.0
        if row["state"] == HELD:
            held_at.add(float(state.setpoint[0]))
        row["hold"] = 0
        replan_path(state.seg, state.paths, 0, state.limits, CYCLE_S, state.work)
        state.clock[0]["mask"] = RECORDER_FULL | PATH_RESTED
        run_recorded(state)
        positions = state.recorder.rows[: int(state.recorder.filled[0]), 4]
        assert state.setpoint[0] == 42.0
        assert np.all(np.diff(positions) >= 0.0)
        assert highest_jerk(state) <= 6e4 * ROUNDING, f"cycle {cycle}"
        assert max(overload(state)) <= ROUNDING
    assert len(held_at) > 50


def test_any_jerk_takes_the_time_of_trapezoids() -> None:
    for seed in seeds(0, 10):
        with_jerk = random_path(seed, PathSettings(jerk=1e9), 1.0, most=60)
        without = random_path(seed, PathSettings(), 1.0, most=60)
        tail = int(without.paths.row[0]["tail"])
        cycles = skip(without, 0, tail)
        assert cycles <= skip(with_jerk, 0, tail) <= cycles + 2 * tail, f"seed {seed}"


def test_the_jerk_costs_what_its_ramps_cost() -> None:
    # Both ramps reach the acceleration: each takes a / j longer, and the way is that much longer as well.
    without, with_jerk = lines([100.0], 200.0, 1000.0, 0.0), lines([100.0], 200.0, 1000.0, 1e4)
    assert skip(without, 0, 1) * CYCLE_S == pytest.approx(0.7, abs=1e-3)
    assert skip(with_jerk, 0, 1) * CYCLE_S == pytest.approx(0.8, abs=2e-3)
    assert math.isclose(with_jerk.setpoint[0], 100.0, abs_tol=0.0)
