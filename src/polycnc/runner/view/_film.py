"""A body while it is cut, as a view shows it: the field at first, and what changes from one moment to the next."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from polycnc.errors import UsageError
from polycnc.runner._machined import Machined
from polycnc.stock import Cutting, Stock

Floats = npt.NDArray[np.float64]
Places = npt.NDArray[np.int32]
Heights = npt.NDArray[np.uint16]

MOST_ACROSS = 360
"""Cells along the longer side."""
MOST_CHANGES = 3_000_000
_STEPS = 1500
_LEVELS = 4095


@dataclass(frozen=True, eq=False)
class Film:
    """Hold a field [ny, nx] in levels above its bottom, and its changes in the order of time.

    `ends` [steps] are times (s); of each step `counts` cells get new `levels`; `cells` are their flat places.
    """

    first_mm: tuple[float, float]
    cell_mm: float
    bottom_mm: float
    level_mm: float
    begin: Heights
    ends: Floats
    counts: Places
    cells: Places
    levels: Heights


def film_of(machined: Machined) -> Film:
    """Return the film of a body that has been cut, with as many cells as a page can bear."""
    if not isinstance(machined.stock, Stock):
        raise UsageError("the page shows stock on three axes only", hint="Leave --stock out.")
    count = max(machined.stock.heights.shape)
    several = max(1, -(-count // MOST_ACROSS))
    while True:
        film = _film(machined, several)
        if film is not None:
            return film
        several *= 2


def _film(machined: Machined, several: int) -> Film | None:
    """Cut the body once more, step by step; None if that has more changes than a page can bear."""
    course, tools = machined.course, machined.rotating
    stock = machined.form.body(course, tools)
    cutting, grid = Cutting(stock, tools), stock.grid
    level = max(stock.box.high[2] - grid.bottom, 1e-9) / _LEVELS
    ny, nx = (-(-size // several) for size in grid.z.shape)

    def levels(y: slice, x: slice) -> Heights:
        """Return the mean levels of some cells of the film."""
        part = grid.z[y.start * several : y.stop * several, x.start * several : x.stop * several]
        high, wide = y.stop - y.start, x.stop - x.start
        short = ((0, high * several - part.shape[0]), (0, wide * several - part.shape[1]))
        cells = np.pad(part, short, mode="edge").reshape(high, several, wide, several)
        found: Heights = np.rint((cells.mean(axis=(1, 3)) - grid.bottom) / level).astype(np.uint16)
        return found

    begin = levels(slice(0, ny), slice(0, nx))
    field = begin.copy()
    reach = max((tool.radius_mm for tool in tools.values()), default=0.0) + 2.0 * several * grid.cell_mm
    step_s = max(float(course.t_s[-1]) / _STEPS, 1e-3) if len(course.t_s) else 1.0
    bounds = np.flatnonzero(np.diff(np.floor(course.t_s / step_s), prepend=-1.0, append=np.inf))
    ends, counts, all_cells, all_levels = [], [], [], []
    width = several * grid.cell_mm
    total = 0
    for first, last in zip(bounds[:-1].tolist(), bounds[1:].tolist(), strict=True):
        cutting.add(course.at(np.arange(first, last)))
        tips = course.tip[max(first - 1, 0) : last]
        low, high = tips[:, :2].min(axis=0) - reach, tips[:, :2].max(axis=0) + reach
        x = slice(
            *(np.clip([(low[0] - grid.x0) // width, (high[0] - grid.x0) // width + 1], 0, nx).astype(int))
        )
        y = slice(
            *(np.clip([(low[1] - grid.y0) // width, (high[1] - grid.y0) // width + 1], 0, ny).astype(int))
        )
        if x.stop <= x.start or y.stop <= y.start:
            continue
        now = levels(y, x)
        rows, columns = np.nonzero(now != field[y, x])
        if not len(rows):
            continue
        field[y, x] = now
        ends.append(float(course.t_s[last - 1]))
        counts.append(len(rows))
        all_cells.append(((rows + y.start) * nx + columns + x.start).astype(np.int32))
        all_levels.append(now[rows, columns])
        total += len(rows)
        if total > MOST_CHANGES:
            return None
    middle = 0.5 * (several - 1) * grid.cell_mm
    return Film(
        (grid.x0 + middle, grid.y0 + middle),
        width,
        grid.bottom,
        level,
        begin,
        np.array(ends, np.float64),
        np.array(counts, np.int32),
        np.concatenate([np.zeros(0, np.int32), *all_cells]),
        np.concatenate([np.zeros(0, np.uint16), *all_levels]),
    )
