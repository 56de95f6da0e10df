"""Lay out the picture of a run and write it to a file."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from polycnc.errors import UsageError
from polycnc.outputs import check_output, complete_or_absent, format_of
from polycnc.runner._blocks import execution_by_lines
from polycnc.runner._outcome import RunOutcome, counted, time_text
from polycnc.runner.plots._over_time import draw_positions, draw_speed
from polycnc.runner.plots._paths import draw_legend, draw_perspective, draw_plan
from polycnc.runner.plots._scene import Scene, scene
from polycnc.runner.plots._solid import draw_solid
from polycnc.runner.view._track import Track, TrackCollector
from polycnc.stock import Stock

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PLOT_FORMATS = (".png", ".svg", ".pdf")
_SIZE_INCH = (12.0, 9.0)
_ROW_INCH = 1.5  # each row of an axis over time makes the picture so much higher
_MOST_LETTERS = 48  # of a program's name in the title


def check_plot_file(path: str | Path) -> Path:
    """Return the path of a plot that could be written there.

    Raises:
        UsageError: an unknown extension, no such folder, or matplotlib is not installed.
    """
    checked = check_output(path, PLOT_FORMATS, "a plot")
    _figure_class()
    return checked


def plot(result: RunOutcome, path: str | Path | None = None) -> Figure:
    """Draw `result`, which must hold a trace, to a .png, .svg or .pdf file; return the matplotlib figure.

    Without a path nothing is written.

    Raises:
        UsageError: no trace, an unknown extension, no such folder, or matplotlib is not installed.
    """
    trace = result.trace
    if trace is None:
        raise UsageError("there is nothing to plot: the result has no trace", hint="Run with trace=True.")
    _figure_class()
    collector = TrackCollector(trace.units)
    execution = trace.execution or execution_by_lines(trace.block)
    collector.add_trace(trace, execution)
    axes = tuple(zip(trace.axes, trace.units, strict=True))
    return plot_track(result, axes, collector.track(execution), path)


def plot_track(
    result: RunOutcome, axes: tuple[tuple[str, str], ...], track: Track, path: str | Path | None = None
) -> Figure:
    """Draw the track of a result, as `plot` does; `axes` are names and units.

    Raises:
        UsageError: an unknown extension, no such folder, or matplotlib is not installed.
    """
    target = None if path is None else check_plot_file(path)
    figure = _figure(result, axes, track)
    if target is not None:
        import matplotlib

        extension = format_of(target, PLOT_FORMATS)
        undated = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}.get(extension)
        with (
            complete_or_absent(target) as partial,
            matplotlib.rc_context({"svg.hashsalt": "polycnc"}),
            warnings.catch_warnings(),
        ):
            warnings.filterwarnings(
                "ignore", "Glyph .* missing"
            )  # names in any script; a box stands for a sign
            figure.savefig(partial, dpi=150, metadata=undated, format=extension[1:])
    return figure


def _figure_class() -> type[Figure]:
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise UsageError("a plot needs matplotlib", hint="Install it: pip install 'polycnc[plot]'.") from None
    return Figure


def _figure(result: RunOutcome, axes: tuple[tuple[str, str], ...], track: Track) -> Figure:
    width, height = _SIZE_INCH
    figure = _figure_class()(figsize=(width, height), layout="constrained")
    figure.suptitle(_title(result), parse_math=False)
    if not len(track.t_s) or all(low == high for low, high in result.extents_mm.values()):
        figure.text(0.5, 0.5, "The program moves no axis.", ha="center", size="x-large")
        return figure
    shown = scene(track, axes, result.config)
    dimensions = shown.points.shape[1]
    over_time = _over_time(track, axes, shown)
    figure.set_size_inches(width, height + _ROW_INCH * max(len(over_time) - 1, 0))
    ratios = ([3.0] if dimensions > 1 else []) + [1.4] + [0.9] * len(over_time)
    grid = figure.add_gridspec(len(ratios), 2, height_ratios=ratios)
    if dimensions > 1:
        draw_plan(figure.add_subplot(grid[0, 0] if dimensions == 3 else grid[0, :]), shown)
        if dimensions == 3:
            axes_3d = figure.add_subplot(grid[0, 1], projection="3d")
            machined = result.machined
            if machined is not None and isinstance(machined.stock, Stock):
                draw_solid(axes_3d, machined.stock, machined.zero_mm)
            else:
                draw_perspective(axes_3d, shown)
        draw_legend(figure, shown, result.operations)
    row = int(dimensions > 1)
    speed = figure.add_subplot(grid[row, :])
    draw_speed(speed, shown, any(unit == "deg" for _, unit in axes))
    for number, columns in enumerate(over_time, start=row + 1):
        speed.tick_params(labelbottom=False)
        below = figure.add_subplot(grid[number, :], sharex=speed)
        draw_positions(below, track, axes, columns)
        below.tick_params(labelbottom=number == len(ratios) - 1)
    figure.axes[-1].set_xlabel("time [s]")
    return figure


def _title(result: RunOutcome) -> str:
    name = Path(result.program).name.encode("utf-8", "replace").decode()
    if len(name) > _MOST_LETTERS:
        name = f"{name[: _MOST_LETTERS - 13]}…{name[-12:]}"
    parts = (name, f"on {result.machine}", time_text(result.time_s))
    return "    ".join((*parts, f"{result.path_mm:,.0f} mm", f"{counted(result.blocks, 'block')}"))


def _over_time(track: Track, axes: tuple[tuple[str, str], ...], shown: Scene) -> list[list[int]]:
    """Return which axes to draw over time, row by row: those that the path does not show, if they move."""
    linear = [i for i, (_, unit) in enumerate(axes) if unit == "mm"]
    drawn = linear[:3] if len(linear) >= 3 and not shown.on_part else []
    together = [] if drawn else linear[: 3 if shown.on_part else 2]
    rows = [[i] for i in range(len(axes)) if i not in drawn and i not in together]
    rows = [row for row in rows if np.ptp(track.position[:, row[0]]) > 0.0]
    return rows if drawn else [together, *rows]
