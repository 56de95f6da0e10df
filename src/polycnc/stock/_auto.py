"""Find the body that a program is cut from, from the course of its tools."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from polycnc.errors import UsageError
from polycnc.stock._contacts import ContactKind
from polycnc.stock._cutting import Cutting
from polycnc.stock._rows import Rows
from polycnc.stock._stock import Box, Stock
from polycnc.stock._tool import Tool
from polycnc.stock._turned_cutting import TurnedCutting
from polycnc.stock._voxels import Voxels
from polycnc.stock._ways import runs

Floats = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]

MARGIN_MM = 1.0
"""Of an `auto` body around what is cut."""
_COARSE_CELLS = 200
_SAME_MM = 1e-3
_ALONG_DIAMETERS = 1.0
"""How far, in diameters of the tool, feeds along a side say that there is material."""


class NoStockError(UsageError):
    """A program that leaves nothing to say about stock: it cuts nothing."""


@dataclass(frozen=True, eq=False, slots=True)
class _Moves:
    """Hold the moves of a course: where they begin and end [n, 3], their blocks, and the radius of their tools.

    A rapid is one move, however many chords it is made of.

    Raises:
        NoStockError: nothing is cut.
    """

    begin: Floats
    end: Floats
    block: npt.NDArray[np.int64]
    radius: Floats
    fed: Flags
    rapid: Flags

    @classmethod
    def of(cls, course: Rows, tools: Mapping[int, Tool], hint: str) -> _Moves:
        nothing = NoStockError("the program cuts nothing: no stock can be told", hint=hint)
        if len(course.tool) < 2:
            raise nothing
        radius = np.zeros(len(course.tool))
        for number in np.unique(course.tool).tolist():
            if (tool := tools.get(number)) is not None:
                radius[course.tool == number] = tool.radius_mm
        rapid, block = course.rapid[1:], course.block[1:]
        same = rapid[1:] & rapid[:-1] & (block[1:] == block[:-1])
        first, last = np.flatnonzero(np.append(True, ~same)), np.flatnonzero(np.append(~same, True))
        begin, end = course.tip[:-1][first], course.tip[1:][last]
        fed = ~rapid[last] & np.any(begin != end, axis=1)
        if not fed.any():
            raise nothing
        return cls(begin, end, block[last], radius[1:][last], fed, rapid[last])

    @property
    def across(self) -> Flags:
        """Which of them go across."""
        different = np.asarray(self.begin[:, :2] != self.end[:, :2])
        return np.asarray(different.any(axis=1))

    def dips(self, top: float) -> npt.NDArray[np.int64]:
        """Return a number for each move that changes where one begins above the top."""
        return np.cumsum(self.begin[:, 2] >= top)

    def meant_as_cuts(self, top: float) -> Flags:
        """Return which rapids go across as deep as cuts do elsewhere, between a way down and up without any feed."""
        dips = self.dips(top)
        feeds = np.zeros(int(dips[-1]) + 1, np.bool_)
        feeds[dips[self.fed]] = True
        level = np.abs(self.begin[:, 2] - self.end[:, 2]) < _SAME_MM
        found = self.rapid & level & (self.end[:, 2] < top) & ~feeds[dips] & (self.radius > 0.0)
        far = np.linalg.norm(self.end[:, :2] - self.begin[:, :2], axis=1) > 2.0 * self.radius
        levels = np.unique(np.round(self.end[self.fed & self.across, 2], 3))
        found &= far & np.isin(np.round(self.end[:, 2], 3), levels)
        low, high = self.end[self.fed, :2].min(axis=0), self.end[self.fed, :2].max(axis=0)
        # Those far from what is cut go where nothing is.
        size = float((high - low).max())
        for places in (self.begin, self.end):
            found &= np.all((places[:, :2] >= low - size) & (places[:, :2] <= high + size), axis=1)
        return found


@dataclass(slots=True)
class _Sides:
    """Hold the sides of a body while it is found; those at a place of the tool may be drawn in."""

    moves: _Moves
    low: list[float]
    high: list[float]

    def leave_out(self, at: int) -> None:
        """Draw one side in, so that a tool that came to the end of a move at rapid, close to it, is beside the body.

        Where the program feeds down as far out, or along the side, there is material.
        """
        x, y, _ = self.moves.end[at].tolist()
        place, radius = (x, y), float(self.moves.radius[at])
        if any(not self.low[i] - radius < place[i] < self.high[i] + radius for i in range(2)):
            return
        sides = [(place[i] + radius - self.low[i], i, self.low) for i in range(2)]
        sides += [(self.high[i] - place[i] + radius, i, self.high) for i in range(2)]
        drawn, i, side = min(sides, key=lambda each: each[0])
        if drawn > 2.0 * (radius + MARGIN_MM):
            return
        sign = 1.0 if side is self.low else -1.0
        if not self._is_fed(i, sign, place[i], radius):
            side[i] = place[i] + sign * radius

    def _is_fed(self, i: int, sign: float, place: float, radius: float) -> bool:
        """Tell whether the program feeds as far out on a side as a place is: down, or along it."""
        moves = self.moves
        far = sign * place + _SAME_MM
        out = moves.fed & (np.maximum(sign * moves.begin[:, i], sign * moves.end[:, i]) <= far)
        if not out.any():
            return False
        way = np.abs(moves.end[out] - moves.begin[out])
        down = moves.begin[out, 2] - moves.end[out, 2]
        plunges = (down > _SAME_MM) & (way[:, :2].max(axis=1) < _SAME_MM) & (moves.end[out, 2] < self.high[2])
        if plunges.any():
            return True
        return float(way[:, 1 - i].sum()) > _ALONG_DIAMETERS * 2.0 * radius


def around(course: Rows, tools: Mapping[int, Tool]) -> Box:
    """Return the box that holds what is cut, with a margin beside and below it.

    Its top is program zero where the tool cuts below that, else the highest cut across. Where the tool gets down
    into it at rapid, close to a side, the box ends beside it.

    Raises:
        NoStockError: nothing is cut.
    """
    moves = _Moves.of(course, tools, "Give one, like box=0,0,-10,90,60,0.")
    lowest = float(min(moves.begin[moves.fed, 2].min(), moves.end[moves.fed, 2].min()))
    across = moves.fed & moves.across
    top = 0.0 if lowest < 0.0 else float(moves.end[across if across.any() else moves.fed, 2].max())
    top, below = top if top > lowest else lowest + MARGIN_MM, lowest - MARGIN_MM
    meant = moves.meant_as_cuts(top)
    cuts = moves.fed | meant
    places = np.concatenate((moves.begin[cuts, :2], moves.end[cuts, :2]))
    reach = np.tile(moves.radius[cuts], 2)[:, None]
    low_xy, high_xy = (places - reach).min(axis=0) - MARGIN_MM, (places + reach).max(axis=0) + MARGIN_MM
    sides = _Sides(moves, [*low_xy.tolist(), below], [*high_xy.tolist(), top])
    deep = moves.rapid & (moves.end[:, 2] < top)
    if deep.any():
        deep &= np.isin(moves.block, _met_at_rapid(course, tools, sides)) & ~meant
    for at in np.flatnonzero(deep).tolist():
        sides.leave_out(at)
    low, high = sides.low, sides.high
    return Box((low[0], low[1], low[2]), (high[0], high[1], high[2]))


def _met_at_rapid(course: Rows, tools: Mapping[int, Tool], sides: _Sides) -> list[int]:
    """Return the blocks that go through a box at rapid; what they have cut before does not count."""
    low, high = sides.low, sides.high
    box = Box((low[0], low[1], low[2]), (high[0], high[1], high[2]))
    stock = Stock(box, max(high[0] - low[0], high[1] - low[1]) / _COARSE_CELLS)
    cutting = Cutting(stock, tools)
    cutting.add(course)
    return [each.block for each in cutting.contacts if each.kind is ContactKind.RAPID]


def around_any_side(course: Rows, tools: Mapping[int, Tool]) -> Box:
    """Return the box that holds what tools cut from any side, with a margin.

    Raises:
        NoStockError: nothing is cut.
    """
    _Moves.of(course, tools, "Give one, like box=0,0,-10,90,60,0.")  # refuses what cuts nothing
    number = np.flatnonzero(~course.rapid[1:] & np.any(course.tip[1:] != course.tip[:-1], axis=1)) + 1
    radius = np.array(
        [tools[each].radius_mm if each in tools else 0.0 for each in course.tool[number].tolist()]
    )
    axis = np.broadcast_to(course.axis, course.tip.shape)[number]
    reach = radius[:, None] * np.sqrt(np.maximum(1.0 - axis**2, 0.0))
    low = (course.tip[number] - reach).min(axis=0) - MARGIN_MM
    high = (course.tip[number] + reach).max(axis=0) + MARGIN_MM
    upright = bool(np.all(axis[:, 2] > 1.0 - 1e-9))
    top = around(course, tools).high[2] if upright else float(high[2]) - MARGIN_MM
    (x0, y0, z0), (x1, y1, _) = low.tolist(), high.tolist()
    return Box((x0, y0, z0), (x1, y1, top))


def leave_out_rapids(body: Voxels, course: Rows, tools: Mapping[int, Tool]) -> None:
    """Take from a body what tools go through at rapid before they have cut it: an `auto` body has nothing there."""
    trial = body.copy()
    cutting = TurnedCutting(trial, tools)
    wide_mm = max((tool.radius_mm for tool in tools.values()), default=0.0)
    axis = np.broadcast_to(course.axis, course.tip.shape)
    for first, last in runs(course.rapid.astype(np.int64)):
        rows = course.at(slice(first, last))
        if not course.rapid[first]:
            cutting.add(rows)
            continue
        come = slice(max(first - 1, 0), last)
        part = body.reached(course.tip[come], axis[come], wide_mm)
        now, left = trial.cells[part], body.cells[part]
        before = now.copy()
        cutting.add(rows)
        left -= np.minimum(before - now, left)


def around_turned(course: Rows) -> tuple[float, float, float]:
    """Return diameter and ends along Z of the bar that holds what is turned.

    It is as thick as the tool gets at a feed, ends 1 mm behind its last place, and begins where it is faced, at program
    zero if it is not.

    Raises:
        NoStockError: nothing is cut.
    """
    moves = _Moves.of(course, {}, "Give one, like cylinder=30,-60,0.")
    begin, end = moves.begin, moves.end
    places = np.concatenate((begin[moves.fed], end[moves.fed]))
    faces = moves.fed & (np.abs(begin[:, 2] - end[:, 2]) < 1e-6) & (end[:, 0] <= 0.0)
    high = float(end[faces][:, 2].max()) if faces.any() else 0.0
    low = min(float(places[:, 2].min()), high - MARGIN_MM) - MARGIN_MM
    return 2.0 * _bar_radius(moves, high), low, high


def _bar_radius(moves: _Moves, high: float) -> float:
    """Return the radius of the bar: what is fed before its end does not count, nor what rapids come down beside."""
    low_z, beside = np.minimum(moves.begin[:, 2], moves.end[:, 2]), moves.begin[:, 2] != moves.end[:, 2]
    begin, end = np.abs(moves.begin[:, 0]), np.abs(moves.end[:, 0])
    within = moves.fed & (low_z <= high)
    within = within if within.any() else moves.fed
    widest, along = (
        float(np.maximum(begin, end)[each].max(initial=0.0)) for each in (within, within & beside)
    )
    down = moves.rapid & (moves.end[:, 2] < high) & (begin >= widest) & (end >= along)
    return min(widest, float(end[down].min(initial=widest)))
