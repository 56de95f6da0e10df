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
    ratio,
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
    chosen = _chosen(board)
    if chosen is None:
        return 1.0, 1.0
    _, length, time_s = chosen
    return length / time_s, length / (time_s * time_s)


def _chosen(board: CommandedBoard) -> tuple[PositionUnit, float, float] | None:
    """Return the unit of position, how many path units and how many seconds the units in force are, if they exist."""
    pu, tu = board.variables.pu, board.variables.tu
    if pu not in PositionUnit.__members__.values() or tu not in TimeUnit.__members__.values():
        return None
    unit = PositionUnit(pu)
    length = MILLIMETRES.get(unit) or DEGREES.get(unit) or 1.0
    return unit, length, seconds(TimeUnit(tu), board.config.sample_time_s)


def _units(board: CommandedBoard, axes: Sequence[int]) -> PathUnits | None:
    chosen = _chosen(board)
    if chosen is None:
        return None
    unit, length, _ = chosen
    of_length = PositionUnit.mm if unit in MILLIMETRES else PositionUnit.counts
    measure = PositionUnit.deg if unit in DEGREES else of_length
    weight = np.ones(len(axes))
    distance = np.ones(len(axes))
    for k, i in enumerate(axes):
        axis = board.axes[i]
        own = axis.setup.position_unit
        per_unit = ratio(own, measure, axis.counts_per_unit)
        distance[k] = length
        if per_unit is None and own in DEGREES and unit in MILLIMETRES and axis.effradius > 0.0:
            per_unit = DEGREES[own] * math.radians(1.0) * axis.effradius * length
            if board.modereg & ModeReg.rotaxisunit:
                distance[k] = per_unit
        if per_unit is None:
            return None
        weight[k] = per_unit
    return PathUnits(*trajectory_units(board), np.array(axes, np.int64), weight, distance)
