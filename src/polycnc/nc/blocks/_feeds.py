"""How fast moves go: the feed by its mode, the spindle's speed, and whether a block comes to rest at its end."""

from __future__ import annotations

import math

from polycnc.nc.blocks._block import BlockContext
from polycnc.nc.blocks._moves import Feed, Point
from polycnc.nc.modal._modal import (
    FEED,
    FEED_INVERSE_TIME,
    FEED_MODE,
    FEED_NUMBER,
    FEED_PER_REVOLUTION,
    NO_AXIS,
)
from polycnc.units import SECONDS_PER_MINUTE


def feed(block: BlockContext, start: Point, end: Point, straight: bool = True) -> Feed:
    """Return the feed of a move by the active feed mode.

    Raises:
        ProgramError: no feed, or feed per revolution with the spindle at rest.
    """
    modal = block.after.modal
    mode = modal.whole[FEED_MODE]
    if mode == FEED_INVERSE_TIME:
        if block.after.feed_word <= 0.0:
            raise block.problem(
                "a feed move with inverse time (G93) needs its own F",
                "Add F to every block with G1, G2 or G3.",
                block.move_word,
            )
        return Feed(duration_s=SECONDS_PER_MINUTE / block.after.feed_word)
    value = float(modal.real[FEED])
    if value <= 0.0:
        block.unfed = end
        raise block.problem(
            "a feed move without a feed", "Program F in this or an earlier block.", block.move_word
        )
    if straight and all(rotary or a == b for a, b, rotary in zip(start, end, modal.rotary, strict=True)):
        value = float(modal.real[FEED_NUMBER])  # only rotary axes move: the feed is in degrees
    if mode == FEED_PER_REVOLUTION:
        speed = rpm(block, start, end) if block.after.spindle.direction else 0.0
        if speed <= 0.0:
            raise block.problem(
                "feed per revolution (G95) with the spindle at rest",
                "Start the spindle with S and M3 or M4 first.",
                block.move_word,
            )
        value *= speed
    return Feed(speed_mm_s=value / SECONDS_PER_MINUTE)


def rpm(block: BlockContext, start: Point, end: Point) -> float:
    """Return the spindle speed; with constant surface speed at the middle of the block's X."""
    spindle = block.after.spindle
    if not spindle.surface_speed:
        return spindle.speed
    modal = block.after.modal
    x = block.after.axis("X")
    # Twice the mean radius, from the axis of the workpiece: program zero.
    diameter = 0.0 if x == NO_AXIS else abs(start[x] + end[x] - 2.0 * float(modal.offset[x]))
    top = min(block.after.machine.spindle.max_rpm, spindle.clamp)
    return top if diameter <= 0.0 else min(top, spindle.speed * 1000.0 / (math.pi * diameter))


def clamp_points(block: BlockContext, start: Point, end: Point) -> list[Point]:
    """Return where on a straight cut the spindle's speed reaches its clamp."""
    spindle, modal = block.after.spindle, block.after.modal
    x = block.after.axis("X")
    if not spindle.surface_speed or x == NO_AXIS or modal.whole[FEED_MODE] != FEED_PER_REVOLUTION:
        return []
    way = end[x] - start[x]
    if way == 0.0:
        return []
    top = min(block.after.machine.spindle.max_rpm, spindle.clamp)
    radius = spindle.speed * 1000.0 / (2.0 * math.pi * top)
    center = float(modal.offset[x])
    shares = sorted((center + side * radius - start[x]) / way for side in (-1.0, 1.0))
    return [
        tuple(a + share * (b - a) for a, b in zip(start, end, strict=True))
        for share in shares
        if 1e-9 < share < 1.0 - 1e-9
    ]
