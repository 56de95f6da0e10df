"""Turning cycles of one block: pecking along Z or X (G74, G75), and threads in several passes (G76).

P and Q count increments without a point, as do I, K and D of a cycle in one block; depths, retracts and tapers are
radii.
"""

from __future__ import annotations

from dataclasses import replace

from polycnc.nc.blocks import _motion as motion
from polycnc.nc.blocks import _turning_moves as turns
from polycnc.nc.blocks._block import BlockContext
from polycnc.nc.blocks._handlers import carries_out
from polycnc.nc.blocks._moves import GeometryError, QueueItem
from polycnc.nc.blocks._turning import Pecking, Step, Threading, exchanged, peck, threads
from polycnc.nc.blocks._words import GWord, whole_number
from polycnc.nc.modal._actions import Action


@carries_out(Action.FACE_PECK, Action.TURN_PECK, Action.THREAD_PASSES)
def cycle(block: BlockContext, g: GWord) -> list[QueueItem]:
    """Return the moves of G74, G75 or G76; none where the block gives parameters only.

    Raises:
        ProgramError: a word is missing or makes no sense, the spindle is at rest, a limit would be passed.
    """
    turns.refuse_compensation(block)
    names = (*block.dialect.incremental, *block.after.axis_names)
    if not any(name in block.words.by_letter for name in names):
        _set_cycle_parameters(block, g)
        return []
    x, z = turns.axes(block)
    try:
        if g.action is Action.THREAD_PASSES:
            return list(turns.items(block, _threads(block), block.start))
        one = _is_one_block(block)
        p, q = (turns.increments(block, letter) for letter in ("IK" if one else "PQ"))
        relief = turns.increments(block, "D") if one else turns.length(block, "R") or 0.0
        end = motion.target(block, motion.axis_words(block))
        retract = block.after.turning.retract
        start = turns.here(block)
        if g.action is Action.FACE_PECK:
            steps = peck(start, Pecking(end[z], end[x], q, p, retract, relief))
        else:
            steps = exchanged(peck(start[::-1], Pecking(end[x], end[z], p, q, retract, relief)))
    except GeometryError as error:
        raise block.problem(f"G{g.code}: {error.what}", error.hint, g.word) from None
    return list(turns.items(block, steps, block.start))


def _is_one_block(block: BlockContext) -> bool:
    """Tell whether a cycle is written in one block, with I, K and D: as FANUC's Series 15 and Haas lathes have it."""
    return bool(set("IKD") & block.words.by_letter.keys())


def _set_cycle_parameters(block: BlockContext, g: GWord) -> None:
    turning = block.after.turning
    if g.action is not Action.THREAD_PASSES:
        retract = turns.length(block, "R")
        if retract is None:
            raise block.problem(f"G{g.code} without a position", "Add X or U, Z or W.", g.word)
        block.after.turning = replace(turning, retract=retract)
        return
    if (word := block.words.take("P")) is not None:
        number = whole_number(
            word, "finishing passes, chamfer and angle in six digits", block.problem, 999_999
        )
        finishing, rest = divmod(number, 10_000)
        chamfer, angle = divmod(rest, 100)
        if finishing < 1 or angle not in (0, 29, 30, 55, 60, 80):
            raise block.problem(
                f"P{number:06d} is none of finishing passes, chamfer and angle",
                "Write two digits of each, like P020060: the angle is 0, 29, 30, 55, 60 or 80.",
                word,
            )
        turning = replace(turning, finishing=finishing, chamfer=chamfer / 10.0, angle_deg=float(angle))
    if "Q" in block.words.by_letter:
        turning = replace(turning, least=turns.increments(block, "Q"))
    if (allowance := turns.length(block, "R")) is not None:
        turning = replace(turning, allowance=allowance)
    block.after.turning = turning


def _threads(block: BlockContext) -> list[Step]:
    turning = block.after.turning
    one = _is_one_block(block)
    height, first = (turns.increments(block, letter) for letter in ("KD" if one else "PQ"))
    taper = turns.length(block, "I" if one else "R") or 0.0
    angle = block.words.value("A") if one else None
    end = motion.target(block, motion.axis_words(block))
    numbers = Threading(
        end=turns.plane_point(block, end),
        taper=taper,
        height_mm=height,
        first_mm=first,
        least_mm=turning.least,
        allowance_mm=turning.allowance,
        finishing=turning.finishing,
        angle_deg=turning.angle_deg if angle is None else angle,
        chamfer_leads=turning.chamfer,
        lead_mm=turns.lead(block),
    )
    return threads(turns.here(block), numbers)
