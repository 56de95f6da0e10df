"""Spline blocks: a cubic by its two control points, a quadratic by the one it has, in the plane XY.

A cubic is I J from its start and P Q from its end; without I J it goes on as the cubic before it ended. It stays in
force for its own block only. A quadratic is the cubic with its control points at two thirds of the way to its own.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

import numpy as np

from polycnc.kernel import MOST_SPANS, SPAN_CURVED, SPAN_END, SPAN_LENGTH, SPAN_SIZE, cut_bezier
from polycnc.nc.blocks import _feeds as feeds
from polycnc.nc.blocks import _limits as limits
from polycnc.nc.blocks import _motion as motion
from polycnc.nc.blocks._block import BlockContext
from polycnc.nc.blocks._moves import Feed, Line, Point, Spline
from polycnc.nc.blocks._words import GWord
from polycnc.nc.modal._actions import Action, Group
from polycnc.nc.modal._modal import NO_AXIS, PLANE, PLANE_XY, length_scale
from polycnc.nc.text._scan_plain import Word

XY = tuple[float, float]


def moves(block: BlockContext) -> list[Line | Spline]:
    """Return the moves of a spline block, none if it goes nowhere.

    Raises:
        ProgramError: another plane than XY or another axis, a control point that is missing, radius compensation, a
            feed that is missing, a limit.
    """
    g = block.words.g[Group.MOTION]
    plane = plane_of(block, g.word)
    values = axis_words(block, plane)
    if not values:
        raise block.problem("a spline without an end point", "Add X or Y.", g.word)
    end = motion.target(block, values)
    way = end[plane[0]] - block.start[plane[0]], end[plane[1]] - block.start[plane[1]]
    control = _cubic(block, g, way) if g.action is Action.CUBIC_SPLINE else _quadratic(block, g, way)
    return parts(block, end, plane, [control])


def plane_of(block: BlockContext, word: Word | None) -> tuple[int, int]:
    """Return the axes of a spline.

    Raises:
        ProgramError: another plane than XY, radius compensation.
    """
    state, whole = block.after, block.after.modal.whole
    plane = state.plane[:2]
    if whole[PLANE] != PLANE_XY or NO_AXIS in plane:
        raise block.problem("a spline outside the plane XY", "Select it with G17 first.", word)
    if state.side or state.compensation.active:
        raise block.problem(
            "a spline with radius compensation",
            "Take it back with G40 and a straight move first, or write the path of the tool's centre.",
            word,
        )
    return plane


def axis_words(block: BlockContext, plane: tuple[int, int]) -> dict[int, float]:
    """Take the axis words of a block.

    Raises:
        ProgramError: there is another axis.
    """
    values = motion.axis_words(block)
    for axis in values:
        if axis not in plane:
            name = block.after.axis_names[axis]
            raise block.problem(
                f"a spline moves X and Y only, not {name}",
                f"Move {name} in a block of its own.",
                block.words.first(name),
            )
    return values


def _cubic(block: BlockContext, g: GWord, way: XY) -> list[XY]:
    """Return the ways from the start to the inner control points and the end; remember how it ends."""
    first, last = _way(block, "I", "J"), _way(block, "P", "Q")
    if first is None:
        if block.after.spline_way is None:
            raise block.problem(
                f"the first of a series of splines (G{g.code}) needs I and J",
                "Add the way from the start to the first control point.",
                g.word,
            )
        first = block.after.spline_way
    if last is None:
        raise block.problem(
            f"a spline (G{g.code}) needs P and Q",
            "Add the way from the end to the last control point.",
            g.word,
        )
    block.after.spline_way = -last[0], -last[1]
    return [first, (way[0] + last[0], way[1] + last[1]), way]


def _quadratic(block: BlockContext, g: GWord, way: XY) -> list[XY]:
    middle = _way(block, "I", "J")
    if middle is None:
        raise block.problem(
            f"a quadratic spline (G{g.code}) needs I and J",
            "Add the way from the start to the control point.",
            g.word,
        )
    block.after.spline_way = None
    x, y = middle[0] * 2.0 / 3.0, middle[1] * 2.0 / 3.0
    return [(x, y), (x + way[0] / 3.0, y + way[1] / 3.0), way]


def _way(block: BlockContext, first: str, second: str) -> XY | None:
    """Take two words that say where a control point is (mm); None without both.

    Raises:
        ProgramError: one of them is missing.
    """
    u, v = block.words.length(first), block.words.length(second)
    if u is None and v is None:
        return None
    if u is None or v is None:
        there, missing = (second, first) if u is None else (first, second)
        raise block.problem(
            f"a control point with {there} and without {missing}",
            f"Add {missing}; 0 is a way too.",
            block.words.first(there),
        )
    scale = length_scale(block.after.modal)
    p, q, _ = block.after.plane
    return block.after.frame.vector(p, q, u * scale, v * scale)


def parts(
    block: BlockContext, end: Point, plane: tuple[int, int], cubics: Iterable[list[XY]]
) -> list[Line | Spline]:
    """Return the moves along cubics that follow each other up to `end`, none if they go nowhere.

    A cubic is the ways from its start to its inner control points and to its end.

    Raises:
        ProgramError: a limit, a feed that is missing, control points too far apart.
    """
    limits.check(block, end)
    rows: list[list[float]] = []
    spans = np.zeros((MOST_SPANS, SPAN_SIZE))
    behind = 0.0, 0.0
    for control in cubics:
        _check_extremes(block, control, plane, behind)
        count = cut_bezier(np.array([(0.0, 0.0), *control]), spans)
        if count < 0:
            raise block.problem(
                "the control points of the spline lie too far from each other",
                "Check I J P Q.",
                block.move_word,
            )
        for row in spans[:count].tolist():
            row[SPAN_END] += behind[0]
            row[SPAN_END + 1] += behind[1]
            rows.append(row)
        behind = behind[0] + control[2][0], behind[1] + control[2][1]
    return list(_moves(block, rows, end, plane))


def _check_extremes(block: BlockContext, control: list[XY], plane: tuple[int, int], behind: XY) -> None:
    start = block.start
    for corner in _extremes(control):
        passed = list(start)
        for j, axis in enumerate(plane):
            passed[axis] = start[axis] + (behind[j] + corner[j])
        limits.check(block, tuple(passed), "would pass")


def _moves(
    block: BlockContext, rows: list[list[float]], end: Point, plane: tuple[int, int]
) -> Iterator[Line | Spline]:
    start = block.start
    feed = feeds.feed(block, start, end, straight=False) if rows else Feed()
    whole_mm = math.fsum(row[SPAN_LENGTH] for row in rows)
    for left, row in zip(range(len(rows) - 1, -1, -1), rows, strict=True):
        length = row[SPAN_LENGTH]
        place = list(start)
        for j, axis in enumerate(plane):
            place[axis] = block.start[axis] + row[SPAN_END + j]
        to = tuple(place) if left else end
        part = Feed(duration_s=feed.duration_s * length / whole_mm) if feed.duration_s > 0.0 else feed
        stop = block.exact_stop and not left
        if row[SPAN_CURVED]:
            yield Spline(start, to, plane, tuple(row[:SPAN_END]), length, part, stop, block.line)
        else:
            yield Line(start, to, part, False, stop, block.line)
        start = to


def _extremes(control: list[XY]) -> Iterator[XY]:
    """Yield the points, ways from the start, at which a cubic turns back in one of its axes."""
    for i in range(2):
        p1, p2, p3 = (way[i] for way in control)
        a, b, c = p3 - 3.0 * p2 + 3.0 * p1, 2.0 * (p2 - 2.0 * p1), p1  # of dp/du / 3 = a u2 + b u + c
        root = math.sqrt(max(b * b - 4.0 * a * c, 0.0))
        lever = -0.5 * (b + math.copysign(root, b))
        for above, below in ((lever, a), (c, lever)):
            u = above / below if below != 0.0 else math.inf
            if 0.0 < u < 1.0:
                yield _at(control, u, 0), _at(control, u, 1)


def _at(control: list[XY], u: float, i: int) -> float:
    v = 1.0 - u
    return 3.0 * u * v * (v * control[0][i] + u * control[1][i]) + u * u * u * control[2][i]
