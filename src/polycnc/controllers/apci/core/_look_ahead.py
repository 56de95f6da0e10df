"""Look-ahead over a spooler: how fast each profile may end so that no axis jumps more than it stands (MDVEL).

Only profiles with a target velocity take part; the end speed lies between 0 and that velocity. Special functions do
not matter: a profile that is to end at rest has no target velocity. Manual 002, 4.4.123 and 4.4.163 name the effect,
not the algorithm; it is one backward pass.
"""

from __future__ import annotations

import math

from polycnc.controllers.apci.core._state import MOVE, SPECIAL, SPOOL_ENTRIES, BoardState
from polycnc.kernel import compiled, segment_slope

SLACK = 1.0 + 1e-9  # what is faster by rounding only has not come too late


@compiled
def _corner_speed(b: BoardState, e: int, following: int, velocity_unit: float) -> float:
    """Return the highest path speed from entry `e` into entry `following`."""
    this, after = b.entry[e], b.entry[following]
    if this["mask"] != after["mask"]:
        return 0.0
    speed = min(this["vl"], after["vl"])
    length = b.seg.row[e]["length"]
    for i in range(b.axis.shape[0]):
        jump = b.axis[i]["MDVEL"] * velocity_unit
        if this["mask"] >> i & 1 and jump > 0.0:
            change = abs(segment_slope(b.seg, following, i, 0.0) - segment_slope(b.seg, e, i, length))
            if change > 1e-12:
                speed = min(speed, jump / change)
    return float(speed)


@compiled
def look_ahead(b: BoardState, i: int, velocity_unit: float) -> bool:
    """Set the end speeds of what axis `i` has queued, as fast as its corners allow; True if it came too late.

    `velocity_unit` is path units/s per unit of MDVEL. What lies after the queue is unknown: it ends at rest there, as
    it does in front of a table, or with the velocity that sstvl has given. Goes back only as far as something changes.
    """
    row = b.axis[i]
    first = row["head"]
    if row["entry"] >= 0 and row["direct"] == 0:
        first += 1  # under way: its end speed stays as it is
    following = -1
    reachable = 0.0  # square of the speed from which all that follows can be kept
    moves = 0
    for count in range(row["tail"] - 1, row["head"] - 1, -1):
        e = int(b.ring[i, count % SPOOL_ENTRIES])
        this = b.entry[e]
        if this["kind"] == SPECIAL:
            continue
        if this["kind"] != MOVE:
            following = -1
            continue
        out = max(min(this["tvl"], this["vl"]), 0.0)
        if following < 0:
            out = min(out, this["join"])
        else:
            out = min(out, _corner_speed(b, e, following, velocity_unit), math.sqrt(reachable))
        if this["tvl"] < 0.0:  # it comes back: that is no way on
            out = this["tvl"]
        if count < first:
            return bool(following >= 0 and this["out"] >= 0.0 and out > this["out"] * SLACK)
        if moves >= 2 and this["out"] == out:
            return False
        this["out"] = out
        reachable = out * out + 2.0 * this["ac"] * b.seg.row[e]["length"]
        following = e
        moves += 1
    return False
