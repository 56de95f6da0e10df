"""A planner of its own for polylines: the corner rule of docs/explanation/motion.md in two passes, in plain Python.

For lines that take some cycles each, so that no two corners are within two cycles. Times are continuous but for the
whole cycles of every stretch from rest to rest; what a corner takes of the acceleration it takes for exactly a cycle.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]

CYCLE_S = 0.001
STRAIGHT = 1e-12
MOST_GIVEN = 0.75  # of a line's acceleration
MOST_LOST = 0.5  # of a corner's speed, by what the lines give away


def _last_true(holds: Callable[[float], bool], low: float, high: float) -> float:
    """Return the greatest number up to `high` for which `holds` is true; it is for `low`."""
    if holds(high):
        return high
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if holds(middle) else (low, middle)
    return low


def _given(v: float, u: Floats, w: Floats, accel: Floats, acceleration: Floats) -> tuple[float, float]:
    """Return which part of their accelerations both lines give away at a corner passed with `v`."""
    before = after = 0.0
    for i, change in enumerate(abs(w - u)):
        if change < STRAIGHT:
            continue
        step = v * change / (acceleration[i] * CYCLE_S)
        used = [min(1.0, abs(d[i]) * a / acceleration[i]) for d, a in zip((u, w), accel, strict=True)]
        each = [max(0.0, 1.0 - (1.0 - step) / part) if part > 0.0 else 0.0 for part in used]
        less = min(used)
        alone = min(2.0 * step / (1.0 + less), step * step / (1.0 - less) if less < 1.0 else math.inf)
        if _lost(v, each, accel) > MOST_LOST and alone < max(each):
            each = [alone, alone]
        before, after = max(before, each[0]), max(after, each[1])
    return before, after


def _lost(v: float, given: list[float], accel: Floats) -> float:
    return max(part * float(a) * CYCLE_S / v for part, a in zip(given, accel, strict=True))


def corner_speed(
    u: Floats, w: Floats, accel: Floats, acceleration: Floats, fastest: float
) -> tuple[float, float, float]:
    """Return the speed through the corner from direction `u` to `w`, and what it takes per speed on both sides."""

    def is_kept(v: float) -> bool:
        given = list(_given(v, u, w, accel, acceleration))
        used = np.maximum(abs(u) * accel[0], abs(w) * accel[1]) / acceleration
        room = 1.0 - np.minimum(used, 1.0) * (1.0 - MOST_GIVEN)
        steps = v * abs(w - u) / (acceleration * CYCLE_S)
        return bool(np.all(steps <= room) and _lost(v, given, accel) <= MOST_LOST)

    speed = _last_true(is_kept, 1e-6, fastest)
    before, after = _given(speed, u, w, accel, acceleration)
    return speed, before / speed, after / speed


def _ramp(near: float, far: float, accel: float, given: float) -> tuple[float, float]:
    """Return time and distance from speed `near`, beside a corner, to `far`: the first cycle with less acceleration."""
    slow = accel * (1.0 - given)
    first = min(far - near, slow * CYCLE_S)
    time = first / slow + (far - near - first) / accel
    between = near + first
    distance = 0.5 * (near + between) * first / slow + 0.5 * (between + far) * (far - between) / accel
    return time, distance


def planned_time(points: Floats, feed: float, speed: Floats, acceleration: Floats) -> float:
    """Return the time of the polyline through `points`, all limits of the axes kept."""
    way = np.diff(points, axis=0)
    length = np.linalg.norm(way, axis=1)
    u = way / length[:, None]
    with np.errstate(divide="ignore"):
        cap = np.minimum(feed, np.min(speed / abs(u), axis=1))
        accel = np.min(acceleration / abs(u), axis=1)
    n = len(length)
    junction, before, after = np.zeros(n + 1), np.zeros(n + 1), np.zeros(n + 1)
    for k in range(n - 1):
        junction[k + 1], before[k + 1], after[k + 1] = corner_speed(
            u[k], u[k + 1], accel[k : k + 2], acceleration, min(cap[k], cap[k + 1])
        )

    def reach(k: int, end: float, given_end: float, given_start: float, most: float) -> float:
        """Return the highest speed up to `most` at one end of a line that is passed with `end` at the other."""

        def fits(v: float) -> bool:
            if v <= end:
                return True
            lost = v * given_start * accel[k] * CYCLE_S  # the corner at the far end takes its part as well
            distance = _ramp(end, v + lost, accel[k], end * given_end)[1]
            return bool(distance - lost * CYCLE_S <= length[k])

        return _last_true(fits, 0.0, most)

    v = np.zeros(n + 1)
    for k in range(n - 1, 0, -1):
        v[k] = reach(k, v[k + 1], before[k + 1], after[k], junction[k])
    total = stretch = 0.0
    for k in range(n):
        v[k + 1] = reach(k, v[k], after[k], before[k + 1], v[k + 1])
        ends = ((v[k], v[k] * after[k]), (v[k + 1], v[k + 1] * before[k + 1]))

        def ramps(
            peak: float, k: int = k, ends: tuple[tuple[float, float], ...] = ends
        ) -> tuple[float, float]:
            each = [_ramp(end, max(peak, end), accel[k], given) for end, given in ends]
            return each[0][0] + each[1][0], each[0][1] + each[1][1]

        def fit(peak: float, k: int = k) -> bool:
            return bool(ramps(peak)[1] <= length[k])

        peak = _last_true(fit, max(v[k], v[k + 1]), cap[k])
        time, distance = ramps(peak)
        stretch += time + max(0.0, length[k] - distance) / peak
        if v[k + 1] == 0.0:
            total += math.ceil(stretch / CYCLE_S - 1e-9) * CYCLE_S
            stretch = 0.0
    return total


def stairs(steps: int, size: float) -> Floats:
    """Return the corners of stairs in XY."""
    points = [(0.0, 0.0, 0.0)]
    for step in range(2 * steps):
        x, y, z = points[-1]
        points.append((x + size, y, z) if step % 2 == 0 else (x, y + size, z))
    return np.array(points)


def kinks(points: Floats) -> int:
    """Return how many corners turn by a degree or more."""
    way = np.diff(points, axis=0)
    way /= np.linalg.norm(way, axis=1)[:, None]
    return sum(float(np.dot(a, b)) < math.cos(math.radians(1.0)) for a, b in pairwise(way))
