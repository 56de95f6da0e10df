"""Where the axes are, in whole increments as programs on a PC read them; all values of one cycle."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from polycnc.controllers.fanuc.data._increment import Scale, scale

if TYPE_CHECKING:
    from polycnc.controllers.fanuc.device._power_mate import PowerMate

_START_OFFSET = "G54"
_LENGTH_AXIS = "Z"
_MM_MIN = 60.0
_INCH_FEED = 100.0 / 25.4  # 0.01 inch/min


class AxisPositions(NamedTuple):
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

    def read(self) -> tuple[AxisPositions, ...]:
        """Return the positions of all axes in the present cycle.

        Acceleration is planned before the path is interpolated on this control, so nothing is delayed by it.
        """
        power_mate = self._power_mate
        shift, scales = self._shift(), self._scales()
        shifted = power_mate.axis_motion.shift
        return tuple(
            AxisPositions(
                absolute=scales[each.unit][0].counts(each.work + shift.get(each.name, 0.0)) + shifted(axis),
                machine=scales[each.unit][1].counts(each.machine),
                relative=scales[each.unit][0].counts(each.relative),
                distance=scales[each.unit][0].counts(each.to_go),
                servo_delay=scales[each.unit][0].counts(each.following_error),
                acceleration_delay=0,
            )
            for axis, each in enumerate(power_mate.control.axes().values(), 1)
        )

    def _scales(self) -> dict[str, tuple[Scale, Scale]]:
        """Return the scales of input and output by the unit of an axis."""
        power_mate = self._power_mate
        increment, inch = power_mate.increment, (power_mate.inch_input, power_mate.inch_output)
        turning = scale(increment, linear=False, inch=False)
        program, machine = (scale(increment, linear=True, inch=each) for each in inch)
        return {"mm": (program, machine), "deg": (turning, turning)}

    def feed(self) -> int:
        """Return the actual feed: mm/min, with inch input 0.01 inch/min; of rotary axes alone deg/min."""
        squares = {"mm": 0.0, "deg": 0.0}
        for axis in self._power_mate.control.axes().values():
            squares[axis.unit] += axis.velocity * axis.velocity
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
        tool = control.tool_in_use()
        if tool is not None:
            return {_LENGTH_AXIS: tool.compensation_mm} if tool.compensation_mm else {}
        return {name: -value for name, value in control.offsets.get(_START_OFFSET, {}).items()}

    @property
    def tool_length_mm(self) -> float:
        """The tool length compensation of the executed block, along its axis."""
        tool = self._power_mate.control.tool_in_use()
        return 0.0 if tool is None else tool.compensation_mm
