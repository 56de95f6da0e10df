"""How large the arc of a rounded corner is by its speed, and whether it is worth it. Units: those of `_segments`."""

from __future__ import annotations

import math

import numpy as np

from polycnc.kernel._axis_limits import AxisLimits
from polycnc.kernel._corner_rules import BY_SHARE
from polycnc.kernel._curve_limits import CENTRIPETAL_SHARE
from polycnc.kernel._jit import compiled
from polycnc.kernel._limits import CURVE_SHARE
from polycnc.kernel._segments import Floats
from polycnc.kernel._touching import Element

# Columns of the scratch `paths.blend`: directions before and after the corner, start and centre of the arc, normal.
BEFORE, AFTER, START, CENTER, NORMAL = 0, 3, 6, 9, 12
CUT, CUT_LINE = 15, 16  # what the last arc took of the line or arc after it, mm, and which segment that is


@compiled
def feed_along(path: np.void, feed_mm_s: float, feed_after_mm_s: float) -> float:
    """Return the feed along an arc between two moves: the lower one; with BY_SHARE the higher one."""
    if path["corner_rule"] == BY_SHARE:
        return max(feed_mm_s, feed_after_mm_s)
    return min(feed_mm_s, feed_after_mm_s)


@compiled
def cut_by_share(
    path: np.void,
    line: np.void,
    limits: AxisLimits,
    axes: tuple[int, int, int],
    work: Floats,
    cut_mm: float,
    turn_rad: float,
    speed_mm_s: float,
    part_beside: float,
) -> tuple[float, float]:
    """Return how much of both lines the arc of a path with BY_SHARE takes, up to `cut_mm`; 0 where it has none.

    It is as large as the speed needs that the largest would allow, and at least half as long as the ramps are that
    overlap in the corner with half the acceleration. `part_beside` of the acceleration is there for the corner as it
    is, all on lines, less on arcs; where that is passed as fast there is no arc either.
    """
    if cut_mm <= 0.0:  # there is no room beside a line of next to no length
        return 0.0, 0.0
    sine = math.sqrt(work[NORMAL] ** 2 + work[NORMAL + 1] ** 2 + work[NORMAL + 2] ** 2)
    speed = feed_along(path, line["feed_mm_s"], speed_mm_s)
    accel, accel_after, busiest = math.inf, math.inf, 0.0
    for j in range(3):
        allowed, most = limits.acceleration[axes[j]], limits.speed[axes[j]]
        u, w, normal = work[BEFORE + j], work[AFTER + j], work[NORMAL + j] / sine
        if u != 0.0:
            speed = min(speed, most / abs(u))
        if w != 0.0:
            speed, accel_after = min(speed, most / abs(w)), min(accel_after, allowed / abs(w))
        busiest = max(busiest, abs(w - u) / allowed)
        in_plane = math.sqrt(max(0.0, 1.0 - normal * normal))  # of the axis; nothing turns along the others
        if in_plane > 0.0:
            accel = min(accel, allowed / in_plane)
            speed = min(speed, most / in_plane)
    passing = min(speed, line["feed_mm_s"], speed_mm_s)
    needed = busiest * (passing / path["corner_cycle_s"] + accel_after) / part_beside
    if needed < path["corner_share"]:
        return 0.0, 0.0
    stepped = passing * path["corner_share"] / needed if part_beside < 1.0 else 0.0
    tangent = math.tan(0.5 * turn_rad)
    largest = cut_mm / tangent
    speed = min(speed, math.sqrt(CENTRIPETAL_SHARE * accel * largest))
    if speed < stepped:
        return 0.0, 0.0
    overlap_s = 2.0 * min(math.sqrt(accel * cut_mm), speed) / accel
    radius = max(speed * speed / (CENTRIPETAL_SHARE * accel), min(overlap_s * speed / turn_rad, largest))
    return min(cut_mm, radius * tangent), speed


@compiled
def _stop_s(way_mm: float, speed_mm_s: float, accel_mm_s2: float) -> float:
    """Return the time that the last `way_mm` before a rest and what slowing down takes of the way before cost."""
    return float(way_mm / speed_mm_s + 0.5 * speed_mm_s / accel_mm_s2)


@compiled
def _is_quicker(
    before: tuple[float, float, float], after: tuple[float, float, float], turning_mm_s: float, arc_mm: float
) -> bool:
    """Tell whether an arc of this length and speed is quicker than a rest between what it takes of both its sides.

    They are speed, acceleration and length each.
    """
    turning = min(turning_mm_s, before[0], after[0])
    stopping = _stop_s(before[2], before[0], before[1]) + _stop_s(after[2], after[0], after[1])
    slower, later = before[0] - turning, after[0] - turning
    rounding = arc_mm / turning
    rounding += slower * slower / (2.0 * before[1] * before[0])
    rounding += later * later / (2.0 * after[1] * after[0])
    return bool(rounding < stopping)


@compiled
def saves_time(
    line: np.void,
    limits: AxisLimits,
    axes: tuple[int, int, int],
    work: Floats,
    cut_mm: float,
    radius_mm: float,
    turn_rad: float,
    speed_mm_s: float,
) -> bool:
    """Tell whether the arc, traversed with the lower feed, is quicker than both lines with a rest between them."""
    before_mm_s, after_mm_s = line["feed_mm_s"], speed_mm_s
    accel_before, accel_after, accel = math.inf, math.inf, math.inf
    turning = math.inf  # every axis that moves is held to its limit all along the arc
    for j in range(3):
        allowed, speed = limits.acceleration[axes[j]], limits.speed[axes[j]]
        u, w = abs(work[BEFORE + j]), abs(work[AFTER + j])
        if u > 0.0:
            before_mm_s, accel_before = min(before_mm_s, speed / u), min(accel_before, allowed / u)
        if w > 0.0:
            after_mm_s, accel_after = min(after_mm_s, speed / w), min(accel_after, allowed / w)
        if u > 0.0 or w > 0.0:
            accel, turning = min(accel, allowed), min(turning, speed)
    turning = min(turning, math.sqrt(CENTRIPETAL_SHARE * accel * radius_mm))
    before, after = (before_mm_s, accel_before, cut_mm), (after_mm_s, accel_after, cut_mm)
    return _is_quicker(before, after, turning, radius_mm * turn_rad)


@compiled
def saves_time_in_plane(
    limits: AxisLimits,
    plane: tuple[int, int],
    before: Element,
    after: Element,
    feeds: tuple[float, float],
    cuts_mm: tuple[float, float],
    radius_mm: float,
    turn_rad: float,
) -> bool:
    """Tell the same of an arc between a line and an arc, or two arcs, of two axes."""
    p, q = plane
    before_mm_s, accel_before = _going(limits, p, q, before, feeds[0])
    after_mm_s, accel_after = _going(limits, p, q, after, feeds[1])
    accel = min(limits.acceleration[p], limits.acceleration[q])
    turning = min(limits.speed[p], limits.speed[q], math.sqrt(CENTRIPETAL_SHARE * accel * radius_mm))
    first, last = (before_mm_s, accel_before, cuts_mm[0]), (after_mm_s, accel_after, cuts_mm[1])
    return _is_quicker(first, last, turning, radius_mm * turn_rad)


@compiled
def _going(limits: AxisLimits, p: int, q: int, element: Element, feed_mm_s: float) -> tuple[float, float]:
    """Return with which speed a line or an arc is traversed, and what acceleration is left there."""
    if element[2] <= 0.0:
        part_p, part_q = max(abs(element[0]), 1e-300), max(abs(element[1]), 1e-300)
        speed = min(feed_mm_s, limits.speed[p] / part_p, limits.speed[q] / part_q)
        return speed, min(limits.acceleration[p] / part_p, limits.acceleration[q] / part_q)
    accel = min(limits.acceleration[p], limits.acceleration[q])
    speed = min(feed_mm_s, limits.speed[p], limits.speed[q])
    speed = min(speed, math.sqrt(CENTRIPETAL_SHARE * accel * element[2]))
    used = speed * speed / (element[2] * accel)
    return speed, accel * math.sqrt(CURVE_SHARE * CURVE_SHARE - used * used)
