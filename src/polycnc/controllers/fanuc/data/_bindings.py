"""Parameters whose values live in the control: work offsets, part counters, timers."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TypeAlias

from polycnc.cnc import Control, Parts, Timer
from polycnc.controllers.fanuc.data._parameters import Bound
from polycnc.controllers.fanuc.device._units import Units

WORK_OFFSETS = {1221 + k: f"G{54 + k}" for k in range(6)}
_TIMERS = {6752: Timer.OPERATING, 6754: Timer.CUTTING, 6758: Timer.CYCLE}
_PARTS = {6711: "made", 6712: "total", 6713: "required"}
_MS_PER_MIN = 60_000
_Control: TypeAlias = Callable[[], Control]


def bound(control: _Control, units: Callable[[], Units]) -> Mapping[int, Bound]:
    """Return what parameters show and change of what the present control counts and keeps elsewhere."""
    found = {number: _offset(control, units, name) for number, name in WORK_OFFSETS.items()}
    found |= {number: _parts(control, name) for number, name in _PARTS.items()}
    found[6750] = _minutes(control, Timer.POWER_ON)
    for number, timer in _TIMERS.items():
        found[number] = _minutes(control, timer)
        found[number - 1] = _milliseconds(control, timer)
    return found


def _offset(control: _Control, units: Callable[[], Units], name: str) -> Bound:
    def get(axis: int) -> int:
        value = control().offsets.get(name, {}).get(units().axis_name(axis), 0.0)
        return units().output_scale(axis).counts(value)

    def put(axis: int, value: int) -> None:
        there = units().output_scale(axis).value(value)
        control().offsets.set(name, {units().axis_name(axis): there})

    return Bound(get, put)


def _parts(control: _Control, name: str) -> Bound:
    def get(axis: int) -> int:
        parts: Parts = control().parts.parts
        return int(getattr(parts, name))

    return Bound(get, lambda axis, value: control().parts.set(**{name: value}))


def _milliseconds_of(control: _Control, timer: Timer) -> int:
    return round(control().timers.seconds(timer) * 1000.0)


def _minutes(control: _Control, timer: Timer) -> Bound:
    def put(axis: int, value: int) -> None:
        rest = _milliseconds_of(control, timer) % _MS_PER_MIN
        control().timers.set_seconds(timer, value * 60.0 + rest / 1000.0)

    return Bound(lambda axis: _milliseconds_of(control, timer) // _MS_PER_MIN, put)


def _milliseconds(control: _Control, timer: Timer) -> Bound:
    def put(axis: int, value: int) -> None:
        minutes = _milliseconds_of(control, timer) // _MS_PER_MIN
        control().timers.set_seconds(timer, minutes * 60.0 + value / 1000.0)

    return Bound(lambda axis: _milliseconds_of(control, timer) % _MS_PER_MIN, put)
