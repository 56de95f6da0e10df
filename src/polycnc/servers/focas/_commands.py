"""What each command reads or does, by its code: one function each, called between two control cycles.

Each takes the control, its profile and the request, and returns the payload; it refuses by raising `RefusedError`.
What a series does not know, and what is not in the table, is answered with code 1.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Callable
from typing import TypeAlias

from polycnc.controllers.fanuc import AlarmBit, PowerMate, bit_of, pmc, read_state, shown
from polycnc.controllers.fanuc.wire import CNC, PMC, VALUE8_SIZE, Request, Value8, text
from polycnc.servers.focas._profile import Profile

NOT_THERE, LENGTH, NUMBER, ATTRIBUTE, DATA, PROTECTED, REJECTED = 1, 2, 3, 4, 5, 7, 13
_MOST_NUMBERS = 200
_ALL = -1
_LONG = (-(1 << 31), (1 << 31) - 1)


class RefusedError(Exception):
    """A command that is answered with a code instead of data."""

    def __init__(self, code: int, detail: int = 0) -> None:
        super().__init__(f"code {code}")
        self.code, self.detail = code, detail


Command: TypeAlias = Callable[[PowerMate, Profile, Request], bytes]


def _shorts(*values: int) -> bytes:
    return struct.pack(f">{len(values)}H", *values)


def _longs(*values: int) -> bytes:
    return struct.pack(f">{len(values)}i", *(max(_LONG[0], min(_LONG[1], value)) for value in values))


def _numbers(request: Request) -> range:
    first, last = request.arguments[:2]
    if last < first or last - first >= _MOST_NUMBERS:
        raise RefusedError(NUMBER)
    return range(first, last + 1)


def _axes(control: PowerMate, request: Request, place: int = 1) -> range:
    """Return the axes that are asked for: one, or all."""
    axis = request.arguments[place]
    if axis == _ALL:
        return range(1, control.axes + 1)
    if not 1 <= axis <= control.axes:
        raise RefusedError(ATTRIBUTE)
    return range(axis, axis + 1)


# ---------------------------------------------------------------------- what it is and does


def _system(control: PowerMate, profile: Profile, request: Request) -> bytes:
    names = (profile.cnc_type, 2), (profile.machine_type, 2), (profile.series, 4), (profile.software, 4)
    return _shorts(profile.additional_info, profile.most_axes) + b"".join(
        text(value, size) for value, size in (*names, (f"{control.axes:02d}", 2))
    )


_LATER_RUN = {4: 3}
_LATER_MOTION = {3: 2}


def _state(control: PowerMate, profile: Profile, request: Request) -> bytes:
    state = read_state(control)
    run, motion = state.run, state.motion
    if not profile.old_states:
        run, motion = _LATER_RUN.get(run, run), _LATER_MOTION.get(motion, motion)
    return _shorts(state.aut, run, motion, state.mstb, state.emergency, state.alarm, state.edit)


_TYPES = (  # alarm groups by the type numbers of later series
    (AlarmBit.PS100 | AlarmBit.PS000 | AlarmBit.PS101 | AlarmBit.PS_OTHER | AlarmBit.PS5000, 3),
    (AlarmBit.OVERTRAVEL, 4),
    (AlarmBit.OVERHEAT, 5),
    (AlarmBit.SERVO | AlarmBit.APC, 6),
    (AlarmBit.EXTERNAL, 15),
)


def _type_of(bits: AlarmBit) -> int:
    return next(number for group, number in _TYPES if bits & group)


def _alarm_bits(control: PowerMate, profile: Profile, request: Request) -> bytes:
    bits = control.alarm_bits
    later = sum(1 << number for group, number in _TYPES if bits & group)
    return struct.pack(">I", int(bits) if profile.old_states else later)


def _alarms(control: PowerMate, profile: Profile, request: Request) -> bytes:
    kind, most, mode, size = request.arguments
    if not (0 <= most <= _MOST_NUMBERS and 0 <= size <= 64):
        raise RefusedError(LENGTH)
    rows = []
    names = [control.axis_name(axis) for axis in range(1, control.axes + 1)]
    for alarm in shown(control.status().alarms):
        number = _type_of(bit_of(alarm.number))
        if kind in (_ALL, number):
            axis = names.index(alarm.axis) + 1 if alarm.axis in names else 0
            words = text(alarm.text, size if mode else 0)
            rows.append(_longs(alarm.number, number, axis, len(words.rstrip(b"\0"))) + words)
    return b"".join(rows[:most])


def _messages(control: PowerMate, profile: Profile, request: Request) -> bytes:
    if not 0 <= request.arguments[0] <= 4:
        raise RefusedError(ATTRIBUTE)
    messages = control.status().messages if request.arguments[0] == 0 else ()
    return b"".join(
        _longs(each.number, 0, len(text(each.text, 256).rstrip(b"\0"))) + text(each.text, 256)
        for each in messages
    )


# ---------------------------------------------------------------------- programs


def _program_numbers(control: PowerMate, profile: Profile, request: Request) -> bytes:
    return _longs(*control.execution.numbers)


def _sequence_number(control: PowerMate, profile: Profile, request: Request) -> bytes:
    return _longs(control.execution.sequence)


def _executed_text(control: PowerMate, profile: Profile, request: Request) -> bytes:
    most = request.arguments[0]
    if not 0 < most <= 1400:
        raise RefusedError(LENGTH)
    block = control.execution.block
    return _longs(0 if block is None else block.line) + control.execution.text(most)


def _program_name(control: PowerMate, profile: Profile, request: Request) -> bytes:
    number = control.execution.numbers[0]
    return _longs(number) + text(f"O{number}", 36)


def _program_path(control: PowerMate, profile: Profile, request: Request) -> bytes:
    return text(f"//CNC_MEM/USER/PATH1/O{control.execution.numbers[0]}", 256)


_BODY_MOST = 1400


def _directory(control: PowerMate, profile: Profile, request: Request) -> bytes:
    first, most, kind, _ = request.arguments
    if kind not in (0, 1, 2) or most < 0:
        raise RefusedError(DATA)
    rows = [
        struct.pack(">II", each.number, each.characters if kind == 2 else 0)
        + text(each.comment if kind else "", 64)
        for each in control.programs.directory(max(first, 1))
    ]
    return b"".join(rows[: min(most, _BODY_MOST // 72)])


def _select(control: PowerMate, profile: Profile, request: Request) -> bytes:
    number = request.arguments[0]
    if number not in control.programs:
        raise RefusedError(LENGTH, 1)
    control.select_program(number)
    return b""


def _delete(control: PowerMate, profile: Profile, request: Request) -> bytes:
    number = request.arguments[0]
    if number not in control.programs or number == control.selected:
        raise RefusedError(DATA)
    if control.programs.key_protects or control.programs.parameter_protects(number):
        raise RefusedError(PROTECTED)
    control.programs.delete(number)
    return b""


def _start(control: PowerMate, profile: Profile, request: Request) -> bytes:
    control.cycle_start()
    return b""


# ---------------------------------------------------------------------- axes and spindle


_KINDS = {
    0: "absolute", 1: "machine", 2: "relative", 3: "distance", 4: "absolute", 6: "relative", 7: "distance",
    9: "servo_delay", 10: "acceleration_delay",
}  # fmt: skip


def _positions(control: PowerMate, profile: Profile, request: Request) -> bytes:
    name = _KINDS.get(request.arguments[0])
    if name is None:
        raise RefusedError(NUMBER)
    found = control.positions.read()
    made = []
    for axis in _axes(control, request):
        units = control.output_scale(axis) if name == "machine" else control.input_scale(axis)
        made.append(bytes(Value8(getattr(found[axis - 1], name), units.decimals)))
    return _padded(made, profile, request.arguments[1])


def _padded(values: list[bytes], profile: Profile, axis: int) -> bytes:
    """Return values of one axis, or of all with room for as many as the series can have."""
    body = b"".join(values)
    return body.ljust(profile.most_axes * VALUE8_SIZE, b"\0") if axis == _ALL else body


def _feed(control: PowerMate, profile: Profile, request: Request) -> bytes:
    return bytes(Value8(control.positions.feed(), 2 if control.inch_input else 0))


def _spindle_speed(control: PowerMate, profile: Profile, request: Request) -> bytes:
    return bytes(Value8.of(abs(control.status().spindle.actual_rpm), 0))


def _axis_names(control: PowerMate, profile: Profile, request: Request) -> bytes:
    return b"".join(text(control.axis_name(axis), 4) for axis in range(1, control.axes + 1))


def _spindle_names(control: PowerMate, profile: Profile, request: Request) -> bytes:
    return text("S1", 4)


def _counts(control: PowerMate, profile: Profile, request: Request) -> bytes:
    return _shorts(1 if request.arguments[0] == 1 else control.axes)


def _figures(control: PowerMate, profile: Profile, request: Request) -> bytes:
    if request.arguments[0] != 0:
        raise RefusedError(ATTRIBUTE)
    pairs = [
        (control.input_scale(axis).decimals, control.output_scale(axis).decimals)
        for axis in range(1, control.axes + 1)
    ]
    return _longs(len(pairs)) + b"".join(_shorts(*pair) for pair in pairs)


# ---------------------------------------------------------------------- data


def _macro(control: PowerMate, number: int) -> float | None:
    try:
        return control.macros.get(number)
    except KeyError:
        raise RefusedError(NUMBER) from None


def _read_macros(control: PowerMate, profile: Profile, request: Request) -> bytes:
    values = [_macro(control, number) for number in _numbers(request)]
    return b"".join(bytes(Value8.of(value, 9)) for value in values)


def _set_macros(control: PowerMate, values: dict[int, float | None]) -> bytes:
    for number, value in values.items():
        _macro(control, number)
        if value is not None and not abs(value) < 1e12:
            raise RefusedError(DATA)
    for number, value in values.items():
        control.macros.set(number, value)
    return b""


def _write_macros(control: PowerMate, profile: Profile, request: Request) -> bytes:
    numbers = _numbers(request)
    if len(request.data) != len(numbers) * VALUE8_SIZE:
        raise RefusedError(LENGTH)
    pieces = [request.data[at : at + VALUE8_SIZE] for at in range(0, len(request.data), VALUE8_SIZE)]
    return _set_macros(
        control, dict(zip(numbers, (Value8.from_wire(each).number for each in pieces), strict=True))
    )


def _read_doubles(control: PowerMate, profile: Profile, request: Request) -> bytes:
    first, count = request.arguments[:2]
    if not 0 < count <= _MOST_NUMBERS:
        raise RefusedError(NUMBER)
    values = [_macro(control, number) for number in range(first, first + count)]
    return struct.pack(f">{count}d", *(math.nan if value is None else value for value in values))


def _write_double(control: PowerMate, profile: Profile, request: Request) -> bytes:
    if len(request.data) != 8:
        raise RefusedError(LENGTH)
    (value,) = struct.unpack(">d", request.data)
    if math.isinf(value):
        raise RefusedError(DATA)
    return _set_macros(control, {request.arguments[0]: None if math.isnan(value) else value})


def _parameters(control: PowerMate, profile: Profile, request: Request) -> bytes:
    asked = request.arguments[2]
    rows = []
    for number in _numbers(request):
        row = control.parameters.rows.get(number)
        if row is None:
            continue
        if row.per_axis and not (asked == _ALL or 1 <= asked <= control.axes):
            raise RefusedError(ATTRIBUTE)
        axes = _axes(control, request, 2) if row.per_axis else range(1)
        values = [control.parameters.value(number, axis) for axis in axes]
        slots = profile.most_axes
        if profile.wide_values:
            made = b"".join(bytes(Value8(value)) for value in values).ljust(slots * VALUE8_SIZE, b"\0")
        else:
            made = _longs(*values).ljust(slots * 4, b"\0")
        axis = asked if row.per_axis else 0
        rows.append(struct.pack(">Ihh", number, axis, int(row.kind)) + made)
    if not rows:
        raise RefusedError(NUMBER)
    if len(b"".join(rows)) > _BODY_MOST * 2:
        raise RefusedError(LENGTH)
    return b"".join(rows)


_TIMERS = {0: (None, 6750), 1: (6751, 6752), 2: (6753, 6754), 3: (6757, 6758)}
"""Parameters of each timer: milliseconds and minutes."""


def _timer(control: PowerMate, profile: Profile, request: Request) -> bytes:
    timer = _TIMERS.get(request.arguments[0])
    if timer is None:
        raise RefusedError(NUMBER)
    ms, minutes = (0 if number is None else control.parameters.value(number) for number in timer)
    return struct.pack("<ii", minutes, ms)  # little-endian, unlike all else: seen on two series


def _clock(control: PowerMate, profile: Profile, request: Request) -> bytes:
    now = control.clock.now
    return _shorts(now.year, now.month, now.day, now.hour, now.minute, now.second)


# ---------------------------------------------------------------------- PMC


_WIDTHS = {0: 1, 1: 2, 2: 4}


def _pmc_place(request: Request) -> tuple[str, int, int]:
    first, last, area, kind = request.arguments
    if kind not in _WIDTHS or not 0 <= area < len(pmc.LETTERS):
        raise RefusedError(ATTRIBUTE)
    letter = pmc.LETTERS[area]
    if last - first >= _BODY_MOST or not pmc.exists(letter, first, last):
        raise RefusedError(NUMBER)
    if (last - first + 1) % _WIDTHS[kind]:
        raise RefusedError(LENGTH)
    return letter, first, last


def _swapped(data: bytes, width: int) -> bytes:
    """Turn values of the PMC, the low byte first, into those of the wire, and back."""
    return b"".join(data[at : at + width][::-1] for at in range(0, len(data), width))


def _read_pmc(control: PowerMate, profile: Profile, request: Request) -> bytes:
    letter, first, last = _pmc_place(request)
    return _swapped(control.pmc.read(letter, first, last), _WIDTHS[request.arguments[3]])


def _write_pmc(control: PowerMate, profile: Profile, request: Request) -> bytes:
    letter, first, last = _pmc_place(request)
    if len(request.data) != last - first + 1:
        raise RefusedError(LENGTH)
    if not pmc.writable(letter, first, last):
        raise RefusedError(PROTECTED)
    control.pmc.write(letter, first, _swapped(request.data, _WIDTHS[request.arguments[3]]))
    return b""


def _nothing(size: int) -> Command:
    def answer(control: PowerMate, profile: Profile, request: Request) -> bytes:
        return bytes(size)

    return answer


COMMANDS: dict[tuple[int, int], Command] = {
    (CNC, 0x01): _start,
    (CNC, 0x03): _select,
    (CNC, 0x05): _delete,
    (CNC, 0x06): _directory,
    (CNC, 0x0E): _parameters,
    (CNC, 0x15): _read_macros,
    (CNC, 0x16): _write_macros,
    (CNC, 0x18): _system,
    (CNC, 0x19): _state,
    (CNC, 0x1A): _alarm_bits,
    (CNC, 0x1B): _figures,
    (CNC, 0x1C): _program_numbers,
    (CNC, 0x1D): _sequence_number,
    (CNC, 0x20): _executed_text,
    (CNC, 0x23): _alarms,
    (CNC, 0x24): _feed,
    (CNC, 0x25): _spindle_speed,
    (CNC, 0x26): _positions,
    (CNC, 0x34): _messages,
    (CNC, 0x45): _clock,
    (CNC, 0x89): _axis_names,
    (CNC, 0x8A): _spindle_names,
    (CNC, 0x8D): _parameters,
    (CNC, 0x98): _nothing(2),
    (CNC, 0xA4): _counts,
    (CNC, 0xA7): _read_doubles,
    (CNC, 0xA8): _write_double,
    (CNC, 0xCF): _program_name,
    (CNC, 0xE1): _nothing(4),
    (CNC, 0xFC): _program_path,
    (CNC, 0x120): _timer,
    (PMC, 0x8001): _read_pmc,
    (PMC, 0x8002): _write_pmc,
}
"""The commands that are answered, by target and code."""
_NARROW, _WIDE = {0x0E}, {0x8D}


def known(profile: Profile, request: Request) -> Command | None:
    """Return what answers a request, None where this series does not know it."""
    if request.command in profile.refused or request.command in (_NARROW if profile.wide_values else _WIDE):
        return None
    return COMMANDS.get((request.target, request.command))
