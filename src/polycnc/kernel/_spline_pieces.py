"""Cut the pieces of a spline into spans of unit speed, and bound their speed and curvature."""

from __future__ import annotations

import math

import numpy as np

from polycnc.kernel._jit import allocating, compiled
from polycnc.kernel._spline import (
    FIXED_U,
    PER_LENGTH,
    START,
    Floats,
    Mask,
    Splines,
    arc_length,
    curvature_at,
    direction_u,
    polynomial_u,
    speed_at,
    tangent_at,
    wrap,
)

# A spline that cannot be made.
SPLINE_TOO_FEW_POINTS = -1
SPLINE_BAD_SHAPE = -2  # arrays that do not fit together: axes, knot count, weight count, Bezier point count
SPLINE_BAD_KNOTS = -3  # decreasing, or repeated so often that the curve would tear
SPLINE_BAD_WEIGHT = -4
SPLINE_NO_LENGTH = -5
SPLINE_STORE_FULL = -6
SPLINE_BAD_DEGREE = -7
SPLINE_BAD_NUMBER = -8  # not a number, infinite, or beyond 1e100
SPLINE_BAD_ENDS = -9  # unknown end condition, or a periodic spline that is not closed
SPLINE_STALLED = -10  # axes outside the path length move while the path stands still
SPLINE_UNRESOLVED = -11  # numbers within one piece too far apart for this arithmetic

BOUND_MARGIN = 1.02  # bounds are sampled maxima, refined by a parabola, times this

_U_ERROR = 5e-10  # largest error of u(s) at a tested point, as a share of the span
_SPEED_RIPPLE = 1e-7
_QUADRATURE_ERROR = 1e-11  # between two step sizes; the finer one, which is used, is 256 times better
_MAX_DEPTH = (
    18  # halvings of a piece; only a cusp gets there, and 2**-18 of u is 1.5e-11 of the length at a cusp
)
_MAX_SPANS = 2000
_MAX_WEIGHT_RATIO = 1e9
_CORNER = 1e-5  # change of dp/ds that counts as a corner
_NOTHING = 1e-30
_STRAIGHT = 1e-14  # distance from a line, as a share of its length, that is rounding
_SAMPLES = 17


@allocating
def _fit_span(
    store: Splines, k: int, piece: int, scale: float, low: float, high: float, span: int
) -> tuple[float, bool]:
    """Write u(t) for u = low..high to the span; return its path length and whether it is accurate enough.

    The polynomial meets u and two derivatives at both ends (degree 5) and u at three places between (degree
    8), and is tested in the four gaps. When it fails, the span holds a straight u(t), which only the smallest
    spans at a cusp keep.
    """
    c = store.span
    width = high - low
    step = 0.125 * width
    along = np.zeros(9)  # path length at low + j step
    coarse = 0.0
    for j in range(8):
        along[j + 1] = along[j] + arc_length(store, k, piece, low + j * step, low + (j + 1) * step)
    for j in range(0, 8, 2):
        coarse += arc_length(store, k, piece, low + j * step, low + (j + 2) * step)
    length = along[8]
    speed0, product0 = speed_at(store, k, piece, low)
    speed1, product1 = speed_at(store, k, piece, high)
    for j in range(PER_LENGTH):
        c[span, j] = 0.0
    c[span, 0], c[span, 1] = low, width
    c[span, FIXED_U] = low if speed0 > speed1 else high
    if length <= _NOTHING:
        return 0.0, False
    c[span, PER_LENGTH] = 1.0 / length
    rounding = 1e-15 * scale
    converged = abs(coarse - length) <= _QUADRATURE_ERROR * length + rounding * width
    if not (converged and min(speed0, speed1) > 1e3 * rounding):
        return length, False
    a0, a1 = length / speed0, length / speed1
    b0 = -product0 / speed0 / speed0 * a0 * a0
    b1 = -product1 / speed1 / speed1 * a1 * a1
    c[span, 1], c[span, 2] = a0, 0.5 * b0
    c[span, 3] = 10.0 * width - 6.0 * a0 - 4.0 * a1 - 1.5 * b0 + 0.5 * b1
    c[span, 4] = -15.0 * width + 8.0 * a0 + 7.0 * a1 + 1.5 * b0 - b1
    c[span, 5] = 6.0 * width - 3.0 * (a0 + a1) - 0.5 * (b0 - b1)
    for j in range(2, 8, 2):
        _pass_through(c, span, along, j, low + j * step)
    for j in range(1, 9, 2):
        u, slope = polynomial_u(c, span, along[j] / length)
        speed = speed_at(store, k, piece, low + j * step)[0]
        in_place = abs(u - (low + j * step)) <= _U_ERROR * width + 4e-16
        ripple = abs(slope * speed / length - 1.0)
        if not (in_place and ripple <= _SPEED_RIPPLE + rounding / max(speed, rounding) + 1e-15 / width):
            for i in range(1, PER_LENGTH):
                c[span, i] = width if i == 1 else 0.0
            return length, False
    c[span, FIXED_U] = -1.0
    return length, True


@allocating
def _pass_through(c: Floats, span: int, along: Floats, j: int, u: float) -> None:
    """Add to u(t) the multiple of t3 (1 - t)3 (t - t2) (t - t4) that makes it meet `u` at place j = 2, 4, 6.

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
        share = (u - polynomial_u(c, span, t)[0]) / value
        for i in range(3, 9):
            c[span, i] += share * factor[i]


@compiled
def _cut_into_spans(store: Splines, k: int, piece: int, scale: float) -> int:
    """Halve the piece until every span fits, from left to right; return 0 or a negative code."""
    capacity = store.span.shape[0]
    level, index, made = 0, 0, 0  # the span is index / 2**level .. (index + 1) / 2**level
    while level > 0 or index == 0:
        count = store.rows[k, 3]
        if store.counts[5] + count >= capacity:
            return SPLINE_STORE_FULL
        span = wrap(store.rows[k, 2] + count, capacity)
        width = 1.0 / (1 << level)
        length, fits = _fit_span(store, k, piece, scale, index * width, (index + 1) * width, span)
        if made >= _MAX_SPANS or not length < math.inf:
            return SPLINE_UNRESOLVED
        if not fits and level < _MAX_DEPTH:
            level += 1
            index *= 2
            continue
        if length > 0.0:
            store.span_row[span, 0] = piece
            store.span[span, START] = store.length[k]
            store.length[k] += length
            store.rows[k, 3] = count + 1
            made += 1
        index += 1
        while level > 0 and index % 2 == 0:
            index //= 2
            level -= 1
    return 0


@compiled
def _bound_span(store: Splines, k: int, span: int, samples: Floats) -> None:
    """Sample |dp/ds| and |d2p/ds2| over the span; keep the largest, refined by a parabola, with a margin."""
    piece = store.span_row[span, 0]
    for sample in range(_SAMPLES):
        s = store.span[span, START] + sample / (_SAMPLES - 1.0) / store.span[span, PER_LENGTH]
        u = direction_u(store, span, s)
        tangent_at(store, k, piece, u, samples[0, sample])
        curvature_at(store, k, piece, u, samples[1, sample])
    for j in range(2):
        for i in range(store.path_axes.shape[1]):
            peak = 0.0
            for sample in range(_SAMPLES):
                here = abs(samples[j, sample, i])
                peak = max(peak, here)
                if 0 < sample < _SAMPLES - 1:
                    left, right = abs(samples[j, sample - 1, i]), abs(samples[j, sample + 1, i])
                    bend = 2.0 * here - left - right
                    if here >= left and here >= right and bend > 0.0:
                        peak = max(peak, here + (right - left) * (right - left) / (8.0 * bend))
            store.span_bound[span, j, i] = BOUND_MARGIN * peak


@compiled
def add_pieces(
    store: Splines, pieces: Floats, weights: Floats, first: Floats, last: Floats, path_axes: Mask
) -> int:
    """Add a spline of `pieces[q, 4, n]` with `weights[q, 4]`; return its number or a negative code.

    Nothing is counted in before all is well, so that a refused spline leaves no trace.
    """
    capacity = store.length.shape[0]
    if not path_axes.shape[0] == first.shape[0] == store.path_axes.shape[1]:
        return SPLINE_BAD_SHAPE
    if store.counts[1] >= capacity:
        return SPLINE_STORE_FULL
    k = wrap(store.counts[0] + store.counts[1], capacity)
    store.rows[k, 0] = wrap(store.counts[2] + store.counts[3], store.weight.shape[0])
    store.rows[k, 2] = wrap(store.counts[4] + store.counts[5], store.span.shape[0])
    store.rows[k, 1], store.rows[k, 3], store.length[k] = 0, 0, 0.0
    for i in range(path_axes.shape[0]):
        store.path_axes[k, i] = path_axes[i]
        store.vectors[k, 0, i], store.vectors[k, 1, i] = first[i], last[i]
    for piece in range(pieces.shape[0]):
        code = _add_piece(store, k, pieces[piece], weights[piece])
        if code < 0:
            return code
    if store.rows[k, 3] == 0:
        return SPLINE_NO_LENGTH
    _find_corners_and_bounds(store, k)
    store.counts[1] += 1
    store.counts[3] += store.rows[k, 1]
    store.counts[5] += store.rows[k, 3]
    return int(k)


@compiled
def _is_line(control: Floats) -> bool:
    """Tell whether the curve is a straight line from end to end, whatever its parameter does on the way.

    Such a line (a control point taken three times makes one) is stored with an even parameter: where u stands
    still, its curvature would be rounding divided by nothing.
    """
    square, largest, before = 0.0, 0.0, 0.0
    for i in range(control.shape[1]):
        square += control[3, i] * control[3, i]
        largest = max(largest, abs(control[3, i]))
    if largest <= _NOTHING:
        return False
    for j in range(1, 4):
        along = 0.0
        for i in range(control.shape[1]):
            along += control[j, i] * control[3, i] / square
        for i in range(control.shape[1]):
            if abs(control[j, i] - along * control[3, i]) > _STRAIGHT * largest:
                return False
        if not before - _STRAIGHT <= along <= 1.0 + _STRAIGHT:
            return False
        before = along
    return True


@compiled
def _add_piece(store: Splines, k: int, control: Floats, weights: Floats) -> int:
    """Add a piece to the spline in the making; return 0 or a negative code.

    `control[4, n]` is the first Bezier point and the way from it to the other three; `weights[4]`.
    """
    count = store.rows[k, 1]
    if store.counts[3] + count >= store.weight.shape[0]:
        return SPLINE_STORE_FULL
    if _is_line(control):
        for i in range(control.shape[1]):
            control[1, i] = control[3, i] / 3.0
            control[2, i] = 2.0 * control[1, i]
        weights[:] = 1.0
    w1, w2, w3 = weights[1] / weights[0], weights[2] / weights[0], weights[3] / weights[0]
    spread = max(1.0, w1, w2, w3) / min(1.0, w1, w2, w3)
    if spread > _MAX_WEIGHT_RATIO:
        return SPLINE_UNRESOLVED
    piece = wrap(store.rows[k, 0] + count, store.weight.shape[0])
    store.weight[piece, 0] = 3.0 * (w1 - 1.0)
    store.weight[piece, 1] = 3.0 * (w2 - 2.0 * w1 + 1.0)
    store.weight[piece, 2] = (w3 - 1.0) + 3.0 * (w1 - w2)
    moving, riding, scale = 0.0, 0.0, 0.0
    for i in range(control.shape[1]):
        b1, b2, b3 = w1 * control[1, i], w2 * control[2, i], w3 * control[3, i]
        c1, c2, c3 = 3.0 * b1, 3.0 * (b2 - 2.0 * b1), b3 + 3.0 * (b1 - b2)
        store.polynomial[piece, 0, i], store.polynomial[piece, 1, i] = control[0, i], c1
        store.polynomial[piece, 2, i], store.polynomial[piece, 3, i] = c2, c3
        extent = max(abs(control[1, i]), abs(control[2, i]), abs(control[3, i]))
        if store.path_axes[k, i] != 0:
            moving = max(moving, extent)
            scale += abs(c1) + 2.0 * abs(c2) + 3.0 * abs(c3)
        else:
            riding = max(riding, extent)
    if moving <= _NOTHING:
        return SPLINE_STALLED if riding > _NOTHING else 0
    store.rows[k, 1] = count + 1
    return _cut_into_spans(store, k, piece, scale * spread)


@allocating
def _find_corners_and_bounds(store: Splines, k: int) -> None:
    axes = store.path_axes.shape[1]
    samples, arriving = np.zeros((2, _SAMPLES, axes)), np.zeros(axes)
    store.vectors[k, 2:] = 0.0
    for number in range(store.rows[k, 3]):
        span = wrap(store.rows[k, 2] + number, store.span.shape[0])
        _bound_span(store, k, span, samples)
        store.span_row[span, 1] = 0
        for i in range(axes):
            if number > 0 and abs(samples[0, 0, i] - arriving[i]) > _CORNER * (1.0 + abs(arriving[i])):
                store.span_row[span, 1] = 1
            arriving[i] = samples[0, _SAMPLES - 1, i]
            for j in range(2):
                store.vectors[k, 2 + j, i] = max(store.vectors[k, 2 + j, i], store.span_bound[span, j, i])
