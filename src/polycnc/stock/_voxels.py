"""A body as a grid of cells that are full, in part or empty, for tools that come from any side."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from polycnc.errors import UsageError
from polycnc.stock._mesh import Mesh
from polycnc.stock._stock import Box, Stock, check_cell
from polycnc.stock._voxel_mesh import surface_of
from polycnc.stock._voxel_sweep import FULL

Floats = npt.NDArray[np.float64]

MOST_VOXELS = 200_000_000
"""Of a body: as many bytes."""


class Voxels:
    """Hold what is left of a body: `cells` [along z, y, x] are from 0, empty, to `FULL`, by the share that is in it.

    Raises:
        UsageError: a body without volume, or a grid that would need too much memory.
    """

    FULL = FULL

    def __init__(self, box: Box, cell_mm: float) -> None:
        sizes = [high - low for low, high in zip(box.low, box.high, strict=True)]
        if not all(size > 0.0 for size in sizes):
            raise UsageError(
                f"a {box} has no volume", hint="Give its lower corner first, then its upper one."
            )
        check_cell(cell_mm)
        counts = [max(1, math.ceil(size / cell_mm - 1e-6)) for size in sizes]
        if math.prod(counts) > MOST_VOXELS:
            enough = (math.prod(sizes) / MOST_VOXELS) ** (1.0 / 3.0)
            raise UsageError(
                f"a {box} at {cell_mm:g} mm has {math.prod(counts):,} cells",
                hint=f"Choose a resolution of {math.ceil(enough * 1000.0) / 1000.0:g} mm or more.",
            )
        self.box = box
        self.name = str(box)
        self.cell_mm = cell_mm
        self.first = np.array(
            [
                0.5 * (low + high - (count - 1) * cell_mm)
                for low, high, count in zip(box.low, box.high, counts, strict=True)
            ]
        )
        along_x, along_y, along_z = (
            _shares(count, size / cell_mm) for count, size in zip(counts, sizes, strict=True)
        )
        self.cells = np.empty(counts[::-1], np.uint8)
        for layer, share in zip(self.cells, along_z, strict=True):
            layer[...] = np.rint(FULL * share * along_y[:, None] * along_x)

    @classmethod
    def cylinder(cls, diameter_mm: float, low_z: float, high_z: float, cell_mm: float) -> Voxels:
        """Return an upright cylinder about the origin of x and y.

        Raises:
            UsageError: no volume, or too many cells.
        """
        radius = 0.5 * diameter_mm
        found = cls(Box((-radius, -radius, low_z), (radius, radius, high_z)), cell_mm)
        x, y = (found.first[i] + cell_mm * np.arange(found.cells.shape[2 - i]) for i in range(2))
        share = np.clip(0.5 + (radius - np.hypot(x, y[:, None])) / cell_mm, 0.0, 1.0)
        for layer in found.cells:
            layer[...] = np.rint(layer.max() * share)
        found.name = f"cylinder of {diameter_mm:g} mm from Z{low_z:g} to Z{high_z:g}"
        return found

    @classmethod
    def of_heights(cls, stock: Stock, cell_mm: float) -> Voxels:
        """Return what is left of a body seen from above.

        Raises:
            UsageError: too many cells.
        """
        found = cls(stock.box, cell_mm)
        grid = stock.grid
        x, y = (
            np.rint((found.first[i] + cell_mm * np.arange(found.cells.shape[2 - i]) - first) / grid.cell_mm)
            .clip(0, grid.z.shape[1 - i] - 1)
            .astype(np.int64)
            for i, first in enumerate((grid.x0, grid.y0))
        )
        heights = grid.z[np.ix_(y, x)]
        for index, layer in enumerate(found.cells):
            low = max(found.first[2] + (index - 0.5) * cell_mm, grid.bottom)
            high = min(found.first[2] + (index + 0.5) * cell_mm, stock.box.high[2])
            layer[...] = np.rint(layer * np.clip((heights - low) / (high - low), 0.0, 1.0))
        found.name = str(stock)
        return found

    def copy(self) -> Voxels:
        """Return a body of its own that is equal."""
        other = Voxels.__new__(Voxels)
        other.box, other.name, other.cell_mm, other.first = self.box, self.name, self.cell_mm, self.first
        other.cells = self.cells.copy()
        return other

    def __str__(self) -> str:
        return self.name

    @property
    def volume_mm3(self) -> float:
        """What is left."""
        return float(self.cells.sum(dtype=np.int64)) / FULL * self.cell_mm**3

    def holds(self, x: float, y: float, z: float) -> bool:
        """Return whether there is material at a place."""
        at = np.rint((np.array([x, y, z]) - self.first) / self.cell_mm).astype(np.int64)
        if np.any(at < 0) or np.any(at >= self.cells.shape[::-1]):
            return False
        return 2 * int(self.cells[at[2], at[1], at[0]]) > FULL

    def reached(self, tips: Floats, axes: Floats, radius_mm: float) -> tuple[slice, slice, slice]:
        """Return the cells, along z, y and x, that a tool as long as the body is near to on its way.

        `tips` and `axes` [rows, 3] are its ends and directions, upwards.
        """
        long_mm = float(np.linalg.norm(np.subtract(self.box.high, self.box.low)))
        ends = np.concatenate((tips, tips + long_mm * axes)) - self.first
        wide_mm = radius_mm + self.cell_mm
        low, high = (
            (ends.min(axis=0) - wide_mm) // self.cell_mm,
            (ends.max(axis=0) + wide_mm) // self.cell_mm + 1,
        )
        sizes = np.array(self.cells.shape[::-1])
        x, y, z = (
            slice(*each)
            for each in zip(
                np.clip(low, 0, sizes).astype(int).tolist(),
                np.clip(high, 0, sizes).astype(int).tolist(),
                strict=True,
            )
        )
        return z, y, x

    def mesh(self) -> Mesh:
        """Return the surface as triangles: where cells are half full between them."""
        return surface_of(self.cells, self.first, self.cell_mm)


def _shares(count: int, cells: float) -> Floats:
    """Return how much of each of `count` cells in a row is in a body that is `cells` of them long, in their middle."""
    found = np.ones(count)
    found[[0, -1]] = cells if count == 1 else 1.0 - 0.5 * (count - cells)
    return np.minimum(found, 1.0)
