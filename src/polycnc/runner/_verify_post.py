"""Hold a posted program against its tool path: run it, and compare what the machine sweeps with what was meant.

Both ways: how far the machine goes off the tool path, and how far the tool path has points that the machine
does not come to. Each cycle of the run is compared with the record that its block came from.

The program runs on the machine as it is, with its work offsets, tool lengths and limits, for time and alarms, and
once more with less acceleration, so that the machine's positions lie close enough together to see every corner.
What is compared is the tip of the tool that is in the spindle, counted from program zero: a program that does not
compensate the length of its tool deviates by that length.
"""

from __future__ import annotations

import gc
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from polycnc.kernel import BLOCK, IS_RAPID, LEADING
from polycnc.machine import MachineConfig, ToolConfig, load_machine
from polycnc.nc import BlockRecords, Dialect, Group, ModalWords, ProgramText, dialect_for
from polycnc.post import BlockMap, Parameters, Sweep, Tangency, ToolPath, Ways, sweep_in_runs, sweep_tool_path
from polycnc.runner._close_run import run_closely
from polycnc.runner._execution import Progress
from polycnc.runner._post_geometry import Floats, Indices, Moves, to_segments
from polycnc.runner._post_rotary import PartFrame, ToolAxisCheck, angle_columns
from polycnc.runner._result import RunResult
from polycnc.runner._run import run_program
from polycnc.runner._settings import RunSettings
from polycnc.units import MM_PER_INCH

SMALLEST_TOLERANCE_MM = 1e-3
_ROUNDING_UNITS = (
    1.25  # of the last decimal: a point loses up to 0.87 of them, a small arc a little more than one
)
TOOL_AXIS_TOLERANCE_DEG = 0.01
_SAMPLING = 0.1  # part of the tolerance that the distance of the machine's positions may cost
_AXES = "XYZ"
_CONTEXT_SHIFT = 32
_MANY_BLOCKS = 20_000  # of a program whose machine takes so much memory that looking for it is worth the time


@dataclass(frozen=True, slots=True)
class Deviation:
    """A distance, and where it is: lines of the program and of the tool path, 0 if there is none."""

    mm: float = 0.0
    block: int = 0
    line: int = 0
    point: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class PostVerification:
    """Say whether a program cuts what its tool path means.

    `off_path` is the farthest that a feed move goes off the tool path, `missed` the farthest that a point of the
    tool path stays from the machine's way, `detour_mm` how far rapids leave the straight line, which is allowed.
    `rapid_cuts` counts records with feed that the program follows by rapid. `kinked_arcs` of the tool path turn
    back on the spot where straight feed moves meet them, and `smooth_arcs` do not: an arc that is read with the wrong
    sense does, so more of the former are no proof. `run` is the run on the machine. `compared` says which axes were
    compared; `tool_axis_deg` is the greatest angle between the tool axes where a record ends, on `tool_axis_line`.
    """

    tolerance_mm: float
    off_path: Deviation
    missed: Deviation
    detour_mm: float
    rapid_cuts: int
    smooth_arcs: int
    kinked_arcs: int
    arc_remark: str
    path_feed_mm: float
    path_rapid_mm: float
    run: RunResult
    compared: str = _AXES
    tool_axis_deg: float = 0.0
    tool_axis_line: int = 0

    @property
    def deviation_mm(self) -> float:
        """Greatest deviation, both ways."""
        return max(self.off_path.mm, self.missed.mm)

    @property
    def ok(self) -> bool:
        """Whether the program runs to its end and stays within the tolerance."""
        return (
            self.run.ok
            and not self.rapid_cuts
            and not self.arc_remark
            and self.deviation_mm <= self.tolerance_mm
            and self.tool_axis_deg <= TOOL_AXIS_TOLERANCE_DEG
        )

    def as_dict(self) -> dict[str, Any]:
        """Return plain data for JSON."""
        return {
            "ok": self.ok,
            "tolerance_mm": self.tolerance_mm,
            "deviation_mm": self.deviation_mm,
            "off_path": {"mm": self.off_path.mm, "block": self.off_path.block, "line": self.off_path.line},
            "missed": {"mm": self.missed.mm, "block": self.missed.block, "line": self.missed.line},
            "compared": self.compared,
            "tool_axis": {"deg": self.tool_axis_deg, "line": self.tool_axis_line},
            "detour_mm": self.detour_mm,
            "rapid_cuts": self.rapid_cuts,
            "smooth_arcs": self.smooth_arcs,
            "kinked_arcs": self.kinked_arcs,
            "path_feed_mm": self.path_feed_mm,
            "path_rapid_mm": self.path_rapid_mm,
            "time_s": self.run.time_s,
            "cutting_path_mm": self.run.cutting_path_mm,
            "rapid_path_mm": self.run.rapid_path_mm,
            "alarms": [str(alarm) for alarm in self.run.alarms],
        }


def verify_post(
    program: ProgramText,
    tool_path: ToolPath,
    block_map: BlockMap,
    machine: str | MachineConfig,
    dialect: str,
    tolerance_mm: float | None = None,
    progress: Progress | None = None,
    parameters: Parameters | None = None,
) -> PostVerification:
    """Run a posted program and compare its path with the tool path; `block_map` is what posting filled.

    Without a tolerance it is what rounding to the decimals of the control file may cost, and at least 0.001 mm.

    The run is that on the machine as it is. Tool radii count as 0 in the comparison, which is in the coordinates of the
    part. With rotary axes in the `parameters` of the control file the tool axis is compared too, where a record ends,
    and positions of the machine's axes are taken to the part by the geometry that stands there.

    Raises:
        UsageError: no such machine or dialect.
    """
    parameters = parameters or Parameters()
    if tolerance_mm is None:
        tolerance_mm = max(SMALLEST_TOLERANCE_MM, _ROUNDING_UNITS * last_decimal_mm(parameters))
    config = load_machine(machine)
    read = dialect_for(program, dialect)
    tangency = Tangency()
    carried = _carried(program, block_map, read)
    sweeps: Iterator[Sweep | Ways] = sweep_in_runs(tool_path.runs())
    if carried is not None:
        owners = carried
        sweeps = (sweep._replace(record=int(owners[sweep.record])) for sweep in sweep_tool_path(tool_path))
    frame = PartFrame(parameters, config)
    moves = Moves(
        _judged(sweeps, tangency),
        len(block_map.line),
        bool(frame.axes),
        None if carried is not None else np.frombuffer(block_map.line, np.intc),
    )
    path_feed_mm, path_rapid_mm = moves.length_mm()
    with tempfile.TemporaryDirectory(prefix="polycnc-") as root:  # nothing is left beside the program
        result = run_program(program, RunSettings(config, read, root=root), check=False)
        if len(block_map.line) > _MANY_BLOCKS:
            gc.collect()  # the machine of that run, before there is another one
        comparison = _Comparison(moves, block_map, carried, config, read, frame)
        if result.ok:
            run_closely(program, config, read, tolerance_mm * _SAMPLING, comparison.add, progress, Path(root))
    tool_axis_deg, tool_axis_line = comparison.tool_axis() if result.ok else (0.0, 0)
    return PostVerification(
        tolerance_mm=tolerance_mm,
        off_path=comparison.off_path,
        missed=comparison.missed() if result.ok else Deviation(),
        detour_mm=comparison.detour_mm,
        rapid_cuts=int(comparison.rapid_cut.sum()),
        path_feed_mm=path_feed_mm,
        path_rapid_mm=path_rapid_mm,
        smooth_arcs=tangency.smooth,
        kinked_arcs=tangency.kinked,
        arc_remark=tangency.text() if tangency.mostly_kinked else "",
        run=result,
        compared=frame.compared,
        tool_axis_deg=tool_axis_deg,
        tool_axis_line=tool_axis_line,
    )


def last_decimal_mm(parameters: Parameters) -> float:
    """Return how much one unit of the last decimal of a position is, in mm."""
    unit = 10.0**-parameters.decimals
    return unit * MM_PER_INCH if parameters.units == "inch" else unit


def _carried(program: ProgramText, block_map: BlockMap, dialect: Dialect) -> Indices | None:
    """Return the record whose blocks do what each record asks for, None if it is always the record itself.

    It is the record itself, unless its last block only computes: then its moves come from a block after, maybe one
    in a loop that moves for many records. They and all that lie between are compared as one.
    """
    if dialect.language != "cpl":
        return None
    records = np.arange(len(block_map.line), dtype=np.int32)
    lines = program.content.split(b"\n")
    for record in range(len(records) - 2, -1, -1):
        last = block_map.last_block[record]
        wrote = last > (block_map.last_block[record - 1] if record else 0)
        if wrote and lines[last - 1].lstrip()[:1].isdigit():
            records[record] = records[record + 1]
    return records


def _judged(sweeps: Iterator[Sweep | Ways], tangency: Tangency) -> Iterator[Sweep | Ways]:
    """Yield the sweeps, and let `tangency` see them."""
    for sweep in sweeps:
        if isinstance(sweep, Ways):
            ways = np.diff(sweep.ends, axis=0, prepend=np.array([sweep.start]))
            tangency.run(sweep.start, sweep.ends, np.sqrt((ways * ways).sum(axis=1)))
        elif sweep.angle > 0.0 and sweep.start is not None:
            tangency.arc(sweep.line, sweep.start, sweep.end, sweep.center, sweep.normal)
        else:
            tangency.straight(sweep.start, sweep.end, not sweep.rapid)
        yield sweep
    tangency.settle()


class _TipFrame:
    """Where the tip of the tool in the spindle is on the part: what to take from the axes' positions."""

    def __init__(self, config: MachineConfig, dialect: Dialect, letters: Sequence[str]) -> None:
        self._config = config
        names = config.axis_names
        self._columns = [names.index(name) if name in names else -1 for name in (*_AXES, *letters)]
        signs = {"length_plus": 1.0, "length_minus": -1.0}
        self._signs = {f"G{code}": signs[action] for code, action in dialect.g.items() if action in signs}
        self._last = np.zeros(len(self._columns))

    def shifts(self, tags: Indices, records: BlockRecords) -> Floats:
        """Return what to take from the positions of each row: X, Y, Z, and the rotary axes."""
        contexts = tags >> _CONTEXT_SHIFT
        begins = np.flatnonzero(np.concatenate(([True], contexts[1:] != contexts[:-1])))
        found = np.empty((len(begins), len(self._columns)))
        for place, begin in enumerate(begins.tolist()):
            words = records.lasting_words(int(tags[begin]))
            if words is not None:
                self._last = self._shift(words)
            found[place] = self._last
        return np.repeat(found, np.diff(np.append(begins, len(tags))), axis=0)

    def _shift(self, modal: ModalWords) -> npt.NDArray[np.float64]:
        shift = np.array([modal.zero[column] if column >= 0 else 0.0 for column in self._columns])
        sign = self._signs.get(modal.g.get(Group.LENGTH_COMPENSATION, ""), 0.0)
        shift[2] += self._length(modal.tool) - sign * self._length(modal.h)
        return shift

    def _length(self, number: int) -> float:
        tool = self._config.tools.get(number, ToolConfig())
        return tool.length_mm + tool.wear_length_mm


class _Skipped:
    """The ways on which the machine passed records that have no row of their own.

    Such a record moved by less than the last decimal: its points lie on the way from the last row of a record before
    it to the first row of one after it.
    """

    def __init__(self) -> None:
        self._records: list[Indices] = []
        self._ways: list[Floats] = []

    def note(self, before: Indices, records: Indices, start: Floats, end: Floats) -> None:
        """Take rows of a recording: the records before and at each, and the way there."""
        steps = records - before
        jumps = np.flatnonzero((steps != 0) & (steps != 1))
        self._records.append(before[jumps].astype(np.int32))
        self._ways.append(np.concatenate((start[jumps], end[jumps]), axis=1))

    def nearest(self, records: Indices, points: Floats, begin: Floats, end: tuple[int, Floats]) -> Floats:
        """Return how near the machine came to points of records that it passed, from `begin` to `end`."""
        last, here = end
        known = np.concatenate([np.array([-1]), *self._records, np.array([last])])
        rest = np.concatenate((begin, begin), axis=1), np.concatenate((here, here), axis=1)
        ways = np.concatenate([rest[0], *self._ways, rest[1]])
        order = np.argsort(known, kind="stable")
        known, ways = known[order], ways[order]
        passed = ways[np.searchsorted(known, records, side="right") - 1]
        return to_segments(points, passed[:, :3], passed[:, 3:])


class _Comparison:
    """Compare rows of a run with the moves of the tool path, as they come."""

    def __init__(
        self,
        moves: Moves,
        block_map: BlockMap,
        carried: Indices | None,
        config: MachineConfig,
        dialect: Dialect,
        frame: PartFrame,
    ) -> None:
        self._carried = carried
        self.off_path = Deviation()
        self.detour_mm = 0.0
        self._moves = moves
        self._last_block = np.frombuffer(block_map.last_block, np.intc)
        self._lines = np.frombuffer(block_map.line, np.intc)
        records = len(self._lines)
        self.rapid_cut = np.zeros(records, np.bool_)
        self._columns = [config.axis_names.index(name) if name in config.axis_names else -1 for name in _AXES]
        self._owner, self._witness = moves.witnesses()
        self._first_witness = moves.first
        if self._owner is not None:
            owners = moves.record[self._owner]
            every = np.arange(records + 1, dtype=np.int32)
            self._first_witness = np.searchsorted(owners, every).astype(np.int32)
        self._best = np.full(len(self._witness), np.inf)
        self._at_block = np.zeros(len(self._witness), np.int32)
        names = dict(zip(config.axis_names, config.start_positions, strict=True))
        self._here = np.array([[names.get(name, 0.0) for name in _AXES]])
        self._frame = _TipFrame(config, dialect, frame.letters)
        self._part = frame
        self._angle_columns = angle_columns(frame, config.axis_names)
        self._angles = np.array([[names.get(name, 0.0) for name in frame.letters]], dtype=np.float64)
        self._tool_mm = np.zeros(records) if frame.axes else np.zeros(0)
        if len(block_map.tool_mm):
            self._tool_mm = np.array(block_map.tool_mm)
        self._wanted_axes: Floats = np.zeros((0, 3))
        self._moving = np.zeros(0, np.bool_)
        if frame.axes:
            self._wanted_axes, self._moving = moves.last_axes()
        self._tool_axes = ToolAxisCheck(frame, records)
        self._begin: Floats | None = None
        self._tip: Floats = np.zeros((1, 3))
        self._record = 0
        self._skipped = _Skipped()

    def add(self, rows: Floats, tags: Indices, blocks_of: BlockRecords) -> None:
        """Take a piece of the record; `tags` refer to the blocks of its rows."""
        points = np.zeros((len(rows), 3))
        for place, column in enumerate(self._columns):
            if column >= 0:
                points[:, place] = rows[:, LEADING + column]
        blocks = rows[:, BLOCK].astype(np.int64)
        found = np.searchsorted(self._last_block, blocks.astype(np.intc))
        records = np.minimum(found, len(self._lines) - 1)
        if self._carried is not None:
            records = self._carried[records]
        before = np.concatenate((self._here, points[:-1]))
        before_records = np.concatenate(([self._record], records[:-1]))
        shifts = self._frame.shifts(tags, blocks_of)
        self._here, self._record = points[-1:].copy(), int(records[-1])
        points, before = points - shifts[:, :3], before - shifts[:, :3]
        if self._part.axes:
            points, before = self._on_part(rows, points, before, shifts[:, 3:], records)
        if self._begin is None:
            self._begin = before[:1]
        self._tip = points[-1:].copy()
        moved = (points != before).any(axis=1) | (records != before_records)
        self._skipped.note(before_records, records, before, points)
        points, before, blocks = points[moved], before[moved], blocks[moved]
        rapid = rows[moved, IS_RAPID] != 0.0
        records, before_records = records[moved], before_records[moved]
        self._compare_points(points, blocks, records, rapid)
        self._visit(before, points, blocks, records)
        crossing = records != before_records
        self._visit(before[crossing], points[crossing], blocks[crossing], before_records[crossing])

    def _on_part(
        self, rows: Floats, points: Floats, before: Floats, shifts: Floats, records: Indices
    ) -> tuple[Floats, Floats]:
        """Return where the tip is on the part; and hold the tool axis against that of the records."""
        angles = np.zeros((len(rows), len(self._angle_columns)))
        for place, column in enumerate(self._angle_columns):
            if column >= 0:
                angles[:, place] = rows[:, LEADING + column]
        angles_before = np.concatenate((self._angles, angles[:-1])) - shifts
        self._angles = angles[-1:].copy()
        angles = angles - shifts
        self._tool_axes.add(angles_before, angles, records, self._wanted_axes)
        lengths = self._tool_mm[records]
        return self._part.tips(points, angles, lengths), self._part.tips(before, angles_before, lengths)

    def tool_axis(self) -> tuple[float, int]:
        """Return the greatest angle of a tool axis, in degree, and the line of the tool path."""
        angle, record = self._tool_axes.worst(self._moving)
        return angle, int(self._lines[record]) if record >= 0 else 0

    def missed(self) -> Deviation:
        """Return the farthest point that the machine did not come to."""
        if not len(self._best):
            return Deviation()
        self._visit_skipped()
        worst = int(np.argmax(self._best))
        x, y, z = self._witness[worst].tolist()
        line = self._moves.line(worst if self._owner is None else int(self._owner[worst]))
        return Deviation(float(self._best[worst]), int(self._at_block[worst]), line, (x, y, z))

    def _compare_points(
        self, points: Floats, blocks: Indices, records: Indices, rapid: npt.NDArray[np.bool_]
    ) -> None:
        moves = self._moves
        first, behind = moves.first[records], moves.first[records + 1]
        of_path = behind > first
        distance = np.full(len(points), np.inf)
        for place in range(int((behind - first).max(initial=0))):
            chosen = np.flatnonzero(first + place < behind)
            found = moves.distances(points[chosen], first[chosen] + place)
            distance[chosen] = np.minimum(distance[chosen], found)
        free = rapid | moves.only_rapid[records]
        self.rapid_cut[records[rapid & of_path & moves.only_feed[records]]] = True
        known = np.zeros(len(points), np.bool_)
        known[of_path] = moves.known[first[of_path]]
        detours = distance[of_path & free & known]
        self.detour_mm = max(self.detour_mm, float(detours.max(initial=0.0)))
        judged = np.where(of_path & ~free & known, distance, 0.0)
        worst = int(np.argmax(judged)) if len(judged) else -1
        if worst >= 0 and judged[worst] > self.off_path.mm:
            x, y, z = points[worst].tolist()
            line = int(self._lines[records[worst]])
            self.off_path = Deviation(float(judged[worst]), int(blocks[worst]), line, (x, y, z))

    def _visit(self, start: Floats, end: Floats, blocks: Indices, records: Indices) -> None:
        """Note how near the ways from `start` to `end` come to the points that their records must pass."""
        first, behind = self._first_witness[records], self._first_witness[records + 1]
        for place in range(int((behind - first).max(initial=0))):
            chosen = np.flatnonzero(first + place < behind)
            witness = first[chosen] + place
            found = to_segments(self._witness[witness], start[chosen], end[chosen])
            nearer = found < self._best[witness]
            np.minimum.at(self._best, witness[nearer], found[nearer])
            self._at_block[witness[nearer]] = blocks[chosen[nearer]]

    def _visit_skipped(self) -> None:
        """Count points of records that the machine passed without a row of theirs."""
        still = np.flatnonzero(~np.isfinite(self._best))
        if not len(still):
            return
        here = self._tip
        begin = here if self._begin is None else self._begin
        moves = still if self._owner is None else self._owner[still]
        records = self._moves.record[moves]
        self._best[still] = self._skipped.nearest(records, self._witness[still], begin, (self._record, here))
