"""Backlash: while an axis goes one way the setpoint is moved by half the play that way, so that the load is there.

Positions that programs see are those of the load: without the shift. The sense lasts while the axis rests, and over shp
(Manual 002, 4.4.116).
"""

from __future__ import annotations

import math

from polycnc.controllers.apci.core._state import BoardState
from polycnc.kernel import KernelState, compiled


@compiled
def backlash_cycle(b: BoardState, state: KernelState, i: int) -> None:
    """Add the shift of axis `i` to its new setpoint; it changes at once when the axis reverses."""
    row = b.axis[i]
    if row["backlash"] == 0.0:
        return
    travel = state.setpoint[i] - (state.work[0, i] - row["shift"])
    if travel != 0.0 and row["closed"] != 0 and row["held"] == 0:
        row["shift"] = math.copysign(0.5 * row["backlash"], travel)
    state.setpoint[i] += row["shift"]
