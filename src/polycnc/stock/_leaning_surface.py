"""How deep a moving tool whose axis leans or turns gets behind points of a surface."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from polycnc.kernel import compiled, entry
from polycnc.stock._chords import chord
from polycnc.stock._profile import TO_R
from polycnc.stock._surface import depth_behind
from polycnc.stock._sweep import AT_X, AT_Y, DEPTH_MM
from polycnc.stock._voxel_sweep import AT_Z

Floats = npt.NDArray[np.float64]

_AROUND = 0.75  # cells: more than from the middle of one to its corner
_STEP_RAD = 0.005
"""How far a tool turns at the most in a piece of its way that counts as straight."""


@compiled
def _frame(piece: Floats, frame: Floats) -> None:
    """Write two directions across the axis of a piece, and the axis itself, as the rows of a frame."""
    axis = piece[2]
    least = 0
    for i in range(1, 3):
        if abs(axis[i]) < abs(axis[least]):
            least = i
    length = math.sqrt(max(1e-12, 1.0 - axis[least] * axis[least]))
    for i in range(3):
        frame[0, i] = ((1.0 if i == least else 0.0) - axis[least] * axis[i]) / length
        frame[2, i] = axis[i]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        frame[1, i] = axis[j] * frame[0, k] - axis[k] * frame[0, j]


@compiled
def _turned(frame: Floats, x: float, y: float, z: float, to: Floats, at: int) -> None:
    for i in range(3):
        to[at + i] = frame[i, 0] * x + frame[i, 1] * y + frame[i, 2] * z


@compiled
def _piece(places: Floats, axes: Floats, n: int, from_share: float, to_share: float, piece: Floats) -> None:
    """Write a piece of a way, where its axis is that of its middle: begin, end and axis as rows of `piece`."""
    length = 0.0
    for i in range(3):
        way, lean = places[n + 1, i] - places[n, i], axes[n + 1, i] - axes[n, i]
        piece[0, i] = places[n, i] + way * from_share
        piece[1, i] = places[n, i] + way * to_share
        piece[2, i] = axes[n, i] + lean * 0.5 * (from_share + to_share)
        length += piece[2, i] ** 2
    for i in range(3):
        piece[2, i] /= math.sqrt(length)


@compiled
def _deepest(
    points: Floats,
    first: int,
    last: int,
    inwards_mm: float,
    piece: Floats,
    cutter: Floats,
    height_mm: float,
    room: Floats,
    figures: Floats,
) -> None:
    """Write into `figures` where a tool gets deeper behind points from `first` up to `last` on a piece of a way."""
    frame, zero, far, point = room[:3, :3], room[3], room[4], room[5]
    _frame(piece, frame)
    for i in range(3):
        zero[i] = 0.0
    _turned(frame, piece[1, 0] - piece[0, 0], piece[1, 1] - piece[0, 1], piece[1, 2] - piece[0, 2], far, 0)
    line = chord(zero, far)
    begin = far if line[0] <= 0.0 and far[2] < 0.0 else zero
    bottom, top = min(0.0, far[2]), height_mm + max(0.0, far[2])
    for at in range(first, last):
        x, y, z = points[at, 0] - piece[0, 0], points[at, 1] - piece[0, 1], points[at, 2] - piece[0, 2]
        _turned(frame, x, y, z, point, 0)
        if point[2] < bottom or point[2] > top:
            continue
        _turned(frame, points[at, 3], points[at, 4], points[at, 5], point, 3)
        least = max(inwards_mm, figures[DEPTH_MM])
        depth = depth_behind(cutter, point, inwards_mm, begin, line, least)
        if depth > least:
            figures[DEPTH_MM] = depth
            figures[AT_X], figures[AT_Y], figures[AT_Z] = points[at, 0], points[at, 1], points[at, 2]


@entry(steps=lambda points, starts, x0, y0, cell_mm, inwards_mm, places, *_: 2000 * len(places))
def reach_behind_leaning(
    points: Floats,
    starts: npt.NDArray[np.int64],
    x0: float,
    y0: float,
    cell_mm: float,
    inwards_mm: float,
    places: Floats,
    axes: Floats,
    cutter: Floats,
    height_mm: float,
    figures: Floats,
) -> None:
    """Write into `figures` [n, 7] how deep a tool gets on each way between `places` [n + 1, 3], and where.

    `axes` [n + 1, 3] are its directions, upwards; it cuts up to `height_mm` along them. The points are those of
    `reach_behind`.
    """
    around = cutter[cutter.shape[0] - 1, TO_R] + _AROUND * cell_mm
    ny, nx = starts.shape[0], starts.shape[1] - 1
    piece, room, low, high = np.empty((3, 3)), np.empty((6, 6)), np.empty(2), np.empty(2)
    for n in range(places.shape[0] - 1):
        lean = 0.0
        for i in range(3):
            lean += (axes[n + 1, i] - axes[n, i]) ** 2
        pieces = max(1, math.ceil(math.sqrt(lean) / _STEP_RAD))
        for k in range(pieces):
            _piece(places, axes, n, k / pieces, (k + 1) / pieces, piece)
            for i in range(2):
                up = height_mm * piece[2, i]
                low[i] = min(piece[0, i], piece[1, i]) + min(up, 0.0) - around
                high[i] = max(piece[0, i], piece[1, i]) + max(up, 0.0) + around
            first_x = max(0, math.ceil((low[0] - x0) / cell_mm))
            last_x = min(nx - 1, math.floor((high[0] - x0) / cell_mm))
            first_y = max(0, math.ceil((low[1] - y0) / cell_mm))
            last_y = min(ny - 1, math.floor((high[1] - y0) / cell_mm))
            for iy in range(first_y, last_y + 1 if first_x <= last_x else first_y):
                first, last = starts[iy, first_x], starts[iy, last_x + 1]
                _deepest(points, first, last, inwards_mm, piece, cutter, height_mm, room, figures[n])
