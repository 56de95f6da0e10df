"""The alarms of a Power Mate: numbers, texts, what clears them, and the groups that programs see as bits.

Ruling: the manual names groups and a few numbers; the other numbers and texts are the usual ones of the maker.
"""

from __future__ import annotations

from collections.abc import Iterable
from enum import IntFlag

from polycnc.cnc import Alarm, AlarmKind, AlarmRow, ClearedBy

PREFIX = "alarm "
NAME_ALARM = 252
"""Ruling: parameter 1020 gives an axis no name that it can have; it gets a free one."""


class AlarmBit(IntFlag):
    """Alarm groups as bits of the alarm status (Manual 000, cnc_rddynamic); the bits between are not used."""

    PS100 = 1 << 0
    PS000 = 1 << 1
    PS101 = 1 << 2
    PS_OTHER = 1 << 3
    OVERTRAVEL = 1 << 4
    OVERHEAT = 1 << 5
    SERVO = 1 << 6
    APC = 1 << 8
    PS5000 = 1 << 10
    EXTERNAL = 1 << 15


_SINGLE = {100: AlarmBit.PS100, 0: AlarmBit.PS000, 101: AlarmBit.PS101}
_RANGES = (
    (range(300, 400), AlarmBit.APC, AlarmKind.SERVO),
    (range(400, 500), AlarmBit.SERVO, AlarmKind.SERVO),
    (range(500, 600), AlarmBit.OVERTRAVEL, AlarmKind.TRAVEL),
    (range(700, 750), AlarmBit.OVERHEAT, AlarmKind.SYSTEM),
    (range(1000, 2000), AlarmBit.EXTERNAL, AlarmKind.PLC),
    (range(5000, 6000), AlarmBit.PS5000, AlarmKind.PROGRAM),
)
_OTHER = AlarmBit.PS_OTHER, AlarmKind.PROGRAM

_POWER = ClearedBy.POWER
_TEXTS = {
    0: ("PLEASE TURN OFF POWER", _POWER),
    100: ("PARAMETER WRITE ENABLE", ClearedBy.RESET),
    101: ("PLEASE CLEAR MEMORY", _POWER),
    300: ("{axis} AXIS NEED ZRN", ClearedBy.RESET),
    417: ("{axis} AXIS DGTL PARAM", ClearedBy.RESET),
    700: ("OVERHEAT: CONTROL UNIT", ClearedBy.RESET),
}


def _of(number: int) -> tuple[AlarmBit, AlarmKind]:
    return next(((bit, kind) for numbers, bit, kind in _RANGES if number in numbers), _OTHER)


# fmt: off
_MACRO_TEXTS = {
    76: "ADDRESS P NOT DEFINED",             77: "SUB PROGRAM NESTING ERROR",
    78: "NUMBER NOT FOUND",                 111: "CALCULATED DATA OVERFLOW",
    112: "DIVIDED BY ZERO",                 113: "IMPROPER COMMAND",
    114: "FORMAT ERROR IN MACRO",           115: "ILLEGAL VARIABLE NUMBER",
    116: "WRITE PROTECTED VARIABLE",        118: "PARENTHESIS NESTING ERROR",
    119: "ILLEGAL ARGUMENT",                122: "FOUR FOLD MACRO MODAL-CALL",
    124: "MISSING END STATEMENT",           125: "FORMAT ERROR IN MACRO",
    126: "ILLEGAL LOOP NUMBER",             127: "NC, MACRO STATEMENT IN SAME BLOCK",
    128: "ILLEGAL MACRO SEQUENCE NUMBER",   129: "ILLEGAL ARGUMENT ADDRESS",
}
# fmt: on
_PROGRAM = "program "
_MACRO_ALARM = "program MC"  # raised by the program itself (#3000): its text is the program's
_MACRO_ERROR = "program PS"


class _Table(dict[str, AlarmRow]):
    """The alarms that the control puts on itself, every number by the name "alarm NUMBER", errors of macros."""

    def __contains__(self, name: object) -> bool:
        return super().__contains__(name) or (
            isinstance(name, str) and name.startswith((PREFIX, _MACRO_ALARM, _MACRO_ERROR))
        )

    def __missing__(self, name: str) -> AlarmRow:
        if name.startswith(_PROGRAM):
            number = int(name[len(_MACRO_ALARM) :])
            return AlarmRow(number, AlarmKind.PROGRAM, _MACRO_TEXTS.get(number, "{detail}"))
        number = int(name.removeprefix(PREFIX))
        text, cleared_by = _TEXTS.get(number, ("{detail}", ClearedBy.RESET))
        return AlarmRow(number, _of(number)[1], text, cleared_by)


# fmt: off
POWER_MATE_ALARMS = _Table({
    "program":               AlarmRow(10, AlarmKind.PROGRAM, "{detail}"),
    "soft_limit_low":        AlarmRow(501, AlarmKind.TRAVEL, "OVER TRAVEL : -{axis}"),
    "soft_limit_high":       AlarmRow(500, AlarmKind.TRAVEL, "OVER TRAVEL : +{axis}"),
    "program soft_limit_low":  AlarmRow(511, AlarmKind.TRAVEL, "OVER TRAVEL : -{axis}"),
    "program soft_limit_high": AlarmRow(510, AlarmKind.TRAVEL, "OVER TRAVEL : +{axis}"),
    "limit_switch_low":      AlarmRow(507, AlarmKind.TRAVEL, "OVER TRAVEL : -{axis}"),
    "limit_switch_high":     AlarmRow(506, AlarmKind.TRAVEL, "OVER TRAVEL : +{axis}"),
    "reference_not_found":   AlarmRow(90, AlarmKind.PROGRAM, "REFERENCE RETURN INCOMPLETE: {axis} ({detail})"),
    "following_error":       AlarmRow(411, AlarmKind.SERVO, "SERVO ALARM: {axis} AXIS EXCESS ERROR"),
    "function_failed":       AlarmRow(1000, AlarmKind.PLC, "{detail}"),
    "function_not_answered": AlarmRow(1001, AlarmKind.PLC, "{detail} NOT ANSWERED"),
    "emergency_stop":        AlarmRow(-1, AlarmKind.EMERGENCY, "EMERGENCY STOP", ClearedBy.CAUSE),
})
# fmt: on
"""The emergency stop is a state of this control and no alarm with a number: -1 is never shown."""


def shown(alarms: Iterable[Alarm]) -> tuple[Alarm, ...]:
    """Return the alarms that the control shows: those with a number."""
    return tuple(alarm for alarm in alarms if alarm.number >= 0)


def bit_of(number: int) -> AlarmBit:
    """Return the group of an alarm number."""
    return _SINGLE.get(number) or _of(number)[0]


def is_macro_alarm(alarm: Alarm) -> bool:
    """Tell whether a program raised an alarm itself (#3000)."""
    return alarm.name.startswith(_MACRO_ALARM)


def alarm_bits(alarms: Iterable[Alarm]) -> AlarmBit:
    """Return the groups of the alarms that are on."""
    bits = AlarmBit(0)
    for alarm in shown(alarms):
        bits |= bit_of(alarm.number)
    return bits
