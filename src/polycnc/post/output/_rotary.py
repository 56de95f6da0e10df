"""Rotary axes from the tool axis: a table whose first axis tilts and whose C axis turns.

The positions are those that a control shows: the tool axis on the part is C turned about Z, then A about X (or B
about Y) tilted, applied to the upright axis.
"""

from __future__ import annotations

import math
from typing import Literal

from polycnc.post.tool_path._records import UPRIGHT, Vector

_UPRIGHT = 1e-9
_OVERHEAD = 1.999


def table_angles(
    axis: Vector, table: Literal["ac_table", "bc_table"], tilt: float, turn: float
) -> tuple[float, float]:
    """Return tilt and turn, in degree, for a tool axis; of the two solutions the one nearer to the present turn."""
    flat = math.hypot(axis[0], axis[1])
    if flat < _UPRIGHT and axis[2] > 0.0:
        return 0.0, turn
    lean = math.degrees(math.atan2(flat, axis[2]))
    # For A: axis = (sin C sin A, -cos C sin A, cos A); for B: (cos C sin B, sin C sin B, cos B).
    x, y = (-axis[1], axis[0]) if table == "ac_table" else (axis[0], axis[1])
    direct = _near(math.degrees(math.atan2(y, x)), turn) if flat >= _UPRIGHT else turn
    other = _near(direct + 180.0, turn)
    # The sense of the tilt that is at hand stays, unless the way round is longer by more than a quarter turn.
    stay_other = tilt < 0.0
    costs = (
        abs(direct - turn) + (90.0 if stay_other else 0.0),
        abs(other - turn) + (0.0 if stay_other else 90.0),
    )
    return (lean, direct) if costs[0] <= costs[1] else (-lean, other)


def axis_of(table: Literal["ac_table", "bc_table"], tilt: float, turn: float) -> Vector:
    """Return the tool axis on the part for tilt and turn in degree."""
    lean, around = math.radians(tilt), math.radians(turn)
    flat = math.sin(lean)
    if table == "ac_table":
        return math.sin(around) * flat, -math.cos(around) * flat, math.cos(lean)
    return math.cos(around) * flat, math.sin(around) * flat, math.cos(lean)


def _near(angle: float, turn: float) -> float:
    """Return the angle, whole turns away, that lies next to `turn`."""
    return angle - 360.0 * round((angle - turn) / 360.0)


def tilt_hint(axis: Vector) -> str:
    """Return what to do about a tilted tool where the control file has no rotary axes."""
    if math.dist(axis, UPRIGHT) > _OVERHEAD:
        return (
            "The axis goes from the tip to the spindle, and points into the table here: turn the coordinate system in "
            "the CAM system, and keep the tool axis 0, 0, 1."
        )
    return (
        "Take a control file with rotary axes (five_axis, as in fanuc-5axis), or let the CAM system keep the tool axis "
        "0, 0, 1."
    )
