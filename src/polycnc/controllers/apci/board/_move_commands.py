"""Interpolation: lines, circles, helices, circles in space, at once or into the spoolers (Manual 002, 4.4.28 ff.).

Axes by their numbers, `distances` one per axis in that order; speeds and distances in the units that ctru set.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

from polycnc.controllers.apci.board._interpolation import Speeds, interpolate, queue_line
from polycnc.controllers.apci.board._shapes import arc, circle_in_space, line

if TYPE_CHECKING:
    from polycnc.controllers.apci.board._board import Board

__all__ = ["Speeds", "mca", "mca3d", "mcr", "mcr3d", "mha", "mhr", "mla", "mlr"]


def mla(
    board: Board,
    axes: Sequence[int],
    targets: Sequence[float],
    speeds: Speeds,
    *,
    spool: bool = False,
    index: int = -1,
) -> None:
    """Move on a straight line to absolute positions; a spooled one may have an `index` (PcapIndex)."""
    if spool:
        queue_line(board, axes, targets, speeds, False, index)
    else:
        interpolate(board, axes, speeds, partial(line, values=targets, relative=False), targets, False)


def mlr(
    board: Board,
    axes: Sequence[int],
    distances: Sequence[float],
    speeds: Speeds,
    *,
    spool: bool = False,
    index: int = -1,
) -> None:
    """Move on a straight line by distances; a spooled one may have an `index` (PcapIndex)."""
    if spool:
        queue_line(board, axes, distances, speeds, True, index)
    else:
        interpolate(board, axes, speeds, partial(line, values=distances, relative=True), distances, False)


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
    shape = partial(circle_in_space, center=center, normal=normal, phi_deg=phi_deg, relative=False)
    interpolate(board, axes, speeds, shape, (*center, *normal, phi_deg), spool)


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
    shape = partial(circle_in_space, center=center, normal=normal, phi_deg=phi_deg, relative=True)
    interpolate(board, axes, speeds, shape, (*center, *normal, phi_deg), spool)


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
    shape = partial(arc, center=center, phi_deg=phi_deg, ends=ends, relative=relative)
    interpolate(board, axes, speeds, shape, (*center, phi_deg, *ends), spool)
