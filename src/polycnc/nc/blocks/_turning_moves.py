"""What blocks of turning cycles share: their words, places in the plane of X and Z, and steps into moves."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from polycnc.nc.blocks import _feeds as feeds
from polycnc.nc.blocks import _limits as limits
from polycnc.nc.blocks import _motion as motion
from polycnc.nc.blocks._block import BlockContext
from polycnc.nc.blocks._moves import Arc, Feed, Line, QueueItem
from polycnc.nc.blocks._moves import Point as AxisPoint
from polycnc.nc.blocks._turning import Piece, Point, Step
from polycnc.nc.modal._modal import FEED, FEED_MODE, FEED_PER_REVOLUTION, INCH, NO_AXIS
from polycnc.units import MM_PER_INCH, SECONDS_PER_MINUTE

_INCREMENT_MM = 0.001
_INCREMENT_INCH = 0.0001


def length(block: BlockContext, letter: str) -> float | None:
    value = block.words.length(letter)
    return None if value is None else value * (MM_PER_INCH if _inch(block) else 1.0)


def increments(block: BlockContext, letter: str) -> float:
    """Take a word that counts increments without a point; 0 without one. In mm."""
    word = block.words.take(letter)
    if word is None:
        return 0.0
    if word.value < 0.0:
        raise block.problem(f"{letter} is negative", "Write it from 0 up.", word)
    if word.point:
        return word.value * (MM_PER_INCH if _inch(block) else 1.0)
    return word.value * (_INCREMENT_INCH * MM_PER_INCH if _inch(block) else _INCREMENT_MM)


def _inch(block: BlockContext) -> bool:
    return bool(block.after.modal.whole[INCH])


def axes(block: BlockContext) -> tuple[int, int]:
    x, z = block.after.axis("X"), block.after.axis("Z")
    if NO_AXIS in (x, z):
        raise block.problem(
            "a turning cycle on a machine without X and Z", "Choose a lathe.", block.move_word
        )
    return x, z


def here(block: BlockContext) -> Point:
    return plane_point(block, block.start)


def plane_point(block: BlockContext, point: AxisPoint) -> Point:
    x, z = axes(block)
    return point[x], point[z]


def refuse_compensation(block: BlockContext) -> None:
    if block.after.side or block.after.compensation.active:
        raise block.problem(
            "a turning cycle while radius compensation is active",
            "Cancel it with G40 first.",
            block.move_word,
        )


def lead(block: BlockContext) -> float:
    lead = float(block.after.modal.real[FEED])
    if lead <= 0.0:
        raise block.problem("a thread without a lead", "Add F and the lead.", block.move_word)
    return lead


def items(
    block: BlockContext, steps: Sequence[Step], others: AxisPoint, *, stops: bool = True
) -> Iterator[QueueItem]:
    """Yield the moves of steps; the axes besides X and Z come to `others` with the first."""
    x, z = axes(block)
    at = block.start
    for step in steps:
        goal = list(others)
        goal[x], goal[z] = step.end
        end = tuple(goal)
        if end == at:
            continue
        limits.check(block, end)
        if step.arc is not None:
            yield _arc(block, step.arc, at, end)
        elif step.thread:
            yield Line(at, end, thread_feed(block, at, end), False, False, block.line)
        elif step.rapid:
            yield Line(at, end, Feed(), True, stops, block.line)
        else:
            yield from motion.cut(block, at, end)
        at = end


def _arc(block: BlockContext, arc: Piece, start: AxisPoint, end: AxisPoint) -> Arc:
    x, z = axes(block)
    assert arc.center is not None
    normal = block.after.axis("Y")
    center = arc.center[1], arc.center[0]
    feed = feeds.feed(block, start, end, straight=False)
    return Arc(start, end, center, arc.sweep_rad, (z, x, normal), feed, block.exact_stop, block.line)


def thread_feed(block: BlockContext, start: AxisPoint, end: AxisPoint, own_lead: float | None = None) -> Feed:
    """Return the feed of a thread: the lead along the axis that goes further, at the speed of the spindle.

    `own_lead` is the one in force if it is None.

    Raises:
        ProgramError: the spindle is at rest, its speed changes with X, or an axis cannot follow it.
    """
    rpm = thread_rpm(block, start, "Its lead would change with X")
    if block.after.modal.whole[FEED_MODE] != FEED_PER_REVOLUTION:
        raise block.problem(
            "a thread without feed per revolution",
            "F is the lead: select feed per revolution first.",
            block.move_word,
        )
    ways = [abs(b - a) for a, b in zip(start, end, strict=True)]
    speed = (lead(block) if own_lead is None else own_lead) * rpm / SECONDS_PER_MINUTE
    return with_spindle(block, start, end, speed * math.hypot(*ways) / max(ways))


def thread_rpm(block: BlockContext, start: AxisPoint, why_constant: str) -> float:
    """Return the speed of the spindle for a thread; `why_constant` says what G96 would do to it."""
    spindle = block.after.spindle
    rpm = feeds.rpm(block, start, start) if spindle.direction else 0.0
    if rpm <= 0.0:
        raise block.problem(
            "a thread with the spindle at rest", "Start it with S and M3 or M4 first.", block.move_word
        )
    if spindle.surface_speed:
        raise block.problem(
            "a thread with constant surface speed (G96)",
            f"{why_constant}: select G97 first.",
            block.move_word,
        )
    return rpm


def with_spindle(block: BlockContext, start: AxisPoint, end: AxisPoint, speed_mm_s: float) -> Feed:
    """Return the feed of a thread at a speed along its path, which each axis must be able to follow."""
    ways = [abs(b - a) for a, b in zip(start, end, strict=True)]
    whole = math.hypot(*ways)
    for axis, way in zip(block.after.machine.axes, ways, strict=True):
        if whole and (wanted := speed_mm_s * way / whole) > axis.vmax * (1.0 + 1e-9):
            raise block.problem(
                f"the thread needs {wanted * SECONDS_PER_MINUTE:.0f} mm/min of axis {axis.name}, "
                f"which has {axis.vmax * SECONDS_PER_MINUTE:.0f}",
                "Turn the spindle slower.",
                block.move_word,
            )
    return Feed(speed_mm_s=speed_mm_s, with_spindle=True)
