"""Time the look-ahead over short lines: all at once, and as a stream with a window of 256 segments.

All at once means limits and the backward pass (`prepare_path`), then the forward pass along all segments (`skip`).
And how long the planned paths take, against an exact stop at every line.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from functools import partial

import numpy as np
import numpy.typing as npt

from _measure import Figure, at_least, at_most
from _programs import contour
from _report import run_script
from polycnc.kernel import (
    STOP,
    AxisLimits,
    KernelState,
    Paths,
    append_line,
    entry,
    prepare_path,
    skip,
    start_path,
)
from polycnc.kernel._segments import Segments
from polycnc.machine import Machine, load_machine

Floats = npt.NDArray[np.float64]

WINDOW = 256
SPEED_MM_S = 100.0
RUNS = 5


@entry
def append_points(
    seg: Segments, paths: Paths, limits: AxisLimits, points: Floats, first: int, last: int, speed: float
) -> None:
    """Append lines to points `first` up to `last` to path 0."""
    for i in range(first, last):
        append_line(seg, paths, 0, limits, points[i], speed, 0, i)


def started(slots: int, depth: int, points: Floats) -> KernelState:
    """Return a machine that stands at the first point with its path started."""
    state = Machine(load_machine("mill3"), segments=slots).state
    state.paths.row["depth"] = depth
    state.paths.position[0] = state.paths.queued[0] = points[0]
    start_path(state.paths, 0)
    return state


def all_at_once(points: Floats) -> tuple[float, float]:
    """Return the time of preparing all lines, and of going along them."""
    state = started(len(points) + 8, 0, points)
    append_points(state.seg, state.paths, state.limits, points, 1, len(points), SPEED_MM_S)
    state.paths.row["closed"] = 1
    begin = time.process_time()
    prepare_path(state.seg, state.paths, 0, state.limits, 0.001, state.work)
    prepared = time.process_time()
    skip(state, 0, len(points))
    end = time.process_time()
    assert state.paths.row[0]["head"] == state.paths.row[0]["tail"] > 0
    return prepared - begin, end - prepared


def streamed(points: Floats, depth: int, piece: int) -> float:
    """Return the time of the look-ahead when lines come in pieces and run as soon as the window allows."""
    state = started(1 << 14, depth, points)
    row = state.paths.row[0]
    spent = 0.0
    for first in range(1, len(points), piece):
        last = min(first + piece, len(points))
        append_points(state.seg, state.paths, state.limits, points, first, last, SPEED_MM_S)
        row["closed"] = last == len(points)
        begin = time.process_time()
        prepare_path(state.seg, state.paths, 0, state.limits, 0.001, state.work)
        skip(state, 0, int(row["tail"]) - (0 if row["closed"] else WINDOW))
        spent += time.process_time() - begin
    assert row["head"] == row["tail"] > 0
    return spent


def path_time(points: Floats, *, stops: bool) -> int:
    """Return the cycles that the lines take, at rest after each of them if `stops`."""
    state = started(len(points) + 8, 0, points)
    append_points(state.seg, state.paths, state.limits, points, 1, len(points), SPEED_MM_S)
    if stops:
        state.seg.row["flags"] |= STOP
    state.paths.row["closed"] = 1
    prepare_path(state.seg, state.paths, 0, state.limits, 0.001, state.work)
    return skip(state, 0, len(points))


def against_stopping(points: Floats) -> float:
    """Return the time of a path by that with an exact stop at every line."""
    return path_time(points, stops=False) / path_time(points, stops=True)


def stairs(steps: int) -> Floats:
    """Return stairs of 1 mm in X and Y."""
    points = np.zeros((2 * steps + 1, 3))
    points[1::2, 0] = points[2::2, 0] = np.arange(1, steps + 1)
    points[1:, 1] = np.arange(2 * steps) // 2
    points[2::2, 1] += 1.0
    return points


def scribble(rng: np.random.Generator, lines: int) -> Floats:
    """Return lines of some tenths of a millimetre that turn at random."""
    steps = np.column_stack([rng.normal(size=(lines, 2)) * 0.3, np.zeros(lines)])
    return np.vstack([np.zeros(3), np.cumsum(steps, axis=0)])


def _whole_time(points: Floats) -> float:
    return sum(all_at_once(points))


def median(work: Callable[[], float]) -> float:
    """Return the median of several results, after one that is not counted."""
    return statistics.median([work() for _ in range(RUNS + 1)][1:])


def figures(quick: bool) -> list[Figure]:
    """Measure and return the figures."""
    size = 50_000 if quick else 400_000
    points = contour(np.random.default_rng(1), 0, size + 1)
    all_at_once(points[:1000])
    per_s = {}
    for part in (size // 16, size // 4, size):
        per_s[part] = part / median(partial(_whole_time, points[: part + 1]))
    backward = size / median(lambda: all_at_once(points)[0])
    stream = size / median(lambda: streamed(points, WINDOW, WINDOW))
    single = (size // 8) / median(lambda: streamed(points[: size // 8 + 1], WINDOW, 1))
    spread = max(per_s.values()) / min(per_s.values())
    return [
        at_least("all at once, both passes", per_s[size], "segments/s", 3e6),
        Figure("all at once, limits and backward pass", backward, "segments/s"),
        at_most(f"fastest to slowest of {', '.join(f'{n:,}' for n in per_s)}", spread, "x", 1.5),
        at_least(f"streamed, window {WINDOW}, in pieces of {WINDOW}", stream, "segments/s", 0.3e6),
        Figure(f"streamed, window {WINDOW}, one by one from Python", single, "segments/s"),
        at_most("time of stairs of 1 mm, against stopping", against_stopping(stairs(100)), "x", 1.0),
        at_most(
            "time of a scribble, against stopping",
            against_stopping(scribble(np.random.default_rng(3), 1500)),
            "x",
            1.0,
        ),
        at_most("time of a contour, against stopping", against_stopping(points[:15_001]), "x", 1.0),
    ]


if __name__ == "__main__":
    run_script("Look-ahead", figures)
