"""Splines as path segments, against scipy's splines, quadrature and closed forms."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from collections.abc import Callable
from itertools import pairwise

import numpy as np
import numpy.typing as npt
import pytest
from scipy.integrate import quad
from scipy.interpolate import BSpline, CubicSpline

from polycnc.kernel import _spline as sp
from polycnc.kernel import _spline_build as make
from polycnc.kernel import _spline_pieces as cut

Floats = npt.NDArray[np.float64]
Mask = npt.NDArray[np.uint8]
Curve = Callable[[float], Floats]

NO_SLOPES = np.zeros((2, 3))
POINTS = np.array([[0.0, 0, 5], [10, 4, 5], [14, 12, 3], [9, 20, 1], [-3, 21, 0], [-8, 14, 2.5], [0, 0, 5]])
KNOTS = np.array([0.0, 1.0, 1.8, 2.9, 4.0, 5.2, 7.0])
HALF = math.sqrt(0.5)
CIRCLE = 10.0 * np.array(
    [
        [1.0, 0, 0],
        [1, 1, 0],
        [0, 1, 0],
        [-1, 1, 0],
        [-1, 0, 0],
        [-1, -1, 0],
        [0, -1, 0],
        [1, -1, 0],
        [1, 0, 0],
    ]
)
CIRCLE_WEIGHTS = np.array([1.0, HALF, 1, HALF, 1, HALF, 1, HALF, 1])
CIRCLE_KNOTS = np.array([0.0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4])


def all_axes(n: int) -> Mask:
    return np.ones(n, np.uint8)


def read(function: Callable[..., None], store: sp.Splines, k: int, s: float) -> Floats:
    out = np.zeros(store.path_axes.shape[1])
    function(store, k, s, out)
    return out


def point(store: sp.Splines, k: int, s: float) -> Floats:
    return read(sp.spline_point, store, k, s)


def tangent(store: sp.Splines, k: int, s: float) -> Floats:
    return read(sp.spline_tangent, store, k, s)


def bound(function: Callable[..., None], store: sp.Splines, k: int) -> Floats:
    out = np.zeros(store.path_axes.shape[1])
    function(store, k, out)
    return out


def along(store: sp.Splines, k: int, count: int = 60) -> Floats:
    """Return path lengths that avoid meeting the ends of spans."""
    return np.asarray(store.length[k] * (np.arange(count) + 0.618) / (count + 0.3))


def check_derivatives(store: sp.Splines, k: int, velocity: Curve, acceleration: Curve, knots: Floats) -> None:
    """Compare path length, tangent and curvature with those of a curve p(x) with pieces between `knots`."""

    def speed(x: float) -> float:
        return math.sqrt(float(velocity(x) @ velocity(x)))

    pieces = [quad(speed, a, b, epsabs=1e-13, epsrel=1e-13)[0] for a, b in pairwise(knots)]
    starts = np.concatenate([[0.0], np.cumsum(pieces)])
    assert store.length[k] == pytest.approx(starts[-1], rel=1e-12)
    for s in along(store, k):
        piece, u = sp.spline_parameter(store, k, s)
        x = float(knots[piece] + u * (knots[piece + 1] - knots[piece]))
        reached = starts[piece] + quad(speed, float(knots[piece]), x, epsabs=1e-13, epsrel=1e-13)[0]
        assert abs(reached - s) <= 1e-9 * store.length[k]
        v, a = velocity(x), acceleration(x)
        square = float(v @ v)
        np.testing.assert_allclose(tangent(store, k, s), v / math.sqrt(square), atol=1e-12)
        bend = a / square - v * float(v @ a) / (square * square)
        np.testing.assert_allclose(read(sp.spline_curvature_vector, store, k, s), bend, rtol=1e-9, atol=1e-11)


@pytest.mark.parametrize("ends", [make.CUBIC_NATURAL, make.CUBIC_CLAMPED, make.CUBIC_PERIODIC])
@pytest.mark.parametrize("count", [4, 5, 7])
def test_a_cubic_spline_is_scipys(ends: int, count: int) -> None:
    points, knots = POINTS[:count].copy(), KNOTS[:count]
    if ends == make.CUBIC_PERIODIC:
        points[-1] = points[0]
    slopes = np.array([[3.0, -2.0, 0.5], [1.0, 7.0, -1.0]])
    conditions = {
        make.CUBIC_NATURAL: "natural",
        make.CUBIC_CLAMPED: ((1, slopes[0]), (1, slopes[1])),
        make.CUBIC_PERIODIC: "periodic",
    }
    peer = CubicSpline(knots, points, bc_type=conditions[ends])
    store = sp.make_splines(3)
    k = make.add_cubic(store, knots, points, ends, slopes, all_axes(3))
    assert k == 0
    for s in along(store, k):
        piece, u = sp.spline_parameter(store, k, s)
        x = knots[piece] + u * (knots[piece + 1] - knots[piece])
        np.testing.assert_allclose(point(store, k, s), peer(x), atol=1e-13, rtol=0.0)
    check_derivatives(store, k, lambda x: np.asarray(peer(x, 1)), lambda x: np.asarray(peer(x, 2)), knots)


def test_a_cubic_spline_of_two_points_is_a_line_or_a_hermite_curve() -> None:
    store = sp.make_splines(2)
    ends = np.array([[1.0, 2.0], [4.0, 6.0]])
    k = make.add_cubic(store, np.array([0.0, 3.0]), ends, make.CUBIC_NATURAL, np.zeros((2, 2)), all_axes(2))
    assert store.length[k] == pytest.approx(5.0, rel=1e-15)
    np.testing.assert_allclose(point(store, k, 2.0), [2.2, 3.6], atol=1e-14)
    slopes = np.array([[5.0, 0.0], [5.0, 0.0]])
    k = make.add_cubic(store, np.array([0.0, 1.0]), ends, make.CUBIC_CLAMPED, slopes, all_axes(2))
    np.testing.assert_allclose(tangent(store, k, 0.0), [1.0, 0.0], atol=1e-15)
    np.testing.assert_allclose(point(store, k, 0.5 * store.length[k]), [2.5, 4.0], atol=1e-9)


def test_a_closed_spline_of_two_different_points_goes_there_and_back() -> None:
    points = np.array([[1.0, 2.0], [4.0, 6.0], [1.0, 2.0]])
    store = sp.make_splines(2)
    knots = np.array([0.0, 1.0, 4.0])
    k = make.add_cubic(store, knots, points, make.CUBIC_PERIODIC, np.zeros((2, 2)), all_axes(2))
    peer = CubicSpline(knots, points, bc_type="periodic")
    xs = np.linspace(0.0, 4.0, 20_001)
    assert store.length[k] == pytest.approx(np.linalg.norm(np.diff(peer(xs), axis=0), axis=1).sum(), rel=1e-6)
    for s in along(store, k):
        p = point(store, k, s)
        assert np.min(np.linalg.norm(peer(xs) - p, axis=1)) < 1e-3


def test_points_on_a_line_give_the_line() -> None:
    """Uneven points on a line: the parameter may run unevenly, the path must not."""
    direction = np.array([2.0, -1.0, 2.0]) / 3.0
    places = np.array([0.0, 1.0, 5.0, 5.5, 12.0])
    store = sp.make_splines(3)
    k = make.add_cubic(store, places, places[:, None] * direction, make.CUBIC_NATURAL, NO_SLOPES, all_axes(3))
    assert store.length[k] == pytest.approx(12.0, rel=1e-14)
    for s in along(store, k):
        np.testing.assert_allclose(point(store, k, s), s * direction, atol=1e-12)
        np.testing.assert_allclose(tangent(store, k, s), direction, atol=1e-13)
        np.testing.assert_allclose(read(sp.spline_curvature_vector, store, k, s), 0.0, atol=1e-12)


def test_a_line_that_stops_at_both_ends_of_its_parameter_still_runs_evenly() -> None:
    control = np.array([[0.0, 0, 0], [0, 0, 0], [30, 40, 0], [30, 40, 0]])
    store = sp.make_splines(3)
    k = make.add_bezier(store, control, all_axes(3))
    assert store.length[k] == pytest.approx(50.0, rel=1e-14)
    for s in [*along(store, k), 1e-7, 50.0 - 1e-7]:
        np.testing.assert_allclose(point(store, k, s), np.array([0.6, 0.8, 0.0]) * s, atol=1e-13)
        np.testing.assert_allclose(tangent(store, k, s), [0.6, 0.8, 0.0], atol=1e-15)
    assert np.all(bound(sp.spline_curvature_bound, store, k) < 1e-15)


def test_a_control_point_taken_three_times_is_a_corner_between_straight_ends() -> None:
    control = np.array(
        [[0.0, 0, 0], [20, 1, 3], [31, 12, 5], [31, 12, 5], [31, 12, 5], [44, 9, -2], [60, 0, 0]]
    )
    store = sp.make_splines(3)
    k = make.add_nurbs(
        store, 3, control, np.ones(7), np.array([0.0, 0, 0, 0, 1, 2, 3, 4, 4, 4, 4]), all_axes(3)
    )
    corner = sp.spline_next_corner(store, k, 0.0)
    np.testing.assert_allclose(point(store, k, corner), control[2], atol=1e-12)
    before, after = read(sp.spline_tangent_before, store, k, corner), tangent(store, k, corner)
    towards = control[2] - point(store, k, corner - 0.5)
    np.testing.assert_allclose(before, towards / np.linalg.norm(towards), atol=1e-12)
    away = point(store, k, corner + 0.5) - control[2]
    np.testing.assert_allclose(after, away / np.linalg.norm(away), atol=1e-12)
    places = np.linspace(0.0, store.length[k], 3000)
    sampled = np.max([np.abs(read(sp.spline_curvature_vector, store, k, s)) for s in places], axis=0)
    assert np.all(bound(sp.spline_curvature_bound, store, k) <= 1.05 * sampled)


def test_a_parameter_that_runs_to_and_fro_on_a_line_turns_round_at_corners() -> None:
    store = sp.make_splines(1)
    k = make.add_bezier(store, np.array([[0.0], [20.0], [-10.0], [10.0]]), all_axes(1))
    turn = math.sqrt(0.05)  # dp/du = 60 - 300 u + 300 u2 is zero at u = 1/2 -+ sqrt(1/20)
    high = [60.0 * u - 150.0 * u * u + 100.0 * u**3 for u in (0.5 - turn, 0.5 + turn)]
    first = sp.spline_next_corner(store, k, 0.0)
    second = sp.spline_next_corner(store, k, first + 0.1)
    assert first == pytest.approx(high[0], rel=1e-9)
    assert second == pytest.approx(2.0 * high[0] - high[1], rel=1e-9)
    assert store.length[k] == pytest.approx(2.0 * high[0] - 2.0 * high[1] + 10.0, rel=1e-9)
    assert [float(tangent(store, k, s)[0]) for s in (0.5 * first, 0.5 * (first + second), second + 0.1)] == [
        1,
        -1,
        1,
    ]


def test_a_chain_of_bezier_curves_is_the_bernstein_sum() -> None:
    control = np.array([[0.0, 0], [5, 9], [14, 9], [16, 1], [18, -7], [25, -8], [31, 2.5]])
    store = sp.make_splines(2)
    k = make.add_bezier(store, control, all_axes(2))
    x = np.array([0.0, 0, 0, 0, 1, 1, 1, 2, 2, 2, 2])
    peer = BSpline(x, control, 3)
    for s in along(store, k):
        piece, u = sp.spline_parameter(store, k, s)
        np.testing.assert_allclose(point(store, k, s), peer(piece + u), atol=1e-13)
    check_derivatives(
        store,
        k,
        lambda x: np.asarray(peer(x, 1)),
        lambda x: np.asarray(peer(x, 2)),
        np.array([0.0, 1.0, 2.0]),
    )


RANDOM = np.random.default_rng(20240607)
NURBS_CASES = [
    pytest.param(2, np.array([0.0, 0, 0, 1, 1, 3, 4, 4, 4]), id="quadratic"),
    pytest.param(3, np.array([0.0, 0, 0, 0, 1.5, 2, 3, 3, 3, 3]), id="cubic"),
    pytest.param(3, np.array([0.0, 0, 0, 0, 2, 2, 3, 3, 3, 3]), id="double inner knot"),
    pytest.param(3, np.array([0.0, 1, 2, 3, 4, 5, 7, 8, 9, 9.5]), id="open knots"),
]


@pytest.mark.parametrize(("degree", "knots"), NURBS_CASES)
@pytest.mark.parametrize("weighted", [False, True])
def test_a_nurbs_curve_is_the_projection_of_scipys_homogeneous_spline(
    degree: int, knots: Floats, weighted: bool
) -> None:
    control = RANDOM.uniform(-50.0, 50.0, (6, 3)) + np.array([900.0, 0.0, -400.0])
    weights = RANDOM.uniform(0.3, 3.0, 6) if weighted else np.full(6, 0.7)
    homogeneous = BSpline(knots, np.column_stack([control * weights[:, None], weights]), degree)

    def derivatives(x: float) -> tuple[Floats, Floats, Floats]:
        h, dh, ddh = homogeneous(x), homogeneous(x, 1), homogeneous(x, 2)
        p = h[:3] / h[3]
        v = (dh[:3] - p * dh[3]) / h[3]
        return p, v, (ddh[:3] - 2.0 * v * dh[3] - p * ddh[3]) / h[3]

    store = sp.make_splines(3)
    k = make.add_nurbs(store, degree, control, weights, knots, all_axes(3))
    assert k == 0
    inner = np.unique(knots[degree:-degree])
    for s in along(store, k):
        piece, u = sp.spline_parameter(store, k, s)
        x = inner[piece] + u * (inner[piece + 1] - inner[piece])
        np.testing.assert_allclose(point(store, k, s), derivatives(x)[0], atol=1e-11, rtol=0.0)
    check_derivatives(store, k, lambda x: derivatives(x)[1], lambda x: derivatives(x)[2], inner)
    if knots[0] == knots[degree]:
        assert point(store, k, 0.0).tobytes() == control[0].tobytes()
        assert point(store, k, store.length[k]).tobytes() == control[-1].tobytes()
    else:
        np.testing.assert_allclose(point(store, k, 0.0), derivatives(knots[degree])[0], atol=1e-12)
        np.testing.assert_allclose(point(store, k, store.length[k]), derivatives(knots[6])[0], atol=1e-12)


def test_equal_weights_are_no_weights() -> None:
    store = sp.make_splines(3)
    knots = np.array([0.0, 0, 0, 0, 0.3, 0.6, 0.7, 1, 1, 1, 1])
    plain = make.add_nurbs(store, 3, POINTS, np.ones(7), knots, all_axes(3))
    heavy = make.add_nurbs(store, 3, POINTS, np.full(7, 0.37), knots, all_axes(3))
    assert np.all(store.weight == 0.0)
    assert store.length[plain] == store.length[heavy]
    for s in along(store, plain):
        assert point(store, plain, s).tobytes() == point(store, heavy, s).tobytes()


def test_a_full_circle_is_round_and_runs_evenly() -> None:
    store = sp.make_splines(3)
    k = make.add_nurbs(store, 2, CIRCLE, CIRCLE_WEIGHTS, CIRCLE_KNOTS, all_axes(3))
    assert store.length[k] == pytest.approx(20.0 * math.pi, rel=1e-13)
    for s in np.linspace(0.0, store.length[k], 1001):
        p, t, c = point(store, k, s), tangent(store, k, s), read(sp.spline_curvature_vector, store, k, s)
        x, y = math.cos(s / 10.0), math.sin(s / 10.0)
        assert abs(math.hypot(p[0], p[1]) - 10.0) <= 1e-12
        np.testing.assert_allclose(p, [10.0 * x, 10.0 * y, 0.0], atol=1e-9)
        np.testing.assert_allclose(t, [-y, x, 0.0], atol=1e-9)
        np.testing.assert_allclose(c, [-0.1 * x, -0.1 * y, 0.0], atol=1e-9)
    assert point(store, k, 0.0).tobytes() == point(store, k, store.length[k]).tobytes() == CIRCLE[0].tobytes()
    assert sp.spline_next_corner(store, k, 0.0) == store.length[k]


def test_both_ends_are_exact_and_nothing_lies_beyond() -> None:
    points = np.array([[0.1, 1 / 3], [1e5 + 0.7, 2 / 3], [math.pi, math.e]])
    store = sp.make_splines(2)
    k = make.add_cubic(
        store, np.array([0.0, 1.0, 2.0]), points, make.CUBIC_NATURAL, np.zeros((2, 2)), all_axes(2)
    )
    for s in (-1.0, -0.0, 0.0):
        assert point(store, k, s).tobytes() == points[0].tobytes()
    for s in (store.length[k], store.length[k] + 1e-9, math.inf):
        assert point(store, k, s).tobytes() == points[2].tobytes()
    np.testing.assert_allclose(point(store, k, 1e-9), points[0], atol=2e-9)
    np.testing.assert_allclose(point(store, k, store.length[k] - 1e-9), points[2], atol=2e-9)


def test_the_speed_is_even_to_a_millionth() -> None:
    store = sp.make_splines(3)
    k = make.add_cubic(store, KNOTS, POINTS, make.CUBIC_NATURAL, NO_SLOPES, all_axes(3))
    step = 1e-3
    for s in along(store, k, 500):
        # A central difference of fourth order: its own error is far below the ripple looked for.
        p = [point(store, k, s + j * step) for j in (-2, -1, 1, 2)]
        speed = float(np.linalg.norm((p[0] - 8.0 * p[1] + 8.0 * p[2] - p[3]) / (12.0 * step)))
        assert abs(speed - 1.0) < 1e-6


@pytest.mark.parametrize("kind", ["cubic", "nurbs"])
def test_bounds_hold_and_are_tight(kind: str) -> None:
    store = sp.make_splines(3)
    if kind == "cubic":
        k = make.add_cubic(store, KNOTS, POINTS, make.CUBIC_NATURAL, NO_SLOPES, all_axes(3))
    else:
        knots = np.array([0.0, 0, 0, 0, 1, 2, 3, 4, 4, 4, 4])
        k = make.add_nurbs(store, 3, POINTS, np.array([1, 0.2, 5, 1, 3, 0.5, 1]), knots, all_axes(3))
    places = np.linspace(0.0, store.length[k], 20001)
    tangents = np.abs([tangent(store, k, s) for s in places])
    bends = np.abs([read(sp.spline_curvature_vector, store, k, s) for s in places])
    for found, given in (
        (tangents.max(axis=0), bound(sp.spline_tangent_bound, store, k)),
        (bends.max(axis=0), bound(sp.spline_curvature_bound, store, k)),
    ):
        assert np.all(found <= given)
        assert np.all(given <= found * (cut.BOUND_MARGIN + 1e-3))
    low, high = 0.3 * store.length[k], 0.4 * store.length[k]
    local_tangent, local_bend = np.zeros(3), np.zeros(3)
    sp.spline_bounds_between(store, k, low, high, local_tangent, local_bend)
    inside = (places >= low) & (places <= high)
    assert np.all(tangents[inside].max(axis=0) <= local_tangent)
    assert np.all(bends[inside].max(axis=0) <= local_bend)
    assert np.all(local_bend <= bound(sp.spline_curvature_bound, store, k))
    assert np.any(local_bend < 0.9 * bound(sp.spline_curvature_bound, store, k))
    sp.spline_bounds_between(store, k, 0.0, store.length[k], local_tangent, local_bend)
    assert np.array_equal(local_tangent, bound(sp.spline_tangent_bound, store, k))
    assert np.array_equal(local_bend, bound(sp.spline_curvature_bound, store, k))


def test_axes_outside_the_path_length_ride_along() -> None:
    """X and Y on a quarter circle of 90 degrees; A turns with them and changes neither length nor speed."""
    control = np.array([[10.0, 0, 0], [10, 10, 45], [0, 10, 90]])
    weights, knots = np.array([1.0, HALF, 1.0]), np.array([0.0, 0, 0, 1, 1, 1])
    store = sp.make_splines(3)
    k = make.add_nurbs(store, 2, control, weights, knots, np.array([1, 1, 0], np.uint8))
    assert store.length[k] == pytest.approx(5.0 * math.pi, rel=1e-13)
    total = 0.0
    edges = np.linspace(0.0, store.length[k], 401)
    for s in 0.5 * (edges[:-1] + edges[1:]):
        t = tangent(store, k, s)
        assert math.hypot(t[0], t[1]) == pytest.approx(1.0, abs=1e-13)
        total += t[2] * (edges[1] - edges[0])
    assert total == pytest.approx(90.0, abs=1e-3)
    middle = 0.5 * store.length[k]
    assert point(store, k, middle)[2] == pytest.approx(45.0, abs=1e-7)
    numeric = (point(store, k, middle + 1e-4) - point(store, k, middle - 1e-4)) / 2e-4
    np.testing.assert_allclose(tangent(store, k, middle), numeric, atol=1e-6)


@pytest.mark.parametrize("weights", [np.ones(5), np.array([1.0, 4.0, 0.5, 3.0, 9.0])])
def test_corners_of_a_polygon_are_found_and_have_two_directions(weights: Floats) -> None:
    """Weights move the parameter of a straight piece, not its points."""
    square = np.array([[0.0, 0], [10, 0], [10, 20], [0, 20], [0, 0]])
    store = sp.make_splines(2)
    k = make.add_nurbs(store, 1, square, weights, np.array([0.0, 0, 1, 2, 3, 4, 4]), all_axes(2))
    corners, s = [], 0.0
    while s < store.length[k]:
        s = sp.spline_next_corner(store, k, s)
        corners.append(s)
    np.testing.assert_allclose(corners, [10.0, 30.0, 40.0, 60.0], rtol=1e-15)
    np.testing.assert_allclose(read(sp.spline_tangent_before, store, k, corners[0]), [1.0, 0.0], atol=1e-15)
    np.testing.assert_allclose(tangent(store, k, corners[0]), [0.0, 1.0], atol=1e-15)
    np.testing.assert_allclose(tangent(store, k, store.length[k]), [0.0, -1.0], atol=1e-15)
    for s in along(store, k):
        expected = np.array([np.interp(s, [0, 10, 30, 40, 60], square[:, i]) for i in range(2)])
        np.testing.assert_allclose(point(store, k, s), expected, atol=1e-12)


def test_a_cusp_inside_a_piece_is_a_corner() -> None:
    """The curve turns back on itself at u = 1/2: it comes from below and leaves downwards."""
    store = sp.make_splines(2)
    k = make.add_bezier(store, np.array([[0.0, 0], [10, 10], [0, 10], [10, 0]]), all_axes(2))
    cusp = sp.spline_next_corner(store, k, 0.0)
    assert cusp == pytest.approx(0.5 * store.length[k], rel=1e-9)
    np.testing.assert_allclose(point(store, k, cusp), [5.0, 7.5], atol=1e-9)
    np.testing.assert_allclose(read(sp.spline_tangent_before, store, k, cusp), [0.0, 1.0], atol=1e-4)
    np.testing.assert_allclose(tangent(store, k, cusp), [0.0, -1.0], atol=1e-4)
    assert sp.spline_next_corner(store, k, cusp) == store.length[k]


def bad_inputs() -> list[object]:
    axes = all_axes(3)
    ramp = np.arange(7.0)
    clamped = np.array([0.0, 0, 0, 0, 1, 2, 3, 4, 4, 4, 4])

    def changed(values: Floats, place: int | tuple[int, int], value: float) -> Floats:
        copy = values.copy()
        copy[place] = value
        return copy

    def cubic(
        code: int, name: str, knots: Floats = ramp, points: Floats = POINTS, ends: int = 0, mask: Mask = axes
    ) -> object:
        return pytest.param(lambda s: make.add_cubic(s, knots, points, ends, NO_SLOPES, mask), code, id=name)

    def nurbs(
        code: int,
        name: str,
        degree: int = 3,
        points: Floats = POINTS,
        weights: Floats = np.ones(7),  # noqa: B008
        knots: Floats = clamped,
    ) -> object:
        return pytest.param(lambda s: make.add_nurbs(s, degree, points, weights, knots, axes), code, id=name)

    def bezier(code: int, name: str, control: Floats, mask: Mask = axes) -> object:
        return pytest.param(lambda s: make.add_bezier(s, control, mask), code, id=name)

    still = np.ones((7, 3)) * 4.25
    riding = np.zeros((4, 3))
    riding[:, 2] = [0.0, 1.0, 2.0, 3.0]
    return [
        cubic(cut.SPLINE_TOO_FEW_POINTS, "one point", ramp[:1], POINTS[:1]),
        cubic(cut.SPLINE_TOO_FEW_POINTS, "closed with two points", ramp[:2], POINTS[:2], make.CUBIC_PERIODIC),
        cubic(cut.SPLINE_BAD_SHAPE, "knots missing", ramp[:6]),
        cubic(cut.SPLINE_BAD_SHAPE, "axes missing", ramp, POINTS[:, :2].copy()),
        cubic(cut.SPLINE_BAD_SHAPE, "mask too short", mask=all_axes(2)),
        cubic(cut.SPLINE_BAD_KNOTS, "equal knots", changed(ramp, 3, 2.0)),
        cubic(cut.SPLINE_BAD_KNOTS, "decreasing knots", changed(ramp, 3, 1.5)),
        cubic(cut.SPLINE_BAD_NUMBER, "knot nan", changed(ramp, 3, math.nan)),
        cubic(cut.SPLINE_BAD_NUMBER, "point infinite", points=changed(POINTS, (2, 1), math.inf)),
        cubic(cut.SPLINE_BAD_ENDS, "unknown ends", ends=3),
        cubic(
            cut.SPLINE_BAD_ENDS,
            "not closed",
            points=changed(POINTS, (6, 0), 1e-9),
            ends=make.CUBIC_PERIODIC,
        ),
        cubic(cut.SPLINE_NO_LENGTH, "all points equal", points=still),
        cubic(
            cut.SPLINE_NO_LENGTH, "no axis counts and none moves", points=still, mask=np.zeros(3, np.uint8)
        ),
        cubic(cut.SPLINE_STALLED, "no axis counts", mask=np.zeros(3, np.uint8)),
        nurbs(cut.SPLINE_BAD_DEGREE, "degree 0", degree=0),
        nurbs(cut.SPLINE_BAD_DEGREE, "degree 4", degree=4),
        nurbs(cut.SPLINE_TOO_FEW_POINTS, "three points", points=POINTS[:3]),
        nurbs(cut.SPLINE_BAD_SHAPE, "knot count", knots=clamped[:-1]),
        nurbs(cut.SPLINE_BAD_SHAPE, "weight count", weights=np.ones(6)),
        nurbs(cut.SPLINE_BAD_WEIGHT, "zero weight", weights=changed(np.ones(7), 2, 0.0)),
        nurbs(cut.SPLINE_BAD_WEIGHT, "negative weight", weights=changed(np.ones(7), 2, -1.0)),
        nurbs(cut.SPLINE_BAD_WEIGHT, "nan weight", weights=changed(np.ones(7), 2, math.nan)),
        nurbs(cut.SPLINE_UNRESOLVED, "weights too far apart", weights=changed(np.ones(7), 2, 1e15)),
        nurbs(cut.SPLINE_BAD_KNOTS, "decreasing knots", knots=changed(clamped, 5, 0.5)),
        nurbs(cut.SPLINE_BAD_KNOTS, "torn", knots=np.array([0.0, 0, 0, 0, 2, 2, 2, 2, 4, 4, 4])),
        nurbs(cut.SPLINE_BAD_KNOTS, "no domain", knots=np.zeros(11)),
        nurbs(cut.SPLINE_BAD_NUMBER, "nan", points=changed(POINTS, (0, 0), math.nan)),
        nurbs(cut.SPLINE_NO_LENGTH, "all points equal", points=still),
        bezier(cut.SPLINE_TOO_FEW_POINTS, "three points", POINTS[:3]),
        bezier(cut.SPLINE_BAD_SHAPE, "five points", POINTS[:5]),
        bezier(cut.SPLINE_STALLED, "only the riding axis moves", riding, np.array([1, 1, 0], np.uint8)),
        bezier(cut.SPLINE_BAD_NUMBER, "nan", changed(POINTS, (3, 1), math.nan)),
        bezier(cut.SPLINE_BAD_SHAPE, "two axes", POINTS[:4, :2].copy()),
    ]


@pytest.mark.parametrize(("build", "code"), bad_inputs())
def test_bad_input_is_refused_and_leaves_no_trace(build: Callable[[sp.Splines], int], code: int) -> None:
    store = sp.make_splines(3, splines=4, pieces=16, spans=1024)
    assert make.add_bezier(store, POINTS[:4], all_axes(3)) == 0
    counts, before = store.counts.copy(), point(store, 0, 5.0).tobytes()
    assert build(store) == code
    assert np.array_equal(store.counts, counts)
    assert point(store, 0, 5.0).tobytes() == before
    assert make.add_bezier(store, POINTS[:4], all_axes(3)) == 1
    assert point(store, 1, 5.0).tobytes() == before


@pytest.mark.parametrize(("splines", "pieces", "spans"), [(1, 99, 9999), (9, 3, 9999), (9, 99, 20)])
def test_a_full_store_refuses_and_keeps_what_it_has(splines: int, pieces: int, spans: int) -> None:
    store = sp.make_splines(3, splines, pieces, spans)
    assert make.add_bezier(store, POINTS[:4], all_axes(3)) == 0
    counts, before = store.counts.copy(), point(store, 0, 5.0).tobytes()
    codes = [make.add_bezier(store, POINTS, all_axes(3)) for _ in range(9)]
    assert codes[-1] == cut.SPLINE_STORE_FULL
    assert store.counts[1] >= counts[1]
    assert point(store, 0, 5.0).tobytes() == before


def test_the_store_is_a_ring() -> None:
    """Curves of different sizes pass through a small store; each must equal itself in a store of its own."""
    store = sp.make_splines(3, splines=3, pieces=13, spans=600)
    rng = np.random.default_rng(3)
    for turn in range(40):
        points = rng.uniform(-10.0, 10.0, (int(rng.integers(2, 6)), 3))
        knots = np.arange(float(points.shape[0]))
        while (k := make.add_cubic(store, knots, points, make.CUBIC_NATURAL, NO_SLOPES, all_axes(3))) < 0:
            assert k == cut.SPLINE_STORE_FULL
            assert sp.splines_release(store) >= 0
        assert k == turn % 3
        alone = sp.make_splines(3)
        assert make.add_cubic(alone, knots, points, make.CUBIC_NATURAL, NO_SLOPES, all_axes(3)) == 0
        assert alone.length[0] == store.length[k]
        assert np.array_equal(
            bound(sp.spline_curvature_bound, alone, 0), bound(sp.spline_curvature_bound, store, k)
        )
        for s in along(store, k, 20):
            assert sp.spline_parameter(alone, 0, s) == sp.spline_parameter(store, k, s)
            assert point(alone, 0, s).tobytes() == point(store, k, s).tobytes()
        tangents, bends = np.zeros((2, 3)), np.zeros((2, 3))
        sp.spline_bounds_between(alone, 0, 1.0, 0.9 * alone.length[0], tangents[0], bends[0])
        sp.spline_bounds_between(store, k, 1.0, 0.9 * alone.length[0], tangents[1], bends[1])
        assert np.array_equal(tangents[0], tangents[1])
        assert np.array_equal(bends[0], bends[1])
    while sp.splines_release(store) >= 0:
        pass
    assert np.array_equal(store.counts[1::2], [0, 0, 0])
    make.add_bezier(store, POINTS[:4], all_axes(3))
    sp.splines_clear(store)
    assert not store.counts.any()


def test_pieces_without_extent_are_left_out() -> None:
    """A corner made of three equal control points in a row; the spline has two curves and one corner."""
    control = np.array([[0.0, 0], [1, 0], [2, 0], [3, 0], [3, 0], [3, 0], [3, 0], [3, 2], [3, 4], [3, 6]])
    store = sp.make_splines(2)
    k = make.add_bezier(store, control, all_axes(2))
    assert store.length[k] == pytest.approx(9.0, rel=1e-14)
    assert store.rows[k, 1] == 2
    assert sp.spline_next_corner(store, k, 0.0) == pytest.approx(3.0, rel=1e-14)
    np.testing.assert_allclose(point(store, k, 4.0), [3.0, 1.0], atol=1e-13)


BITS_PROGRAM = """
import numpy as np
from polycnc.kernel import _circle3d as c3, _spline as sp, _spline_build as make
store, axes, out = sp.make_splines(3), np.ones(3, np.uint8), np.zeros(3)
points = np.array([[0.0, 0, 5], [10, 4, 5], [14, 12, 3], [9, 20, 1], [-3, 21, 0], [-8, 14, 2.5], [0, 0, 5]])
make.add_cubic(store, np.arange(7.0) ** 1.1, points, make.CUBIC_PERIODIC, np.zeros((2, 3)), axes)
make.add_nurbs(store, 3, points, np.array([1, 0.2, 5, 1, 3, 0.5, 1]),
             np.array([0.0, 0, 0, 0, 1, 2, 3, 4, 4, 4, 4]), axes)
make.add_bezier(store, np.array([[0.0, 0, 0], [0, 0, 0], [30, 40, 0], [31, 40, 7]]), axes)
geo = np.zeros(12)
c3.circle3d_setup(points[1], points[2], points[3], -300.0, geo)
result = [geo.tobytes().hex(), store.vectors.tobytes().hex(), store.span.tobytes().hex()]
for j in range(9):
    for k in range(3):
        for read in (sp.spline_point, sp.spline_tangent, sp.spline_curvature_vector):
            read(store, k, store.length[k] * j / 8.0, out)
            result.append(out.tobytes().hex())
    for read in (c3.circle3d_point, c3.circle3d_tangent, c3.circle3d_curvature_vector):
        read(geo, j / 8.0, out)
        result.append(out.tobytes().hex())
print("\\n".join(result))
"""


def test_compiled_and_plain_python_agree_bit_by_bit() -> None:
    outputs = []
    for disable in ("0", "1"):
        environment = {**os.environ, "NUMBA_DISABLE_JIT": disable, "POLYCNC_OPEN_INTERNALS": "1"}
        run = subprocess.run(
            [sys.executable, "-c", BITS_PROGRAM], env=environment, capture_output=True, text=True, check=True
        )
        outputs.append(run.stdout)
    assert len(outputs[0]) > 10_000
    assert outputs[0] == outputs[1]
