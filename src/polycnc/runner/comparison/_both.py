"""Both paths of a comparison in one view."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path as FilePath

from polycnc.nc import ProgramText
from polycnc.runner._result import RunResult
from polycnc.runner.comparison._compare import Compared, Comparison, PathDeviation
from polycnc.runner.view import Beside, Mark, Track, View, page


def view_of_comparison(comparison: Comparison) -> View:
    """Return a page with path A, its blocks and times, path B beside it, and the greatest deviations marked."""
    axes = comparison.axes
    marks = [
        _mark("A is farthest from B", comparison.a_from_b, axes, own=True),
        _mark("B is farthest from A", comparison.b_from_a, axes, own=False),
    ]
    marks = [
        mark
        for mark, found in zip(marks, (comparison.a_from_b, comparison.b_from_a), strict=True)
        if found.mm
    ]
    result = _result_of(comparison.a)
    both = zip(comparison.tracks, comparison.track_axes, strict=True)
    own, beside = (_of_axes(track, names, axes) for track, names in both)
    shown = Beside(_name(comparison.b), _name(comparison.a), beside, tuple(marks))
    texts: dict[str, ProgramText] = {}
    html = page(result, axes, own, texts, shown)
    inputs = tuple(FilePath(each.name) for each in (comparison.a, comparison.b) if "\0" not in each.name)
    return View(html, result, inputs)


def _name(side: Compared) -> str:
    """Return file and machine of a side; a trace has no machine."""
    name = FilePath(side.name).name if "\0" not in side.name else side.name
    return f"{name} on {side.machine}" if side.machine else name


def _mark(what: str, found: PathDeviation, axes: tuple[tuple[str, str], ...], *, own: bool) -> Mark:
    line = f", line {found.line}" if found.line else ""
    place = tuple(found.position.get(axis, 0.0) for axis, _ in axes)
    return Mark(f"{what}: {found.mm:.4f} mm{line}", place, found.time_s if own else None)


def _of_axes(track: Track, names: tuple[str, ...], axes: tuple[tuple[str, str], ...]) -> Track:
    """Return a track with some of its axes only."""
    columns = [names.index(axis) for axis, _ in axes]
    return replace(track, position=track.position[:, columns])


def _result_of(side: Compared) -> RunResult:
    """Return the result of a run, or what a trace tells of one."""
    if side.result is not None:
        return side.result
    return RunResult(
        program=side.name,
        dialect="",
        machine="trace",
        blocks=0,
        cycles=0,
        time_s=side.time_s,
        cutting_time_s=0.0,
        rapid_time_s=0.0,
        waiting_time_s=0.0,
        cutting_path_mm=side.path_mm,
        rapid_path_mm=0.0,
        top_feed_mm_min=side.top_feed_mm_min or 0.0,
        axis_units={},
        end_position_mm={},
        extents_mm=side.extents_mm,
        alarms=[],
        messages=[],
        tool_times={},
        events=[],
    )
