"""Centres of arcs as they are written: of the rounded ones the one whose arc fits best, if there is one that does."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import product

import numpy as np

from polycnc.post.macros._control_parameters import Parameters
from polycnc.post.tool_path._arcs import TWO_PI, Arc

_PARTS = np.linspace(0.0, 1.0, 9)
_GOOD_UNITS = 0.75
"""An arc nearer than this to the one that is meant, in units of the last decimal, needs no other centre."""
_FAR_UNITS = 1.2
"""An arc farther off than this is another one; rounded ends alone take up to 0.71."""
_FLAT_MM = 1e-7
_FITS_MM = 0.004
_FITS = 0.9e-3
"""Controls refuse an arc whose end lies farther off its circle than 0.005 mm or a thousandth of the radius."""
_REACH = 2  # units of the last decimal around the rounded centre
_AXES = {17: (0, 1), 18: (2, 0), 19: (1, 2)}

_Place = tuple[float, float]


def may_be_written(arc: Arc, parameters: Parameters) -> bool:
    """Tell whether a control file allows the plane, the radius and the rise of an arc."""
    found = arc.plane()
    return (
        parameters.arcs == "arcs"
        and found is not None
        and found[0] in parameters.arc_planes
        and parameters.arc_min_radius_mm <= arc.radius <= parameters.arc_max_radius_mm
        and (parameters.helix == "arcs" or abs(arc.rise) <= _FLAT_MM)
    )


class WrittenArc:
    """An arc of plane 17, 18 or 19 as the control reads it: in its units, rounded to its decimals."""

    def __init__(self, arc: Arc, plane: int, clockwise: bool, scale: float, decimals: int) -> None:
        self._axes = first, second = _AXES[plane]
        self._arc, self._scale, self._decimals = arc, scale, decimals
        self._sense = -1.0 if clockwise else 1.0
        self._unit = 10.0**-decimals
        self._whole = [round(value * scale, decimals) for value in arc.center]
        self._start, self._end = (
            (round(point[first] * scale, decimals), round(point[second] * scale, decimals))
            for point in (arc.start, arc.end)
        )
        self._meant = np.array([arc.point(float(part) * arc.sweep) for part in _PARTS])[:, self._axes] * scale

    def center(self, by_radius: bool) -> list[float] | None:
        """Return the centre to write; None if the control would refuse every such arc, or turn another one.

        The control turns about the written centre, from its distance to the rounded start to that to the rounded end.
        Such an arc may lie more than a unit of the last decimal off the one that is meant, where a neighbour of the
        rounded centre does better. With coarse decimals the end may lie so far off the circle that the control refuses
        the arc: then of the near ones the one with the least of that. With `by_radius` the control has no choice.
        """
        if by_radius:
            return self._whole if self._fits(self._center_by_radius()) else None
        first, second = self._axes
        best = self._whole[first], self._whole[second]
        if self._off(best) > _GOOD_UNITS * self._unit or self._misfit(best):
            best = min(self._around(best), key=self._cost)
        if not self._fits(best):
            return None
        center = self._whole
        center[first], center[second] = (round(value, self._decimals) for value in best)
        return center

    def _around(self, place: _Place) -> Iterator[_Place]:
        steps = [step * self._unit for step in range(-_REACH, _REACH + 1)]
        return ((place[0] + first, place[1] + second) for first, second in product(steps, steps))

    def _cost(self, place: _Place) -> tuple[bool, float, float]:
        off = self._off(place)
        return off > self._unit, self._misfit(place), off

    def _fits(self, place: _Place | None) -> bool:
        """Tell whether the control turns about a place, and as far as is meant: not once more, or less."""
        if place is None or self._misfit(place) or self._off(place) > _FAR_UNITS * self._unit:
            return False
        first, last = (math.atan2(end[1] - place[1], end[0] - place[0]) for end in (self._start, self._end))
        sweep = (last - first) * self._sense % TWO_PI or TWO_PI
        return abs(sweep - self._arc.sweep) < math.pi

    def _off(self, place: _Place) -> float:
        """Return how far the arc about a place lies off the one that is meant."""
        begin = math.dist(place, self._start)
        reach = begin + (math.dist(place, self._end) - begin) * _PARTS
        away = np.hypot(self._meant[:, 0] - place[0], self._meant[:, 1] - place[1])
        return float(np.abs(away - reach).max())

    def _misfit(self, place: _Place) -> float:
        """Return how far the end lies off the circle about a place, beyond what any control accepts."""
        radius, last = math.dist(place, self._start), math.dist(place, self._end)
        if min(radius, last) < 0.5 * self._unit:
            return math.inf
        return max(abs(last - radius) - max(_FITS_MM * self._scale, _FITS * radius), 0.0)

    def _center_by_radius(self) -> _Place | None:
        """Return about which place a control turns that is told the rounded radius."""
        (x0, y0), (x1, y1) = self._start, self._end
        chord = math.dist(self._start, self._end)
        radius = round(self._arc.radius * self._scale, self._decimals)
        if not chord or radius < 0.5 * chord - _FITS_MM * self._scale:
            return None
        height = math.sqrt(max(radius**2 - 0.25 * chord**2, 0.0)) / chord
        side = self._sense if self._arc.sweep <= math.pi + 1e-9 else -self._sense
        return 0.5 * (x0 + x1) - side * height * (y1 - y0), 0.5 * (y0 + y1) + side * height * (x1 - x0)
