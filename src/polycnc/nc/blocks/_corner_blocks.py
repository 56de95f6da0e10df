"""Corners that a block asks for with R or C: its move waits for the next one, and the corner comes between them."""

from __future__ import annotations

from dataclasses import replace

from polycnc.errors import ProgramError
from polycnc.nc.blocks._channel_state import ChannelState
from polycnc.nc.blocks._corners import Corner, CornerError
from polycnc.nc.blocks._corners import joined as corner_moves
from polycnc.nc.blocks._motion import MotionBuilder
from polycnc.nc.blocks._moves import Arc, Line, Move, QueueItem
from polycnc.nc.blocks._words import BlockWords, Fail, GWord, code_text
from polycnc.nc.modal._modal import AXIS_P, AXIS_Q, AXIS_R, NO_AXIS, length_scale

NUMBERS = "NO:"
"""The letters of block and program numbers."""


class CornerBlocks:
    """Hold back moves that wait for their corner, and give them out with it."""

    def __init__(self, state: ChannelState, motion: MotionBuilder, fail: Fail) -> None:
        self._state = state
        self._motion = motion
        self._fail = fail
        self._holds: Corner | None = None  # the corner that the present block asks for

    def no_straight_move(self, corner: Corner) -> ProgramError:
        """Return the error of a block that is no straight move behind a move that waits for its corner."""
        return self._fail(
            f"{corner.word} of the block before needs a straight move at feed behind it",
            "Write G1 and nothing else in this block, or take the corner out.",
            None,
        )

    def held(self, moves: list[Move], words: BlockWords) -> list[QueueItem]:
        """Hold the last of a block's moves if R or C asks for a corner behind it; return the others."""
        letters = [each for each in "RC" if each in words.by_letter and each not in self._state.axis_names]
        if not letters:
            return list(moves)
        word = words.by_letter[letters[-1]]
        size = words.length(letters[-1])
        if len(letters) > 1 or size is None:
            raise self._fail("R and C in one block", "Write one of them.", word)
        if size == 0.0:
            return list(moves)
        last = moves[-1]
        assert isinstance(last, Line)
        text = f"{letters[-1]}{code_text(word.value)}"
        self._holds = Corner(last, abs(size) * length_scale(self._state.modal), letters[-1] == "R", text)
        return list(moves[:-1])

    def joined(self, items: list[QueueItem], words: BlockWords) -> list[QueueItem]:
        """Return the items behind a move that waits for its corner, with that move and the corner.

        Raises:
            ProgramError: the block is no straight move at feed, or the corner does not fit.
        """
        corner, holds = self._state.corner, self._holds
        self._holds = None
        if corner is None or not (
            items or holds or words.by_letter.keys() - set(NUMBERS) or words.g or words.m
        ):
            self._state.corner = holds or corner
            return items
        moves = [*items, *([holds.move] if holds else [])]
        after = moves[0] if moves else None
        whole = self._state.modal.whole
        plane = int(whole[AXIS_P]), int(whole[AXIS_Q]), int(whole[AXIS_R])
        if not isinstance(after, Line) or after.rapid or NO_AXIS in plane[:2]:
            raise self.no_straight_move(corner)
        try:
            found: list[QueueItem] = list(corner_moves(corner, after, plane))
        except CornerError as error:
            raise self._fail(error.what, error.hint, None) from None
        for item in found:
            if isinstance(item, Arc):
                self._motion.check_limits(item.end, "would pass")
        last = found.pop()
        if holds is None:
            self._state.corner = None
            return [*found, last, *items[1:]]
        assert isinstance(last, Line)
        if len(moves) == 1:
            self._state.corner = replace(holds, move=last)
            return found
        self._state.corner = holds
        return [*found, last, *items[1:]]

    def refuse_open(self, g: GWord) -> None:
        """Refuse the end of a contour behind a move that waits for its corner."""
        if (corner := self._state.corner) is not None:
            raise self._fail(
                f"{corner.word} at the end of the contour of G{g.code}",
                "A corner needs a straight move behind it.",
                g.word,
            )
