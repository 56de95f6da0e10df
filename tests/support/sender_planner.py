"""The planners of small open controls in plain Python: trapezoids in two passes, corners by their angle.

Written from the formulas those controls publish (angle theta between the reversed first and the second direction),
in continuous time: a reference for the corner rules of the machine file.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
# What a rule is told: both directions, lengths and accelerations; it answers the squared speed.
Rule = Callable[[Floats, Floats, tuple[float, float], tuple[float, float]], float]


def by_junction_deviation(deviation_mm: float, acceleration: Floats) -> Rule:
    """Return the rule of controls with a junction deviation: acceleration limited along the junction vector."""

    def squared(u: Floats, w: Floats, lengths: tuple[float, float], accels: tuple[float, float]) -> float:
        cos_theta = -float(u @ w)
        if cos_theta > 0.999999:
            return 0.0
        if cos_theta < -0.999999999999:
            return math.inf
        junction = (w - u) / np.linalg.norm(w - u)
        with np.errstate(divide="ignore"):
            accel = float(np.min(acceleration / abs(junction)))
        sin_half = math.sqrt(0.5 * (1.0 - cos_theta))
        return accel * deviation_mm * sin_half / (1.0 - sin_half)

    return squared


def by_square_corner(speed_mm_s: float, highest_accel_mm_s2: float) -> Rule:
    """Return the rule of controls with a square corner velocity: a centripetal bound by each move's length too."""
    deviation = speed_mm_s**2 * (math.sqrt(2.0) - 1.0) / highest_accel_mm_s2

    def squared(u: Floats, w: Floats, lengths: tuple[float, float], accels: tuple[float, float]) -> float:
        cos_theta = -float(u @ w)
        if cos_theta > 0.999999:
            return 0.0
        sin_half = math.sqrt(max(0.5 * (1.0 - cos_theta), 0.0))
        cos_half = math.sqrt(max(0.5 * (1.0 + cos_theta), 0.0))
        if 1.0 - sin_half <= 0.0 or cos_half <= 0.0:
            return math.inf
        radius = deviation * sin_half / (1.0 - sin_half)
        centripetal = 0.5 * sin_half / cos_half
        return min(
            *(radius * accel for accel in accels),
            *(centripetal * length * accel for length, accel in zip(lengths, accels, strict=True)),
        )

    return squared


def travel_time(
    points: Floats,
    feed: float,
    rule: Rule,
    *,
    speed: Floats,
    acceleration: Floats,
    path_speed: float = math.inf,
    path_acceleration: float = math.inf,
    low_acceleration: float = math.inf,
) -> tuple[float, int]:
    """Return the time of the polyline through `points`, s, and how many stretches from rest to rest it has.

    `low_acceleration` is what speeds between corners are found with (`max_accel_to_decel`).
    """
    way = np.diff(points, axis=0)
    length = np.linalg.norm(way, axis=1)
    u = way / length[:, None]
    with np.errstate(divide="ignore"):
        cap = np.minimum(min(feed, path_speed), np.min(speed / abs(u), axis=1))
        accel = np.minimum(path_acceleration, np.min(acceleration / abs(u), axis=1))
    n = len(length)
    gain = 2.0 * accel * length
    v2 = np.zeros(n + 1)
    for k in range(n - 1):
        lengths, accels = (length[k], length[k + 1]), (accel[k], accel[k + 1])
        v2[k + 1] = min(rule(u[k], u[k + 1], lengths, accels), cap[k] ** 2, cap[k + 1] ** 2)
    starts, top2 = v2.copy(), cap**2
    for k in range(n):
        starts[k + 1] = min(starts[k + 1], starts[k] + gain[k])
    for k in range(n - 1, -1, -1):
        starts[k] = min(starts[k], starts[k + 1] + gain[k])
    if low_acceleration < math.inf:
        top2 = cruising(v2, np.minimum(gain, 2.0 * low_acceleration * length), gain, starts, top2)
        # The formulas let the speed step up between two moves of a fall; here the lower one holds.
        starts[1:-1] = np.minimum(starts[1:-1], np.minimum(top2[:-1], top2[1:]))
    time, stretches = 0.0, 0
    for k in range(n):
        start2, end2 = min(starts[k], top2[k]), min(starts[k + 1], top2[k])
        peak2 = min(top2[k], 0.5 * (start2 + end2 + gain[k]))
        peak, start, end = math.sqrt(peak2), math.sqrt(start2), math.sqrt(end2)
        ramps = (2.0 * peak2 - start2 - end2) / (2.0 * accel[k])
        time += (2.0 * peak - start - end) / accel[k] + max(0.0, length[k] - ramps) / peak
        stretches += end2 == 0.0
    return time, stretches


def cruising(corners2: Floats, low_gain: Floats, gain: Floats, starts: Floats, cap2: Floats) -> Floats:
    """Return the highest squared speed of every move: the peaks of a plan with the lower acceleration.

    From `corners2`, [moves + 1], what a move adds to a squared speed with either acceleration, and `starts` of the plan
    with the full one.
    """
    n = len(gain)
    from_before = np.zeros(n + 1)
    for k in range(n):
        from_before[k + 1] = min(corners2[k + 1], from_before[k] + low_gain[k])
    low = from_before.copy()
    low[n] = 0.0
    for k in range(n - 1, -1, -1):
        low[k] = min(from_before[k], low[k + 1] + low_gain[k])
    top = cap2.copy()
    falls = [low[k] == low[k + 1] + low_gain[k] for k in range(n)]
    peak = 0.0
    for k in range(n - 1, -1, -1):
        if falls[k]:
            top[k] = starts[k]  # until the peak before it is known
            continue
        last = k + 1
        while last < n and falls[last]:
            last += 1
        if last > k + 1 or low[k] + low_gain[k] > low[k + 1]:
            peak = min(cap2[k], 0.5 * (low[k] + low[k + 1] + low_gain[k]))
            for later in range(k + 1, last):
                top[later] = min(peak, starts[later])
        top[k] = min(cap2[k], peak)
    return top
