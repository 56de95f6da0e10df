"""A body of material seen from above: a height field on a bottom."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from polycnc.errors import UsageError
from polycnc.stock._mesh import Mesh, mesh
from polycnc.stock._sweep import Grid

Floats = npt.NDArray[np.float64]

MOST_CELLS = 64_000_000
"""Of a field: half a gigabyte."""
FARTHEST_MM = 1e6
"""That a corner of a body may be from zero."""
CELLS_MM = (1e-4, 1e4)
"""Narrowest and widest cell."""
_LEAST_ACROSS = 0.1


@dataclass(frozen=True, slots=True)
class Box:
    """A box between two corners (mm).

    Raises:
        UsageError: a corner farther away than any machine reaches.
    """

    low: tuple[float, float, float]
    high: tuple[float, float, float]

    def __post_init__(self) -> None:
        if not all(abs(place) <= FARTHEST_MM for place in (*self.low, *self.high)):
            raise UsageError(
                f"a body with a corner at {max((*self.low, *self.high), key=abs):g} mm",
                hint=f"Corners are at most {FARTHEST_MM:,.0f} mm from zero.",
            )

    @property
    def across_mm(self) -> float:
        """The side of a square as large as it is seen from above, and at least a tenth of its longer side."""
        wide, deep = self.high[0] - self.low[0], self.high[1] - self.low[1]
        return max(math.sqrt(max(0.0, wide * deep)), _LEAST_ACROSS * max(wide, deep))

    def __str__(self) -> str:
        size = " x ".join(f"{b - a:g}" for a, b in zip(self.low, self.high, strict=True))
        return f"box of {size} mm"


def fitted_cell(cell_mm: float, wide_mm: float, deep_mm: float) -> float:
    """Return the width of cells, at most `cell_mm`, of which both sides of a body hold a whole number, or nearly."""
    cell_mm = min(cell_mm, wide_mm, deep_mm)
    first = math.ceil(wide_mm / cell_mm - 1e-9)
    cells = np.append(cell_mm, wide_mm / np.arange(first, first + max(1, first // 10) + 1))
    beyond = sum(np.ceil(side / cells - 1e-9) * cells - side for side in (wide_mm, deep_mm))
    return float(cells[np.argmin(np.round(beyond / cells, 2))])


def check_cell(cell_mm: float) -> None:
    """Refuse a width that no cell has.

    Raises:
        UsageError: it is none.
    """
    least, most = CELLS_MM
    if not least <= cell_mm <= most:
        raise UsageError(f"a resolution of {cell_mm:g} mm", hint=f"Give {least:g} to {most:g} mm.")


class Stock:
    """Hold what is left of a body above its bottom: one height for each cell of a grid.

    `box` is what the field covers (mm), `cell_mm` the width of a cell, at most: one that fits the body is taken.
    Undercuts cannot be told.

    Raises:
        UsageError: a body without volume, or a grid that would need too much memory.
    """

    def __init__(self, box: Box, cell_mm: float) -> None:
        sizes = tuple(high - low for low, high in zip(box.low, box.high, strict=True))
        if not all(0.0 < size < math.inf for size in sizes):
            raise UsageError(
                f"a {box} has no volume", hint="Give its lower corner first, then its upper one."
            )
        check_cell(cell_mm)
        cell_mm = fitted_cell(cell_mm, *sizes[:2])
        counts = [max(1, math.ceil(size / cell_mm - 1e-9)) for size in sizes[:2]]
        if counts[0] * counts[1] > MOST_CELLS:
            enough = math.sqrt(sizes[0] * sizes[1] / MOST_CELLS)
            raise UsageError(
                f"a {box} at {cell_mm:g} mm has {counts[0] * counts[1]:,} cells "
                f"({counts[0] * counts[1] * 8 / 1e9:,.1f} GB)",
                hint=f"Choose a resolution of {math.ceil(enough * 1000.0) / 1000.0:g} mm or more.",
            )
        self.box = box
        x0, y0 = (
            0.5 * (low + high - (count - 1) * cell_mm)
            for low, high, count in zip(box.low, box.high, counts, strict=False)
        )
        heights = np.full((counts[1], counts[0]), float(box.high[2]))
        self.grid = Grid(float(x0), float(y0), float(cell_mm), float(box.low[2]), heights)

    @classmethod
    def cylinder(cls, diameter_mm: float, low_z: float, high_z: float, cell_mm: float) -> Stock:
        """Return an upright cylinder about the origin of x and y.

        Raises:
            UsageError: no volume, or too many cells.
        """
        radius = 0.5 * diameter_mm
        stock = cls(Box((-radius, -radius, low_z), (radius, radius, high_z)), cell_mm)
        x, y = stock.grid.x, stock.grid.y
        stock.grid.z[x**2 + y[:, None] ** 2 > radius**2] = low_z
        return stock

    def __str__(self) -> str:
        return str(self.box)

    @property
    def cell_mm(self) -> float:
        """The width of a cell."""
        return self.grid.cell_mm

    @property
    def heights(self) -> Floats:
        """The height of each cell, [along y, along x]; those without material have that of the bottom."""
        return self.grid.z

    @property
    def volume_mm3(self) -> float:
        """What is left."""
        return float(np.sum(self.grid.z - self.grid.bottom) * self.grid.cell_mm**2)

    def height(self, x: float, y: float) -> float:
        """Return the height of the cell at a place, that of the bottom outside."""
        grid = self.grid
        ix, iy = (
            round((x - grid.x0) / grid.cell_mm),
            round((y - grid.y0) / grid.cell_mm),
        )
        inside = 0 <= iy < grid.z.shape[0] and 0 <= ix < grid.z.shape[1]
        return float(grid.z[iy, ix]) if inside else grid.bottom

    def copy(self) -> Stock:
        """Return a body of its own that is equal."""
        other = Stock.__new__(Stock)
        other.box = self.box
        other.grid = self.grid._replace(z=self.grid.z.copy())
        return other

    def mesh(self) -> Mesh:
        """Return the surface as triangles."""
        return mesh(self.grid)
