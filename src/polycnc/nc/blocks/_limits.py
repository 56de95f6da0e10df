"""The limits that moves must keep: soft limits of the axes, and how long a block may take."""

from __future__ import annotations

import math
from collections.abc import Iterator

from polycnc.machine import LONGEST_BLOCK_S
from polycnc.nc.blocks._arcs import arc_extents
from polycnc.nc.blocks._block import BlockContext
from polycnc.nc.blocks._channel_state import ChannelState
from polycnc.nc.blocks._compensation_errors import CompensationError
from polycnc.nc.blocks._moves import Arc, Line, Move, Point, QueueItem, Spline, Wait
from polycnc.nc.modal._modal import AXIS_P, AXIS_Q, LARGEST
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
    state, whole = block.after, block.after.modal.whole
    compensated = state.side != 0 or state.compensation.active
    later = (int(whole[AXIS_P]), int(whole[AXIS_Q])) if compensated else ()
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
