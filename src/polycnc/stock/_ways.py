"""A record as ways of one tool each."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from polycnc.stock._chords import find_chords
from polycnc.stock._rows import Rows, joined

Floats = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]


@dataclass(frozen=True, eq=False, slots=True)
class Ways:
    """Hold ways of one tool, all at rapid or none: `places` [n + 1, 3] of its tip, and the rows at their ends."""

    places: Floats
    ends: Integers
    begins: Integers
    rows: Rows

    @property
    def axes(self) -> Floats:
        """The axis of the tool at each place [n + 1, 3]."""
        axis = np.broadcast_to(self.rows.axis, self.rows.tip.shape)
        return axis[np.concatenate((self.begins[:1], self.ends))]

    @property
    def number(self) -> int:
        """The number of the tool."""
        return int(self.rows.tool[self.ends[0]])

    @property
    def rapid(self) -> bool:
        """Whether they are at rapid."""
        return bool(self.rows.rapid[self.ends[0]])

    @property
    def block(self) -> Integers:
        """The number of the block of each way."""
        return self.rows.block[self.ends]

    @property
    def duration_s(self) -> Floats:
        """How long each way takes."""
        return self.rows.t_s[self.ends] - self.rows.t_s[self.begins]


class WaysOfRows:
    """Make ways of pieces of a record; the tool comes from where the last piece ended.

    At a feed a way is at most about as long as `longest_mm` says of its tool, so that what it meets is known over time.
    """

    def __init__(self, tolerance_mm: float, longest_mm: Mapping[int, float]) -> None:
        self._tolerance_mm = tolerance_mm
        self._longest_mm = longest_mm
        self._last: Rows | None = None  # one row

    def of(self, rows: Rows) -> Iterator[Ways]:
        """Yield the ways of the next rows."""
        if not len(rows.t_s):
            return
        rows = rows if self._last is None else joined([self._last, rows])
        self._last = rows.at(np.array([len(rows.t_s) - 1]))
        ends = np.zeros(len(rows.t_s), np.int64)
        count = find_chords(rows.guides(), self._keys(rows), self._tolerance_mm, ends)
        nodes = np.concatenate(([0], ends[:count]))
        tool, rapid = rows.tool[nodes], rows.rapid[nodes]
        # Another tool has not come that way.
        way = np.where(tool[1:] == tool[:-1], 2 * tool[1:] + rapid[1:], -1)
        # Each way at rapid meets what the one before has left.
        singly = np.where(way % 2 == 1, 2 * np.arange(len(way)) + 1, -2 - 2 * way)
        for first, last in runs(singly):
            if way[first] >= 0:
                places = np.ascontiguousarray(rows.tip[nodes[first : last + 1]])
                yield Ways(places, nodes[first + 1 : last + 1], nodes[first:last], rows)

    def _keys(self, rows: Rows) -> Integers:
        """Return a number for each row that changes where one way must not go on."""
        step = np.where(rows.rapid[1:], 0.0, np.linalg.norm(np.diff(rows.tip, axis=0), axis=1))
        numbers, of = np.unique(rows.tool, return_inverse=True)
        longest = np.array([self._longest_mm.get(number, np.inf) for number in numbers.tolist()])[of]
        piece = np.floor(np.concatenate(([0.0], np.cumsum(step))) / longest)
        return rows.keys() + np.concatenate(([0], np.cumsum(piece[1:] != piece[:-1])))


def runs(values: Integers) -> Iterator[tuple[int, int]]:
    """Yield from where to where values are equal."""
    begins = np.flatnonzero(np.diff(values, prepend=~values[:1]))
    return pairwise([*begins.tolist(), len(values)])
