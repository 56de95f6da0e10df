"""Draw speed, acceleration and jerk along a path, without and with limited jerk, and with a feed hold in it."""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib import pyplot
from numpy.typing import NDArray

from polycnc.kernel import (
    PATH_RESTED,
    KernelState,
    advance,
    append_arc,
    append_line,
    give_to_path,
    make_state,
    prepare_path,
    replan_path,
    start_path,
)

TARGET = Path(__file__).resolve().parents[1] / "docs" / "images" / "jerk.png"
CYCLE_S = 0.001
FEED_MM_S = 200.0
ACCELERATION = 2000.0
JERK = 40_000.0
HELD = (500, 700)  # cycles in which the feed is held


def path(jerk_mm_s3: float) -> KernelState:
    """Return a machine before a line, a half circle that is slower, and a line of two blocks."""
    state = make_state(2, cycle_s=CYCLE_S, record_cycles=4096)
    state.limits.speed[:], state.limits.acceleration[:] = 500.0, ACCELERATION
    state.paths.row["jerk_mm_s3"] = jerk_mm_s3
    give_to_path(state, 0)

    def line(x: float, y: float, tag: int) -> None:
        append_line(state.seg, state.paths, 0, state.limits, np.array([x, y]), FEED_MM_S, 0, tag)

    line(40.0, 0.0, 1)
    end = np.array([40.0, 10.0])
    append_arc(state.seg, state.paths, 0, state.limits, end, 0, 1, 40.0, 5.0, np.pi, FEED_MM_S, 0, 2)
    line(25.0, 10.0, 3)
    line(0.0, 10.0, 4)
    state.paths.row["closed"] = 1
    prepare_path(state.seg, state.paths, 0, state.limits, CYCLE_S, state.work)
    start_path(state.paths, 0)
    return state


def hold(state: KernelState, on: bool) -> None:
    """Hold the feed, or let it go on."""
    state.paths.row["hold"] = on
    replan_path(state.seg, state.paths, 0, state.limits, CYCLE_S, state.work)


def speeds(jerk_mm_s3: float, *, held: bool = False) -> NDArray[np.float64]:
    """Return the path speed of every cycle."""
    state = path(jerk_mm_s3)
    if held:
        advance(state, HELD[0])
        hold(state, on=True)
        advance(state, HELD[1] - HELD[0])
        hold(state, on=False)
    state.clock[0]["mask"] = PATH_RESTED
    advance(state, 4000)
    found: NDArray[np.float64] = state.recorder.rows[: int(state.recorder.filled[0]), 2]
    return np.concatenate([np.zeros(2), found, np.zeros(2)])


def draw() -> None:
    """Write the picture."""
    mpl.use("agg")
    figure, plots = pyplot.subplots(3, 1, sharex=True, figsize=(9.0, 6.4), dpi=100)
    kinds = (
        ("any jerk", speeds(0.0), "#9a9a9a"),
        ("40 000 mm/s³", speeds(JERK), "#0b62a4"),
        ("the same, held from 0.5 s to 0.7 s", speeds(JERK, held=True), "#d1601e"),
    )
    for label, speed, colour in kinds:
        rate = np.diff(speed) / CYCLE_S
        jerk = np.diff(rate) / CYCLE_S
        for plot, values in zip(
            plots, (speed[2:], rate[1:], np.clip(jerk, -1.5 * JERK, 1.5 * JERK)), strict=True
        ):
            plot.plot(np.arange(len(values)) * CYCLE_S, values, color=colour, label=label, linewidth=1.3)
    for plot, unit in zip(plots, ("speed, mm/s", "acceleration, mm/s²", "jerk, mm/s³"), strict=True):
        plot.set_ylabel(unit)
        plot.grid(alpha=0.3)
    figure.legend(
        *plots[0].get_legend_handles_labels(), loc="upper center", ncols=3, frameon=False, fontsize="small"
    )
    plots[2].set_xlabel("time, s")
    figure.align_ylabels()
    figure.tight_layout(rect=(0.0, 0.0, 1.0, 0.96))
    figure.savefig(TARGET, metadata={"Software": None})


if __name__ == "__main__":
    draw()
