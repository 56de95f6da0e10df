"""The path from above, in profile, or in perspective: each tool in its colour, start and end marked."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from polycnc.runner._operations import Operation
from polycnc.runner._outcome import counted
from polycnc.runner.plots._scene import RAPIDS, Floats, Scene
from polycnc.runner.plots._styles import END, RAPID, tool_colour, tool_line

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_MOST_MARKS = 5_000
_MOST_TOOLS = 20  # in the legend
_MOST_LETTERS = 36  # of an operation in the legend
_COLUMNS = 3


def draw_plan(axes: Axes, scene: Scene) -> None:
    """Draw the first two axes; those of a lathe in profile, Z to the right and the spindle's axis dash-dotted."""
    first, second = (1, 0) if scene.is_lathe else (0, 1)
    points = scene.seen([first, second])
    if scene.is_lathe:
        axes.axhline(0.0, color=END, linewidth=0.8, linestyle=(0, (8, 2, 1.5, 2)), zorder=1)
    _draw_path(axes, scene, points)
    _draw_plunges(axes, scene, points)
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel(scene.labels[first])
    axes.set_ylabel(scene.labels[second])
    low, high = _framed(scene)
    axes.update_datalim([(low[first], low[second]), (high[first], high[second])])
    axes.margins(0.0)
    axes.autoscale_view()
    axes.set_title(_title(scene), loc="left")
    axes.grid(alpha=0.3)
    if scene.is_lathe:
        axes.set_ylabel("X [mm], radius")
        right = axes.secondary_yaxis("right", functions=(_doubled, _halved))
        right.set_ylabel("X [mm], diameter")


def draw_perspective(axes: Any, scene: Scene) -> None:
    """Draw the path in three dimensions."""
    from matplotlib.ticker import MaxNLocator

    _draw_path(axes, scene, scene.seen([0, 1, 2]))
    low, high = _framed(scene)
    sides = np.maximum(high - low, 0.3 * np.max(high - low))
    for name, label, side, first, last in zip("xyz", scene.labels, sides, low, high, strict=True):
        getattr(axes, f"set_{name}label")(label, labelpad=9 if name == "z" else 12)
        getattr(axes, f"set_{name}lim")(first, last)
        ticks = 3 + int(4 * side / np.max(sides))
        getattr(axes, f"{name}axis").set_major_locator(MaxNLocator(ticks))
    axes.set_box_aspect(sides, zoom=0.85)
    axes.set_title("Perspective" + _frame(scene), loc="left")


def draw_legend(figure: Figure, scene: Scene, operations: Sequence[Operation]) -> None:
    """Put below everything what its colours and marks mean; what stands in no picture is left out."""
    from matplotlib.lines import Line2D

    handles = [
        Line2D([], [], **tool_line(place), linewidth=2.0, label=_name(tool, scene, operations))
        for place, tool in enumerate(scene.tools[:_MOST_TOOLS])
    ]
    if (more := len(scene.tools) - _MOST_TOOLS) > 0:
        handles.append(Line2D([], [], linestyle="none", label=f"and {counted(more, 'more tool')}"))
    found: dict[str, Any] = {}
    for axes in figure.axes:
        for line in axes.lines:
            if (mark := str(line.get_label()).partition(",")[0]) in _MARKS:
                found.setdefault(mark, line)
    handles += [_shown(found[mark]) for mark in _MARKS if mark in found]
    figure.legend(
        handles=handles, loc="outside lower left", ncols=min(len(handles), _COLUMNS), frameon=False
    ).set_in_layout(True)


_MARKS = ("rapid", "plunge", "start", "end")


def _shown(line: Any) -> Any:
    """Return a mark as the legend shows it: a plunge in no tool's colour."""
    from matplotlib.lines import Line2D

    if line.get_label() != "plunge":
        return line
    return Line2D(
        [], [], color=END, linestyle="none", marker="o", markersize=4, fillstyle="none", label="plunge"
    )


def _name(tool: int, scene: Scene, operations: Sequence[Operation]) -> str:
    """Return how the legend calls a tool: by its number, and by its operation if it has just one with a name."""
    names = {each.name for each in operations if each.tool == tool and each.cutting_s > 0.0}
    if scene.tools == (0,):
        return "cut"
    name = names.pop() if len(names) == 1 else ""
    if len(name) > _MOST_LETTERS:
        name = name[: _MOST_LETTERS - 1].rstrip(" ,") + "…"
    return f"T{tool}  {name}".rstrip().replace("$", r"\$")


def _title(scene: Scene) -> str:
    if scene.is_lathe:
        return "Profile"
    return ("Plan view" if len(scene.labels) > 2 else "Path") + _frame(scene)


def _frame(scene: Scene) -> str:
    return ", as the part sees it" if scene.on_part else ""


def _draw_path(axes: Any, scene: Scene, points: Floats) -> None:
    for kind, line in scene.lines(points).items():
        if kind == RAPIDS:
            style = {"color": RAPID, "linewidth": 0.8, "linestyle": (0, (4, 3)), "label": "rapid"}
        else:
            style = {**tool_line(kind), "linewidth": 1.1, "label": f"T{scene.tools[kind]}"}
        axes.plot(*line.T, **style)
    _draw_ends(axes, points)


def _draw_ends(axes: Any, points: Floats) -> None:
    """Mark where the path begins and where it ends, hollow where it comes from or goes on outside of the picture."""
    inside = np.flatnonzero(~np.isnan(points).any(axis=1))
    if not len(inside):
        return
    for place, outer, marker, size, label in (
        (inside[0], 0, "o", 10.0, "start"),
        (inside[-1], len(points) - 1, "X", 6.5, "end"),
    ):
        whole = place == outer
        axes.plot(
            *points[place : place + 1].T,
            linestyle="none",
            marker=marker,
            markersize=size,
            markerfacecolor=END if whole and label == "end" else "none" if label == "start" else "white",
            markeredgecolor=END,
            markeredgewidth=(1.8 if whole else 0.8) if label == "start" else 0.8,
            label=label if whole else f"{label}, further out",
            zorder=5,
        )


def _draw_plunges(axes: Axes, scene: Scene, points: Floats) -> None:
    """Mark where a tool goes down in the view's direction only."""
    stays = np.concatenate(([False], np.all(np.diff(points, axis=0) == 0.0, axis=1)))
    plunging = scene.moves & stays & (scene.kind != RAPIDS)
    for kind in np.unique(scene.kind[plunging]).tolist():
        places = np.unique(points[plunging & (scene.kind == kind)], axis=0)[:_MOST_MARKS]
        axes.plot(
            *places.T,
            linestyle="none",
            marker="o",
            markersize=4,
            color=tool_colour(kind),
            fillstyle="none",
            label="plunge",
        )


def _framed(scene: Scene) -> tuple[Floats, Floats]:
    """Return the limits of the drawing: what is shown with a little room around it."""
    room = 0.03 * np.max(scene.high - scene.low)
    return scene.low - room, scene.high + room


def _doubled(values: Any) -> Any:
    return np.asarray(values) * 2.0


def _halved(values: Any) -> Any:
    return np.asarray(values) / 2.0
