"""A body as a grid of points in it, for tools that come from any side."""

from __future__ import annotations

import math

import numpy as np

from polycnc.errors import UsageError
from polycnc.stock._mesh import Mesh
from polycnc.stock._stock import Box, check_cell

MOST_VOXELS = 200_000_000
"""Of a body: as many bytes."""


class Voxels:
    """Hold what is left of a body: `cells` [along z, y, x] are 1 where the middle of a cell is in it.

    Raises:
        UsageError: a body without volume, or a grid that would need too much memory.
    """

    def __init__(self, box: Box, cell_mm: float) -> None:
        sizes = [high - low for low, high in zip(box.low, box.high, strict=True)]
        if not all(size > 0.0 for size in sizes):
            raise UsageError(
                f"a {box} has no volume", hint="Give its lower corner first, then its upper one."
            )
        check_cell(cell_mm)
        counts = [max(1, round(size / cell_mm)) for size in sizes]
        if math.prod(counts) > MOST_VOXELS:
            enough = (math.prod(sizes) / MOST_VOXELS) ** (1.0 / 3.0)
            raise UsageError(
                f"a {box} at {cell_mm:g} mm has {math.prod(counts):,} cells",
                hint=f"Choose a resolution of {math.ceil(enough * 1000.0) / 1000.0:g} mm or more.",
            )
        self.box = box
        self.cell_mm = cell_mm
        self.first = np.array(
            [
                0.5 * (low + high - (count - 1) * cell_mm)
                for low, high, count in zip(box.low, box.high, counts, strict=True)
            ]
        )
        self.cells = np.ones(counts[::-1], np.uint8)

    @classmethod
    def cylinder(cls, diameter_mm: float, low_z: float, high_z: float, cell_mm: float) -> Voxels:
        """Return an upright cylinder about the origin of x and y.

        Raises:
            UsageError: no volume, or too many cells.
        """
        radius = 0.5 * diameter_mm
        found = cls(Box((-radius, -radius, low_z), (radius, radius, high_z)), cell_mm)
        x, y = (found.first[i] + cell_mm * np.arange(found.cells.shape[2 - i]) for i in range(2))
        found.cells[:, x**2 + y[:, None] ** 2 > radius**2] = 0
        return found

    def __str__(self) -> str:
        return str(self.box)

    @property
    def volume_mm3(self) -> float:
        """What is left."""
        return float(np.count_nonzero(self.cells)) * self.cell_mm**3

    def holds(self, x: float, y: float, z: float) -> bool:
        """Return whether there is material at a place."""
        at = np.rint((np.array([x, y, z]) - self.first) / self.cell_mm).astype(np.int64)
        if np.any(at < 0) or np.any(at >= self.cells.shape[::-1]):
            return False
        return bool(self.cells[at[2], at[1], at[0]])

    def mesh(self) -> Mesh:
        """Return the surface as triangles: the sides of cells."""
        full = np.pad(self.cells, 1).astype(np.int8)
        corners, quads = np.array(full.shape) + 1, []
        for axis in range(3):
            change = np.diff(full, axis=axis)
            for sign in (1, -1):
                at = np.argwhere(change == sign)  # of the corner before the side, along z, y, x
                at[:, axis] += 1
                along = [np.eye(3, dtype=np.int64)[(axis + step) % 3] for step in (1, 2)]
                around = [at, at + along[0], at + along[0] + along[1], at + along[1]]
                # The order of axes is z, y, x: it turns the other way around.
                quads.append(np.stack(around if sign == 1 else around[::-1], axis=1))
        places = np.concatenate(quads).reshape(-1, 3)
        flat, same = np.unique(np.ravel_multi_index(tuple(places.T), tuple(corners)), return_inverse=True)
        index = np.stack(np.unravel_index(flat, tuple(corners)), axis=1)[:, ::-1]
        quad = same.reshape(-1, 4)
        faces = np.concatenate((quad[:, [0, 1, 2]], quad[:, [0, 2, 3]])).astype(np.int64)
        return Mesh(self.first + (index - 1.5) * self.cell_mm, faces)
