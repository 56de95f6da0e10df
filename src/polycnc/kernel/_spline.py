"""Splines as path segments: a cubic in u for the shape, and a polynomial that says which u a length means.

A spline is a row of *pieces*, cubics in u = 0..1 (rational ones for weighted NURBS). Each piece is cut into
*spans*, short enough that u, as a polynomial of degree 8 in the path length s, travels at unit speed.
Evaluation is then a search for the span and two short polynomials: the point is on the curve whatever u is,
and nothing iterates. `_spline_build` makes splines, `_spline_pieces` cuts them.

Storage is a ring: the oldest spline can be released while others run.
"""

from __future__ import annotations

import math
from typing import NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from polycnc.kernel._jit import compiled, entry

Floats: TypeAlias = npt.NDArray[np.float64]
Mask: TypeAlias = npt.NDArray[np.uint8]
Triple: TypeAlias = tuple[float, float, float]

_NODES = (0.33998104358485626, 0.86113631159405258)
_NODE_WEIGHTS = (0.65214515486254614, 0.34785484513745386)


class Splines(NamedTuple):
    """Hold many splines in n axes; S splines, P pieces and Q spans are the three ring capacities."""

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
    counts[0] = wrap(k + 1, store.length.shape[0])
    counts[1] -= 1
    counts[2] = wrap(counts[2] + store.rows[k, 1], store.weight.shape[0])
    counts[3] -= store.rows[k, 1]
    counts[4] = wrap(counts[4] + store.rows[k, 3], store.span.shape[0])
    counts[5] -= store.rows[k, 3]
    return int(k)


@compiled
def wrap(row: int, capacity: int) -> int:
    return row - capacity if row >= capacity else row


@compiled
def _weights(store: Splines, piece: int, u: float) -> Triple:
    """Return weight(u) and its first two derivatives."""
    w1, w2, w3 = store.weight[piece, 0], store.weight[piece, 1], store.weight[piece, 2]
    return 1.0 + ((w3 * u + w2) * u + w1) * u, (3.0 * w3 * u + 2.0 * w2) * u + w1, 6.0 * w3 * u + 2.0 * w2


@compiled
def _derivatives(store: Splines, piece: int, u: float, weights: Triple, i: int) -> tuple[float, float]:
    """Return dp_i/du and d2p_i/du2 by the quotient rule, which without weights changes no bit."""
    c1, c2, c3 = store.polynomial[piece, 1, i], store.polynomial[piece, 2, i], store.polynomial[piece, 3, i]
    w, dw, ddw = weights
    away = ((c3 * u + c2) * u + c1) * u / w
    velocity = ((3.0 * c3 * u + 2.0 * c2) * u + c1 - away * dw) / w
    return velocity, (6.0 * c3 * u + 2.0 * c2 - 2.0 * velocity * dw - away * ddw) / w


@compiled
def speed_at(store: Splines, k: int, piece: int, u: float) -> tuple[float, float]:
    """Return the path speed |dp/du| and the product p'.p'' over the axes that count."""
    weights = _weights(store, piece, u)
    square, product = 0.0, 0.0
    for i in range(store.path_axes.shape[1]):
        if store.path_axes[k, i] != 0:
            velocity, acceleration = _derivatives(store, piece, u, weights, i)
            square += velocity * velocity
            product += velocity * acceleration
    return math.sqrt(square), product


@compiled
def arc_length(store: Splines, k: int, piece: int, low: float, high: float) -> float:
    """Return the path length from u = low to u = high by Gauss-Legendre quadrature with four points."""
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    total = 0.0
    for j in range(2):
        for side in range(-1, 2, 2):
            total += _NODE_WEIGHTS[j] * speed_at(store, k, piece, middle + side * half * _NODES[j])[0]
    return half * total


@compiled
def _span_at(store: Splines, k: int, s: float, before: bool) -> int:
    """Return the span that holds `s`; where two meet, the later one, or with `before` the earlier one."""
    first, low, high = store.rows[k, 2], 0, store.rows[k, 3]
    capacity = store.span.shape[0]
    while high - low > 1:
        middle = (low + high) >> 1
        start = store.span[wrap(first + middle, capacity), START]
        if start < s or (start == s and not before):
            low = middle
        else:
            high = middle
    return wrap(first + low, capacity)


@compiled
def polynomial_u(c: Floats, span: int, t: float) -> tuple[float, float]:
    """Return u and du/dt at a place t = 0..1 along the span."""
    u, slope = 0.0, 0.0
    for j in range(8, -1, -1):
        slope = slope * t + u
        u = u * t + c[span, j]
    return u, slope


@compiled
def _u_at(store: Splines, span: int, s: float) -> float:
    t = min(max((s - store.span[span, START]) * store.span[span, PER_LENGTH], 0.0), 1.0)
    return polynomial_u(store.span, span, t)[0]


@compiled
def direction_u(store: Splines, span: int, s: float) -> float:
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
def tangent_at(store: Splines, k: int, piece: int, u: float, out: Floats) -> None:
    weights = _weights(store, piece, u)
    speed = speed_at(store, k, piece, u)[0]
    for i in range(store.path_axes.shape[1]):
        out[i] = _derivatives(store, piece, u, weights, i)[0] / speed


@compiled
def spline_tangent(store: Splines, k: int, s: float, out: Floats) -> None:
    """Write dp/ds to `out[n]`, of length 1 over the axes that count; at a corner, the direction after it."""
    span = _span_at(store, k, s, False)
    tangent_at(store, k, store.span_row[span, 0], direction_u(store, span, s), out)


@compiled
def spline_tangent_before(store: Splines, k: int, s: float, out: Floats) -> None:
    """Write dp/ds to `out[n]`; at a corner, the direction before it."""
    span = _span_at(store, k, s, True)
    tangent_at(store, k, store.span_row[span, 0], direction_u(store, span, s), out)


@compiled
def curvature_at(store: Splines, k: int, piece: int, u: float, out: Floats) -> None:
    weights = _weights(store, piece, u)
    speed, product = speed_at(store, k, piece, u)
    square = speed * speed
    pull = product / square
    for i in range(store.path_axes.shape[1]):
        velocity, acceleration = _derivatives(store, piece, u, weights, i)
        out[i] = (acceleration - velocity * pull) / square


@compiled
def spline_curvature_vector(store: Splines, k: int, s: float, out: Floats) -> None:
    """Write d2p/ds2 to `out[n]`; where pieces meet, that of the later one."""
    span = _span_at(store, k, s, False)
    curvature_at(store, k, store.span_row[span, 0], direction_u(store, span, s), out)


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
    span, last = _span_at(store, k, low, False), _span_at(store, k, high, True)
    for i in range(tangent_out.shape[0]):
        tangent_out[i] = store.span_bound[span, 0, i]
        curvature_out[i] = store.span_bound[span, 1, i]
    while span != last and store.span[span, START] < high:
        span = wrap(span + 1, store.span.shape[0])
        for i in range(tangent_out.shape[0]):
            tangent_out[i] = max(tangent_out[i], store.span_bound[span, 0, i])
            curvature_out[i] = max(curvature_out[i], store.span_bound[span, 1, i])


@compiled
def spline_next_corner(store: Splines, k: int, s: float) -> float:
    """Return the path length of the first corner or cusp after `s`, or the length of the spline if none."""
    last = wrap(store.rows[k, 2] + store.rows[k, 3] - 1, store.span.shape[0])
    span = _span_at(store, k, s, False)
    while span != last:
        span = wrap(span + 1, store.span.shape[0])
        if store.span_row[span, 1] != 0:
            return float(store.span[span, START])
    return float(store.length[k])


@compiled
def spline_next_cut(store: Splines, k: int, s: float) -> float:
    """Return the path length of the first corner or start of a piece after `s`, or of the end of the spline."""
    last = wrap(store.rows[k, 2] + store.rows[k, 3] - 1, store.span.shape[0])
    span = _span_at(store, k, s, False)
    piece = store.span_row[span, 0]
    while span != last:
        span = wrap(span + 1, store.span.shape[0])
        if store.span_row[span, 0] != piece or store.span_row[span, 1] != 0:
            return float(store.span[span, START])
    return float(store.length[k])
