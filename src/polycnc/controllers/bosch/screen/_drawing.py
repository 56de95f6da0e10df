"""Lines, circles and fillings on the graphics window (Manual 003, 8.2 to 8.6)."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from polycnc.controllers.bosch.screen._surface import HEIGHT, SOFTKEY_ROWS, WIDTH, Surface
from polycnc.nc.cpl import OMITTED, Fault

_TOP = HEIGHT - SOFTKEY_ROWS - 1
_PATTERNS = {0: "#", 3: "########..#..", 4: "######...."}
_ERASE, _TOGGLE = 1, 2
_LINE_TYPES = 5
_LARGEST = 100_000
Places: TypeAlias = npt.NDArray[np.int64]


class Drawing:
    """Draw with the colour, line type and coordinates that are in force."""

    def __init__(self, surface: Surface) -> None:
        self._surface = surface
        self.colour = 1
        self.line_type = 0
        self.window = (0, WIDTH - 1, 0, _TOP)
        self._edges = self.window
        self._at = (0.0, 0.0)
        self._circle: list[float | None] = [None] * 6
        self._radius: float | None = None
        self.functions: Mapping[str, Callable[..., object]] = {
            "GMD": self._gmd, "GWD": self._gwd, "MWD": self._mwd, "LIN": self._lin, "CIR": self._cir, "FIL": self._fil,
            "CLR": self._clr,
        }  # fmt: skip

    def _gmd(self, line_type: object) -> int:
        if type(line_type) is not int or not 0 <= line_type < _LINE_TYPES:
            raise Fault("INVALID PARAMETER", "line types are 0 to 4")
        self.line_type = line_type
        return 0

    def _gwd(self, *edges: object) -> int:
        left, right, bottom, top = (round(number(edge)) for edge in edges)
        if not (0 <= left < right < WIDTH and 0 <= bottom < top <= _TOP):
            raise Fault("INVALID PARAMETER", f"a window lies within 0 to {WIDTH - 1} and 0 to {_TOP}")
        self.window = self._edges = (left, right, bottom, top)
        return 0

    def _mwd(self, *edges: object) -> int:
        left, right, bottom, top = (round(number(edge)) for edge in edges)
        if left >= right or bottom >= top:
            raise Fault("INVALID PARAMETER", "the left edge is below the right one, the bottom below the top")
        self._edges = (left, right, bottom, top)
        return 0

    def _lin(self, *places: object) -> int:
        if len(places) == 3:
            raise Fault("INVALID PARAMETER", "a line has two or four coordinates")
        start = self._at
        if len(places) == 4:
            start = _or(places[0], start[0]), _or(places[1], start[1])
        end = _or(places[-2], self._at[0]), _or(places[-1], self._at[1])
        self._at = end
        self._line([self._pixel(*start), self._pixel(*end)])
        return 0

    def _cir(self, *places: object) -> int:
        if len(places) not in (3, 6):
            raise Fault("INVALID PARAMETER", "a circle has centre and radius, an arc start, end and centre")
        if len(places) == 3:
            x, y, radius = (
                _or(each, old) for each, old in zip(places, (*self._circle[4:], self._radius), strict=True)
            )
            start = end = (x + radius, y)
        else:
            kept = [None if each is OMITTED else number(each) for each in places]
            if kept[2:4] == [None, None] and kept[:2] != [None, None]:
                kept[2:4] = kept[:2]  # the end is left out, the start is not: all around
            values = [
                _or(OMITTED if new is None else new, old) for new, old in zip(kept, self._circle, strict=True)
            ]
            start, end, (x, y) = (values[0], values[1]), (values[2], values[3]), (values[4], values[5])
            radius = math.dist(start, (x, y))
        if radius <= 0:
            raise Fault("INVALID PARAMETER", "a circle needs a radius above 0")
        self._circle, self._radius = [*start, *end, x, y], radius
        if len(places) == 6:
            self._at = end
        begin = math.atan2(start[1] - y, start[0] - x)
        sweep = (begin - math.atan2(end[1] - y, end[0] - x)) % math.tau or math.tau
        steps = min(max(16, math.ceil(sweep * min(radius, _LARGEST))), 20_000)
        angles = [begin - sweep * step / steps for step in range(steps + 1)]
        self._line([self._pixel(x + radius * math.cos(a), y + radius * math.sin(a)) for a in angles])
        return 0

    def _fil(self, x: object, y: object, pattern: object, colour: object, contour: object = OMITTED) -> int:
        code = colour_code(colour)
        edge = code if contour is OMITTED else colour_code(contour)
        if type(pattern) is not int or not 0 <= pattern <= 5:
            raise Fault("INVALID PARAMETER", "fill patterns are 0 to 5")
        left, right, bottom, top = self.window
        begin = self._pixel(number(x), number(y))
        pixels = self._surface.pixels[bottom + SOFTKEY_ROWS : top + SOFTKEY_ROWS + 1, left : right + 1]
        reached = _reached((pixels != edge) & (pixels != code), begin[1] - bottom, begin[0] - left)
        pixels[reached] = code
        return 0

    def _clr(self) -> int:
        left, right, bottom, top = self.window
        self._surface.clear_window(left, right, bottom + SOFTKEY_ROWS, top + SOFTKEY_ROWS)
        return 0

    def _pixel(self, x: float, y: float) -> tuple[int, int]:
        left, right, bottom, top = self.window
        edge_left, edge_right, edge_bottom, edge_top = self._edges
        return (
            _clamped(left + (x - edge_left) * (right - left) / (edge_right - edge_left)),
            _clamped(bottom + (y - edge_bottom) * (top - bottom) / (edge_top - edge_bottom)),
        )

    def _line(self, corners: list[tuple[int, int]]) -> None:
        left, right, bottom, top = self.window
        pattern = np.array([each == "#" for each in _PATTERNS.get(self.line_type, "#")])
        x, y = _pixels(corners)
        seen = np.resize(pattern, len(x)) & (left <= x) & (x <= right) & (bottom <= y) & (y <= top)
        pixels = self._surface.pixels.reshape(-1)
        places = (y[seen] + SOFTKEY_ROWS) * WIDTH + x[seen]
        if self.line_type != _TOGGLE:
            pixels[places] = -1 if self.line_type == _ERASE else self.colour
            return
        places, times = np.unique(places, return_counts=True)  # where it crosses itself it toggles again
        drawn = (pixels[places] >= 0) ^ (times % 2 == 1)
        pixels[places] = np.where(drawn, self.colour, -1)


def _pixels(corners: list[tuple[int, int]]) -> tuple[Places, Places]:
    """Return the pixels along a line through corners, each once."""
    at = np.array(corners, np.int64)
    ways = np.diff(at, axis=0)
    steps = np.maximum(np.abs(ways).max(axis=1), 1)
    step = np.arange(int((steps + 1).sum())) - np.repeat(np.cumsum(steps + 1) - steps - 1, steps + 1)
    ways, begins, steps = (np.repeat(each, steps + 1, axis=0) for each in (ways, at[:-1], steps))
    found = begins + np.rint(ways * step[:, None] / steps[:, None]).astype(np.int64)
    new = np.ones(len(found), bool)
    new[1:] = (found[1:] != found[:-1]).any(axis=1)
    return found[new, 0], found[new, 1]


def _reached(free: npt.NDArray[np.bool_], row: int, column: int) -> npt.NDArray[np.bool_]:
    """Return the free pixels that are joined to one by their edges, row by row in runs."""
    reached = np.zeros_like(free)
    todo = [(row, column)]
    while todo:
        row, column = todo.pop()
        inside = 0 <= row < free.shape[0] and 0 <= column < free.shape[1]
        if not inside or not free[row, column] or reached[row, column]:
            continue
        walls = np.flatnonzero(~free[row])
        place = int(np.searchsorted(walls, column))
        left = int(walls[place - 1]) + 1 if place else 0
        right = int(walls[place]) if place < len(walls) else free.shape[1]
        reached[row, left:right] = True
        for beside in (row - 1, row + 1):
            if 0 <= beside < free.shape[0]:
                here = free[beside, left:right] & ~reached[beside, left:right]
                todo += (
                    (beside, left + int(each)) for each in np.flatnonzero(np.diff(here, prepend=False) & here)
                )
    return reached


def number(value: object) -> float:
    """Return a coordinate.

    Raises:
        Fault: It has no value.
    """
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise Fault("INVALID PARAMETER", "a number is needed")
    return float(value)


def colour_code(value: object) -> int:
    """Return the code of a colour.

    Raises:
        Fault: It is none.
    """
    if type(value) is not int or not 0 <= value <= 7:
        raise Fault("INVALID PARAMETER", "codes of colours are 0 to 7")
    return value


def _or(value: object, before: float | None) -> float:
    if value is not OMITTED:
        return number(value)
    if before is None:
        raise Fault("INVALID PARAMETER", "there is no value before that could stand for the one left out")
    return before


def _clamped(value: float) -> int:
    return math.floor(min(max(value, -_LARGEST), _LARGEST) + 0.5)
