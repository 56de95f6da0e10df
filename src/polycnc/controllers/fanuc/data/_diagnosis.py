"""The diagnosis data of a Power Mate. Ruling: the manual leaves numbers to another book; these are usual ones."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from polycnc.cnc import Emergency, Motion
from polycnc.controllers.fanuc.data._parameter_rows import Kind
from polycnc.controllers.fanuc.device._alarms import shown

if TYPE_CHECKING:
    from polycnc.controllers.fanuc.device._power_mate import PowerMate


@dataclass(frozen=True, slots=True)
class Diagnosis:
    """One diagnosis number; `value` is given the axis (from 1), 0 for data without axes."""

    name: str
    kind: Kind
    value: Callable[[PowerMate, int], int]
    per_axis: bool = False


def _alarm(number: int) -> Callable[[PowerMate, int], int]:
    def value(power_mate: PowerMate, axis: int) -> int:
        name = power_mate.units.axis_name(axis)
        alarms = shown(power_mate.control.alarms.active)
        return int(any(each.number == number and each.axis == name for each in alarms))

    return value


def _servo_bits(power_mate: PowerMate, axis: int) -> int:
    return _alarm(411)(power_mate, axis) << 3 | _alarm(417)(power_mate, axis) << 4


def _stopped(power_mate: PowerMate, axis: int) -> int:
    signals = power_mate.signals
    emergency = power_mate.control.emergency is Emergency.ON
    return signals.state.reset_is_on << 2 | emergency << 3 | signals.state.hold_is_on << 5


def _axis_state(power_mate: PowerMate, axis: int) -> int:
    status = power_mate.control.axes()[power_mate.units.axis_name(axis)]
    return 0 if not status.moving else 2 if status.manual != "none" else 1


def _spindle_rpm(power_mate: PowerMate, axis: int) -> int:
    return round(abs(power_mate.control.spindle.state().actual_rpm))


def _spindle_load(power_mate: PowerMate, axis: int) -> int:
    most = power_mate.machine.config.spindle.max_rpm
    return round(100.0 * abs(power_mate.control.spindle.state().actual_rpm) / most)


_AMBIENT_C = 25
"""Ruling: motors of this control stay at one temperature (degree Celsius)."""


def _ambient(power_mate: PowerMate, axis: int) -> int:
    return _AMBIENT_C


def _zero(power_mate: PowerMate, axis: int) -> int:
    return 0


# fmt: off
DIAGNOSIS: dict[int, Diagnosis] = {
    0: Diagnosis(
        "waits for the answer to a function", Kind.BYTE, lambda it, axis: bool(it.control.channel_status().functions)
    ),
    1: Diagnosis("axes move", Kind.BYTE, lambda it, axis: it.control.channel_status().motion is Motion.MOVING),
    2: Diagnosis("dwells", Kind.BYTE, lambda it, axis: it.control.channel_status().motion is Motion.DWELL),
    4: Diagnosis("the feed override is 0 %", Kind.BYTE, lambda it, axis: it.signals.feed_override == 0),
    20: Diagnosis("what stops: #2 reset, #3 emergency stop, #5 feed hold", Kind.BIT, _stopped),
    30: Diagnosis("feed override (%)", Kind.WORD, lambda it, axis: it.signals.feed_override),
    31: Diagnosis("actual feed (mm/min)", Kind.TWO_WORD, lambda it, axis: it.positions.feed()),
    200: Diagnosis("servo alarms: #3 excess error, #4 parameter", Kind.BIT, _servo_bits, True),
    201: Diagnosis("what moves the axis: 1 program, 2 hand or direct command", Kind.BYTE, _axis_state, True),
    202: Diagnosis(
        "torque override (0.1 %)", Kind.WORD, lambda it, axis: round(10 * it.signals.torque_override(axis)), True
    ),
    203: Diagnosis("torque mode", Kind.BYTE, lambda it, axis: it.signals.state.torque_mode >> axis - 1 & 1, True),
    300: Diagnosis(
        "position error (increments)", Kind.TWO_WORD, lambda it, axis: it.positions.read()[axis - 1].servo_delay, True
    ),
    301: Diagnosis(
        "distance from the reference position (increments)", Kind.TWO_WORD,
        lambda it, axis: it.positions.read()[axis - 1].machine, True,
    ),
    308: Diagnosis("temperature of the servo motor (degree Celsius)", Kind.BYTE, _ambient, True),
    309: Diagnosis("temperature of the pulse coder (degree Celsius)", Kind.BYTE, _ambient, True),
    400: Diagnosis("spindle control: no serial spindle", Kind.BIT, _zero),
    403: Diagnosis("temperature of the spindle motor (degree Celsius)", Kind.BYTE, _ambient),
    408: Diagnosis("errors on the line of the spindle", Kind.BIT, _zero),
    410: Diagnosis("load of the spindle (%)", Kind.WORD, _spindle_load),
    411: Diagnosis("speed of the spindle motor (1/min)", Kind.TWO_WORD, _spindle_rpm),
    418: Diagnosis("position error of the spindle (increments)", Kind.TWO_WORD, _zero),
    425: Diagnosis("synchronization error of the spindle (increments)", Kind.TWO_WORD, _zero),
    710: Diagnosis("error of the spindle", Kind.WORD, _zero),
    712: Diagnosis("warning of the spindle", Kind.WORD, _zero),
}
# fmt: on
