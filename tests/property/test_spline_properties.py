"""What every spline must hold, whatever its control points are."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import TypeAlias

import numpy as np
import numpy.typing as npt
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.interpolate import BSpline, CubicSpline

from polycnc.kernel import _spline as sp
from polycnc.kernel import _spline_build as make
from polycnc.kernel import _spline_pieces as cut

Floats = npt.NDArray[np.float64]
Mask = npt.NDArray[np.uint8]
Drawn: TypeAlias = tuple[int, Floats, Floats, Floats, Mask]
Curve: TypeAlias = Callable[[Floats, int], Floats]
SETTINGS = settings(deadline=None, max_examples=60)

coordinates = st.integers(-100_000, 100_000).map(lambda x: x / 1000.0)


@st.composite
def nurbs(draw: st.DrawFn) -> Drawn:
    """Draw degree, control points, weights, knots (inner ones up to full multiplicity) and path axes."""
    n = draw(st.integers(2, 4))
    degree = draw(st.integers(1, 3))
    m = degree + 1 + draw(st.integers(0, 5))
    control = np.array(draw(st.lists(st.tuples(*[coordinates] * n), min_size=m, max_size=m)))
    weights = np.ones(m)
    if draw(st.booleans()):
        weights = np.array(draw(st.lists(st.integers(1, 20), min_size=m, max_size=m)), np.float64) / 4.0
    gaps = draw(st.lists(st.integers(0, 4), min_size=m - degree - 1, max_size=m - degree - 1))
    inner = np.cumsum(np.array(gaps, np.float64))
    if inner.size:
        inner += 1.0
    last = (inner[-1] if inner.size else 0.0) + 1.0
    knots = np.concatenate([np.zeros(degree + 1), inner, np.full(degree + 1, last)])
    assume(all(knots[i] < knots[i + degree] for i in range(1, m)))
    path_axes = np.ones(n, np.uint8)
    path_axes[2:] = draw(st.integers(0, 1))
    return degree, control, weights, knots, path_axes


def built(
    drawn: Drawn,
) -> tuple[sp.Splines, Curve, Floats]:
    """Return the store with the curve as spline 0, an independent curve p(x, order), and its knots."""
    degree, control, weights, knots, path_axes = drawn
    store = sp.make_splines(control.shape[1], 1, 16, 16384)
    k = make.add_nurbs(store, degree, control, weights, knots, path_axes)
    assume(k not in (cut.SPLINE_NO_LENGTH, cut.SPLINE_STALLED))
    assert k == 0
    inner = np.unique(knots)
    assume(store.rows[0, 1] == inner.size - 1)  # pieces left out would have to be left out of the peer too
    origin = control[0]  # the peer counts from here, or its own rounding would be what is seen
    homogeneous = BSpline(knots, np.column_stack([(control - origin) * weights[:, None], weights]), degree)

    def curve(x: Floats, order: int) -> Floats:
        h = homogeneous(x)
        p = h[:, :-1] / h[:, -1:]
        if order == 0:
            return np.asarray(p + origin)
        dh = homogeneous(x, 1)
        return np.asarray((dh[:, :-1] - p * dh[:, -1:]) / h[:, -1:])

    return store, curve, inner


def is_straight(store: sp.Splines, piece: int) -> bool:
    c = np.abs(store.polynomial[piece])
    return bool(c[2:].max() <= 1e-15 * c[1].max() and not store.weight[piece].any())


def places(store: sp.Splines, count: int) -> Floats:
    return np.asarray(store.length[0] * (np.arange(count) + 0.382) / count)


NODES, NODE_WEIGHTS = np.polynomial.legendre.leggauss(12)


def arc(curve: Curve, counting: npt.NDArray[np.bool_], low: float, high: float, tolerance: float) -> float:
    """Return the path length within one piece by bisection until 12 Gauss points do not care.

    Before that, the piece is cut where the speed is least: a cusp between two Gauss points would not be seen.
    """

    def speeds(x: Floats) -> Floats:
        return np.asarray(np.linalg.norm(curve(x, 1)[:, counting], axis=1))

    def gauss(a: float, b: float) -> float:
        return 0.5 * (b - a) * float(NODE_WEIGHTS @ speeds(0.5 * (a + b) + 0.5 * (b - a) * NODES))

    cuts = [low, high]
    grid = np.linspace(low, high, 201)
    at_grid = speeds(grid)
    for j in np.flatnonzero((at_grid[1:-1] <= at_grid[:-2]) & (at_grid[1:-1] <= at_grid[2:])):
        a, b = grid[j], grid[j + 2]
        for _ in range(30):
            x = np.linspace(a, b, 5)
            best = int(np.argmin(speeds(x)))
            a, b = x[max(best - 1, 0)], x[min(best + 1, 4)]
        cuts.append(float(0.5 * (a + b)))
    todo = [(a, b, gauss(a, b)) for a, b in pairwise(sorted(cuts))]
    total = 0.0
    while todo:
        a, b, whole = todo.pop()
        middle = 0.5 * (a + b)
        left, right = gauss(a, middle), gauss(middle, b)
        if abs(left + right - whole) <= tolerance or b - a < 1e-7 * (high - low):
            total += left + right
        else:
            todo += [(a, middle, left), (middle, b, right)]
    return total


@given(nurbs())
@SETTINGS
def test_points_are_on_the_curve_and_at_their_path_length(drawn: Drawn) -> None:
    store, curve, inner = built(drawn)
    counting = drawn[4] == 1
    length = store.length[0]
    out = np.zeros(drawn[1].shape[1])
    lengths = [arc(curve, counting, float(a), float(b), 1e-12 * length) for a, b in pairwise(inner)]
    starts = np.concatenate([[0.0], np.cumsum(lengths)])
    assert abs(starts[-1] - length) <= 1e-10 * length
    for s in places(store, 12):
        piece, u = sp.spline_parameter(store, 0, s)
        low, high = float(inner[piece]), float(inner[piece + 1])
        sp.spline_point(store, 0, s, out)
        if is_straight(store, piece):  # stored with a parameter of its own
            share = (s - starts[piece]) / lengths[piece]
            first, last = curve(np.array([low, high]), 0)
            np.testing.assert_allclose(out, (1.0 - share) * first + share * last, atol=1e-9 * length)
        else:
            x = low + u * (high - low)
            np.testing.assert_allclose(out, curve(np.array([x]), 0)[0], atol=1e-10)
            assert abs(starts[piece] + arc(curve, counting, low, x, 1e-12 * length) - s) <= 1e-9 * length


@given(nurbs())
@SETTINGS
def test_the_parameter_never_runs_back_and_the_tangent_has_length_one(
    drawn: Drawn,
) -> None:
    store, _, _ = built(drawn)
    counting = drawn[4] == 1
    n = drawn[1].shape[1]
    tangent, bend = np.zeros(n), np.zeros(n)
    tangent_bound, bend_bound = np.zeros(n), np.zeros(n)
    sp.spline_tangent_bound(store, 0, tangent_bound)
    sp.spline_curvature_bound(store, 0, bend_bound)
    rounding = 1e-4 / store.length[0]  # of a curvature, where the parameter hardly moves
    before = (0, 0.0)
    for s in np.linspace(0.0, store.length[0], 300):
        here = sp.spline_parameter(store, 0, s)
        assert here >= before
        before = here
        sp.spline_tangent(store, 0, s, tangent)
        sp.spline_curvature_vector(store, 0, s, bend)
        assert abs(np.linalg.norm(tangent[counting]) - 1.0) < 1e-12
        assert abs(float(tangent[counting] @ bend[counting])) <= 1e-9 * float(np.linalg.norm(bend)) + rounding
        assert np.all(np.abs(tangent) <= tangent_bound)
        assert np.all(np.abs(bend) <= bend_bound + rounding)


@given(nurbs())
@SETTINGS
def test_the_speed_is_even(drawn: Drawn) -> None:
    """Over steps of a 5000th of the path, as a control cycle takes them, within spans without a corner."""
    store, curve, inner = built(drawn)
    counting = drawn[4] == 1
    step = store.length[0] / 5000.0
    for s in places(store, 10):
        piece, low = sp.spline_parameter(store, 0, s)
        next_piece, high = sp.spline_parameter(store, 0, s + step)
        if next_piece != piece or is_straight(store, piece) or sp.spline_next_corner(store, 0, s) < s + step:
            continue
        start, width = float(inner[piece]), float(inner[piece + 1] - inner[piece])
        walked = arc(curve, counting, start + low * width, start + high * width, 1e-11 * step)
        assert abs(walked / step - 1.0) < 1e-6


@given(nurbs())
@SETTINGS
def test_the_path_is_no_shorter_than_the_chord_and_no_longer_than_the_polygon(
    drawn: Drawn,
) -> None:
    store, _, _ = built(drawn)
    control = drawn[1][:, drawn[4] == 1]
    length = store.length[0]
    assert length >= float(np.linalg.norm(control[-1] - control[0])) * (1.0 - 1e-12)
    polygon = float(np.sum(np.linalg.norm(np.diff(control, axis=0), axis=1)))
    assert length <= polygon * (1.0 + 1e-12)
    points = np.zeros((65, drawn[1].shape[1]))
    for j in range(65):
        sp.spline_point(store, 0, length * (j / 64.0), points[j])
    steps = np.linalg.norm(np.diff(points[:, drawn[4] == 1], axis=0), axis=1)
    assert np.all(steps <= length / 64.0 * (1.0 + 1e-7))
    assert points[0].tobytes() == drawn[1][0].tobytes()
    assert points[-1].tobytes() == drawn[1][-1].tobytes()


@given(st.lists(st.tuples(coordinates, coordinates), min_size=4, max_size=12), st.booleans())
@SETTINGS
def test_a_cubic_spline_passes_through_its_points(drawn: list[tuple[float, float]], closed: bool) -> None:
    points = np.array(drawn)
    if closed:
        points[-1] = points[0]
    chords = np.linalg.norm(np.diff(points, axis=0), axis=1)
    assume(chords.min() > 0.5)
    knots = np.concatenate([[0.0], np.cumsum(chords)])
    store = sp.make_splines(2)
    ends = make.CUBIC_PERIODIC if closed else make.CUBIC_NATURAL
    assert make.add_cubic(store, knots, points, ends, np.zeros((2, 2)), np.ones(2, np.uint8)) == 0
    length = float(store.length[0])
    out, after = np.zeros(2), np.zeros(2)
    # A point is where the parameter passes from one piece to the next: bisect for it.
    for piece in range(1, points.shape[0] - 1):
        low, high = 0.0, length
        for _ in range(60):
            middle = 0.5 * (low + high)
            if sp.spline_parameter(store, 0, middle)[0] < piece:
                low = middle
            else:
                high = middle
        sp.spline_point(store, 0, high, out)
        np.testing.assert_allclose(out, points[piece], atol=1e-9)
    peer = CubicSpline(knots, points, bc_type="periodic" if closed else "natural")
    if closed and np.linalg.norm(peer(0.0, 1)) > 1e-3:
        sp.spline_tangent_before(store, 0, length, out)
        sp.spline_tangent(store, 0, 0.0, after)
        np.testing.assert_allclose(out, after, atol=1e-9)
    expected = 0.0
    for low, high in pairwise(knots):
        expected += quad(lambda x: float(np.linalg.norm(peer(x, 1))), low, high, limit=200)[0]
    assert abs(expected - length) <= 1e-7 * length
