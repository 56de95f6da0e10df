"""From the units of an interpolation (TRU) to path units: mm, degrees or counts, and seconds.

The position unit decides what a path is measured in. A rotary axis takes part in a path of millimetres with the
circumference at its effective radius (Manual 002, 2.3.4).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from polycnc.controllers.apci.board._commanded import CommandedBoard
from polycnc.controllers.apci.board._units import (
    DEGREES,
    MILLIMETRES,
    PathUnits,
    PositionUnit,
    TimeUnit,
    seconds,
)
from polycnc.controllers.apci.core._registers import ModeReg

_ROTARY = int(ModeReg.rotaxisunit)
_KEPT = 64


def path_units(board: CommandedBoard, axes: Sequence[int]) -> PathUnits | None:
    """Return the units in force for an interpolation of `axes`; None if an axis does not fit the position unit.

    They are kept on the board until something changes that they depend on.
    """
    variables = board.variables
    key = (tuple(axes), variables.pu, variables.tu, int(board.state.board[0]["mode_register"]) & _ROTARY)
    known = board.units_in_use
    if key not in known:
        if len(known) >= _KEPT:
            known.clear()
        known[key] = _units(board, axes)
    return known[key]


def trajectory_units(board: CommandedBoard) -> tuple[float, float]:
    """Return path units/s and path units/s2 per unit of velocity and acceleration, whatever the axes."""
    variables = board.variables
    if (
        variables.pu not in PositionUnit.__members__.values()
        or variables.tu not in TimeUnit.__members__.values()
    ):
        return 1.0, 1.0
    unit = PositionUnit(variables.pu)
    length = MILLIMETRES.get(unit) or DEGREES.get(unit) or 1.0
    time_s = seconds(TimeUnit(variables.tu), board.config.sample_time_s)
    return length / time_s, length / (time_s * time_s)


def _units(board: CommandedBoard, axes: Sequence[int]) -> PathUnits | None:
    variables = board.variables
    if (
        variables.pu not in PositionUnit.__members__.values()
        or variables.tu not in TimeUnit.__members__.values()
    ):
        return None
    unit = PositionUnit(variables.pu)
    weight = np.ones(len(axes))
    distance = np.ones(len(axes))
    length = MILLIMETRES.get(unit) or DEGREES.get(unit) or 1.0
    for k, i in enumerate(axes):
        axis = board.axes[i]
        own = axis.setup.position_unit
        per_unit = _weight(axis.counts_per_unit, own, unit)
        distance[k] = length
        if per_unit is None and own in DEGREES and unit in MILLIMETRES and axis.effradius > 0.0:
            per_unit = DEGREES[own] * math.radians(1.0) * axis.effradius * length
            if board.modereg & ModeReg.rotaxisunit:
                distance[k] = per_unit
        if per_unit is None:
            return None
        weight[k] = per_unit
    time_s = seconds(TimeUnit(variables.tu), board.config.sample_time_s)
    return PathUnits(length / time_s, length / (time_s * time_s), np.array(axes, np.int64), weight, distance)


def _weight(counts_per_unit: float, own: PositionUnit, unit: PositionUnit) -> float | None:
    """Return path units per unit of an axis, None if they are of different kinds."""
    for kind in (MILLIMETRES, DEGREES):
        if own in kind and unit in kind:
            return kind[own]
    if unit in (PositionUnit.counts, PositionUnit.steps):
        return 1.0 if own in (PositionUnit.counts, PositionUnit.steps) else counts_per_unit
    return None
