"""The shape of a rotating body seen from below: how high its lowest point is at each radius."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]

FROM_R, TO_R, BEGIN_Z, SLOPE, CENTRE_R, CENTRE_Z, ARC_R = range(7)
"""Columns of a profile's rows: radii (mm), then height and slope of a line, or centre and radius of an arc."""
COLUMNS = 7


class Line(NamedTuple):
    """A piece of a profile from radius `from_r` to `to_r` (mm), straight from height `begin_z` to `end_z`."""

    from_r: float
    to_r: float
    begin_z: float
    end_z: float


class Arc(NamedTuple):
    """A piece of a profile from radius `from_r` to `to_r` (mm): the lower part of a circle about (r, z)."""

    from_r: float
    to_r: float
    centre_r: float
    centre_z: float
    radius: float


@dataclass(frozen=True, eq=False)
class Profile:
    """Hold the lower outline of a rotating body over its radius, tip at height 0.

    `rows` [pieces, 7] follow each other from the axis outwards, and heights never fall.
    """

    rows: Floats

    @property
    def radius_mm(self) -> float:
        """The largest radius, 0 of a body without any piece."""
        return float(self.rows[-1, TO_R]) if len(self.rows) else 0.0

    def within(self, radius_mm: float) -> Profile:
        """Return the outline up to a radius."""
        rows = self.rows[self.rows[:, FROM_R] < radius_mm].copy()
        rows[:, TO_R] = np.minimum(rows[:, TO_R], radius_mm)
        return Profile(rows)

    def height(self, radius_mm: float) -> float:
        """Return the height of the outline (mm) at a radius; infinite outside."""
        for row in self.rows:
            if row[FROM_R] <= radius_mm <= row[TO_R]:
                return _height(row, radius_mm)
        return math.inf

    def volume_below(self, height_mm: float, steps: int = 2000) -> float:
        """Return the volume of the body from its tip up to a height (mm3), by the middle of `steps` rings."""
        edges = np.linspace(0.0, self.radius_mm, steps + 1)
        middle = 0.5 * (edges[1:] + edges[:-1])
        high = np.array([max(0.0, height_mm - self.height(float(r))) for r in middle])
        return float(np.sum(np.pi * (edges[1:] ** 2 - edges[:-1] ** 2) * high))


def make_profile(pieces: Sequence[Line | Arc]) -> Profile:
    """Make the profile of these pieces, from the axis outwards.

    Raises:
        ValueError: pieces that do not follow each other, fall outwards, or bend over.
    """
    rows = np.zeros((len(pieces), COLUMNS))
    last_r, last_z = 0.0, -math.inf
    for row, piece in zip(rows, pieces, strict=True):
        row[FROM_R], row[TO_R] = piece.from_r, piece.to_r
        if isinstance(piece, Line):
            width = piece.to_r - piece.from_r
            row[BEGIN_Z] = piece.begin_z
            row[SLOPE] = (piece.end_z - piece.begin_z) / width if width > 0.0 else 0.0
        else:
            row[CENTRE_R], row[CENTRE_Z], row[ARC_R] = piece.centre_r, piece.centre_z, piece.radius
            reach = max(abs(piece.from_r - piece.centre_r), abs(piece.to_r - piece.centre_r))
            if piece.from_r < piece.centre_r - 1e-12 or reach > piece.radius * (1.0 + 1e-12):
                raise ValueError("an arc that bends over")
        begin, end = _height(row, piece.from_r), _height(row, piece.to_r)
        if abs(piece.from_r - last_r) > 1e-9 or piece.to_r < piece.from_r:
            raise ValueError("pieces that do not follow each other")
        if begin < last_z - 1e-9 or end < begin - 1e-9:
            raise ValueError("a profile that falls outwards")
        last_r, last_z = piece.to_r, end
    return Profile(rows)


def falling_profile(pieces: Sequence[Line]) -> Profile:
    """Make the upper outline of a body of these pieces, from the axis outwards; none of them rises."""
    rows = np.zeros((len(pieces), COLUMNS))
    for row, piece in zip(rows, pieces, strict=True):
        row[FROM_R], row[TO_R], row[BEGIN_Z] = piece.from_r, piece.to_r, piece.begin_z
        if math.isfinite(piece.begin_z):
            row[SLOPE] = (piece.end_z - piece.begin_z) / (piece.to_r - piece.from_r)
    return Profile(rows)


def _height(row: Floats, radius_mm: float) -> float:
    if row[ARC_R] > 0.0:
        left = row[ARC_R] ** 2 - (radius_mm - row[CENTRE_R]) ** 2
        return float(row[CENTRE_Z] - math.sqrt(max(0.0, left)))
    return float(row[BEGIN_Z] + row[SLOPE] * (radius_mm - row[FROM_R]))
