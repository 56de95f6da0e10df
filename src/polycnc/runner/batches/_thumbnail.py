"""A picture of a path that is as small as a stamp."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from polycnc.machine import MachineConfig
from polycnc.runner.plots._styles import END, RAPID, tool_colour
from polycnc.runner.view._part_frame import turns, with_part_frame
from polycnc.runner.view._thin import kept_rows
from polycnc.runner.view._track import Track

WIDTH, HEIGHT = 96.0, 64.0
_EDGE = 3.0
_MOST = 400  # points; about 4 kB

Floats = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class _Drawing:
    """Places in the box [points, 2], which of them end cuts, the tool of each, and where a lathe's axis is."""

    points: Floats
    cuts: Flags
    tools: npt.NDArray[np.int64]
    axis: float | None


def thumbnail(track: Track, machine: MachineConfig) -> tuple[str, str] | None:
    """Return cuts and rapids as SVG path data, seen from above (a lathe in profile); None where nothing moves."""
    drawing = _drawing(track, machine)
    return (
        None
        if drawing is None
        else (_path(drawing.points, drawing.cuts), _path(drawing.points, ~drawing.cuts))
    )


def picture(track: Track, machine: MachineConfig, width_px: int) -> str:
    """Return a picture as an SVG element: tools in their colours, a ring at the start, a cross at the end.

    It is empty where nothing moves.
    """
    drawing = _drawing(track, machine)
    if drawing is None:
        return ""
    shapes = []
    if drawing.axis is not None:
        shapes.append(
            f'<path d="M0 {drawing.axis:.1f}H{WIDTH:g}" fill="none" stroke="{END}" stroke-width="0.3" '
            'stroke-dasharray="4 1 0.6 1"/>'
        )
    shapes.append(
        f'<path d="{_path(drawing.points, ~drawing.cuts)}" fill="none" stroke="{RAPID}" stroke-width="0.4" '
        'stroke-dasharray="2 1.5"/>'
    )
    for place, tool in enumerate(np.unique(drawing.tools[drawing.cuts]).tolist()):
        cuts = _path(drawing.points, drawing.cuts & (drawing.tools == tool))
        shapes.append(
            f'<path d="{cuts}" fill="none" stroke="{tool_colour(place)}" stroke-width="0.8">'
            f"<title>T{tool}</title></path>"
        )
    (x, y), (end_x, end_y) = np.clip(drawing.points[[0, -1]], 1.5, (WIDTH - 1.5, HEIGHT - 1.5)).tolist()
    shapes.append(
        f'<circle cx="{x:.1f}" cy="{y:.1f}" r="1.3" fill="none" stroke="{END}" stroke-width="0.5"><title>start</title>'
        f'</circle><path d="M{end_x - 0.9:.1f} {end_y - 0.9:.1f}l1.8 1.8m0 -1.8l-1.8 1.8" fill="none" stroke="{END}" '
        'stroke-width="0.5"><title>end</title></path>'
    )
    return (
        f'<svg viewBox="0 0 {WIDTH:g} {HEIGHT:g}" width="{width_px}" role="img" aria-label="path" '
        f'style="background:#fff">{"".join(shapes)}</svg>'
    )


def _drawing(track: Track, machine: MachineConfig) -> _Drawing | None:
    linear = [i for i, axis in enumerate(machine.axes) if axis.unit == "mm"]
    if len(linear) < 2 or not len(track.t_s):
        return None
    across, up = linear[0], linear[1]
    is_lathe = [machine.axes[i].name for i in linear] == ["X", "Z"]
    if is_lathe:
        across, up = up, across
    if turns(track, machine):
        track = with_part_frame(track, machine)
        across, up = len(machine.axes), len(machine.axes) + 1
    points = track.position[:, [across, up]]
    shown = points[~track.rapid] if not track.rapid.all() else points
    low, high = shown.min(axis=0), shown.max(axis=0)
    if is_lathe:
        low[1] = min(low[1], 0.0)
    size = float(np.max((high - low) / (WIDTH - 2 * _EDGE, HEIGHT - 2 * _EDGE)))
    if size <= 0.0:
        return None

    def placed(places: Floats) -> Floats:
        found: Floats = (places - 0.5 * (low + high)) / size * (1.0, -1.0) + (WIDTH / 2.0, HEIGHT / 2.0)
        return found

    found, cuts, tools = _thinned(np.clip(placed(points), -WIDTH, 2.0 * WIDTH), ~track.rapid, track.tools())
    return _Drawing(found, cuts, tools, float(placed(np.zeros((1, 2)))[0, 1]) if is_lathe else None)


def _thinned(
    points: Floats, cuts: Flags, tools: npt.NDArray[np.int64]
) -> tuple[Floats, Flags, npt.NDArray[np.int64]]:
    """Leave out the points that nobody would see, for as long as there are many."""
    tolerance = 0.2
    while True:
        way = np.sqrt((np.diff(points, axis=0) ** 2).sum(1))
        moves = np.concatenate(([True], way > 0.0))
        points, cuts, tools, way = points[moves], cuts[moves], tools[moves], way[moves[1:]]
        forced = np.zeros(len(points), np.bool_)
        forced[:-1] = np.diff(cuts) | (np.diff(tools) != 0)
        kept = kept_rows(np.concatenate(([0.0], np.cumsum(way))), points / tolerance, forced)
        points, cuts, tools = points[kept], cuts[kept], tools[kept]
        if len(points) <= _MOST or tolerance > 4.0:
            return points[:_MOST], cuts[:_MOST], tools[:_MOST]
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
