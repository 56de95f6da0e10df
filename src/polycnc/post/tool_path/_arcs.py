"""Arcs of a tool path in space: their sweep, points on them, where they are split, and lines that stand for them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from polycnc.post.tool_path._records import Vector

SAME_POINT_MM = 1e-5
"""An arc whose ends are this close to each other is a whole turn."""

TWO_PI = 2.0 * math.pi
_OFF_CIRCLE_MM = 0.02
_OFF_CIRCLE = 1e-3  # the same as a part of the radius
_ANGLE = 1e-9
_ALONG_AXIS = 1.0 - 1e-9


def dot(a: Vector, b: Vector) -> float:
    """Return the scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    """Return the vector product."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def across(point: Vector, center: Vector, normal: Vector) -> Vector:
    """Return the shortest way from the axis of a circle to a point."""
    x, y, z = point[0] - center[0], point[1] - center[1], point[2] - center[2]
    along = x * normal[0] + y * normal[1] + z * normal[2]
    return x - along * normal[0], y - along * normal[1], z - along * normal[2]


def radius_at(point: Vector, center: Vector, normal: Vector) -> float:
    """Return how far a point lies off the axis of a circle."""
    return math.hypot(*across(point, center, normal))


def off_circle(start: Vector, end: Vector, center: Vector, normal: Vector) -> float:
    """Return how far an end point lies off the circle through the start, 0 if that is within what CAM systems round."""
    radius = radius_at(start, center, normal)
    off = abs(radius - radius_at(end, center, normal))
    if radius <= 0.0:
        return max(off, _OFF_CIRCLE_MM)
    return off if off > max(_OFF_CIRCLE_MM, _OFF_CIRCLE * radius) else 0.0


def sweep_of(start: Vector, end: Vector, center: Vector, normal: Vector) -> float:
    """Return the angle from start to end about an axis by the right-hand rule: above 0, up to a whole turn."""
    first = across(start, center, normal)
    last = across(end, center, normal)
    if math.dist(first, last) < SAME_POINT_MM:
        return TWO_PI
    angle = math.atan2(dot(cross(first, last), normal), dot(first, last))
    return angle if angle > 0.0 else angle + TWO_PI


@dataclass(frozen=True, slots=True)
class Arc:
    """An arc or helix from start to end, turning by `sweep` rad (above 0) about `normal` through `center`."""

    start: Vector
    end: Vector
    center: Vector
    normal: Vector
    sweep: float

    @property
    def radius(self) -> float:
        """Radius at the start."""
        return radius_at(self.start, self.center, self.normal)

    @property
    def rise(self) -> float:
        """Way along the axis from start to end."""
        way = (self.end[0] - self.start[0], self.end[1] - self.start[1], self.end[2] - self.start[2])
        return dot(way, self.normal)

    @property
    def length(self) -> float:
        """Length of the path."""
        return math.hypot(self.sweep * self.radius, self.rise)

    @property
    def height(self) -> float:
        """How far the arc bulges from its chord."""
        return self.radius * (1.0 - math.cos(min(self.sweep, TWO_PI) * 0.5))

    def point(self, angle: float) -> Vector:
        """Return the point after `angle` rad; a difference of the radii at both ends is spread along the arc."""
        if angle >= self.sweep:
            return self.end
        out = across(self.start, self.center, self.normal)
        side = cross(self.normal, out)
        part = angle / self.sweep
        last = radius_at(self.end, self.center, self.normal)
        size = 1.0 + part * (last / self.radius - 1.0)
        c, s = math.cos(angle) * size, math.sin(angle) * size
        rise = self.rise * part
        foot = [a - b + rise * n for a, b, n in zip(self.start, out, self.normal, strict=True)]
        return (
            foot[0] + c * out[0] + s * side[0],
            foot[1] + c * out[1] + s * side[1],
            foot[2] + c * out[2] + s * side[2],
        )

    def pieces(self, angles: list[float]) -> Iterator[Arc]:
        """Yield the arc cut at ascending `angles`."""
        start, before = self.start, 0.0
        for angle in [*angles, self.sweep]:
            end = self.point(angle)
            yield Arc(start, end, self.center, self.normal, angle - before)
            start, before = end, angle

    def chords(self, tolerance: float) -> Iterator[Vector]:
        """Yield the ends of lines that lie no further than `tolerance` off the arc."""
        step = 2.0 * math.acos(max(1.0 - tolerance / self.radius, 0.0)) if self.radius > 0.0 else TWO_PI
        count = max(1, math.ceil(self.sweep / max(step, 1e-6) - _ANGLE))
        for number in range(1, count + 1):
            yield self.point(self.sweep * number / count) if number < count else self.end

    def plane(self) -> tuple[Literal[17, 18, 19], bool] | None:
        """Return the plane and whether the arc turns clockwise in it; None if it is tilted."""
        for component, plane in ((2, 17), (1, 18), (0, 19)):
            value = self.normal[component]
            if abs(value) >= _ALONG_AXIS:
                return plane, value < 0.0  # type: ignore[return-value]
        return None


def cuts(arc: Arc, split: Literal["none", "half", "quadrant"]) -> list[float]:
    """Return the angles at which an arc is split: after whole turns, and as `split` says."""
    if split == "quadrant":
        return _axis_crossings(arc)
    most = TWO_PI if split == "none" else math.pi
    count = max(1, math.ceil(arc.sweep / most - _ANGLE))
    if split == "none":
        return [TWO_PI * number for number in range(1, count)]
    return [arc.sweep * number / count for number in range(1, count)]


_FIRST_AXIS = {17: (0, 1), 18: (2, 0), 19: (1, 2)}


def _axis_crossings(arc: Arc) -> list[float]:
    found = arc.plane()
    if found is None:
        return []
    plane, clockwise = found
    p, q = _FIRST_AXIS[plane]
    out = across(arc.start, arc.center, arc.normal)
    first = math.atan2(out[q], out[p]) * (-1.0 if clockwise else 1.0)
    quarter = 0.5 * math.pi
    number = math.floor(first / quarter + 1e-6) + 1
    angles = []
    while (angle := number * quarter - first) < arc.sweep - 1e-6:
        angles.append(angle)
        number += 1
    return angles
