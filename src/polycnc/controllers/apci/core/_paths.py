"""Give an entry of the spooler its path: a line, an arc or a helix, a circle in space."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from polycnc.controllers.apci.core._state import Floats
from polycnc.kernel import Segments, entry, set_arc, set_circle3d, set_line

Mask = npt.NDArray[np.uint8]


@entry
def fill_line(seg: Segments, e: int, feed_axis: Mask, start: Floats, end: Floats) -> float:
    """Make entry `e` a straight line; return its length, 0 if there is none."""
    if not set_line(seg.row, seg.start, seg.end, e, feed_axis, start, end, 0.0, 0, 0):
        return 0.0
    return float(seg.row[e]["length"])


@entry
def fill_arc(
    seg: Segments,
    e: int,
    feed_axis: Mask,
    start: Floats,
    end: Floats,
    axis_p: int,
    axis_q: int,
    center_p: float,
    center_q: float,
    sweep: float,
) -> float:
    """Make entry `e` an arc or a helix through `sweep` rad; return its length, 0 if there is none."""
    if not set_arc(seg, e, feed_axis, start, end, axis_p, axis_q, center_p, center_q, sweep, 0.0, 0, 0):
        return 0.0
    return float(seg.row[e]["length"])


@entry
def fill_circle3d(
    seg: Segments,
    e: int,
    start: Floats,
    axis_p: int,
    axis_q: int,
    axis_r: int,
    center: Floats,
    normal: Floats,
    sweep_deg: float,
) -> float:
    """Make entry `e` a circle in space; return its length, 0 if there is none."""
    if not set_circle3d(seg, e, start, axis_p, axis_q, axis_r, center, normal, sweep_deg, 0.0, 0, 0):
        return 0.0
    return float(seg.row[e]["length"])
