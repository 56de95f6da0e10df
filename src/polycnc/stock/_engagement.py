"""How hard tools cut: material removed in a second, depth and width of the cut, thickness of the chips, over time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from polycnc.stock._insert import Insert, InsertKind
from polycnc.stock._sweep import DEPTH_MM, VOLUME_MM3
from polycnc.stock._tool import Tool
from polycnc.stock._ways import Ways

Floats = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]

_LEAST_MM = 1e-6
_SAID_RPM = 1.0
"""What counts as the speed of a spindle that is started without S."""


@dataclass(frozen=True, eq=False, slots=True)
class Engagement:
    """Hold stretches of a run in which a tool removes material at a feed, in the order of time.

    `t_s` is where each ends, `duration_s` how long it takes, `block` the number of its block. `rate_mm3_s` is what it
    removes in a second. `axial_mm` is the greatest depth along the axis of the tool; of a turning tool it is that
    towards the axis of the part. `radial_mm` is the mean width: width, depth and speed multiply to the rate. Where a
    tool goes down or up more steeply than 45 degrees it has its diameter as width, and no depth. `chip_mm` is the
    greatest thickness of a chip. NaN is what there is not, or is not known: the width of a turning tool, chips
    of a thread, and those without the speed of the spindle or the number of teeth.
    """

    t_s: Floats
    duration_s: Floats
    block: Integers
    rate_mm3_s: Floats
    axial_mm: Floats
    radial_mm: Floats
    chip_mm: Floats

    @property
    def most(self) -> tuple[float, float, float, float]:
        """The greatest rate, depth, width and thickness of a chip; 0 where none is known."""
        return tuple(
            float(np.nanmax(each, initial=0.0))
            for each in (self.rate_mm3_s, self.axial_mm, self.radial_mm, self.chip_mm)
        )  # type: ignore[return-value]


class EngagementLog:
    """Collect how tools cut."""

    def __init__(self) -> None:
        self._columns: list[tuple[Floats | Integers, ...]] = []

    def add(self, ways: Ways, figures: Floats, tool: Tool | Insert) -> None:
        """Take what the ways of a tool have removed."""
        duration = ways.duration_s
        cut = (figures[:, DEPTH_MM] > _LEAST_MM) & (duration > 0.0)
        if ways.rapid or not cut.any():
            return
        volume, axial, duration = figures[cut, VOLUME_MM3], figures[cut, DEPTH_MM], duration[cut]
        step = np.diff(ways.places, axis=0)[cut]
        if isinstance(tool, Tool):
            level = np.hypot(step[:, 0], step[:, 1])
            across = level > np.abs(step[:, 2])
            area = np.where(across, level * axial, volume / tool.diameter_mm)
            radial = np.minimum(volume / area, tool.diameter_mm)
            axial = np.where(across, axial, np.nan)
            length = np.linalg.norm(step, axis=1)
            chip = _chip_mm(length / duration, np.abs(ways.rows.turns[ways.ends][cut]), radial, tool)
        else:
            radial = np.full(len(volume), np.nan)
            feed = np.linalg.norm(step, axis=1) / duration
            chip = _turned_chip_mm(feed, np.abs(ways.rows.turns[ways.ends][cut]), step, axial, tool)
        ends = ways.ends[cut]
        self._columns.append(
            (ways.rows.t_s[ends], duration, ways.rows.block[ends], volume / duration, axial, radial, chip)
        )

    def all(self) -> Engagement:
        """Return what was collected."""
        nothing = np.zeros(0)
        empty = (nothing, nothing, np.zeros(0, np.int64), nothing, nothing, nothing, nothing)
        return Engagement(*(np.concatenate(column) for column in zip(empty, *self._columns, strict=True)))


def _turned_chip_mm(feed_mm_s: Floats, turns: Floats, step: Floats, depth: Floats, insert: Insert) -> Floats:
    """Return the greatest thickness of a chip: the feed of a turn, less along the axis where the edge leans."""
    if insert.kind is InsertKind.THREADING:
        return np.full(len(feed_mm_s), np.nan)
    of_turn = feed_mm_s * 60.0 / np.where(turns > _SAID_RPM, turns, np.nan)
    flank = np.radians(np.where(step[:, 2] < 0.0, insert.left_deg, insert.right_deg))
    if insert.nose_mm > 0.0:
        flank = np.minimum(flank, np.arccos(np.clip(1.0 - depth / insert.nose_mm, 0.0, 1.0)))
    along = np.abs(step[:, 2]) > np.abs(step[:, 0])
    return np.where(along, of_turn * np.sin(flank), of_turn)


def _chip_mm(feed_mm_s: Floats, turns: Floats, radial: Floats, tool: Tool) -> Floats:
    """Return the greatest thickness of a chip: the feed of a tooth, less where it is narrower than the radius."""
    if not tool.teeth:
        return np.full(len(feed_mm_s), np.nan)
    known = turns > _SAID_RPM
    of_tooth = feed_mm_s * 60.0 / np.where(known, turns, np.nan) / tool.teeth
    share = np.minimum(radial / tool.diameter_mm, 0.5)
    return of_tooth * 2.0 * np.sqrt(share * (1.0 - share))
