"""Cut a body by a record of where the tool was, and note what each block removed and what went wrong."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from polycnc.stock._chords import find_chords
from polycnc.stock._contacts import Contact, ContactKind, Contacts, Idle
from polycnc.stock._rows import Rows, joined
from polycnc.stock._stock import Stock
from polycnc.stock._sweep import AT_X, AT_Y, DEPTH_MM, FIGURES, VOLUME_MM3, sweep
from polycnc.stock._target import Target
from polycnc.stock._tool import Tool

Floats = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]

CHORD_SHARE = 0.02
"""How far a chord may be from where the tool was, as a part of a cell."""
RIM_SHARE = 0.5
"""How much narrower bodies are that must not touch, as a part of a cell: a tool leaves the wall that it has cut."""
LEAST_DEPTH_SHARE = 0.5
"""How deep something must be in the material to count as a collision, as a part of a cell."""
IDLE_S = 3.0
"""How long a block feeds through air before that is remarked."""


@dataclass(frozen=True, eq=False, slots=True)
class _Outlines:
    """Hold the outlines of a tool: of what cuts, the same without its rim, of what must not touch, and of nothing."""

    cutter: Floats
    core: Floats
    shank: Floats
    holder: Floats
    none: Floats

    @classmethod
    def of(cls, tool: Tool, rim_mm: float) -> _Outlines:
        cutting, shank, holder = (
            outline.within(max(outline.radius_mm - rim_mm, 0.5 * outline.radius_mm)).rows
            for outline in (tool.cutting_profile(), tool.shank_profile(), tool.holder_profile())
        )
        return cls(tool.cutting_profile().rows, cutting, shank, holder, cutting[:0])


@dataclass(frozen=True, eq=False, slots=True)
class _Ways:
    """Hold ways of one tool, all at rapid or none: `places` [n + 1, 3] of its tip, and the rows at their ends."""

    places: Floats
    ends: Integers
    begins: Integers
    rows: Rows

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


class Cutting:
    """Let tools cut a body: what each block removed (mm3), and what went wrong (`contacts`).

    A tool that is not among `tools` cuts nothing; its number is kept in `unknown_tools`. `fixtures` must not be touched
    by any part of a tool; what they cut into `target` is a contact too.
    """

    def __init__(
        self,
        stock: Stock,
        tools: Mapping[int, Tool],
        fixtures: Sequence[Stock] = (),
        target: Target | None = None,
    ) -> None:
        self.stock = stock
        self.unknown_tools: set[int] = set()
        self.idle_s = 0.0
        """How long tools fed without removing anything."""
        self.idle: list[Idle] = []
        """The blocks that fed through air for long."""
        rim = RIM_SHARE * stock.cell_mm
        self._outlines = {number: _Outlines.of(tool, rim) for number, tool in tools.items()}
        self._tools = tools
        self._fixtures = fixtures
        self._target = target
        self._removed = np.zeros(0)
        self._by_tool: dict[int, float] = {}
        self._contacts = Contacts()
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
        return self._contacts.all()

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
                places = np.ascontiguousarray(rows.tip[nodes[first : last + 1]])
                self._sweep(_Ways(places, nodes[first + 1 : last + 1], nodes[first:last], rows))

    def _sweep(self, ways: _Ways) -> None:
        outlines = self._outlines.get(ways.number)
        if outlines is None:
            self.unknown_tools.add(ways.number)
            return
        none, grid, least = outlines.none, self.stock.grid, LEAST_DEPTH_SHARE * self.stock.cell_mm
        for fixture in self._fixtures:
            met, touched = self._figures(ways), self._figures(ways)
            sweep(fixture.grid, ways.places, none, outlines.core, met, met)
            above = outlines.holder if len(outlines.holder) else outlines.shank
            sweep(fixture.grid, ways.places, none, above, touched, touched)
            self._note(ContactKind.FIXTURE, ways, met, least)
            self._note(ContactKind.FIXTURE_HOLDER, ways, touched, least)
        if self._target is not None:
            met = self._figures(ways)
            self._target.gouges(ways.places, outlines.cutter, met)
            self._note(ContactKind.GOUGE, ways, met, 0.0)
        if ways.rapid:
            met = self._figures(ways)
            sweep(grid, ways.places, none, outlines.core, met, met)
            self._note(ContactKind.RAPID, ways, met, least)
        cut, touched, shank = self._figures(ways), self._figures(ways), self._figures(ways)
        sweep(grid, ways.places, outlines.cutter, outlines.holder, cut, touched)
        sweep(grid, ways.places, none, outlines.shank, shank, shank)
        self._note(ContactKind.HOLDER, ways, touched, least)
        self._note(ContactKind.SHANK, ways, shank, least)
        self._count(ways, cut)
        tool = self._tools[ways.number]
        self._note(ContactKind.FLUTES, ways, cut, tool.flute_mm)
        if not ways.rapid:
            turns = ways.rows.turns[ways.ends].astype(np.int8)
            self._note(ContactKind.SPINDLE, ways, cut, least, turns == 0)
            self._note(ContactKind.DIRECTION, ways, cut, least, turns == (1 if tool.left_hand else -1))
            self._note_idle(ways, cut, outlines)

    @staticmethod
    def _figures(ways: _Ways) -> Floats:
        return np.zeros((len(ways.ends), FIGURES))

    def _count(self, ways: _Ways, cut: Floats) -> None:
        """Count what ways have removed."""
        blocks, volume = ways.block, cut[:, VOLUME_MM3]
        if len(self._removed) <= blocks.max():
            self._removed = np.concatenate((self._removed, np.zeros(int(blocks.max()) + 1)))
        np.add.at(self._removed, blocks, volume)
        self._by_tool[ways.number] = self._by_tool.get(ways.number, 0.0) + float(volume.sum())

    def _note(
        self,
        kind: ContactKind,
        ways: _Ways,
        figures: Floats,
        least_mm: float,
        only: npt.NDArray[np.bool_] | None = None,
    ) -> None:
        """Note where something was deeper than it may be, of ways that count alone if `only` says which."""
        wrong = figures[:, DEPTH_MM] > least_mm
        for way in np.flatnonzero(wrong if only is None else wrong & only).tolist():
            row, found = int(ways.ends[way]), figures[way]
            place = float(found[AT_X]), float(found[AT_Y]), float(ways.places[way : way + 2, 2].min())
            depth = float(found[DEPTH_MM])
            self._contacts.note(
                Contact(kind, int(ways.rows.block[row]), float(ways.rows.t_s[row]), place, depth)
            )

    def _note_idle(self, ways: _Ways, cut: Floats, outlines: _Outlines) -> None:
        """Count the time of feeding that removes nothing, and note blocks that feed through air for long.

        A tool that goes along what it has cut is not in the air: it would cut if it were two cells lower.
        """
        moves = np.any(ways.places[1:] != ways.places[:-1], axis=1)
        duration = np.where(moves & (cut[:, VOLUME_MM3] <= 0.0), ways.duration_s, 0.0)
        self.idle_s += float(duration.sum())
        block = ways.block
        for first, last in _runs(block):
            if cut[first:last, VOLUME_MM3].any() or duration[first:last].sum() < IDLE_S:
                continue
            lower = ways.places[first : last + 1] - (0.0, 0.0, 2.0 * self.stock.cell_mm)
            touched = np.zeros((last - first, FIGURES))
            sweep(
                self.stock.grid, np.ascontiguousarray(lower), outlines.none, outlines.core, touched, touched
            )
            if not touched[:, DEPTH_MM].any():
                x, y, z = ways.places[last].tolist()
                t_s = float(ways.rows.t_s[ways.begins[first]])
                self.idle.append(Idle(int(block[first]), t_s, float(duration[first:last].sum()), (x, y, z)))


def _runs(values: Integers) -> Iterator[tuple[int, int]]:
    """Yield from where to where values are equal."""
    begins = np.flatnonzero(np.diff(values, prepend=~values[:1]))
    return pairwise([*begins.tolist(), len(values)])
