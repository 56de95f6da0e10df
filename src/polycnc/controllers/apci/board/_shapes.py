"""The paths of interpolations, from what was programmed: absolute values count from the axes' origins."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from polycnc.controllers.apci.board._commanded import CommandedBoard
from polycnc.controllers.apci.board._records import TARGET_POINT_PHI
from polycnc.controllers.apci.board._units import PathUnits
from polycnc.controllers.apci.core._paths import fill_arc, fill_circle3d, fill_line
from polycnc.controllers.apci.core._registers import ErrorReg
from polycnc.controllers.apci.core._spool_entries import HARDLY_ANY
from polycnc.controllers.apci.core._state import Floats


def _ends(
    board: CommandedBoard,
    units: PathUnits,
    begin: Floats,
    values: Sequence[float],
    relative: bool,
    count: int,
) -> Floats:
    """Return the end point of a path of the first `count` axes, path units."""
    end = begin.copy()
    axes = units.axes[:count]
    origins = begin[axes] if relative else units.weight[:count] * [board.axes[i].origin for i in axes]
    end[axes] = units.distance[:count] * values + origins
    return end


def _is_path(board: CommandedBoard, units: PathUnits, length: float) -> bool:
    if length < HARDLY_ANY:
        board.raise_error(ErrorReg.ZeroProfile)
        return False
    if not math.isfinite(length):
        _refuse(board, units)
        return False
    return True


def _refuse(board: CommandedBoard, units: PathUnits) -> None:
    for i in units.axes:
        board.state.axis[i]["dhef"] = 1


def _refuse_radius(board: CommandedBoard, units: PathUnits) -> bool:
    board.raise_error(ErrorReg.RadiusError)
    board.raise_error(ErrorReg.errCenterPoint)
    _refuse(board, units)
    return False


class Shape(Protocol):
    """What a motion of interpolation describes; a path when it is known where it begins."""

    @property
    def numbers(self) -> Sequence[float]:
        """Return all its numbers, which must be finite."""
        ...

    def path(self, board: CommandedBoard, e: int, units: PathUnits, begin: Floats) -> bool:
        """Make entry `e` the path from `begin`, path units; False, with the reason in ErrorReg, if there is none."""
        ...


@dataclass(frozen=True, slots=True)
class Line:
    """A straight line to `values`, one per axis, or by them."""

    values: Sequence[float]
    relative: bool = False

    @property
    def numbers(self) -> Sequence[float]:
        """Return all its numbers."""
        return self.values

    def path(self, board: CommandedBoard, e: int, units: PathUnits, begin: Floats) -> bool:
        """Make entry `e` the line."""
        end = _ends(board, units, begin, self.values, self.relative, len(units.axes))
        return _is_path(board, units, fill_line(board.state.seg, e, board.state.feed_axis, begin, end))


@dataclass(frozen=True, slots=True)
class Circle:
    """A circle of the first two axes about `center`, through `phi_deg`, positive from the first to the second axis."""

    center: Sequence[float]
    phi_deg: float
    relative: bool = False

    @property
    def numbers(self) -> Sequence[float]:
        """Return all its numbers."""
        return (*self.center, self.phi_deg)

    def path(self, board: CommandedBoard, e: int, units: PathUnits, begin: Floats) -> bool:
        """Make entry `e` the circle."""
        return _arc(board, e, units, begin, self.center, self.phi_deg, (), self.relative)


@dataclass(frozen=True, slots=True)
class Helix:
    """A circle of the first two axes, all others linear to their `ends` (one per axis).

    With hardly any angle the circle ends at the target point; the sign of `phi_deg` is its sense.
    """

    center: Sequence[float]
    phi_deg: float
    ends: Sequence[float]
    relative: bool = False

    @property
    def numbers(self) -> Sequence[float]:
        """Return all its numbers."""
        return (*self.center, self.phi_deg, *self.ends)

    def path(self, board: CommandedBoard, e: int, units: PathUnits, begin: Floats) -> bool:
        """Make entry `e` the helix."""
        return _arc(board, e, units, begin, self.center, self.phi_deg, self.ends, self.relative)


@dataclass(frozen=True, slots=True)
class SpaceCircle:
    """A circle of the first three axes about a line through `center`, by the right hand about `normal`."""

    center: Sequence[float]
    normal: Sequence[float]
    phi_deg: float
    relative: bool = False

    @property
    def numbers(self) -> Sequence[float]:
        """Return all its numbers."""
        return (*self.center, *self.normal, self.phi_deg)

    def path(self, board: CommandedBoard, e: int, units: PathUnits, begin: Floats) -> bool:
        """Make entry `e` the circle."""
        if len(units.axes) < 3:
            _refuse(board, units)
            return False
        p, q, r = (int(i) for i in units.axes[:3])
        middle = _ends(board, units, begin, self.center, self.relative, 3)[[p, q, r]]
        facing = np.array(self.normal, np.float64)
        length = float(fill_circle3d(board.state.seg, e, begin, p, q, r, middle, facing, self.phi_deg))
        if length < HARDLY_ANY and self.phi_deg != 0.0:
            return _refuse_radius(board, units)
        return _is_path(board, units, length)


def _arc(
    board: CommandedBoard,
    e: int,
    units: PathUnits,
    begin: Floats,
    center: Sequence[float],
    phi_deg: float,
    ends: Sequence[float],
    relative: bool,
) -> bool:
    """Make entry `e` a circle of the first two axes; with `ends` the others go to theirs."""
    if len(units.axes) < 2:
        _refuse(board, units)
        return False
    p, q = (int(i) for i in units.axes[:2])
    middle = _ends(board, units, begin, center, relative, 2)
    dp, dq = begin[p] - middle[p], begin[q] - middle[q]
    radius = math.hypot(dp, dq)
    if not HARDLY_ANY <= radius < math.inf:
        return _refuse_radius(board, units)
    end = _ends(board, units, begin, ends, relative, len(units.axes)) if ends else begin.copy()
    sweep = math.radians(phi_deg)
    angle = math.atan2(dq, dp)
    if ends and abs(phi_deg) <= TARGET_POINT_PHI:
        turned = math.atan2(end[q] - middle[q], end[p] - middle[p]) - angle
        sweep = turned % (2.0 * math.pi) or 2.0 * math.pi
        if math.copysign(1.0, phi_deg) < 0.0:
            sweep = sweep - 2.0 * math.pi or -2.0 * math.pi
    end[p] = middle[p] + radius * math.cos(angle + sweep)
    end[q] = middle[q] + radius * math.sin(angle + sweep)
    seg, feed_axis = board.state.seg, board.state.feed_axis
    return _is_path(board, units, fill_arc(seg, e, feed_axis, begin, end, p, q, middle[p], middle[q], sweep))
