"""Sweep the outline of a turning tool over the profile of a turned body: one radius for each cell along the axis.

Where a tool goes straight, the lowest point of its outline over a cell is where the outline has the slope of the way;
the outline is convex, so the nearest place of the way to that is the lowest of all.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from polycnc.kernel import compiled, entry
from polycnc.stock._sweep import AT_X, AT_Y, DEPTH_MM, VOLUME_MM3

Floats = npt.NDArray[np.float64]

HALF_FLAT, NOSE, LEFT_ANGLE, LEFT_REACH, RIGHT_ANGLE, RIGHT_REACH = range(6)
"""Of an outline: half the flat and the radius (mm); angle (radian) and reach beyond the flat (mm) of the flanks."""
_STEEP = 0.5 * math.pi - 1e-9


@compiled
def _height(outline: Floats, beside: float) -> float:
    """Return the height of an outline above the middle of its corners, `beside` it along Z."""
    nose = outline[NOSE]
    angle = outline[RIGHT_ANGLE] if beside > 0.0 else outline[LEFT_ANGLE]
    out = abs(beside) - outline[HALF_FLAT]
    if out <= 0.0:
        return -float(nose)
    if angle >= _STEEP or out <= nose * math.sin(angle):
        return -math.sqrt(max(0.0, nose * nose - out * out))
    return float((out - nose * math.sin(angle)) * math.tan(angle) - nose * math.cos(angle))


@compiled
def _where_sloped(outline: Floats, slope: float) -> float:
    """Return where along Z, from its middle, an outline has a slope; its end where it is nowhere that steep."""
    if slope == 0.0:
        return 0.0
    angle = math.atan(abs(slope))
    if slope > 0.0:
        if angle >= outline[RIGHT_ANGLE]:
            return float(outline[HALF_FLAT] + outline[RIGHT_REACH])
        return float(outline[HALF_FLAT] + outline[NOSE] * math.sin(angle))
    if angle >= outline[LEFT_ANGLE]:
        return -float(outline[HALF_FLAT] + outline[LEFT_REACH])
    return -float(outline[HALF_FLAT] + outline[NOSE] * math.sin(angle))


@compiled
def _lowest(outline: Floats, begin: Floats, end: Floats, z: float, left: float, right: float) -> float:
    """Return how low an outline gets at `z` on its way; infinite if it does not get there."""
    low, high = min(begin[1], end[1]), max(begin[1], end[1])
    first, last = max(low, z - right), min(high, z + left)
    if first > last:
        return math.inf
    if high - low < 1e-9:
        return float(min(begin[0], end[0]) + _height(outline, z - low))
    slope = (end[0] - begin[0]) / (end[1] - begin[1])
    at = min(max(z - _where_sloped(outline, slope), first), last)
    return float(begin[0] + slope * (at - begin[1]) + _height(outline, z - at))


@entry(steps=lambda z0, cell_mm, field, *rest: len(rest[1]) * min(len(field), 200))
def sweep_insert(
    z0: float,
    cell_mm: float,
    field: Floats,
    limit: Floats,
    begins: Floats,
    ends: Floats,
    outline: Floats,
    narrower_mm: float,
    cuts: bool,
    figures: Floats,
) -> None:
    """Move an outline along ways [n, 2] of its middle (X, Z): lower the field of radii to what it leaves.

    The field does not get below `limit`. `narrower_mm` is taken off both sides of the outline. `figures` [n, 6] get
    volume and depth of each way, and the place of that: Z and radius.
    """
    left = max(0.0, outline[HALF_FLAT] + outline[LEFT_REACH] - narrower_mm)
    right = max(0.0, outline[HALF_FLAT] + outline[RIGHT_REACH] - narrower_mm)
    for n in range(begins.shape[0]):
        begin, end = begins[n], ends[n]
        first = max(0, math.ceil((min(begin[1], end[1]) - left - z0) / cell_mm))
        last = min(field.shape[0] - 1, math.floor((max(begin[1], end[1]) + right - z0) / cell_mm))
        volume = 0.0
        for i in range(first, last + 1):
            here = field[i]
            if here <= limit[i]:
                continue
            z = z0 + i * cell_mm
            found = max(_lowest(outline, begin, end, z, left, right), limit[i])
            if found >= here:
                continue
            volume += abs(here * here - found * found)
            if here - found > figures[n, DEPTH_MM]:
                figures[n, DEPTH_MM] = here - found
                figures[n, AT_X], figures[n, AT_Y] = abs(found), z
            if cuts:
                field[i] = found
        figures[n, VOLUME_MM3] = math.pi * cell_mm * volume
