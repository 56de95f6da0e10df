"""Centres of arcs as they are written: of the rounded ones around the centre the one whose arc fits best."""

from __future__ import annotations

import math
from itertools import product

import numpy as np

from polycnc.post.tool_path._arcs import Arc

_PARTS = np.linspace(0.0, 1.0, 9)
_GOOD_UNITS = 0.75
"""An arc nearer than this to the one that is meant, in units of the last decimal, needs no other centre."""
_FITS_MM = 0.004
"""Controls refuse an arc whose end lies farther off its circle than a hundredth or two."""
_REACH = 2  # units of the last decimal around the rounded centre
_AXES = {17: (0, 1), 18: (2, 0), 19: (1, 2)}


def written_center(arc: Arc, plane: int, scale: float, decimals: int) -> list[float]:
    """Return the centre to write for an arc in a plane, in units of the control and rounded to `decimals`.

    The control turns about the written centre, from its distance to the rounded start to that to the rounded end.
    Such an arc may lie more than a unit of the last decimal off the one that is meant, where a neighbour of the
    rounded centre does better. With coarse decimals the end may lie so far off the circle that the control refuses the
    arc: then of the near ones the one with the least of that.
    """
    center = [round(value * scale, decimals) for value in arc.center]
    axes = list(_AXES[plane])
    start, end = ([round(point[axis] * scale, decimals) for axis in axes] for point in (arc.start, arc.end))
    meant = np.array([arc.point(float(part) * arc.sweep) for part in _PARTS])[:, axes] * scale

    def off(place: tuple[float, float]) -> float:
        reach = math.dist(place, start) + (math.dist(place, end) - math.dist(place, start)) * _PARTS
        return float(np.abs(np.hypot(meant[:, 0] - place[0], meant[:, 1] - place[1]) - reach).max())

    def misfit(place: tuple[float, float]) -> float:
        return max(abs(math.dist(place, end) - math.dist(place, start)) - _FITS_MM * scale, 0.0)

    def cost(place: tuple[float, float]) -> tuple[bool, float, float]:
        return off(place) > unit, misfit(place), off(place)

    unit = 10.0**-decimals
    best = center[axes[0]], center[axes[1]]
    if off(best) > _GOOD_UNITS * unit or misfit(best):
        steps = [step * unit for step in range(-_REACH, _REACH + 1)]
        best = min(((best[0] + first, best[1] + second) for first, second in product(steps, steps)), key=cost)
        for axis, value in zip(axes, best, strict=True):
            center[axis] = round(value, decimals)
    return center
