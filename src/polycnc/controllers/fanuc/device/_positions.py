"""Where the axes are, in whole increments as programs on a PC read them; all values of one cycle."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from polycnc.cnc import Status
from polycnc.nc import Group, ModalWords

if TYPE_CHECKING:
    from polycnc.controllers.fanuc.device._power_mate import PowerMate

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

    def read(self, status: Status | None = None) -> tuple[AxisPositions, ...]:
        """Return the positions of all axes in the present cycle.

        Acceleration is planned before the path is interpolated on this control, so nothing is delayed by it.
        """
        power_mate = self._power_mate
        status = status or power_mate.status()
        zero = self._zero(status)
        found = []
        for axis, each in enumerate(status.axes.values(), 1):
            program, machine = power_mate.input_scale(axis), power_mate.output_scale(axis)
            found.append(
                AxisPositions(
                    absolute=program.counts(each.machine - zero[axis - 1]),
                    machine=machine.counts(each.machine),
                    relative=program.counts(each.relative),
                    distance=program.counts(each.to_go),
                    servo_delay=program.counts(each.following_error),
                    acceleration_delay=0,
                )
            )
        return tuple(found)

    def feed(self, status: Status | None = None) -> int:
        """Return the actual feed: mm/min, with inch input 0.01 inch/min; of rotary axes alone deg/min."""
        status = status or self._power_mate.status()
        speeds = {
            kind: math.hypot(*(axis.velocity for axis in status.axes.values() if axis.unit == kind))
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

    def _zero(self, status: Status) -> list[float]:
        """Return where program zero lies without the tool length (machine coordinates)."""
        power_mate = self._power_mate
        names = tuple(status.axes)
        modal = status.channel.modal
        if modal is None:
            offset = power_mate.control.offsets.get(_START_OFFSET, {})
            return [offset.get(name, 0.0) for name in names]
        zero = list(modal.zero)
        if _LENGTH_AXIS in names:
            zero[names.index(_LENGTH_AXIS)] -= self._length(modal)
        return zero

    def _length(self, modal: ModalWords) -> float:
        sign = {"G43": 1.0, "G44": -1.0}.get(modal.g.get(Group.LENGTH_COMPENSATION, ""), 0.0)
        tool = self._power_mate.control.tools.get(modal.h)
        return 0.0 if tool is None else sign * (tool.length_mm + tool.wear_length_mm)
