"""Paths with circles in three axes and Bezier curves, and axes that ride along: limits, geometry, ends."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
import pytest

from polycnc.kernel import (
    MOST_SPANS,
    RAPID,
    SPAN_CURVED,
    SPAN_END,
    SPAN_LENGTH,
    SPAN_SIZE,
    KernelState,
    append_arc,
    append_circle3d,
    append_line,
    append_spline,
    cut_bezier,
    give_to_path,
    make_state,
    skip,
    start_path,
)
from polycnc.kernel._segments import CIRCLE3D
from support.random_paths import (
    CYCLE_S,
    blocks,
    is_done,
    overload,
    prepare,
    run_recorded,
    seeds,
    stop_everywhere,
)

Floats = npt.NDArray[np.float64]

AXES = 3  # as in `overload`
ROUNDING = 1.0 + 1e-6
RECORDED = 1 << 16


def curve_machine(rng: np.random.Generator, ride_along: bool) -> KernelState:
    """Return a machine with random limits; its last axis may ride along (rotary)."""
    state = make_state(AXES, cycle_s=CYCLE_S, segments=4096, record_cycles=RECORDED)
    state.limits.speed[:] = rng.uniform(50.0, 600.0, AXES)
    state.limits.acceleration[:] = rng.uniform(300.0, 8000.0, AXES)
    if ride_along:
        state.limits.feed_axis[2] = 0
    state.paths.row[0]["jerkrel"] = rng.choice((0.0, 0.0, 0.5))
    give_to_path(state, 0)
    return state


def append_bezier(state: KernelState, control: Floats, axes: tuple[int, int], feed: float, tag: int) -> bool:
    """Append a cubic with these ways from the path's end to its control points and its end."""
    spans = np.zeros((MOST_SPANS, SPAN_SIZE))
    count = cut_bezier(np.vstack([np.zeros(2), control]), spans)
    start = state.paths.queued[0].copy()
    for span in spans[: max(count, 0)]:
        end = start.copy()
        end[list(axes)] += span[SPAN_END : SPAN_END + 2]
        length = span[SPAN_LENGTH]
        if span[SPAN_CURVED]:
            append_spline(state.seg, state.paths, 0, end, *axes, span, length, feed, 0, tag)
        else:
            append_line(state.seg, state.paths, 0, state.limits, end, feed, 0, tag)
    return count > 0


def append_random(state: KernelState, rng: np.random.Generator, ride_along: bool, tag: int) -> bool:
    """Append one line, arc, circle or Bezier curve."""
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
    control = rng.normal(size=(3, 2)) * size
    if rng.integers(0, 4) == 0:
        control[0] = 0.0  # it stands still at its start
    axes = (0, 1) if ride_along or rng.integers(0, 2) else (2, 0)
    return append_bezier(state, control, axes, feed, tag)


@pytest.mark.parametrize("ride_along", [False, True])
def test_every_axis_keeps_its_limits_and_the_end_is_exact(ride_along: bool) -> None:
    for seed in seeds(0, 40):
        rng = np.random.default_rng(seed)
        state = curve_machine(rng, ride_along)
        for tag in range(1, blocks(25)):
            assert append_random(state, rng, ride_along, tag), f"seed {seed}"
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
    for seed in seeds(200, 260):
        cycles = []
        for stops in (False, True):
            rng = np.random.default_rng(seed)
            state = curve_machine(rng, ride_along)
            for tag in range(1, int(rng.integers(3, blocks(40)))):
                assert append_random(state, rng, ride_along, tag), f"seed {seed}"
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
    state = curve_machine(np.random.default_rng(1), False)
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
    state = curve_machine(np.random.default_rng(1), False)
    for center, normal in (((1.0, 0.0, 0.0), (0.0, 0.0, 0.0)), ((0.0, 0.0, 5.0), (0.0, 0.0, 1.0))):
        arguments = (np.array(center), np.array(normal), 90.0, 20.0, 0, 1)
        assert not append_circle3d(state.seg, state.paths, 0, 0, 1, 2, *arguments)
    assert state.paths.row[0]["tail"] == 0
