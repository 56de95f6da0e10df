"""What is to come out where axes turn: where leaning tools cut into it, and what they leave on it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt

from polycnc.stock._leaning_surface import reach_behind_leaning
from polycnc.stock._solid import check_closed, draw_cells, read_stl
from polycnc.stock._sweep import Grid
from polycnc.stock._target import TargetComparison, check_tolerance, points_by_cell
from polycnc.stock._voxels import Voxels

Floats = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]


class SolidTarget:
    """Hold what is to come out of a body of cells, from an STL file in the same coordinates, seen from any side.

    Raises:
        UsageError: no such file, no closed surface, or too fine.
    """

    def __init__(self, path: Path, body: Voxels, tolerance_mm: float) -> None:
        check_tolerance(tolerance_mm)
        surface = read_stl(path)
        check_closed(path, surface)
        self.tolerance_mm = tolerance_mm
        triangles = np.ascontiguousarray(surface.vertices[surface.faces])
        self._cells = body.copy()
        draw_cells(triangles, self._cells)
        x0, y0, z0 = body.first.tolist()
        self._grid = Grid(x0, y0, body.cell_mm, z0, np.zeros(body.cells.shape[1:]))
        self._points, self._starts = points_by_cell(
            path, triangles, self._grid, tolerance_mm, from_below=True
        )

    def gouges(self, places: Floats, axes: Floats, cutter: Floats, height_mm: float, figures: Floats) -> None:
        """Write how deep a tool cuts into the target on each way, and where, into `figures` [ways, 7]."""
        grid = self._grid
        reach_behind_leaning(
            self._points,
            self._starts,
            grid.x0,
            grid.y0,
            grid.cell_mm,
            self.tolerance_mm,
            places,
            axes,
            cutter,
            height_mm,
            figures,
        )

    def compare(self, body: Voxels) -> TargetComparison:
        """Return how a body differs from the target; the highest of what is left is how thick it is."""
        wanted, found = self._cells.cells, body.cells
        rest = _apart(found, wanted)
        thick = _thickness(rest)
        at = np.unravel_index(int(np.argmax(thick)), thick.shape)
        x, y, z = (body.first + body.cell_mm * np.array(at[::-1])).tolist()
        return TargetComparison(
            self.tolerance_mm,
            _volume(wanted, found, _apart(wanted, found)) * body.cell_mm**3,
            _volume(found, wanted, rest) * body.cell_mm**3,
            float(thick[at]) * body.cell_mm,
            (x, y, z) if thick[at] > 0 else None,
        )


def _apart(more: npt.NDArray[np.uint8], less: npt.NDArray[np.uint8]) -> Flags:
    """Return where one body is and the other is not, not even a cell beside."""
    return (more > _spread(less)) & (more - np.minimum(_spread(less), more) > Voxels.FULL // 2)


def _volume(more: npt.NDArray[np.uint8], less: npt.NDArray[np.uint8], apart: Flags) -> float:
    """Return how many cells one body has more than the other, where they are apart and a cell around."""
    near = _spread(apart.astype(np.uint8)) > 0
    return float((more[near] - np.minimum(more[near], less[near])).sum(dtype=np.int64)) / Voxels.FULL


def _spread(cells: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint8]:
    """Return the greatest of each cell and its neighbours."""
    for axis in range(3):
        wide = cells.copy()
        first, last = [slice(None)] * 3, [slice(None)] * 3
        first[axis], last[axis] = slice(1, None), slice(None, -1)
        np.maximum(wide[tuple(first)], cells[tuple(last)], out=wide[tuple(first)])
        np.maximum(wide[tuple(last)], cells[tuple(first)], out=wide[tuple(last)])
        cells = wide
    return cells


def _thickness(flags: Flags) -> npt.NDArray[np.int32]:
    """Return for each cell of flags how many are in a row through it, along the axis where that is least."""
    found = np.zeros(flags.shape, np.int32)
    found[flags] = np.iinfo(np.int32).max
    for axis in range(3):
        rows = np.moveaxis(flags, axis, -1)
        padded = np.pad(rows, [(0, 0), (0, 0), (1, 1)]).astype(np.int8)
        edges = np.flatnonzero(np.diff(padded.ravel()))
        lengths = edges[1::2] - edges[::2]
        along = np.zeros(rows.shape, np.int32)
        along[rows] = np.repeat(lengths, lengths)
        found = np.minimum(found, np.moveaxis(along, -1, axis))
    return found
