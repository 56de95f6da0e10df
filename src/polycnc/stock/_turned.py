"""A turned body: an outer and an inner radius for each cell along its axis."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from polycnc.errors import UsageError
from polycnc.stock._chords import find_chords
from polycnc.stock._mesh import Mesh
from polycnc.stock._stock import MOST_CELLS, Box, check_cell

Floats = npt.NDArray[np.float64]

FACETS = 96
_MESH_MM = 0.002
"""How far the profile of a mesh may be from that of the cells."""


class Turned:
    """Hold what is left of a cylinder about Z: `outer` and `inner` [cells] are radii (mm); equal ones hold nothing.

    Raises:
        UsageError: a body without volume, or too many cells.
    """

    def __init__(self, diameter_mm: float, low_z: float, high_z: float, cell_mm: float) -> None:
        radius = 0.5 * diameter_mm
        self.box = Box((-radius, -radius, low_z), (radius, radius, high_z))
        if not (radius > 0.0 and high_z > low_z):
            raise UsageError(
                f"a cylinder of {diameter_mm:g} mm from {low_z:g} to {high_z:g} mm has no volume",
                hint="Give a diameter above 0, then its lower end, then its upper one.",
            )
        check_cell(cell_mm)
        count = max(1, math.ceil((high_z - low_z) / cell_mm - 1e-9))
        if count > MOST_CELLS:
            raise UsageError(
                f"a cylinder of {high_z - low_z:g} mm at {cell_mm:g} mm has {count:,} cells",
                hint=f"Choose a resolution of {(high_z - low_z) / MOST_CELLS:.2g} mm or more.",
            )
        self.cell_mm = (high_z - low_z) / count
        """The width of a cell: a whole number of them is in the body."""
        self.first_z = low_z + 0.5 * self.cell_mm
        self.outer = np.full(count, radius)
        self.inner = np.zeros(count)

    def __str__(self) -> str:
        low, high = self.box.low[2], self.box.high[2]
        return f"cylinder of {2.0 * self.box.high[0]:g} mm from Z{low:g} to Z{high:g}"

    @property
    def z(self) -> Floats:
        """The middles of the cells."""
        return self.first_z + self.cell_mm * np.arange(len(self.outer), dtype=np.float64)

    @property
    def volume_mm3(self) -> float:
        """What is left."""
        return float(np.pi * np.sum(self.outer**2 - self.inner**2) * self.cell_mm)

    def radii(self, z: float) -> tuple[float, float]:
        """Return outer and inner radius at a place along the axis; 0 outside of the body."""
        at = round((z - self.first_z) / self.cell_mm)
        if not 0 <= at < len(self.outer):
            return 0.0, 0.0
        return float(self.outer[at]), float(self.inner[at])

    def copy(self) -> Turned:
        """Return a body of its own that is equal."""
        other = Turned.__new__(Turned)
        other.box, other.cell_mm, other.first_z = self.box, self.cell_mm, self.first_z
        other.outer, other.inner = self.outer.copy(), self.inner.copy()
        return other

    def mesh(self) -> Mesh:
        """Return the surface as triangles: facets with the volume of the round body."""
        z, outer, inner = self._thinned()
        wider = math.sqrt(2.0 * math.pi / FACETS / math.sin(2.0 * math.pi / FACETS))
        # Around the profile: out along the outer radii, back along the inner ones.
        ring_z = np.concatenate((z, z[::-1]))
        ring_r = np.concatenate((outer, inner[::-1])) * wider
        angle = np.linspace(0.0, 2.0 * np.pi, FACETS, endpoint=False)
        count = len(ring_z)
        vertices = np.column_stack(
            (
                (ring_r[:, None] * np.cos(angle)).ravel(),
                (ring_r[:, None] * np.sin(angle)).ravel(),
                np.repeat(ring_z, FACETS),
            )
        )
        ring, facet = (
            each.ravel() for each in np.meshgrid(np.arange(count), np.arange(FACETS), indexing="ij")
        )
        further, beside = (ring + 1) % count, (facet + 1) % FACETS
        a, b = ring * FACETS + facet, ring * FACETS + beside
        c, d = further * FACETS + beside, further * FACETS + facet
        faces = np.concatenate((np.column_stack((a, b, c)), np.column_stack((a, c, d))))
        # Corners at the same place are one, and what has no area is left out.
        vertices, same = np.unique(vertices, axis=0, return_inverse=True)
        faces = same.reshape(-1)[faces]
        i, j, k = faces.T
        return Mesh(vertices, faces[(i != j) & (j != k) & (i != k)].astype(np.int64))

    def _thinned(self) -> tuple[Floats, Floats, Floats]:
        """Return places along the axis with their radii, as few as stay close to all of them; the ends included."""
        low, high = self.box.low[2], self.box.high[2]
        z = np.concatenate(([low], self.z, [high]))
        outer = np.concatenate((self.outer[:1], self.outer, self.outer[-1:]))
        inner = np.concatenate((self.inner[:1], self.inner, self.inner[-1:]))
        profile = np.ascontiguousarray(np.column_stack((outer, inner, z)))
        ends = np.zeros(len(z), np.int64)
        count = find_chords(profile, np.zeros(len(z), np.int64), _MESH_MM, ends)
        kept = np.concatenate(([0], ends[:count]))
        return z[kept], outer[kept], inner[kept]
