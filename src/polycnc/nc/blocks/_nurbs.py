"""A curve by weighted control points (NURBS): a block begins it, blocks with X Y P add points, one more ends it.

Nothing moves before the end, so points given as ways are ways from the start of the curve.
"""

from __future__ import annotations

from dataclasses import replace

from polycnc.nc.blocks import _feeds as feeds
from polycnc.nc.blocks import _limits as limits
from polycnc.nc.blocks import _motion as motion
from polycnc.nc.blocks import _splines as splines
from polycnc.nc.blocks._block import BlockContext
from polycnc.nc.blocks._moves import Line, Spline
from polycnc.nc.blocks._nurbs_curve import Nurbs, nurbs_cubics
from polycnc.nc.blocks._words import GWord
from polycnc.nc.modal._actions import Action, Family, Group
from polycnc.nc.modal._modal import MOTION, MOTION_NONE

LEAST_ORDER, GREATEST_ORDER = 3, 16
_BESIDE = (Group.MOTION, Group.DWELL)


def refuse_others(block: BlockContext) -> None:
    """Refuse what cannot stand between the control points of a curve.

    Raises:
        ProgramError: a G code of another function.
    """
    curve = block.after.nurbs
    if curve is None:
        return
    for group, g in block.words.g.items():
        is_part = group in _BESIDE and g.action in (Action.NURBS, Action.NURBS_END, Action.DWELL)
        if not is_part:
            raise block.problem(
                f"G{g.code} in a curve (G{curve.code}) that is not ended",
                "End the curve first (G5.3).",
                g.word,
            )


def moves(block: BlockContext) -> list[Line | Spline]:
    """Take over what a block says of the curve; return its moves where it ends.

    Raises:
        ProgramError: a word is missing or has no value that a curve could have, there are too few points, or what a
            spline is refused for.
    """
    g = block.words.g.get(Group.MOTION)
    if g is not None and g.action is Action.NURBS_END:
        return _end(block, g)
    if g is not None and block.after.nurbs is None:
        _begin(block, g)
    _point(block, g)
    return []


def _begin(block: BlockContext, g: GWord) -> None:
    p, q = splines.plane_of(block, g.word)
    start = block.start
    feeds.feed(block, start, start, straight=False)  # refused where the curve begins
    block.after.spline_way = None
    block.after.nurbs = Nurbs(g.code, block.line, LEAST_ORDER, ((start[p], start[q], 1.0),))
    block.after.mode = Family.CURVE


def _point(block: BlockContext, g: GWord | None) -> None:
    curve = block.after.nurbs
    assert curve is not None
    p, q = splines.plane_of(block, block.words.first(*block.after.axis_names))
    values = splines.axis_words(block, (p, q))
    if g is not None:
        curve = replace(curve, order=_order(block, curve.order))
        if not values and block.words.first("P"):
            if len(curve.points) > 1:
                raise block.problem(
                    "a weight without a control point", "Add X and Y.", block.words.first("P")
                )
            x, y, _ = curve.points[0]
            curve = replace(curve, points=((x, y, _weight(block)),))
    if values:
        if len(values) < 2:
            there, missing = ("X", "Y") if p in values else ("Y", "X")
            raise block.problem(
                f"a control point with {there} and without {missing}",
                f"Add {missing}.",
                block.words.first(there),
            )
        point = motion.target(block, values)
        limits.check(block, point)
        curve = replace(curve, points=(*curve.points, (point[p], point[q], _weight(block))))
    block.after.nurbs = curve


def _weight(block: BlockContext) -> float:
    word = block.words.first("P")
    value = block.words.value("P")
    if value is None:
        raise block.problem(
            "a control point without a weight", "Add P, 1 for equal weights.", block.words.first("X", "Y")
        )
    if value <= 0.0:
        raise block.problem(f"a weight of {value:g}", "Weights (P) are above 0.", word)
    return value


def _order(block: BlockContext, order: int) -> int:
    word = block.words.first("L")
    value = block.words.value("L")
    if value is None:
        return order
    if value != int(value) or not LEAST_ORDER <= value <= GREATEST_ORDER:
        raise block.problem(
            f"a curve of order {value:g}",
            f"L is a whole number, {LEAST_ORDER} to {GREATEST_ORDER}: 3 for parabolas, 4 for cubics.",
            word,
        )
    return int(value)


def _end(block: BlockContext, g: GWord) -> list[Line | Spline]:
    state = block.after
    curve = state.nurbs
    if curve is None:
        raise block.problem(f"G{g.code} without a curve that it ends", "Begin one with G5.2.", g.word)
    if len(curve.points) < curve.order:
        raise block.problem(
            f"a curve of order {curve.order} with {len(curve.points)} control points",
            f"It takes {curve.order}; the start is one of them.",
            g.word,
        )
    whole = state.modal.whole
    plane = state.plane[:2]
    end = list(block.start)
    end[plane[0]], end[plane[1]], _ = curve.points[-1]
    moves = splines.parts(block, tuple(end), plane, nurbs_cubics(curve.points, curve.order))
    state.nurbs = None
    state.leave_drilling()
    state.leave_turning()
    state.mode = Family.MOVE
    whole[MOTION] = MOTION_NONE
    return moves
