"""Run a program with positions that lie close together, so that its path is seen at every corner."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt

from polycnc.cnc import RunOptions, let_pass
from polycnc.kernel import BLOCK
from polycnc.machine import Machine, MachineConfig, PathConfig, RotaryAxis, TimesConfig
from polycnc.nc import Dialect, ProgramText
from polycnc.runner._execution import Floats, Progress, TaggedRows, run_to_end
from polycnc.runner._program_control import Surroundings, control_for, run_under

_AXES = "XYZ"
_LEVER_MM = 300.0  # no point of a part is much further from the rotary axes that swing it
_RECORD_CYCLES = 1 << 13


def run_closely(
    program: ProgramText,
    config: MachineConfig,
    dialect: Dialect,
    distance_mm: float,
    take: TaggedRows,
    progress: Progress | None,
    root: Path,
) -> None:
    """Run a program with close positions, each of which `take` gets; `root` is the folder of its control."""
    machine = Machine(_with_close_positions(config, distance_mm), record_cycles=_RECORD_CYCLES)
    lines = max(program.content.count(b"\n"), 1)

    def compare(rows: Floats, tags: npt.NDArray[np.int64]) -> None:
        take(rows, tags, execution.channel.records)
        if progress is not None:
            progress(min(float(rows[-1, BLOCK]) / lines, 1.0))

    options = RunOptions(stands_at_stops=False)
    control = control_for(dialect, program, machine, Surroundings(root))
    if control is not None and not control.has_statements(program):
        control = None
    execution = run_under(control, machine, program, dialect, options, rows=compare, on_passed=let_pass)
    run_to_end(execution, every_cycle=True)
    if control is not None:
        control.finish()


def _with_close_positions(config: MachineConfig, distance_mm: float) -> MachineConfig:
    """Return a machine whose positions, cycle by cycle, miss no corner by more than `distance_mm`.

    A speed v that turns by the angle w within one cycle costs an acceleration v w / dt, and the chord across it
    lies v dt w / 4 off the corner: acceleration times dt squared by 4, in each axis.
    """
    highest = 4.0 * distance_mm / (config.cycle_s**2 * len(_AXES) ** 0.5)
    turning = float(np.degrees(highest / _LEVER_MM))
    axes = tuple(
        axis.model_copy(update={"amax_mm_s2": min(axis.amax, highest), "jump_mm_s": None})
        if axis.name in _AXES
        else axis.model_copy(update={"amax_deg_s2": min(axis.amax, turning), "jump_deg_s": None})
        if isinstance(axis, RotaryAxis)
        else axis
        for axis in config.axes
    )
    tools = {
        number: tool.model_copy(update={"radius_mm": 0.0, "wear_radius_mm": 0.0})
        for number, tool in config.tools.items()
    }
    changed = {"axes": axes, "path": PathConfig(), "times": TimesConfig(), "tools": tools}
    return config.model_copy(update=changed)
