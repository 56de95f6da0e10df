"""Points on a surface of triangles, in the cells of a grid, and how deep a moving tool gets behind them."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from polycnc.kernel import compiled, entry
from polycnc.stock._chords import chord
from polycnc.stock._lowest import FAR, lowest
from polycnc.stock._profile import TO_R
from polycnc.stock._sweep import AT_X, AT_Y, DEPTH_MM, span

Floats = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]

_AROUND = 0.75  # cells: more than from the middle of one to its corner
_LEAST_UP = -1e-3
_HALVINGS = 16


@compiled
def _normal(corners: Floats, normal: Floats) -> float:
    """Write the unit normal of a triangle [3, 3]; return its area (mm2), 0 of one without."""
    ux, uy, uz = (
        corners[1, 0] - corners[0, 0],
        corners[1, 1] - corners[0, 1],
        corners[1, 2] - corners[0, 2],
    )
    vx, vy, vz = (
        corners[2, 0] - corners[0, 0],
        corners[2, 1] - corners[0, 1],
        corners[2, 2] - corners[0, 2],
    )
    normal[0], normal[1], normal[2] = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    twice = math.sqrt(normal[0] ** 2 + normal[1] ** 2 + normal[2] ** 2)
    if twice < 1e-12:
        return 0.0
    for i in range(3):
        normal[i] /= twice
    return 0.5 * twice


@compiled
def _distance(a: Floats, b: Floats) -> float:
    return math.sqrt((a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2 + (a[2] - b[2]) ** 2)


@entry(steps=lambda triangles, *_: 50 * len(triangles))
def sample(triangles: Floats, spacing_mm: float, inwards_mm: float, points: Floats, from_below: bool) -> int:
    """Write points [at least as many, 6] behind triangles [n, 3, 3]; return how many.

    They lie as close as `spacing_mm` and as deep as `inwards_mm` below the surface, whose normal is the last three
    columns. Those that `points` has no room for are counted alone, those of triangles that are seen from below only if
    they are wanted.
    """
    count = 0
    normal = np.empty(3)
    for n in range(triangles.shape[0]):
        area = _normal(triangles[n], normal)
        if area <= 0.0 or (normal[2] < _LEAST_UP and not from_below):
            continue
        top = 0  # the corner opposite of the longest side
        base = 0.0
        for corner in range(3):
            length = _distance(triangles[n, (corner + 1) % 3], triangles[n, (corner + 2) % 3])
            if length > base:
                top, base = corner, length
        left, right = (top + 1) % 3, (top + 2) % 3
        lines = math.ceil(2.0 * area / base / spacing_mm)
        for line in range(lines):
            up = (line + 0.5) / lines
            across = math.ceil(base * (1.0 - up) / spacing_mm)
            for at in range(across):
                share = (at + 0.5) / across
                if count < points.shape[0]:
                    for i in range(3):
                        low = triangles[n, left, i] * (1.0 - share) + triangles[n, right, i] * share
                        place = low * (1.0 - up) + triangles[n, top, i] * up
                        points[count, i] = place - inwards_mm * normal[i]
                        points[count, 3 + i] = normal[i]
                count += 1
    return count


@compiled
def _inside(
    rows: Floats, point: Floats, back_mm: float, begin: Floats, way: tuple[float, float, float, float]
) -> tuple[float, float]:
    """Return how far in what a tool sweeps a point is: from its side, and from below; 0 for both if it is not.

    The point is taken `back_mm` farther behind its surface.
    """
    length, ux, uy, slope = way
    radius = rows[rows.shape[0] - 1, TO_R]
    dx, dy = point[0] - back_mm * point[3] - begin[0], point[1] - back_mm * point[4] - begin[1]
    along, beside = dx * ux + dy * uy, dy * ux - dx * uy
    past = along - min(max(along, 0.0), length)
    sideways = radius - math.sqrt(past * past + beside * beside)
    if sideways <= 0.0:
        return 0.0, 0.0
    low = lowest(rows, beside * beside, slope, -along, length - along)
    downwards = point[2] - back_mm * point[5] - (begin[2] + slope * along + low)
    return (sideways, downwards) if low < 0.5 * FAR and downwards > 0.0 else (0.0, 0.0)


@compiled
def depth_behind(
    rows: Floats,
    point: Floats,
    inwards_mm: float,
    begin: Floats,
    way: tuple[float, float, float, float],
    least_mm: float,
) -> float:
    """Return how deep a tool gets behind the surface before a point; `least_mm` if that is not deeper.

    It is the way out of the tool: square to the surface, or sideways or down if that is shorter, as beside an edge.
    """
    sideways, downwards = _inside(rows, point, 0.0, begin, way)
    level = math.sqrt(max(0.0, 1.0 - point[5] * point[5]))
    most = min(sideways + inwards_mm * level, downwards + inwards_mm * max(point[5], 0.0))
    if sideways <= 0.0 or most <= least_mm:
        return least_mm
    low, high = 0.0, most - inwards_mm
    for _ in range(_HALVINGS):
        if _inside(rows, point, high, begin, way)[0] > 0.0:
            low = high
            break
        middle = 0.5 * (low + high)
        if _inside(rows, point, middle, begin, way)[0] > 0.0:
            low = middle
        else:
            high = middle
    return max(least_mm, inwards_mm + low)


@entry(steps=lambda points, starts, x0, y0, cell_mm, inwards_mm, places, *_: 500 * len(places))
def reach_behind(
    points: Floats,
    starts: npt.NDArray[np.int64],
    x0: float,
    y0: float,
    cell_mm: float,
    inwards_mm: float,
    places: Floats,
    cutter: Floats,
    figures: Floats,
) -> None:
    """Write into `figures` [n, 6] how deep a tool gets on each way between `places` [n + 1, 3], and where.

    The points of cell `(iy, ix)` are those from `starts[iy, ix]` on, whose last column begins the next line.
    """
    radius = cutter[cutter.shape[0] - 1, TO_R] + _AROUND * cell_mm
    ny, nx = starts.shape[0], starts.shape[1] - 1
    for n in range(places.shape[0] - 1):
        begin, end = places[n], places[n + 1]
        way = chord(begin, end)
        lowest_tip = min(begin[2], end[2])
        first_y = max(0, math.ceil((min(begin[1], end[1]) - radius - y0) / cell_mm))
        last_y = min(ny - 1, math.floor((max(begin[1], end[1]) + radius - y0) / cell_mm))
        low_z = begin if begin[2] <= end[2] else end
        for iy in range(first_y, last_y + 1):
            low, high = span(begin, end, way[1], way[2], radius, y0 + iy * cell_mm)
            if low > high:
                continue
            first_x = max(0, math.ceil((low - x0) / cell_mm))
            last_x = min(nx - 1, math.floor((high - x0) / cell_mm))
            if first_x > last_x:
                continue
            for at in range(starts[iy, first_x], starts[iy, last_x + 1]):
                if points[at, 2] <= lowest_tip:
                    continue
                least = max(inwards_mm, figures[n, DEPTH_MM])
                depth = depth_behind(
                    cutter, points[at], inwards_mm, begin if way[0] > 0.0 else low_z, way, least
                )
                if depth > least:
                    figures[n, DEPTH_MM] = depth
                    figures[n, AT_X], figures[n, AT_Y] = points[at, 0], points[at, 1]
