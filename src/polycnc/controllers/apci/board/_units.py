"""Units of position and time, by the board's numbers, and what they are in millimetres, degrees and seconds.

Counts and steps are one thing here: `slsp` of them make a turn of the motor, and `gf` turns a unit of the axis,
so a unit of the axis has `slsp * gf` counts.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import IntEnum

from polycnc.controllers.apci.core._state import Floats, Whole


class PositionUnit(IntEnum):
    """Numbers of the position units, 4.4.11."""

    mm = 0
    inch = 1
    m = 2
    rev = 3
    deg = 4
    rad = 5
    counts = 6
    steps = 7


class TimeUnit(IntEnum):
    """Numbers of the time units, 4.4.11; `tsample` is the scan time."""

    sec = 0
    min = 1
    tsample = 2


MILLIMETRES = {PositionUnit.mm: 1.0, PositionUnit.inch: 25.4, PositionUnit.m: 1000.0}
DEGREES = {PositionUnit.rev: 360.0, PositionUnit.deg: 1.0, PositionUnit.rad: 180.0 / math.pi}


def seconds(unit: TimeUnit, sample_time_s: float) -> float:
    """Return the length of a time unit in seconds."""
    return {TimeUnit.sec: 1.0, TimeUnit.min: 60.0, TimeUnit.tsample: sample_time_s}[unit]


def ratio(unit: PositionUnit, other: PositionUnit, counts_per_unit: float) -> float | None:
    """Return how many `other` make one `unit` of an axis; None between a length and an angle, or from counts."""
    for kind in (MILLIMETRES, DEGREES):
        if unit in kind and other in kind:
            return kind[unit] / kind[other]
    if unit in (PositionUnit.counts, PositionUnit.steps):
        return 1.0 if other in (PositionUnit.counts, PositionUnit.steps) else None
    return counts_per_unit if other in (PositionUnit.counts, PositionUnit.steps) else None


@dataclass(frozen=True, slots=True)
class PathUnits:
    """How the numbers of one interpolation are meant; the arrays go with its axes, in their order."""

    velocity_unit: float  # path units/s per unit of velocity
    acceleration_unit: float  # path units/s2 per unit of acceleration
    axes: Whole
    weight: Floats  # path units per unit of each axis
    distance: Floats  # path units per unit in which the axis' distances are given

    def velocity(self, value: float) -> float:
        """Return a velocity in path units/s."""
        return value * self.velocity_unit

    def acceleration(self, value: float) -> float:
        """Return an acceleration in path units/s2."""
        return value * self.acceleration_unit
