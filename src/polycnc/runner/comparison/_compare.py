"""Compare two runs: how far apart their paths lie and where, whether in one order, and what takes how long."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path as FilePath
from typing import Any

import numpy as np

from polycnc.errors import UsageError
from polycnc.machine import MachineConfig
from polycnc.nc import BlockRecords, Dialect, ProgramText, dialect_for
from polycnc.runner._blocks import execution_by_lines
from polycnc.runner._execution import Progress
from polycnc.runner._outcome import Trace, time_text
from polycnc.runner._result import RunResult
from polycnc.runner._run import run_program
from polycnc.runner._settings import RunSettings, program_text
from polycnc.runner._trace import read_trace
from polycnc.runner._trace_formats import TRACE_FORMATS
from polycnc.runner.comparison._both import view_of_both
from polycnc.runner.comparison._compared import Compared, PathDeviation
from polycnc.runner.comparison._distance import PRECISION_MM, Boxes, greatest_distance, in_one_order
from polycnc.runner.comparison._first_difference import BlockDifference, first_difference
from polycnc.runner.comparison._path import THINNING_MM, Floats, Indices, Path, PathCollector
from polycnc.runner.view import Track, TrackCollector, View

DEFAULT_TOLERANCE_MM = 0.01
_SLACK = 2.0 * THINNING_MM + PRECISION_MM  # what may be off in a distance between two polylines
Side = str | FilePath | ProgramText | RunResult | Trace


@dataclass(frozen=True)
class Comparison:
    """Say how two runs differ.

    `a_from_b` is the greatest distance of a point of path A from path B, `b_from_a` the other way round.
    `cuts_a_from_b` and `cuts_b_from_a` look at everything but rapids alone; they are None where nobody knows what was
    a rapid. `same_order` says whether both paths, cuts as cuts and rapids as rapids, can be traversed together within
    the tolerance, with the same tools; where not, `parts_at` are the blocks (program, line) of A and B up to which they
    can. `same_order` is None where the paths are too far apart anyway. `lone_axes` move in one run and do not exist in
    the other.
    """

    tolerance_mm: float
    a: Compared
    b: Compared
    a_from_b: PathDeviation
    b_from_a: PathDeviation
    cuts_a_from_b: PathDeviation | None
    cuts_b_from_a: PathDeviation | None
    same_order: bool | None
    parts_at: tuple[tuple[str, int], tuple[str, int]] | None
    tools: tuple[tuple[int, ...], tuple[int, ...]] | None
    lone_axes: tuple[str, ...]
    first_difference: BlockDifference | None
    tracks: tuple[Track, Track] = field(repr=False, compare=False)
    track_axes: tuple[tuple[str, ...], tuple[str, ...]] = field(repr=False)
    axes: tuple[tuple[str, str], ...] = field(repr=False)

    @property
    def deviation_mm(self) -> float:
        """Greatest deviation, both ways, of all motions and of the cuts."""
        found = (self.a_from_b, self.b_from_a, self.cuts_a_from_b, self.cuts_b_from_a)
        return max(each.mm for each in found if each is not None)

    @property
    def ok(self) -> bool:
        """Whether both run to their ends along one path, in one order, within the tolerance."""
        return (
            self.a.ok
            and self.b.ok
            and not self.lone_axes
            and self.deviation_mm <= self.tolerance_mm + _SLACK
            and self.same_order is True
        )

    def view(self) -> View:
        """Return both paths as one page, to be saved, opened, or shown in a notebook."""
        ways = self.a_from_b, self.b_from_a
        return view_of_both((self.a, self.b), ways, self.axes, self.tracks, self.track_axes)

    def _repr_html_(self) -> str:
        """Return times, lengths and greatest deviations as a table, for notebooks."""
        from polycnc.web import html_table

        rows = [
            ("time", time_text(self.a.time_s), time_text(self.b.time_s)),
            ("path", f"{self.a.path_mm:,.3f} mm", f"{self.b.path_mm:,.3f} mm"),
            ("farthest from the other", *(_place(each) for each in (self.a_from_b, self.b_from_a))),
        ]
        if self.tools is not None and self.tools[0] != self.tools[1]:
            rows.append(("tools", *(", ".join(f"T{tool}" for tool in tools) for tools in self.tools)))
        if self.parts_at is not None:
            rows.append(("one path up to", *(f"line {line}" for _, line in self.parts_at)))
        heads = (f"{each.name} on {each.machine}".removesuffix(" on ") for each in (self.a, self.b))
        return html_table(str(self), ("", *heads), rows)

    def as_dict(self) -> dict[str, Any]:
        """Return plain data for JSON."""
        parts = None
        if self.parts_at is not None:
            parts = {
                side: {"program": program, "line": line}
                for side, (program, line) in zip("ab", self.parts_at, strict=True)
            }
        first = self.first_difference
        return {
            "ok": self.ok,
            "tolerance_mm": self.tolerance_mm,
            "deviation_mm": self.deviation_mm,
            "a_from_b": self.a_from_b.as_dict(),
            "b_from_a": self.b_from_a.as_dict(),
            "cuts_a_from_b": None if self.cuts_a_from_b is None else self.cuts_a_from_b.as_dict(),
            "cuts_b_from_a": None if self.cuts_b_from_a is None else self.cuts_b_from_a.as_dict(),
            "same_order": self.same_order,
            "parts_at": parts,
            "tools": None if self.tools is None else [list(each) for each in self.tools],
            "lone_axes": list(self.lone_axes),
            "first_difference": None
            if first is None
            else {
                "a": {"line": first.line_a, "text": first.text_a},
                "b": {"line": first.line_b, "text": first.text_b},
            },
            "a": self.a.as_dict(),
            "b": self.b.as_dict(),
        }

    def __str__(self) -> str:
        verdict = "agree" if self.ok else "differ"
        return f"{self.a.name} and {self.b.name} {verdict}: deviation {self.deviation_mm:.6f} mm"


def _place(found: PathDeviation) -> str:
    return f"{found.mm:.4f} mm" + (f", line {found.line}" if found.line else "")


def compare(
    a: Side,
    b: Side | None = None,
    machine: str | FilePath | MachineConfig | None = None,
    dialect: str | Dialect | None = None,
    *,
    machine_b: str | FilePath | MachineConfig | None = None,
    dialect_b: str | Dialect | None = None,
    tolerance_mm: float = DEFAULT_TOLERANCE_MM,
    progress: Progress | None = None,
) -> Comparison:
    """Run two programs, or take their traces, and compare where they go and how long it takes.

    `a` and `b` are programs (a path, a text of several lines), traces (a file that ends with .csv, .npz or .parquet, or
    the object) or results that hold one. `machine_b` and `dialect_b` are those of B where they differ; without `b`, A
    is compared with itself on them. Distances are exact between the positions too, to 0.00002 mm, and do not depend on
    when anything is reached. Compared are the axes that both have, in machine coordinates.

    Raises:
        UsageError: no such file, machine or dialect; nothing to compare with; a tolerance below 0; a result without a
            trace; no axis in common.
    """
    if not tolerance_mm >= 0.0:
        raise UsageError(f"a tolerance of {tolerance_mm} mm", hint="Give 0 or more.")
    if b is None:
        _check_twice(a, differs=machine_b is not None or dialect_b is not None)
    part = None if progress is None else (lambda done: progress(0.5 * done))
    rest = None if progress is None else (lambda done: progress(0.5 + 0.5 * done))
    left = _taken(a, machine, dialect, part)
    right = _taken(
        a if b is None else b,
        machine if machine_b is None else machine_b,
        dialect if dialect_b is None else dialect_b,
        rest,
    )
    common = _common(left, right)
    known = left.path.kinds_known and right.path.kinds_known
    one, other = _Lines(left.path, common), _Lines(right.path, common)
    a_from_b, b_from_a = one.deviation_from(other), other.deviation_from(one)
    cuts = (
        (one.deviation_from(other, cuts=True), other.deviation_from(one, cuts=True))
        if known
        else (None, None)
    )
    tools = (left.path.tool_order, right.path.tool_order) if known else None
    greatest = max(each.mm for each in (a_from_b, b_from_a, *cuts) if each is not None)
    same_order, parts_at = None, None
    if greatest <= tolerance_mm + _SLACK:
        same_order, parts_at = one.order_with(other, tolerance_mm + 2.0 * _SLACK, kinds=known)
    difference = None
    if left.text is not None and right.text is not None:
        difference = first_difference(left.text, right.text, left.dialect, right.dialect)
    return Comparison(
        tolerance_mm=tolerance_mm,
        a=left.side,
        b=right.side,
        a_from_b=a_from_b,
        b_from_a=b_from_a,
        cuts_a_from_b=cuts[0],
        cuts_b_from_a=cuts[1],
        same_order=same_order,
        parts_at=parts_at,
        tools=tools,
        lone_axes=(*_lone(left.path, common), *_lone(right.path, common)),
        first_difference=difference,
        tracks=(left.track, right.track),
        track_axes=(left.path.axes, right.path.axes),
        axes=tuple((axis, left.path.units[left.path.axes.index(axis)]) for axis in common),
    )


@dataclass(frozen=True)
class _Taken:
    side: Compared
    path: Path
    track: Track
    text: ProgramText | None
    dialect: Dialect


def _check_twice(side: Side, *, differs: bool) -> None:
    """Refuse to compare something with itself where nothing differs, or it cannot run again."""
    if not differs:
        raise UsageError(
            f"{_name(side)} has nothing to be compared with",
            hint="Name a second file, or another machine (machine_b, --machine-b).",
        )
    if not _is_program(side):
        raise UsageError(f"{_name(side)} has run already", hint="Compare its program, or name a second side.")


def _is_program(side: Side) -> bool:
    """Tell whether a side is a program, which can run on another machine too."""
    if isinstance(side, str | FilePath):
        return (isinstance(side, str) and "\n" in side) or FilePath(side).suffix.lower() not in TRACE_FORMATS
    return isinstance(side, ProgramText)


def _name(side: Side) -> str:
    if isinstance(side, str):
        return "a program" if "\n" in side else side
    return side.name if isinstance(side, FilePath | ProgramText) else type(side).__name__


def _common(left: _Taken, right: _Taken) -> list[str]:
    common = [axis for axis in left.path.axes if axis in right.path.axes]
    if not common:
        raise UsageError(
            f"{left.side.name} and {right.side.name} have no axis in common",
            hint=f"Axes are {', '.join(left.path.axes)} and {', '.join(right.path.axes)}.",
        )
    return common


def _taken(
    side: Side,
    machine: str | FilePath | MachineConfig | None,
    dialect: str | Dialect | None,
    progress: Progress | None,
) -> _Taken:
    if isinstance(side, str | FilePath) and not _is_program(side):
        return _of_trace(read_trace(side), str(side), None)
    if isinstance(side, Trace):
        return _of_trace(side, "trace", None)
    if isinstance(side, RunResult):
        if side.trace is None:
            raise UsageError(
                f"{side.program} cannot be compared: the result has no trace", hint="Run with trace=True."
            )
        return _of_trace(side.trace, side.program, side)
    text = program_text(side)
    config = RunSettings(machine, dialect).machine_of(text)
    units = tuple(axis.unit for axis in config.axes)
    collector = PathCollector(config.axis_names, units)
    tracks = TrackCollector(units)

    def rows(piece: Floats, tags: Indices, records: BlockRecords) -> None:
        collector.add(piece, tags, records)
        tracks.add(piece, tags, records)

    read = dialect_for(text, dialect)
    result = run_program(text, RunSettings(config, read), check=False, tagged_rows=rows, progress=progress)
    seen = Compared(
        text.name,
        result.machine,
        result.time_s,
        result.path_mm,
        result.extents_mm,
        result.top_feed_mm_min,
        result,
    )
    return _Taken(seen, collector.path(), tracks.track(tracks.execution()), text, read)


def _of_trace(trace: Trace, name: str, result: RunResult | None) -> _Taken:
    path = PathCollector(trace.axes, trace.units).path_of(trace)
    tracks = TrackCollector(trace.units)
    execution = trace.execution or execution_by_lines(trace.block)
    tracks.add_trace(trace, execution)
    seen = Compared(
        name,
        "" if result is None else result.machine,
        float(trace.t_s[-1]) if len(trace) else 0.0,
        path.length() if result is None else result.path_mm,
        _extents(trace) if result is None else result.extents_mm,
        None if result is None else result.top_feed_mm_min,
        result,
    )
    text = None if result is None else result.source
    named = ProgramText.from_text("", name) if text is None else text
    read = dialect_for(named, None if result is None else result.dialect)
    return _Taken(seen, path, tracks.track(execution), text, read)


def _extents(trace: Trace) -> dict[str, tuple[float, float]]:
    if not len(trace):
        return dict.fromkeys(trace.axes, (0.0, 0.0))
    low, high = trace.setpoint.min(axis=0).tolist(), trace.setpoint.max(axis=0).tolist()
    return dict(zip(trace.axes, zip(low, high, strict=True), strict=True))


def _lone(path: Path, common: list[str]) -> tuple[str, ...]:
    """Return the axes that only this path has, and that move in it."""
    return tuple(
        axis
        for column, axis in enumerate(path.axes)
        if axis not in common and np.ptp(path.point[:, column : column + 1]) > THINNING_MM
    )


class _Lines:
    """A path as segments of the axes that are compared."""

    def __init__(self, path: Path, axes: list[str]) -> None:
        self._path = path
        self._axes = axes
        columns = [path.axes.index(axis) for axis in axes]
        self.point = np.ascontiguousarray(path.point[:, columns])
        # A path without motion is a point, if there is one: a segment from it to itself.
        begin = self.point[:-1] if len(self.point) > 1 else self.point
        end = self.point[1:] if len(self.point) > 1 else self.point
        self.start, self.end = begin, end
        self.rapid = path.rapid[1:] if len(self.point) > 1 else path.rapid

    def deviation_from(self, other: _Lines, *, cuts: bool = False) -> PathDeviation:
        """Return how far this path goes from the other; with `cuts` without the rapids of both."""
        mine = ~self.rapid if cuts else np.ones(len(self.start), np.bool_)
        if not mine.any():
            return PathDeviation()
        chosen = np.flatnonzero(mine)
        start, end = self.start[chosen], self.end[chosen]
        step = max(self._path.step, other._path.step)
        to_start, to_end = other._cuts(step) if cuts else (other.start, other.end)
        if not len(to_start):
            return self._at(int(chosen[0]), 0.0, float("inf"))
        distance, segment, share = greatest_distance(start, end, Boxes(to_start, to_end))
        return self._at(int(chosen[segment]), share, distance)

    def order_with(
        self, other: _Lines, reach: float, *, kinds: bool
    ) -> tuple[bool, tuple[tuple[str, int], tuple[str, int]] | None]:
        """Say whether both can be traversed together, and if not, up to which blocks."""
        if not len(self.point) or not len(other.point):
            return len(self.point) == len(other.point), None
        looser = reach + 2.0 * max(self._path.step, other._path.step)  # a rapid ends within one control cycle
        for marked, within in ((False, reach), (True, looser)):
            if kinds or not marked:
                mine, of_mine = self._polyline(within, marked)
                theirs, of_theirs = other._polyline(within, marked)
                same, segment, of_other = in_one_order(mine, theirs, within)
                if not same:
                    return False, (self._block(int(of_mine[segment])), other._block(int(of_theirs[of_other])))
        return True, None

    def _polyline(self, reach: float, marked: bool) -> tuple[Floats, Indices]:
        """Return points, and whose segment each way between them is; if `marked` with rapid and tool as coordinates."""
        own = np.arange(len(self.start))
        points = np.concatenate((self.start[:1], self.end))
        if not marked:
            return points, own
        marks = np.column_stack((self.rapid.astype(np.float64), self._tools())) * (4.0 * reach)
        turns = np.flatnonzero(np.any(np.diff(marks, axis=0) != 0.0, axis=1)) + 1
        lifted = np.concatenate((points, np.concatenate((marks[:1], marks))), axis=1)
        turned = np.concatenate((points[turns], marks[turns]), axis=1)
        return np.insert(lifted, turns + 1, turned, axis=0), np.insert(own, turns, turns)

    def _tools(self) -> Floats:
        tools = self._path.tools.astype(np.float64)
        return tools[1:] if len(self.point) > 1 else tools

    def _cuts(self, step: float) -> tuple[Floats, Floats]:
        """Return the segments that are no rapids, and what of the rapids beside them may belong to them."""
        cut = ~self.rapid
        starts, ends = [self.start[cut]], [self.end[cut]]
        for beside, near, far in (
            (np.flatnonzero(self.rapid[1:] & cut[:-1]) + 1, self.start, self.end),
            (np.flatnonzero(self.rapid[:-1] & cut[1:]), self.end, self.start),
        ):
            way = far[beside] - near[beside]
            length = np.sqrt((way * way).sum(1))
            share = np.minimum(step / np.where(length > 0.0, length, 1.0), 1.0)
            starts.append(near[beside])
            ends.append(near[beside] + share[:, None] * way)
        return np.concatenate(starts), np.concatenate(ends)

    def _at(self, segment: int, share: float, mm: float) -> PathDeviation:
        place = self.start[segment] + share * (self.end[segment] - self.start[segment])
        first = min(segment, len(self._path.t_s) - 1)
        last = min(segment + 1, len(self._path.t_s) - 1)
        t_s = self._path.t_s[first] + share * (self._path.t_s[last] - self._path.t_s[first])
        program, line = self._block(segment)
        position = dict(zip(self._axes, place.tolist(), strict=True))
        return PathDeviation(mm, position, program, line, float(t_s))

    def _block(self, segment: int) -> tuple[str, int]:
        block = self._path.blocks[self._path.number[min(segment + 1, len(self._path.number) - 1)]]
        return block.program, block.line
