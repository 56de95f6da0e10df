"""Where the axes are, in whole increments as programs on a PC read them; all values of one cycle."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

from polycnc.cnc import AxisStatus, Status
from polycnc.controllers.fanuc.data._increment import Scale, scale
from polycnc.nc import Group, ModalWords

if TYPE_CHECKING:
    from polycnc.controllers.fanuc.device._power_mate import PowerMate

Axes: TypeAlias = Status | Mapping[str, AxisStatus]

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
        axes = self._axes(of)
        shift = self._shift(tuple(axes))
        scales = self._scales()
        found = []
        for axis, each in enumerate(axes.values(), 1):
            program, machine = scales[each.unit]
            found.append(
                AxisPositions(
                    absolute=program.counts(each.work + shift.get(each.name, 0.0))
                    + self._power_mate.axis_motion.shift(axis),
                    machine=machine.counts(each.machine),
                    relative=program.counts(each.relative),
                    distance=program.counts(each.to_go),
                    servo_delay=program.counts(each.following_error),
                    acceleration_delay=0,
                )
            )
        return tuple(found)

    def _axes(self, of: Axes | None) -> Mapping[str, AxisStatus]:
        if of is None:
            return self._power_mate.control.axes()
        return of.axes if isinstance(of, Status) else of

    def _scales(self) -> dict[str, tuple[Scale, Scale]]:
        """Return the scales of input and output by the unit of an axis."""
        power_mate = self._power_mate
        increment, inch = power_mate.increment, (power_mate.inch_input, power_mate.inch_output)
        turning = scale(increment, linear=False, inch=False)
        program, machine = (scale(increment, linear=True, inch=each) for each in inch)
        return {"mm": (program, machine), "deg": (turning, turning)}

    def feed(self, of: Axes | None = None) -> int:
        """Return the actual feed: mm/min, with inch input 0.01 inch/min; of rotary axes alone deg/min."""
        axes = self._axes(of)
        speeds = {
            kind: math.hypot(*(axis.velocity for axis in axes.values() if axis.unit == kind))
            for kind in ("mm", "deg")
        }
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

    def _shift(self, names: tuple[str, ...]) -> dict[str, float]:
        """Return what absolute positions have beside work positions: the tool length; before any block G54."""
        control = self._power_mate.control
        block = control.channels[0].executed
        if block is not None:
            return (
                {_LENGTH_AXIS: self._length(block.modal)} if control.tools and _LENGTH_AXIS in names else {}
            )
        return {name: -value for name, value in control.offsets.get(_START_OFFSET, {}).items()}

    def _length(self, modal: ModalWords) -> float:
        sign = {"G43": 1.0, "G44": -1.0}.get(modal.g.get(Group.LENGTH_COMPENSATION, ""), 0.0)
        tool = self._power_mate.control.tools.get(modal.h)
        return 0.0 if tool is None else sign * (tool.length_mm + tool.wear_length_mm)
