"""The surface of a body as triangles, and as a file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from polycnc.outputs import complete_or_absent
from polycnc.stock._mesh_files import stl, write_mesh
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
            partial.write_bytes(stl(self.vertices, self.faces))


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
    at = np.arange(count).reshape(ny, nx)
    a, b, c, d = at[:-1, :-1].ravel(), at[:-1, 1:].ravel(), at[1:, 1:].ravel(), at[1:, :-1].ravel()
    upper = np.concatenate((np.column_stack((a, b, c)), np.column_stack((a, c, d))))
    solid = (top[upper, 2] > grid.bottom).any(axis=1)
    upper = upper[solid]
    lower = upper[:, ::-1] + count
    faces = np.concatenate((upper, lower))
    # Where the top lies on the bottom both share their corner, so that the surface is closed.
    same = np.arange(count)
    faces = np.concatenate((same, np.where(top[:, 2] > grid.bottom, same + count, same)))[faces]
    used, compact = np.unique(faces, return_inverse=True)
    vertices = np.concatenate((top, below))[used]
    return Mesh(vertices, compact.reshape(faces.shape).astype(np.int64))
