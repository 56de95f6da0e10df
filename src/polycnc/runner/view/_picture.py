"""What is drawn besides lines: where program zero is, how the machine turns part and tool, and shapes of tools."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from polycnc.machine import MachineConfig, ToolConfig
from polycnc.nc import ProgramText, Zero
from polycnc.runner._rotation import turning_axes
from polycnc.runner._stock_tools import tools_of
from polycnc.runner._turning_tools import turning_tools_of
from polycnc.runner.view._part_frame import hang_mm, on_part
from polycnc.runner.view._track import Track
from polycnc.stock import Insert, Tool

Floats = npt.NDArray[np.float64]
Axes = tuple[tuple[str, str], ...]

_PLACES = "XYZ"
_STEPS = 12  # of a rounded end
_SHAFT_DIAMETERS = 3.0  # that a tool is drawn long where its flutes are not known
_LONGEST_EDGE_MM = 15.0  # of an insert


def places(track: Track, axes: Axes, machine: MachineConfig | None) -> Floats:
    """Return where the tip of the tool is on the part [points, 3], in machine coordinates with all angles at 0."""
    own = track.position[:, : len(axes)]
    if machine is not None:
        return on_part(own, machine, track.tools())
    found = np.zeros((len(own), 3))
    for column, axis in enumerate(columns_of(axes)):
        if axis is not None:
            found[:, column] = own[:, axis]
    return found


def columns_of(axes: Axes) -> tuple[int | None, int | None, int | None]:
    """Return which axes are x, y and z of the picture: by name, or the first linear ones."""
    names = [name for name, _ in axes]
    if any(name in names for name in _PLACES):
        x, y, z = (names.index(name) if name in names else None for name in _PLACES)
        return x, y, z
    linear = [i for i, (_, unit) in enumerate(axes) if unit == "mm"] or list(range(len(axes)))
    first, second, third = (*linear[:3], None, None, None)[:3]
    return first, second, third


def first_cut(track: Track) -> int | None:
    """Return the point at which the first move at feed ends, None where nothing is cut."""
    moves = np.any(np.diff(track.position, axis=0) != 0.0, axis=1) & ~track.rapid[1:]
    found = np.flatnonzero(moves)
    return int(found[0]) + 1 if len(found) else None


def zero_of_work(track: Track, axes: Axes, machine: MachineConfig | None) -> tuple[list[float], bool]:
    """Return where zero of the first cut is in the picture, without the length of a tool, and whether it is in inch."""
    point = first_cut(track)
    row = 0 if point is None or not track.cycle_s else round(track.t_s[point] / track.cycle_s) - 1
    zero = track.zeros.at(row)
    if zero is None:
        return [0.0, 0.0, 0.0], False
    tool = 0 if point is None else int(track.tools()[point])
    found = []
    for column, axis in enumerate(columns_of(axes)):
        value = 0.0 if axis is None or axis >= len(zero.offset) else zero.offset[axis]
        found.append(value - (0.0 if machine is None else _compensated(zero, machine, tool, axis, column)))
    return found, zero.inch


def _compensated(zero: Zero, machine: MachineConfig, tool: int, axis: int | None, column: int) -> float:
    """Return how much of a zero is the tool: all that it hangs from the spindle, or nothing."""
    if axis is None or axis >= len(zero.offset):
        return 0.0
    rest = zero.offset[axis] - sum(machine.work_offset(name)[axis] for name in zero.work)
    hangs = -hang_mm(machine.tools.get(tool, ToolConfig()))[column]
    return hangs if abs(rest - hangs) < abs(rest) else 0.0


def kinematics(machine: MachineConfig | None) -> list[dict[str, Any]]:
    """Return what each turning axis carries, and the line that it turns about."""
    if machine is None:
        return []
    return [
        {"axis": number, "carries": axis.carries, "about": axis.about, "center": axis.center_mm}
        for number, axis in turning_axes(machine)
    ]


def tool_shapes(
    numbers: list[int],
    machine: MachineConfig | None,
    texts: Mapping[str, ProgramText],
    known: Mapping[int, Tool | Insert] | None = None,
) -> dict[str, dict[str, Any]]:
    """Return by number how tools look: outline (radius, height) from the tip to the shaft, and the holder.

    They are those of machine and programs, or those that are `known`. Inserts of a lathe have a plate (X, Z), from the
    point that programs guide.
    """
    if machine is None:
        return {}
    if known is None:
        known = (
            turning_tools_of(machine, texts) if "Y" not in machine.axis_names else tools_of(machine, texts)
        )
    shapes = {}
    for number in numbers:
        at = machine.tools.get(number, ToolConfig())
        shape: dict[str, Any] = {"hang": hang_mm(at), "tip": at.tip, "name": at.description}
        tool = known.get(number)
        if isinstance(tool, Tool):
            shape |= _outline(tool)
        elif tool is not None:
            shape["plate"] = tool.plate(_LONGEST_EDGE_MM)
        shapes[str(number)] = shape
    return shapes


def _outline(tool: Tool) -> dict[str, Any]:
    if tool.undercuts:
        return _shape(tool, list(tool.outline))
    profile = tool.cutting_profile()
    edges = sorted({*np.linspace(0.0, tool.radius_mm, _STEPS + 1).tolist(), *profile.rows[:, 1].tolist()})
    outline = [(0.0, profile.height(0.0)), *((r, profile.height(r)) for r in edges if r > 0.0)]
    end = outline[-1][1]
    flutes = tool.flute_mm if np.isfinite(tool.flute_mm) else end + _SHAFT_DIAMETERS * tool.diameter_mm
    return _shape(tool, [*outline, (tool.radius_mm, max(flutes, end))])


def _shape(tool: Tool, outline: list[tuple[float, float]]) -> dict[str, Any]:
    return {
        "kind": tool.kind.value,
        "diameter": tool.diameter_mm,
        "outline": outline,
        "holder": [list(step) for step in tool.holder],
    }
