"""Corners that a block asks for with R or C: its move waits for the next one, and the corner comes between them."""

from __future__ import annotations

from dataclasses import replace

from polycnc.errors import ProgramError
from polycnc.nc.blocks import _limits as limits
from polycnc.nc.blocks._block import BlockContext
from polycnc.nc.blocks._channel_state import ChannelState
from polycnc.nc.blocks._corners import Corner
from polycnc.nc.blocks._corners import joined as corner_moves
from polycnc.nc.blocks._moves import Arc, GeometryError, Line, QueueItem
from polycnc.nc.blocks._words import NUMBERS, GWord, code_text
from polycnc.nc.modal._modal import NO_AXIS, length_scale


def no_straight_move(block: BlockContext, corner: Corner) -> ProgramError:
    """Return the error of a block that is no straight move after a move that waits for its corner."""
    return block.problem(
        f"{corner.word} of the block before needs a straight move at feed after it",
        "Write G1 and nothing else in this block, or take the corner out.",
        None,
    )


def held(block: BlockContext, moves: list[Line]) -> list[QueueItem]:
    """Hold the last of a block's moves if R or C asks for a corner after it; return the others."""
    letters = [each for each in "RC" if each in block.words.by_letter and each not in block.after.axis_names]
    if not letters:
        return [*moves]
    word = block.words.by_letter[letters[-1]]
    size = block.words.length(letters[-1])
    if len(letters) > 1 or size is None:
        raise block.problem("R and C in one block", "Write one of them.", word)
    if size == 0.0:
        return [*moves]
    last = moves[-1]
    text = f"{letters[-1]}{code_text(word.value)}"
    block.holds = Corner(last, abs(size) * length_scale(block.after.modal), letters[-1] == "R", text)
    return [*moves[:-1]]


def joined(block: BlockContext, items: list[QueueItem]) -> list[QueueItem]:
    """Return the items after a move that waits for its corner, with that move and the corner.

    Raises:
        ProgramError: the block is no straight move at feed, or the corner does not fit.
    """
    corner, holds = block.after.corner, block.holds
    if corner is None or not (
        items or holds or block.words.by_letter.keys() - set(NUMBERS) or block.words.g or block.words.m
    ):
        block.after.corner = holds or corner
        return items
    moves = [*items, *([holds.move] if holds else [])]
    after = moves[0] if moves else None
    plane = block.after.plane
    if not isinstance(after, Line) or after.rapid or NO_AXIS in plane[:2]:
        raise no_straight_move(block, corner)
    try:
        found: list[QueueItem] = list(corner_moves(corner, after, plane))
    except GeometryError as error:
        raise block.problem(error.what, error.hint, None) from None
    for item in found:
        if isinstance(item, Arc):
            limits.check(block, item.end, "would pass")
    last = found.pop()
    if holds is None:
        block.after.corner = None
        return [*found, last, *items[1:]]
    assert isinstance(last, Line)
    if len(moves) == 1:
        block.after.corner = replace(holds, move=last)
        return found
    block.after.corner = holds
    return [*found, last, *items[1:]]


def refuse_open(block: BlockContext, state: ChannelState, g: GWord) -> None:
    """Refuse the end of a contour after a move that waits for its corner."""
    if (corner := state.corner) is not None:
        raise block.problem(
            f"{corner.word} at the end of the contour of G{g.code}",
            "A corner needs a straight move after it.",
            g.word,
        )
