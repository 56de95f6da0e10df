"""Cut a body by a record of where the tool was, and note what each block removed and what went wrong."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from polycnc.stock._contacts import Contact, ContactKind, Idle
from polycnc.stock._rows import Rows
from polycnc.stock._stock import Stock
from polycnc.stock._sweep import AT_X, AT_Y, DEPTH_MM, FIGURES, VOLUME_MM3, sweep
from polycnc.stock._tally import NEAR_CELLS, Tally
from polycnc.stock._target import Target
from polycnc.stock._tool import Tool, ToolKind
from polycnc.stock._ways import Ways, WaysOfRows

Floats = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]

CHORD_SHARE = 0.02
"""How far a chord may be from where the tool was, as a part of a cell."""
RIM_SHARE = 0.5
"""How much narrower bodies are that must not touch, as a part of a cell: a tool leaves the wall that it has cut."""
LEAST_DEPTH_SHARE = 0.5
"""How deep something must be in the material to count as a collision, as a part of a cell."""


@dataclass(frozen=True, eq=False, slots=True)
class _Outlines:
    """Hold the outlines of a tool: of what cuts, the same without its rim, of what must not touch, and of nothing.

    `above_flutes` meets the walls of what the tool has cut, above its flutes.
    """

    cutter: Floats
    core: Floats
    shank: Floats
    holder: Floats
    above_flutes: Floats
    none: Floats

    @classmethod
    def of(cls, tool: Tool, rim_mm: float) -> _Outlines:
        cutting, shank, holder = (
            outline.within(max(outline.radius_mm - rim_mm, 0.5 * outline.radius_mm)).rows
            for outline in (tool.core_profile(), tool.shank_profile(), tool.holder_profile())
        )
        rubs = tool.above_flutes_profile(rim_mm / RIM_SHARE).rows
        return cls(tool.cutting_profile().rows, cutting, shank, holder, rubs, cutting[:0])


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
        rim = RIM_SHARE * stock.cell_mm
        self._outlines = {number: _Outlines.of(tool, rim) for number, tool in tools.items()}
        self._tools = tools
        self._fixtures = fixtures
        self._target = target
        self.tally = Tally()
        self._ways = WaysOfRows(
            CHORD_SHARE * stock.cell_mm, {number: tool.radius_mm for number, tool in tools.items()}
        )

    @property
    def removed_mm3(self) -> float:
        """What has been removed in all."""
        return float(self.by_block_mm3.sum())

    @property
    def by_block_mm3(self) -> Floats:
        """What each block has removed, by its number."""
        return self.tally.by_block_mm3

    @property
    def by_tool_mm3(self) -> dict[int, float]:
        """What each tool has removed."""
        return dict(self.tally.by_tool_mm3)

    @property
    def unknown_tools(self) -> set[int]:
        """The tools that cut nothing, because their shape is not known."""
        return self.tally.unknown_tools

    @property
    def contacts(self) -> list[Contact]:
        """What went wrong, in the order of time; one for each kind and block, with its greatest depth."""
        return self.tally.contacts.all()

    @property
    def idle(self) -> list[Idle]:
        """The blocks that fed through air for long."""
        return self.tally.idle

    @property
    def idle_s(self) -> float:
        """How long tools fed without removing anything."""
        return self.tally.idle_s

    def add(self, rows: Rows) -> None:
        """Take the next rows; the tool comes from where the last ones ended."""
        for ways in self._ways.of(rows):
            self._sweep(ways)

    def _sweep(self, ways: Ways) -> None:
        outlines = self._outlines.get(ways.number)
        if outlines is None:
            self.tally.miss(ways)
            return
        none, grid, least = outlines.none, self.stock.grid, LEAST_DEPTH_SHARE * self.stock.cell_mm
        for fixture in self._fixtures:
            for kind, outline in (
                (ContactKind.FIXTURE, outlines.core),
                (ContactKind.FIXTURE_SHANK, outlines.shank),
                (ContactKind.FIXTURE_HOLDER, outlines.holder),
            ):
                if len(outline):
                    met = self._figures(ways)
                    sweep(fixture.grid, ways.places, none, outline, met, met)
                    self._note(kind, ways, met, least)
        if self._target is not None:
            met = self._figures(ways)
            self._target.gouges(ways.places, outlines.cutter, met)
            self._note(ContactKind.GOUGE, ways, met, 0.0)
        if ways.rapid:
            met = self._figures(ways)
            sweep(grid, ways.places, none, outlines.core, met, met)
            self._note(ContactKind.RAPID, ways, met, least)
        cut, touched, shank = self._figures(ways), self._figures(ways), self._figures(ways)
        tool = self._tools[ways.number]
        edge_is_free = ways.rapid and tool.kind is ToolKind.BORING
        cutter = outlines.core if edge_is_free else outlines.cutter
        sweep(grid, ways.places, cutter, outlines.holder, cut, touched)
        sweep(grid, ways.places, none, outlines.shank, shank, shank)
        self._note(ContactKind.HOLDER, ways, touched, least)
        self._note(ContactKind.SHANK, ways, shank, least)
        self.tally.count(ways, cut, tool)
        self._note(ContactKind.FLUTES, ways, cut, tool.flute_mm)
        if len(outlines.above_flutes):
            self._note_walls(ways, cut, outlines, tool.flute_mm)
        if not ways.rapid:
            turns = np.sign(ways.rows.turns[ways.ends].astype(np.float64))
            self._note(ContactKind.SPINDLE, ways, cut, least, turns == 0)
            self._note(ContactKind.DIRECTION, ways, cut, least, turns == (1 if tool.left_hand else -1))
            self.tally.count_idle(ways, cut, lambda first, last: self._is_near(ways, outlines, first, last))

    def _note_walls(self, ways: Ways, cut: Floats, outlines: _Outlines, flute_mm: float) -> None:
        """Note where a tool cuts beside walls that rise above its flutes, level by level or peck by peck."""
        walls = self._figures(ways)
        sweep(self.stock.grid, ways.places, outlines.none, outlines.above_flutes, walls, walls)
        walls[walls[:, DEPTH_MM] > LEAST_DEPTH_SHARE * self.stock.cell_mm, DEPTH_MM] += flute_mm
        self._note(ContactKind.FLUTES, ways, walls, flute_mm, cut[:, VOLUME_MM3] > 0.0)

    @staticmethod
    def _figures(ways: Ways) -> Floats:
        return np.zeros((len(ways.ends), FIGURES))

    def _note(
        self,
        kind: ContactKind,
        ways: Ways,
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
            self.tally.contacts.note(
                Contact(kind, int(ways.rows.block[row]), float(ways.rows.t_s[row]), place, depth)
            )

    def _is_near(self, ways: Ways, outlines: _Outlines, first: int, last: int) -> bool:
        """Tell whether a tool would cut if it were a little lower."""
        lower = ways.places[first : last + 1] - (0.0, 0.0, NEAR_CELLS * self.stock.cell_mm)
        met = np.zeros((last - first, FIGURES))
        sweep(self.stock.grid, np.ascontiguousarray(lower), outlines.none, outlines.core, met, met)
        return bool(met[:, DEPTH_MM].any())
