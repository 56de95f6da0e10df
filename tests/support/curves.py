"""Curves in the queue of a channel in the dialect of LinuxCNC."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from polycnc.kernel import segment_point
from polycnc.kernel._segments import SPLINE
from polycnc.nc import Channel
from support.programs import accepted


def prepared(program: str, **options: Any) -> Channel:
    """Return a channel that has prepared a program without an error."""
    return accepted(program, **{"dialect": "linuxcnc", **options})


def track(channel: Channel, parts: int = 7) -> npt.NDArray[np.float64]:
    """Return points of all spline segments in the queue, X and Y."""
    seg = channel.machine.state.seg
    out = np.zeros(3)
    points = []
    for k in np.flatnonzero(seg.row["kind"] == SPLINE):
        for part in range(parts + 1):
            segment_point(seg, int(k), float(seg.row[k]["length"]) * part / parts, out)
            points.append(out[:2].copy())
    return np.array(points)
