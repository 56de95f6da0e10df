"""The way of every interpolation: check it, give it a path, begin it or put it into the spoolers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from polycnc.controllers.apci.board._commanded import CommandedBoard
from polycnc.controllers.apci.board._path_units import path_units
from polycnc.controllers.apci.board._shapes import Line, Shape
from polycnc.controllers.apci.board._units import PathUnits
from polycnc.controllers.apci.core._compiled_entries import begin_move
from polycnc.controllers.apci.core._registers import ErrorReg, ModeReg
from polycnc.controllers.apci.core._spool_entries import (
    give_back,
    new_entry,
    queued_position,
    spool_line,
    spool_move,
)


@dataclass(frozen=True, slots=True)
class Speeds:
    """Trajectory acceleration, velocity and target velocity, as they were programmed."""

    ac: float
    vl: float
    tvl: float = 0.0


def go(board: CommandedBoard, axes: Sequence[int], shape: Shape, speeds: Speeds) -> None:
    """Begin an interpolation at once, if nothing is wrong with it."""
    units = _checked(board, axes, speeds, shape.numbers)
    if units is not None:
        board.command(tuple(axes), partial(begin_interpolation, board, units, speeds, shape))


def queue(board: CommandedBoard, axes: Sequence[int], shape: Shape, speeds: Speeds, index: int = -1) -> None:
    """Put an interpolation into the spoolers, if nothing is wrong with it; a line may have an `index` (PcapIndex)."""
    units = _checked(board, axes, speeds, shape.numbers)
    if units is None:
        return
    if board.pending:
        board.in_turn(axes, partial(queue_interpolation, board, units, speeds, shape, index=index))
    else:
        queue_interpolation(board, units, speeds, shape, index=index)


def queue_interpolation(
    board: CommandedBoard, units: PathUnits, speeds: Speeds, shape: Shape, *, index: int = -1
) -> None:
    """Put an interpolation after what the spoolers of its axes hold."""
    ac, vl, tvl = units.acceleration(speeds.ac), units.velocity(speeds.vl), units.velocity(speeds.tvl)
    bases = units.velocity_unit, units.acceleration_unit
    if isinstance(shape, Line):
        ends, state = units.distance * shape.values, board.state
        base = board.kernel.base
        spool_line(state, base, units.axes, units.weight, ends, shape.relative, ac, vl, tvl, *bases, index)
        return
    start = [queued_position(board.state, board.kernel.base, i) for i in units.axes]
    e = _path(board, units, shape, start)
    if e >= 0:
        spool_move(board.state, e, units.axes, units.weight, ac, vl, tvl, *bases)


def _checked(
    board: CommandedBoard, axes: Sequence[int], speeds: Speeds, numbers: Sequence[float]
) -> PathUnits | None:
    """Return the units of an interpolation; None, with the reason in ErrorReg and dhef, if it is refused."""
    if len(set(axes)) < len(axes):
        board.raise_error(ErrorReg.errAxDef)
        return None
    closed = board.state.axis["closed"]
    for i in axes:
        if not closed[i]:
            return None
    units = path_units(board, axes)
    if units is None:
        board.raise_error(ErrorReg.errUnit)
    elif _is_consistent(board, units, speeds) and all(map(math.isfinite, numbers)):
        return units if axes else None
    for i in axes:
        board.state.axis[i]["dhef"] = 1
    return None


def _is_consistent(board: CommandedBoard, units: PathUnits, speeds: Speeds) -> bool:
    """Tell whether speeds can be meant; without velocity or acceleration it depends on InhibitProfileRefuse."""
    if speeds.vl == 0.0:
        board.raise_error(ErrorReg.VelocityZero)
    if speeds.ac == 0.0:
        board.raise_error(ErrorReg.AccelZero)
    if (speeds.vl == 0.0 or speeds.ac == 0.0) and not board.modereg & ModeReg.InhibitProfileRefuse:
        return False
    taken = (units.acceleration(speeds.ac), units.velocity(speeds.vl), units.velocity(speeds.tvl))
    return speeds.ac >= 0.0 and speeds.vl >= 0.0 and all(map(math.isfinite, taken))


def _path(board: CommandedBoard, units: PathUnits, shape: Shape, start: Sequence[float]) -> int:
    """Make an entry with a path that begins at machine positions `start`; -1 if there is none."""
    e = int(new_entry(board.state))
    if e < 0:
        return -1
    begin = np.zeros(len(board.axes))
    begin[units.axes] = units.weight * start
    if not shape.path(board, e, units, begin):
        give_back(board.state, e)
        return -1
    return e


def begin_interpolation(board: CommandedBoard, units: PathUnits, speeds: Speeds, shape: Shape) -> None:
    """Begin a direct interpolation from where the axes are now, with the speed they have."""
    state = board.state
    e = _path(board, units, shape, [float(board.kernel.base[i]) for i in units.axes])
    if e < 0:
        return
    velocities = [
        board.axes[i].profile_velocity() * weight for i, weight in zip(units.axes, units.weight, strict=True)
    ]
    counted = [v for i, v in zip(units.axes, velocities, strict=True) if state.feed_axis[i]]
    begin_move(
        state,
        e,
        units.axes,
        units.weight,
        units.acceleration(speeds.ac),
        units.velocity(speeds.vl),
        units.velocity(speeds.tvl),
        math.hypot(*(counted or velocities)),
    )
