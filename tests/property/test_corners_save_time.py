"""A corner is passed with speed where that saves time, and never costs any."""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import numpy.typing as npt
import pytest

from polycnc.kernel import KernelState, append_arc, append_line, give_to_path, make_state, skip, start_path
from support.often import often
from support.random_paths import (
    CYCLE_S,
    PathSettings,
    overload,
    prepare,
    random_path,
    run_recorded,
    seeds,
    stop_everywhere,
)
from support.two_passes import kinks, planned_time, stairs

Floats = npt.NDArray[np.float64]

SPEED = np.array([500.0, 400.0, 300.0])
ACCELERATION = np.array([5000.0, 4000.0, 3000.0])
SETTINGS = (
    PathSettings(),
    PathSettings(jerkrel=0.3),
    PathSettings(jerkrel=1.0),
    PathSettings(depth=3),
    PathSettings(tolerance=0.1),
    PathSettings(tolerance=math.inf, jerkrel=0.3),
)


def polyline(
    points: Floats,
    feed: float,
    *,
    stops: bool = False,
    speed: Floats = SPEED,
    acceleration: Floats = ACCELERATION,
) -> KernelState:
    """Return a machine at the first point, ready to go through the others."""
    state = make_state(3, cycle_s=CYCLE_S, segments=4096, record_cycles=1 << 15)
    state.limits.speed[:], state.limits.acceleration[:] = speed, acceleration
    state.paths.position[0] = state.paths.queued[0] = points[0]
    give_to_path(state, 0)
    state.paths.queued[0] = state.paths.position[0] = points[0]
    for tag, point in enumerate(points[1:], 1):
        assert append_line(state.seg, state.paths, 0, state.limits, np.asarray(point, float), feed, 0, tag)
    if stops:
        stop_everywhere(state)
    prepare(state)
    start_path(state.paths, 0)
    return state


def time_of(state: KernelState) -> float:
    return skip(state, 0, int(state.paths.row[0]["tail"])) * CYCLE_S


LENGTHS = (None, 0.0002, 0.002, 0.05, 1.0)


@pytest.mark.parametrize(("settings", "length"), often(list(product(SETTINGS, LENGTHS)), 11))
def test_going_on_is_never_slower_than_stopping_at_every_block(
    settings: PathSettings, length: float | None
) -> None:
    saved = 0
    for seed in seeds(2000, 2016):
        most = 300 if seed % 2 else 8
        cycles = [
            skip(state, 0, int(state.paths.row[0]["tail"]))
            for state in (
                random_path(seed, settings, length, most=most),
                random_path(seed, settings, length, stops=True, most=most),
            )
        ]
        assert cycles[0] <= cycles[1], f"seed {seed}"
        saved += cycles[1] - cycles[0]
    assert saved > 0


def test_what_physics_stops_takes_the_time_of_stopping() -> None:
    there_and_back = np.array([[0.0, 0.0, 0.0], [100.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    # 100 mm at 500 mm/s and 5000 mm/s2: 0.2 s and one ramp of 0.1 s, twice.
    assert time_of(polyline(there_and_back, 500.0)) == pytest.approx(0.6, abs=1e-9)
    # Around a square turned by an eighth X or Y reverses at every corner.
    turned = np.array([[0.0, 0, 0], [40, 40, 0], [0, 80, 0], [-40, 40, 0], [0, 0, 0]])
    even = np.full(3, 5000.0)
    stopping = time_of(polyline(turned, 200.0, stops=True, acceleration=even))
    assert time_of(polyline(turned, 200.0, acceleration=even)) == pytest.approx(stopping, abs=4e-3)


def test_a_right_angle_is_passed_at_half_of_what_a_cycle_gives() -> None:
    state = polyline(np.array([[0.0, 0, 0], [30, 0, 0], [30, 20, 0]]), 100.0, acceleration=np.full(3, 5000.0))
    assert state.seg.row[0]["junction"] == pytest.approx(0.5 * 5000.0 * CYCLE_S)
    # A quarter of the acceleration is given away beside it, the rest of the line has all.
    assert state.seg.row[0]["yield_before"] * state.seg.row[0]["junction"] == pytest.approx(0.25)
    assert state.seg.row[0]["accel"] == 5000.0


def walks() -> dict[str, tuple[Floats, float]]:
    """Return polylines of lines that take some cycles each, with their feeds."""
    rng = np.random.default_rng(7)
    found: dict[str, tuple[Floats, float]] = {"stairs": (stairs(60, 1.0), 500.0)}
    for size in (0.4, 1.5, 6.0):
        for spread in (0.03, 0.2, 1.0):
            heading = np.cumsum(rng.normal(size=120) * spread)
            steps = size * np.column_stack([np.cos(heading), np.sin(heading), 0.2 * np.sin(3.0 * heading)])
            walk = np.vstack([np.zeros(3), np.cumsum(steps, axis=0)])
            found[f"{size} mm, turning by {spread} rad"] = (walk, 100.0)
    scribble = np.vstack([np.zeros(3), np.cumsum(rng.normal(size=(150, 3)) * (2.0, 2.0, 0.0), axis=0)])
    found["scribble"] = (scribble, 60.0)
    return found


@pytest.mark.parametrize("name", walks())
def test_within_a_hundredth_of_a_two_pass_planner_with_the_same_corner_rule(name: str) -> None:
    points, feed = walks()[name]
    reference = planned_time(points, feed, SPEED, ACCELERATION)
    assert kinks(points) > 50
    assert time_of(polyline(points, feed)) == pytest.approx(reference, rel=0.01)
    stepped = polyline(points, feed)
    run_recorded(stepped)
    stepped.recorder.rows[:, 4:7] -= points[0]
    assert max(overload(stepped)) <= 1.0 + 1e-6


def circle(radius: float, chord: float) -> Floats:
    count = round(2.0 * math.pi * radius / chord)
    angle = np.linspace(0.0, 2.0 * math.pi, count + 1)
    return np.column_stack([radius * np.sin(angle), radius - radius * np.cos(angle), 0.0 * angle])


def top_speed(state: KernelState) -> float:
    run_recorded(state)
    return float(state.recorder.rows[: int(state.recorder.filled[0]), 2].max())


@pytest.mark.parametrize(
    ("chord", "least"),
    [
        # Within a cycle lie several corners: what an arc could reach at most is sqrt(a R) = 223.6 mm/s.
        (0.05, 0.92 * 223.6),
        (0.1, 0.92 * 223.6),
        # Longer chords: all of a cycle's change of velocity in one corner, a T R / chord, is 250, 100 and 50 mm/s.
        (0.2, 0.79 * 223.6),
        (0.5, 0.85 * 100.0),
        (1.0, 0.85 * 50.0),
    ],
)
def test_chords_of_a_circle_keep_what_physics_allows(chord: float, least: float) -> None:
    state = polyline(circle(10.0, chord), 1000.0, acceleration=np.full(3, 5000.0))
    assert top_speed(state) > least
    assert max(overload(state)) <= 1.0 + 1e-6


def test_a_circle_of_fine_chords_is_as_fast_as_an_arc() -> None:
    chords = time_of(polyline(circle(10.0, 0.05), 200.0, acceleration=np.full(3, 5000.0)))
    arc = polyline(np.zeros((1, 3)), 200.0, acceleration=np.full(3, 5000.0))
    end = np.zeros(3)
    assert append_arc(arc.seg, arc.paths, 0, arc.limits, end, 0, 1, 0.0, 10.0, 2.0 * math.pi, 200.0, 0, 1)
    prepare(arc)
    assert chords <= time_of(arc)
