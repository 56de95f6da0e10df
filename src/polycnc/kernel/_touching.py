"""Circles that touch two path elements which meet in a corner: lines, and arcs about a centre, in one plane.

`kappa` is the curvature of an element towards the side that the path turns to: 1 / radius where the element's centre
lies on that side, -1 / radius where it lies on the other, 0 of a line. With q, half of the power of the corner with
respect to the touching circle, both conditions are linear in the normals n of the elements: centre . n = r + kappa q.
The circles grow from the corner on until the elements leave no room for larger ones.

Units: lengths in mm, angles in rad.
"""

from __future__ import annotations

import math
from typing import TypeAlias

from polycnc.kernel._jit import compiled

# Of an element at its corner: direction of travel (p, q), radius (0: a line), sense of rotation (1 from p to q, or -1),
# growth of the radius per rad of travel, centre (p, q).
Element: TypeAlias = tuple[float, float, float, float, float, float, float]

LARGEST_RADIUS = 1e4  # mm; flatter ones are lines
CLOSE_TO_LARGEST = 0.98  # of the largest circle, where a little more radius takes much more of the elements
LEAST_RADIUS = 1e-9  # mm
HALVINGS = 36  # of a radius that is known within a factor of 2
REFINEMENTS = 16


@compiled
def line_element(p: float, q: float) -> Element:
    """Return the element of a line in the direction (p, q)."""
    size = math.sqrt(p * p + q * q)
    return (p / size, q / size, 0.0, 0.0, 0.0, 0.0, 0.0)


@compiled
def arc_element(
    p: float, q: float, center_p: float, center_q: float, sweep_rad: float, growth_mm: float
) -> Element:
    """Return the element of an arc through the corner (p, q) whose radius grows by `growth_mm` over the sweep."""
    sense = math.copysign(1.0, sweep_rad)
    at_p, at_q = p - center_p, q - center_q
    radius = math.sqrt(at_p * at_p + at_q * at_q)
    growth = growth_mm / abs(sweep_rad)
    along_p = growth * at_p / radius - sense * at_q
    along_q = growth * at_q / radius + sense * at_p
    size = math.sqrt(along_p * along_p + along_q * along_q)
    return (along_p / size, along_q / size, radius, sense, growth, center_p, center_q)


@compiled
def curvature(element: Element, side: float) -> float:
    """Return the curvature of an element at its corner towards `side` (1 left of the direction of travel, -1 right)."""
    radius, growth = element[2], element[4]
    if radius <= 0.0:
        return 0.0
    square = radius * radius + growth * growth
    return float(side * element[3] * (square + growth * growth) / (square * math.sqrt(square)))


@compiled
def largest_touching(turn: float, kappa: float, kappa_after: float) -> float:
    """Return the radius beyond which no circle touches both elements near their corner, at most LARGEST_RADIUS."""
    bend = kappa + kappa_after + _spread(turn, kappa, kappa_after)
    room = 2.0 * math.cos(0.5 * turn) ** 2
    return room / bend if bend * LARGEST_RADIUS > room else LARGEST_RADIUS


@compiled
def _spread(turn: float, kappa: float, kappa_after: float) -> float:
    sine = math.sin(0.5 * turn)
    return math.sqrt((kappa - kappa_after) ** 2 + max(0.0, 4.0 * sine * sine * kappa * kappa_after))


@compiled
def half_power(turn: float, kappa: float, kappa_after: float, radius: float) -> float:
    """Return half the power of the corner with respect to the circle of this radius."""
    cosine, sine = math.cos(0.5 * turn), math.sin(0.5 * turn)
    room = 2.0 * cosine * cosine - radius * (kappa + kappa_after)
    left = radius * _spread(turn, kappa, kappa_after)
    root = math.sqrt(max(0.0, (room - left) * (room + left)))
    return float(2.0 * sine * sine * radius * radius / (room + root))


@compiled
def distance_of(turn: float, kappa: float, kappa_after: float, radius: float) -> float:
    """Return how far the circle of this radius stays away from the corner."""
    power = 2.0 * half_power(turn, kappa, kappa_after, radius)
    return float(power / (radius + math.sqrt(radius * radius + power)))


@compiled
def cuts(turn: float, kappa: float, kappa_after: float, radius: float) -> tuple[float, float]:
    """Return how much of both elements the circle takes: mm of a line, rad of an arc."""
    cosine, sine = math.cos(0.5 * turn), math.sin(0.5 * turn)
    q = half_power(turn, kappa, kappa_after, radius)
    inward = (radius + 0.5 * (kappa + kappa_after) * q) / cosine
    onward = 0.5 * (kappa - kappa_after) * q / sine
    return (
        _taken(sine * inward - cosine * onward, radius + kappa * q, kappa),
        _taken(sine * inward + cosine * onward, radius + kappa_after * q, kappa_after),
    )


@compiled
def _taken(way: float, height: float, kappa: float) -> float:
    if kappa == 0.0:
        return way
    return math.atan2(way * abs(kappa), 1.0 - height * kappa)


@compiled
def fits(
    turn: float,
    kappa: float,
    kappa_after: float,
    radius: float,
    distance: float,
    most: float,
    most_after: float,
) -> bool:
    """Tell whether the circle of this radius stays within `distance` of the corner and takes no more than `most`."""
    if distance_of(turn, kappa, kappa_after, radius) > distance:
        return False
    cut, cut_after = cuts(turn, kappa, kappa_after, radius)
    return bool(cut <= most and cut_after <= most_after)


@compiled
def fitting_radius(
    turn: float,
    kappa: float,
    kappa_after: float,
    largest: float,
    distance: float,
    most: float,
    most_after: float,
) -> float:
    """Return a radius up to `largest` that fits (`fits`) and next to which larger ones do not; 0 where none does."""
    largest = min(largest, CLOSE_TO_LARGEST * largest_touching(turn, kappa, kappa_after))
    if fits(turn, kappa, kappa_after, largest, distance, most, most_after):
        return largest
    low = min(1.0, 0.5 * largest)
    while not fits(turn, kappa, kappa_after, low, distance, most, most_after):
        low *= 0.5
        if low < LEAST_RADIUS:
            return 0.0
    high = 2.0 * low
    while high < largest and fits(turn, kappa, kappa_after, high, distance, most, most_after):
        low, high = high, 2.0 * high
    high = min(high, largest)
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if fits(turn, kappa, kappa_after, middle, distance, most, most_after):
            low = middle
        else:
            high = middle
    return low


@compiled
def _point(
    element: Element, p: float, q: float, way: float, side: float, radius: float
) -> tuple[float, float, float, float, float, float]:
    """Return where the element is `way` (mm or rad, negative before) from the corner (p, q).

    Two numbers each: the point, the direction there, and the centre of a circle of this radius that touches it there.
    """
    u, v, size, sense, growth = element[0], element[1], element[2], element[3], element[4]
    if size <= 0.0:
        p, q = p + way * u, q + way * v
    else:
        cosine, sine = math.cos(way), sense * math.sin(way)
        at_p, at_q = (p - element[5]) / size, (q - element[6]) / size
        at_p, at_q = cosine * at_p - sine * at_q, cosine * at_q + sine * at_p
        size += growth * way
        u, v = growth * at_p - size * sense * at_q, growth * at_q + size * sense * at_p
        whole = math.sqrt(u * u + v * v)
        u, v = u / whole, v / whole
        p, q = element[5] + size * at_p, element[6] + size * at_q
    return p, q, u, v, p - side * radius * v, q + side * radius * u


@compiled
def touch(
    before: Element,
    after: Element,
    p: float,
    q: float,
    side: float,
    radius: float,
    cut: float,
    cut_after: float,
) -> tuple[float, float, float, float, float, float, float, float, float]:
    """Return the circle of this radius that touches both elements of the corner (p, q) near these cuts.

    Both cuts, both points of touch, the centre, and the angle from one point to the other; that is 0 where there is no
    circle. An element with a growing radius is no circle itself; some steps find where the circle touches it.
    """
    kappa, kappa_after = curvature(before, side), curvature(after, side)
    scale = before[2] if before[2] > 0.0 else 1.0
    scale_after = after[2] if after[2] > 0.0 else 1.0
    near = 1e-14 * (1.0 + radius + abs(p) + abs(q))
    angle = 0.0
    bp, bq, bu, bv, center_p, center_q = _point(before, p, q, -cut, side, radius)
    ap, aq, au, av, other_p, other_q = _point(after, p, q, cut_after, side, radius)
    for _ in range(REFINEMENTS):
        off_p, off_q = other_p - center_p, other_q - center_q
        cross = bu * av - bv * au
        if abs(off_p) + abs(off_q) <= near or cross == 0.0:
            break
        # Both centres move along their elements by (1 - kappa r) of the way.
        step = (off_p * av - off_q * au) / (cross * (1.0 - kappa * radius))
        step_after = (off_p * bv - off_q * bu) / (cross * (1.0 - kappa_after * radius))
        cut -= step / scale
        cut_after += step_after / scale_after
        bp, bq, bu, bv, center_p, center_q = _point(before, p, q, -cut, side, radius)
        ap, aq, au, av, other_p, other_q = _point(after, p, q, cut_after, side, radius)
    if abs(other_p - center_p) + abs(other_q - center_q) <= 1e3 * near:
        angle = side * math.atan2(side * (bu * av - bv * au), bu * au + bv * av)
    return cut, cut_after, bp, bq, ap, aq, center_p, center_q, angle
