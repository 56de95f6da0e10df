"""What a view shows of a record of any length: the points of the path that matter, and which block is when."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from polycnc.kernel import FEED_MM_S, IS_RAPID, LEADING, TIME_S
from polycnc.machine import MachineConfig
from polycnc.nc import BlockRecords
from polycnc.runner._blocks import Blocks, Execution, ExecutionCollector
from polycnc.runner._outcome import Trace
from polycnc.runner._power import powers
from polycnc.runner._zeros import NO_ZEROS, Zeros
from polycnc.runner.view._motion import Motion, MotionCollector
from polycnc.runner.view._thin import Floats, kept_rows

MOST_POINTS = 100_000
_PIECE = 1 << 16  # rows of a trace that are thinned at a time
_TOLERANCE = {"mm": 0.005, "deg": 0.01}
_POWER = 0.01  # of full power, the same for a laser
_SPEED_MM_S = 0.1  # deviation of the speed that counts as much as a tolerance of position


@dataclass(frozen=True)
class Track:
    """Hold a thinned record: points of the path over time, and executions of blocks over time.

    `tolerance_mm` is how far the tool may be from the record between two points (twice that number in degree).
    """

    t_s: Floats
    position: Floats  # [points, axes]
    feed_mm_s: Floats
    rapid: npt.NDArray[np.bool_]
    start_s: Floats  # [executions]
    number: npt.NDArray[np.int64]  # [executions], places in `blocks`
    blocks: Blocks
    tolerance_mm: float
    thinned: bool  # executions are left out too
    motion: Motion
    zeros: Zeros = NO_ZEROS
    cycle_s: float = 0.0
    power: Floats | None = None  # of a laser

    def block_at(self) -> npt.NDArray[np.int64]:
        """Return the place in `blocks` of each point's block; the rows before the first block count for it."""
        at = np.searchsorted(self.start_s, self.t_s - 1e-6, side="left") - 1
        return self.number[np.maximum(at, 0)] if len(self.number) else np.zeros(len(at), np.int64)

    def tools(self) -> npt.NDArray[np.int64]:
        """Return the tool in the spindle at each point, 0 where no block is known."""
        return (
            self.blocks.tool[self.block_at()].astype(np.int64)
            if len(self.blocks)
            else np.zeros(len(self.t_s), np.int64)
        )


class TrackCollector:
    """Thin a record while it comes; memory is bounded by `most` points, and the executions of blocks.

    Of a machine with a `laser` its power is kept too.
    """

    def __init__(
        self, units: tuple[str, ...], *, most: int = MOST_POINTS, laser: MachineConfig | None = None
    ) -> None:
        self._laser = laser if laser is not None and laser.spindle.laser else None
        tolerances = [*(_TOLERANCE[unit] for unit in units), _SPEED_MM_S]
        if self._laser is not None:
            tolerances.append(_POWER * self._laser.spindle.max_rpm)
        self._scale = 1.0 / np.array(tolerances)
        self._axes = len(units)
        self._most = most
        self._pieces: list[Floats] = []  # columns: time, rapid, style, axes, speed, power of a laser
        self._held = 0
        self._factor = 1.0
        self._missed = 1.0
        self._last: Floats | None = None
        self._rows = 0
        self._executions = ExecutionCollector()
        self._motion = MotionCollector(self._axes)

    def add(self, rows: Floats, tags: npt.NDArray[np.int64], records: BlockRecords) -> None:
        """Take a piece of the record."""
        if len(rows):
            style = self._executions.table.styles(self._executions.add(tags, records))
            axes = rows[:, LEADING : LEADING + self._axes]
            self._motion.add(rows[:, TIME_S], axes)
            columns = [rows[:, TIME_S], rows[:, IS_RAPID], style, axes, rows[:, FEED_MM_S]]
            if self._laser is not None:
                columns.append(powers(rows, tags, records, self._laser))
            self._take(np.column_stack(columns))

    def add_trace(self, trace: Trace, execution: Execution) -> None:
        """Take a whole trace."""
        number = np.repeat(execution.number, np.diff(execution.start, append=len(trace)))
        style = execution.blocks.styles(number)
        for first in range(0, len(trace), _PIECE):
            part = slice(first, first + _PIECE)
            columns = [trace.t_s, trace.rapid, style, trace.setpoint, trace.feed_mm_s]
            if self._laser is not None and trace.power is not None:
                columns.append(trace.power)
            self._motion.add(trace.t_s[part], trace.setpoint[part])
            self._take(np.column_stack([column[part] for column in columns]))

    def execution(self) -> Execution:
        """Return which block was executed when, of the pieces so far."""
        return self._executions.execution()

    def track(self, execution: Execution) -> Track:
        """Return what was collected."""
        ends = [] if self._last is None else [self._last]
        points = np.concatenate([*self._pieces, *ends]) if ends else np.zeros((0, 3 + len(self._scale)))
        cycle_s = float(points[-1, 0]) / self._rows if self._rows else 0.0
        start, number = execution.start, execution.number
        start_s = start.astype(np.float64) * cycle_s
        thinned = len(start) > 2 * self._most
        if thinned:  # keep the executions that a point belongs to
            at = np.searchsorted(start_s, points[:, 0] - 0.5 * cycle_s, side="right") - 1
            chosen = np.unique(np.maximum(at, 0))
            start_s, number = start_s[chosen], number[chosen]
        return Track(
            t_s=points[:, 0],
            position=points[:, 3 : 3 + self._axes],
            feed_mm_s=points[:, 3 + self._axes],
            power=None if self._laser is None else points[:, -1],
            rapid=points[:, 1] != 0.0,
            start_s=start_s,
            number=number,
            blocks=execution.blocks,
            tolerance_mm=self._missed * _TOLERANCE["mm"],
            thinned=thinned,
            motion=self._motion.motion(),
            zeros=execution.zeros,
            cycle_s=cycle_s,
        )

    def _take(self, piece: Floats) -> None:
        whole = piece if self._last is None else np.concatenate((self._last, piece))
        kept = whole[self._kept(whole)]
        self._rows += len(piece)
        self._last = whole[-1:].copy()
        self._pieces.append(kept[:-1].copy())  # the last is the first of the next piece
        self._held += len(kept) - 1
        if self._held > 2 * self._most:
            self._thin()

    def _kept(self, points: Floats) -> npt.NDArray[np.bool_]:
        """Mark the rows to keep: what the tolerance asks for, and both sides of a change of tool or kind."""
        turns = np.any(np.diff(points[:, 1:3], axis=0) != 0.0, axis=1)
        forced = np.zeros(len(points), np.bool_)
        if 2 * np.count_nonzero(turns) <= self._most // 2:
            forced[1:] = turns
            forced[:-1] |= turns
        return kept_rows(points[:, 0], points[:, 3:] * (self._scale / self._factor), forced)

    def _thin(self) -> None:
        points = np.concatenate(self._pieces)
        while len(points) > self._most:
            self._factor *= 2.0
            self._missed += self._factor
            points = points[self._kept(points)]
        self._pieces, self._held = [points], len(points)
