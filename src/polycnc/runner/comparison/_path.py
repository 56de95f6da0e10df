"""The path of a run as a polyline: what lies on straight lines is left out, as long as the blocks do not change."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from polycnc.kernel import IS_RAPID, LEADING, TIME_S
from polycnc.nc import BlockRecords
from polycnc.runner._blocks import Blocks, ExecutionCollector, execution_by_lines
from polycnc.runner._outcome import Trace
from polycnc.runner.view import kept_rows

Floats = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]
Flags = npt.NDArray[np.bool_]

THINNING_MM = 1e-5
"""How far a polyline may leave the positions that it was made from, mm or degree."""

_PIECE = 1 << 16
_HEAD = 3  # columns before the axes: time, rapid, number of the block


@dataclass(frozen=True)
class Path:
    """Where a run went: points, and of the segment that ends at each point its block and whether it was a rapid.

    `step` is the longest way within one control cycle at which a rapid and another motion meet: so far apart they may
    seem to meet in two runs of one path. With `kinds_known` false neither rapids nor tools are known.
    """

    axes: tuple[str, ...]
    units: tuple[str, ...]
    t_s: Floats
    point: Floats  # [points, axes]
    number: Indices
    rapid: Flags
    blocks: Blocks
    step: float
    kinds_known: bool

    @property
    def tools(self) -> Indices:
        """The tool of the segment that ends at each point."""
        return self.blocks.tool[self.number].astype(np.int64)

    @property
    def tool_order(self) -> tuple[int, ...]:
        """The tools one after the other, as they moved."""
        tools = self.tools[1:]
        return tuple(tools[np.flatnonzero(np.diff(tools, prepend=-1))].tolist())

    def length(self) -> float:
        """Return how long the polyline is, a degree counted as a millimetre."""
        return float(np.sqrt((np.diff(self.point, axis=0) ** 2).sum(1)).sum())


class PathCollector:
    """Collect a path while it is run."""

    def __init__(self, axes: tuple[str, ...], units: tuple[str, ...]) -> None:
        self._axes, self._units = axes, units
        self._turning = [i for i, unit in enumerate(units) if unit == "deg"]
        self._pieces: list[Floats] = []
        self._last: Floats | None = None
        self._step = 0.0
        self._executions = ExecutionCollector()

    def add(self, rows: Floats, tags: Indices, records: BlockRecords) -> None:
        """Take a piece of the record."""
        if len(rows):
            number = self._executions.add(tags, records)
            axes = rows[:, LEADING : LEADING + len(self._axes)]
            self._take(np.column_stack((rows[:, TIME_S], rows[:, IS_RAPID], number, axes)))

    def path(self) -> Path:
        """Return the path so far."""
        return self._path(self._executions.execution().blocks, kinds_known=True)

    def path_of(self, trace: Trace) -> Path:
        """Take a whole trace, and return its path."""
        execution = trace.execution or execution_by_lines(trace.block)
        number = np.repeat(execution.number, np.diff(execution.start, append=len(trace)))
        for first in range(0, len(trace), _PIECE):
            part = slice(first, first + _PIECE)
            columns = (trace.t_s, trace.rapid, number, trace.setpoint)
            self._take(np.column_stack([column[part] for column in columns]))
        return self._path(execution.blocks, kinds_known=trace.execution is not None)

    def _path(self, blocks: Blocks, *, kinds_known: bool) -> Path:
        points = np.concatenate([np.zeros((0, _HEAD + len(self._axes))), *self._pieces])
        return Path(
            self._axes,
            self._units,
            t_s=points[:, 0],
            point=points[:, _HEAD:],
            number=points[:, 2].astype(np.int64),
            rapid=points[:, 1] != 0.0,
            blocks=blocks,
            step=self._step,
            kinds_known=kinds_known,
        )

    def _take(self, piece: Floats) -> None:
        begins = self._last is None
        whole = piece if self._last is None else np.concatenate((self._last, piece))
        for axis in self._turning:  # an axis without end counts on, so that its path has no jump
            whole[:, _HEAD + axis] = np.unwrap(whole[:, _HEAD + axis], period=360.0)
        way = np.sqrt((np.diff(whole[:, _HEAD:], axis=0) ** 2).sum(1))
        changes = np.diff(whole[:, 1]) != 0.0
        beside = changes.copy()
        beside[:-1] |= changes[1:]
        self._step = max(self._step, float(np.max(way, where=beside, initial=0.0)))
        moves = np.concatenate(([True], way > 0.0))
        whole, way = whole[moves], way[moves[1:]]
        along = np.concatenate(([0.0], np.cumsum(way)))
        forced = np.zeros(len(whole), np.bool_)
        forced[:-1] = np.any(np.diff(whole[:, 1:_HEAD], axis=0) != 0.0, axis=1)
        kept = whole[kept_rows(along, whole[:, _HEAD:] / THINNING_MM, forced)]
        self._pieces.append(kept if begins else kept[1:])
        self._last = kept[-1:].copy()
