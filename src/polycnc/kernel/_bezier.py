"""A piece of a cubic Bezier curve in two axes as one segment: the curve in u, and a polynomial that says u at a length.

A curve is cut into *spans*, short enough that u, as a polynomial of degree 8 in the path length s, travels along the
curve at unit speed. So nothing iterates in the control cycle, and the point is on the curve whatever u is. A span is
one row of numbers, for a curve that begins at the segment's start and ends, at u = 1, at its end:

    0..3    ways from the start to the two inner control points: first axis and second axis of each
    4..11   coefficients 1 to 8 of u(t), with t = 0..1 the part of the path length
    12..15  bounds of |dp/ds| of both axes, and of |d2p/ds2| of both

Where a curve stands still (a cusp, a control point on an end), no polynomial in s can follow it: what is left there,
too short to be seen, is straight.
"""

from __future__ import annotations

import math
from typing import Annotated, TypeAlias

import numpy as np
import numpy.typing as npt

from polycnc.kernel._jit import allocating, compiled, entry

Floats: TypeAlias = npt.NDArray[np.float64]
Table: TypeAlias = Annotated[Floats, 2]
Pair: TypeAlias = tuple[float, float]

BEZIER_SIZE = 16
TANGENT_BOUND, BEND_BOUND = 12, 14

# Columns of a span as `cut_bezier` writes it, after the row of a segment.
SPAN_END, SPAN_LENGTH, SPAN_CURVED = 16, 18, 19
SPAN_SIZE = 20
MOST_SPANS = 256

BOUND_MARGIN = 1.02  # bounds are sampled maxima times this
SHORTEST_MM = 1e-6  # a span that does not fit and is shorter than this is straight
SHORTEST_SHARE = 1e-11  # the same as a part of the curve

_FIRST_U = 4  # column of the first coefficient of u(t)
_NODES = (0.33998104358485626, 0.86113631159405258)
_NODE_WEIGHTS = (0.65214515486254614, 0.34785484513745386)
_U_ERROR = 2e-8  # largest error of u(t) at a tested point
_SPEED_RIPPLE = 1e-5
_QUADRATURE_ERROR = 1e-11  # between two step sizes; the finer one, which is used, is 256 times better
_DEEPEST = 40  # halvings
_STRAIGHT = 1e-14  # distance from a line, as a share of its length, that is rounding
_SAMPLES = 9


@compiled
def _velocity(b: Floats, u: float) -> Pair:
    """Return dp/du of the curve whose control points are `b[4, 2]`."""
    v = 1.0 - u
    first, middle, last = 3.0 * v * v, 6.0 * u * v, 3.0 * u * u
    return (
        first * (b[1, 0] - b[0, 0]) + middle * (b[2, 0] - b[1, 0]) + last * (b[3, 0] - b[2, 0]),
        first * (b[1, 1] - b[0, 1]) + middle * (b[2, 1] - b[1, 1]) + last * (b[3, 1] - b[2, 1]),
    )


@compiled
def _acceleration(b: Floats, u: float, i: int) -> float:
    first, last = b[2, i] - 2.0 * b[1, i] + b[0, i], b[3, i] - 2.0 * b[2, i] + b[1, i]
    return float(6.0 * ((1.0 - u) * first + u * last))


@compiled
def _speed(b: Floats, u: float) -> float:
    p, q = _velocity(b, u)
    return math.sqrt(p * p + q * q)


@compiled
def _arc_length(b: Floats, low: float, high: float) -> float:
    """Return the path length from u = low to u = high by Gauss-Legendre quadrature with four points."""
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    total = 0.0
    for j in range(2):
        for side in range(-1, 2, 2):
            total += _NODE_WEIGHTS[j] * _speed(b, middle + side * half * _NODES[j])
    return half * total


@compiled
def _u_at(row: Floats, t: float) -> Pair:
    """Return u and du/dt at a part t = 0..1 of the path length."""
    u, slope = 0.0, 0.0
    for j in range(_FIRST_U + 7, _FIRST_U - 1, -1):
        slope = slope * t + u
        u = u * t + row[j]
    return u * t, slope * t + u


@compiled
def bezier_point(row: Floats, way_p: float, way_q: float, t: float) -> Pair:
    """Return the way from the start at a part `t` of the path length; (way_p, way_q) is the one to the end."""
    u = _u_at(row, t)[0]
    p1, q1, p2, q2 = row[0], row[1], row[2], row[3]
    p = (((way_p + 3.0 * (p1 - p2)) * u + 3.0 * (p2 - 2.0 * p1)) * u + 3.0 * p1) * u
    q = (((way_q + 3.0 * (q1 - q2)) * u + 3.0 * (q2 - 2.0 * q1)) * u + 3.0 * q1) * u
    return p, q


@compiled
def bezier_tangent(row: Floats, way_p: float, way_q: float, at: float) -> Pair:
    """Return dp/ds, of length 1, at the start (`at` 0) or the end (1)."""
    p, q = row[0], row[1]
    if at > 0.0:
        p, q = way_p - row[2], way_q - row[3]
    size = math.sqrt(p * p + q * q)
    return p / size, q / size


@allocating
def _fit(b: Floats, row: Floats) -> tuple[float, bool]:
    """Write u(t) of the curve `b[4, 2]` to the row; return its path length and whether u(t) is accurate enough.

    The polynomial meets u and two derivatives at both ends (degree 5) and u at three places between (degree 8), and is
    tested in the four gaps.
    """
    along = np.zeros(9)  # path length at u = j / 8
    coarse = 0.0
    for j in range(8):
        along[j + 1] = along[j] + _arc_length(b, 0.125 * j, 0.125 * (j + 1))
    for j in range(0, 8, 2):
        coarse += _arc_length(b, 0.125 * j, 0.125 * (j + 2))
    length = along[8]
    speed0, speed1 = _speed(b, 0.0), _speed(b, 1.0)
    least = 1e-6 * length
    if not (abs(coarse - length) <= _QUADRATURE_ERROR * length and speed0 > least and speed1 > least):
        return length, False
    a0, a1 = length / speed0, length / speed1
    bend0, bend1 = _parameter_bend(b, 0.0, a0), _parameter_bend(b, 1.0, a1)
    row[4], row[5] = a0, 0.5 * bend0
    row[6] = 10.0 - 6.0 * a0 - 4.0 * a1 - 1.5 * bend0 + 0.5 * bend1
    row[7] = -15.0 + 8.0 * a0 + 7.0 * a1 + 1.5 * bend0 - bend1
    row[8] = 6.0 - 3.0 * (a0 + a1) - 0.5 * (bend0 - bend1)
    row[9], row[10], row[11] = 0.0, 0.0, 0.0
    for j in range(2, 8, 2):
        _pass_through(row, along, j)
    for j in range(1, 9, 2):
        u, slope = _u_at(row, along[j] / length)
        ripple = abs(slope * _speed(b, 0.125 * j) / length - 1.0)
        if not (abs(u - 0.125 * j) <= _U_ERROR and ripple <= _SPEED_RIPPLE):
            return length, False
    return length, True


@compiled
def _parameter_bend(b: Floats, u: float, slope: float) -> float:
    """Return d2u/dt2 where du/dt is `slope`, at unit speed."""
    p, q = _velocity(b, u)
    along = p * _acceleration(b, u, 0) + q * _acceleration(b, u, 1)
    return -along / (p * p + q * q) * slope * slope


@allocating
def _pass_through(row: Floats, along: Floats, j: int) -> None:
    """Add to u(t) the multiple of t3 (1 - t)3 (t - t2) (t - t4) that makes it meet u = j / 8, j = 2, 4, 6.

    The product vanishes with two derivatives at the ends, and at the places met before.
    """
    factor = np.zeros(9)
    factor[3], factor[4], factor[5], factor[6] = 1.0, -3.0, 3.0, -1.0
    t = along[j] / along[8]
    value = t * t * t * (1.0 - t) * (1.0 - t) * (1.0 - t)
    for before in range(2, j, 2):
        root = along[before] / along[8]
        value *= t - root
        for i in range(8, 0, -1):
            factor[i] = factor[i - 1] - root * factor[i]
    if value != 0.0:
        share = (0.125 * j - _u_at(row, t)[0]) / value
        for i in range(3, 9):
            row[_FIRST_U + i - 1] += share * factor[i]


@compiled
def _set_bounds(b: Floats, row: Floats) -> None:
    """Sample |dp/ds| and |d2p/ds2| over the span and keep the largest, with a margin."""
    for j in range(TANGENT_BOUND, BEZIER_SIZE):
        row[j] = 0.0
    for sample in range(_SAMPLES):
        u = _u_at(row, sample / (_SAMPLES - 1.0))[0]
        p, q = _velocity(b, u)
        square = p * p + q * q
        size = math.sqrt(square)
        acceleration_p, acceleration_q = _acceleration(b, u, 0), _acceleration(b, u, 1)
        across = (p * acceleration_q - q * acceleration_p) / (square * square)
        row[TANGENT_BOUND] = max(row[TANGENT_BOUND], BOUND_MARGIN * abs(p) / size)
        row[TANGENT_BOUND + 1] = max(row[TANGENT_BOUND + 1], BOUND_MARGIN * abs(q) / size)
        row[BEND_BOUND] = max(row[BEND_BOUND], BOUND_MARGIN * abs(q * across))
        row[BEND_BOUND + 1] = max(row[BEND_BOUND + 1], BOUND_MARGIN * abs(p * across))


@compiled
def _cut_straight(control: Floats, spans: Floats) -> int:
    """Cut a curve whose control points lie on one line into lines, where it turns back; return how many, 0 if none do.

    How its parameter goes along them does not matter.
    """
    far = 3
    for j in range(1, 4):
        if abs(control[j, 0]) + abs(control[j, 1]) > abs(control[far, 0]) + abs(control[far, 1]):
            far = j
    p, q = control[far, 0], control[far, 1]
    size = math.sqrt(p * p + q * q)
    p, q = p / size, q / size
    for j in range(1, 4):
        if not abs(p * control[j, 1] - q * control[j, 0]) <= _STRAIGHT * size:
            return 0
    x1, x2, x3 = (
        p * control[1, 0] + q * control[1, 1],
        p * control[2, 0] + q * control[2, 1],
        p * control[3, 0] + q * control[3, 1],
    )
    a, b, c = x3 - 3.0 * x2 + 3.0 * x1, 2.0 * (x2 - 2.0 * x1), x1  # of dx/du / 3 = a u2 + b u + c
    square = b * b - 4.0 * a * c
    lever = -0.5 * (b + math.copysign(math.sqrt(max(square, 0.0)), b))
    first = lever / a if square > 0.0 and a != 0.0 else 1.0
    second = c / lever if square > 0.0 and lever != 0.0 else 1.0
    at, count = 0.0, 0
    for u in (min(first, second), max(first, second), 1.0):
        if not 0.0 < u <= 1.0:
            continue
        v = 1.0 - u
        x = 3.0 * u * v * (v * x1 + u * x2) + u * u * u * x3
        length = abs(x - at)
        if length > _STRAIGHT * size:
            row = spans[count]
            row[SPAN_END], row[SPAN_END + 1] = p * x, q * x
            row[SPAN_LENGTH], row[SPAN_CURVED] = length, 0.0
            at = x
            count += 1
    return count


@compiled
def _part(control: Floats, low: float, high: float, b: Floats) -> None:
    """Write to `b[4, 2]` the control points of the part u = low..high, ways from its own start.

    They are sums of differences of neighbours, so nothing cancels in a short part.
    """
    width = high - low
    for i in range(2):
        w0, w1, w2 = (
            control[1, i] - control[0, i],
            control[2, i] - control[1, i],
            control[3, i] - control[2, i],
        )
        at_low0, at_low1 = w0 + low * (w1 - w0), w1 + low * (w2 - w1)
        at_high0, at_high1 = w0 + high * (w1 - w0), w1 + high * (w2 - w1)
        b[0, i] = 0.0
        b[1, i] = width * (at_low0 + low * (at_low1 - at_low0))
        b[2, i] = b[1, i] + width * (at_low0 + high * (at_low1 - at_low0))
        b[3, i] = b[2, i] + width * (at_high0 + high * (at_high1 - at_high0))


@allocating
def _cut_curve(control: Floats, shortest: float, spans: Floats) -> int:
    """Halve the curve until every part fits, from the start to the end."""
    b = np.zeros((4, 2))
    count, level, index = 0, 0, 0  # the span is index / 2**level .. (index + 1) / 2**level
    at_p, at_q = 0.0, 0.0
    while level > 0 or index == 0:
        if count >= MOST_SPANS:
            return -1
        row = spans[count]
        width = 1.0 / (1 << level)
        _part(control, index * width, (index + 1) * width, b)
        length, fits = _fit(b, row)
        if not length < math.inf:
            return -1
        if not fits and length > shortest and level < _DEEPEST:
            level += 1
            index *= 2
            continue
        at_p, at_q = at_p + b[3, 0], at_q + b[3, 1]
        row[0], row[1], row[2], row[3] = b[1, 0], b[1, 1], b[2, 0], b[2, 1]
        row[SPAN_END], row[SPAN_END + 1] = at_p, at_q
        row[SPAN_LENGTH] = length
        row[SPAN_CURVED] = 1.0 if fits else 0.0
        if fits:
            _set_bounds(b, row)
        else:
            row[SPAN_LENGTH] = math.sqrt(b[3, 0] * b[3, 0] + b[3, 1] * b[3, 1])
        if row[SPAN_LENGTH] > 0.0:
            count += 1
        index += 1
        while level > 0 and index % 2 == 0:
            index //= 2
            level -= 1
    return count


@entry
def cut_bezier(control: Table, spans: Table) -> int:
    """Cut the curve with control points `control[4, 2]` (mm, the first one 0) into `spans[MOST_SPANS, SPAN_SIZE]`.

    Return how many, -1 if it would be more. A span holds the row of its segment, the way from the start of the curve to
    its end, its length, and 1 if it is curved, 0 if it is straight.
    """
    size = 0.0
    for j in range(1, 4):
        size = max(size, abs(control[j, 0]), abs(control[j, 1]))
    if size <= 0.0:
        return 0
    count = _cut_straight(control, spans)
    if count == 0:
        count = _cut_curve(control, max(SHORTEST_MM, SHORTEST_SHARE * size), spans)
    if count > 0:
        spans[count - 1, SPAN_END], spans[count - 1, SPAN_END + 1] = control[3, 0], control[3, 1]
    return count
