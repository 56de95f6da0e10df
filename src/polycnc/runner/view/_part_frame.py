"""The path as the part sees it: on a machine whose table turns, the tool goes another way than its axes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from polycnc.machine import MachineConfig, RotaryAxis
from polycnc.runner.view._track import Track

Floats = npt.NDArray[np.float64]

_PLACES = "XYZ"
_ABOUT = {"A": 0, "B": 1, "C": 2}
_STEP_DEG = 3.0  # so far the part turns at most between two points
_MOST_POINTS = 200_000


def tables_of(machine: MachineConfig) -> list[tuple[int, RotaryAxis]]:
    """Return number and configuration of the axes that turn the part, from the machine to the part."""
    return [
        (i, axis)
        for i, axis in enumerate(machine.axes)
        if isinstance(axis, RotaryAxis) and axis.carries == "part" and axis.name[0] in _ABOUT
    ]


def on_part(position: Floats, machine: MachineConfig) -> Floats:
    """Return where the part sees positions [points, axes] of the machine: X, Y, Z [points, 3] at angles of 0.

    A table turns the part backwards, so that a positive angle turns the tool forwards about it (ISO 841).
    """
    names = machine.axis_names
    place = np.zeros((len(position), 3))
    for column, name in enumerate(_PLACES):
        if name in names:
            place[:, column] = position[:, names.index(name)]
    for number, axis in tables_of(machine):
        about = _ABOUT[axis.name[0]]
        first, second = (about + 1) % 3, (about + 2) % 3
        angle = np.radians(position[:, number])
        center = np.array(axis.center_mm)
        off = place - center
        place[:, first] = center[first] + off[:, first] * np.cos(angle) - off[:, second] * np.sin(angle)
        place[:, second] = center[second] + off[:, first] * np.sin(angle) + off[:, second] * np.cos(angle)
    return place


def with_part_frame(track: Track, machine: MachineConfig) -> Track:
    """Return a track with three more columns, the places on the part, and with points wherever the part has turned."""
    turning = [number for number, _ in tables_of(machine)]
    if len(track.t_s) < 2:
        return replace(track, position=np.column_stack((track.position, on_part(track.position, machine))))
    turned = np.abs(np.diff(track.position[:, turning], axis=0)).max(axis=1)
    step = max(_STEP_DEG, float(turned.sum()) / _MOST_POINTS)
    parts = np.maximum(np.ceil(turned / step).astype(np.int64), 1)
    begin = np.repeat(np.arange(len(parts)), parts)
    share = (np.arange(len(begin)) - np.repeat(np.cumsum(parts) - parts, parts) + 1) / parts[begin]

    def between(values: Floats) -> Floats:
        rise = values[begin + 1] - values[begin]
        part = share if values.ndim == 1 else share[:, None]
        inner: Floats = np.where(part >= 1.0, values[begin + 1], values[begin] + part * rise)
        return np.concatenate((values[:1], inner))

    position = between(track.position)
    return replace(
        track,
        t_s=between(track.t_s),
        position=np.column_stack((position, on_part(position, machine))),
        feed_mm_s=between(track.feed_mm_s),
        rapid=np.concatenate((track.rapid[:1], track.rapid[begin + 1])),
    )
