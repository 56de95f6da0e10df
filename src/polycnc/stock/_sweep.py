"""Sweep a rotating body along chords over a height field: cut what is in its way, or measure how deep it would be in.

All lengths are mm. A field is a grid of heights [rows along y, columns along x] at the middle of its cells.
Over one cell the lowest point of the body is the least of `slope * s + h(distance)` along the chord, which each piece
of the outline has in closed form; only a rounded corner on a slope is found step by step.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from polycnc.kernel import compiled, entry
from polycnc.stock._chords import chord
from polycnc.stock._profile import ARC_R, BEGIN_Z, CENTRE_R, CENTRE_Z, FROM_R, SLOPE, TO_R

Floats = npt.NDArray[np.float64]

_FAR = 1e300
_CORNER_MM = 1e-6
_STEPS_TO_CORNER = 48
_BOUNDS = 1024
_CELLS_A_STEP = 5  # most are left as they are
_ROUNDING_MM = 1e-9


class Grid(NamedTuple):
    """A height field: the middle of its first cell, the width of a cell, the bottom, and the heights (mm)."""

    x0: float
    y0: float
    cell_mm: float
    bottom: float
    z: Floats  # [ny, nx]

    @property
    def x(self) -> Floats:
        """X of the columns: the middles of the cells."""
        return self.x0 + self.cell_mm * np.arange(self.z.shape[1], dtype=np.float64)

    @property
    def y(self) -> Floats:
        """Y of the rows."""
        return self.y0 + self.cell_mm * np.arange(self.z.shape[0], dtype=np.float64)


VOLUME_MM3, DEPTH_MM, WIDTH_LOW_MM, WIDTH_HIGH_MM, AT_X, AT_Y = range(6)
"""Columns of what a chord has done: volume, greatest depth, how far left and right of the way, where it was deepest."""
FIGURES = 6


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
    return _FAR


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
        return _FAR
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
    found = _FAR
    nearest = min(max(0.0, before), after)
    nearest2, farthest2 = q2 + nearest * nearest, q2 + max(before * before, after * after)
    for i in range(rows.shape[0]):
        outer2, inner2 = rows[i, TO_R] * rows[i, TO_R], rows[i, FROM_R] * rows[i, FROM_R]
        if outer2 < nearest2 or inner2 > farthest2:
            continue
        outer = math.sqrt(outer2 - q2) if outer2 < farthest2 else _FAR
        if inner2 <= nearest2:
            found = min(found, _least(rows[i], q2, slope, max(before, -outer), min(after, outer)))
        else:
            inner = math.sqrt(max(0.0, inner2 - q2))
            found = min(found, _least(rows[i], q2, slope, max(before, -outer), min(after, -inner)))
            found = min(found, _least(rows[i], q2, slope, max(before, inner), min(after, outer)))
    return found


@compiled
def _bounds(rows: Floats, bounds: Floats) -> None:
    """Write heights that the outline does not get below, by the square of the distance in equal steps."""
    outer = rows[rows.shape[0] - 1, TO_R]
    for i in range(bounds.shape[0]):
        bounds[i] = level(rows, max(0.0, outer * math.sqrt(i / bounds.shape[0]) - _ROUNDING_MM))


@compiled
def _bound(bounds: Floats, per_bound: float, d2: float) -> float:
    """Return a height that the outline does not get below at the square of a distance, or farther away."""
    return float(bounds[min(int(d2 * per_bound), bounds.shape[0] - 1)])


@compiled
def _any_above(heights: Floats, z: float) -> bool:
    """Tell whether any height is above another one."""
    count = 0
    for i in range(heights.shape[0]):
        count += heights[i] > z
    return count > 0


@compiled
def span(begin: Floats, end: Floats, ux: float, uy: float, radius: float, y: float) -> tuple[float, float]:
    """Return from where to where along x a body of this radius covers the line `y` on its way."""
    low, high = _FAR, -_FAR
    for place in (begin, end):
        left = radius * radius - (y - place[1]) ** 2
        if left >= 0.0:
            reach = math.sqrt(left)
            low, high = min(low, place[0] - reach), max(high, place[0] + reach)
    for side in (-radius, radius):
        from_y, to_y = begin[1] + side * ux, end[1] + side * ux
        if from_y != to_y and min(from_y, to_y) <= y <= max(from_y, to_y):
            share = (y - from_y) / (to_y - from_y)
            x = begin[0] + share * (end[0] - begin[0]) - side * uy
            low, high = min(low, x), max(high, x)
    return low, high


@compiled
def _columns(grid: Grid, low: float, high: float) -> tuple[int, int]:
    """Return the first column from one x to another, and the one after the last."""
    first = max(0, math.ceil((low - grid.x0) / grid.cell_mm))
    return first, min(grid.z.shape[1], math.floor((high - grid.x0) / grid.cell_mm) + 1)


@compiled
def _sweep_chord(
    grid: Grid, begin: Floats, end: Floats, rows: Floats, bounds: Floats, cuts: bool, figures: Floats
) -> None:
    length, ux, uy, slope = chord(begin, end)
    radius = rows[rows.shape[0] - 1, TO_R]
    lowest_tip = min(begin[2], end[2])
    per_bound = bounds.shape[0] / (radius * radius)
    low_y, high_y = min(begin[1], end[1]), max(begin[1], end[1])
    first_y = max(0, math.ceil((low_y - radius - grid.y0) / grid.cell_mm))
    last_y = min(grid.z.shape[0] - 1, math.floor((high_y + radius - grid.y0) / grid.cell_mm))
    first_x, end_x = _columns(grid, min(begin[0], end[0]) - radius, max(begin[0], end[0]) + radius)
    volume, depth, left, right = 0.0, 0.0, _FAR, -_FAR
    for iy in range(first_y, last_y + 1):
        y = grid.y0 + iy * grid.cell_mm
        row = grid.z[iy]
        away = max(0.0, low_y - y, y - high_y)
        floor = max(lowest_tip + _bound(bounds, per_bound, away * away), grid.bottom)
        if length < radius and not _any_above(row[first_x:end_x], floor):
            continue
        low, high = span(begin, end, ux, uy, radius, y)
        if low > high:
            continue
        first, last = _columns(grid, low, high)
        dy = y - begin[1]
        for ix in range(first, last):
            here = row[ix]
            if here <= floor:
                continue
            x = grid.x0 + ix * grid.cell_mm
            dx = x - begin[0]
            along = dx * ux + dy * uy
            beside = dy * ux - dx * uy
            past = along - min(max(along, 0.0), length)
            if here <= lowest_tip + _bound(bounds, per_bound, past * past + beside * beside):
                continue
            if length > 0.0:
                z = begin[2] + slope * along + lowest(rows, beside * beside, slope, -along, length - along)
            else:
                z = lowest_tip + level(rows, math.sqrt(dx * dx + dy * dy))
            z = max(z, grid.bottom)
            if z >= here:
                continue
            missed = here - z
            volume += missed
            left, right = min(left, beside), max(right, beside)
            if missed > depth:
                depth = missed
                figures[AT_X], figures[AT_Y] = x, y
            if cuts:
                row[ix] = z
    figures[VOLUME_MM3] = volume * grid.cell_mm * grid.cell_mm
    figures[DEPTH_MM] = depth
    figures[WIDTH_LOW_MM], figures[WIDTH_HIGH_MM] = (left, right) if depth > 0.0 else (0.0, 0.0)


def _steps(grid: Grid, places: Floats, cutter: Floats, holder: Floats, *_: object) -> int:
    """Return about how many cells are looked at: those within a body's radius of its ways, and in the field."""
    size = np.array(grid.z.shape[::-1]) * grid.cell_mm
    first = np.array([grid.x0, grid.y0]) - 0.5 * grid.cell_mm
    low, high = np.minimum(places[:-1, :2], places[1:, :2]), np.maximum(places[:-1, :2], places[1:, :2])
    found = len(places)
    for rows in (cutter, holder):
        if len(rows):
            begin, end = (
                np.maximum(low - rows[-1, TO_R], first),
                np.minimum(high + rows[-1, TO_R], first + size),
            )
            found += int(
                np.prod(np.maximum(end - begin, 0.0), axis=1).sum() / grid.cell_mm**2 / _CELLS_A_STEP
            )
    return found


@entry(steps=_steps)
def sweep(grid: Grid, places: Floats, cutter: Floats, holder: Floats, cut: Floats, touched: Floats) -> None:
    """Move a tool from each of `places` [n + 1, 3] (its tip) to the next: lower the field to what is left.

    `cutter` and `holder` are outlines, of which either may be empty; the holder follows the cutter and lowers nothing.
    `cut` and `touched` [n, 6] get a row of figures for each way.
    """
    bounds, holder_bounds = np.empty(_BOUNDS), np.empty(_BOUNDS)
    if cutter.shape[0]:
        _bounds(cutter, bounds)
    if holder.shape[0]:
        _bounds(holder, holder_bounds)
    for n in range(places.shape[0] - 1):
        if cutter.shape[0]:
            _sweep_chord(grid, places[n], places[n + 1], cutter, bounds, True, cut[n])
        if holder.shape[0]:
            _sweep_chord(grid, places[n], places[n + 1], holder, holder_bounds, False, touched[n])
