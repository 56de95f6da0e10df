"""Corners by their angle, as small open controls take them, against those controls' published formulas."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
import pytest

from polycnc.kernel import append_line, give_to_path, prepare_path, skip, start_path
from polycnc.machine import LinearAxis, Machine, MachineConfig, PathConfig
from support.random_paths import seeds
from support.sender_planner import Rule, by_junction_deviation, by_square_corner, travel_time

Floats = npt.NDArray[np.float64]

SPEED = np.array([137.0, 113.0, 41.0])
ACCELERATION = np.array([1700.0, 1300.0, 430.0])


def machine(path: PathConfig, acceleration: Floats = ACCELERATION) -> Machine:
    return Machine(
        MachineConfig(
            name="router",
            axis=tuple(
                LinearAxis(name=name, vmax_mm_s=v, amax_mm_s2=a)
                for name, v, a in zip("XYZ", SPEED, acceleration, strict=True)
            ),
            path=path,
        ),
        segments=4096,
    )


def time_of(points: Floats, feed: float, path: PathConfig, acceleration: Floats = ACCELERATION) -> float:
    state = machine(path, acceleration).state
    give_to_path(state, 0)
    state.paths.queued[0] = state.paths.position[0] = points[0]
    for tag, point in enumerate(points[1:], 1):
        assert append_line(state.seg, state.paths, 0, state.limits, np.asarray(point), feed, 0, tag)
    state.paths.row[0]["closed"] = 1
    prepare_path(state.seg, state.paths, 0, state.limits, 0.001, state.work)
    start_path(state.paths, 0)
    return float(skip(state, 0, int(state.paths.row[0]["tail"])) * 0.001)


def walk(seed: int) -> tuple[Floats, float]:
    rng = np.random.default_rng(seed)
    size = float(rng.choice([0.05, 0.3, 2.0, 17.0]))
    heading = np.cumsum(rng.normal(size=80) * rng.choice([0.02, 0.3, 1.5]))
    lengths = size * rng.uniform(0.2, 1.0, size=80)
    steps = lengths[:, None] * np.column_stack(
        [np.cos(heading), np.sin(heading), 0.3 * np.sin(3.0 * heading)]
    )
    return np.vstack([np.zeros(3), np.cumsum(steps, axis=0)]) + 3.7, float(rng.uniform(5.0, 150.0))


def assert_agrees(
    seed: int,
    path: PathConfig,
    rule: Rule,
    acceleration: Floats = ACCELERATION,
    low_acceleration: float = math.inf,
) -> None:
    points, feed = walk(seed)
    expected, stretches = travel_time(
        points,
        feed,
        rule,
        speed=SPEED,
        acceleration=acceleration,
        path_speed=path.speed_limit_mm_s or math.inf,
        path_acceleration=path.acceleration_limit_mm_s2 or math.inf,
        low_acceleration=low_acceleration,
    )
    # Every stretch from rest to rest takes whole cycles.
    time = time_of(points, feed, path, acceleration)
    assert expected - 1e-9 <= time <= expected + 0.001 * stretches + 1e-9, f"seed {seed}"


@pytest.mark.parametrize("deviation", [0.002, 0.01, 0.13])
def test_junction_deviation_takes_the_time_of_its_formula(deviation: float) -> None:
    for seed in seeds(0, 60):
        assert_agrees(
            seed,
            PathConfig(junction_deviation_mm=deviation),
            by_junction_deviation(deviation, ACCELERATION),
        )


@pytest.mark.parametrize("speed", [1.0, 5.0, 23.0])
def test_square_corner_speed_takes_the_time_of_its_formula(speed: float) -> None:
    even = np.array([3100.0, 3100.0, 700.0])
    for seed in seeds(100, 160):
        path = PathConfig(square_corner_mm_s=speed, speed_limit_mm_s=120.0, acceleration_limit_mm_s2=3100.0)
        assert_agrees(seed, path, by_square_corner(speed, 3100.0), even)


@pytest.mark.parametrize("share", [0.25, 0.5, 0.9])
def test_a_minimum_cruise_share_takes_the_time_of_its_formula(share: float) -> None:
    even = np.array([3100.0, 3100.0, 700.0])
    for seed in range(200, 260):
        path = PathConfig(
            square_corner_mm_s=6.0,
            speed_limit_mm_s=120.0,
            acceleration_limit_mm_s2=3100.0,
            minimum_cruise_share=share,
        )
        assert_agrees(seed, path, by_square_corner(6.0, 3100.0), even, 3100.0 * (1.0 - share))


@pytest.mark.parametrize("piece", [1, 3, 11])
def test_cruising_speeds_are_the_same_however_the_path_comes_in(piece: int) -> None:
    path = PathConfig(square_corner_mm_s=6.0, acceleration_limit_mm_s2=3100.0, minimum_cruise_share=0.6)
    for seed in range(300, 312):
        points, feed = walk(seed)
        found = []
        for size in (len(points), piece):
            state = machine(path).state
            state.paths.queued[0] = state.paths.position[0] = points[0]
            for tag, point in enumerate(points[1:], 1):
                append_line(state.seg, state.paths, 0, state.limits, np.asarray(point), feed, 0, tag)
                if tag % size == 0 and tag + size < len(points):
                    final = int(state.paths.row[0]["planned"])
                    before = state.seg.row[:final][["cap", "junction", "out"]].tolist()
                    prepare_path(state.seg, state.paths, 0, state.limits, 0.001, state.work)
                    assert state.seg.row[:final][["cap", "junction", "out"]].tolist() == before
            state.paths.row[0]["closed"] = 1
            prepare_path(state.seg, state.paths, 0, state.limits, 0.001, state.work)
            found.append(state.seg.row[: len(points) - 1][["cap", "junction", "out"]].tolist())
            assert state.paths.row[0]["planned"] == len(points) - 1
        assert found[0] == found[1]


def test_a_minimum_cruise_share_needs_corners_by_their_angle() -> None:
    with pytest.raises(ValueError, match="passed by their angle"):
        PathConfig(minimum_cruise_share=0.5)


def test_a_right_angle_is_passed_at_the_square_corner_speed() -> None:
    state = machine(PathConfig(square_corner_mm_s=7.0), np.full(3, 900.0)).state
    give_to_path(state, 0)
    for tag, point in enumerate([[30.0, 0, 0], [30, 20, 0]], 1):
        assert append_line(state.seg, state.paths, 0, state.limits, np.array(point, float), 60.0, 0, tag)
    prepare_path(state.seg, state.paths, 0, state.limits, 0.001, state.work)
    assert state.seg.row[0]["junction"] == pytest.approx(7.0, rel=1e-12)


def test_a_reversal_stops_whatever_the_rule() -> None:
    points = np.array([[0.0, 0, 0], [40.0, 0, 0], [0, 0, 0]])
    # 40 mm at 100 mm/s and 1700 mm/s2, from rest to rest, in whole cycles, twice.
    alone = math.ceil((40.0 / 100.0 + 100.0 / 1700.0) * 1000.0) * 0.001
    for path in (PathConfig(junction_deviation_mm=5.0), PathConfig(square_corner_mm_s=80.0)):
        assert time_of(points, 100.0, path) == pytest.approx(2.0 * alone, abs=1e-9)


def test_the_limits_of_the_path_hold_on_lines_across_axes() -> None:
    # A diagonal could go sqrt(2) times as fast as one axis; the path may not.
    points = np.array([[0.0, 0, 0], [60.0, 60.0, 0]])
    path = PathConfig(speed_limit_mm_s=50.0, acceleration_limit_mm_s2=400.0)
    expected = math.hypot(60.0, 60.0) / 50.0 + 50.0 / 400.0
    assert time_of(points, 150.0, path) == pytest.approx(expected, abs=0.001)
