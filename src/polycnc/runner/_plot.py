"""Draw a run: the path from above and in perspective, rapids apart from cuts, speed and axes over time."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from polycnc.errors import UsageError
from polycnc.kernel import LEADING
from polycnc.machine import MachineConfig
from polycnc.outputs import check_output, complete_or_absent, format_of
from polycnc.runner._result import RunResult, Trace, counted, time_text
from polycnc.runner._trace import TraceCollector

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Floats = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]

PLOT_FORMATS = (".png", ".svg", ".pdf")
_MOST_ROWS = 200_000
_MOST_MARKS = 5_000
_CUT = "#1f5fa8"
_RAPID = "#d08a2b"
_END = "#1b2228"
_MARGIN = 0.15  # of the larger side of the cuts: how much of the rapids around them is drawn
_CALM = 2.0  # rapids that are faster than so many times the fastest cut leave the picture of the speed
_SIZE_INCH = (12.0, 9.0)
_ROW_INCH = 1.5  # each row of an axis over time makes the picture so much higher


class PlotCollector:
    """Collect what a plot needs of a record of any length: every n-th row, n growing with the record."""

    def __init__(self, config: MachineConfig) -> None:
        self.config = config
        self._pieces: list[Floats] = []
        self._held = 0
        self._stride = 1
        self._next = 0  # rows to leave out before the next one that is kept
        self._last: Floats | None = None

    def add(self, rows: Floats) -> None:
        """Take a piece of the record."""
        kept = rows[self._next :: self._stride].copy()
        self._next = (self._next - len(rows)) % self._stride
        self._pieces.append(kept)
        self._last = rows[-1:].copy() if len(rows) else self._last
        self._held += len(kept)
        while self._held > 2 * _MOST_ROWS:
            thinned = np.concatenate(self._pieces)[::2]
            self._pieces, self._held = [thinned], len(thinned)
            self._stride *= 2

    def with_trace(self, result: RunResult) -> RunResult:
        """Return `result` with the collected rows, and the last row in any case, as its trace."""
        width = len(self.config.axes)
        pieces = self._pieces + ([self._last] if self._last is not None and self._stride > 1 else [])
        collector = TraceCollector(self.config, any(piece.shape[1] > LEADING + width for piece in pieces))
        for piece in pieces:
            collector.add(piece)
        return replace(result, trace=collector.trace())


def check_plot_file(path: str | Path) -> Path:
    """Return the path of a plot that could be written there.

    Raises:
        UsageError: an unknown extension, no such folder, or matplotlib is not installed.
    """
    checked = check_output(path, PLOT_FORMATS, "a plot")
    _figure_class()
    return checked


def plot(result: RunResult, path: str | Path | None = None) -> Figure:
    """Draw `result`, which must hold a trace, to a .png, .svg or .pdf file; return the matplotlib figure.

    Without a path nothing is written.

    Raises:
        UsageError: no trace, an unknown extension, no such folder, or matplotlib is not installed.
    """
    if result.trace is None:
        raise UsageError("there is nothing to plot: the result has no trace", hint="Run with trace=True.")
    target = None if path is None else check_plot_file(path)
    figure = _figure(result, result.trace)
    if target is not None:
        import matplotlib

        extension = format_of(target, PLOT_FORMATS)
        undated = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}.get(extension)
        with complete_or_absent(target) as partial, matplotlib.rc_context({"svg.hashsalt": "polycnc"}):
            figure.savefig(partial, dpi=150, metadata=undated, format=extension[1:])
    return figure


def _figure_class() -> type[Figure]:
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise UsageError("a plot needs matplotlib", hint="Install it: pip install 'polycnc[plot]'.") from None
    return Figure


def _figure(result: RunResult, trace: Trace) -> Figure:
    linear = [i for i, unit in enumerate(trace.units) if unit == "mm"]
    solid = len(linear) >= 3
    width, height = _SIZE_INCH
    figure = _figure_class()(figsize=(width, height), layout="constrained")
    figure.suptitle(_title(result), parse_math=False)
    if not len(trace) or all(low == high for low, high in result.extents_mm.values()):
        figure.text(0.5, 0.5, "The program moves no axis.", ha="center", size="x-large")
        return figure
    over_time = _over_time(trace, linear)
    figure.set_size_inches(width, height + _ROW_INCH * max(len(over_time) - 1, 0))
    has_plan = len(linear) >= 2
    ratios = ([3.0] if has_plan else []) + [1.4] + [0.9] * len(over_time)
    grid = figure.add_gridspec(len(ratios), 2, height_ratios=ratios)
    if has_plan:
        view = _view(trace, linear[:3])
        _plan(figure.add_subplot(grid[0, 0] if solid else grid[0, :]), trace, view)
        if solid:
            _perspective(figure.add_subplot(grid[0, 1], projection="3d"), trace, view)
    row = int(has_plan)
    speed = figure.add_subplot(grid[row, :])
    _speed(speed, trace)
    for number, columns in enumerate(over_time, start=row + 1):
        speed.tick_params(labelbottom=False)
        axes = figure.add_subplot(grid[number, :], sharex=speed)
        _positions(axes, trace, columns)
        axes.tick_params(labelbottom=number == len(ratios) - 1)
    figure.axes[-1].set_xlabel("time [s]")
    return figure


def _title(result: RunResult) -> str:
    parts = (Path(result.program).name, f"on {result.machine}", time_text(result.time_s))
    return "    ".join((*parts, f"{result.path_mm:,.0f} mm", f"{counted(result.blocks, 'block')}"))


def _over_time(trace: Trace, linear: list[int]) -> list[list[int]]:
    """Return which axes to draw over time, row by row: those that the views do not show, if they move."""
    shown = linear[:3] if len(linear) >= 3 else []
    rows = [[i] for i in range(len(trace.axes)) if i not in shown and i not in linear[:2]]
    rows = [row for row in rows if np.ptp(trace.setpoint[:, row[0]]) > 0.0]
    return rows if shown else [linear[:2], *rows]


@dataclass(frozen=True)
class _View:
    """The part of space that is drawn: the cuts and a margin; where nothing is cut, everything."""

    columns: list[int]
    low: Floats
    high: Floats
    points: Floats  # [rows, columns]
    moving_cut: Flags

    def seen(self, columns: list[int]) -> Floats:
        """Return some columns of the points, NaN where one of them is outside."""
        points, low, high = self.points[:, columns], self.low[columns], self.high[columns]
        outside = np.any((points < low) | (points > high), axis=1)
        return np.where(outside[:, None], np.nan, points)


def _view(trace: Trace, columns: list[int]) -> _View:
    points = trace.setpoint[:, columns]
    moves = np.concatenate(([False], np.any(np.diff(points, axis=0) != 0.0, axis=1)))
    moving_cut = ~trace.rapid & moves
    inside = points[moving_cut] if moving_cut.any() else points
    low, high = inside.min(axis=0), inside.max(axis=0)
    margin = _MARGIN * float(np.max(high - low))
    if margin <= 0.0:
        low, high = points.min(axis=0), points.max(axis=0)
        margin = max(_MARGIN * float(np.max(high - low)), 0.5)
    low, high = np.maximum(low - margin, points.min(axis=0)), np.minimum(high + margin, points.max(axis=0))
    flat = high - low < 2.0 * margin * _MARGIN
    low, high = np.where(flat, low - margin, low), np.where(flat, high + margin, high)
    return _View(columns, low, high, points, moving_cut)


def _stretches(rapid: Flags) -> list[tuple[int, int, bool]]:
    """Return the stretches of equal kind as (first row, last row, is rapid).

    Each begins where the one before has ended.
    """
    edges = np.flatnonzero(np.diff(rapid.astype(np.int8))) + 1
    bounds = [0, *edges.tolist(), len(rapid)]
    return [(max(first - 1, 0), last, bool(rapid[first])) for first, last in pairwise(bounds)]


def _draw_path(axes: Any, trace: Trace, points: Floats) -> None:
    """Draw cuts and rapids, each as one line with gaps."""
    gap = np.full((1, points.shape[1]), np.nan)
    parts: dict[bool, list[Floats]] = {True: [], False: []}
    for first, last, rapid in _stretches(trace.rapid):
        parts[rapid] += [points[first:last], gap]
    styles: dict[bool, dict[str, Any]] = {
        True: {"color": _RAPID, "linewidth": 0.8, "linestyle": (0, (4, 3)), "label": "rapid"},
        False: {"color": _CUT, "linewidth": 1.1, "label": "cut"},
    }
    for rapid, pieces in parts.items():
        if pieces:
            axes.plot(*np.concatenate(pieces).T, **styles[rapid])
    _draw_ends(axes, points)


def _draw_ends(axes: Any, points: Floats) -> None:
    """Mark where the path begins and where it ends, if that is in the picture."""
    for place, marker, label in ((points[:1], ">", "start"), (points[-1:], "X", "end")):
        if not np.isnan(place).any():
            axes.plot(
                *place.T,
                linestyle="none",
                marker=marker,
                markersize=7,
                color=_END,
                markeredgecolor="white",
                markeredgewidth=0.6,
                label=label,
                zorder=5,
            )


def _plan(axes: Axes, trace: Trace, view: _View) -> None:
    first, second = 0, 1
    if len(view.columns) == 2 and trace.axes[view.columns[0]] == "X":
        first, second = 1, 0  # a lathe is drawn with Z to the right
    points = view.seen([first, second])
    _draw_path(axes, trace, points)
    stays = np.concatenate(([False], np.all(np.diff(points, axis=0) == 0.0, axis=1)))
    plunges = np.unique(points[view.moving_cut & stays], axis=0)[:_MOST_MARKS]
    if len(plunges):
        axes.plot(
            *plunges.T,
            linestyle="none",
            marker="o",
            markersize=4,
            color=_CUT,
            fillstyle="none",
            label="plunge",
        )
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel(_label(trace, view.columns[first]))
    axes.set_ylabel(_label(trace, view.columns[second]))
    low, high = _framed(view)
    axes.update_datalim([(low[first], low[second]), (high[first], high[second])])
    axes.margins(0.0)
    axes.autoscale_view()
    axes.set_title("Plan view" if len(view.columns) > 2 else "Path", loc="left")
    axes.grid(alpha=0.3)
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=5, frameon=False, fontsize="small")


def _perspective(axes: Any, trace: Trace, view: _View) -> None:
    from matplotlib.ticker import MaxNLocator

    _draw_path(axes, trace, view.seen([0, 1, 2]))
    low, high = _framed(view)
    sides = np.maximum(high - low, 0.3 * np.max(high - low))
    for name, column, side, first, last in zip("xyz", view.columns, sides, low, high, strict=True):
        getattr(axes, f"set_{name}label")(_label(trace, column))
        getattr(axes, f"set_{name}lim")(first, last)
        ticks = 3 + int(4 * side / np.max(sides))
        getattr(axes, f"{name}axis").set_major_locator(MaxNLocator(ticks))
    axes.set_box_aspect(sides, zoom=0.85)
    axes.set_title("Perspective", loc="left")


def _framed(view: _View) -> tuple[Floats, Floats]:
    """Return the limits of the drawing: the view with a little room around it."""
    room = 0.03 * np.max(view.high - view.low)
    return view.low - room, view.high + room


def _speed(axes: Axes, trace: Trace) -> None:
    speed = trace.feed_mm_s * 60.0
    unit = "mm/min" if "deg" not in trace.units else "mm/min or deg/min"
    for rapid, color, width in ((True, _RAPID, 0.6), (False, _CUT, 1.0)):
        # A stretch goes up from the rest it begins with and down to the rest it ends with.
        kind = (trace.rapid == rapid) & ((speed > 0.0) | np.roll(speed > 0.0, 1))
        axes.plot(trace.t_s, np.where(kind, speed, np.nan), color=color, linewidth=width)
    title = "Speed"
    highest = float(speed.max())
    cut = float(np.max(speed, where=~trace.rapid, initial=0.0))
    if 0.0 < _CALM * cut < highest:
        title += f"    (rapids leave the picture: they reach {highest:,.0f} {unit})"
        highest = cut
    axes.set_ylim(0.0, 1.2 * highest if highest > 0.0 else 1.0)
    axes.yaxis.set_major_formatter("{x:,.0f}")
    axes.set_ylabel(f"path speed [{unit}]")
    axes.set_title(title, loc="left")
    end = float(trace.t_s[-1])
    axes.set_xlim(-0.01 * end, 1.01 * end)
    axes.grid(alpha=0.3)


def _positions(axes: Axes, trace: Trace, columns: list[int]) -> None:
    for column in columns:
        axes.plot(trace.t_s, trace.setpoint[:, column], linewidth=0.9, label=_label(trace, column))
    if len(columns) == 1:
        axes.set_ylabel(_label(trace, columns[0]))
    else:
        axes.set_ylabel("position [mm]")
        axes.legend(loc="upper left", fontsize="small")
    axes.grid(alpha=0.3)


def _label(trace: Trace, column: int) -> str:
    return f"{trace.axes[column]} [{trace.units[column]}]"
