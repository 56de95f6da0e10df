"""Where the axes are, in whole increments as programs on a PC read them; all values of one cycle."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

from polycnc.cnc import AxisFigures, AxisStatus, Status
from polycnc.controllers.fanuc.data._increment import Scale, scale
from polycnc.nc import Group

if TYPE_CHECKING:
    from polycnc.controllers.fanuc.device._power_mate import PowerMate

Axes: TypeAlias = Status | AxisFigures | Mapping[str, AxisStatus]

_START_OFFSET = "G54"
_LENGTH_AXIS = "Z"
_MM_MIN = 60.0
_INCH_FEED = 100.0 / 25.4  # 0.01 inch/min


@dataclass(frozen=True, slots=True)
class AxisPositions:
    """One axis in increments: `machine` of the output unit, the others of the input unit.

    `absolute` and `relative` contain the tool length compensation, `distance` is what is left of the block.
    """

    absolute: int
    machine: int
    relative: int
    distance: int
    servo_delay: int
    acceleration_delay: int


class Positions:
    """Read positions and feed of a Power Mate."""

    def __init__(self, power_mate: PowerMate) -> None:
        self._power_mate = power_mate

    def read(self, of: Axes | None = None) -> tuple[AxisPositions, ...]:
        """Return the positions of all axes in the present cycle, or in that of a status.

        Acceleration is planned before the path is interpolated on this control, so nothing is delayed by it.
        """
        power_mate = self._power_mate
        shift, scales = self._shift(), self._scales()
        shifted = power_mate.axis_motion.shift
        return tuple(
            AxisPositions(
                absolute=scales[unit][0].counts(work + shift.get(name, 0.0)) + shifted(axis),
                machine=scales[unit][1].counts(machine),
                relative=scales[unit][0].counts(relative),
                distance=scales[unit][0].counts(to_go),
                servo_delay=scales[unit][0].counts(delay),
                acceleration_delay=0,
            )
            for axis, (name, unit, work, machine, relative, to_go, delay) in enumerate(self._places(of), 1)
        )

    def _places(self, of: Axes | None) -> Iterator[tuple[str, str, float, float, float, float, float]]:
        """Yield name, unit, work, machine and relative position, way to go and lag of each axis."""
        control = self._power_mate.control
        if of is not None and not isinstance(of, AxisFigures):
            axes = of.axes if isinstance(of, Status) else of
            for each in axes.values():
                lag = each.following_error
                yield each.name, each.unit, each.work, each.machine, each.relative, each.to_go, lag
            return
        figures = control.figures() if of is None else of
        zeros = control.relative_zero
        for index, axis in enumerate(control.machine.config.axes):
            actual = figures.actual[index]
            yield (
                axis.name,
                axis.unit,
                actual - figures.zero[index],
                actual,
                actual - zeros[index],
                figures.to_go[index],
                figures.following_error[index],
            )

    def _scales(self) -> dict[str, tuple[Scale, Scale]]:
        """Return the scales of input and output by the unit of an axis."""
        power_mate = self._power_mate
        increment, inch = power_mate.increment, (power_mate.inch_input, power_mate.inch_output)
        turning = scale(increment, linear=False, inch=False)
        program, machine = (scale(increment, linear=True, inch=each) for each in inch)
        return {"mm": (program, machine), "deg": (turning, turning)}

    def feed(self, of: Axes | None = None) -> int:
        """Return the actual feed: mm/min, with inch input 0.01 inch/min; of rotary axes alone deg/min."""
        if of is None or isinstance(of, AxisFigures):
            figures = self._power_mate.control.figures() if of is None else of
            units: list[str] = [axis.unit for axis in self._power_mate.control.machine.config.axes]
            found = list(zip(units, figures.velocity, strict=True))
        else:
            axes = of.axes if isinstance(of, Status) else of
            found = [(axis.unit, axis.velocity) for axis in axes.values()]
        squares = {"mm": 0.0, "deg": 0.0}
        for unit, velocity in found:
            squares[unit] += velocity * velocity
        speeds = {unit: math.sqrt(square) for unit, square in squares.items()}
        if speeds["mm"] > 0.0:
            return round(speeds["mm"] * _MM_MIN * (_INCH_FEED if self._power_mate.inch_input else 1.0))
        return round(speeds["deg"] * _MM_MIN)

    def preset_relative(self, values: dict[int, int]) -> None:
        """Let the relative positions of axes (from 1) be these, in increments."""
        for axis, value in values.items():
            power_mate = self._power_mate
            power_mate.control.set_relative(
                power_mate.axis_name(axis), power_mate.input_scale(axis).value(value)
            )

    def _shift(self) -> dict[str, float]:
        """Return what absolute positions have beside work positions: the tool length; before any block G54."""
        control = self._power_mate.control
        block = control.channels[0].executed
        if block is not None:
            return {_LENGTH_AXIS: self.tool_length_mm} if self.tool_length_mm else {}
        return {name: -value for name, value in control.offsets.get(_START_OFFSET, {}).items()}

    @property
    def tool_length_mm(self) -> float:
        """The tool length compensation of the executed block, along its axis."""
        block = self._power_mate.control.channels[0].executed
        if block is None:
            return 0.0
        modal = block.modal
        sign = {"G43": 1.0, "G44": -1.0}.get(modal.g.get(Group.LENGTH_COMPENSATION, ""))
        if sign is None:
            return 0.0
        tool = self._power_mate.control.tools.get(modal.h)
        return 0.0 if tool is None else sign * (tool.length_mm + tool.wear_length_mm)
