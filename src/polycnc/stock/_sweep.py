"""Sweep a rotating body along chords over a height field: cut what is in its way, or measure how deep it would be in.

All lengths are mm. A field is a grid of heights [rows along y, columns along x] at the middle of its cells.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from polycnc.kernel import compiled, entry
from polycnc.stock._chords import chord
from polycnc.stock._lowest import FAR, level, lowest_of, shape_of
from polycnc.stock._profile import TO_R

Floats = npt.NDArray[np.float64]

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
    low, high = FAR, -FAR
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
def _height(shape: int, rows: Floats, slope: float, length: float, along: float, beside: float) -> float:
    """Return how low a body gets over a cell, against its tip at the foot of the cell."""
    if length > 0.0:
        return lowest_of(shape, rows, beside * beside, slope, -along, length - along)
    return level(rows, math.sqrt(along * along + beside * beside))


@compiled
def _sweep_chord(
    grid: Grid,
    begin: Floats,
    end: Floats,
    rows: Floats,
    shape: int,
    bounds: Floats,
    cuts: bool,
    figures: Floats,
) -> None:
    length, ux, uy, slope = chord(begin, end)
    radius = rows[rows.shape[0] - 1, TO_R]
    lowest_tip = min(begin[2], end[2])
    per_bound = bounds.shape[0] / (radius * radius)
    low_y, high_y = min(begin[1], end[1]), max(begin[1], end[1])
    first_y = max(0, math.ceil((low_y - radius - grid.y0) / grid.cell_mm))
    last_y = min(grid.z.shape[0] - 1, math.floor((high_y + radius - grid.y0) / grid.cell_mm))
    first_x, end_x = _columns(grid, min(begin[0], end[0]) - radius, max(begin[0], end[0]) + radius)
    volume, depth, left, right = 0.0, 0.0, FAR, -FAR
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
            from_z = begin[2] + slope * along if length > 0.0 else lowest_tip
            z = max(from_z + _height(shape, rows, slope, length, along, beside), grid.bottom)
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
def _sweep_ways(
    grid: Grid, places: Floats, cutter: Floats, holder: Floats, cut: Floats, touched: Floats, bounds: Floats
) -> None:
    """Do what `sweep` says; `bounds` [2, any] is room for it: compiled code that makes arrays takes long to load."""
    cutter_shape, holder_shape = 0, 0
    if cutter.shape[0]:
        _bounds(cutter, bounds[0])
        cutter_shape = shape_of(cutter)
    if holder.shape[0]:
        _bounds(holder, bounds[1])
        holder_shape = shape_of(holder)
    for n in range(places.shape[0] - 1):
        begin, end = places[n], places[n + 1]
        if cutter.shape[0]:
            _sweep_chord(grid, begin, end, cutter, cutter_shape, bounds[0], True, cut[n])
        if holder.shape[0]:
            _sweep_chord(grid, begin, end, holder, holder_shape, bounds[1], False, touched[n])


def sweep(grid: Grid, places: Floats, cutter: Floats, holder: Floats, cut: Floats, touched: Floats) -> None:
    """Move a tool from each of `places` [n + 1, 3] (its tip) to the next: lower the field to what is left.

    `cutter` and `holder` are outlines, of which either may be empty; the holder follows the cutter and lowers nothing.
    `cut` and `touched` [n, 6] get a row of figures for each way.
    """
    _sweep_ways(grid, places, cutter, holder, cut, touched, np.empty((2, _BOUNDS)))
