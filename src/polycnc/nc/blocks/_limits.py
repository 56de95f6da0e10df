"""The limits that moves must keep: soft limits of the axes, and how long a block may take.

Some controls refuse nothing at a soft limit: moves stop there.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

from polycnc.machine import LONGEST_BLOCK_S
from polycnc.nc.blocks._arcs import arc_extents
from polycnc.nc.blocks._block import BlockContext
from polycnc.nc.blocks._channel_state import ChannelState
from polycnc.nc.blocks._compensation_errors import CompensationError
from polycnc.nc.blocks._moves import Arc, Line, Move, Point, QueueItem, Spline, Wait
from polycnc.nc.modal._modal import LARGEST
from polycnc.nc.text._scan_plain import Word

LIMIT_ROUNDING = 1e-6
"""A position this little past a soft limit (mm or degree) is one on it, reached by rounding."""

_SECONDS_PER_DAY = 86_400.0
_SECONDS_PER_YEAR = 365.25 * _SECONDS_PER_DAY
_TOO_LONG = "the block would take {}"
_CHECK_NUMBER = "Check the number."
_LONGEST_DAYS = LONGEST_BLOCK_S / _SECONDS_PER_DAY
_TOO_LONG_HINT = f"No block may take longer than {_LONGEST_DAYS:.0f} days: check the feed and the way."


def check(block: BlockContext, point: Point, what: str = "would go to") -> None:
    """Refuse a point outside the soft limits, or note it where the dialect lets moves go up to them.

    With radius compensation it is the compensated path that counts in the plane, see `check_path`.

    Raises:
        ProgramError: names the axis, the position and the limit.
    """
    state = block.after
    compensated = state.side != 0 or state.compensation.active
    later = state.plane[:2] if compensated else ()
    for index, text, hint in _limit_problems(state, point, what, later):
        axis = state.axis_names[index]
        error = block.problem(text, hint, block.words.first(axis))
        error.limit = _limit(block.rules.stops_at_limits, state, index, point)
        if not block.rules.stops_at_limits or hint == _CHECK_NUMBER:
            raise error
        block.passed.append(error)


def check_path(state: ChannelState, item: Move, *, stops_at_limits: bool = False) -> None:
    """Refuse a compensated move that leaves the soft limits.

    Raises:
        CompensationError: names the axis, the position and the limit.
    """
    time_s = _least_time_s(state, item)
    if not time_s <= LONGEST_BLOCK_S:
        what = _TOO_LONG.format(_duration_text(time_s))
        raise CompensationError(
            f"with radius compensation {what}", reason="time", line=item.line, hint=_TOO_LONG_HINT
        )
    for point, what in points(item):
        for index, text, hint in _limit_problems(state, point, what):
            error = CompensationError(
                f"with radius compensation {text}", reason="limit", line=item.line, hint=hint
            )
            error.limit = _limit(stops_at_limits, state, index, point)
            raise error


def _limit(stops: bool, state: ChannelState, index: int, point: Point) -> tuple[str, bool, bool]:
    return state.axis_names[index], point[index] > float(state.modal.high[index]), stops


def check_time(block: BlockContext, item: QueueItem) -> None:
    """Refuse a move or a dwell that would take longer than anybody waits (`LONGEST_BLOCK_S`).

    Raises:
        ProgramError: says how long, and names what makes it so.
    """
    time_s = _least_time_s(block.after, item)
    if not time_s <= LONGEST_BLOCK_S:
        raise block.problem(_TOO_LONG.format(_duration_text(time_s)), _TOO_LONG_HINT, _slow_word(block, item))


def _least_time_s(state: ChannelState, item: QueueItem) -> float:
    """Return the time that an item takes at the least: at its feed, and at the speeds of the axes."""
    if isinstance(item, Wait):
        return item.duration_s
    ways = [abs(b - a) for a, b in zip(item.start, item.end, strict=True)]
    length = item.length_mm if isinstance(item, Spline) else math.hypot(*ways)
    if isinstance(item, Arc):
        p, q = item.plane[:2]
        radius = math.hypot(item.start[p] - item.center[0], item.start[q] - item.center[1])
        length = math.hypot(length, radius * item.sweep_rad)
        ways[p] = ways[q] = radius * abs(item.sweep_rad) / 2.0
    axes = max(way / axis.vmax for way, axis in zip(ways, state.machine.axes, strict=True))
    if isinstance(item, Line) and item.rapid:
        return axes
    if item.feed.duration_s > 0.0:
        return max(axes, item.feed.duration_s)
    return max(axes, length / item.feed.speed_mm_s) if item.feed.speed_mm_s > 0.0 else math.inf


def _slow_word(block: BlockContext, item: QueueItem) -> Word | None:
    if isinstance(item, Wait):
        return block.words.first("P", "X", "U", "F")
    return block.words.first("F") or block.move_word


def _limit_problems(
    state: ChannelState, point: Point, what: str, but: tuple[int, ...] = ()
) -> Iterator[tuple[int, str, str]]:
    """Yield the axes whose limits a point passes, what is wrong and what to do."""
    for index, value in enumerate(point):
        low, high = float(state.modal.low[index]), float(state.modal.high[index])
        if low - LIMIT_ROUNDING <= value <= high + LIMIT_ROUNDING or index in but:
            continue
        axis = state.machine.axes[index]
        limit = low if value < low else high
        if abs(limit) == LARGEST:
            text = f"axis {axis.name} {what} {value:.6g} {axis.unit}, further than any machine"
            yield index, text, _CHECK_NUMBER
        else:
            text = f"axis {axis.name} {what} {value:.3f} {axis.unit}, past its soft limit of {limit:.3f} {axis.unit}"
            yield (
                index,
                text,
                "Check the program, the work offset and the machine's soft limits (machine coordinates).",
            )


def _duration_text(time_s: float) -> str:
    """Return a time that nobody waits for."""
    if not time_s < math.inf:
        return "for ever"
    years = time_s / _SECONDS_PER_YEAR
    return f"{years:.3g} years" if years >= 1.0 else f"{time_s / _SECONDS_PER_DAY:.0f} days"


def points(item: Move) -> Iterator[tuple[Point, str]]:
    """Yield the points of a move that must be inside the limits, and how it comes there."""
    yield item.end, "would go to"
    if isinstance(item, Arc):
        p, q = item.plane[:2]
        ends = item.start[p], item.start[q], item.end[p], item.end[q]
        for corner in arc_extents(*ends, *item.center, item.sweep_rad):
            point = list(item.end)
            point[p], point[q] = corner
            yield tuple(point), "would pass"


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
