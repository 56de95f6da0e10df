"""A cubic in three axes, traversed evenly in its parameter: one motion ends in it while another begins.

Where a motion slows down to rest evenly while the next speeds up evenly, their sum is a parabola that takes even
steps of its parameter in even times. The path length of an OVERLAP is what both motions lose, and the path speed in it
goes evenly from the speed of the first to that of the second: at the part u of the time the part 2 e u + (1 - 2 e) u^2
of the length is behind, e being the part of the first in the sum of both speeds. Arcs and helices make it a cubic that
meets both with their directions. Its row of numbers:

    0..2    ways from the start to the first inner control point, one for each axis
    3..5    the same to the second
    6       e
    7       what was taken of the motion after it, mm; 8 what of the one before had been taken at its start
"""

from __future__ import annotations

import math

from polycnc.kernel._bezier import Floats
from polycnc.kernel._jit import compiled

FIRST, SECOND, ENTRY, CUT_AFTER, TAKEN = 0, 3, 6, 7, 8


@compiled
def cubic_way(row: Floats, j: int, way: float, part: float) -> float:
    """Return how far axis `j` is from the start at a part of the length; `way` is how far the end is."""
    first, second, entry = row[FIRST + j], row[SECOND + j], row[ENTRY]
    u = part / (entry + math.sqrt(entry * entry + (1.0 - 2.0 * entry) * part))
    return float((((way + 3.0 * (first - second)) * u + 3.0 * (second - 2.0 * first)) * u + 3.0 * first) * u)


@compiled
def cubic_slope(row: Floats, j: int, way: float, at: float) -> float:
    """Return d(way)/d(part of the length) of axis `j` at the start (`at` 0) or the end (1)."""
    entry = row[ENTRY]
    if at > 0.0:
        return float(1.5 * (way - row[SECOND + j]) / (1.0 - entry))
    return float(1.5 * row[FIRST + j] / entry)


@compiled
def cubic_bounds(row: Floats, j: int, way: float, length_mm: float) -> tuple[float, float, float, float]:
    """Return the greatest |dp/ds| of axis `j`, and what it accelerates by, per squared speed at the faster end.

    All by differences of its control points: where the path speed goes evenly from that of one end to that of the
    other; where it stays, as high as it then is at that place; and where it is that of the faster end all along.
    """
    first, second, entry = row[FIRST + j], row[SECOND + j], row[ENTRY]
    leaving = 1.0 - entry
    faster, slower = max(entry, leaving), min(entry, leaving)
    square = 4.0 * length_mm * length_mm
    q0, q1, q2 = 3.0 * first, 3.0 * (second - first), 3.0 * (way - second)
    slope = max(abs(q0) / (2.0 * entry), abs(q1), abs(q2) / (2.0 * leaving)) / length_mm
    b0, b1 = 6.0 * (second - 2.0 * first), 6.0 * (way - 2.0 * second + first)
    even = max(abs(b0), abs(b1)) / (square * faster * faster)
    # d2p/ds2 is n / (4 length^2 d^3), with d the speed over the sum of those at both ends and n of second degree.
    rate = leaving - entry
    n0, n2 = abs(b0 * entry - rate * q0), abs(b1 * leaving - rate * q2)
    n1 = abs(0.5 * (b0 * leaving + b1 * entry) - rate * q1)
    steady = max(n0 / entry, 2.0 * n1, n2 / leaving) / (square * faster * faster)
    return slope, even, steady, max(n0, n1, n2) / (square * slower * slower * slower)
