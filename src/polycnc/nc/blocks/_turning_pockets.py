"""Roughing of contours with pockets (G71, G72 type II): monotone along the cuts, in and out across them as it likes.

Levels lie one depth below each other. At each one the contour leaves stretches open; a stretch below another one is its
child. A pocket is cut to its bottom before the next one: in along its flank, along the level, out along the other
flank up to the level above, then away by the escape.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

from polycnc.nc.blocks._moves import GeometryError
from polycnc.nc.blocks._turning import (
    MOST_PASSES,
    SAME_MM,
    Piece,
    Point,
    Roughing,
    Step,
    along,
    angle_of,
    back,
    check_top,
    extremes,
)


@dataclass(frozen=True, slots=True)
class _Place:
    """A point of the contour: on the piece of this number."""

    piece: int
    point: Point


@dataclass(slots=True)
class _Stretch:
    """What is open at a level, between two places of the contour; `inner` are those of the next level."""

    level: float
    begin: _Place
    end: _Place
    inner: list[_Stretch] = field(default_factory=list)


def rough_pockets(contour: Sequence[Piece], numbers: Roughing, *, first_rapid: bool) -> list[Step]:
    """Return the steps of roughing along Z, from the start of the first piece and back to it.

    The first piece is the way from the start to the contour; `first_rapid` says that it is a rapid, and so are the
    infeeds along it.

    Raises:
        GeometryError: The contour turns back along Z, comes out beyond the start, or a number makes no sense.
    """
    start = contour[0].start
    corner = start[0] + numbers.allowance[0], start[1] + numbers.allowance[1]
    pieces = [part for piece in contour for part in _monotone(piece.shifted(numbers.allowance))]
    first = sum(1 for _ in _monotone(contour[0]))
    if len(pieces) == first:
        raise GeometryError("the contour has one block only", "Give it two blocks and more.")
    if numbers.depth_mm <= 0.0:
        raise GeometryError("the depth of a cut is not above zero", "Give U (G71) or W (G72) above 0.")
    x_way = _x_way(pieces, corner)
    z_way = _z_way(pieces, first)
    check_top(contour, x_way)
    work = _Work(_closed(pieces, corner[0]), numbers, x_way, z_way, first if first_rapid else 0)
    steps = [Step(corner, rapid=True)] if corner != start else []
    steps += work.passes(corner)
    at = steps[-1].end if steps else start
    if abs(at[0] - corner[0]) > SAME_MM:
        steps.append(Step((corner[0], at[1]), rapid=True))
    if abs(at[1] - corner[1]) > SAME_MM:
        steps.append(Step(corner, rapid=True))
    steps += [
        replace(along(piece), rapid=first_rapid and number < first) for number, piece in enumerate(pieces)
    ]
    return [*steps, *back(pieces[-1].end, start)]


def _monotone(piece: Piece) -> Iterator[Piece]:
    """Yield the parts of a piece that turn back in no axis."""
    points = [piece.start, *extremes(piece), piece.end]
    for start, end in itertools.pairwise(points):
        yield _part(piece, start, end)


def _part(piece: Piece, start: Point, end: Point) -> Piece:
    """Return the part of a piece between two of its points."""
    if piece.center is None:
        return Piece(start, end)
    turned = angle_of(end, piece.center) - angle_of(start, piece.center)
    return Piece(start, end, piece.center, math.remainder(turned, 2.0 * math.pi))  # a quarter at the most


def _x_way(pieces: Sequence[Piece], corner: Point) -> float:
    """Return on which side of the start the contour lies: where it is further away."""
    farthest = max((piece.end[0] - corner[0] for piece in pieces), key=abs)
    if abs(farthest) < SAME_MM:
        raise GeometryError("the contour leaves nothing to rough", "Start away from it.")
    return math.copysign(1.0, farthest)


def _z_way(pieces: Sequence[Piece], first: int) -> float:
    """Return which way the contour follows the cuts; the way to it must not go against that.

    Raises:
        GeometryError: It turns back, or does not go anywhere.
    """
    way = math.copysign(1.0, pieces[-1].end[1] - pieces[first].start[1])
    if abs(pieces[-1].end[1] - pieces[first].start[1]) < SAME_MM:
        raise GeometryError("the contour comes back to where it begins", "End it where the part ends.")
    if any((piece.end[1] - piece.start[1]) * way < -SAME_MM for piece in pieces):
        raise GeometryError(
            "the contour turns back along the cuts",
            "It may go in and out across them, but only one way along them: Z for G71, X for G72.",
        )
    return way


def _closed(pieces: Sequence[Piece], top: float) -> list[Piece]:
    """Return the contour with a wall at its end, up to where the cycle begins."""
    x, z = pieces[-1].end
    return [*pieces, Piece((x, z), (top, z))]


class _Work:
    """The passes of one contour."""

    def __init__(
        self, pieces: Sequence[Piece], numbers: Roughing, x_way: float, z_way: float, rapid_pieces: int
    ) -> None:
        self._pieces = pieces
        self._numbers = numbers
        self._x_way, self._z_way = x_way, z_way
        self._rapid_pieces = rapid_pieces
        self._count = 0

    def passes(self, corner: Point) -> list[Step]:
        """Return the steps of all passes, from the corner."""
        last = len(self._pieces) - 1
        whole = _Stretch(corner[0], _Place(0, corner), _Place(last, self._pieces[last].end))
        stack = self._below(whole)[::-1]
        above = {id(each): whole for each in stack}
        steps: list[Step] = []
        at = corner
        while stack:
            stretch = stack.pop()
            found = self._cut(stretch, above[id(stretch)], at)
            steps += found
            at = found[-1].end
            inner = self._below(stretch)
            above |= {id(each): stretch for each in inner}
            stretch.inner = inner  # keeps them, and so their ids
            stack += inner[::-1]
        return steps

    def _deeper(self, x: float, level: float) -> float:
        return (x - level) * self._x_way

    def _below(self, outer: _Stretch) -> list[_Stretch]:
        """Return what is open one depth below a stretch."""
        level = outer.level + self._x_way * self._numbers.depth_mm
        found: list[_Stretch] = []
        begin: _Place | None = None
        for number in range(outer.begin.piece, outer.end.piece + 1):
            piece = self._pieces[number]
            start = self._deeper(piece.start[0], level)
            end = self._deeper(piece.end[0], level)
            if begin is None and start <= SAME_MM < end:
                begin = _Place(number, self._crossing(piece, level))
            elif begin is not None and end <= SAME_MM < start:
                stretch = _Stretch(level, begin, _Place(number, self._crossing(piece, level)))
                begin = None
                if abs(stretch.end.point[1] - stretch.begin.point[1]) > SAME_MM:
                    found.append(stretch)
        self._count += len(found)
        if self._count > MOST_PASSES:
            raise GeometryError(f"roughing would take more than {MOST_PASSES} passes", "Give a larger depth.")
        return found

    def _crossing(self, piece: Piece, level: float) -> Point:
        """Return where a piece that turns back in no axis comes to a level."""
        (x0, z0), (x1, z1) = piece.start, piece.end
        if abs(level - x0) <= SAME_MM:
            return level, z0
        if abs(level - x1) <= SAME_MM:
            return level, z1
        if piece.center is None:
            return level, z0 + (z1 - z0) * (level - x0) / (x1 - x0)
        x, z = piece.center
        half = math.sqrt(max(math.dist(piece.start, piece.center) ** 2 - (level - x) ** 2, 0.0))
        low, high = sorted((z0, z1))
        return level, min((z - half, z + half), key=lambda each: max(low - each, each - high, 0.0))

    def _cut(self, stretch: _Stretch, outer: _Stretch, at: Point) -> list[Step]:
        """Return the steps of one stretch: over it, in along its flank, along it, out along the other one, away."""
        down, out = self._flank_down(stretch, outer), self._flank_up(stretch, outer)
        away = outer.level - self._x_way * self._numbers.escape_mm
        over = down[0].start
        steps: list[Step] = []
        rapid = stretch.begin.piece < self._rapid_pieces
        if math.dist(over, at) > SAME_MM:
            height = over[0] if rapid else away
            first, second = (height, at[1]), (height, over[1])
            if self._deeper(height, at[0]) > 0.0:  # further in: first along, then in
                first = at[0], over[1]
            steps += [Step(each, rapid=True) for each in (first, second)]
            if not rapid:
                steps.append(Step(over))
        steps += [replace(along(piece), rapid=rapid) for piece in down]
        steps.append(Step(stretch.end.point))
        steps += [along(piece) for piece in out]
        z = steps[-1].end[1] - self._z_way * self._numbers.escape_mm
        if (z - over[1]) * self._z_way < 0.0:
            z = over[1]
        steps.append(Step((away, z), rapid=True))
        return _moving(steps, at)

    def _flank_down(self, stretch: _Stretch, outer: _Stretch) -> list[Piece]:
        """Return the flank that leads down to a stretch: from the level above it, or from where it begins."""
        number, end = stretch.begin.piece, stretch.begin.point
        found: list[Piece] = []
        while True:
            piece = self._pieces[number]
            deeper = self._deeper(piece.start[0], outer.level)
            if deeper <= 0.0 or number == outer.begin.piece:
                start = outer.begin.point
                if number != outer.begin.piece:
                    start = self._crossing(piece, outer.level) if deeper < -SAME_MM else piece.start
                return [_part(piece, start, end), *found]
            found.insert(0, _part(piece, piece.start, end))
            before = self._pieces[number - 1]
            if self._deeper(before.start[0], before.end[0]) >= -SAME_MM:
                return found  # the top of a ridge that does not come up to the level above
            number, end = number - 1, piece.start

    def _flank_up(self, stretch: _Stretch, outer: _Stretch) -> list[Piece]:
        """Return the flank that leads up from a stretch."""
        number, start = stretch.end.piece, stretch.end.point
        found: list[Piece] = []
        while True:
            piece = self._pieces[number]
            deeper = self._deeper(piece.end[0], outer.level)
            if deeper <= 0.0:
                end = self._crossing(piece, outer.level) if deeper < -SAME_MM else piece.end
                return [*found, _part(piece, start, end)]
            found.append(_part(piece, start, piece.end))
            number, start = number + 1, piece.end
            if self._deeper(self._pieces[number].end[0], start[0]) >= -SAME_MM:
                return found


def _moving(steps: Sequence[Step], at: Point) -> list[Step]:
    """Return the steps that go anywhere."""
    found = []
    for step in steps:
        if math.dist(step.end, at) > SAME_MM:
            found.append(step)
            at = step.end
    return found
