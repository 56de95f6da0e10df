"""Move a tool with a turning axis through a grid of cells: what gets into it is removed, at its surface in part.

Between two rows of a record the tool is set down so often that no point of it goes farther than a share of a cell.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from polycnc.kernel import compiled, entry
from polycnc.stock._lowest import level
from polycnc.stock._profile import ARC_R, BEGIN_Z, CENTRE_R, CENTRE_Z, FROM_R, SLOPE, TO_R
from polycnc.stock._sweep import AT_X, AT_Y, DEPTH_MM, VOLUME_MM3

Floats = npt.NDArray[np.float64]
Cells = npt.NDArray[np.uint8]

AT_Z = AT_Y + 1
VOXEL_FIGURES = AT_Z + 1
FULL = 250
"""What a cell holds that is full of material."""
_STEP_CELLS = 0.5
_EVEN = 1e-12


@compiled
def _square_to(r: float, z: float, r0: float, z0: float, r1: float, z1: float) -> float:
    """Return the square of the way from a place to a line between two others."""
    along_r, along_z = r1 - r0, z1 - z0
    length2 = along_r * along_r + along_z * along_z
    share = 0.0
    if length2 > 0.0:
        share = min(max(((r - r0) * along_r + (z - z0) * along_z) / length2, 0.0), 1.0)
    return (r0 + share * along_r - r) ** 2 + (z0 + share * along_z - z) ** 2


@compiled
def _square_to_outline(rows: Floats, r: float, z: float, last_z: float) -> float:
    """Return the square of the way to an outline, with walls between its pieces and up to `last_z`."""
    found, end = math.inf, math.inf
    for n in range(rows.shape[0]):
        r0, r1 = rows[n, FROM_R], rows[n, TO_R]
        if rows[n, ARC_R] > 0.0:
            begin, after = rows[n, CENTRE_Z] - rows[n, ARC_R], rows[n, CENTRE_Z]
            if r >= rows[n, CENTRE_R] and z <= rows[n, CENTRE_Z]:
                away = math.hypot(r - rows[n, CENTRE_R], z - rows[n, CENTRE_Z]) - rows[n, ARC_R]
                found = min(found, away * away)
        else:
            begin = rows[n, BEGIN_Z]
            after = begin + rows[n, SLOPE] * (r1 - r0)
            if begin < math.inf:
                found = min(found, _square_to(r, z, r0, begin, r1, after))
        if end < math.inf and begin < math.inf:
            found = min(found, _square_to(r, z, r0, end, r0, begin))
        end = after if begin < math.inf else math.inf
    wide = rows[rows.shape[0] - 1, TO_R]
    return float(min(found, _square_to(r, z, wide, end, wide, last_z)))


@compiled
def _outside(rows: Floats, tops: Floats, height: float, r: float, z: float) -> float:
    """Return how far a place is outside of a tool (mm), below zero in it, at `r` from its axis and `z` up."""
    wide = rows[rows.shape[0] - 1, TO_R]
    inside = r <= wide and 0.0 <= z <= height and z >= level(rows, r)
    last = height
    if tops.shape[0] > 0:
        at = tops.shape[0] - 1
        inside = inside and z <= level(tops, r)
        last = tops[at, BEGIN_Z] + tops[at, SLOPE] * (tops[at, TO_R] - tops[at, FROM_R])
    found = _square_to_outline(rows, r, z, last)
    if tops.shape[0] > 0:
        found = min(found, _square_to_outline(tops, r, z, last))
        wide = tops[0, TO_R]
    found = math.sqrt(min(found, _square_to(r, z, 0.0, height, wide, height)))
    return float(-found if inside else found)


@compiled
def _remove(
    cells: Cells,
    first: Floats,
    cell_mm: float,
    tip: Floats,
    axis: Floats,
    rows: Floats,
    tops: Floats,
    figures: Floats,
    cuts: bool,
    begin: npt.NDArray[np.int64],
    last: npt.NDArray[np.int64],
    end: Floats,
) -> None:
    """Look at, or take from cells, what is in a tool: `figures` [8] has the tool's height last.

    `begin` and `last` [3] are room for places, `end` [6] is tip and axis at the end of the way. What is left of a cell
    is by how far its middle is from the surface of the tool.
    """
    around = 0.5 * cell_mm
    radius, height = rows[rows.shape[0] - 1, TO_R] + around, figures[VOXEL_FIGURES]
    for i in range(3):
        reach = radius * math.sqrt(max(0.0, 1.0 - axis[i] * axis[i])) + around * abs(axis[i])
        top = tip[i] + height * axis[i]
        begin[i] = max(0, math.ceil((min(tip[i], top) - reach - first[i]) / cell_mm))
        last[i] = min(cells.shape[2 - i] - 1, math.floor((max(tip[i], top) + reach - first[i]) / cell_mm))
    square = 1.0 - axis[0] * axis[0]
    for iz in range(begin[2], last[2] + 1):
        dz = first[2] + iz * cell_mm - tip[2]
        for iy in range(begin[1], last[1] + 1):
            dy = first[1] + iy * cell_mm - tip[1]
            up = axis[1] * dy + axis[2] * dz
            up_end = (first[1] + iy * cell_mm - end[1]) * end[4] + (first[2] + iz * cell_mm - end[2]) * end[5]
            rest = dy * dy + dz * dz - up * up - radius * radius
            first_x, last_x = begin[0], last[0]
            if square > _EVEN:  # where a line along X is within the radius of the axis
                half = axis[0] * up / square
                root2 = half * half - rest / square
                if root2 < 0.0:
                    continue
                root = math.sqrt(root2)
                first_x = max(first_x, math.ceil((tip[0] + half - root - first[0]) / cell_mm))
                last_x = min(last_x, math.floor((tip[0] + half + root - first[0]) / cell_mm))
            elif rest > 0.0:
                continue
            for ix in range(first_x, last_x + 1):
                before, dx = int(cells[iz, iy, ix]), first[0] + ix * cell_mm - tip[0]
                along = axis[0] * dx + up
                if before == 0 or along < -around or along > height + around:
                    continue
                beside2 = dx * dx + dy * dy + dz * dz - along * along
                outside = _outside(rows, tops, height, math.sqrt(max(0.0, beside2)), along)
                left = max(0, math.floor(FULL * (0.5 + outside / cell_mm) + 0.5))
                if left >= before:
                    continue
                figures[VOLUME_MM3] += (before - left) / FULL
                if outside <= 0.0 and 2 * before > FULL:
                    depth = max(along, (first[0] + ix * cell_mm - end[0]) * end[3] + up_end)
                    if depth > figures[DEPTH_MM]:
                        figures[DEPTH_MM] = depth
                        figures[AT_X], figures[AT_Y], figures[AT_Z] = tip[0] + dx, tip[1] + dy, tip[2] + dz
                if cuts:
                    cells[iz, iy, ix] = left


@entry(steps=lambda cells, first, cell_mm, tips, *_: 2000 * len(tips))
def sweep_voxels(
    cells: Cells,
    first: Floats,
    cell_mm: float,
    tips: Floats,
    axes: Floats,
    rows: Floats,
    tops: Floats,
    from_mm: float,
    height_mm: float,
    cuts: bool,
    figures: Floats,
) -> None:
    """Move a tool from each of `tips` [n + 1, 3] to the next, with its axis [n + 1, 3], upwards, turning along.

    `cells` [along z, y, x] are up to `FULL` where there is material around `first + place * cell_mm`. The tool has the
    outline `rows`, from `from_mm` above its tip, and is `height_mm` high; `tops` is where it ends above, empty where
    that is nowhere. `figures` [n, 7] get volume, how far up the tool it met something, seen from the end of the way
    too, and where that was.
    """
    tip, axis, found = np.empty(3), np.empty(3), np.zeros(VOXEL_FIGURES + 1)
    begin, last, end = np.zeros(3, np.int64), np.zeros(3, np.int64), np.zeros(6)
    for n in range(tips.shape[0] - 1):
        far = 0.0
        for i in range(3):
            end[i], end[3 + i] = tips[n + 1, i], axes[n + 1, i]
        for top in range(2):
            moved = 0.0
            for i in range(3):
                step = tips[n + 1, i] - tips[n, i] + top * height_mm * (axes[n + 1, i] - axes[n, i])
                moved += step * step
            far = max(far, math.sqrt(moved))
        steps = max(1, math.ceil(far / (_STEP_CELLS * cell_mm)))
        found[:] = 0.0
        found[VOXEL_FIGURES] = height_mm
        for step in range(steps + 1):
            share = step / steps
            length = 0.0
            for i in range(3):
                axis[i] = axes[n, i] + share * (axes[n + 1, i] - axes[n, i])
                length += axis[i] * axis[i]
            length = math.sqrt(length)
            for i in range(3):
                axis[i] /= length
                tip[i] = tips[n, i] + share * (tips[n + 1, i] - tips[n, i]) + from_mm * axis[i]
            _remove(cells, first, cell_mm, tip, axis, rows, tops, found, cuts, begin, last, end)
        for i in range(VOXEL_FIGURES):
            figures[n, i] = found[i]
        figures[n, VOLUME_MM3] *= cell_mm**3
