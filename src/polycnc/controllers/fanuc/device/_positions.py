"""Where the axes are, in whole increments as programs on a PC read them; all values of one cycle."""

from __future__ import annotations

from typing import NamedTuple

from polycnc.controllers.fanuc.device._device_state import AxisMotionState
from polycnc.controllers.fanuc.device._power import Power
from polycnc.controllers.fanuc.device._units import Units

_START_OFFSET = "G54"
_LENGTH_AXIS = "Z"
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

    def __init__(self, power: Power, units: Units, shifted: AxisMotionState) -> None:
        self._power = power
        self._units = units
        self._shifted = shifted

    def read(self) -> tuple[AxisPositions, ...]:
        """Return the positions of all axes in the present cycle.

        Acceleration is planned before the path is interpolated on this control, so nothing is delayed by it.
        """
        shift, scales, shifted = self._shift(), self._units.by_kind(), self._shifted.shift
        return tuple(
            AxisPositions(
                absolute=scales[each.unit][0].counts(
                    each.work + shift.get(each.name, 0.0) + scales[each.unit][1].value(shifted[k])
                ),
                machine=scales[each.unit][1].counts(each.machine),
                relative=scales[each.unit][0].counts(each.relative),
                distance=scales[each.unit][0].counts(each.to_go),
                servo_delay=scales[each.unit][0].counts(each.following_error),
                acceleration_delay=0,
            )
            for k, each in enumerate(self._power.control.axes().values())
        )

    def coordinate(self, axis: int) -> int:
        """Return the absolute position of an axis (from 1) in increments of the machine."""
        each = self._power.control.axes()[self._units.axis_name(axis)]
        work = each.work + self._shift().get(each.name, 0.0)
        return self._units.output_scale(axis).counts(work) + self._shifted.shift[axis - 1]

    def feed(self) -> int:
        """Return the actual feed: mm/min, with inch input 0.01 inch/min; of rotary axes alone deg/min."""
        control = self._power.control
        feed = control.channel_status().feed.actual
        moving = {axis.unit for axis in control.axes().values() if axis.velocity != 0.0}
        is_inch = self._units.inch_input and moving != {"deg"}
        return round(feed * (_INCH_FEED if is_inch else 1.0))

    def preset_relative(self, values: dict[int, int]) -> None:
        """Let the relative positions of axes (from 1) be these, in increments."""
        for axis, value in values.items():
            name, scale = self._units.axis_name(axis), self._units.input_scale(axis)
            self._power.control.set_relative(name, scale.value(value))

    def _shift(self) -> dict[str, float]:
        """Return what absolute positions have beside work positions: the tool length; before any block G54."""
        control = self._power.control
        tool = control.tool_in_use()
        if tool is not None:
            return {_LENGTH_AXIS: tool.compensation_mm} if tool.compensation_mm else {}
        return {name: -value for name, value in control.offsets.get(_START_OFFSET, {}).items()}

    @property
    def tool_length_mm(self) -> float:
        """The tool length compensation of the executed block, along its axis."""
        tool = self._power.control.tool_in_use()
        return 0.0 if tool is None else tool.compensation_mm
