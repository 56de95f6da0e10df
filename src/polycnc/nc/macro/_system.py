"""The system variables of custom macros: what the control and the machine are doing, by number."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from datetime import datetime

from polycnc.kernel import OTHER_SOURCE
from polycnc.machine import Clock
from polycnc.nc.blocks._channel_state import ChannelState
from polycnc.nc.blocks._tables import COMMON_OFFSET, additional_offset
from polycnc.nc.macro._host import Host
from polycnc.nc.macro._macro_state import SavedSystem
from polycnc.nc.macro._variables import MacroError, Value, no_variable
from polycnc.nc.modal._modal import (
    ABSOLUTE,
    EXACT_STOP,
    FEED_MODE,
    FEED_NUMBER,
    INCH,
    MOTION,
    PLANE,
    STOPS_SUPPRESSED,
)

_AXES = 8
_SINGLE_BLOCK, _FEED_CONTROL, _SETTINGS, _MIRRORS = 3003, 3004, 3005, 3007
_TIMER_MS, _TIMER_H, _DATE, _TIME = 3001, 3002, 3011, 3012
_PARTS, _PARTS_REQUIRED = 3901, 3902
_STORED = frozenset({_SINGLE_BLOCK, _FEED_CONTROL, _SETTINGS, _PARTS, _PARTS_REQUIRED})
_SUPPRESSING = (_SINGLE_BLOCK, _FEED_CONTROL)
_TIMERS = frozenset({_TIMER_MS, _TIMER_H, _DATE, _TIME})
_BLOCK_END, _MACHINE, _WORK, _SKIP, _LENGTH, _DEVIATION = 5001, 5021, 5041, 5061, 5081, 5101
_POSITIONS = (_BLOCK_END, _MACHINE, _WORK, _SKIP, _LENGTH, _DEVIATION)
_FEED_MODES = (94.0, 95.0, 93.0)
_PLANES = (17.0, 18.0, 19.0)
_TOOL_FIELDS = ("wear_length_mm", "length_mm", "wear_radius_mm", "radius_mm")
_ADDITIONAL, _ADDITIONAL_LONG = 7001, 14001
_MODAL, _EXECUTED = 4000, 4200
_MODAL_NUMBERS = frozenset(
    {1, 2, 3, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 22, 107, 109, 111, 113, 114, 115, 119, 120, 130}
)


_IN_FORCE: Mapping[int, Callable[[ChannelState], Value]] = {
    1: lambda state: float(max(int(state.modal.whole[MOTION]), 0)),
    2: lambda state: _PLANES[int(state.modal.whole[PLANE])],
    3: lambda state: 90.0 if state.modal.whole[ABSOLUTE] else 91.0,
    5: lambda state: _FEED_MODES[int(state.modal.whole[FEED_MODE])],
    6: lambda state: 20.0 if state.modal.whole[INCH] else 21.0,
    7: lambda state: {1: 41.0, -1: 42.0}.get(state.side, 40.0),
    8: lambda state: {1: 43.0, -1: 44.0}.get(state.coordinates.length_sign, 49.0),
    9: lambda state: state.cycle.code,
    10: lambda state: 98.0 if state.cycle.retract_to_initial else 99.0,
    11: lambda state: 51.0 if state.frame.scaled else 50.0,
    13: lambda state: 96.0 if state.spindle.surface_speed else 97.0,
    14: lambda state: (
        54.1 if ".P" in state.coordinates.work[0] else float(state.coordinates.work[0][1:] or 53)
    ),
    15: lambda state: 61.0 if state.modal.whole[EXACT_STOP] else 64.0,
    16: lambda state: 68.0 if state.frame.rotated else 69.0,
    17: lambda state: 16.0 if state.frame.polar else 15.0,
    22: lambda state: 51.1 if state.frame.mirrors else 50.1,
    107: lambda state: float(state.compensation_tool or 0),
    109: lambda state: float(state.modal.real[FEED_NUMBER]),
    111: lambda state: float(state.length_tool),
    113: lambda state: float(state.m_codes[-1]) if state.m_codes else 0.0,
    119: lambda state: state.spindle.speed,
    120: lambda state: float(state.selected_tool),
    130: lambda state: float(state.coordinates.work[0].partition(".P")[2] or 0),
}
"""What is in force by the last digits of its variable (#4001 and on)."""


class SystemVariables:
    """Read and write the system variables of the channel that a language is attached to.

    `clock` gives date and time; without it they are those of the machine's clock. A control with more
    variables derives from this and asks here for the rest.
    """

    def __init__(self, clock: Callable[[], datetime] | None = None) -> None:
        self._clock = clock
        self._channel: Host | None = None
        self._stored: dict[int, Value] = {}
        self._timers: dict[int, tuple[float, float]] = {}
        self.modal_call = False
        self.program_number = 0
        self.sequence_number = 0

    def attach(self, channel: Host) -> None:
        """Work for a channel; nothing is suppressed."""
        self._channel = channel
        for number in _SUPPRESSING:
            self._stored.pop(number, None)
        self.program_number = self.sequence_number = 0

    @contextmanager
    def seen_from(self, channel: Host) -> Iterator[None]:
        """Tell meanwhile which variables there are for programs of another channel."""
        before, self._channel = self._channel, channel
        try:
            yield
        finally:
            self._channel = before

    def saved(self) -> SavedSystem:
        """Return what it holds by itself, to go back to."""
        return SavedSystem(
            dict(self._stored), dict(self._timers), self.modal_call, self.program_number, self.sequence_number
        )

    def restore_state(self, saved: SavedSystem) -> None:
        """Go back to what it held."""
        self._stored, self._timers = dict(saved.stored), dict(saved.timers)
        self.modal_call = saved.modal_call
        self.program_number, self.sequence_number = saved.program_number, saved.sequence_number

    @property
    def channel(self) -> Host:
        """The channel."""
        assert self._channel is not None
        return self._channel

    @property
    def machine_clock(self) -> Clock:
        """The clock that timers, date and time follow."""
        return self.channel.machine.clock

    def has(self, number: int) -> bool:
        """Tell whether there is a variable."""
        return (
            number in _STORED
            or number in _TIMERS
            or number == _MIRRORS
            or self._position(number) is not None
            or self._tool(number) is not None
            or self._offset(number) is not None
            or (number - _MODAL in _MODAL_NUMBERS or number - _EXECUTED in _MODAL_NUMBERS)
        )

    def waits(self, number: int) -> bool:
        """Tell whether reading or writing waits until all blocks before have been executed."""
        place = self._position(number)
        if place is not None:
            return place[0] not in (_BLOCK_END, _LENGTH)
        return (
            number in _TIMERS
            or number in (_PARTS, _PARTS_REQUIRED, *_SUPPRESSING)
            or number - _EXECUTED in _MODAL_NUMBERS
        )

    def read(self, number: int) -> Value:
        """Return a variable.

        Raises:
            MacroError: There is none of this number.
        """
        if number in _STORED:
            return self._stored.get(number, 0.0)
        if number in _TIMERS:
            return self._time(number)
        if number == _MIRRORS:
            frame = self.channel.state.frame
            return float(sum(1 << axis for axis in frame.mirrors))
        if (place := self._position(number)) is not None:
            return self._read_position(*place)
        if (tool := self._tool(number)) is not None:
            return self._length(float(getattr(self.channel.state.tables.tool(tool[0]), tool[1])))
        if (offset := self._offset(number)) is not None:
            return self.channel.state.tables.work_offset(offset[0])[offset[1]] / self._scale(offset[1])
        for base in (_MODAL, _EXECUTED):
            if number - base in _MODAL_NUMBERS:
                return self._modal(number - base)
        raise no_variable(number)

    def write(self, number: int, value: Value) -> None:
        """Set a variable; a vacant value counts as 0.

        Raises:
            MacroError: There is none of this number, or it can only be read.
        """
        new = 0.0 if value is None else value
        if number in _SUPPRESSING:
            self._suppress(number, new)
        elif number in _STORED:
            self._stored[number] = new
        elif number in (_TIMER_MS, _TIMER_H):
            self._timers[number] = (self.machine_clock.now_s, new)
        elif (tool := self._tool(number)) is not None:
            inch = 25.4 if self.channel.state.modal.whole[INCH] else 1.0
            self.channel.state.tables.set_tool(tool[0], **{tool[1]: new * inch})
        elif (offset := self._offset(number)) is not None:
            state = self.channel.state
            state.tables.set_offset(offset[0], {offset[1]: new * self._scale(offset[1])})
            state.take_changes()
        elif self.has(number):
            raise MacroError(f"#{number} can only be read", "Write another variable.", "PS0116")
        else:
            raise no_variable(number)

    def _suppress(self, number: int, value: float) -> None:
        """Let single block, answers (#3003), feed hold, override and exact stops (#3004) act or not."""
        if value not in range(8 if number == _FEED_CONTROL else 4):
            raise MacroError(f"#{number} cannot be {value:g}", "It takes the sum of 1, 2 and 4.", "PS0119")
        self._stored[number] = value
        first, second = bool(int(value) & 1), bool(int(value) & 2)
        was = self.channel.suppressed
        self.channel.suppressed = (
            was._replace(single_block=first, answers=second)
            if number == _SINGLE_BLOCK
            else was._replace(hold=first, override=second)
        )
        if number == _FEED_CONTROL:
            self.channel.state.modal.whole[STOPS_SUPPRESSED] = int(value) >> 2

    # ------------------------------------------------------------------ where a number leads

    def _axes(self) -> int:
        return len(self.channel.state.axis_names)

    def _position(self, number: int) -> tuple[int, int] | None:
        for base in _POSITIONS:
            if base <= number < base + min(_AXES, self._axes()):
                return base, number - base
        return None

    def _tool(self, number: int) -> tuple[int, str] | None:
        if 2001 <= number <= 2400:
            group, tool = divmod(number - 2001, 200)
            return tool + 1, _TOOL_FIELDS[group]
        group, tool = divmod(number - 10_000, 1000)
        if 0 <= group < len(_TOOL_FIELDS) and tool:
            return tool, _TOOL_FIELDS[group]
        return None

    def _offset(self, number: int) -> tuple[str, int] | None:
        axes = self._axes()
        if 5201 <= number <= 5340:
            group, axis = divmod(number - 5201, 20)
            found = COMMON_OFFSET if group == 0 else f"G{53 + group}", axis
        elif 2500 <= number <= 2899 and number % 100 <= 6:
            axis, group = divmod(number - 2500, 100)
            found = COMMON_OFFSET if group == 0 else f"G{53 + group}", axis
        elif _ADDITIONAL <= number < _ADDITIONAL + 48 * 20:
            group, axis = divmod(number - _ADDITIONAL, 20)
            found = additional_offset(group + 1), axis
        elif _ADDITIONAL_LONG <= number < _ADDITIONAL_LONG + 300 * 20:
            group, axis = divmod(number - _ADDITIONAL_LONG, 20)
            found = additional_offset(group + 1), axis
        else:
            return None
        return found if found[1] < min(axes, _AXES) else None

    # ------------------------------------------------------------------ values

    def _scale(self, axis: int) -> float:
        return float(self.channel.state.modal.scale[axis])

    def _length(self, length_mm: float) -> float:
        return length_mm / 25.4 if self.channel.state.modal.whole[INCH] else length_mm

    def _time(self, number: int) -> float:
        if number in (_TIMER_MS, _TIMER_H):
            begun_s, value = self._timers.get(number, (0.0, 0.0))
            unit_s = 0.001 if number == _TIMER_MS else 3600.0
            return value + (self.machine_clock.now_s - begun_s) / unit_s
        now = self._clock() if self._clock else self.machine_clock.now
        if number == _DATE:
            return float(now.year * 10_000 + now.month * 100 + now.day)
        return float(now.hour * 10_000 + now.minute * 100 + now.second)

    def _read_position(self, base: int, axis: int) -> float:
        state = self.channel.state
        modal = state.modal
        scale = self._scale(axis)
        length = float(state.coordinates.length[axis])
        zero = float(modal.offset[axis]) - length
        machine = self.channel.machine.state
        at = float(machine.setpoint[axis])
        if (
            base != _MACHINE and machine.owner[axis] == OTHER_SOURCE
        ):  # a machine lock: the path goes on without it
            at = float(machine.paths.position[self.channel.path, axis])
        match base:
            case 5001:
                return (float(modal.position[axis]) - float(modal.offset[axis])) / scale
            case 5021:
                return at / scale
            case 5041:
                return (at - zero) / scale
            case 5061:
                skipped = state.skip_position
                return ((at if skipped is None else skipped[axis]) - zero) / scale
            case 5081:
                return length / scale
            case _:
                return (float(machine.setpoint[axis]) - float(machine.servo.actual[axis])) / scale

    def _modal(self, number: int) -> Value:
        match number:
            case 12:
                return 66.0 if self.modal_call else 67.0
            case 114:
                return float(self.sequence_number)
            case 115:
                return float(self.program_number)
        found = _IN_FORCE.get(number)
        return 0.0 if found is None else found(self.channel.state)
