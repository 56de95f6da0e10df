"""Bodies that are watched while they are cut: which cells of a coarser picture have changed since."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Protocol

import numpy as np
import numpy.typing as npt

from polycnc.runner._machined import Machined
from polycnc.stock import (
    Removing,
    Rows,
    Stock,
    Tool,
    Turned,
    TurnedCutting,
    TurningCutting,
    Voxels,
)

Floats = npt.NDArray[np.float64]
Places = npt.NDArray[np.int32]
Levels = npt.NDArray[np.uint16]

MOST_ACROSS = 360
"""Cells along the longer side of a field."""
MOST_ALONG = 900
"""Cells along the axis of a turned body."""
MOST_THROUGH = 120
"""Cells along the longest side of a body that is cut from all sides."""
_HEIGHTS = 4095
_RADII = 65535
_SHARES = 4096  # shares of cells of 2, 4 or 8 points a side are whole


class Watched(Protocol):
    """What a film asks of a body: its cells at first, and those that have changed since it was asked last."""

    kind: str
    first_mm: tuple[float, float, float]
    cell_mm: float
    level: float
    begin: Levels

    def changes(self, course: Rows, first: int, last: int) -> tuple[Places, Levels]:
        """Return flat places and levels of cells that rows of a course have changed."""
        ...


def watched(machined: Machined, coarser: int) -> tuple[Watched, Callable[[int, int], None]]:
    """Return the body of a run as it was, in cells `coarser` times as wide as need be, and what cuts it again.

    That is called with the first row of the course and the one after the last.
    """
    form, course, tools = machined.form, machined.course, machined.rotating
    cutting: TurningCutting | TurnedCutting
    if isinstance(machined.stock, Turned):
        bar = form.turned_body(course)
        several = coarser * max(1, -(-len(bar.outer) // MOST_ALONG))
        cutting = TurningCutting(bar, machined.tools)
        return _WatchedBar(bar, several), lambda first, last: cutting.add(course.at(slice(first, last)))
    if isinstance(machined.stock, Voxels):
        whole = machined.stock
        longest = max(high - low for low, high in zip(whole.box.low, whole.box.high, strict=True))
        solid = replace(form, cell_mm=max(whole.cell_mm, longest / (2 * MOST_THROUGH))).voxels(course, tools)
        cutting = TurnedCutting(solid, tools)
        picture = _WatchedSolid(solid, 2 * coarser, tools)
        return picture, lambda first, last: cutting.add(course.at(slice(first, last)))
    was = machined.stock
    stock = Stock(was.box, was.cell_mm) if form.text == "auto" else form.body(course, tools)
    several = coarser * max(1, -(-max(stock.heights.shape) // MOST_ACROSS))
    removing = Removing(stock, tools, course)
    return _WatchedField(stock, several, tools), lambda _, last: removing.up_to(last - 1)


class _WatchedField:
    """Watch a field of heights; cells of the picture have the mean of those of the body."""

    kind = "field"

    def __init__(self, stock: Stock, several: int, tools: Mapping[int, Tool]) -> None:
        grid = stock.grid
        self._grid, self._several, self._top = grid, several, stock.box.high[2]
        self.cell_mm = several * grid.cell_mm
        self.level = max(stock.box.high[2] - grid.bottom, 1e-9) / _HEIGHTS
        middle = 0.5 * (several - 1) * grid.cell_mm
        self.first_mm = (grid.x0 + middle, grid.y0 + middle, grid.bottom)
        self._reach = max((tool.radius_mm for tool in tools.values()), default=0.0) + 2.0 * self.cell_mm
        ny, nx = (-(-size // several) for size in grid.z.shape)
        self.begin = self._levels(slice(0, ny), slice(0, nx))
        self._shown = self.begin.copy()

    def changes(self, course: Rows, first: int, last: int) -> tuple[Places, Levels]:
        """Return flat places and levels of cells that rows of a course have changed."""
        tips, (ny, nx) = course.tip[first:last], self._shown.shape
        low_x, low_y, low_z = tips.min(axis=0).tolist()
        high_x, high_y, _ = tips.max(axis=0).tolist()
        x0, y0, reach = self._grid.x0, self._grid.y0, self._reach
        x = _between(low_x - reach - x0, high_x + reach - x0, self.cell_mm, nx)
        y = _between(low_y - reach - y0, high_y + reach - y0, self.cell_mm, ny)
        if low_z >= self._top or x.stop <= x.start or y.stop <= y.start:
            return np.zeros(0, np.int32), np.zeros(0, np.uint16)
        now = self._levels(y, x)
        rows, columns = np.nonzero(now != self._shown[y, x])
        self._shown[y, x] = now
        return ((rows + y.start) * nx + columns + x.start).astype(np.int32), now[rows, columns]

    def _levels(self, y: slice, x: slice) -> Levels:
        """Return the mean levels of some cells of the picture."""
        n, grid = self._several, self._grid
        part = grid.z[y.start * n : y.stop * n, x.start * n : x.stop * n]
        high, wide = y.stop - y.start, x.stop - x.start
        short = ((0, high * n - part.shape[0]), (0, wide * n - part.shape[1]))
        if short[0][1] or short[1][1]:
            part = np.pad(part, short, mode="edge")
        if n > 1:  # NumPy's own mean is slow for a few numbers each
            lines = np.add.reduce([part[i::n] for i in range(n)])
            part = np.add.reduce([lines[:, i::n] for i in range(n)]) / (n * n)
        found: Levels = np.rint((part - grid.bottom) / self.level).astype(np.uint16)
        return found


class _WatchedBar:
    """Watch the radii of a turned body: outer ones, then inner ones."""

    kind = "turned"

    def __init__(self, bar: Turned, several: int) -> None:
        self._bar, self._several = bar, several
        self.cell_mm = several * bar.cell_mm
        self.level = bar.box.high[0] / _RADII
        self.first_mm = (0.0, 0.0, bar.first_z + 0.5 * (several - 1) * bar.cell_mm)
        self.begin = self._levels()
        self._shown = self.begin.copy()

    def changes(self, course: Rows, first: int, last: int) -> tuple[Places, Levels]:
        """Return flat places and levels of cells that have changed, wherever the rows of the course are."""
        now = self._levels()
        cells = np.flatnonzero(now != self._shown)
        self._shown = now
        return cells.astype(np.int32), now.ravel()[cells]

    def _levels(self) -> Levels:
        radii, n = np.stack((self._bar.outer, self._bar.inner)), self._several
        count = -(-radii.shape[1] // n)
        cells = np.pad(radii, ((0, 0), (0, count * n - radii.shape[1])), mode="edge").reshape(2, count, n)
        found: Levels = np.rint(cells.mean(axis=2) / self.level).astype(np.uint16)
        return found


class _WatchedSolid:
    """Watch a grid of cells: those of the picture have the share that is left in all of theirs."""

    kind = "solid"

    def __init__(self, solid: Voxels, several: int, tools: Mapping[int, Tool]) -> None:
        self._solid, self._several = solid, several
        self.cell_mm = several * solid.cell_mm
        self.level = 1.0 / _SHARES
        x, y, z = (solid.first + 0.5 * (several - 1) * solid.cell_mm).tolist()
        self.first_mm = (x, y, z)
        self._wide_mm = max((tool.radius_mm for tool in tools.values()), default=0.0)
        self._before = solid.cells.copy()
        self._left = self._sums(solid.cells)
        self._all = Voxels.FULL * self._sums(np.ones_like(solid.cells))
        self.begin = self._levels(np.arange(self._left.size)).reshape(self._left.shape)

    def changes(self, course: Rows, first: int, last: int) -> tuple[Places, Levels]:
        """Return flat places and levels of cells that rows of a course have changed."""
        axes = np.broadcast_to(course.axis, course.tip.shape)[first:last]
        part = self._solid.reached(course.tip[first:last], axes, self._wide_mm)
        now, before = self._solid.cells[part], self._before[part]
        gone = np.argwhere(now != before)
        if not len(gone):
            return np.zeros(0, np.int32), np.zeros(0, np.uint16)
        taken = before[tuple(gone.T)].astype(np.int64) - now[tuple(gone.T)]
        before[...] = now
        gone = (gone + [each.start for each in part]) // self._several
        flat = np.ravel_multi_index((gone[:, 0], gone[:, 1], gone[:, 2]), self._left.shape)
        cells = np.unique(flat)
        np.subtract.at(self._left.ravel(), flat, taken)
        return cells.astype(np.int32), self._levels(cells)

    def _sums(self, cells: npt.NDArray[np.uint8]) -> npt.NDArray[np.int64]:
        n = self._several
        counts = [-(-size // n) for size in cells.shape]
        short = [(0, count * n - size) for count, size in zip(counts, cells.shape, strict=True)]
        blocks = np.pad(cells, short).reshape(counts[0], n, counts[1], n, counts[2], n)
        found: npt.NDArray[np.int64] = blocks.sum(axis=(1, 3, 5), dtype=np.int64)
        return found

    def _levels(self, cells: npt.NDArray[np.int64]) -> Levels:
        shares = self._left.ravel()[cells] / self._all.ravel()[cells]
        return np.rint(shares * _SHARES).astype(np.uint16)


def _between(low: float, high: float, cell_mm: float, count: int) -> slice:
    """Return which of some cells are between two places, counted from the middle of the first."""
    first, last = (min(max(int(each // cell_mm), -1), count) for each in (low, high))
    return slice(max(first, 0), min(last + 1, count))
