"""A picture of a path that is as small as a stamp."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from polycnc.machine import MachineConfig
from polycnc.runner.view import Track, kept_rows

WIDTH, HEIGHT = 96.0, 64.0
_EDGE = 3.0
_MOST = 400  # points; about 4 kB

Floats = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]


def thumbnail(track: Track, machine: MachineConfig) -> tuple[str, str] | None:
    """Return cuts and rapids as SVG path data, seen from above (a lathe in profile); None where nothing moves."""
    linear = [i for i, axis in enumerate(machine.axes) if axis.unit == "mm"]
    if len(linear) < 2 or not len(track.t_s):
        return None
    across, up = linear[0], linear[1]
    if len(linear) == 2 and [machine.axes[i].name for i in linear] == ["X", "Z"]:
        across, up = up, across
    points = track.position[:, [across, up]]
    shown = points[~track.rapid] if not track.rapid.all() else points
    low, high = shown.min(axis=0), shown.max(axis=0)
    size = float(np.max((high - low) / (WIDTH - 2 * _EDGE, HEIGHT - 2 * _EDGE)))
    if size <= 0.0:
        return None
    placed = (points - 0.5 * (low + high)) / size * (1.0, -1.0) + (WIDTH / 2.0, HEIGHT / 2.0)
    placed, cuts = _thinned(np.clip(placed, -WIDTH, 2.0 * WIDTH), ~track.rapid)
    return _path(placed, cuts), _path(placed, ~cuts)


def svg(paths: tuple[str, str], width_px: int) -> str:
    """Return a picture of cuts and rapids as an SVG element."""
    cuts, rapids = paths
    return (
        f'<svg viewBox="0 0 {WIDTH:g} {HEIGHT:g}" width="{width_px}" role="img" aria-label="path">'
        f'<path d="{rapids}" fill="none" stroke="#8a949d" stroke-width="0.4" stroke-dasharray="2 1.5"/>'
        f'<path d="{cuts}" fill="none" stroke="#0072b2" stroke-width="0.8"/></svg>'
    )


def _thinned(points: Floats, cuts: Flags) -> tuple[Floats, Flags]:
    """Leave out the points that nobody would see, for as long as there are many."""
    tolerance = 0.2
    while True:
        way = np.sqrt((np.diff(points, axis=0) ** 2).sum(1))
        moves = np.concatenate(([True], way > 0.0))
        points, cuts, way = points[moves], cuts[moves], way[moves[1:]]
        forced = np.zeros(len(points), np.bool_)
        forced[:-1] = np.diff(cuts)
        kept = kept_rows(np.concatenate(([0.0], np.cumsum(way))), points / tolerance, forced)
        points, cuts = points[kept], cuts[kept]
        if len(points) <= _MOST or tolerance > 4.0:
            return points[:_MOST], cuts[:_MOST]
        tolerance *= 2.0


def _path(points: Floats, wanted: Flags) -> str:
    """Return the lines that end at the wanted points."""
    parts: list[str] = []
    drawn = -1
    texts = [f"{x:.1f} {y:.1f}" for x, y in points.tolist()]
    for i in np.flatnonzero(wanted).tolist():
        if i == 0:
            continue
        if drawn != i - 1:
            parts.append(f"M{texts[i - 1]}")
        if texts[i] != texts[i - 1]:
            parts.append(f"L{texts[i]}")
        drawn = i
    return "".join(parts)
