"""Turn a body by a record of where the tool was, and note what each block removed and what went wrong."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from polycnc.stock._contacts import Contact, ContactKind
from polycnc.stock._cutting import CHORD_SHARE, LEAST_DEPTH_SHARE
from polycnc.stock._insert import Insert, InsertKind
from polycnc.stock._insert_sweep import sweep_insert
from polycnc.stock._rows import Rows
from polycnc.stock._sweep import AT_X, AT_Y, DEPTH_MM, FIGURES, VOLUME_MM3
from polycnc.stock._tally import NEAR_CELLS, Tally
from polycnc.stock._tool import Tool
from polycnc.stock._turned import Turned
from polycnc.stock._turned_solid import TurnedTarget
from polycnc.stock._ways import Ways, WaysOfRows, runs

Floats = npt.NDArray[np.float64]

_ON_AXIS_MM = 0.01
_DRILL_STEPS = 400
_LONGEST_MM = 2.0  # of a way


class TurningCutting:
    """Let turning tools cut a body (see `tally`): X of the record is the distance from the axis, Y is 0.

    What rotates besides is a tool for the middle: a drill. A threading tool leaves one groove for each turn of the
    spindle. A tool that is not among `tools` cuts nothing. No tool may touch `fixtures`, which turn with the part; what
    cuts into `target` is a contact too, but for threads.
    """

    def __init__(
        self,
        stock: Turned,
        tools: Mapping[int, Tool | Insert],
        fixtures: Sequence[Turned] = (),
        target: TurnedTarget | None = None,
    ) -> None:
        self.stock = stock
        self._fixtures, self._target = fixtures, target
        self.tally = Tally()
        self._tools = tools
        self._first_turns: dict[int, float] = {}  # which way the spindle turned in the first cut of an insert
        self._in_thread: Floats | None = None  # where a threading tool has ended, of its middle
        self._ways = WaysOfRows(CHORD_SHARE * stock.cell_mm, dict.fromkeys(tools, _LONGEST_MM))

    def add(self, rows: Rows) -> None:
        """Take the next rows; the tool comes from where the last ones ended."""
        for ways in self._ways.of(rows):
            tool = self._tools.get(ways.number)
            if tool is None:
                self.tally.miss(ways)
            elif isinstance(tool, Tool):
                self._drill(ways, tool)
            else:
                self._turn(ways, tool)

    def _turn(self, ways: Ways, insert: Insert) -> None:
        least = LEAST_DEPTH_SHARE * self.stock.cell_mm
        outline, middle = insert.outline(), insert.middle()
        places = ways.places[:, [0, 2]] + middle
        if insert.inside:
            places[:, 0] *= -1.0
        figures = np.zeros((len(ways.ends), FIGURES))
        self._note_around(ways, insert, outline, places)
        threads, out_of_thread = insert.kind is InsertKind.THREADING, self._leaves_thread(ways, places)
        if ways.rapid and not out_of_thread:
            met = figures.copy()
            self._sweep(insert, outline, places[:-1], places[1:], met, narrower_mm=0.5 * self.stock.cell_mm)
            self._note(ContactKind.RAPID, ways, met, least)
        if threads and not ways.rapid:
            self._thread(ways, insert, outline, places, figures)
        elif not out_of_thread:
            self._sweep(insert, outline, places[:-1], places[1:], figures, cuts=True)
        self._in_thread = places[-1] if threads and not ways.rapid else None
        self.tally.count(ways, figures, insert)
        self._note(ContactKind.HOLDER, ways, self._held(insert, places), least)
        if not ways.rapid:
            turns = ways.rows.turns[ways.ends]
            self._note(ContactKind.SPINDLE, ways, figures, least, turns == 0.0)
            wrong = turns > 0.0 if insert.left_hand else self._turns_otherwise(ways, figures, least)
            self._note(ContactKind.DIRECTION, ways, figures, least, wrong)
            self.tally.count_idle(
                ways, figures, lambda first, last: self._is_near(insert, outline, places[first : last + 1])
            )

    def _note_around(self, ways: Ways, insert: Insert, outline: Floats, places: Floats) -> None:
        """Note where an insert, or what holds it, meets fixtures, and where the insert cuts into the target."""
        least = LEAST_DEPTH_SHARE * self.stock.cell_mm
        for fixture in self._fixtures:
            met = np.zeros((len(ways.ends), FIGURES))
            self._sweep(insert, outline, places[:-1], places[1:], met, body=fixture)
            self._note(ContactKind.FIXTURE, ways, met, least)
            self._note(ContactKind.FIXTURE_HOLDER, ways, self._held(insert, places, fixture), least)
        if self._target is not None and insert.kind is not InsertKind.THREADING:
            met = np.zeros((len(ways.ends), FIGURES))
            self._sweep(insert, outline, places[:-1], places[1:], met, body=self._target.limit)
            met[:, DEPTH_MM] += np.where(met[:, DEPTH_MM] > 0.0, self._target.tolerance_mm, 0.0)
            self._note(ContactKind.GOUGE, ways, met, 0.0)

    def _leaves_thread(self, ways: Ways, places: Floats) -> bool:
        """Tell whether a tool is only lifted out of the groove that it has cut up to where it is."""
        if not ways.rapid or self._in_thread is None:
            return False
        from_there = bool(np.allclose(places[0], self._in_thread, rtol=0.0, atol=1e-6))
        return from_there and bool(np.all(np.diff(places[:, 0]) >= 0.0) and np.ptp(places[:, 1]) < 1e-6)

    def _turns_otherwise(self, ways: Ways, figures: Floats, least_mm: float) -> npt.NDArray[np.bool_]:
        """Tell where the spindle turns otherwise than in the first cut of an insert whose hand is not told."""
        sign = np.sign(ways.rows.turns[ways.ends])
        cuts = np.flatnonzero((figures[:, DEPTH_MM] > least_mm) & (sign != 0.0))
        if len(cuts):
            self._first_turns.setdefault(ways.number, float(sign[cuts[0]]))
        return (
            sign == -self._first_turns.get(ways.number, 0.0) if len(cuts) else np.zeros(len(sign), np.bool_)
        )

    def _is_near(self, insert: Insert, outline: Floats, places: Floats) -> bool:
        """Tell whether a tool would cut if it were a little lower, or beside where it is."""
        found, near = np.zeros((len(places) - 1, FIGURES)), NEAR_CELLS * self.stock.cell_mm
        for shift in ((-near, 0.0), (0.0, -near), (0.0, near)):
            self._sweep(insert, outline, places[:-1] + shift, places[1:] + shift, found)
        return bool(found[:, DEPTH_MM].any())

    def _held(self, insert: Insert, places: Floats, body: Turned | None = None) -> Floats:
        """Return how deep what holds a tool gets: it is taken to be as wide as the tool, and a cell on both sides."""
        found = np.zeros((len(places) - 1, FIGURES))
        if not math.isinf(insert.reach_mm):
            wide = 0.5 * insert.flat_mm + insert.nose_mm + self.stock.cell_mm
            outline = np.array([wide, 0.0, 0.5 * math.pi, 0.0, 0.5 * math.pi, 0.0])
            above = places + (insert.reach_mm - insert.nose_mm, 0.0)
            self._sweep(insert, outline, above[:-1], above[1:], found, body=body)
        return found

    def _sweep(
        self,
        insert: Insert,
        outline: Floats,
        begins: Floats,
        ends: Floats,
        figures: Floats,
        *,
        narrower_mm: float = 0.0,
        cuts: bool = False,
        body: Turned | None = None,
    ) -> None:
        stock = body or self.stock
        begins, ends = np.ascontiguousarray(begins), np.ascontiguousarray(ends)
        field, limit = (-stock.inner, -stock.outer) if insert.inside else (stock.outer, stock.inner)
        sweep_insert(
            stock.first_z, stock.cell_mm, field, limit, begins, ends, outline, narrower_mm, cuts, figures
        )
        if insert.inside and cuts:
            stock.inner[:] = -field

    def _thread(self, ways: Ways, insert: Insert, outline: Floats, places: Floats, figures: Floats) -> None:
        """Cut where the tool is after each turn of the spindle, from where its block begins."""
        for first, last in runs(ways.block):
            row = int(ways.ends[first])
            way_z = np.abs(np.diff(places[first : last + 1, 1]))
            duration = np.maximum(ways.duration_s[first:last], 1e-9)
            lead = float((way_z / duration).max() * 60.0 / max(abs(float(ways.rows.turns[row])), 1e-9))
            far = np.concatenate(([0.0], np.cumsum(way_z)))
            at = np.arange(0.0, far[-1] + 1e-9, lead) if 1e-6 < lead < far[-1] else np.zeros(0)
            stamps = np.column_stack([np.interp(at, far, places[first : last + 1, i]) for i in range(2)])
            found = np.zeros((len(at), FIGURES))
            self._sweep(insert, outline, stamps, stamps, found, cuts=True)
            of = np.minimum(np.searchsorted(far[1:], at), last - first - 1) + first
            np.add.at(figures[:, VOLUME_MM3], of, found[:, VOLUME_MM3])
            for way, row_ in zip(of.tolist(), found, strict=True):
                if row_[DEPTH_MM] > figures[way, DEPTH_MM]:
                    figures[way, DEPTH_MM:] = row_[DEPTH_MM:]

    def _drill(self, ways: Ways, tool: Tool) -> None:
        """Let a tool for the middle widen the bore."""
        profile, stock = tool.cutting_profile(), self.stock
        radii = np.linspace(0.0, tool.radius_mm, _DRILL_STEPS)
        heights = np.array([profile.height(float(r)) for r in radii])
        figures = np.zeros((len(ways.ends), FIGURES))
        holes = figures.copy()
        for way, (begin, end) in enumerate(self._on_axis(ways.places)):
            lowest = min(begin[2], end[2])
            above = stock.z - lowest
            reach = np.where(above < 0.0, 0.0, np.interp(above, heights, radii))
            reach = np.minimum(np.where(above > heights[-1], tool.radius_mm, reach), stock.outer)
            wider = np.maximum(stock.inner, reach)
            volume = float(np.pi * np.sum(wider**2 - stock.inner**2) * stock.cell_mm)
            if volume > 0.0:
                deep = (wider > stock.inner) & (stock.outer > stock.inner)
                figures[way, DEPTH_MM] = float(stock.z[deep].max()) - lowest
                figures[way, VOLUME_MM3], figures[way, AT_Y] = volume, lowest
                stock.inner[:] = wider
                # How far the wall of its own hole rises, whatever the pecks before have drilled.
                wall = (stock.inner <= tool.radius_mm + stock.cell_mm) & (stock.outer > tool.radius_mm)
                wall &= above >= 0.0
                holes[way] = figures[way]
                holes[way, DEPTH_MM] = float(above[wall].max(initial=0.0))
        least = LEAST_DEPTH_SHARE * stock.cell_mm
        self._note_bores(ways, tool, radii, heights)
        if ways.rapid:
            self._note(ContactKind.RAPID, ways, figures, least)
        self.tally.count(ways, figures, tool)
        self._note(ContactKind.FLUTES, ways, holes, tool.flute_mm)
        if not ways.rapid:
            turns = ways.rows.turns[ways.ends]
            self._note(ContactKind.SPINDLE, ways, figures, least, turns == 0.0)
            wrong = turns > 0.0 if tool.left_hand else turns < 0.0
            self._note(ContactKind.DIRECTION, ways, figures, least, wrong)
            self.tally.count_idle(
                ways, figures, lambda first, last: self._bores_near(ways.places[first : last + 1], tool)
            )

    def _note_bores(self, ways: Ways, tool: Tool, radii: Floats, heights: Floats) -> None:
        """Note where a drill meets fixtures, and where its hole is wider or deeper than that of the target."""
        bodies = [(ContactKind.FIXTURE, each, 0.0) for each in self._fixtures]
        if self._target is not None:
            bodies.append((ContactKind.GOUGE, self._target.limit, self._target.tolerance_mm))
        for kind, body, tolerance_mm in bodies:
            met = np.zeros((len(ways.ends), FIGURES))
            for way, (begin, end) in enumerate(self._on_axis(ways.places)):
                above = body.z - min(begin[2], end[2])
                reach = np.where(above < 0.0, 0.0, np.interp(above, heights, radii, right=tool.radius_mm))
                deep = np.where((body.outer > body.inner) & (reach > 0.0), reach - body.inner, 0.0)
                at = int(np.argmax(deep))
                if deep[at] > 0.0:
                    met[way, DEPTH_MM] = deep[at] + tolerance_mm
                    met[way, AT_X], met[way, AT_Y] = reach[at], body.z[at]
            self._note(kind, ways, met, LEAST_DEPTH_SHARE * self.stock.cell_mm)

    def _bores_near(self, places: Floats, tool: Tool) -> bool:
        """Tell whether a drill would cut if it went a little farther."""
        lowest = min((min(a[2], b[2]) for a, b in self._on_axis(places)), default=math.inf)
        below = self.stock.z >= lowest - NEAR_CELLS * self.stock.cell_mm
        return bool(np.any(below & (self.stock.inner < np.minimum(self.stock.outer, tool.radius_mm))))

    @staticmethod
    def _on_axis(places: Floats) -> Iterator[tuple[Floats, Floats]]:
        """Yield the ways, those beside the axis far above: they drill nothing."""
        away = np.array([0.0, 0.0, np.inf])
        for begin, end in pairwise(places):
            on_axis = max(abs(begin[0]), abs(end[0])) <= _ON_AXIS_MM
            yield (begin, end) if on_axis else (away, away)

    def _note(
        self,
        kind: ContactKind,
        ways: Ways,
        figures: Floats,
        least_mm: float,
        only: npt.NDArray[np.bool_] | None = None,
    ) -> None:
        wrong = figures[:, DEPTH_MM] > least_mm
        for way in np.flatnonzero(wrong if only is None else wrong & only).tolist():
            row, found = int(ways.ends[way]), figures[way]
            place = float(found[AT_X]), 0.0, float(found[AT_Y])
            t_s, block = float(ways.rows.t_s[row]), int(ways.rows.block[row])
            self.tally.contacts.note(Contact(kind, block, t_s, place, float(found[DEPTH_MM])))
