"""Interpolation: lines, circles, helices, circles in space, at once or into the spoolers (Manual 002, 4.4.28 ff.).

Axes by their numbers, `distances` one per axis in that order; speeds and distances in the units that ctru set.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from polycnc.controllers.apci._entries import Mask, begin_move, fill_arc, fill_circle3d, fill_line
from polycnc.controllers.apci._path_units import PathUnits, path_units
from polycnc.controllers.apci._records import TARGET_POINT_PHI
from polycnc.controllers.apci._registers import ErrorReg, ModeReg
from polycnc.controllers.apci._spool_commands import free_entry, give_back, queue_entry, queued_position
from polycnc.controllers.apci._state import MOVE, Floats

if TYPE_CHECKING:
    from polycnc.controllers.apci._board import Board

HARDLY_ANY = 1e-9  # path units: a distance or a radius below it is none


@dataclass(frozen=True, slots=True)
class Speeds:
    """Trajectory acceleration, velocity and target velocity, as they were programmed."""

    ac: float
    vl: float
    tvl: float = 0.0


# Make entry `e` the path from `start`, [n] path units; the length of the path, 0 if there is none.
Shape = Callable[["Board", int, PathUnits, Floats], float]


def mla(
    board: Board, axes: Sequence[int], targets: Sequence[float], speeds: Speeds, *, spool: bool = False
) -> None:
    """Move on a straight line to absolute positions."""
    _move(board, axes, speeds, partial(_line, axes=axes, values=targets, relative=False), targets, spool)


def mlr(
    board: Board, axes: Sequence[int], distances: Sequence[float], speeds: Speeds, *, spool: bool = False
) -> None:
    """Move on a straight line by distances."""
    _move(board, axes, speeds, partial(_line, axes=axes, values=distances, relative=True), distances, spool)


def mca(
    board: Board,
    axes: Sequence[int],
    center: Sequence[float],
    phi_deg: float,
    speeds: Speeds,
    *,
    spool: bool = False,
) -> None:
    """Move on a circle about an absolute centre through `phi_deg`, positive from the first to the second axis."""
    _circular(board, axes, center, phi_deg, (), speeds, False, spool)


def mcr(
    board: Board,
    axes: Sequence[int],
    center: Sequence[float],
    phi_deg: float,
    speeds: Speeds,
    *,
    spool: bool = False,
) -> None:
    """Move on a circle about a centre given from the starting point."""
    _circular(board, axes, center, phi_deg, (), speeds, True, spool)


def mha(
    board: Board,
    axes: Sequence[int],
    center: Sequence[float],
    phi_deg: float,
    targets: Sequence[float],
    speeds: Speeds,
    *,
    spool: bool = False,
) -> None:
    """Move on a helix: a circle of the first two axes, all others linear to `targets` (one per axis).

    With hardly any angle the circle ends at the target point; the sign of `phi_deg` is its sense.
    """
    _circular(board, axes, center, phi_deg, targets, speeds, False, spool)


def mhr(
    board: Board,
    axes: Sequence[int],
    center: Sequence[float],
    phi_deg: float,
    distances: Sequence[float],
    speeds: Speeds,
    *,
    spool: bool = False,
) -> None:
    """Move on a helix, everything given from the starting point."""
    _circular(board, axes, center, phi_deg, distances, speeds, True, spool)


def mca3d(
    board: Board,
    axes: Sequence[int],
    center: Sequence[float],
    normal: Sequence[float],
    phi_deg: float,
    speeds: Speeds,
    *,
    spool: bool = False,
) -> None:
    """Move on a circle in space about an absolute centre, by the right hand about `normal`."""
    shape = partial(_space, axes=axes, center=center, normal=normal, phi_deg=phi_deg, relative=False)
    _move(board, axes, speeds, shape, (*center, *normal, phi_deg), spool)


def mcr3d(
    board: Board,
    axes: Sequence[int],
    center: Sequence[float],
    normal: Sequence[float],
    phi_deg: float,
    speeds: Speeds,
    *,
    spool: bool = False,
) -> None:
    """Move on a circle in space about a centre given from the starting point."""
    shape = partial(_space, axes=axes, center=center, normal=normal, phi_deg=phi_deg, relative=True)
    _move(board, axes, speeds, shape, (*center, *normal, phi_deg), spool)


def _circular(
    board: Board,
    axes: Sequence[int],
    center: Sequence[float],
    phi_deg: float,
    ends: Sequence[float],
    speeds: Speeds,
    relative: bool,
    spool: bool,
) -> None:
    shape = partial(_arc, axes=axes, center=center, phi_deg=phi_deg, ends=ends, relative=relative)
    _move(board, axes, speeds, shape, (*center, phi_deg, *ends), spool)


# ---------------------------------------------------------------------- the way of every interpolation


def _move(
    board: Board, axes: Sequence[int], speeds: Speeds, shape: Shape, numbers: Sequence[float], spool: bool
) -> None:
    """Check an interpolation, and begin it or put it into the spoolers."""
    if not _is_acceptable(board, axes, speeds, numbers):
        return
    units = path_units(board, axes)
    if units is None:
        board.raise_error(ErrorReg.errUnit)
        return
    if spool:
        start = {i: queued_position(board, i) for i in axes}
        e = _entry(board, axes, units, speeds, shape, start)
        if e >= 0:
            if board.modereg & ModeReg.maxcheck:
                _limit_line(board, e, axes, units)
            queue_entry(board, axes, e)
        return
    for i in axes:
        row = board.state.axis[i]
        row["pe"] = 0
        row["commanded"] += 1
        row["saf"] = 0
    board.later(partial(_begin, board, tuple(axes), units, speeds, shape))


def _is_acceptable(board: Board, axes: Sequence[int], speeds: Speeds, numbers: Sequence[float]) -> bool:
    if len(set(axes)) < len(axes):
        board.raise_error(ErrorReg.errAxDef)
        return False
    if not axes or not all(map(math.isfinite, (*numbers, speeds.ac, speeds.vl, speeds.tvl))):
        return False
    if speeds.vl == 0.0:
        board.raise_error(ErrorReg.VelocityZero)
    if speeds.ac == 0.0:
        board.raise_error(ErrorReg.AccelZero)
    return speeds.vl > 0.0 and speeds.ac > 0.0 and all(board.state.axis[i]["closed"] for i in axes)


def _entry(
    board: Board, axes: Sequence[int], units: PathUnits, speeds: Speeds, shape: Shape, start: dict[int, float]
) -> int:
    """Make an entry that begins at machine positions `start`; -1 if it is refused, with the reason in ErrorReg."""
    e = free_entry(board)
    if e < 0:
        return -1
    state = board.state
    entry = state.entry[e]
    state.weight[e] = 1.0
    begin = np.zeros(len(board.axes))
    for i in axes:
        state.weight[e, i] = units.weight[i]
        begin[i] = start[i] * units.weight[i]
    if shape(board, e, units, begin) <= 0.0:
        give_back(board, e)
        return -1
    for i in axes:
        state.axis[i]["tp"] = state.seg.end[e, i] / state.weight[e, i] - board.axes[i].origin
    entry["kind"] = MOVE
    entry["mask"] = sum(1 << i for i in axes)
    entry["refs"] = len(axes)
    entry["ac"] = units.acceleration(speeds.ac)
    entry["vl"] = units.velocity(speeds.vl)
    entry["tvl"] = units.velocity(speeds.tvl)
    entry["out"] = math.nan
    return e


def _begin(board: Board, axes: tuple[int, ...], units: PathUnits, speeds: Speeds, shape: Shape) -> None:
    """Begin a direct interpolation from where the axes are now, with the speed they have."""
    rows = [board.state.axis[i] for i in axes]
    for row in rows:
        row["commanded"] -= 1
    if not all(row["closed"] for row in rows):
        return
    e = _entry(board, axes, units, speeds, shape, {i: float(board.kernel.base[i]) for i in axes})
    if e < 0:
        for row in rows:
            row["pe"] = row["motion"] == 0 and row["commanded"] == 0
        return
    velocities = [board.profile_velocity(i) * units.weight[i] for i in axes if not board.nfrax >> i & 1]
    begin_move(board.state, board.kernel, e, math.hypot(*velocities) if velocities else 0.0)


def _limit_line(board: Board, e: int, axes: Sequence[int], units: PathUnits) -> None:
    """Lower velocity and acceleration of a spooled line to MaxVel and MaxAcc of its axes."""
    entry, seg = board.state.entry[e], board.state.seg
    if seg.row[e]["kind"] != 0:
        return
    for i in axes:
        part = abs(float(seg.end[e, i] - seg.start[e, i])) / float(seg.row[e]["length"])
        axis = board.axes[i]
        if part > 0.0 and axis.MaxVel > 0.0:
            entry["vl"] = min(float(entry["vl"]), units.velocity(axis.MaxVel) / part)
            entry["tvl"] = min(float(entry["tvl"]), float(entry["vl"]))
        if part > 0.0 and axis.MaxAcc > 0.0:
            entry["ac"] = min(float(entry["ac"]), units.acceleration(axis.MaxAcc) / part)


# ---------------------------------------------------------------------- shapes


def _feed_axes(board: Board) -> Mask:
    """Return which axes count for the path."""
    return np.array([0 if board.nfrax >> i & 1 else 1 for i in range(len(board.axes))], np.uint8)


def _ends(
    board: Board,
    units: PathUnits,
    begin: Floats,
    axes: Sequence[int],
    values: Sequence[float],
    relative: bool,
) -> Floats:
    """Return the end point of a path, path units: absolute values count from the axes' origins."""
    end = begin.copy()
    for i, value in zip(axes, values, strict=True):
        if relative:
            end[i] = begin[i] + value * units.distance[i]
        else:
            end[i] = value * units.distance[i] + board.axes[i].origin * units.weight[i]
    return end


def _line(
    board: Board,
    e: int,
    units: PathUnits,
    begin: Floats,
    *,
    axes: Sequence[int],
    values: Sequence[float],
    relative: bool,
) -> float:
    end = _ends(board, units, begin, axes, values, relative)
    length = float(fill_line(board.state.seg, e, _feed_axes(board), begin, end))
    if length < HARDLY_ANY:
        board.raise_error(ErrorReg.ZeroProfile)
        return 0.0
    return length


def _arc(
    board: Board,
    e: int,
    units: PathUnits,
    begin: Floats,
    *,
    axes: Sequence[int],
    center: Sequence[float],
    phi_deg: float,
    ends: Sequence[float],
    relative: bool,
) -> float:
    p, q = axes[0], axes[1]
    middle = _ends(board, units, begin, (p, q), center, relative)
    dp, dq = begin[p] - middle[p], begin[q] - middle[q]
    radius = math.hypot(dp, dq)
    if radius < HARDLY_ANY:
        board.raise_error(ErrorReg.RadiusError)
        board.raise_error(ErrorReg.errCenterPoint)
        return 0.0
    end = _ends(board, units, begin, axes, ends, relative) if ends else begin.copy()
    sweep = math.radians(phi_deg)
    angle = math.atan2(dq, dp)
    if ends and abs(phi_deg) <= TARGET_POINT_PHI:
        turned = math.atan2(end[q] - middle[q], end[p] - middle[p]) - angle
        clockwise = math.copysign(1.0, phi_deg) < 0.0
        sweep = turned % (2.0 * math.pi) or 2.0 * math.pi
        if clockwise:
            sweep -= 2.0 * math.pi
            sweep = sweep or -2.0 * math.pi
    end[p] = middle[p] + radius * math.cos(angle + sweep)
    end[q] = middle[q] + radius * math.sin(angle + sweep)
    length = float(
        fill_arc(board.state.seg, e, _feed_axes(board), begin, end, p, q, middle[p], middle[q], sweep)
    )
    if length < HARDLY_ANY:
        board.raise_error(ErrorReg.ZeroProfile)
        return 0.0
    return length


def _space(
    board: Board,
    e: int,
    units: PathUnits,
    begin: Floats,
    *,
    axes: Sequence[int],
    center: Sequence[float],
    normal: Sequence[float],
    phi_deg: float,
    relative: bool,
) -> float:
    p, q, r = axes[:3]
    middle = _ends(board, units, begin, (p, q, r), center, relative)[[p, q, r]]
    length = float(
        fill_circle3d(board.state.seg, e, begin, p, q, r, middle, np.array(normal, np.float64), phi_deg)
    )
    if length < HARDLY_ANY:
        board.raise_error(ErrorReg.ZeroProfile if phi_deg == 0.0 else ErrorReg.RadiusError)
        return 0.0
    return length
