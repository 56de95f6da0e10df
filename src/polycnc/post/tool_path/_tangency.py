"""Whether arcs turn the way that the straight feed moves beside them run: a judgement that no reader has a part in.

An arc read with the wrong sense begins or ends against its neighbour: the tool would turn back on the spot, by half
a turn. CAM systems write tangent joints or corners, hardly ever such a cusp, so neighbours that run along the
circle decide.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from polycnc.post.tool_path._arcs import across, cross, dot
from polycnc.post.tool_path._records import Vector

_ALONG = math.cos(math.radians(2.0))
_SHORT_MM = 1e-6


class Tangency:
    """Counts arcs that go on as their straight neighbours run, and arcs that turn back on the spot."""

    def __init__(self) -> None:
        self.smooth = 0
        self.kinked = 0
        self.first_kink = 0
        """The line of the first arc that turns back, 0 if none does."""
        self._way: Vector | None = None
        self._segment: tuple[Vector, Vector] | None = None
        """The last move, if its direction is not in `_way` yet: only an arc after it asks for it."""
        self._leaves: Vector | None = None
        self._vote = 0
        self._line = 0

    def feed(self, start: Vector, end: Vector, length: float) -> None:
        """Take a straight feed move of a length in mm."""
        if self._leaves is not None or self._vote:
            self.straight(start, end, True)
        elif length > _SHORT_MM:
            self._segment = (start, end)

    def run(self, start: Vector, ends: npt.NDArray[np.float64], lengths: npt.NDArray[np.float64]) -> None:
        """Take straight feed moves, one after the other, with their lengths in mm."""
        long = np.flatnonzero(lengths > _SHORT_MM)
        for place in sorted({*long[:1].tolist(), *long[-1:].tolist()}):
            before = start if not place else _vector(ends[place - 1])
            self.feed(before, _vector(ends[place]), float(lengths[place]))

    def straight(self, start: Vector | None, end: Vector, feed: bool) -> None:
        """Take a straight move."""
        if start is not None and math.dist(start, end) <= _SHORT_MM:
            return
        way = None if start is None or not feed else _direction(start, end)
        if way is not None and self._leaves is not None:
            self._vote += _vote(way, self._leaves)
        self.settle()
        self._way = way
        self._segment = None

    def arc(self, line: int, start: Vector, end: Vector, center: Vector, normal: Vector) -> None:
        """Take an arc that turns about `normal` by the right-hand rule."""
        self.settle()
        self._line = line
        if self._segment is not None:
            self._way = _direction(*self._segment)
            self._segment = None
        if self._way is not None and (sets_out := _tangent(start, center, normal)) is not None:
            self._vote += _vote(self._way, sets_out)
        self._way = None
        self._leaves = _tangent(end, center, normal)

    @property
    def mostly_kinked(self) -> bool:
        """Whether more arcs turn back than go on."""
        self.settle()
        return self.kinked > self.smooth

    def text(self) -> str:
        """Say what was found."""
        return (
            f"{self.kinked} of {self.kinked + self.smooth} arcs whose straight neighbours decide turn back on the "
            f"spot, the first on line {self.first_kink}: their axes seem to be meant the other way (--arc-axis)"
        )

    def settle(self) -> None:
        """Count the last arc, whose neighbours are known."""
        if self._vote > 0:
            self.smooth += 1
        elif self._vote < 0:
            self.kinked += 1
            self.first_kink = self.first_kink or self._line
        self._vote = 0
        self._leaves = None


def _vector(row: npt.NDArray[np.float64]) -> Vector:
    x, y, z = row.tolist()
    return x, y, z


def _direction(start: Vector, end: Vector) -> Vector:
    length = math.dist(start, end)
    return (end[0] - start[0]) / length, (end[1] - start[1]) / length, (end[2] - start[2]) / length


def _tangent(point: Vector, center: Vector, normal: Vector) -> Vector | None:
    way = cross(normal, across(point, center, normal))
    length = math.hypot(*way)
    return (way[0] / length, way[1] / length, way[2] / length) if length > _SHORT_MM else None


def _vote(way: Vector, tangent: Vector) -> int:
    along = dot(way, tangent)
    return 0 if abs(along) < _ALONG else 1 if along > 0.0 else -1
