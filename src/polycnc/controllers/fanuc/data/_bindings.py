"""Parameters whose values live in the control: work offsets, part counters, timers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from polycnc.cnc import Parts, Timer
from polycnc.controllers.fanuc.data._parameters import Bound

if TYPE_CHECKING:
    from polycnc.controllers.fanuc.device._power_mate import PowerMate

WORK_OFFSETS = {1221 + k: f"G{54 + k}" for k in range(6)}
_TIMERS = {6752: Timer.OPERATING, 6754: Timer.CUTTING, 6758: Timer.CYCLE}
_PARTS = {6711: "made", 6712: "total", 6713: "required"}
_MS_PER_MIN = 60_000


def bind(power_mate: PowerMate) -> None:
    """Let the parameters of a control show what it counts and keeps elsewhere, and change that."""
    bound = power_mate.parameters.bound
    for number, name in WORK_OFFSETS.items():
        bound[number] = _offset(power_mate, name)
    for number, name in _PARTS.items():
        bound[number] = _parts(power_mate, name)
    bound[6750] = _minutes(power_mate, Timer.POWER_ON)
    for number, timer in _TIMERS.items():
        bound[number] = _minutes(power_mate, timer)
        bound[number - 1] = _milliseconds(power_mate, timer)


def _offset(power_mate: PowerMate, name: str) -> Bound:
    def get(axis: int) -> int:
        value = power_mate.control.offsets.get(name, {}).get(power_mate.axis_name(axis), 0.0)
        return power_mate.output_scale(axis).counts(value)

    def put(axis: int, value: int) -> None:
        there = power_mate.output_scale(axis).value(value)
        power_mate.control.offsets.set(name, {power_mate.axis_name(axis): there})

    return Bound(get, put)


def _parts(power_mate: PowerMate, name: str) -> Bound:
    def get(axis: int) -> int:
        parts: Parts = power_mate.control.parts.parts
        return int(getattr(parts, name))

    return Bound(get, lambda axis, value: power_mate.control.parts.set(**{name: value}))


def _milliseconds_of(power_mate: PowerMate, timer: Timer) -> int:
    return round(power_mate.control.timers.seconds(timer) * 1000.0)


def _minutes(power_mate: PowerMate, timer: Timer) -> Bound:
    def put(axis: int, value: int) -> None:
        rest = _milliseconds_of(power_mate, timer) % _MS_PER_MIN
        power_mate.control.timers.set_seconds(timer, value * 60.0 + rest / 1000.0)

    return Bound(lambda axis: _milliseconds_of(power_mate, timer) // _MS_PER_MIN, put)


def _milliseconds(power_mate: PowerMate, timer: Timer) -> Bound:
    def put(axis: int, value: int) -> None:
        minutes = _milliseconds_of(power_mate, timer) // _MS_PER_MIN
        power_mate.control.timers.set_seconds(timer, minutes * 60.0 + value / 1000.0)

    return Bound(lambda axis: _milliseconds_of(power_mate, timer) % _MS_PER_MIN, put)
