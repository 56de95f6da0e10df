"""Electronic gears: the setpoint of a slave grows by a ratio of what a master moves.

A follower contributes to the slave's setpoint, from the cycle in which it is engaged; what it has contributed
stays when it is released. A master is an index into the positions given, so it may be an axis or anything
that counts. `Follower` works in axis units, `FixedFollower` in whole counts with the exact fixed-point ratio
of a motion card.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from polycnc.kernel._jit import compiled

Floats: TypeAlias = npt.NDArray[np.float64]
Integers: TypeAlias = npt.NDArray[np.int64]

SETPOINT = 0
ACTUAL = 1

FRACTION_BITS = 32
FRACTION_MASK = (1 << FRACTION_BITS) - 1

GEAR_ROW = np.dtype(
    [
        # Written by the caller.
        ("master", np.int64),
        ("source", np.int64),  # SETPOINT or ACTUAL position of the master
        ("ratio", np.float64),  # slave units per master unit; may change at any time without a jump
        ("engaged", np.int64),
        # Result: the contribution.
        ("offset", np.float64),
        # Memory: offset = base + ratio_in_use (master - anchor), which does not drift.
        ("following", np.int64),
        ("ratio_in_use", np.float64),
        ("last", np.float64),
        ("anchor", np.float64),
        ("base", np.float64),
    ],
    align=True,
)

FIXED_GEAR_ROW = np.dtype(
    [
        ("master", np.int64),
        ("source", np.int64),
        ("ratio", np.int64),  # S16.32: slave counts per master count, times 2**32
        ("engaged", np.int64),
        # Results, exact together.
        ("whole", np.int64),  # counts contributed
        ("fraction", np.int64),  # of a count, in 2**-32, never negative, waits for the next cycles
        ("following", np.int64),
        ("last", np.int64),
    ]
)


class Follower(NamedTuple):
    """Gears in axis units."""

    row: npt.NDArray[np.void]  # [slots] of GEAR_ROW
    slave: Integers  # [slots] axis that is moved


class FixedFollower(NamedTuple):
    """Gears in whole counts."""

    row: npt.NDArray[np.void]  # [slots] of FIXED_GEAR_ROW
    slave: Integers  # [slots] axis that is moved


def make_follower(slots: int) -> Follower:
    """Make released gears for `slots` slots."""
    return Follower(np.zeros(slots, GEAR_ROW), np.zeros(slots, np.int64))


def make_fixed_follower(slots: int) -> FixedFollower:
    """Make released gears for `slots` slots."""
    return FixedFollower(np.zeros(slots, FIXED_GEAR_ROW), np.zeros(slots, np.int64))


@compiled
def follower_cycle(k: int, follower: Follower, setpoint: Floats, actual: Floats) -> float:
    """Return the contribution of gear `k` in this cycle, from the positions `[axes]` of the masters.

    The cycle of engagement takes the master's position as the start and adds nothing.
    """
    row = follower.row[k]
    if row["engaged"] == 0:
        row["following"] = 0
        return float(row["offset"])
    now = actual[row["master"]] if row["source"] == ACTUAL else setpoint[row["master"]]
    if row["following"] == 0:
        row["following"] = 1
        row["ratio_in_use"] = row["ratio"]
        row["anchor"] = now
        row["base"] = row["offset"]
    elif row["ratio"] != row["ratio_in_use"]:
        row["ratio_in_use"] = row["ratio"]
        row["anchor"] = row["last"]
        row["base"] = row["offset"]
    row["last"] = now
    row["offset"] = row["base"] + row["ratio"] * (now - row["anchor"])
    return float(row["offset"])


@compiled
def fixed_follower_cycle(k: int, follower: FixedFollower, setpoint: Integers, actual: Integers) -> int:
    """Return the whole counts that gear `k` has contributed, from the counts `[axes]` of the masters.

    Exact for masters that move less than 2**31 counts in a cycle. A negative result rounds down, as the carry
    of two's complement numbers does.
    """
    row = follower.row[k]
    if row["engaged"] == 0:
        row["following"] = 0
        return int(row["whole"])
    now = actual[row["master"]] if row["source"] == ACTUAL else setpoint[row["master"]]
    if row["following"] == 0:
        row["following"] = 1
        row["last"] = now
    moved = now - row["last"]
    row["last"] = now
    # The ratio's halves apart, so that no product needs more than 63 bits.
    parts = row["fraction"] + moved * (row["ratio"] & FRACTION_MASK)
    row["whole"] += moved * (row["ratio"] >> FRACTION_BITS) + (parts >> FRACTION_BITS)
    row["fraction"] = parts & FRACTION_MASK
    return int(row["whole"])
