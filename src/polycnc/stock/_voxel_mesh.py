"""The surface of a body of cells that are full, in part or empty."""

from __future__ import annotations

from itertools import product

import numpy as np
import numpy.typing as npt

from polycnc.stock._mesh import Mesh
from polycnc.stock._voxel_sweep import FULL

_HALF = 0.5 * FULL
_CORNERS = list(product((0, 1), repeat=3))
_EDGES = [
    (a, b)
    for a, b in product(_CORNERS, _CORNERS)
    if sum(b) == sum(a) + 1 and all(i <= j for i, j in zip(a, b, strict=True))
]


def surface_of(cells: npt.NDArray[np.uint8], first: npt.NDArray[np.float64], cell_mm: float) -> Mesh:
    """Return the closed surface where cells [along z, y, x] are half full.

    In each cube between the middles of eight cells it has a corner, at the mean of where it goes through the edges of
    the cube; four corners around an edge between a cell and the next are joined.
    """
    padded = np.pad(cells, 1)
    full = padded > _HALF
    shape = np.array(full.shape) - 1
    count = np.zeros(tuple(shape), np.uint8)
    for corner in _CORNERS:
        count += _part(full, corner)
    cubes = np.argwhere((count > 0) & (count < len(_CORNERS)))
    del count
    values = {corner: padded[tuple((cubes + corner).T)].astype(np.float64) for corner in _CORNERS}
    crossings, met = np.zeros((len(cubes), 3)), np.zeros(len(cubes))
    for a, b in _EDGES:
        crosses = (values[a] > _HALF) != (values[b] > _HALF)
        rise = np.where(crosses, values[b] - values[a], 1.0)
        share = (_HALF - values[a]) / rise
        place = np.array(a) + share[:, None] * (np.array(b) - a)
        crossings += np.where(crosses[:, None], place, 0.0)
        met += crosses
    # Along z, y, x, counted from the middle of the padding before the first cell.
    vertices = (cubes + crossings / met[:, None])[:, ::-1]
    number = np.full(int(np.prod(shape)), -1, np.int32)
    number[np.ravel_multi_index(tuple(cubes.T), tuple(shape))] = np.arange(len(cubes), dtype=np.int32)
    quads = []
    for axis in range(3):
        change = np.diff(full.astype(np.int8), axis=axis)
        u, v = (np.eye(3, dtype=np.int64)[(axis + step) % 3] for step in (1, 2))
        for sign in (1, -1):
            at = np.argwhere(change == sign)
            around = [at, at - u, at - u - v, at - v]
            corners = [number[np.ravel_multi_index(tuple(each.T), tuple(shape))] for each in around]
            quads.append(np.stack(corners if sign == 1 else corners[::-1], axis=1))
    quad = np.concatenate(quads).astype(np.int64)
    faces = np.concatenate((quad[:, [0, 1, 2]], quad[:, [0, 2, 3]]))
    return Mesh(first + (vertices - 1.0) * cell_mm, faces)


def _part(full: npt.NDArray[np.bool_], corner: tuple[int, ...]) -> npt.NDArray[np.bool_]:
    z, y, x = (slice(at, at - 1 if at == 0 else None) for at in corner)
    return full[z, y, x]
