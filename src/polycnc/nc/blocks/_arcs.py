"""From the words of a circular block to centre and sweep, for both ways that blocks are read.

Angles are positive from the first to the second axis of the plane (counter-clockwise, G3). Square roots stand
for `hypot`, which Python and compiled code round differently.
"""

from __future__ import annotations

import math

from polycnc.kernel import compiled, entry

ARC_OK = 0
ARC_NO_RADIUS = 1  # neither centre nor radius, or a centre on the start point
ARC_RADIUS_TOO_SMALL = 2  # R is less than half the distance to the end point
ARC_RADIUS_AT_SAME_POINT = 3  # R with the end point on the start point has no centre
ARC_OFF_CIRCLE = 4  # start and end lie on different radii
ARC_TOO_LARGE = 5  # a radius that no machine has, so the centre would be lost in rounding

TWO_PI = 2.0 * math.pi
SAME_ANGLE = 1e-9  # an end this close to the start is a full turn
LARGEST_RADIUS = 1e9


@compiled
def _distance(p: float, q: float) -> float:
    return math.sqrt(p * p + q * q)


@entry
def arc_by_center(
    start_p: float,
    start_q: float,
    end_p: float,
    end_q: float,
    center_p: float,
    center_q: float,
    clockwise: bool,
    tolerance: float,
    relative: float,
    most: float,
) -> tuple[int, float, float, float, float]:
    """Return (status, center_p, center_q, sweep rad, difference of the radii) of an arc by its centre.

    The radii at start and end may differ by `tolerance`, or by `relative` of the larger one if that is more, but by no
    more than `most` tolerances.
    """
    radius = _distance(start_p - center_p, start_q - center_q)
    radius_end = _distance(end_p - center_p, end_q - center_q)
    off = abs(radius - radius_end)
    if not (radius < LARGEST_RADIUS and radius_end < LARGEST_RADIUS):
        return ARC_TOO_LARGE, center_p, center_q, 0.0, off
    if radius <= 0.0 or radius_end <= 0.0:
        return ARC_NO_RADIUS, center_p, center_q, 0.0, off
    if off > max(tolerance, relative * max(radius, radius_end)) or off > most * tolerance:
        return ARC_OFF_CIRCLE, center_p, center_q, 0.0, off
    first = math.atan2(start_q - center_q, start_p - center_p)
    last = math.atan2(end_q - center_q, end_p - center_p)
    return ARC_OK, center_p, center_q, _turn(last - first, clockwise), off


@compiled
def _turn(angle: float, clockwise: bool) -> float:
    """Return `angle` as a turn of the wanted sense, more than 0 and up to one whole turn."""
    if clockwise:
        while angle >= -SAME_ANGLE:
            angle -= TWO_PI
        while angle < -TWO_PI - SAME_ANGLE:
            angle += TWO_PI
    else:
        while angle <= SAME_ANGLE:
            angle += TWO_PI
        while angle > TWO_PI + SAME_ANGLE:
            angle -= TWO_PI
    return angle


@entry
def arc_by_radius(
    start_p: float,
    start_q: float,
    end_p: float,
    end_q: float,
    radius: float,
    clockwise: bool,
    tolerance: float,
) -> tuple[int, float, float, float, float]:
    """Return (status, center_p, center_q, sweep rad, shortfall) of an arc by its radius.

    A positive radius takes the arc of up to half a turn, a negative one the longer arc. A radius too small by
    less than `tolerance` is a half turn.
    """
    dp, dq = end_p - start_p, end_q - start_q
    chord = _distance(dp, dq)
    if chord <= 0.0:
        return ARC_RADIUS_AT_SAME_POINT, start_p, start_q, 0.0, 0.0
    half = 0.5 * chord
    size = abs(radius)
    if not size < LARGEST_RADIUS:
        return ARC_TOO_LARGE, start_p, start_q, 0.0, 0.0
    if size <= 0.0:
        return ARC_NO_RADIUS, start_p, start_q, 0.0, 0.0
    if size < half - tolerance:
        return ARC_RADIUS_TOO_SMALL, start_p, start_q, 0.0, half - size
    height = math.sqrt(max(size * size - half * half, 0.0))
    # The centre lies left of the chord for a short counter-clockwise and for a long clockwise arc.
    side = 1.0 if (radius > 0.0) != clockwise else -1.0
    center_p = 0.5 * (start_p + end_p) - side * height * dq / chord
    center_q = 0.5 * (start_q + end_q) + side * height * dp / chord
    first = math.atan2(start_q - center_q, start_p - center_p)
    last = math.atan2(end_q - center_q, end_p - center_p)
    return ARC_OK, center_p, center_q, _turn(last - first, clockwise), max(half - size, 0.0)


def arc_extents(
    start_p: float, start_q: float, end_p: float, end_q: float, center_p: float, center_q: float, sweep: float
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the lowest and the highest (p, q) that an arc passes."""
    dp, dq = start_p - center_p, start_q - center_q
    radius = math.sqrt(dp * dp + dq * dq)
    first = math.atan2(start_q - center_q, start_p - center_p)
    low, high = sorted((first, first + max(min(sweep, TWO_PI), -TWO_PI)))  # more turns pass nothing new
    ps, qs = [start_p, end_p], [start_q, end_q]
    quadrant = math.ceil(low / (0.5 * math.pi))
    while quadrant * 0.5 * math.pi <= high:
        step = quadrant % 4
        if step % 2 == 0:
            ps.append(center_p + (radius if step == 0 else -radius))
        else:
            qs.append(center_q + (radius if step == 1 else -radius))
        quadrant += 1
    return (min(ps), min(qs)), (max(ps), max(qs))
