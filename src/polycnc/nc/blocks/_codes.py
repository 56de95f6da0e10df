"""Which function carries a code out, and which mode of motion gives the moves of a block."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

from polycnc.nc.blocks import (
    _contour_cycles,
    _cycle_blocks,
    _frames,
    _modal_words,
    _motion,
    _non_modal,
    _nurbs,
    _placing,
    _profile_cycles,
    _round_pockets,
    _splines,
    _turning_blocks,
    _turning_cycles,
)
from polycnc.nc.blocks._block import BlockContext
from polycnc.nc.blocks._handlers import Handler, handlers
from polycnc.nc.blocks._moves import QueueItem
from polycnc.nc.blocks._words import GWord
from polycnc.nc.modal._actions import Action, Family

CODES: Mapping[Action, Handler] = dict(
    handlers(
        _contour_cycles,
        _frames,
        _modal_words,
        _non_modal,
        _placing,
        _profile_cycles,
        _round_pockets,
        _turning_cycles,
    )
)
"""What carries a code out; its row is in `Action`. Motions have modes, tool compensation and IGNORED codes steps."""


class MotionMode(NamedTuple):
    """A mode of motion: what puts it in force, and what gives the moves of a block."""

    begin: Callable[[BlockContext, GWord], None]
    moves: Callable[[BlockContext], Sequence[QueueItem]]


def _begin_nothing(_: BlockContext, __: GWord) -> None:
    """Leave the mode in force: a spline counts for its own block, and a curve begins with its moves."""


MOTION_MODES: Mapping[Family, MotionMode] = {
    Family.MOVE: MotionMode(_motion.begin, _motion.moves),
    Family.DRILLING: MotionMode(_cycle_blocks.begin, _cycle_blocks.moves),
    Family.TURNING: MotionMode(_turning_blocks.begin, _turning_blocks.moves),
    Family.SPLINE: MotionMode(_begin_nothing, _splines.moves),
    Family.CURVE: MotionMode(_begin_nothing, _nurbs.moves),
}
"""The modes of motion by the family of their codes; `ChannelState.mode` names the one in force."""
