"""Splines as path segments: a cubic in u for the shape, and a polynomial that says which u a length means.

A spline is a row of *pieces*, cubics in u = 0..1 (rational ones for weighted NURBS). Each piece is cut into
*spans*, short enough that u, as a polynomial of degree 8 in the path length s, travels at unit speed.
Evaluation is then a search for the span and two short polynomials: the point is on the curve whatever u is,
and nothing iterates.

The builders (`add_...`) do the work. They return the number of the spline or a negative `SPLINE_...` code,
and leave the splines already stored untouched. Storage is a ring: the oldest spline can be released while
others run.
"""

from __future__ import annotations

import math
from typing import NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from polycnc.kernel._jit import allocating, compiled, entry

Floats: TypeAlias = npt.NDArray[np.float64]
Mask: TypeAlias = npt.NDArray[np.uint8]

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

CUBIC_NATURAL = 0
CUBIC_CLAMPED = 1
CUBIC_PERIODIC = 2

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
_HUGE = 1e100
_SAMPLES = 17
_NODES = (0.33998104358485626, 0.86113631159405258)
_NODE_WEIGHTS = (0.65214515486254614, 0.34785484513745386)


class Splines(NamedTuple):
    """Hold many splines in n axes; S splines, P pieces and Q spans are the three ring capacities.

    Few arrays, because every array that a compiled function takes costs compile time.
    """

    counts: npt.NDArray[np.int64]  # [6]: first row and number of rows in use, for splines, pieces and spans
    rows: npt.NDArray[np.int64]  # [S, 4]: first piece, number of pieces, first span, number of spans
    length: Floats  # [S]: path length
    vectors: Floats  # [S, 4, n]: first point, last point (both exact), bounds of |dp/ds| and |d2p/ds2|
    path_axes: Mask  # [S, n]: 1 for axes that count in the path length
    polynomial: Floats  # [P, 4, n]: the point is row 0 + (row 1 u + row 2 u2 + row 3 u3) / weight(u)
    weight: Floats  # [P, 3]: weight(u) = 1 + w0 u + w1 u2 + w2 u3; zeros for a piece without weights
    span_row: npt.NDArray[np.int64]  # [Q, 2]: the piece a span lies on, 1 if the direction jumps at its start
    span: Floats  # [Q, 12]: nine coefficients of u(t) with t = 0..1 along the span, then the columns below
    span_bound: Floats  # [Q, 2, n]: bounds of |dp/ds| and |d2p/ds2|


PER_LENGTH = 9  # 1 / length of the span
FIXED_U = 10  # -1, or at a cusp the one u whose direction stands for the whole (tiny) span
START = 11  # path length at the start of the span, from the start of the spline


def make_splines(axes: int, splines: int = 64, pieces: int = 1024, spans: int = 16384) -> Splines:
    """Return an empty store for so many splines, pieces and spans; a smooth piece takes 1 to 16 spans."""
    return Splines(
        counts=np.zeros(6, np.int64),
        rows=np.zeros((splines, 4), np.int64),
        length=np.zeros(splines),
        vectors=np.zeros((splines, 4, axes)),
        path_axes=np.zeros((splines, axes), np.uint8),
        polynomial=np.zeros((pieces, 4, axes)),
        weight=np.zeros((pieces, 3)),
        span_row=np.zeros((spans, 2), np.int64),
        span=np.zeros((spans, 12)),
        span_bound=np.zeros((spans, 2, axes)),
    )


@entry
def splines_clear(store: Splines) -> None:
    """Forget all splines."""
    store.counts[:] = 0


@entry
def splines_release(store: Splines) -> int:
    """Free the oldest spline and its room; return its number, or -1 when there is none."""
    counts = store.counts
    if counts[1] == 0:
        return -1
    k = counts[0]
    counts[0] = _wrap(k + 1, store.length.shape[0])
    counts[1] -= 1
    counts[2] = _wrap(counts[2] + store.rows[k, 1], store.weight.shape[0])
    counts[3] -= store.rows[k, 1]
    counts[4] = _wrap(counts[4] + store.rows[k, 3], store.span.shape[0])
    counts[5] -= store.rows[k, 3]
    return int(k)


@compiled
def _wrap(row: int, capacity: int) -> int:
    return row - capacity if row >= capacity else row


@compiled
def _weights(store: Splines, piece: int, u: float) -> tuple[float, float, float]:
    """Return weight(u) and its first two derivatives."""
    w1, w2, w3 = store.weight[piece, 0], store.weight[piece, 1], store.weight[piece, 2]
    return 1.0 + ((w3 * u + w2) * u + w1) * u, (3.0 * w3 * u + 2.0 * w2) * u + w1, 6.0 * w3 * u + 2.0 * w2


@compiled
def _derivatives(
    store: Splines, piece: int, u: float, weights: tuple[float, float, float], i: int
) -> tuple[float, float]:
    """Return dp_i/du and d2p_i/du2 by the quotient rule, which without weights changes no bit."""
    c1, c2, c3 = store.polynomial[piece, 1, i], store.polynomial[piece, 2, i], store.polynomial[piece, 3, i]
    w, dw, ddw = weights
    away = ((c3 * u + c2) * u + c1) * u / w
    velocity = ((3.0 * c3 * u + 2.0 * c2) * u + c1 - away * dw) / w
    return velocity, (6.0 * c3 * u + 2.0 * c2 - 2.0 * velocity * dw - away * ddw) / w


@compiled
def _speed(store: Splines, k: int, piece: int, u: float) -> tuple[float, float]:
    """Return the path speed |dp/du| and the product p'.p'' over the axes that count."""
    weights = _weights(store, piece, u)
    square = 0.0
    product = 0.0
    for i in range(store.path_axes.shape[1]):
        if store.path_axes[k, i] != 0:
            velocity, acceleration = _derivatives(store, piece, u, weights, i)
            square += velocity * velocity
            product += velocity * acceleration
    return math.sqrt(square), product


@compiled
def _arc(store: Splines, k: int, piece: int, low: float, high: float) -> float:
    """Return the path length from u = low to u = high by Gauss-Legendre quadrature with four points."""
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    total = 0.0
    for j in range(2):
        for side in range(-1, 2, 2):
            total += _NODE_WEIGHTS[j] * _speed(store, k, piece, middle + side * half * _NODES[j])[0]
    return half * total


@compiled
def _span_at(store: Splines, k: int, s: float, before: bool) -> int:
    """Return the span that holds `s`; where two meet, the later one, or with `before` the earlier one."""
    first, low, high = store.rows[k, 2], 0, store.rows[k, 3]
    capacity = store.span.shape[0]
    while high - low > 1:
        middle = (low + high) >> 1
        start = store.span[_wrap(first + middle, capacity), START]
        if start < s or (start == s and not before):
            low = middle
        else:
            high = middle
    return _wrap(first + low, capacity)


@compiled
def _polynomial_u(c: Floats, span: int, t: float) -> tuple[float, float]:
    """Return u and du/dt at a place t = 0..1 along the span."""
    u, slope = 0.0, 0.0
    for j in range(8, -1, -1):
        slope = slope * t + u
        u = u * t + c[span, j]
    return u, slope


@compiled
def _u_at(store: Splines, span: int, s: float) -> float:
    t = min(max((s - store.span[span, START]) * store.span[span, PER_LENGTH], 0.0), 1.0)
    return _polynomial_u(store.span, span, t)[0]


@compiled
def _direction_u(store: Splines, span: int, s: float) -> float:
    fixed = store.span[span, FIXED_U]
    return float(fixed) if fixed >= 0.0 else _u_at(store, span, s)


@compiled
def spline_parameter(store: Splines, k: int, s: float) -> tuple[int, float]:
    """Return the piece (0, 1, ... from the start) and its parameter u at path length `s`."""
    span = _span_at(store, k, s, False)
    piece = store.span_row[span, 0] - store.rows[k, 0]
    return int(piece + store.weight.shape[0] if piece < 0 else piece), _u_at(store, span, s)


@compiled
def spline_point(store: Splines, k: int, s: float, out: Floats) -> None:
    """Write the point at path length `s` to `out[n]`; at and beyond an end, the end point bit for bit."""
    axes = store.path_axes.shape[1]
    if s <= 0.0 or s >= store.length[k]:
        end = 0 if s <= 0.0 else 1
        for i in range(axes):
            out[i] = store.vectors[k, end, i]
        return
    span = _span_at(store, k, s, False)
    u = _u_at(store, span, s)
    piece = store.span_row[span, 0]
    c = store.polynomial
    weight = _weights(store, piece, u)[0]
    for i in range(axes):
        out[i] = c[piece, 0, i] + ((c[piece, 3, i] * u + c[piece, 2, i]) * u + c[piece, 1, i]) * u / weight


@compiled
def _tangent_at(store: Splines, k: int, piece: int, u: float, out: Floats) -> None:
    weights = _weights(store, piece, u)
    speed = _speed(store, k, piece, u)[0]
    for i in range(store.path_axes.shape[1]):
        out[i] = _derivatives(store, piece, u, weights, i)[0] / speed


@compiled
def spline_tangent(store: Splines, k: int, s: float, out: Floats) -> None:
    """Write dp/ds to `out[n]`, of length 1 over the axes that count; at a corner, the direction after it."""
    span = _span_at(store, k, s, False)
    _tangent_at(store, k, store.span_row[span, 0], _direction_u(store, span, s), out)


@compiled
def spline_tangent_before(store: Splines, k: int, s: float, out: Floats) -> None:
    """Write dp/ds to `out[n]`; at a corner, the direction before it."""
    span = _span_at(store, k, s, True)
    _tangent_at(store, k, store.span_row[span, 0], _direction_u(store, span, s), out)


@compiled
def _curvature_at(store: Splines, k: int, piece: int, u: float, out: Floats) -> None:
    weights = _weights(store, piece, u)
    speed, product = _speed(store, k, piece, u)
    square = speed * speed
    pull = product / square
    for i in range(store.path_axes.shape[1]):
        velocity, acceleration = _derivatives(store, piece, u, weights, i)
        out[i] = (acceleration - velocity * pull) / square


@compiled
def spline_curvature_vector(store: Splines, k: int, s: float, out: Floats) -> None:
    """Write d2p/ds2 to `out[n]`; where pieces meet, that of the later one."""
    span = _span_at(store, k, s, False)
    _curvature_at(store, k, store.span_row[span, 0], _direction_u(store, span, s), out)


@compiled
def spline_tangent_bound(store: Splines, k: int, out: Floats) -> None:
    """Write to `out[n]` a bound of |dp_i/ds| on the whole spline: path speed <= axis speed limit / bound."""
    for i in range(out.shape[0]):
        out[i] = store.vectors[k, 2, i]


@compiled
def spline_curvature_bound(store: Splines, k: int, out: Floats) -> None:
    """Write to `out[n]` a bound of |d2p_i/ds2| on the whole spline: speed squared <= acceleration / bound."""
    for i in range(out.shape[0]):
        out[i] = store.vectors[k, 3, i]


@compiled
def spline_bounds_between(
    store: Splines, k: int, low: float, high: float, tangent_out: Floats, curvature_out: Floats
) -> None:
    """Write both bounds for path lengths `low`..`high` to arrays [n], so that limits can be local."""
    capacity = store.span.shape[0]
    span, last = _span_at(store, k, low, False), _span_at(store, k, high, True)
    for i in range(tangent_out.shape[0]):
        tangent_out[i] = store.span_bound[span, 0, i]
    for i in range(curvature_out.shape[0]):
        curvature_out[i] = store.span_bound[span, 1, i]
    while span != last and store.span[span, START] < high:
        span = _wrap(span + 1, capacity)
        for i in range(store.path_axes.shape[1]):
            tangent_out[i] = max(tangent_out[i], store.span_bound[span, 0, i])
            curvature_out[i] = max(curvature_out[i], store.span_bound[span, 1, i])


@compiled
def spline_next_corner(store: Splines, k: int, s: float) -> float:
    """Return the path length of the first corner or cusp after `s`, or the length of the spline if none."""
    capacity = store.span.shape[0]
    last = _wrap(store.rows[k, 2] + store.rows[k, 3] - 1, capacity)
    span = _span_at(store, k, s, False)
    while span != last:
        span = _wrap(span + 1, capacity)
        if store.span_row[span, 1] != 0:
            return float(store.span[span, START])
    return float(store.length[k])


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
        along[j + 1] = along[j] + _arc(store, k, piece, low + j * step, low + (j + 1) * step)
    for j in range(0, 8, 2):
        coarse += _arc(store, k, piece, low + j * step, low + (j + 2) * step)
    length = along[8]
    speed0, product0 = _speed(store, k, piece, low)
    speed1, product1 = _speed(store, k, piece, high)
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
        u, slope = _polynomial_u(c, span, along[j] / length)
        speed = _speed(store, k, piece, low + j * step)[0]
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
        share = (u - _polynomial_u(c, span, t)[0]) / value
        for i in range(3, 9):
            c[span, i] += share * factor[i]


@compiled
def _cut_into_spans(store: Splines, k: int, piece: int, scale: float) -> int:
    """Halve the piece until every span fits, from left to right; return 0 or a negative code."""
    capacity = store.span.shape[0]
    level, index = 0, 0  # the span index / 2**level .. (index + 1) / 2**level
    made = 0
    while level > 0 or index == 0:
        count = store.rows[k, 3]
        if store.counts[5] + count >= capacity:
            return SPLINE_STORE_FULL
        span = _wrap(store.rows[k, 2] + count, capacity)
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
    axes = store.path_axes.shape[1]
    for sample in range(_SAMPLES):
        s = store.span[span, START] + sample / (_SAMPLES - 1.0) / store.span[span, PER_LENGTH]
        u = _direction_u(store, span, s)
        _tangent_at(store, k, piece, u, samples[0, sample])
        _curvature_at(store, k, piece, u, samples[1, sample])
    for j in range(2):
        for i in range(axes):
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
def _add_spline(
    store: Splines, pieces: Floats, weights: Floats, first: Floats, last: Floats, path_axes: Mask
) -> int:
    """Add a spline of `pieces[q, 4, n]` with `weights[q, 4]`; return its number or a negative code.

    Nothing is counted in before all is well, so that a refused spline leaves no trace.
    """
    capacity = store.length.shape[0]
    if path_axes.shape[0] != first.shape[0]:
        return SPLINE_BAD_SHAPE
    if store.counts[1] >= capacity:
        return SPLINE_STORE_FULL
    k = _wrap(store.counts[0] + store.counts[1], capacity)
    store.rows[k, 0] = _wrap(store.counts[2] + store.counts[3], store.weight.shape[0])
    store.rows[k, 1] = 0
    store.rows[k, 2] = _wrap(store.counts[4] + store.counts[5], store.span.shape[0])
    store.rows[k, 3] = 0
    store.length[k] = 0.0
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
def _add_piece(store: Splines, k: int, control: Floats, weights: Floats) -> int:
    """Add a piece to the spline in the making; return 0 or a negative code.

    `control[4, n]` is the first Bezier point and the way from it to the other three; `weights[4]`.
    """
    count = store.rows[k, 1]
    if store.counts[3] + count >= store.weight.shape[0]:
        return SPLINE_STORE_FULL
    w1, w2, w3 = weights[1] / weights[0], weights[2] / weights[0], weights[3] / weights[0]
    spread = max(1.0, w1, w2, w3) / min(1.0, w1, w2, w3)
    if spread > _MAX_WEIGHT_RATIO:
        return SPLINE_UNRESOLVED
    piece = _wrap(store.rows[k, 0] + count, store.weight.shape[0])
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
        span = _wrap(store.rows[k, 2] + number, store.span.shape[0])
        _bound_span(store, k, span, samples)
        store.span_row[span, 1] = 0
        for i in range(axes):
            if number > 0 and abs(samples[0, 0, i] - arriving[i]) > _CORNER * (1.0 + abs(arriving[i])):
                store.span_row[span, 1] = 1
            arriving[i] = samples[0, _SAMPLES - 1, i]
            for j in range(2):
                store.vectors[k, 2 + j, i] = max(store.vectors[k, 2 + j, i], store.span_bound[span, j, i])


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
    if rows % 3 != 1 or n != store.path_axes.shape[1]:
        return SPLINE_BAD_SHAPE
    if not _all_usable(control):
        return SPLINE_BAD_NUMBER
    pieces = np.zeros((rows // 3, 4, n))
    for piece in range(rows // 3):
        for i in range(n):
            pieces[piece, 0, i] = control[3 * piece, i]
            for j in range(1, 4):
                pieces[piece, j, i] = control[3 * piece + j, i] - control[3 * piece, i]
    return _add_spline(store, pieces, np.ones((rows // 3, 4)), control[0], control[rows - 1], path_axes)


@allocating
def _solve_tridiagonal(lower: Floats, diagonal: Floats, upper: Floats, unknown: Floats) -> None:
    """Solve in place: `unknown[m, q]` holds q right-hand sides and receives the solutions."""
    m = diagonal.shape[0]
    ratio = np.zeros(m)
    pivot = diagonal[0]
    for i in range(m):
        if i > 0:
            ratio[i - 1] = upper[i - 1] / pivot
            pivot = diagonal[i] - lower[i] * ratio[i - 1]
        for j in range(unknown.shape[1]):
            carried = lower[i] * unknown[i - 1, j] if i > 0 else 0.0
            unknown[i, j] = (unknown[i, j] - carried) / pivot
    for i in range(m - 2, -1, -1):
        for j in range(unknown.shape[1]):
            unknown[i, j] -= ratio[i] * unknown[i + 1, j]


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
        lower[i], diagonal[i], upper[i] = _smooth_row(
            knots, points, i - 1 if i > 0 else m - 2, i, slopes[i, :n]
        )
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
def _smooth_row(
    knots: Floats, points: Floats, back: int, i: int, right: Floats
) -> tuple[float, float, float]:
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
    if m < 2:
        return SPLINE_TOO_FEW_POINTS
    if n != store.path_axes.shape[1] or knots.shape[0] != m or end_slopes.shape != (2, n):
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
    return _add_spline(store, pieces, np.ones((m - 1, 4)), points[0], points[m - 1], path_axes)


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
    for i in range(knots.shape[0] - 1):
        if knots[i + 1] < knots[i]:
            return SPLINE_BAD_KNOTS
    for i in range(1, m):
        if knots[i] == knots[i + degree]:
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
    for i in range(bezier.shape[1]):
        b0, b1, b2 = bezier[0, i], bezier[1, i], bezier[2, i]
        if degree == 1:
            bezier[1, i], bezier[2, i], bezier[3, i] = (2.0 * b0 + b1) / 3.0, (b0 + 2.0 * b1) / 3.0, b1
        elif degree == 2:
            bezier[1, i], bezier[2, i], bezier[3, i] = (b0 + 2.0 * b1) / 3.0, (2.0 * b1 + b2) / 3.0, b2


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
    if n != store.path_axes.shape[1]:
        return SPLINE_BAD_SHAPE
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
        for j in range(4):
            piece_weights[count, j] = bezier[j, n]
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
    return _add_spline(store, pieces[:count], piece_weights[:count], first, last, path_axes)
