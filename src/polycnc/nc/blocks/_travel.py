"""How far moves go until an axis comes to its soft limit, for controls that stop there and refuse nothing."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace

from polycnc.nc.blocks._moves import Arc, Line, Point, QueueItem, Spline

_ROUNDING = 1e-6


def up_to_limits(
    items: Iterable[QueueItem], low: Sequence[float], high: Sequence[float]
) -> tuple[list[QueueItem], tuple[int, bool] | None]:
    """Return the items that come before a soft limit, the last one cut where the first axis is on it; and that axis,
    with whether it is the upper limit.

    A curve that passes a limit is left out whole.
    """
    kept: list[QueueItem] = []
    for item in items:
        if isinstance(item, Spline) and not _inside(item.end, low, high):
            return kept, None
        if not isinstance(item, Line | Arc):
            kept.append(item)
            continue
        share, at = _share(item, low, high)
        if share < 1.0:
            return [*kept, _cut(item, share, low, high)] if share > 0.0 else kept, at
        kept.append(item)
    return kept, None


def _inside(point: Point, low: Sequence[float], high: Sequence[float]) -> bool:
    return all(a - _ROUNDING <= x <= b + _ROUNDING for x, a, b in zip(point, low, high, strict=False))


def _share(
    item: Line | Arc, low: Sequence[float], high: Sequence[float]
) -> tuple[float, tuple[int, bool] | None]:
    """Return the part of a move, 0 to 1, that stays inside the limits, and the axis and limit that end it."""
    turning = item.plane[:2] if isinstance(item, Arc) else ()
    least: float = 1.0
    at: tuple[int, bool] | None = None
    for axis, (begin, end) in enumerate(zip(item.start, item.end, strict=True)):
        for upper, limit in ((False, low[axis]), (True, high[axis])):
            sense = 1.0 if upper else -1.0
            if isinstance(item, Arc) and axis in turning:
                share = _arc_share(item, axis, limit, sense) if (begin - limit) * sense <= _ROUNDING else 0.0
            elif (end - limit) * sense <= _ROUNDING:
                continue
            else:
                share = max(0.0, (limit - begin) / (end - begin)) if end != begin else 0.0
            if share < least:
                least, at = share, (axis, upper)
    return least, at


def _arc_share(item: Arc, axis: int, limit: float, outwards: float) -> float:
    """Return the part of an arc until an axis of its plane passes a limit `outwards` (1, -1), 1 where it does not."""
    first = axis == item.plane[0]
    p, q = item.start[item.plane[0]] - item.center[0], item.start[item.plane[1]] - item.center[1]
    radius, begin = math.hypot(p, q), math.atan2(q, p)
    reach = limit - item.center[0 if first else 1]
    if abs(reach) >= radius - _ROUNDING or item.sweep_rad == 0.0:
        return 1.0
    half = math.acos(reach / radius)
    crossings = (half, -half) if first else (math.pi / 2.0 - half, math.pi / 2.0 + half)
    sense = math.copysign(1.0, item.sweep_rad)
    shares = []
    for angle in crossings:
        speed = (-math.sin(angle) if first else math.cos(angle)) * sense
        if speed * outwards > 0.0:
            way = (angle - begin) * sense % (2.0 * math.pi)
            if 2.0 * math.pi - way < _ROUNDING / radius:
                way = 0.0  # it begins on the limit
            shares.append(way / abs(item.sweep_rad))
    return min([1.0, *shares])


def _cut(item: Line | Arc, share: float, low: Sequence[float], high: Sequence[float]) -> Line | Arc:
    """Return the first part of a move; a feed by time keeps its speed."""
    end = [a + (b - a) * share for a, b in zip(item.start, item.end, strict=True)]
    feed = replace(item.feed, duration_s=item.feed.duration_s * share)
    if isinstance(item, Arc):
        p, q = item.plane[:2]
        radius = math.hypot(item.start[p] - item.center[0], item.start[q] - item.center[1])
        angle = math.atan2(item.start[q] - item.center[1], item.start[p] - item.center[0])
        angle += item.sweep_rad * share
        end[p], end[q] = item.center[0] + radius * math.cos(angle), item.center[1] + radius * math.sin(angle)
    kept = tuple(min(max(x, a), b) for x, a, b in zip(end, low, high, strict=False))
    if isinstance(item, Arc):
        return replace(item, end=kept, sweep_rad=item.sweep_rad * share, feed=feed)
    return replace(item, end=kept, feed=feed)
