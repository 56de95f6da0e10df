"""The turning modes of motion: threads, and cycles of a single cut. Depths and tapers are radii."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

from polycnc.nc.blocks import _limits as limits
from polycnc.nc.blocks import _motion as motion
from polycnc.nc.blocks import _turning_moves as turns
from polycnc.nc.blocks._block import BlockContext
from polycnc.nc.blocks._messages import CODE_SYSTEM
from polycnc.nc.blocks._moves import GeometryError, Line, Point, QueueItem
from polycnc.nc.blocks._synchronized import SYNCHRONIZED
from polycnc.nc.blocks._synchronized import moves as synchronized
from polycnc.nc.blocks._turning import MOST_PASSES, SAME_MM, Step, box, exchanged
from polycnc.nc.blocks._words import GWord
from polycnc.nc.modal._actions import Action, Family, Group
from polycnc.nc.modal._modal import MOTION, MOTION_LINEAR

_MODES = {
    (Action.TURN_CYCLE, "90"): "X and Z are absolute anyway, U and W are incremental",
    (Action.FACE_CYCLE, "94"): "feed per minute is G98, feed per revolution G99",
}
"""What other code systems mean by codes that are cycles in system A, as it is said there."""


def begin(block: BlockContext, g: GWord) -> None:
    """Put a turning motion in force."""
    block.after.leave_drilling()
    block.after.modal.whole[MOTION] = MOTION_LINEAR
    block.after.turning = replace(block.after.turning, motion=g.action.title, corner=(None, None), taper=0.0)
    block.after.mode = Family.TURNING


def moves(block: BlockContext) -> list[QueueItem]:
    """Return the moves of a block with such a motion; none if it has no position.

    Raises:
        ProgramError: a word is missing, or the spindle is at rest, or a limit would be passed.
    """
    turning = block.after.turning
    if turning.motion in SYNCHRONIZED:
        return synchronized(block)
    is_thread = turning.motion in ("thread", "thread_changing")
    taper_word = block.words.by_letter.get("R") if not is_thread else None
    taper = turns.length(block, "R") if taper_word is not None else None
    values = motion.axis_words(block)
    if not values and taper is None:
        _remark_system(block)
        return []
    turns.refuse_compensation(block)
    end = motion.target(block, values)
    if turning.motion == "thread":
        return list(turns.items(block, [Step(turns.plane_point(block, end), thread=True)], end, stops=False))
    if turning.motion == "thread_changing":
        return list(_changing_thread(block, end))
    x, z = turns.axes(block)
    corner = tuple(
        end[axis] if axis in values else kept for axis, kept in zip((x, z), turning.corner, strict=True)
    )
    turning = replace(turning, corner=(corner[0], corner[1]), taper=turning.taper if taper is None else taper)
    block.after.turning = turning
    if corner[0] is None or corner[1] is None:
        raise block.problem(
            "a cutting cycle without X (U) or Z (W)", "Give both in its first block.", block.move_word
        )
    start = turns.here(block)
    to = corner[0], corner[1]
    try:
        if turning.motion == "face_cycle":
            steps = exchanged(box(start[::-1], to[::-1], turning.taper))
        else:
            chamfer = turning.chamfer * turns.lead(block) if turning.motion == "thread_cycle" else 0.0
            steps = box(start, to, turning.taper, thread=turning.motion == "thread_cycle", chamfer=chamfer)
    except GeometryError as error:
        raise block.problem(error.what, error.hint, block.move_word) from None
    return list(turns.items(block, steps, end))


def _remark_system(block: BlockContext) -> None:
    """Tell of a cycle that is begun without a position: programs of another code system mean a mode by its code."""
    g = block.words.g.get(Group.MOTION)
    instead = None if g is None else _MODES.get((g.action, g.code))
    if g is not None and instead:
        block.note(f"G{g.code} without X and Z begins a cutting cycle ({instead}){CODE_SYSTEM}")


def _changing_thread(block: BlockContext, end: Point) -> Iterator[Line]:
    """Yield a thread whose lead changes by K with each turn of the spindle: a line for each turn.

    After n turns it has come by F n + K n^2 / 2, so the mean lead of a turn is that in its middle.

    Raises:
        ProgramError: K is missing, the lead comes down to 0 before the end, or what `_thread_feed` says.
    """
    growth = turns.length(block, "K")
    if growth is None:
        raise block.problem(
            "a thread of changing lead without K", "Add K and the change per turn.", block.move_word
        )
    limits.check(block, end)
    start, lead = block.start, turns.lead(block)
    long = max(abs(b - a) for a, b in zip(start, end, strict=True))
    square = lead * lead + 2.0 * growth * long
    if square <= 0.0:
        raise block.problem(
            "the lead of the thread comes down to 0 before its end",
            f"With K{growth:g} it can be {-lead * lead / (2.0 * growth):.6g} mm long at the most.",
            block.move_word,
        )
    count = 2.0 * long / (lead + math.sqrt(square))
    if count > MOST_PASSES:
        raise block.problem(f"a thread of {count:.0f} turns", "Check F and K.", block.move_word)
    at, turned = start, 0.0
    while at != end:
        next_turn = min(math.floor(turned + 1.0), count)
        if count - next_turn < SAME_MM:
            next_turn, to = count, end
        else:
            share = (lead + 0.5 * growth * next_turn) * next_turn / long
            to = tuple(a + share * (b - a) for a, b in zip(start, end, strict=True))
        mean = lead + 0.5 * growth * (turned + next_turn)
        yield Line(at, to, turns.thread_feed(block, at, to, mean), False, False, block.line)
        at, turned = to, next_turn
