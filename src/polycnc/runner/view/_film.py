"""A body while it is cut, as a view shows it: its cells at first, and what changes from one moment to the next."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from polycnc.runner._machined import Machined
from polycnc.runner.view._watched import Floats, Levels, Places, Watched, watched
from polycnc.stock import Rows

MOST_CHANGES = 3_000_000
_STEPS = 1500


@dataclass(frozen=True, eq=False)
class Film:
    """Hold the cells of a body, each with a level, and their changes in the order of time.

    `kind` is "field" [ny, nx] with heights above its bottom, "turned" [2, nz] with outer and inner radii, or "solid"
    [nz, ny, nx] with the share of a cell that is full. `first_mm` is the middle of the first cell (of a field: on its
    bottom); a level is worth `level`. `ends` [steps] are times (s); of each step `counts` cells get new `levels`;
    `cells` are their flat places.
    """

    kind: str
    first_mm: tuple[float, float, float]
    cell_mm: float
    level: float
    begin: Levels
    ends: Floats
    counts: Places
    cells: Places
    levels: Levels


def film_of(machined: Machined) -> Film:
    """Return the film of a body that has been cut, with as many cells as a page can bear."""
    coarser = 1
    while True:
        body, cuts = watched(machined, coarser)
        film = _film(machined.course, body, cuts)
        if film is not None:
            return film
        coarser *= 2


def _film(course: Rows, body: Watched, cut: Callable[[int, int], None]) -> Film | None:
    """Cut a body once more, step by step; None if that has more changes than a page can bear."""
    begin = body.begin.copy()
    step_s = max(float(course.t_s[-1]) / _STEPS, 1e-3) if len(course.t_s) else 1.0
    bounds = np.flatnonzero(np.diff(np.floor(course.t_s / step_s), prepend=-1.0, append=np.inf))
    ends, counts, all_cells, all_levels = [], [], [], []
    total = 0
    for first, last in zip(bounds[:-1].tolist(), bounds[1:].tolist(), strict=True):
        cut(first, last)
        cells, levels = body.changes(course, max(first - 1, 0), last)
        if not len(cells):
            continue
        ends.append(float(course.t_s[last - 1]))
        counts.append(len(cells))
        all_cells.append(cells)
        all_levels.append(levels)
        total += len(cells)
        if total > MOST_CHANGES:
            return None
    return Film(
        body.kind,
        body.first_mm,
        body.cell_mm,
        body.level,
        begin,
        np.array(ends, np.float64),
        np.array(counts, np.int32),
        np.concatenate([np.zeros(0, np.int32), *all_cells]),
        np.concatenate([np.zeros(0, np.uint16), *all_levels]),
    )
