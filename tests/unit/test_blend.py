"""Corners rounded within a path tolerance: the arc's size, its place, and where there is none."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
import pytest

import polycnc
from polycnc.kernel import RAPID, STOP, KernelState, add_line, append_line, make_state, prepare_path
from polycnc.kernel._segments import CIRCLE3D, LINE
from polycnc.machine import MachineConfig, load_machine

Floats = npt.NDArray[np.float64]


def queue_of(points: list[tuple[float, float, float]], tolerance: float, flags: int = 0) -> KernelState:
    state = make_state(3, segments=64)
    state.paths.row["tolerance_mm"] = tolerance
    for tag, point in enumerate(points):
        append_line(state.seg, state.paths, 0, state.limits, np.array(point), 50.0, flags, tag)
    return state


def kinds(state: KernelState) -> list[int]:
    return [int(kind) for kind in state.seg.row["kind"][: state.paths.row[0]["tail"]]]


LEAD = (-10.0, 0.0, 0.0)  # something to run while the corner after it is still open


def test_a_right_angle_gets_the_arc_that_passes_the_corner_at_the_tolerance() -> None:
    state = queue_of([LEAD, (0.0, 0.0, 0.0), (0.0, 20.0, 0.0)], tolerance=0.1)
    assert kinds(state) == [LINE, LINE, CIRCLE3D, LINE]
    radius = 0.1 * math.cos(math.pi / 4) / (1.0 - math.cos(math.pi / 4))
    assert state.seg.geo[2, 10] == pytest.approx(radius, rel=1e-12)
    assert state.seg.row[2]["length"] == pytest.approx(radius * math.pi / 2, rel=1e-12)
    # A right angle is cut by the radius on both sides.
    assert state.seg.end[1] == pytest.approx([-radius, 0.0, 0.0], abs=1e-12)
    assert state.seg.end[2] == pytest.approx([0.0, radius, 0.0], abs=1e-12)
    assert np.array_equal(state.seg.start[3], state.seg.end[2])
    assert state.seg.row[1]["length"] == pytest.approx(10.0 - radius, rel=1e-12)


def test_short_lines_limit_the_arc_to_half_of_each() -> None:
    state = queue_of([LEAD, (0.0, 0.0, 0.0), (0.0, 0.2, 0.0), (0.2, 0.2, 0.0)], tolerance=5.0)
    assert kinds(state) == [LINE, LINE, CIRCLE3D, LINE, CIRCLE3D, LINE]
    assert state.seg.end[1] == pytest.approx([-0.1, 0.0, 0.0], abs=1e-12)
    assert state.seg.end[2] == pytest.approx([0.0, 0.1, 0.0], abs=1e-12)
    assert state.seg.row["length"][:6].min() > 0.0


@pytest.mark.parametrize(
    ("points", "tolerance", "flags"),
    [
        pytest.param([LEAD, (0, 0, 0), (0, 20, 0)], 0.0, 0, id="no tolerance"),
        pytest.param([LEAD, (0, 0, 0), (0, 20, 0)], 0.1, STOP, id="exact stop"),
        pytest.param([LEAD, (0, 0, 0), (0, 20, 0)], 0.1, RAPID, id="rapids"),
        pytest.param([LEAD, (0, 0, 0), (-9, 0, 0)], 0.1, 0, id="reversal"),
        pytest.param([LEAD, (0, 0, 0), (20, 0, 0)], 0.1, 0, id="straight on"),
    ],
)
def test_corners_that_stay_as_they_are(
    points: list[tuple[float, float, float]], tolerance: float, flags: int
) -> None:
    state = queue_of(points, tolerance, flags)
    assert kinds(state) == [LINE] * len(points)
    assert [tuple(end) for end in state.seg.end[: len(points)]] == [tuple(map(float, p)) for p in points]


@pytest.mark.parametrize(("slow_mm_s", "found"), [(100.0, [LINE, LINE]), (400.0, [LINE, CIRCLE3D, LINE])])
def test_an_arc_that_a_slow_axis_would_hold_up_is_none(slow_mm_s: float, found: list[int]) -> None:
    """Y hardly moves, but along an arc of 20 mm it would be held to its speed; stopping costs 0.06 s."""
    state = make_state(3, segments=64)
    state.limits.speed[:], state.limits.acceleration[:] = (400.0, slow_mm_s, 100.0), 6000.0
    state.paths.row["tolerance_mm"] = math.inf
    for tag, point in enumerate([(20.0, 0.0, 0.0), (60.0, 0.004, 0.0)]):
        append_line(state.seg, state.paths, 0, state.limits, np.array(point), 600.0, 0, tag)
    assert kinds(state) == found


@pytest.mark.parametrize(("closed", "found"), [(0, [LINE, CIRCLE3D, LINE]), (1, [LINE, LINE])])
def test_a_line_waits_for_the_corner_behind_it_unless_the_path_is_closed(
    closed: int, found: list[int]
) -> None:
    state = queue_of([(5.0, 0.0, 0.0)], tolerance=0.1)
    row = state.paths.row[0]
    row["closed"] = closed
    prepare_path(state.seg, state.paths, 0, state.limits, 0.001, state.work)
    assert row["prepared"] == closed
    append_line(state.seg, state.paths, 0, state.limits, np.array([5.0, 5.0, 0.0]), 50.0, 0, 1)
    assert kinds(state) == found


def distance_to(polyline: Floats, point: Floats) -> float:
    start, along = polyline[:-1], np.diff(polyline, axis=0)
    part = np.clip(np.sum((point - start) * along, axis=1) / np.sum(along * along, axis=1), 0.0, 1.0)
    return float(np.min(np.linalg.norm(start + part[:, None] * along - point, axis=1)))


def zigzag(machine: MachineConfig, tolerance_mm: float) -> tuple[polycnc.RunResult, Floats]:
    rng = np.random.default_rng(7)
    turn = np.cumsum(rng.uniform(-1.2, 1.2, 120))
    steps = np.stack([np.cos(turn), np.sin(turn), rng.uniform(-0.2, 0.2, 120)], axis=1)
    points = np.round(np.cumsum(steps * rng.uniform(0.1, 3.0, (120, 1)), axis=0), 4)
    blocks = [f"G1 X{x:.4f} Y{y:.4f} Z{z:.4f}" for x, y, z in points]
    text = "\n".join([f"G21 G90 G64 P{tolerance_mm}", "F6000", *blocks, "M30"])
    result = polycnc.run(text, machine, dialect="din", trace=True)
    return result, np.concatenate([np.zeros((1, 3)), points])


def test_a_rounded_path_is_faster_and_stays_within_tolerance_and_limits() -> None:
    machine = load_machine("mill3")
    exact, _ = zigzag(machine, 0.0)
    rounded, points = zigzag(machine, 0.02)
    assert rounded.trace is not None
    assert rounded.time_s < 0.85 * exact.time_s
    assert polycnc.verify_trace(rounded.trace, machine) == []
    worst = max(distance_to(points, point) for point in rounded.trace.setpoint[::5])
    assert 0.005 < worst <= 0.02 + 1e-9
    assert tuple(rounded.trace.setpoint[-1]) == tuple(points[-1])


def test_a_cut_counts_for_the_line_that_it_was_taken_from_alone() -> None:
    """Lines that were appended without a tolerance are cut nowhere; half of the last of them is there for an arc."""
    state = queue_of([LEAD, (0.0, 0.0, 0.0), (0.0, 7.0, 0.0)], tolerance=5.0)
    cut = 7.0 / 2.0
    assert state.seg.start[3] == pytest.approx([0.0, cut, 0.0], abs=1e-12)
    state.paths.row["tolerance_mm"] = 0.0
    columns = (state.seg.row, state.seg.start, state.seg.end, state.paths.row, state.paths.queued)
    assert add_line(*columns, 0, state.limits.feed_axis, np.array([1.3, 7.0, 0.0]), 50.0, 0, 7)
    state.paths.row["tolerance_mm"] = 5.0
    append_line(state.seg, state.paths, 0, state.limits, np.array([1.3, 20.0, 0.0]), 50.0, 0, 8)
    assert kinds(state) == [LINE, LINE, CIRCLE3D, LINE, LINE, CIRCLE3D, LINE]
    assert state.seg.end[4] == pytest.approx([1.3 / 2.0, 7.0, 0.0], abs=1e-12)
