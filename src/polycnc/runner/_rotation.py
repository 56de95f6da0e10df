"""Turn points about a direction, each by its own angle; where tables and heads take the tip of a tool."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from polycnc.machine import MachineConfig, RotaryAxis

Floats = npt.NDArray[np.float64]
Triple = tuple[float, float, float]


def turned(points: Floats, direction: Triple, angles_deg: Floats, center: Triple = (0.0, 0.0, 0.0)) -> Floats:
    """Return points [n, 3] turned about a line through `center` by the right-hand rule, each by its angle [n]."""
    x, y, z = np.asarray(direction) / np.linalg.norm(direction)
    skew = np.array(((0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0)))
    angles = np.radians(angles_deg)[:, None]
    off: Floats = points - center
    once: Floats = off @ skew.T
    twice: Floats = once @ skew.T
    found: Floats = points + np.sin(angles) * once + (1.0 - np.cos(angles)) * twice
    return found


def turning_axes(machine: MachineConfig) -> list[tuple[int, RotaryAxis]]:
    """Return number and configuration of the axes that turn the part or the tool."""
    return [
        (i, axis)
        for i, axis in enumerate(machine.axes)
        if isinstance(axis, RotaryAxis) and axis.carries != "nothing"
    ]


def tip_and_axis(
    machine: MachineConfig, position: Floats, place: Floats, hangs: Floats
) -> tuple[Floats, Floats]:
    """Return where the part sees the tips of tools [points, 3], and the direction from there to the holder.

    `position` [points, axes] are those of the machine's axes, `place` [points, 3] the nose of the spindle, `hangs` the
    way from there to the tip. A table turns the part backwards, so that a positive angle turns the tool forwards about
    it (ISO 841).
    """
    up = np.broadcast_to(np.array([0.0, 0.0, 1.0]), place.shape)
    axes = turning_axes(machine)
    for number, axis in reversed(axes):
        if axis.carries == "tool":
            hangs = turned(hangs, axis.about, position[:, number], axis.center_mm)
            up = turned(up, axis.about, position[:, number])
    tip = place + hangs
    for number, axis in axes:
        if axis.carries == "part":
            tip = turned(tip, axis.about, position[:, number], axis.center_mm)
            up = turned(up, axis.about, position[:, number])
    return tip, up
