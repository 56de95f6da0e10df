"""Rational B-splines in a plane as cubics: exactly where they are cubics, else within a hundredth of a micrometre.

The knots are even, with both ends clamped, so the curve begins at the first control point and ends at the last one. It
is cut at its knots into rational Bezier curves, and these are halved until the cubic that leaves both ends in the same
direction and at the same rate stays beside them.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

Floats: TypeAlias = npt.NDArray[np.float64]
XY: TypeAlias = tuple[float, float]

DEVIATION_MM = 1e-5
"""How far the cubics may be from the curve."""
_ROUNDING = 1e-13  # of the size of the curve, which no halving gets below
_TESTED = np.arange(1, 8) / 8.0
_TESTED_PART = 0.5  # of the deviation at the tested places; between them it is hardly more
_DEEPEST = 30  # halvings


@dataclass(frozen=True, slots=True)
class Nurbs:
    """A curve that is being written: its control points so far, the first one the start, each with its weight."""

    code: str
    line: int
    order: int
    points: tuple[tuple[float, float, float], ...]


def nurbs_cubics(points: Sequence[tuple[float, float, float]], order: int) -> Iterator[list[XY]]:
    """Yield cubics that follow a curve: for each the ways from its start to its inner control points and its end (mm).

    `points` are the control points (mm) with their weights, all above 0, at least `order` of them.
    """
    weighted = np.array(points)
    weighted[:, :2] -= weighted[0, :2]
    size = float(np.abs(weighted[:, :2]).max())
    weighted[:, :2] *= weighted[:, 2:]
    allowed = max(_TESTED_PART * DEVIATION_MM, _ROUNDING * size)
    for piece in _pieces(weighted, order - 1):
        yield from _cubics(piece, allowed)


def _pieces(weighted: Floats, degree: int) -> Iterator[Floats]:
    """Yield the Bezier curves between the knots, by their weighted control points `[degree + 1, 3]`."""
    spans = len(weighted) - degree
    knots = [0.0] * degree + [float(each) for each in range(spans + 1)] + [float(spans)] * degree
    for span in range(spans):
        local = weighted[span : span + degree + 1]
        low, high = float(span), float(span + 1)
        yield np.array(
            [
                _blossom(local, knots[span : span + 2 * degree + 2], [low] * (degree - n) + [high] * n)
                for n in range(degree + 1)
            ]
        )


def _blossom(local: Floats, knots: list[float], arguments: list[float]) -> Floats:
    """Return the symmetric, in each argument linear form whose values are the control points (de Boor)."""
    points = list(local)
    degree = len(arguments)
    for done, t in enumerate(arguments, 1):
        for j in range(degree, done - 1, -1):
            low, high = knots[j], knots[j + degree - done + 1]
            part = (t - low) / (high - low)
            points[j] = (1.0 - part) * points[j - 1] + part * points[j]
    return np.asarray(points[degree])


def _cubics(piece: Floats, allowed: float) -> Iterator[list[XY]]:
    degree = len(piece) - 1
    of_piece, of_cubic = _bernstein(degree), _bernstein(3)
    waiting = [(piece, 0)]
    while waiting:
        curve, depth = waiting.pop()
        cubic = _cubic(curve)
        there = of_piece @ curve
        away = there[:, :2] / there[:, 2:] - of_cubic @ cubic
        if depth == _DEEPEST or float(np.hypot(away[:, 0], away[:, 1]).max()) <= allowed:
            ways = (cubic[1:] - cubic[0]).tolist()
            yield [(x, y) for x, y in ways]
        else:
            left, right = _halves(curve)
            waiting += [(right, depth + 1), (left, depth + 1)]


def _cubic(curve: Floats) -> Floats:
    """Return the control points of the cubic with the ends of a rational curve and its derivatives there."""
    weight = curve[:, 2]
    points = curve[:, :2] / weight[:, None]
    third = (len(curve) - 1) / 3.0
    first = third * (weight[1] / weight[0]) * (points[1] - points[0])
    last = third * (weight[-2] / weight[-1]) * (points[-1] - points[-2])
    return np.array([points[0], points[0] + first, points[-1] - last, points[-1]])


def _halves(curve: Floats) -> tuple[Floats, Floats]:
    left, right = [curve[0]], [curve[-1]]
    while len(curve) > 1:
        curve = 0.5 * (curve[:-1] + curve[1:])
        left.append(curve[0])
        right.append(curve[-1])
    return np.array(left), np.array(right[::-1])


def _bernstein(degree: int) -> Floats:
    """Return what each control point counts at the tested places."""
    n = np.arange(degree + 1)
    count = np.array([math.comb(degree, int(each)) for each in n])
    return np.asarray(count * _TESTED[:, None] ** n * (1.0 - _TESTED[:, None]) ** (degree - n))
