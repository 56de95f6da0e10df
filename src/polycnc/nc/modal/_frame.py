"""Mirroring, scaling, rotation in the plane and polar coordinates: from programmed to workpiece coordinates.

A control mirrors first, then scales, then rotates. All of it is linear, so the programmed position follows from the
workpiece position by going back the other way.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class Rotation:
    """Turn the plane of axes `p` and `q` about a centre (mm) by an angle, counter-clockwise in degrees."""

    p: int
    q: int
    center_p: float
    center_q: float
    angle_deg: float

    def turned(self, u: float, v: float, sign: float = 1.0) -> tuple[float, float]:
        """Return a vector turned, with sign -1 back."""
        angle = math.radians(self.angle_deg * sign)
        cosine, sine = math.cos(angle), math.sin(angle)
        if math.fmod(self.angle_deg, 90.0) == 0.0:
            cosine, sine = float(round(cosine)), float(round(sine))
        return u * cosine - v * sine, u * sine + v * cosine


@dataclass(frozen=True, slots=True)
class Polar:
    """Read the words of a plane as radius (mm) and angle (degrees) about a centre in programmed coordinates (mm)."""

    center: tuple[float, float] = (0.0, 0.0)
    radius: float = 0.0
    angle_deg: float = 0.0

    def point(self) -> tuple[float, float]:
        """Return where radius and angle lead."""
        angle = math.radians(self.angle_deg)
        cosine, sine = math.cos(angle), math.sin(angle)
        if math.fmod(self.angle_deg, 90.0) == 0.0:
            cosine, sine = float(round(cosine)), float(round(sine))
        return self.center[0] + self.radius * cosine, self.center[1] + self.radius * sine


@dataclass(frozen=True, slots=True)
class Frame:
    """Hold what is active: mirrors (axis -> centre in mm), scales (axis -> centre in mm, factor), rotation, polar.

    `outer` turns the workpiece on the machine, after all of these.
    """

    mirrors: Mapping[int, float] = field(default_factory=dict)
    scales: Mapping[int, tuple[float, float]] = field(default_factory=dict)
    rotation: Rotation | None = None
    polar: Polar | None = None
    outer: Rotation | None = None

    @property
    def active(self) -> bool:
        """Whether anything is."""
        return bool(self.mirrors or self.scales or self.rotation or self.polar or self.outer)

    @property
    def scaled(self) -> bool:
        """Whether scaling is."""
        return bool(self.scales)

    @property
    def rotated(self) -> bool:
        """Whether rotation is."""
        return self.rotation is not None

    def factor(self, axis: int) -> float:
        """Return by what an axis is multiplied: scale, negative when mirrored."""
        factor = self.scales[axis][1] if axis in self.scales else 1.0
        return -factor if axis in self.mirrors else factor

    def forward(self, point: list[float]) -> list[float]:
        """Return the workpiece position of a programmed one (mm or degree)."""
        found = list(point)
        for axis, center in self.mirrors.items():
            found[axis] = 2.0 * center - found[axis]
        for axis, (center, factor) in self.scales.items():
            found[axis] = center + (found[axis] - center) * factor
        if (turn := self.rotation) is not None:
            u, v = turn.turned(found[turn.p] - turn.center_p, found[turn.q] - turn.center_q)
            found[turn.p], found[turn.q] = turn.center_p + u, turn.center_q + v
        if (turn := self.outer) is not None:
            found[turn.p], found[turn.q] = turn.turned(found[turn.p], found[turn.q])
        return found

    def back(self, point: list[float]) -> list[float]:
        """Return the programmed position of a workpiece position (mm or degree)."""
        found = list(point)
        if (turn := self.outer) is not None:
            found[turn.p], found[turn.q] = turn.turned(found[turn.p], found[turn.q], -1.0)
        if (turn := self.rotation) is not None:
            u, v = turn.turned(found[turn.p] - turn.center_p, found[turn.q] - turn.center_q, -1.0)
            found[turn.p], found[turn.q] = turn.center_p + u, turn.center_q + v
        for axis, (center, factor) in self.scales.items():
            found[axis] = center + (found[axis] - center) / factor
        for axis, center in self.mirrors.items():
            found[axis] = 2.0 * center - found[axis]
        return found

    def vector(self, p: int, q: int, u: float, v: float) -> tuple[float, float]:
        """Return what a programmed vector in the plane of `p` and `q` becomes (mm)."""
        u, v = u * self.factor(p), v * self.factor(q)
        for turn in (self.rotation, self.outer):
            if turn is not None and {turn.p, turn.q} == {p, q}:
                u, v = turn.turned(u, v) if turn.p == p else turn.turned(v, u)[::-1]
        return u, v

    def turns_over(self, p: int, q: int) -> bool:
        """Tell whether arcs in the plane change their direction."""
        return self.factor(p) * self.factor(q) < 0.0


UNTURNED = Frame()
"""Positions are meant as they are programmed."""
