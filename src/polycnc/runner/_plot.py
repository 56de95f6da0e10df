"""Draw a run: the path from above and in perspective, rapids apart from cuts, and the speed over time."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from polycnc.errors import UsageError
from polycnc.kernel import LEADING
from polycnc.machine import MachineConfig
from polycnc.runner._result import RunResult
from polycnc.runner._trace import TraceCollector

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Floats = npt.NDArray[np.float64]

_MOST_ROWS = 200_000
_CUT = "#1f5fa8"
_RAPID = "#d08a2b"
_FORMATS = (".png", ".svg", ".pdf")


class PlotCollector:
    """Collect what a plot needs of a record of any length: every n-th row, n growing with the record."""

    def __init__(self, config: MachineConfig) -> None:
        self.config = config
        self._pieces: list[Floats] = []
        self._held = 0
        self._stride = 1
        self._next = 0  # rows to leave out before the next one that is kept

    def add(self, rows: Floats) -> None:
        """Take a piece of the record."""
        kept = rows[self._next :: self._stride].copy()
        self._next = (self._next - len(rows)) % self._stride
        self._pieces.append(kept)
        self._held += len(kept)
        if self._held > 2 * _MOST_ROWS:
            thinned = np.concatenate(self._pieces)[::2]
            self._pieces, self._held = [thinned], len(thinned)
            self._stride *= 2

    def with_trace(self, result: RunResult) -> RunResult:
        """Return `result` with the collected rows as its trace."""
        width = len(self.config.axes)
        collector = TraceCollector(
            self.config, any(piece.shape[1] > LEADING + width for piece in self._pieces)
        )
        for piece in self._pieces:
            collector.add(piece)
        return replace(result, trace=collector.trace())


def plot(result: RunResult, path: str | Path) -> None:
    """Draw `result`, which must hold a trace, to a .png, .svg or .pdf file.

    Raises:
        UsageError: no trace, an unknown extension, or matplotlib is not installed.
    """
    path = Path(path)
    if result.trace is None or not len(result.trace):
        raise UsageError("there is nothing to plot: the result has no trace", hint="Run with trace=True.")
    if path.suffix.lower() not in _FORMATS:
        raise UsageError(f"a plot cannot be written as '{path.suffix}'", hint=f"Use {', '.join(_FORMATS)}.")
    figure = _figure(result)
    figure.savefig(path, dpi=150)


def _figure(result: RunResult) -> Figure:
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise UsageError("a plot needs matplotlib", hint="Install it: pip install 'polycnc[plot]'.") from None
    trace = result.trace
    assert trace is not None
    linear = [i for i, unit in enumerate(trace.units) if unit == "mm"]
    figure = Figure(figsize=(12.0, 9.0), layout="constrained")
    grid = figure.add_gridspec(2, 2, height_ratios=(2.0, 1.0))
    figure.suptitle(
        f"{Path(result.program).name}   on {result.machine}   {_clock(result.time_s)}   "
        f"{result.path_mm:,.0f} mm   {result.blocks:,} blocks"
    )
    _plan(figure.add_subplot(grid[0, 0]), result, linear)
    if len(linear) >= 3:
        _perspective(figure.add_subplot(grid[0, 1], projection="3d"), result, linear)
    else:
        _positions(figure.add_subplot(grid[0, 1]), result)
    _speed(figure.add_subplot(grid[1, :]), result)
    return figure


def _runs(rapid: npt.NDArray[np.bool_]) -> list[tuple[int, int, bool]]:
    """Return the stretches of equal kind as (first row, last row, is rapid); each begins where the last one ended."""
    edges = np.flatnonzero(np.diff(rapid.astype(np.int8))) + 1
    bounds = [0, *edges.tolist(), len(rapid)]
    return [
        (max(first - 1, 0), last, bool(rapid[first]))
        for first, last in zip(bounds[:-1], bounds[1:], strict=True)
    ]


def _by_kind(result: RunResult, columns: list[int]) -> dict[bool, Floats]:
    """Return the path of `columns` for cuts (False) and rapids (True), stretches parted by rows of NaN."""
    trace = result.trace
    assert trace is not None
    points = trace.setpoint[:, columns]
    gap = np.full((1, len(columns)), np.nan)
    parts: dict[bool, list[Floats]] = {False: [], True: []}
    for first, last, rapid in _runs(trace.rapid):
        parts[rapid] += [points[first:last], gap]
    return {kind: np.concatenate(pieces) for kind, pieces in parts.items() if pieces}


def _draw(axes: Any, paths: dict[bool, Floats]) -> None:
    for rapid, points in paths.items():
        style: dict[str, Any] = (
            {"color": _RAPID, "linewidth": 0.7, "linestyle": "--", "label": "rapid"}
            if rapid
            else {"color": _CUT, "linewidth": 0.9, "label": "cut"}
        )
        axes.plot(*points.T, **style)


def _plan(axes: Axes, result: RunResult, linear: list[int]) -> None:
    trace = result.trace
    assert trace is not None
    first, second = (linear * 2)[:2] if len(linear) < 2 else linear[:2]
    if len(linear) == 2 and trace.axes[first] == "X":
        first, second = second, first  # a lathe is drawn with Z to the right
    _draw(axes, _by_kind(result, [first, second]))
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel(f"{trace.axes[first]} [mm]")
    axes.set_ylabel(f"{trace.axes[second]} [mm]")
    axes.set_title("Plan view")
    axes.grid(alpha=0.3)
    axes.legend(loc="upper right", fontsize="small")


def _perspective(axes: Any, result: RunResult, linear: list[int]) -> None:
    trace = result.trace
    assert trace is not None
    columns = linear[:3]
    _draw(axes, _by_kind(result, columns))
    for name, column in zip("xyz", columns, strict=True):
        getattr(axes, f"set_{name}label")(f"{trace.axes[column]} [mm]")
    spans = np.maximum(np.ptp(trace.setpoint[:, columns], axis=0), 1e-9)
    axes.set_box_aspect(np.maximum(spans / spans.max(), 0.2))
    axes.set_title("Perspective")


def _positions(axes: Axes, result: RunResult) -> None:
    trace = result.trace
    assert trace is not None
    for index, (name, unit) in enumerate(zip(trace.axes, trace.units, strict=True)):
        axes.plot(trace.t_s, trace.setpoint[:, index], linewidth=0.8, label=f"{name} [{unit}]")
    axes.set_xlabel("time [s]")
    axes.set_ylabel("position")
    axes.set_title("Positions")
    axes.grid(alpha=0.3)
    axes.legend(fontsize="small")


def _speed(axes: Axes, result: RunResult) -> None:
    trace = result.trace
    assert trace is not None
    speed = trace.feed_mm_s * 60.0
    for rapid, color, label in ((False, _CUT, "cut"), (True, _RAPID, "rapid")):
        axes.plot(
            trace.t_s, np.where(trace.rapid == rapid, speed, np.nan), color=color, linewidth=0.8, label=label
        )
    axes.set_xlabel("time [s]")
    axes.set_ylabel("path speed [mm/min]")
    axes.set_title("Speed")
    axes.set_ylim(bottom=0.0)
    axes.margins(x=0.01)
    axes.grid(alpha=0.3)


def _clock(seconds: float) -> str:
    minutes, rest = divmod(seconds, 60.0)
    hours, minutes = divmod(int(minutes), 60)
    return f"{hours}:{minutes:02d}:{rest:06.3f}" if hours else f"{minutes}:{rest:06.3f} min"
