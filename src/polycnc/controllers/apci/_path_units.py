"""From the units of an interpolation (TRU) to path units: mm, degrees or counts, and seconds.

The position unit decides what a path is measured in. A rotary axis takes part in a path of millimetres with the
circumference at its effective radius (Manual 002, 2.3.4).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from polycnc.controllers.apci._registers import ModeReg
from polycnc.controllers.apci._units import DEGREES, MILLIMETRES, PositionUnit, TimeUnit, seconds

if TYPE_CHECKING:
    from polycnc.controllers.apci._board import Board


@dataclass(frozen=True, slots=True)
class PathUnits:
    """How the numbers of one interpolation are meant."""

    length: float  # path units per position unit
    time_s: float  # seconds per time unit
    weight: dict[int, float]  # path units per unit of each axis
    distance: dict[int, float]  # path units per unit in which the axis' distances are given

    def velocity(self, value: float) -> float:
        """Return a velocity in path units/s."""
        return value * self.length / self.time_s

    def acceleration(self, value: float) -> float:
        """Return an acceleration in path units/s2."""
        return value * self.length / (self.time_s * self.time_s)


def path_units(board: Board, axes: Sequence[int]) -> PathUnits | None:
    """Return the units in force for an interpolation of `axes`; None if an axis does not fit the position unit."""
    variables = board.variables
    if (
        variables.pu not in PositionUnit.__members__.values()
        or variables.tu not in TimeUnit.__members__.values()
    ):
        return None
    unit = PositionUnit(variables.pu)
    weight: dict[int, float] = {}
    distance: dict[int, float] = {}
    length = MILLIMETRES.get(unit) or DEGREES.get(unit) or 1.0
    for i in axes:
        axis = board.axes[i]
        own = axis.setup.position_unit
        per_unit = _weight(axis.counts_per_unit, own, unit)
        distance[i] = length
        if per_unit is None and own in DEGREES and unit in MILLIMETRES and axis.effradius > 0.0:
            per_unit = DEGREES[own] * math.radians(1.0) * axis.effradius * length
            if board.modereg & ModeReg.rotaxisunit:
                distance[i] = per_unit
        if per_unit is None:
            return None
        weight[i] = per_unit
    return PathUnits(length, seconds(TimeUnit(variables.tu), board.config.sample_time_s), weight, distance)


def _weight(counts_per_unit: float, own: PositionUnit, unit: PositionUnit) -> float | None:
    """Return path units per unit of an axis, None if they are of different kinds."""
    for kind in (MILLIMETRES, DEGREES):
        if own in kind and unit in kind:
            return kind[own]
    if unit in (PositionUnit.counts, PositionUnit.steps):
        return 1.0 if own in (PositionUnit.counts, PositionUnit.steps) else counts_per_unit
    return None
