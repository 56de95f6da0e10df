"""Paths with circles in three axes and splines, and axes that ride along: limits, geometry, ends."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
import pytest
from scipy.interpolate import CubicSpline

from polycnc.kernel import (
    RAPID,
    KernelState,
    append_arc,
    append_circle3d,
    append_line,
    append_spline,
    give_to_path,
    make_state,
    skip,
    start_path,
)
from polycnc.kernel._segments import CIRCLE3D, SPLINE
from polycnc.kernel._spline import Splines, make_splines
from polycnc.kernel._spline_build import CUBIC_NATURAL, add_bezier, add_cubic
from support.random_paths import CYCLE_S, is_done, overload, prepare, run_recorded, stop_everywhere

Floats = npt.NDArray[np.float64]

AXES = 3  # as in `overload`
ROUNDING = 1.0 + 1e-6
RECORDED = 1 << 16


def curve_machine(rng: np.random.Generator, ride_along: bool) -> tuple[KernelState, Splines]:
    """Return a machine with random limits and a store of splines; its last axis may ride along (rotary)."""
    store = make_splines(AXES)
    state = make_state(AXES, cycle_s=CYCLE_S, segments=4096, record_cycles=RECORDED, splines=store)
    state.limits.speed[:] = rng.uniform(50.0, 600.0, AXES)
    state.limits.acceleration[:] = rng.uniform(300.0, 8000.0, AXES)
    if ride_along:
        state.limits.feed_axis[2] = 0
    state.paths.row[0]["jerkrel"] = rng.choice((0.0, 0.0, 0.5))
    give_to_path(state, 0)
    return state, store


def append_random(
    state: KernelState, store: Splines, rng: np.random.Generator, ride_along: bool, tag: int
) -> bool:
    """Append one line, arc, circle or spline."""
    seg, paths, limits = state.seg, state.paths, state.limits
    place = paths.queued[0].copy()
    feed = float(rng.choice((5.0, 50.0, 500.0)))
    size = 10.0 ** rng.uniform(-1.0, 1.3)
    kind = int(rng.integers(0, 4))
    if kind == 0:
        rapid = bool(rng.integers(0, 2))
        end = place + rng.normal(size=AXES) * size
        return append_line(
            seg, paths, 0, limits, end, math.inf if rapid else feed, RAPID if rapid else 0, tag
        )
    if kind == 1:  # a helix; the third axis may be rotary
        end = place + np.array([0.0, 0.0, rng.normal() * size])
        center = place[:2] + rng.normal(size=2) * size
        return append_arc(seg, paths, 0, limits, end, 0, 1, center[0], center[1], 2.0 * math.pi, feed, 0, tag)
    if kind == 2 and not ride_along:
        center = place + rng.normal(size=3) * size
        normal = rng.normal(size=3)
        sweep = float(rng.uniform(-400.0, 400.0))
        return append_circle3d(seg, paths, 0, 0, 1, 2, center, normal, sweep, feed, 0, tag)
    points = place + np.vstack([np.zeros(AXES), np.cumsum(rng.normal(size=(6, AXES)) * size, axis=0)])
    path_axes = limits.feed_axis
    if kind == 2:
        index = add_bezier(store, points, path_axes)
    else:
        knots = np.arange(len(points), dtype=np.float64)
        index = add_cubic(store, knots, points, CUBIC_NATURAL, np.zeros((2, AXES)), path_axes)
    assert index >= 0
    return append_spline(seg, store, paths, 0, index, feed, 0, tag) > 0


@pytest.mark.parametrize("ride_along", [False, True])
def test_every_axis_keeps_its_limits_and_the_end_is_exact(ride_along: bool) -> None:
    for seed in range(40):
        rng = np.random.default_rng(seed)
        state, store = curve_machine(rng, ride_along)
        for tag in range(1, 25):
            assert append_random(state, store, rng, ride_along, tag), f"seed {seed}"
        prepare(state)
        start_path(state.paths, 0)
        run_recorded(state)
        speed, acceleration = overload(state)
        assert speed <= ROUNDING, f"seed {seed}"
        assert acceleration <= ROUNDING, f"seed {seed}"
        if is_done(state):
            assert np.array_equal(state.setpoint, state.paths.queued[0])


@pytest.mark.parametrize("ride_along", [False, True])
def test_going_on_is_never_slower_than_stopping_at_every_block(ride_along: bool) -> None:
    saved = 0
    for seed in range(200, 260):
        cycles = []
        for stops in (False, True):
            rng = np.random.default_rng(seed)
            state, store = curve_machine(rng, ride_along)
            for tag in range(1, int(rng.integers(3, 40))):
                assert append_random(state, store, rng, ride_along, tag), f"seed {seed}"
            if stops:
                stop_everywhere(state)
            prepare(state)
            start_path(state.paths, 0)
            cycles.append(skip(state, 0, int(state.paths.row[0]["tail"])))
        assert cycles[0] <= cycles[1], f"seed {seed}"
        saved += cycles[1] - cycles[0]
    assert saved > 0


def recorded(state: KernelState, tag: int) -> Floats:
    rows = state.recorder.rows[: int(state.recorder.filled[0])]
    return np.asarray(rows[rows[:, 1] == tag][:, 4 : 4 + AXES])


def test_a_circle_in_space_keeps_its_radius_and_its_plane() -> None:
    state, _ = curve_machine(np.random.default_rng(1), False)
    center, normal = np.array([3.0, -4.0, 12.0]), np.array([1.0, 2.0, -0.5])
    assert append_circle3d(state.seg, state.paths, 0, 0, 1, 2, center, normal, 270.0, 20.0, 0, 7)
    assert state.seg.row[0]["kind"] == CIRCLE3D
    prepare(state)
    start_path(state.paths, 0)
    run_recorded(state)
    # The circle's own centre is the foot of the start on the axis through `center`.
    unit = normal / np.linalg.norm(normal)
    foot = center - np.dot(center, unit) * unit
    points = recorded(state, 7)
    radius = np.linalg.norm(foot)
    assert len(points) > 1000
    assert np.allclose(np.linalg.norm(points - foot, axis=1), radius, rtol=1e-12)
    assert np.allclose((points - foot) @ unit, 0.0, atol=1e-12 * radius)


def test_a_circle_without_normal_or_radius_is_refused_and_nothing_appended() -> None:
    state, _ = curve_machine(np.random.default_rng(1), False)
    for center, normal in (((1.0, 0.0, 0.0), (0.0, 0.0, 0.0)), ((0.0, 0.0, 5.0), (0.0, 0.0, 1.0))):
        arguments = (np.array(center), np.array(normal), 90.0, 20.0, 0, 1)
        assert not append_circle3d(state.seg, state.paths, 0, 0, 1, 2, *arguments)
    assert state.paths.row[0]["tail"] == 0


def test_a_spline_runs_through_its_points_piece_by_piece() -> None:
    state, store = curve_machine(np.random.default_rng(2), False)
    knots = np.arange(5.0)
    points = np.array(
        [[0.0, 0.0, 0.0], [10.0, 5.0, 0.0], [20.0, -5.0, 3.0], [25.0, 0.0, 3.0], [40.0, 0.0, 0.0]]
    )
    index = add_cubic(store, knots, points, CUBIC_NATURAL, np.zeros((2, AXES)), state.limits.feed_axis)
    assert append_spline(state.seg, store, state.paths, 0, index, 30.0, 0, 1) == 4
    assert state.seg.row["kind"][:4].tolist() == [SPLINE] * 4
    assert np.allclose(state.seg.end[:4], points[1:], rtol=0.0, atol=1e-12)
    assert state.seg.row["length"][:4].sum() == pytest.approx(store.length[index], rel=1e-12)
    prepare(state)
    start_path(state.paths, 0)
    run_recorded(state)
    # No setpoint is beside the curve of scipy: the nearest of many points of it is as close as they are apart.
    curve = CubicSpline(knots, points, bc_type="natural")
    u = np.linspace(0.0, 4.0, 40001)
    dense = curve(u)
    for place in recorded(state, 1)[::97]:
        nearest = int(np.argmin(np.sum((dense - place) ** 2, axis=1)))
        direction = curve(u[nearest], 1)
        off = place - dense[nearest]
        off -= direction * np.dot(off, direction) / np.dot(direction, direction)
        assert np.linalg.norm(off) < 1e-5


def test_a_spline_that_begins_elsewhere_or_does_not_fit_is_refused() -> None:
    state, store = curve_machine(np.random.default_rng(3), False)
    axes = state.limits.feed_axis
    elsewhere = add_bezier(store, np.arange(12.0).reshape(4, 3) + 1.0, axes)
    assert append_spline(state.seg, store, state.paths, 0, elsewhere, 10.0, 0, 1) == 0
    here = add_bezier(store, np.arange(12.0).reshape(4, 3) ** 1.5 - np.array([0.0, 1.0, 2.0**1.5]), axes)
    state.paths.row[0]["tail"] = state.paths.row[0]["capacity"]  # a full queue
    assert append_spline(state.seg, store, state.paths, 0, here, 10.0, 0, 1) == 0
    state.paths.row[0]["tail"] = 0
    assert append_spline(state.seg, store, state.paths, 0, here, 10.0, 0, 1) == 1
