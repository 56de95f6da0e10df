"""Spline blocks: a cubic by its two control points, a quadratic by the one it has, in the plane XY.

A cubic is I J from its start and P Q from its end; without I J it goes on as the cubic before it ended. It stays in
force for its own block only. A quadratic is the cubic with its control points at two thirds of the way to its own.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

import numpy as np

from polycnc.kernel import MOST_SPANS, SPAN_CURVED, SPAN_END, SPAN_LENGTH, SPAN_SIZE, cut_bezier
from polycnc.nc.blocks._channel_state import ChannelState
from polycnc.nc.blocks._motion import MotionBuilder
from polycnc.nc.blocks._moves import Feed, Line, Point, Spline
from polycnc.nc.blocks._words import Fail, GWord
from polycnc.nc.modal._actions import Action
from polycnc.nc.modal._modal import (
    AXIS_P,
    AXIS_Q,
    NO_AXIS,
    PLANE,
    PLANE_XY,
    length_scale,
)
from polycnc.nc.text._scan_plain import Word

XY = tuple[float, float]


class SplineBlocks:
    """Turn the words of a spline block into moves, by the modal state."""

    def __init__(self, state: ChannelState, motion: MotionBuilder, fail: Fail) -> None:
        self._state = state
        self._motion = motion
        self._fail = fail
        self._spans = np.zeros((MOST_SPANS, SPAN_SIZE))

    def moves(self, g: GWord, line: int) -> list[Line | Spline]:
        """Return the moves of a spline block, none if it goes nowhere.

        Raises:
            ProgramError: another plane than XY or another axis, a control point that is missing, radius compensation, a
                feed that is missing, a limit.
        """
        motion = self._motion
        plane = self.plane(g.word)
        values = self.axis_words(plane)
        if not values:
            raise self._fail("a spline without an end point", "Add X or Y.", g.word)
        end = motion.target(values)
        way = end[plane[0]] - motion.start[plane[0]], end[plane[1]] - motion.start[plane[1]]
        control = self._cubic(g, way) if g.action is Action.CUBIC_SPLINE else self._quadratic(g, way)
        return self.parts(end, plane, [control], line)

    def plane(self, word: Word | None) -> tuple[int, int]:
        """Return the axes of a spline.

        Raises:
            ProgramError: another plane than XY, radius compensation.
        """
        state, whole = self._state, self._state.modal.whole
        plane = int(whole[AXIS_P]), int(whole[AXIS_Q])
        if whole[PLANE] != PLANE_XY or NO_AXIS in plane:
            raise self._fail("a spline outside the plane XY", "Select it with G17 first.", word)
        if state.side or state.compensation.active:
            raise self._fail(
                "a spline with radius compensation",
                "Take it back with G40 and a straight move first, or write the path of the tool's centre.",
                word,
            )
        return plane

    def axis_words(self, plane: tuple[int, int]) -> dict[int, float]:
        """Take the axis words of a block.

        Raises:
            ProgramError: there is another axis.
        """
        values = self._motion.axis_words()
        for axis in values:
            if axis not in plane:
                name = self._state.axis_names[axis]
                raise self._fail(
                    f"a spline moves X and Y only, not {name}",
                    f"Move {name} in a block of its own.",
                    self._motion.words.first(name),
                )
        return values

    def _cubic(self, g: GWord, way: XY) -> list[XY]:
        """Return the ways from the start to the inner control points and the end; remember how it ends."""
        first, last = self._way("I", "J"), self._way("P", "Q")
        if first is None:
            if self._state.spline_way is None:
                raise self._fail(
                    f"the first of a series of splines (G{g.code}) needs I and J",
                    "Add the way from the start to the first control point.",
                    g.word,
                )
            first = self._state.spline_way
        if last is None:
            raise self._fail(
                f"a spline (G{g.code}) needs P and Q",
                "Add the way from the end to the last control point.",
                g.word,
            )
        self._state.spline_way = -last[0], -last[1]
        return [first, (way[0] + last[0], way[1] + last[1]), way]

    def _quadratic(self, g: GWord, way: XY) -> list[XY]:
        middle = self._way("I", "J")
        if middle is None:
            raise self._fail(
                f"a quadratic spline (G{g.code}) needs I and J",
                "Add the way from the start to the control point.",
                g.word,
            )
        self._state.spline_way = None
        x, y = middle[0] * 2.0 / 3.0, middle[1] * 2.0 / 3.0
        return [(x, y), (x + way[0] / 3.0, y + way[1] / 3.0), way]

    def _way(self, first: str, second: str) -> XY | None:
        """Take two words that say where a control point is (mm); None without both.

        Raises:
            ProgramError: one of them is missing.
        """
        words = self._motion.words
        u, v = words.length(first), words.length(second)
        if u is None and v is None:
            return None
        if u is None or v is None:
            there, missing = (second, first) if u is None else (first, second)
            raise self._fail(
                f"a control point with {there} and without {missing}",
                f"Add {missing}; 0 is a way too.",
                words.first(there),
            )
        scale = length_scale(self._state.modal)
        u, v = u * scale, v * scale
        whole = self._state.modal.whole
        return self._state.frame.vector(int(whole[AXIS_P]), int(whole[AXIS_Q]), u, v)

    def parts(
        self, end: Point, plane: tuple[int, int], cubics: Iterable[list[XY]], line: int
    ) -> list[Line | Spline]:
        """Return the moves along cubics that follow each other up to `end`, none if they go nowhere.

        A cubic is the ways from its start to its inner control points and to its end.

        Raises:
            ProgramError: a limit, a feed that is missing, control points too far apart.
        """
        motion = self._motion
        motion.check_limits(end)
        rows: list[list[float]] = []
        behind = 0.0, 0.0
        for control in cubics:
            self._check_extremes(control, plane, behind)
            count = cut_bezier(np.array([(0.0, 0.0), *control]), self._spans)
            if count < 0:
                raise self._fail(
                    "the control points of the spline lie too far from each other",
                    "Check I J P Q.",
                    motion.place(),
                )
            for row in self._spans[:count].tolist():
                row[SPAN_END] += behind[0]
                row[SPAN_END + 1] += behind[1]
                rows.append(row)
            behind = behind[0] + control[2][0], behind[1] + control[2][1]
        return list(self._moves(rows, end, plane, line))

    def _check_extremes(self, control: list[XY], plane: tuple[int, int], behind: XY) -> None:
        start = self._motion.start
        for corner in _extremes(control):
            passed = list(start)
            for j, axis in enumerate(plane):
                passed[axis] = start[axis] + (behind[j] + corner[j])
            self._motion.check_limits(tuple(passed), "would pass")

    def _moves(
        self, rows: list[list[float]], end: Point, plane: tuple[int, int], line: int
    ) -> Iterator[Line | Spline]:
        motion = self._motion
        start = motion.start
        feed = motion.feed(start, end, straight=False) if rows else Feed()
        whole_mm = math.fsum(row[SPAN_LENGTH] for row in rows)
        for left, row in zip(range(len(rows) - 1, -1, -1), rows, strict=True):
            length = row[SPAN_LENGTH]
            place = list(start)
            for j, axis in enumerate(plane):
                place[axis] = motion.start[axis] + row[SPAN_END + j]
            to = tuple(place) if left else end
            part = Feed(duration_s=feed.duration_s * length / whole_mm) if feed.duration_s > 0.0 else feed
            stop = motion.exact_stop and not left
            if row[SPAN_CURVED]:
                yield Spline(start, to, plane, tuple(row[:SPAN_END]), length, part, stop, line)
            else:
                yield Line(start, to, part, False, stop, line)
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
