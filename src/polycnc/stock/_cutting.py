"""Cut a body by a record of where the tool was, and note what each block removed and what went wrong."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import StrEnum
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt

from polycnc.stock._chords import find_chords
from polycnc.stock._stock import Stock
from polycnc.stock._sweep import AT_X, AT_Y, DEPTH_MM, FIGURES, VOLUME_MM3, sweep
from polycnc.stock._tool import Tool

Floats = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]

CHORD_SHARE = 0.02
"""How far a chord may be from where the tool was, as a part of a cell."""
RIM_SHARE = 0.5
"""How much narrower bodies are that must not touch, as a part of a cell: a tool leaves the wall that it has cut."""
LEAST_DEPTH_SHARE = 0.5
"""How deep something must be in the material to count as a collision, as a part of a cell."""


class ContactKind(StrEnum):
    """What went wrong."""

    RAPID = "rapid through stock"
    HOLDER = "holder in stock"
    SPINDLE = "cut with the spindle at rest"
    FLUTES = "cut deeper than the flutes are long"


@dataclass(frozen=True, slots=True)
class Contact:
    """Say what went wrong in a block, the first time: number of the block, time, place and depth (mm)."""

    kind: ContactKind
    block: int
    t_s: float
    place: tuple[float, float, float]
    depth_mm: float


@dataclass(frozen=True, eq=False)
class Rows:
    """Hold a piece of a record, one row a cycle: `tip` is the end of the tool (mm), `turns` that the spindle does."""

    t_s: Floats
    tip: Floats  # [rows, 3]
    block: Integers
    tool: Integers
    rapid: npt.NDArray[np.bool_]
    turns: npt.NDArray[np.bool_]

    def columns(self) -> tuple[npt.NDArray[Any], ...]:
        """Return the columns in their order."""
        return self.t_s, self.tip, self.block, self.tool, self.rapid, self.turns

    def at(self, places: Integers) -> Rows:
        """Return the rows at these places."""
        return Rows(*(column[places] for column in self.columns()))

    def keys(self) -> Integers:
        """Return a number for each row that changes where one chord must not go on."""
        changed = np.zeros(len(self.block), np.bool_)
        for column in (self.block, self.tool, self.rapid, self.turns):
            changed[1:] |= column[1:] != column[:-1]
        changed[2:] |= self.tool[1:-1] != self.tool[:-2]  # where another tool is first is the end of a chord
        return np.cumsum(changed)


def joined(pieces: list[Rows]) -> Rows:
    """Return pieces of a record as one."""
    whole, flags = np.zeros(0, np.int64), np.zeros(0, np.bool_)
    empty = Rows(np.zeros(0), np.zeros((0, 3)), whole, whole, flags, flags)
    columns: Any = zip(*(each.columns() for each in [empty, *pieces]), strict=True)
    return Rows(*(np.concatenate(column) for column in columns))


@dataclass(frozen=True, eq=False, slots=True)
class _Outlines:
    """Hold the outlines of a tool: of what cuts, the same without its rim, of what must not touch, and of nothing."""

    cutter: Floats
    core: Floats
    holder: Floats
    none: Floats

    @classmethod
    def of(cls, tool: Tool, rim_mm: float) -> _Outlines:
        cutting, holder = tool.cutting_profile(), tool.holder_profile()
        core = cutting.within(max(cutting.radius_mm - rim_mm, 0.5 * cutting.radius_mm))
        clear = holder.within(max(holder.radius_mm - rim_mm, 0.5 * holder.radius_mm))
        return cls(cutting.rows, core.rows, clear.rows, holder.rows[:0])


class Cutting:
    """Let tools cut a body: what each block removed (mm3), and what went wrong (`contacts`).

    A tool that is not among `tools` cuts nothing; its number is kept in `unknown_tools`.
    """

    def __init__(self, stock: Stock, tools: Mapping[int, Tool]) -> None:
        self.stock = stock
        self.unknown_tools: set[int] = set()
        rim = RIM_SHARE * stock.cell_mm
        self._outlines = {number: _Outlines.of(tool, rim) for number, tool in tools.items()}
        self._tools = tools
        self._removed = np.zeros(0)
        self._by_tool: dict[int, float] = {}
        self._contacts: dict[tuple[ContactKind, int], Contact] = {}
        self._last: Rows | None = None  # one row

    @property
    def removed_mm3(self) -> float:
        """What has been removed in all."""
        return float(self._removed.sum())

    @property
    def by_block_mm3(self) -> Floats:
        """What each block has removed, by its number."""
        return self._removed

    @property
    def by_tool_mm3(self) -> dict[int, float]:
        """What each tool has removed."""
        return dict(self._by_tool)

    @property
    def contacts(self) -> list[Contact]:
        """What went wrong, in the order of time; one for each kind and block, with its greatest depth."""
        return sorted(self._contacts.values(), key=lambda each: each.t_s)

    def add(self, rows: Rows) -> None:
        """Take the next rows; the tool comes from where the last ones ended."""
        if not len(rows.t_s):
            return
        rows = rows if self._last is None else joined([self._last, rows])
        self._last = rows.at(np.array([len(rows.t_s) - 1]))
        ends = np.zeros(len(rows.t_s), np.int64)
        count = find_chords(rows.tip, rows.keys(), CHORD_SHARE * self.stock.cell_mm, ends)
        nodes = np.concatenate(([0], ends[:count]))
        tool, rapid = rows.tool[nodes], rows.rapid[nodes]
        way = np.where(
            tool[1:] == tool[:-1], 2 * tool[1:] + rapid[1:], -1
        )  # another tool has not come that way
        for first, last in _runs(way):
            if way[first] >= 0:
                self._sweep(rows.tip[nodes[first : last + 1]], nodes[first + 1 : last + 1], rows)

    def _sweep(self, places: Floats, ends: Integers, rows: Rows) -> None:
        """Sweep the ways between places with one tool, all at rapid or none; `ends` are the rows at their ends."""
        number = int(rows.tool[ends[0]])
        outlines = self._outlines.get(number)
        if outlines is None:
            self.unknown_tools.add(number)
            return
        cut, touched, met = (np.zeros((len(ends), FIGURES)) for _ in range(3))
        places = np.ascontiguousarray(places)
        rapid = bool(rows.rapid[ends[0]])
        if rapid:
            sweep(self.stock.grid, places, outlines.none, outlines.core, cut, met)
        sweep(self.stock.grid, places, outlines.cutter, outlines.holder, cut, touched)
        blocks, volume, depth = rows.block[ends], cut[:, VOLUME_MM3], cut[:, DEPTH_MM]
        if len(self._removed) <= blocks.max():
            self._removed = np.concatenate((self._removed, np.zeros(int(blocks.max()) + 1)))
        np.add.at(self._removed, blocks, volume)
        self._by_tool[number] = self._by_tool.get(number, 0.0) + float(volume.sum())
        least = LEAST_DEPTH_SHARE * self.stock.cell_mm
        deep = depth > least
        flutes = self._tools[number].flute_mm
        for kind, wrong, figures in (
            (ContactKind.RAPID, met[:, DEPTH_MM] > least, met),
            (ContactKind.SPINDLE, deep & ~rows.turns[ends] & (not rapid), cut),
            (ContactKind.FLUTES, depth > flutes, cut),
            (ContactKind.HOLDER, touched[:, DEPTH_MM] > least, touched),
        ):
            for way in np.flatnonzero(wrong).tolist():
                self._note(kind, int(ends[way]), figures[way], places[way : way + 2], rows)

    def _note(self, kind: ContactKind, row: int, figures: Floats, way: Floats, rows: Rows) -> None:
        key = kind, int(rows.block[row])
        depth = float(figures[DEPTH_MM])
        known = self._contacts.get(key)
        if known is not None and known.depth_mm >= depth:
            return
        t_s = float(rows.t_s[row]) if known is None else known.t_s
        place = float(figures[AT_X]), float(figures[AT_Y]), float(way[:, 2].min())
        self._contacts[key] = Contact(kind, key[1], t_s, place, depth)


def _runs(values: Integers) -> Iterator[tuple[int, int]]:
    """Yield from where to where values are equal."""
    begins = np.flatnonzero(np.diff(values, prepend=~values[:1]))
    return pairwise([*begins.tolist(), len(values)])
