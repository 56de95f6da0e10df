"""A curve by weighted control points (NURBS): a block begins it, blocks with X Y P add points, one more ends it.

Nothing moves before the end, so points given as ways are ways from the start of the curve.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from polycnc.nc.blocks._channel_state import ChannelState
from polycnc.nc.blocks._motion import MotionBuilder
from polycnc.nc.blocks._moves import Line, Spline
from polycnc.nc.blocks._nurbs_curve import Nurbs, nurbs_cubics
from polycnc.nc.blocks._splines import SplineBlocks
from polycnc.nc.blocks._words import BlockWords, Fail, GWord
from polycnc.nc.modal._actions import Action, Group
from polycnc.nc.modal._modal import AXIS_P, AXIS_Q, MOTION, MOTION_NONE

LEAST_ORDER, GREATEST_ORDER = 3, 16
_BESIDE = (Group.MOTION, Group.DWELL)


class NurbsBlocks:
    """Turn the blocks of a curve into moves, by the modal state."""

    def __init__(
        self,
        state: ChannelState,
        motion: MotionBuilder,
        splines: SplineBlocks,
        fail: Fail,
        leave_cycles: Callable[[], None],
    ) -> None:
        self._state = state
        self._motion = motion
        self._splines = splines
        self._fail = fail
        self._leave_cycles = leave_cycles

    def refuse_others(self, words: BlockWords) -> None:
        """Refuse what cannot stand between the control points of a curve.

        Raises:
            ProgramError: a G code of another function.
        """
        curve = self._state.nurbs
        if curve is None:
            return
        for group, g in words.g.items():
            is_part = group in _BESIDE and g.action in (Action.NURBS, Action.NURBS_END, Action.DWELL)
            if not is_part:
                raise self._fail(
                    f"G{g.code} in a curve (G{curve.code}) that is not ended",
                    "End the curve first (G5.3).",
                    g.word,
                )

    def block(self, words: BlockWords, line: int) -> list[Line | Spline]:
        """Take over what a block says of the curve; return its moves where it ends.

        Raises:
            ProgramError: a word is missing or has no value that a curve could have, there are too few points, or what a
                spline is refused for.
        """
        g = words.g.get(Group.MOTION)
        if g is not None and g.action is Action.NURBS_END:
            return self._end(g, line)
        if g is not None and self._state.nurbs is None:
            self._begin(g, line)
        self._point(words, g)
        return []

    def _begin(self, g: GWord, line: int) -> None:
        p, q = self._splines.plane(g.word)
        start = self._motion.start
        self._motion.feed(start, start, straight=False)  # refused where the curve begins
        self._state.spline_way = None
        self._state.nurbs = Nurbs(g.code, line, LEAST_ORDER, ((start[p], start[q], 1.0),))

    def _point(self, words: BlockWords, g: GWord | None) -> None:
        curve = self._state.nurbs
        assert curve is not None
        p, q = self._splines.plane(words.first(*self._state.axis_names))
        values = self._splines.axis_words((p, q))
        if g is not None:
            curve = replace(curve, order=self._order(words, curve.order))
            if not values and words.first("P"):
                if len(curve.points) > 1:
                    raise self._fail("a weight without a control point", "Add X and Y.", words.first("P"))
                x, y, _ = curve.points[0]
                curve = replace(curve, points=((x, y, self._weight(words)),))
        if values:
            if len(values) < 2:
                there, missing = ("X", "Y") if p in values else ("Y", "X")
                raise self._fail(
                    f"a control point with {there} and without {missing}",
                    f"Add {missing}.",
                    words.first(there),
                )
            point = self._motion.target(values)
            self._motion.check_limits(point)
            curve = replace(curve, points=(*curve.points, (point[p], point[q], self._weight(words))))
        self._state.nurbs = curve

    def _weight(self, words: BlockWords) -> float:
        word = words.first("P")
        value = words.value("P")
        if value is None:
            raise self._fail(
                "a control point without a weight", "Add P, 1 for equal weights.", words.first("X", "Y")
            )
        if value <= 0.0:
            raise self._fail(f"a weight of {value:g}", "Weights (P) are above 0.", word)
        return value

    def _order(self, words: BlockWords, order: int) -> int:
        word = words.first("L")
        value = words.value("L")
        if value is None:
            return order
        if value != int(value) or not LEAST_ORDER <= value <= GREATEST_ORDER:
            raise self._fail(
                f"a curve of order {value:g}",
                f"L is a whole number, {LEAST_ORDER} to {GREATEST_ORDER}: 3 for parabolas, 4 for cubics.",
                word,
            )
        return int(value)

    def _end(self, g: GWord, line: int) -> list[Line | Spline]:
        state, motion = self._state, self._motion
        curve = state.nurbs
        if curve is None:
            raise self._fail(f"G{g.code} without a curve that it ends", "Begin one with G5.2.", g.word)
        if len(curve.points) < curve.order:
            raise self._fail(
                f"a curve of order {curve.order} with {len(curve.points)} control points",
                f"It takes {curve.order}; the start is one of them.",
                g.word,
            )
        whole = state.modal.whole
        plane = int(whole[AXIS_P]), int(whole[AXIS_Q])
        end = list(motion.start)
        end[plane[0]], end[plane[1]], _ = curve.points[-1]
        moves = self._splines.parts(tuple(end), plane, nurbs_cubics(curve.points, curve.order), line)
        state.nurbs = None
        self._leave_cycles()
        whole[MOTION] = MOTION_NONE
        return moves
