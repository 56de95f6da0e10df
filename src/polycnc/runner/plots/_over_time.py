"""Speed and axes over time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from polycnc.runner.plots._scene import RAPIDS, Scene
from polycnc.runner.plots._styles import RAPID, tool_colour
from polycnc.runner.view._track import Track

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_CALM = 2.0  # rapids that are faster than so many times the fastest cut leave the picture of the speed
_AXIS_COLOURS = ("#0072b2", "#d55e00", "#009e73")


def draw_speed(axes: Axes, scene: Scene, turns: bool) -> None:
    """Draw the speed of the path over time; `turns`: it may be in degree too."""
    track = scene.track
    speed = track.feed_mm_s * 60.0
    unit = "mm/min or deg/min" if turns else "mm/min"
    kinds = scene.lines(np.column_stack((track.t_s, speed)))
    for kind, line in kinds.items():
        color = RAPID if kind == RAPIDS else tool_colour(kind)
        axes.plot(*line.T, color=color, linewidth=0.7 if kind == RAPIDS else 1.0)
    title = "Speed"
    highest = float(speed.max())
    cut = float(np.max(speed, where=~track.rapid, initial=0.0))
    if 0.0 < _CALM * cut < highest:
        title += f"    (rapids leave the picture: they reach {highest:,.0f} {unit})"
        highest = cut
    axes.set_ylim(0.0, 1.2 * highest if highest > 0.0 else 1.0)
    axes.yaxis.set_major_formatter("{x:,.0f}")
    axes.set_ylabel(f"path speed\n[{unit}]")
    axes.set_title(title, loc="left")
    end = float(track.t_s[-1])
    axes.set_xlim(-0.01 * end, 1.01 * end)
    axes.grid(alpha=0.3)


def draw_positions(axes: Axes, track: Track, names: tuple[tuple[str, str], ...], columns: list[int]) -> None:
    """Draw positions of some axes over time in one frame; `names` are names and units of all of them."""
    for column, color in zip(columns, _AXIS_COLOURS, strict=False):
        label = "{} [{}]".format(*names[column])
        axes.plot(track.t_s, track.position[:, column], color=color, linewidth=0.9, label=label)
    if len(columns) == 1:
        axes.set_ylabel("{} [{}]".format(*names[columns[0]]))
    else:
        axes.set_ylabel("position [mm]")
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False, fontsize="small")
    axes.grid(alpha=0.3)
