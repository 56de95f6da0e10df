"""A cubic in three axes, traversed evenly in its parameter: one motion ends in it while another begins.

Where a motion slows down to rest evenly while the next speeds up evenly, their sum is a parabola that takes even
steps of its parameter in even times: the path length of an OVERLAP is the parameter times what both motions lose, and
its point moves with the path speed at the ends and slower between. Arcs and helices make it a cubic that meets both
with their directions. Its row of numbers:

    0..2    ways from the start to the first inner control point, one for each axis
    3..5    the same to the second
"""

from __future__ import annotations

from polycnc.kernel._bezier import Floats, Pair
from polycnc.kernel._jit import compiled

FIRST, SECOND = 0, 3


@compiled
def cubic_way(row: Floats, j: int, way: float, u: float) -> float:
    """Return how far axis `j` is from the start at a part `u` of the length; `way` is how far the end is."""
    first, second = row[FIRST + j], row[SECOND + j]
    return float((((way + 3.0 * (first - second)) * u + 3.0 * (second - 2.0 * first)) * u + 3.0 * first) * u)


@compiled
def cubic_slope(row: Floats, j: int, way: float, at: float) -> float:
    """Return d(way)/du of axis `j` at the start (`at` 0) or the end (1)."""
    return float(3.0 * (way - row[SECOND + j])) if at > 0.0 else float(3.0 * row[FIRST + j])


@compiled
def cubic_bounds(row: Floats, j: int, way: float, length_mm: float) -> Pair:
    """Return the greatest |dp/ds| and |d2p/ds2| of axis `j`, by the differences of its control points."""
    first, second = row[FIRST + j], row[SECOND + j]
    slope = 3.0 * max(abs(first), abs(second - first), abs(way - second)) / length_mm
    bend = 6.0 * max(abs(second - 2.0 * first), abs(way - 2.0 * second + first)) / (length_mm * length_mm)
    return slope, bend
