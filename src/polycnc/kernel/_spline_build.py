"""Make splines: cubics through points, Bezier chains, NURBS.

The builders return the number of the new spline or a negative `SPLINE_...` code; a refused one leaves the
store as it was.
"""

from __future__ import annotations

import numpy as np

from polycnc.kernel._jit import allocating, compiled, entry
from polycnc.kernel._spline import (
    Floats,
    Mask,
    Splines,
    Triple,
)
from polycnc.kernel._spline_pieces import (
    SPLINE_BAD_DEGREE,
    SPLINE_BAD_ENDS,
    SPLINE_BAD_KNOTS,
    SPLINE_BAD_NUMBER,
    SPLINE_BAD_SHAPE,
    SPLINE_BAD_WEIGHT,
    SPLINE_TOO_FEW_POINTS,
    add_pieces,
)

CUBIC_NATURAL = 0
CUBIC_CLAMPED = 1
CUBIC_PERIODIC = 2

_HUGE = 1e100


@compiled
def _all_usable(values: Floats) -> bool:
    usable = True
    for value in values.flat:
        usable = usable and bool(abs(value) <= _HUGE)
    return usable


@entry
def add_bezier(store: Splines, control: Floats, path_axes: Mask) -> int:
    """Add a chain of cubic Bezier curves, `control[3 q + 1, n]`, neighbours share a point; return its number.

    `path_axes[n]` is 1 for axes that count in the path length. A negative return is a `SPLINE_...` code.
    """
    rows, n = control.shape
    if rows < 4:
        return SPLINE_TOO_FEW_POINTS
    if rows % 3 != 1:
        return SPLINE_BAD_SHAPE
    if not _all_usable(control):
        return SPLINE_BAD_NUMBER
    pieces = np.zeros((rows // 3, 4, n))
    for piece in range(rows // 3):
        for i in range(n):
            pieces[piece, 0, i] = control[3 * piece, i]
            for j in range(1, 4):
                pieces[piece, j, i] = control[3 * piece + j, i] - control[3 * piece, i]
    return add_pieces(store, pieces, np.ones((rows // 3, 4)), control[0], control[rows - 1], path_axes)


@compiled
def _solve_tridiagonal(lower: Floats, diagonal: Floats, upper: Floats, unknown: Floats) -> None:
    """Solve in place: `unknown[m, q]` holds q right-hand sides and receives the solutions."""
    m = diagonal.shape[0]
    for i in range(1, m):
        factor = lower[i] / diagonal[i - 1]
        diagonal[i] -= factor * upper[i - 1]
        for j in range(unknown.shape[1]):
            unknown[i, j] -= factor * unknown[i - 1, j]
    for i in range(m - 1, -1, -1):
        for j in range(unknown.shape[1]):
            above = upper[i] * unknown[i + 1, j] if i < m - 1 else 0.0
            unknown[i, j] = (unknown[i, j] - above) / diagonal[i]


@allocating
def _open_slopes(knots: Floats, points: Floats, ends: int, end_slopes: Floats) -> Floats:
    """Return dp/du [m, n] at the points of a natural or clamped cubic spline."""
    m, n = points.shape
    lower, diagonal, upper, slopes = np.zeros(m), np.ones(m), np.zeros(m), np.zeros((m, n))
    for i in range(1, m - 1):
        lower[i], diagonal[i], upper[i] = _smooth_row(knots, points, i - 1, i, slopes[i])
    for j in range(n):
        slopes[0, j], slopes[m - 1, j] = end_slopes[0, j], end_slopes[1, j]
        if ends == CUBIC_NATURAL:
            slopes[0, j] = 3.0 * (points[1, j] - points[0, j]) / (knots[1] - knots[0])
            slopes[m - 1, j] = 3.0 * (points[m - 1, j] - points[m - 2, j]) / (knots[m - 1] - knots[m - 2])
    if ends == CUBIC_NATURAL:
        diagonal[0] = diagonal[m - 1] = 2.0
        upper[0] = lower[m - 1] = 1.0
    _solve_tridiagonal(lower, diagonal, upper, slopes)
    return slopes


@allocating
def _periodic_slopes(knots: Floats, points: Floats) -> Floats:
    """Return dp/du [m, n] at the points of a closed cubic spline.

    The system has two entries outside the three diagonals. They are taken out as a product of two vectors and
    put back after the solution (Sherman and Morrison); right-hand side n is the first of these vectors.
    """
    m, n = points.shape
    size = m - 1
    lower, diagonal, upper, slopes = np.zeros(size), np.zeros(size), np.zeros(size), np.zeros((m, n + 1))
    for i in range(size):
        back = i - 1 if i > 0 else m - 2
        lower[i], diagonal[i], upper[i] = _smooth_row(knots, points, back, i, slopes[i, :n])
    pivot = -diagonal[0]
    share = lower[0] / pivot
    slopes[0, n] += pivot
    slopes[size - 1, n] += upper[size - 1]
    diagonal[0] -= pivot
    diagonal[size - 1] -= upper[size - 1] * share
    _solve_tridiagonal(lower, diagonal, upper, slopes[:size])
    below = 1.0 + slopes[0, n] + share * slopes[size - 1, n]
    for j in range(n):
        factor = (slopes[0, j] + share * slopes[size - 1, j]) / below
        for i in range(size):
            slopes[i, j] -= factor * slopes[i, n]
        slopes[m - 1, j] = slopes[0, j]
    return slopes


@compiled
def _smooth_row(knots: Floats, points: Floats, back: int, i: int, right: Floats) -> Triple:
    """Return the row that makes the second derivative continuous at point i; write its right-hand side.

    `back` is the interval before the point: i - 1, or in a closed spline the last one.
    """
    before, after = knots[back + 1] - knots[back], knots[i + 1] - knots[i]
    for j in range(right.shape[0]):
        slope_before = (points[back + 1, j] - points[back, j]) / before
        slope_after = (points[i + 1, j] - points[i, j]) / after
        right[j] = 3.0 * (after * slope_before + before * slope_after)
    return after, 2.0 * (before + after), before


@entry
def add_cubic(
    store: Splines, knots: Floats, points: Floats, ends: int, end_slopes: Floats, path_axes: Mask
) -> int:
    """Add the cubic spline through `points[m, n]` at parameters `knots[m]`; return its number.

    `ends` is `CUBIC_NATURAL` (no bending at the ends), `CUBIC_CLAMPED` (dp/dknot at both ends in
    `end_slopes[2, n]`, otherwise unused) or `CUBIC_PERIODIC` (last point equal to the first).
    `path_axes[n]` is 1 for axes that count in the path length. A negative return is a `SPLINE_...` code.
    """
    m, n = points.shape
    if m < (3 if ends == CUBIC_PERIODIC else 2):
        return SPLINE_TOO_FEW_POINTS
    if knots.shape[0] != m or end_slopes.shape != (2, n):
        return SPLINE_BAD_SHAPE
    if ends < CUBIC_NATURAL or ends > CUBIC_PERIODIC:
        return SPLINE_BAD_ENDS
    if not (_all_usable(points) and _all_usable(end_slopes) and _all_usable(knots)):
        return SPLINE_BAD_NUMBER
    for i in range(m - 1):
        if not knots[i + 1] > knots[i]:
            return SPLINE_BAD_KNOTS
    for j in range(n):
        if ends == CUBIC_PERIODIC and points[0, j] != points[m - 1, j]:
            return SPLINE_BAD_ENDS
    if ends == CUBIC_PERIODIC:
        slopes = _periodic_slopes(knots, points)
    else:
        slopes = _open_slopes(knots, points, ends, end_slopes)
    pieces = np.zeros((m - 1, 4, n))
    for i in range(m - 1):
        third = (knots[i + 1] - knots[i]) / 3.0
        for j in range(n):
            pieces[i, 0, j] = points[i, j]
            pieces[i, 1, j] = third * slopes[i, j]
            pieces[i, 3, j] = points[i + 1, j] - points[i, j]
            pieces[i, 2, j] = pieces[i, 3, j] - third * slopes[i + 1, j]
    return add_pieces(store, pieces, np.ones((m - 1, 4)), points[0], points[m - 1], path_axes)


@compiled
def _nurbs_code(degree: int, control: Floats, weights: Floats, knots: Floats) -> int:
    """Return 0 or the code of what is wrong with a NURBS curve."""
    m = control.shape[0]
    if degree < 1 or degree > 3:
        return SPLINE_BAD_DEGREE
    if m <= degree:
        return SPLINE_TOO_FEW_POINTS
    if weights.shape[0] != m or knots.shape[0] != m + degree + 1:
        return SPLINE_BAD_SHAPE
    if not (_all_usable(control) and _all_usable(knots)):
        return SPLINE_BAD_NUMBER
    for i in range(m):
        if not 0.0 < weights[i] <= _HUGE:
            return SPLINE_BAD_WEIGHT
    for i in range(m + degree):
        if knots[i + 1] < knots[i] or (0 < i < m and knots[i + degree] == knots[i]):
            return SPLINE_BAD_KNOTS
    return 0 if knots[degree] < knots[m] else SPLINE_BAD_KNOTS


@compiled
def _bezier_of_interval(
    degree: int, control: Floats, weights: Floats, knots: Floats, interval: int, bezier: Floats, work: Floats
) -> None:
    """Write the Bezier points of knots[interval]..knots[interval + 1] to `bezier[degree + 1, n + 1]`.

    Point j is the de Boor scheme with the upper knot in j steps and the lower one in the others, which is
    what inserting both knots up to full multiplicity leaves. The last column is the weight, the others are
    weight times the way from the first control point of the interval: nothing is lost far from the origin.
    """
    n = control.shape[1]
    origin = interval - degree
    for j in range(degree + 1):
        for r in range(degree + 1):
            work[r, n] = weights[origin + r]
            for i in range(n):
                work[r, i] = weights[origin + r] * (control[origin + r, i] - control[origin, i])
        for step in range(1, degree + 1):
            x = knots[interval + 1] if step <= j else knots[interval]
            for r in range(degree, step - 1, -1):
                low, high = knots[origin + r], knots[interval + 1 + r - step]
                share = (x - low) / (high - low)
                for i in range(n + 1):
                    work[r, i] = work[r - 1, i] + share * (work[r, i] - work[r - 1, i])
        for i in range(n + 1):
            bezier[j, i] = work[degree, i]


@compiled
def _elevate(degree: int, bezier: Floats) -> None:
    """Turn homogeneous Bezier points of degree 1 or 2 into the four points of the same curve as a cubic."""
    for old in range(degree, 3):
        for j in range(old + 1, 0, -1):
            share = j / (old + 1.0)
            for i in range(bezier.shape[1]):
                bezier[j, i] = share * bezier[j - 1, i] + (1.0 - share) * bezier[j, i]


@entry
def add_nurbs(
    store: Splines, degree: int, control: Floats, weights: Floats, knots: Floats, path_axes: Mask
) -> int:
    """Add a NURBS curve of degree 1 to 3; return its number.

    `control[m, n]`, `weights[m]` and `knots[m + degree + 1]`: knots do not decrease, an inner knot comes at
    most `degree` times. Open (clamped) knot vectors start and end at the first and last control point, others
    where the curve does. `path_axes[n]` is 1 for axes that count in the path length. A negative return is a
    `SPLINE_...` code.
    """
    m, n = control.shape
    code = _nurbs_code(degree, control, weights, knots)
    if code < 0:
        return code
    scaled = weights / weights[0]
    bezier, work = np.zeros((4, n + 1)), np.zeros((4, n + 1))
    pieces, piece_weights = np.zeros((m - degree, 4, n)), np.ones((m - degree, 4))
    first, last = control[0].copy(), control[m - 1].copy()
    count = 0
    for interval in range(degree, m):
        if knots[interval] == knots[interval + 1]:
            continue
        _bezier_of_interval(degree, control, scaled, knots, interval, bezier, work)
        _elevate(degree, bezier)
        piece_weights[count] = bezier[:, n]
        for i in range(n):
            start = bezier[0, i] / bezier[0, n]
            pieces[count, 0, i] = control[interval - degree, i] + start
            for j in range(1, 4):
                pieces[count, j, i] = bezier[j, i] / bezier[j, n] - start
        count += 1
    for i in range(n):
        if knots[1] != knots[degree]:
            first[i] = pieces[0, 0, i]
        if knots[m] != knots[m + degree - 1]:
            last[i] = pieces[count - 1, 0, i] + pieces[count - 1, 3, i]
    return add_pieces(store, pieces[:count], piece_weights[:count], first, last, path_axes)
