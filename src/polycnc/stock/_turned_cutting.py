"""Cut a body with tools whose axis turns against it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np
import numpy.typing as npt

from polycnc.stock._contacts import Contact, ContactKind
from polycnc.stock._cutting import CHORD_SHARE
from polycnc.stock._profile import COLUMNS
from polycnc.stock._rows import Rows
from polycnc.stock._solid_target import SolidTarget
from polycnc.stock._sweep import AT_X, AT_Y, DEPTH_MM
from polycnc.stock._tally import NEAR_CELLS, Tally
from polycnc.stock._tool import Tool
from polycnc.stock._voxel_sweep import AT_Z, VOXEL_FIGURES, sweep_voxels
from polycnc.stock._voxels import Voxels
from polycnc.stock._ways import Ways, WaysOfRows

Floats = npt.NDArray[np.float64]

_NOTHING = np.zeros((0, COLUMNS))
_RIM_CELLS = 1.0
"""How much narrower, and higher, a tool is that must not touch what it has cut: points are in it by chance."""


class TurnedCutting:
    """Let tools cut a body of cells (see `tally`), each with the axis that its rows have.

    Depths are how far up the tool the material is. A tool that is not among `tools` cuts nothing. `fixtures` turn with
    the body, and no part of a tool may touch them; what cuts into `target` is a contact too.
    """

    def __init__(
        self,
        stock: Voxels,
        tools: Mapping[int, Tool],
        fixtures: Sequence[Voxels] = (),
        target: SolidTarget | None = None,
    ) -> None:
        self.stock = stock
        self.tally = Tally()
        self._tools = tools
        self._ways = WaysOfRows(
            CHORD_SHARE * stock.cell_mm, {number: tool.radius_mm for number, tool in tools.items()}
        )
        self._fixtures, self._target = fixtures, target
        self._reach_mm = _diagonal_mm(stock)

    def add(self, rows: Rows) -> None:
        """Take the next rows; the tool comes from where the last ones ended."""
        for ways in self._ways.of(rows):
            tool = self._tools.get(ways.number)
            if tool is None:
                self.tally.miss(ways)
            else:
                self._sweep(ways, tool)

    def _sweep(self, ways: Ways, tool: Tool) -> None:
        outline = tool.cutting_profile()
        rim = _RIM_CELLS * self.stock.cell_mm
        core = outline.within(max(outline.radius_mm - rim, 0.5 * outline.radius_mm)).rows
        height, tops = self._height_mm(tool, self.stock), tool.upper_profile().rows
        for fixture in self._fixtures:
            top = self._height_mm(tool, fixture) - rim
            met = self._figures(ways, core, rim, top, cuts=False, tops=tops, body=fixture)
            self._note(ContactKind.FIXTURE, ways, met, rim)
            for kind, _, clear in self._held(tool):
                met = self._figures(ways, clear, 0.0, _diagonal_mm(fixture), cuts=False, body=fixture)
                self._note(kind, ways, met, 0.0)
        if self._target is not None:
            met = np.zeros((len(ways.ends), VOXEL_FIGURES))
            places, axes = (np.ascontiguousarray(each) for each in (ways.places[:, :3], ways.axes))
            self._target.gouges(places, axes, outline.rows, min(height, self._reach_mm), met)
            self._note(ContactKind.GOUGE, ways, met, 0.0)
        if ways.rapid:
            met = self._figures(ways, core, rim, height - rim, cuts=False, tops=tops)
            self._note(ContactKind.RAPID, ways, met, rim)
        cut = self._figures(ways, outline.rows, 0.0, height, cuts=True, tops=tops)
        self.tally.count(ways, cut, tool)
        self._note(ContactKind.FLUTES, ways, cut, tool.flute_mm)
        for _, kind, clear in self._held(tool):
            self._note(kind, ways, self._figures(ways, clear, 0.0, self._reach_mm, cuts=False), 0.0)
        if not ways.rapid:
            turns = ways.rows.turns[ways.ends]
            for kind, wrong in (
                (ContactKind.SPINDLE, turns == 0.0),
                (ContactKind.DIRECTION, turns < 0.0 if not tool.left_hand else turns > 0.0),
            ):
                self._note(kind, ways, np.where(wrong[:, None], cut, 0.0), 0.0)
            self.tally.count_idle(
                ways, cut, lambda first, last: self._is_near(ways, outline.rows, tops, height, first, last)
            )

    def _held(self, tool: Tool) -> Iterator[tuple[ContactKind, ContactKind, Floats]]:
        """Yield what is wrong where shank and holder touch a fixture, and the body, and their outlines without rims."""
        rim = _RIM_CELLS * self.stock.cell_mm
        for in_fixture, in_stock, steps in (
            (ContactKind.FIXTURE_SHANK, ContactKind.SHANK, tool.neck_profile()),
            (ContactKind.FIXTURE_HOLDER, ContactKind.HOLDER, tool.holder_profile()),
        ):
            if len(steps.rows):
                yield (
                    in_fixture,
                    in_stock,
                    steps.within(max(steps.radius_mm - rim, 0.5 * steps.radius_mm)).rows,
                )

    @staticmethod
    def _height_mm(tool: Tool, body: Voxels) -> float:
        """Return how high a tool is up to its shank or holder, as far as it can be in a body."""
        steps = [height for height, _ in (*tool.shank, *tool.holder)]
        top = [tool.outline[-1][1]] if tool.undercuts else []
        return min(*steps, *top, _diagonal_mm(body), math.inf)

    def _is_near(
        self, ways: Ways, outline: Floats, tops: Floats, height_mm: float, first: int, last: int
    ) -> bool:
        """Tell whether a tool would cut if it were a little lower along its axis."""
        axes = ways.axes[first : last + 1]
        lower = ways.places[first : last + 1, :3] - NEAR_CELLS * self.stock.cell_mm * axes
        met = self._swept(lower, axes, outline, 0.0, height_mm, cuts=False, tops=tops)
        return bool(met[:, DEPTH_MM].any())

    def _figures(
        self,
        ways: Ways,
        outline: Floats,
        from_mm: float,
        height_mm: float,
        *,
        cuts: bool,
        tops: Floats = _NOTHING,
        body: Voxels | None = None,
    ) -> Floats:
        places = ways.places[:, :3]
        return self._swept(places, ways.axes, outline, from_mm, height_mm, cuts=cuts, tops=tops, body=body)

    def _swept(
        self,
        places: Floats,
        axes: Floats,
        outline: Floats,
        from_mm: float,
        height_mm: float,
        *,
        cuts: bool,
        tops: Floats,
        body: Voxels | None = None,
    ) -> Floats:
        found, stock = np.zeros((len(places) - 1, VOXEL_FIGURES)), body or self.stock
        sweep_voxels(
            stock.cells,
            stock.first,
            stock.cell_mm,
            np.ascontiguousarray(places),
            np.ascontiguousarray(axes),
            outline,
            tops,
            from_mm,
            height_mm,
            cuts,
            found,
        )
        return found

    def _note(self, kind: ContactKind, ways: Ways, figures: Floats, least_mm: float) -> None:
        for way in np.flatnonzero(figures[:, DEPTH_MM] > least_mm).tolist():
            row, found = int(ways.ends[way]), figures[way]
            place = float(found[AT_X]), float(found[AT_Y]), float(found[AT_Z])
            t_s, block = float(ways.rows.t_s[row]), int(ways.rows.block[row])
            self.tally.contacts.note(Contact(kind, block, t_s, place, float(found[DEPTH_MM])))


def _diagonal_mm(body: Voxels) -> float:
    return float(np.linalg.norm(np.subtract(body.box.high, body.box.low)))
