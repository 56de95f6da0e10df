"""What is drawn of a run: its points in the frame of a part, which tool moves when, and the part of space to show."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from polycnc.machine import LinearAxis, MachineConfig
from polycnc.runner.view._part_frame import turns, with_part_frame
from polycnc.runner.view._track import Track

Floats = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]

_MARGIN = 0.15  # of the larger side of the cuts: how much of the rapids around them is drawn
RAPIDS = -1


@dataclass(frozen=True)
class Scene:
    """Hold the path to draw.

    `points` [points, 1 to 3] are drawn with `labels`; `low` and `high` bound the part of space that is shown: the cuts
    and a margin, and where nothing is cut, everything. `kind` [points] is the place in `tools` of the tool that cuts on
    the way to the point, or `RAPIDS`. `track` holds the same points over time.
    """

    track: Track
    points: Floats
    labels: tuple[str, ...]
    low: Floats
    high: Floats
    kind: npt.NDArray[np.int64]
    tools: tuple[int, ...]
    moves: Flags  # [points]
    on_part: bool
    is_lathe: bool
    diameters: bool

    def seen(self, columns: list[int]) -> Floats:
        """Return some columns of the points, NaN where one of them is outside."""
        points, low, high = self.points[:, columns], self.low[columns], self.high[columns]
        outside = np.any((points < low) | (points > high), axis=1)
        return np.where(outside[:, None], np.nan, points)

    def lines(self, values: Floats) -> dict[int, Floats]:
        """Return for each kind the values [points, columns] of its stretches, one after the other with gaps of NaN."""
        gap = np.full((1, values.shape[1]), np.nan)
        parts: dict[int, list[Floats]] = {}
        for first, last, kind in self._stretches():
            parts.setdefault(kind, []).extend((values[first:last], gap))
        return {kind: np.concatenate(parts[kind]) for kind in sorted(parts)}

    def _stretches(self) -> list[tuple[int, int, int]]:
        """Return the stretches of equal kind as (first row, last row, kind); each begins where the one before ended."""
        edges = np.flatnonzero(np.diff(self.kind)) + 1
        bounds = [0, *edges.tolist(), len(self.kind)]
        return [(max(first - 1, 0), last, int(self.kind[first])) for first, last in pairwise(bounds)]


def scene(track: Track, axes: tuple[tuple[str, str], ...], machine: MachineConfig | None) -> Scene:
    """Return what to draw of a track that has points; `axes` are names and units of its columns."""
    linear = [i for i, (_, unit) in enumerate(axes) if unit == "mm"]
    framed = machine is not None and turns(track, machine)
    if machine is not None and framed:
        track = with_part_frame(track, machine)
        columns = [len(axes), len(axes) + 1, len(axes) + 2]
        labels: tuple[str, ...] = ("X [mm]", "Y [mm]", "Z [mm]")
    else:
        columns = linear[:3]
        labels = tuple(f"{axes[i][0]} [mm]" for i in columns)
    points = track.position[:, columns]
    moves = np.concatenate(([False], np.any(np.diff(points, axis=0) != 0.0, axis=1)))
    number = track.tools()
    cuts = ~track.rapid & moves
    tools = tuple(np.unique(number[cuts]).tolist())
    kind = np.where(track.rapid, RAPIDS, np.searchsorted(np.array(tools, np.int64), number))
    kind = np.where(np.isin(number, tools) | track.rapid, kind, RAPIDS)
    is_lathe = [axes[i][0] for i in linear] == ["X", "Z"]
    low, high = _bounds(points, cuts)
    if is_lathe:
        low[0], high[0] = min(low[0], 0.0), max(high[0], 0.0)
    x = machine.axes[linear[0]] if is_lathe and machine is not None else None
    return Scene(
        track, points, labels, low, high, kind, tools, moves, framed, is_lathe,
        isinstance(x, LinearAxis) and x.diameter,
    )  # fmt: skip


def _bounds(points: Floats, cuts: Flags) -> tuple[Floats, Floats]:
    if not points.shape[1]:
        return np.zeros(0), np.zeros(0)
    ends = cuts | np.append(cuts[1:], False)
    inside = points[ends] if cuts.any() else points
    low, high = inside.min(axis=0), inside.max(axis=0)
    margin = _MARGIN * float(np.max(high - low))
    if margin <= 0.0:
        low, high = points.min(axis=0), points.max(axis=0)
        margin = max(_MARGIN * float(np.max(high - low)), 0.5)
    low, high = np.maximum(low - margin, points.min(axis=0)), np.minimum(high + margin, points.max(axis=0))
    flat = high - low < 2.0 * margin * _MARGIN
    return np.where(flat, low - margin, low), np.where(flat, high + margin, high)
