"""How low a rotating body gets over one cell on a straight way: the least of `slope * s + h(distance)` along it.

All lengths are mm. Each piece of the outline has that in closed form; only a rounded corner on a slope is found step by
step.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from polycnc.kernel import compiled
from polycnc.stock._profile import ARC_R, BEGIN_Z, CENTRE_R, CENTRE_Z, FROM_R, SLOPE, TO_R

Floats = npt.NDArray[np.float64]

FAR = 1e300
_CORNER_MM = 1e-6
_STEPS_TO_CORNER = 48
_ANY, _DISC, _BALL, _BULL = range(4)  # shapes of outlines


@compiled
def _outline(row: Floats, r: float) -> float:
    """Return the height of a piece of an outline at radius `r`."""
    if row[ARC_R] > 0.0:
        left = row[ARC_R] * row[ARC_R] - (r - row[CENTRE_R]) ** 2
        return float(row[CENTRE_Z] - math.sqrt(max(0.0, left)))
    return float(row[BEGIN_Z] + row[SLOPE] * (r - row[FROM_R]))


@compiled
def level(rows: Floats, r: float) -> float:
    """Return the height of an outline at radius `r`."""
    for i in range(rows.shape[0]):
        if r <= rows[i, TO_R]:
            return _outline(rows[i], r)
    return FAR


@compiled
def _at(row: Floats, q2: float, slope: float, w: float) -> tuple[float, float]:
    """Return `slope * w + outline` of a piece, and which way that rises with `w`: a number of the sign of its slope."""
    if row[ARC_R] <= 0.0:
        if row[SLOPE] == 0.0:
            return slope * w + row[BEGIN_Z], slope
        d = math.sqrt(q2 + w * w)
        return slope * w + _outline(row, d), slope * d + row[SLOPE] * w
    if row[CENTRE_R] <= 0.0:  # a ball needs one root alone
        root = math.sqrt(max(0.0, row[ARC_R] * row[ARC_R] - (q2 + w * w)))
        return slope * w + (row[CENTRE_Z] - root), slope * root + w
    d = math.sqrt(q2 + w * w)
    over = d - row[CENTRE_R]
    root = math.sqrt(max(0.0, row[ARC_R] * row[ARC_R] - over * over))
    return slope * w + (row[CENTRE_Z] - root), slope * root * d + over * w


@compiled
def _on_corner(row: Floats, q2: float, slope: float, low: float, high: float) -> float:
    """Return where from `low` to `high`, between which it is, a corner is lowest, to `_CORNER_MM` in height."""
    w = min(max(0.0, low), high)
    for _ in range(_STEPS_TO_CORNER):
        d = math.sqrt(q2 + w * w)
        over = d - row[CENTRE_R]
        root = math.sqrt(max(1e-12, row[ARC_R] * row[ARC_R] - over * over))
        rise, share = over / root, w / d
        gradient = slope + rise * share
        if gradient > 0.0:
            high = w
        else:
            low = w
        bend = 1e-12 + (1.0 + rise * rise) / root * share * share + rise * (1.0 - share * share) / d
        step = gradient / bend
        w = w - step if low < w - step < high else 0.5 * (low + high)
        if abs(gradient) * min(abs(step), high - low) < _CORNER_MM:
            break
    return w


@compiled
def _stationary(row: Floats, q2: float, slope: float, low: float, high: float) -> float:
    """Return where along the way, from the foot of the cell, a piece is lowest over it, between `low` and `high`."""
    if row[ARC_R] <= 0.0:
        return -slope * math.sqrt(q2 / (row[SLOPE] * row[SLOPE] - slope * slope))
    if row[CENTRE_R] <= 0.0:
        return -slope * math.sqrt(max(0.0, row[ARC_R] * row[ARC_R] - q2) / (1.0 + slope * slope))
    return _on_corner(row, q2, slope, low, high)


@compiled
def _least(row: Floats, q2: float, slope: float, low: float, high: float) -> float:
    """Return the least of `slope * w + outline` for `w` from `low` to `high`; far if there is none."""
    if low > high:
        return FAR
    if low + high >= 0.0:  # most often it is at the end that is nearer
        z, rises = _at(row, q2, slope, low)
        if rises >= 0.0:
            return z
        z, rises = _at(row, q2, slope, high)
        if rises <= 0.0:
            return z
    else:
        z, rises = _at(row, q2, slope, high)
        if rises <= 0.0:
            return z
        z, rises = _at(row, q2, slope, low)
        if rises >= 0.0:
            return z
    w = min(max(_stationary(row, q2, slope, low, high), low), high)
    return _at(row, q2, slope, w)[0]


@compiled
def lowest(rows: Floats, q2: float, slope: float, before: float, after: float) -> float:
    """Return how low a body gets over a cell, against its tip at the foot of the cell.

    The way leads from `before` to `after` about that foot, which lies `sqrt(q2)` beside it.
    """
    if slope == 0.0:
        w = min(max(0.0, before), after)
        return level(rows, math.sqrt(q2 + w * w))
    found = FAR
    nearest = min(max(0.0, before), after)
    nearest2, farthest2 = q2 + nearest * nearest, q2 + max(before * before, after * after)
    for i in range(rows.shape[0]):
        outer2, inner2 = rows[i, TO_R] * rows[i, TO_R], rows[i, FROM_R] * rows[i, FROM_R]
        if outer2 < nearest2 or inner2 > farthest2:
            continue
        outer = math.sqrt(outer2 - q2) if outer2 < farthest2 else FAR
        if inner2 <= nearest2:
            found = min(found, _least(rows[i], q2, slope, max(before, -outer), min(after, outer)))
        else:
            inner = math.sqrt(max(0.0, inner2 - q2))
            found = min(found, _least(rows[i], q2, slope, max(before, -outer), min(after, -inner)))
            found = min(found, _least(rows[i], q2, slope, max(before, inner), min(after, outer)))
    return found


@compiled
def shape_of(rows: Floats) -> int:
    """Return the shape of an outline, for `lowest_of`."""
    last = rows[rows.shape[0] - 1]
    if rows.shape[0] == 1 and last[ARC_R] <= 0.0:
        return _DISC if last[SLOPE] == 0.0 else _ANY
    if last[ARC_R] <= 0.0 or last[CENTRE_Z] != last[ARC_R]:
        return _ANY
    if rows.shape[0] == 1:
        return _BALL if last[CENTRE_R] == 0.0 else _ANY
    level_to_corner = rows[0, ARC_R] <= 0.0 and rows[0, SLOPE] == 0.0 and rows[0, BEGIN_Z] == 0.0
    return _BULL if rows.shape[0] == 2 and level_to_corner and rows[0, TO_R] == last[CENTRE_R] else _ANY


@compiled
def _lowest_of_disc(row: Floats, q2: float, slope: float, before: float, after: float) -> float:
    root = math.sqrt(max(0.0, row[TO_R] * row[TO_R] - q2))
    return float(slope * (max(before, -root) if slope > 0.0 else min(after, root)) + row[BEGIN_Z])


@compiled
def _lowest_of_ball(row: Floats, q2: float, slope: float, before: float, after: float) -> float:
    arc2 = row[ARC_R] * row[ARC_R]
    root = math.sqrt(max(0.0, arc2 - q2))
    low, high = max(before, -root), min(after, root)
    w = min(max(-slope * root / math.sqrt(1.0 + slope * slope), low), high)
    if low < w < high:
        w = min(max(_stationary(row, q2, slope, low, high), low), high)
    return float(slope * w + (row[CENTRE_Z] - math.sqrt(max(0.0, arc2 - (q2 + w * w)))))


@compiled
def _at_end(rows: Floats, q2: float, slope: float, w: float) -> tuple[float, float]:
    return _at(rows[0 if q2 + w * w <= rows[0, TO_R] * rows[0, TO_R] else 1], q2, slope, w)


@compiled
def _lowest_of_bull(rows: Floats, q2: float, slope: float, before: float, after: float) -> float:
    """Look at the end that is nearer, then at the other one: what is between falls and then rises."""
    outer2, inner2 = rows[1, TO_R] * rows[1, TO_R], rows[1, FROM_R] * rows[1, FROM_R]
    if before + after < 0.0:
        if q2 + after * after > outer2:
            return lowest(rows, q2, slope, before, after)
        z, rises = _at_end(rows, q2, slope, after)
        if rises <= 0.0:
            return z
        if q2 + before * before <= outer2:
            z, rises = _at_end(rows, q2, slope, before)
            if rises >= 0.0:
                return z
    else:
        if q2 + before * before > outer2:
            return lowest(rows, q2, slope, before, after)
        z, rises = _at_end(rows, q2, slope, before)
        if rises >= 0.0:
            return z
        if q2 + after * after <= outer2:
            z, rises = _at_end(rows, q2, slope, after)
            if rises <= 0.0:
                return z
    outer, inner = math.sqrt(max(0.0, outer2 - q2)), math.sqrt(max(0.0, inner2 - q2))
    low, high = max(before, -outer), min(after, outer)
    low, high = (low, min(high, -inner)) if slope > 0.0 else (max(low, inner), high)
    w = min(max(_on_corner(rows[1], q2, slope, low, high), low), high)
    return _at(rows[1], q2, slope, w)[0]


@compiled
def lowest_of(shape: int, rows: Floats, q2: float, slope: float, before: float, after: float) -> float:
    """Return what `lowest` does, sooner where `shape_of` knows the outline."""
    if slope == 0.0 or shape == _ANY:
        return lowest(rows, q2, slope, before, after)
    if shape == _DISC:
        return _lowest_of_disc(rows[0], q2, slope, before, after)
    if shape == _BALL:
        return _lowest_of_ball(rows[0], q2, slope, before, after)
    return _lowest_of_bull(rows, q2, slope, before, after)
