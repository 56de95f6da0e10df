"""What is to come out: where tools cut into it, and what they leave on it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from polycnc.errors import UsageError
from polycnc.stock._contacts import Place
from polycnc.stock._solid import check_closed, draw, read_stl
from polycnc.stock._stock import Stock
from polycnc.stock._surface import reach_behind, sample
from polycnc.stock._sweep import Grid

Floats = npt.NDArray[np.float64]

TOLERANCE_MM = 0.02
"""How far a part may differ from its target where that is not said."""
TOLERANCES_MM = (0.001, 10.0)
MOST_POINTS = 8_000_000


@dataclass(frozen=True, slots=True)
class TargetComparison:
    """Say how a body differs from its target: volumes (mm3) cut too deep and left, and the highest of what is left.

    What differs by no more than `tolerance_mm`, or by a cell sideways, does not count.
    """

    tolerance_mm: float
    gouge_mm3: float
    rest_mm3: float
    rest_mm: float
    rest_place: Place | None

    def __str__(self) -> str:
        if self.rest_place is None:
            return "nothing is left on the target"
        place = " ".join(f"{name}{value:.3f}" for name, value in zip("XYZ", self.rest_place, strict=True))
        return f"{self.rest_mm3:.3f} mm3 are left on the target, up to {self.rest_mm:.3f} mm at {place}"


def check_tolerance(tolerance_mm: float) -> None:
    """Refuse a tolerance that no comparison has.

    Raises:
        UsageError: it is none.
    """
    least, most = TOLERANCES_MM
    if not least <= tolerance_mm <= most:
        raise UsageError(f"a tolerance of {tolerance_mm:g} mm", hint=f"Give {least:g} to {most:g} mm.")


class Target:
    """Hold what is to come out of a stock, from an STL file in the same coordinates: seen from above.

    Raises:
        UsageError: no such file, no closed surface, or too fine.
    """

    def __init__(self, path: Path, stock: Stock, tolerance_mm: float = TOLERANCE_MM) -> None:
        check_tolerance(tolerance_mm)
        surface = read_stl(path)
        check_closed(path, surface)
        self.tolerance_mm = tolerance_mm
        triangles = np.ascontiguousarray(surface.vertices[surface.faces])
        self._grid = stock.grid._replace(z=np.full_like(stock.grid.z, stock.grid.bottom))
        draw(triangles, self._grid.x0, self._grid.y0, self._grid.cell_mm, self._grid.z)
        self._points, self._starts = points_by_cell(path, triangles, self._grid, tolerance_mm)

    def gouges(self, places: Floats, cutter: Floats, figures: Floats) -> None:
        """Write how deep a tool cuts into the target on each way, and where, into `figures` [ways, 6]."""
        grid = self._grid
        reach_behind(
            self._points,
            self._starts,
            grid.x0,
            grid.y0,
            grid.cell_mm,
            self.tolerance_mm,
            places,
            cutter,
            figures,
        )

    def compare(self, stock: Stock) -> TargetComparison:
        """Return how a body differs from the target."""
        wanted, found, cell = self._grid.z, stock.heights, stock.cell_mm
        low, high = _around(wanted, np.minimum), _around(wanted, np.maximum)
        gouge = np.where(low - found > self.tolerance_mm, wanted - found, 0.0)
        rest = np.where(found - high > self.tolerance_mm, found - wanted, 0.0)
        iy, ix = np.unravel_index(int(np.argmax(rest)), rest.shape)
        most = float(rest[iy, ix])
        place = float(stock.grid.x[ix]), float(stock.grid.y[iy]), float(found[iy, ix])
        return TargetComparison(
            self.tolerance_mm,
            float(gouge.sum()) * cell**2,
            float(rest.sum()) * cell**2,
            most,
            place if most > 0.0 else None,
        )


def _around(heights: Floats, pick: np.ufunc) -> Floats:
    """Return the lowest or highest of each cell and its neighbours."""
    wide = np.pad(heights, 1, mode="edge")
    across = pick(pick(wide[:, :-2], wide[:, 1:-1]), wide[:, 2:])
    found: Floats = pick(pick(across[:-2], across[1:-1]), across[2:])
    return found


def points_by_cell(
    path: Path, triangles: Floats, grid: Grid, tolerance_mm: float, *, from_below: bool = False
) -> tuple[Floats, npt.NDArray[np.int64]]:
    """Return points of a surface a cell apart in the order of a grid's cells, and where those of each cell begin.

    Raises:
        UsageError: there are too many.
    """
    count = sample(triangles, grid.cell_mm, tolerance_mm, np.zeros((0, 6)), from_below)
    if count > MOST_POINTS:
        raise UsageError(
            f"the surface in '{path}' has {count:,} points {grid.cell_mm:g} mm apart",
            hint=f"At most {MOST_POINTS:,} are looked at: choose a coarser resolution.",
        )
    points = np.zeros((count, 6))
    sample(triangles, grid.cell_mm, tolerance_mm, points, from_below)
    return _by_cell(points, grid)


def _by_cell(points: Floats, grid: Grid) -> tuple[Floats, npt.NDArray[np.int64]]:
    """Return the points within a grid in the order of its cells, and where those of each cell begin."""
    ny, nx = grid.z.shape
    ix = np.rint((points[:, 0] - grid.x0) / grid.cell_mm).astype(np.int64)
    iy = np.rint((points[:, 1] - grid.y0) / grid.cell_mm).astype(np.int64)
    inside = (ix >= 0) & (ix < nx) & (iy >= 0) & (iy < ny)
    cell = iy[inside] * nx + ix[inside]
    order = np.argsort(cell, kind="stable")
    first = np.searchsorted(cell[order], np.arange(ny * nx + 1)).astype(np.int64)
    starts = np.column_stack((first[:-1].reshape(ny, nx), first[nx::nx]))
    return np.ascontiguousarray(points[inside][order]), np.ascontiguousarray(starts)
