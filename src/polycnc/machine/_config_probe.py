"""What a probe or a fixed stop meets: surfaces of the workpiece, in machine coordinates."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Literal

from pydantic import Field, model_validator

from polycnc.machine._toml import StrictModel, problem

_EVERYWHERE = (0.0, 1.0)
Interval = tuple[float, float]


class SurfaceConfig(StrictModel):
    """Describe a solid that a probe meets: a box, a boss (a cylinder that stands up), or a bore in a block.

    Lengths and angles are where the axes stand when the probe switches, so they hold its radius and length.
    """

    kind: Literal["box", "boss", "bore"] = Field(
        default="box",
        description='"box": between `low` and `high`; "boss": also within a circle; "bore": also outside of it.',
    )
    low: dict[str, float] = Field(
        default={}, description="Where the solid begins, axis = position (mm, degree); absent: nowhere."
    )
    high: dict[str, float] = Field(
        default={}, description="Where the solid ends, axis = position (mm, degree); absent: nowhere."
    )
    center: dict[str, float] = Field(
        default={}, description="Centre of the circle, two axes, like `{ X = 10, Y = 20 }` (boss, bore)."
    )
    radius_mm: float = Field(default=0.0, ge=0, description="Radius of the circle (boss, bore).")

    @model_validator(mode="after")
    def _fits_together(self) -> SurfaceConfig:
        if (self.kind != "box") != (len(self.center) == 2 and self.radius_mm > 0.0):
            raise problem(
                "a boss and a bore have a centre in two axes and a radius, a box has neither",
                hint='write kind = "bore", center = { X = 10, Y = 20 }, radius_mm = 5',
                at=("center",),
            )
        for axis, low in self.low.items():
            if low >= self.high.get(axis, math.inf):
                raise problem(
                    f"the surface ends before it begins in {axis}", hint="make low < high", at=("low", axis)
                )
        if not (self.low or self.high or self.center):
            raise problem("the surface is everywhere", hint="give low, high or center")
        return self

    @property
    def axes(self) -> tuple[str, ...]:
        """Return the axes that it names."""
        return (*self.low, *self.high, *self.center)

    def contact(self, names: Sequence[str], start: Sequence[float], end: Sequence[float]) -> float | None:
        """Return the share (0 to 1) of a straight move at which it is met, None if it is not."""
        within = _EVERYWHERE
        for index, name in enumerate(names):
            low, high = self.low.get(name, -math.inf), self.high.get(name, math.inf)
            if name in self.low or name in self.high:
                within = _common(within, _between(start[index], end[index], low, high))
        if self.kind == "box":
            return within[0] if within[0] <= within[1] else None
        circle = self._circle(names, start, end)
        if self.kind == "boss":
            both = _common(within, circle)
            return both[0] if both[0] <= both[1] else None
        if within[0] > within[1]:
            return None
        if circle[0] > circle[1] or within[0] < circle[0] or within[0] > circle[1]:
            return within[0]
        return circle[1] if circle[1] < within[1] else None

    def _circle(self, names: Sequence[str], start: Sequence[float], end: Sequence[float]) -> Interval:
        """Return the shares between which a move is inside the circle, reaching beyond 0 and 1."""
        (first, at_p), (second, at_q) = self.center.items()
        p, q = names.index(first), names.index(second)
        u, v = start[p] - at_p, start[q] - at_q
        du, dv = end[p] - start[p], end[q] - start[q]
        a, b, c = du * du + dv * dv, u * du + v * dv, u * u + v * v - self.radius_mm**2
        if a == 0.0:
            return (-math.inf, math.inf) if c < 0.0 else (math.inf, -math.inf)
        square = b * b - a * c
        if square <= 0.0:
            return math.inf, -math.inf
        root = math.sqrt(square)
        return (-b - root) / a, (-b + root) / a


def first_contact(
    surfaces: Sequence[SurfaceConfig], names: Sequence[str], start: Sequence[float], end: Sequence[float]
) -> tuple[float, ...] | None:
    """Return where a straight move first meets a surface (machine coordinates), None if it meets none.

    A surface with an axis that is not among `names` is out of reach.
    """
    near = (surface for surface in surfaces if set(surface.axes) <= set(names))
    shares = [each for surface in near if (each := surface.contact(names, start, end)) is not None]
    if not shares:
        return None
    share = min(shares)
    return tuple(a + share * (b - a) for a, b in zip(start, end, strict=True))


def surface_problems(surfaces: Sequence[SurfaceConfig], names: Sequence[str]) -> Iterator[Exception]:
    """Yield what is wrong with surfaces on a machine with these axes."""
    for index, surface in enumerate(surfaces):
        for name in surface.axes:
            if name not in names:
                yield problem(
                    f"there is no axis '{name}'",
                    hint=f"the axes are {', '.join(names)}",
                    at=("surface", index),
                )


def _between(start: float, end: float, low: float, high: float) -> Interval:
    """Return the shares between which a coordinate is between two limits."""
    way = end - start
    if way == 0.0:
        return _EVERYWHERE if low <= start <= high else (math.inf, -math.inf)
    a, b = (low - start) / way, (high - start) / way
    return min(a, b), max(a, b)


def _common(a: Interval, b: Interval) -> Interval:
    return max(a[0], b[0]), min(a[1], b[1])
