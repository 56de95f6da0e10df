"""Blocks of circular motion: by centre (I J K) or radius (R), with whole turns (P)."""

from __future__ import annotations

from polycnc.nc.blocks import _feeds as feeds
from polycnc.nc.blocks import _limits as limits
from polycnc.nc.blocks._arcs import (
    ARC_NO_RADIUS,
    ARC_OFF_CIRCLE,
    ARC_OK,
    ARC_RADIUS_AT_SAME_POINT,
    ARC_RADIUS_TOO_SMALL,
    ARC_TOO_LARGE,
    TWO_PI,
    arc_by_center,
    arc_by_radius,
)
from polycnc.nc.blocks._block import BlockContext
from polycnc.nc.blocks._moves import Arc, Point
from polycnc.nc.blocks._words import code_text
from polycnc.nc.modal._modal import (
    ARC_ABSOLUTE,
    ARC_INCH_TOLERANCE,
    ARC_MOST,
    ARC_RELATIVE,
    ARC_SHORT_RADIUS,
    ARC_TOLERANCE,
    CENTER_LETTERS,
    INCH,
    LARGEST,
    PLANE,
    PLANE_LETTERS,
    length_scale,
)

_ARC_PROBLEMS = {
    ARC_NO_RADIUS: (
        "the arc has no radius",
        "Give the way from the start to the centre (I J K), or a radius R that is not 0.",
    ),
    ARC_RADIUS_TOO_SMALL: (
        "the radius is {off:.6g} mm too small to reach the end point",
        "R must be at least half the distance between start and end.",
    ),
    ARC_RADIUS_AT_SAME_POINT: (
        "an arc with R ends where it starts, so its centre is unknown",
        "Write a full circle with I J K.",
    ),
    ARC_OFF_CIRCLE: (
        "the end point is {off:.6g} mm off the circle about the given centre",
        "Check the end point and the centre (I J K); the dialect's [arcs] says how much is tolerated.",
    ),
    ARC_TOO_LARGE: ("the radius of the arc is larger than any machine", "Check R, or I J K."),
}


def arc(block: BlockContext, end: Point, clockwise: bool) -> Arc | None:
    """Return a circular move to `end` by centre (I J K) or radius (R); None if a line stands for it.

    Raises:
        ProgramError: no centre, a centre word outside the plane, an end point off the circle, a limit.
    """
    p, q, r = block.plane("an arc", block.move_word)
    center = _center_words(block, int(block.after.modal.whole[PLANE]))
    radius = None if "R" in block.after.axis_names else block.words.length("R")
    if not center and radius is None:
        if block.dialect.arcs.no_center == "line":
            block.note("an arc with neither centre nor radius goes straight to its end point")
            return None
        raise block.problem(
            "an arc needs a centre or a radius",
            "Add I J K or R, or write G1 if the move is straight.",
            block.move_word,
        )
    if center and radius is not None:
        raise block.problem(
            "an arc has both a radius R and a centre", "Write one of them.", block.words.first("R")
        )
    _refuse_half(block, center)
    start = block.start
    frame = block.after.frame
    if frame.active:
        turn = frame.outer
        if block.dialect.turns_work and turn is not None and {p, q} != {turn.p, turn.q}:
            raise block.problem(
                "an arc outside the plane that the work offset turns",
                "Remove R from G10 L2, or write lines.",
                block.move_word,
            )
        clockwise ^= frame.turns_over(p, q)
        if center and abs(frame.factor(p)) != abs(frame.factor(q)):
            raise block.problem(
                "an arc with a centre between axes of different scale", "Write it with R.", block.move_word
            )
        if radius is not None:
            radius *= max(abs(frame.factor(p)), abs(frame.factor(q)))
    center_p, center_q, sweep = _circle(block, start, end, p, q, center, radius, clockwise)
    extra = TWO_PI * (_turns(block) - 1)
    sweep = sweep - extra if clockwise else sweep + extra
    feed = feeds.feed(block, start, end, straight=False)
    made = Arc(start, end, (center_p, center_q), sweep, (p, q, r), feed, block.exact_stop, block.line)
    for passed, what in limits.points(made):
        limits.check(block, passed, what)
    return made


def _refuse_half(block: BlockContext, center: dict[str, float]) -> None:
    """Refuse an absolute centre of one word, where the dialect does."""
    if (
        not center
        or "half a centre" not in block.dialect.refuses
        or not block.after.modal.whole[ARC_ABSOLUTE]
    ):
        return
    for letter in CENTER_LETTERS[int(block.after.modal.whole[PLANE])]:
        if letter not in center:
            word = block.words.first(*"IJK")
            raise block.problem(f"an absolute centre (G90.1) without {letter}", "Write both.", word)


def _center_words(block: BlockContext, plane: int) -> dict[str, float]:
    """Take I J K; one that is not of the plane may stand there if it is 0."""
    center = {}
    for letter in "IJK":
        value = block.words.length(letter)
        if value is None:
            continue
        if letter in CENTER_LETTERS[plane]:
            center[letter] = value
        elif value != 0.0:
            raise block.problem(
                f"'{letter}' is no centre word of the plane {PLANE_LETTERS[plane][:2]}",
                f"Use {' and '.join(CENTER_LETTERS[plane])}, or select another plane (G17, G18, G19).",
                block.words.first(letter),
            )
    return center


def _turns(block: BlockContext) -> int:
    turns = block.words.value("P") if block.dialect.arcs.turns else None
    if turns is None:
        return 1
    if not turns.is_integer() or not 1 <= turns <= LARGEST:
        raise block.problem(
            f"the number of turns P{code_text(turns)} of an arc is not a whole number from 1 up",
            "Write P1, P2, ...",
            block.words.first("P"),
        )
    return int(turns)


def _circle(
    block: BlockContext,
    start: Point,
    end: Point,
    p: int,
    q: int,
    center: dict[str, float],
    radius: float | None,
    clockwise: bool,
) -> tuple[float, float, float]:
    """Return the centre and the sweep of an arc of up to one turn."""
    modal = block.after.modal
    tolerance = float(modal.real[ARC_INCH_TOLERANCE if modal.whole[INCH] else ARC_TOLERANCE])
    ends = start[p], start[q], end[p], end[q]
    if radius is not None:
        found = arc_by_radius(
            *ends, radius * length_scale(modal), clockwise, float(modal.real[ARC_SHORT_RADIUS])
        )
    else:
        letters = CENTER_LETTERS[int(modal.whole[PLANE])]
        if block.after.frame.active:
            at = _framed_center(block, [center.get(letter, 0.0) for letter in letters], start, p, q)
        else:
            at = [
                _center(block, axis, center.get(letter), start)
                for axis, letter in zip((p, q), letters, strict=True)
            ]
        found = arc_by_center(
            *ends,
            at[0],
            at[1],
            clockwise,
            tolerance,
            float(modal.real[ARC_RELATIVE]),
            float(modal.real[ARC_MOST]),
        )
    status, center_p, center_q, sweep, off = found
    if status != ARC_OK:
        what, hint = _ARC_PROBLEMS[status]
        raise block.problem(
            what.format(off=off), hint, block.words.first(*("R" if radius is not None else "IJK"))
        )
    return center_p, center_q, sweep


def _framed_center(block: BlockContext, center: list[float], start: Point, p: int, q: int) -> list[float]:
    modal = block.after.modal
    u, v = (value * length_scale(modal) for value in center)
    if not modal.whole[ARC_ABSOLUTE]:
        u, v = block.after.frame.vector(p, q, u, v)
        return [start[p] + u, start[q] + v]
    point = block.after.frame.back(block.after.here)
    point[p], point[q] = u, v
    found = block.after.frame.forward(point)
    return [found[axis] + float(modal.offset[axis]) for axis in (p, q)]


def _center(block: BlockContext, axis: int, value: float | None, start: Point) -> float:
    modal = block.after.modal
    if value is None:
        return start[axis]
    length = value * length_scale(modal)
    return length + float(modal.offset[axis]) if modal.whole[ARC_ABSOLUTE] else start[axis] + length
