"""The signals that a Power Mate gives to its PMC: one row for each F address, made of what is seen in one cycle."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

from polycnc.cnc import AxisStatus, Emergency, Motion, RunState, Status
from polycnc.controllers.fanuc.device._alarms import shown
from polycnc.controllers.fanuc.device._modes import PowerMateMode

_M = PowerMateMode
_MODE_LAMPS = {
    _M.INC: 0, _M.HND: 1, _M.T_HND: 1, _M.JOG: 2, _M.T_JOG: 2, _M.MDI: 3, _M.RMT: 4, _M.MEM: 5, _M.EDIT: 6,
}  # fmt: skip
_TEACHES = (_M.T_JOG, _M.T_HND)
_FUNCTION_BITS = {"M": 0, "S": 2, "T": 3, "B": 7}
_FUNCTION_BYTES = {"M": 10, "S": 22, "T": 26, "B": 30}
_INTERRUPTED = frozenset({RunState.STOPPED_AT_BLOCK, RunState.PROGRAM_STOP, RunState.OPTIONAL_STOP})


@dataclass(frozen=True, slots=True)
class Seen:
    """What the signals are made of; `machine_zeros` tells which axes are at 0 of the machine."""

    status: Status
    mode: PowerMateMode
    inch: bool
    reset_is_on: bool
    machine_lock: bool
    battery_low: bool
    user_outputs: int
    machine_zeros: Callable[[], list[bool]]


def _bits(bits: Mapping[int, bool]) -> int:
    return sum(1 << bit for bit, on in bits.items() if on)


def _in_order(values: Iterable[bool]) -> int:
    return _bits(dict(enumerate(values)))


def _run(seen: Seen) -> int:
    state = seen.status.channel.run_state
    active, held = state is RunState.ACTIVE, state is RunState.HOLD
    ready = seen.status.emergency is Emergency.OFF
    return _bits({4: held, 5: active, 6: ready, 7: active or held or state in _INTERRUPTED})


def _alarms(seen: Seen) -> int:
    return _bits({0: bool(shown(seen.status.alarms)), 1: seen.reset_is_on, 2: seen.battery_low, 7: True})


def _feed(seen: Seen) -> int:
    channel = seen.status.channel
    moving = channel.motion is Motion.MOVING
    rapid = moving and channel.feed.rapid
    cut = moving and channel.run_state is RunState.ACTIVE and not rapid
    return _bits({0: seen.inch, 1: rapid, 6: cut, 7: seen.status.switches.dry_run})


def _mode(seen: Seen) -> int:
    lamp = _MODE_LAMPS.get(seen.mode)
    return (0 if lamp is None else 1 << lamp) | (seen.mode in _TEACHES) << 7


def _switches(seen: Seen) -> int:
    switches = seen.status.switches
    return _bits(
        {
            0: 1 in switches.block_delete,
            1: seen.machine_lock,
            3: switches.single_block,
            5: seen.mode is _M.REF,
        }
    )


def _of_axes(test: Callable[[AxisStatus], bool]) -> Callable[[Seen], int]:
    return lambda seen: _in_order(map(test, seen.status.axes.values()))


_ROWS: Mapping[int, Callable[[Seen], int]] = {
    0: _run,
    1: _alarms,
    2: _feed,
    3: _mode,
    4: _switches,
    7: lambda seen: _bits({_FUNCTION_BITS[each[0]]: True for each in seen.status.channel.functions}),
    54: lambda seen: seen.user_outputs & 0xFF,
    55: lambda seen: seen.user_outputs >> 8 & 0xFF,
    94: lambda seen: _in_order(seen.machine_zeros()),
    102: _of_axes(lambda axis: axis.velocity != 0.0),
    106: _of_axes(lambda axis: axis.velocity < 0.0),
    120: _of_axes(lambda axis: axis.referenced),
}


def output_byte(address: int, seen: Seen) -> int:
    """Return the byte of an F address; those without a row hold numbers of functions that wait for their answer."""
    row = _ROWS.get(address)
    return _function_byte(address, seen.status.channel.functions) if row is None else row(seen)


def _function_byte(address: int, functions: tuple[str, ...]) -> int:
    for each in functions:
        first = _FUNCTION_BYTES[each[0]]
        if first <= address < first + 4:
            return int(each[1:]) >> 8 * (address - first) & 0xFF
    return 0
