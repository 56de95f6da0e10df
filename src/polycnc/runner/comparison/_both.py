"""Both paths of a comparison in one view."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path as FilePath

from polycnc.runner._result import RunResult
from polycnc.runner.comparison._compared import Compared, PathDeviation
from polycnc.runner.view import Beside, Mark, Track, View, page


def view_of_both(
    sides: tuple[Compared, Compared],
    ways: tuple[PathDeviation, PathDeviation],
    axes: tuple[tuple[str, str], ...],
    tracks: tuple[Track, Track],
    track_axes: tuple[tuple[str, ...], tuple[str, ...]],
) -> View:
    """Return a page with path A, its blocks and times, path B beside it, and the greatest deviations marked.

    `ways` are the greatest deviations of A from B and of B from A; the tracks have the axes `track_axes`, and those
    that both have are `axes`.
    """
    texts = ("A is farthest from B", "B is farthest from A")
    marks = [
        _mark(text, found, axes, own=found is ways[0])
        for text, found in zip(texts, ways, strict=True)
        if found.mm
    ]
    a, b = sides
    own, beside = (_of_axes(track, names, axes) for track, names in zip(tracks, track_axes, strict=True))
    html = page(_result_of(a), axes, own, {}, Beside(_name(b), _name(a), beside, tuple(marks)))
    inputs = tuple(FilePath(each.name) for each in sides if "\0" not in each.name)
    return View(html, _result_of(a), inputs)


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
