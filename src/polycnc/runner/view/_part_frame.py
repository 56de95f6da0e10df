"""The path as the part sees it: where tables or heads turn, the tool goes another way than the linear axes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from polycnc.machine import MachineConfig, ToolConfig
from polycnc.runner._rotation import tip_and_axis, turning_axes
from polycnc.runner.view._track import Track

Floats = npt.NDArray[np.float64]

_PLACES = "XYZ"
_STEP_DEG = 3.0  # so far the part turns at most between two points
_MOST_POINTS = 200_000


def turns(track: Track, machine: MachineConfig) -> bool:
    """Return whether the part or the tool turns anywhere on a track."""
    columns = [number for number, _ in turning_axes(machine)]
    return bool(columns and len(track.t_s) and np.ptp(track.position[:, columns], axis=0).any())


def on_part(position: Floats, machine: MachineConfig, tool: npt.NDArray[np.int64] | None = None) -> Floats:
    """Return where the part sees the tips of tools [points]: X, Y, Z [points, 3] of the machine at angles of 0.

    `position` [points, axes] are those of the machine's axes: the nose of the spindle, from which a tool hangs by its
    length. A table turns the part backwards, so that a positive angle turns the tool forwards about it (ISO 841).
    """
    names = machine.axis_names
    place = np.zeros((len(position), 3))
    for column, name in enumerate(_PLACES):
        if name in names:
            place[:, column] = position[:, names.index(name)]
    hangs = np.zeros((len(position), 3))
    if tool is not None:
        hangs = _hangs_mm(machine, tool)
    return tip_and_axis(machine, position, place, hangs)[0]


def with_part_frame(track: Track, machine: MachineConfig) -> Track:
    """Return a track with three more columns, the places on the part, and with points wherever something has turned."""
    turning = [number for number, _ in turning_axes(machine)]
    if len(track.t_s) < 2:
        return _extended(track, machine)
    turns = np.abs(np.diff(track.position[:, turning], axis=0)).max(axis=1)
    step = max(_STEP_DEG, float(turns.sum()) / _MOST_POINTS)
    parts = np.maximum(np.ceil(turns / step).astype(np.int64), 1)
    begin = np.repeat(np.arange(len(parts)), parts)
    share = (np.arange(len(begin)) - np.repeat(np.cumsum(parts) - parts, parts) + 1) / parts[begin]

    def between(values: Floats) -> Floats:
        rise = values[begin + 1] - values[begin]
        part = share if values.ndim == 1 else share[:, None]
        inner: Floats = np.where(part >= 1.0, values[begin + 1], values[begin] + part * rise)
        return np.concatenate((values[:1], inner))

    finer = replace(
        track,
        t_s=between(track.t_s),
        position=between(track.position),
        feed_mm_s=between(track.feed_mm_s),
        rapid=np.concatenate((track.rapid[:1], track.rapid[begin + 1])),
    )
    return _extended(finer, machine)


def _extended(track: Track, machine: MachineConfig) -> Track:
    tips = on_part(track.position, machine, track.tools())
    return replace(track, position=np.column_stack((track.position, tips)))


def hang_mm(tool: ToolConfig) -> tuple[float, float, float]:
    """Return where the tip of a tool is as seen from where it is held: X, Y, Z."""
    z_mm = tool.length_mm + tool.wear_length_mm + tool.z_mm + tool.wear_z_mm
    return -(tool.x_mm + tool.wear_x_mm), -tool.y_mm, -z_mm


def _hangs_mm(machine: MachineConfig, tool: npt.NDArray[np.int64]) -> Floats:
    numbers, place = np.unique(tool, return_inverse=True)
    found = [hang_mm(machine.tools.get(number, ToolConfig())) for number in numbers.tolist()]
    return np.array(found).reshape(-1, 3)[place]
