"""Curve tables: the setpoint of a slave is a function of a master's position.

A table is a list of (master, slave) points, joined by straight lines or, with a slope per point, by cubics.
Outside the table the slave stands still or the table repeats; a repeated table goes on from where it ended,
so a table whose last slave position differs from its first advances the slave with every turn.
"""

from __future__ import annotations

import math
from typing import NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from polycnc.errors import UsageError
from polycnc.kernel._follower import ACTUAL
from polycnc.kernel._jit import compiled

Floats: TypeAlias = npt.NDArray[np.float64]
Integers: TypeAlias = npt.NDArray[np.int64]

# Columns of the points.
MASTER = 0
SLAVE = 1
SLOPE = 2  # slave units per master unit
POINT_COLUMNS = 3

LINEAR = 0
CUBIC = 1

CLAMP = 0
REPEAT = 1

BEFORE = -1
INSIDE = 0
AFTER = 1

CURVE_ROW = np.dtype(
    [
        # Written by the caller.
        ("master", np.int64),
        ("source", np.int64),  # SETPOINT or ACTUAL position of the master
        ("engaged", np.int64),
        ("relative", np.int64),  # 1 lays the first point on where master and slave are when engaged
        # The table, written by `set_curve`.
        ("shape", np.int64),  # LINEAR or CUBIC
        ("outside", np.int64),  # CLAMP or REPEAT
        ("start", np.int64),  # first point
        # Results.
        ("offset", np.float64),  # the contribution; stays when the coupling is released
        ("side", np.int64),  # BEFORE, INSIDE or AFTER the table; a repeated one is always INSIDE
        # Memory: offset = base + table at (master - origin).
        ("following", np.int64),
        ("origin", np.float64),
        ("base", np.float64),
    ],
    align=True,
)


class Curve(NamedTuple):
    """Curve couplings and the points of all their tables."""

    row: npt.NDArray[np.void]  # [slots] of CURVE_ROW
    slave: Integers  # [slots] axis that is moved
    length: Integers  # [slots] points of the table, 0 without one
    points: Floats  # [points, POINT_COLUMNS], one table behind the other


def make_curve(slots: int, points: int) -> Curve:
    """Make released couplings for `slots` slots with room for `points` table points altogether."""
    return Curve(
        row=np.zeros(slots, CURVE_ROW),
        slave=np.zeros(slots, np.int64),
        length=np.zeros(slots, np.int64),
        points=np.zeros((points, POINT_COLUMNS)),
    )


def set_curve(
    curve: Curve,
    k: int,
    start: int,
    master: Floats,
    slave: Floats,
    slopes: Floats | None = None,
    outside: int = CLAMP,
) -> None:
    """Write the table of coupling `k` to the points from `start`; with `slopes` it is made of cubics.

    Raises:
        UsageError: fewer than two points, master positions that do not rise, lengths that differ, or no room.
    """
    count = len(master)
    lengths = {count, len(slave), count if slopes is None else len(slopes)}
    if count < 2 or len(lengths) > 1:
        raise UsageError(
            f"curve {k}: {count} master positions, {len(slave)} slave positions",
            hint="Give two or more points, with as many slave positions (and slopes) as master positions.",
        )
    if not np.all(np.diff(master) > 0.0):
        raise UsageError(
            f"curve {k}: master positions do not rise", hint="Sort the points by master position."
        )
    if start < 0 or start + count > len(curve.points):
        raise UsageError(
            f"curve {k}: points {start} to {start + count - 1} do not fit into {len(curve.points)}",
            hint="Make the curves with more points.",
        )
    row = curve.row[k]
    row["start"] = start
    row["shape"] = LINEAR if slopes is None else CUBIC
    row["outside"] = outside
    curve.length[k] = count
    curve.points[start : start + count, MASTER] = master
    curve.points[start : start + count, SLAVE] = slave
    curve.points[start : start + count, SLOPE] = 0.0 if slopes is None else slopes


@compiled
def _interval(points: Floats, first: int, last: int, x: float) -> int:
    """Return the point from which the interval with `x` starts, by bisection of points `first` to `last`."""
    while last - first > 1:
        middle = (first + last) // 2
        if x < points[middle, MASTER]:
            last = middle
        else:
            first = middle
    return first


@compiled
def curve_value(k: int, curve: Curve, master: float) -> float:
    """Return the slave position of table `k` at a `master` position, both in the table's coordinates."""
    points = curve.points
    first = int(curve.row[k]["start"])
    last = first + int(curve.length[k]) - 1
    low = points[first, MASTER]
    high = points[last, MASTER]
    advance = 0.0
    if curve.row[k]["outside"] == REPEAT:
        turns = math.floor((master - low) / (high - low))
        master -= turns * (high - low)
        advance = turns * (points[last, SLAVE] - points[first, SLAVE])
    if master <= low:
        return float(points[first, SLAVE] + advance)
    if master >= high:
        return float(points[last, SLAVE] + advance)
    at = _interval(points, first, last, master)
    x = master - points[at, MASTER]
    width = points[at + 1, MASTER] - points[at, MASTER]
    begin = points[at, SLAVE]
    chord = (points[at + 1, SLAVE] - begin) / width
    if curve.row[k]["shape"] == LINEAR:
        return float(begin + chord * x + advance)
    slope = points[at, SLOPE]
    # Newton's form of the cubic through both points with both slopes.
    bend = (chord - slope) / width
    twist = (slope + points[at + 1, SLOPE] - 2.0 * chord) / (width * width)
    return float(begin + x * (slope + x * (bend + (x - width) * twist)) + advance)


@compiled
def curve_cycle(k: int, curve: Curve, setpoint: Floats, actual: Floats) -> float:
    """Return the contribution of coupling `k` in this cycle, from the positions `[axes]` of the masters."""
    row = curve.row[k]
    if row["engaged"] == 0:
        row["following"] = 0
        return float(row["offset"])
    now = actual[row["master"]] if row["source"] == ACTUAL else setpoint[row["master"]]
    first = row["start"]
    if row["following"] == 0:
        row["following"] = 1
        row["origin"] = 0.0
        row["base"] = 0.0
        if row["relative"] != 0:
            row["origin"] = now - curve.points[first, MASTER]
            row["base"] = row["offset"] - curve.points[first, SLAVE]
    x = now - row["origin"]
    row["side"] = INSIDE
    if row["outside"] == CLAMP:
        if x < curve.points[first, MASTER]:
            row["side"] = BEFORE
        elif x > curve.points[first + curve.length[k] - 1, MASTER]:
            row["side"] = AFTER
    row["offset"] = row["base"] + curve_value(k, curve, x)
    return float(row["offset"])
