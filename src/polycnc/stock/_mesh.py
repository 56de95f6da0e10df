"""The surface of a body as triangles, and as a file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from polycnc.outputs import complete_or_absent
from polycnc.stock._mesh_files import write_mesh, write_stl
from polycnc.stock._sweep import Grid


@dataclass(frozen=True, eq=False)
class Mesh:
    """Hold a closed surface: `vertices` [n, 3] (mm) and `faces` [m, 3], counter-clockwise seen from outside."""

    vertices: npt.NDArray[np.float64]
    faces: npt.NDArray[np.int64]

    @property
    def volume_mm3(self) -> float:
        """The volume inside."""
        a, b, c = (self.vertices[self.faces[:, corner]] for corner in range(3))
        return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0)

    def write(self, path: str | Path) -> None:
        """Write an .stl or .3mf file, whole or not at all.

        Raises:
            UsageError: another extension, or no such folder.
        """
        write_mesh(self.vertices, self.faces, path)

    def write_stl(self, path: str | Path) -> None:
        """Write a binary STL file, whole or not at all."""
        with complete_or_absent(Path(path)) as partial:
            write_stl(self.vertices, self.faces, partial)


def mesh(grid: Grid) -> Mesh:
    """Return the surface of a body: its heights at the corners of the cells' middles, walls and bottom.

    Cells without material are left out; a wall between two cells is as wide as a cell, the sides are upright.
    """
    x, y = grid.x, grid.y
    half = 0.5 * grid.cell_mm
    x = np.concatenate(([x[0] - half] * 2, x, [x[-1] + half] * 2))
    y = np.concatenate(([y[0] - half] * 2, y, [y[-1] + half] * 2))
    z = np.pad(np.pad(grid.z, 1, mode="edge"), 1, constant_values=grid.bottom)
    ny, nx = z.shape
    count = ny * nx
    columns, rows = np.meshgrid(x, y)
    top = np.column_stack((columns.ravel(), rows.ravel(), z.ravel()))
    below = top.copy()
    below[:, 2] = grid.bottom
    at = np.arange(count, dtype=np.int32).reshape(ny, nx)
    a, b, c, d = at[:-1, :-1].ravel(), at[:-1, 1:].ravel(), at[1:, 1:].ravel(), at[1:, :-1].ravel()
    is_solid = top[:, 2] > grid.bottom
    upper = np.concatenate((np.column_stack((a, b, c)), np.column_stack((a, c, d))))
    upper = upper[is_solid[upper].any(axis=1)]
    # Where the top lies on the bottom both share their corner, so that the surface is closed.
    used = np.zeros(2 * count, np.bool_)
    used[upper] = True
    used[count:] = used[:count] & is_solid
    compact = np.cumsum(used, dtype=np.int32) - 1
    under = np.where(is_solid, compact[count:], compact[:count])
    faces = np.concatenate((compact[upper], under[upper[:, ::-1]]), dtype=np.int64)
    return Mesh(np.concatenate((top[used[:count]], below[used[count:]])), faces)
