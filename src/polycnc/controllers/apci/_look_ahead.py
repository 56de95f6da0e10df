"""Look-ahead over a spooler: how fast each profile may end so that no axis jumps more than it stands (MDVEL).

Only profiles with a target velocity take part; the end speed lies between 0 and that velocity. Manual 002, 4.4.123 and
4.4.163 name the effect, not the algorithm; it is one backward pass.
"""

from __future__ import annotations

import math

from polycnc.controllers.apci._state import MOVE, SPOOL_ENTRIES, BoardState, Floats
from polycnc.kernel import compiled, entry, segment_slope


@compiled
def _corner_speed(b: BoardState, e: int, following: int, jump: Floats) -> float:
    """Return the highest path speed from entry `e` into entry `following`."""
    this, after = b.entry[e], b.entry[following]
    speed = min(this["vl"], after["vl"], max(this["tvl"], 0.0))
    if this["mask"] != after["mask"]:
        return 0.0
    length = b.seg.row[e]["length"]
    for i in range(jump.shape[0]):
        if this["mask"] >> i & 1 and jump[i] > 0.0:
            change = abs(segment_slope(b.seg, following, i, 0.0) - segment_slope(b.seg, e, i, length))
            if change > 1e-12:
                speed = min(speed, jump[i] / change)
    return float(speed)


@entry
def look_ahead(b: BoardState, i: int, jump: Floats, last_out: float) -> bool:
    """Set the end speeds of what axis `i` has queued, as fast as its corners allow; True if it came too late.

    `jump[n]` is the velocity step that each axis stands (path units/s, 0 any). What lies behind the queue is
    unknown: its end is taken with `last_out`. Goes back only as far as something changes.
    """
    row = b.axis[i]
    first = row["head"]
    if row["entry"] >= 0 and row["direct"] == 0:
        first += 1  # under way: its end speed stays as it is
    late = False
    following = -1
    entry_square = 0.0
    for count in range(row["tail"] - 1, first - 2, -1):
        if count < row["head"]:
            break
        e = int(b.ring[i, count % SPOOL_ENTRIES])
        this = b.entry[e]
        if this["kind"] != MOVE:
            following = -1
            entry_square = 0.0
            continue
        if following < 0:
            out = last_out if count == row["tail"] - 1 else 0.0
            out = min(out, this["vl"])
        else:
            corner = _corner_speed(b, e, following, jump)
            out = min(corner, math.sqrt(entry_square))
        if count < first:
            late = out > this["out"] * (1.0 + 1e-9) and following >= 0
            break
        if this["out"] == out and count < row["tail"] - 2:
            break
        this["out"] = out
        entry_square = out * out + 2.0 * this["ac"] * b.seg.row[e]["length"]
        following = e
    return late
