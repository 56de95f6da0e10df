"""Time what tools cut out of stock: sweeps of a finishing pass, and chords of a record."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
import numpy.typing as npt

from _measure import Figure, at_most, median_s
from _report import run_script
from polycnc.stock import Box, Course, Cutting, Rows, Stock, Tool, ToolKind

SIDE_MM, CELL_MM, STEP_MM, OVER_MM = 100.0, 0.1, 0.1, 0.2
TOOLS = {
    "flat": Tool(ToolKind.FLAT, 6.0),
    "ball": Tool(ToolKind.BALL, 6.0),
    "bull-nosed": Tool(ToolKind.BULL, 6.0, corner_mm=1.0),
}
MILLION_S = 20.0


def record(ways: int, height: Callable[[npt.NDArray[np.float64], npt.NDArray[np.float64]], object]) -> Rows:
    """Return a record that goes to and fro over a surface, with so many ways of 0.1 mm."""
    across = int(SIDE_MM / STEP_MM)
    n = np.arange(ways + 1)
    row, at = n // across, n % across
    x = STEP_MM * np.where(row % 2, across - 1 - at, at).astype(np.float64)
    y = OVER_MM * row.astype(np.float64) % SIDE_MM
    tip = np.column_stack((x, y, np.broadcast_to(np.asarray(height(x, y)), x.shape)))
    ones = np.ones(len(n), np.int64)
    t_s = np.linspace(0.001, 0.001 * len(n), len(n), dtype=np.float64)
    return Rows(t_s, tip, n, ones, np.zeros(len(n), np.bool_), np.ones(len(n), np.bool_))


def cut(rows: Rows, tool: Tool) -> None:
    """Cut a block of 100 x 100 mm."""
    cutting = Cutting(Stock(Box((0.0, 0.0, -20.0), (SIDE_MM, SIDE_MM, 0.0)), CELL_MM), {1: tool})
    cutting.add(rows)


def figures(quick: bool) -> list[Figure]:
    """Measure and return the figures."""
    ways = 20_000 if quick else 200_000
    wave = record(ways, lambda x, y: -5.0 + 2.0 * np.sin(x / 10.0) * np.cos(y / 7.0))
    found = []
    for name, tool in TOOLS.items():
        seconds = median_s(partial(cut, wave, tool), 1 if quick else 3) / ways * 1e6
        title = f"a million ways of 0.1 mm, {name}, 6 mm, cells of 0.1 mm"
        found.append(at_most(title, seconds, "s", MILLION_S))
    seconds = median_s(lambda: Course().add(wave), 3)
    return [*found, Figure("rows of a record to chords", ways / seconds / 1e6, "M/s")]


if __name__ == "__main__":
    run_script("Stock", figures)
