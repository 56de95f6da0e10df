"""Parallel curves of lines and arcs in a plane, and how two of them join at a corner.

An offset is signed: positive lies to the left of the direction of travel, negative to the right. The parallel
curve of a line is a line, that of an arc an arc about the same center, so every question at a corner is an
intersection of lines and circles.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

# Shorter plane moves have no direction worth trusting; they count as no plane motion.
SHORTEST_MM = 1e-7
# Up to this offset radius an arc counts as collapsed: the tool turns on the spot.
COLLAPSED_MM = 1e-6
# How far a collapsed arc may lie off the neighbour's offset curve.
COLLAPSED_GAP_MM = 1e-5
# Below this sine a turn by almost 180 degrees is a retraced path; curvature says which side is inside.
RETRACE = 1e-7
# An almost tangent corner is joined without solving: the arc radius error is d^2 turn^2 / 8 R <= 1e-10 / 8.
_TANGENT = 1e-10
# Both intersections count as equally near the corner below this share of the radius.
_TIE = 1e-7

XY = tuple[float, float]


@dataclass(slots=True)
class Leg:
    """Describe one plane move: its ends (mm), unit tangents at both, and an arc's center, radii and sweep.

    `sense` is 0 for a line, +1 for an arc that turns left (first towards second axis), -1 for one that turns
    right. The two radii of an arc differ as the program's rounding makes them; each end keeps its own.
    """

    x0: float
    y0: float
    x1: float
    y1: float
    tx0: float
    ty0: float
    tx1: float
    ty1: float
    sense: int = 0
    cx: float = 0.0
    cy: float = 0.0
    radius0: float = math.inf
    radius1: float = math.inf
    sweep_rad: float = 0.0


class Joint(NamedTuple):
    """Say how two offset legs join.

    The first ends at `end`, the second starts at `start`. With `sweep_rad` 0 both are one point; otherwise an
    arc about the programmed corner leads from one to the other.
    """

    end: XY
    start: XY
    sweep_rad: float


def line_leg(x0: float, y0: float, x1: float, y1: float) -> Leg | None:
    """Return the leg of a straight move, None if it does not move in the plane."""
    dx = x1 - x0
    dy = y1 - y0
    length = math.hypot(dx, dy)
    if length < SHORTEST_MM:
        return None
    tx = dx / length
    ty = dy / length
    return Leg(x0, y0, x1, y1, tx, ty, tx, ty)


def arc_leg(x0: float, y0: float, x1: float, y1: float, cx: float, cy: float, sweep_rad: float) -> Leg | None:
    """Return the leg of a circular move, None if it does not move in the plane."""
    vx0 = x0 - cx
    vy0 = y0 - cy
    vx1 = x1 - cx
    vy1 = y1 - cy
    radius0 = math.hypot(vx0, vy0)
    radius1 = math.hypot(vx1, vy1)
    if min(radius0, radius1) < SHORTEST_MM or abs(sweep_rad) * radius0 < SHORTEST_MM:
        return None
    sense = 1 if sweep_rad > 0.0 else -1
    k0 = sense / radius0
    k1 = sense / radius1
    tangents = (-vy0 * k0, vx0 * k0, -vy1 * k1, vx1 * k1)
    return Leg(x0, y0, x1, y1, *tangents, sense, cx, cy, radius0, radius1, sweep_rad)


def bent_arc(leg: Leg, start: XY, offset: float) -> Leg | None:
    """Return the arc with the end and direction of another whose offset curve begins at a point, if there is one."""
    x1, y1 = end_offset(leg, offset)
    inwards_x, inwards_y = -leg.sense * leg.ty1, leg.sense * leg.tx1  # from the end to the center
    dx, dy = start[0] - x1, start[1] - y1
    towards = dx * inwards_x + dy * inwards_y
    if towards <= SHORTEST_MM:
        return None
    radius = (dx * dx + dy * dy) / (2.0 * towards)
    cx, cy = x1 + radius * inwards_x, y1 + radius * inwards_y
    scale = (radius + leg.sense * offset) / radius
    x0, y0 = cx + (start[0] - cx) * scale, cy + (start[1] - cy) * scale
    sweep = leg.sense * (_angle(start[0] - cx, start[1] - cy, x1 - cx, y1 - cy) * leg.sense % math.tau)
    turns = math.ceil(abs(leg.sweep_rad) / math.tau - _TANGENT) - 1
    sweep += leg.sense * turns * math.tau
    return arc_leg(x0, y0, leg.x1, leg.y1, cx, cy, sweep)


def leg_length(leg: Leg) -> float:
    """Return how far the leg goes in the plane (mm)."""
    if leg.sense:
        return abs(leg.sweep_rad) * leg.radius0
    return math.hypot(leg.x1 - leg.x0, leg.y1 - leg.y0)


def start_offset(leg: Leg, offset: float) -> XY:
    """Return the point beside the start of the leg."""
    return leg.x0 - offset * leg.ty0, leg.y0 + offset * leg.tx0


def end_offset(leg: Leg, offset: float) -> XY:
    """Return the point beside the end of the leg."""
    return leg.x1 - offset * leg.ty1, leg.y1 + offset * leg.tx1


def smallest_offset_radius(leg: Leg, offset: float) -> float:
    """Return the smaller end radius (mm) of the offset arc; negative when the offset does not fit inside."""
    return min(leg.radius0, leg.radius1) - leg.sense * offset


def collapses(leg: Leg, offset: float) -> bool:
    """Tell whether the offset of an arc shrinks to its center."""
    return leg.sense != 0 and smallest_offset_radius(leg, offset) <= COLLAPSED_MM


def turn_cosine(before: Leg, after: Leg) -> float:
    """Return the cosine of the turn from the end of one leg to the start of the next: 1 is straight on."""
    return before.tx1 * after.tx0 + before.ty1 * after.ty0


def turns_inside(before: Leg, after: Leg, offset: float, retrace: float = RETRACE) -> bool:
    """Tell whether the path turns towards the offset side, so that the offset legs overlap."""
    cross = before.tx1 * after.ty0 - before.ty1 * after.tx0
    if abs(cross) < retrace and turn_cosine(before, after) < 0.0:
        curvature = before.sense / before.radius1 + after.sense / after.radius0
        return curvature * offset < 0.0
    return cross * offset > 0.0


def join(
    before: Leg, after: Leg, offset: float, meet_cosine: float, retrace: float = RETRACE
) -> Joint | None:
    """Join two offset legs at their common corner.

    Inside corners meet at the intersection of the offset curves. Outside corners do too while the cosine of
    the turn is at least `meet_cosine`; sharper ones, and those without an intersection, get an arc about the
    corner. Returns None when an inside corner has no intersection: the tool does not fit.
    """
    inside = turns_inside(before, after, offset, retrace)
    if inside or turn_cosine(before, after) >= meet_cosine:
        point = _meeting_point(before, after, offset)
        if point is not None:
            return Joint(point, point, 0.0)
        if inside:
            return None
    return round_joint(before, after, offset)


def round_joint(before: Leg, after: Leg, offset: float) -> Joint:
    """Join two offset legs by an arc about the corner, from beside the first leg to beside the second."""
    cross = before.tx1 * after.ty0 - before.ty1 * after.tx0
    turn = math.atan2(-math.copysign(cross, cross * offset), turn_cosine(before, after)) % math.tau
    return Joint(end_offset(before, offset), start_offset(after, offset), -math.copysign(turn, offset))


def chamfer(before: Leg, after: Leg, joint: Joint) -> Joint:
    """Replace the arc of a joint by straight moves outside it: on, across, and on."""
    (ex, ey), (sx, sy), sweep = joint
    reach = math.hypot(ex - before.x1, ey - before.y1) * math.tan(0.25 * abs(sweep))
    end = ex + reach * before.tx1, ey + reach * before.ty1
    start = sx - reach * after.tx0, sy - reach * after.ty0
    return Joint(end, start, sweep)


def offset_sweep(leg: Leg, start: XY, end: XY) -> float:
    """Return the signed sweep of an offset arc that starts and ends at the given points on it."""
    trimmed = _angle(leg.x0 - leg.cx, leg.y0 - leg.cy, start[0] - leg.cx, start[1] - leg.cy)
    added = _angle(leg.x1 - leg.cx, leg.y1 - leg.cy, end[0] - leg.cx, end[1] - leg.cy)
    return leg.sweep_rad - trimmed + added


def _angle(ux: float, uy: float, vx: float, vy: float) -> float:
    return math.atan2(ux * vy - uy * vx, ux * vx + uy * vy)


def _meeting_point(before: Leg, after: Leg, offset: float) -> XY | None:
    radius1 = before.radius1 - before.sense * offset
    radius2 = after.radius0 - after.sense * offset
    if before.sense and radius1 <= COLLAPSED_MM:
        return _collapsed(before, start_offset(after, offset))
    if after.sense and radius2 <= COLLAPSED_MM:
        return _collapsed(after, end_offset(before, offset))
    cross = before.tx1 * after.ty0 - before.ty1 * after.tx0
    cosine = turn_cosine(before, after)
    straight = not before.sense and not after.sense
    bend = offset * cross
    if straight or (cosine > 0.0 and bend * bend <= _TANGENT * min(radius1, radius2)):
        scale = offset / (1.0 + cosine)
        return after.x0 - (before.ty1 + after.ty0) * scale, after.y0 + (before.tx1 + after.tx0) * scale
    if not before.sense:
        px, py = end_offset(before, offset)
        return _line_circle(px, py, before.tx1, before.ty1, after.cx, after.cy, radius2, -1.0, cosine)
    if not after.sense:
        px, py = start_offset(after, offset)
        return _line_circle(px, py, after.tx0, after.ty0, before.cx, before.cy, radius1, 1.0, cosine)
    return _circle_circle(before, after, radius1, radius2)


def _collapsed(leg: Leg, neighbour: XY) -> XY | None:
    if math.hypot(neighbour[0] - leg.cx, neighbour[1] - leg.cy) > COLLAPSED_GAP_MM:
        return None
    return leg.cx, leg.cy


def _line_circle(
    px: float,
    py: float,
    ux: float,
    uy: float,
    cx: float,
    cy: float,
    radius: float,
    overlap: float,
    cosine: float,
) -> XY | None:
    """Return the intersection nearest to p, beside the corner; on a tie the one towards `overlap`.

    Where the path turns back and p lies inside the circle, the line is trimmed, not prolonged.
    """
    along = (cx - px) * ux + (cy - py) * uy
    across = ux * (cy - py) - uy * (cx - px)
    square = (radius - across) * (radius + across)
    if square < 0.0:
        return None
    half = math.sqrt(square)
    if abs(along) <= _TIE * radius or (cosine < 0.0 and abs(along) < half):
        distance = along + overlap * half
    else:
        distance = along - math.copysign(half, along)
    return px + distance * ux, py + distance * uy


def _circle_circle(before: Leg, after: Leg, radius1: float, radius2: float) -> XY | None:
    """Return the intersection on the corner's side of the line of centers; on a tie the one in the wedge."""
    ex = after.cx - before.cx
    ey = after.cy - before.cy
    distance = math.hypot(ex, ey)
    if distance < SHORTEST_MM:
        return None
    ex /= distance
    ey /= distance
    along = (distance * distance + (radius1 - radius2) * (radius1 + radius2)) / (2.0 * distance)
    square = (radius1 - along) * (radius1 + along)
    if square < 0.0:
        return None
    side = ex * (after.y0 - before.cy) - ey * (after.x0 - before.cx)
    if abs(side) <= _TIE * radius1:
        side = ex * (after.ty0 - before.ty1) - ey * (after.tx0 - before.tx1)
    across = math.copysign(math.sqrt(square), side)
    return before.cx + along * ex - across * ey, before.cy + along * ey + across * ex
