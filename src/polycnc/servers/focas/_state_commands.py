"""Commands that read what the control is and does: system, state, alarms, messages, axes, spindle, modal words."""

from __future__ import annotations

import math
from datetime import datetime

from polycnc.cnc import PROGRAM_MESSAGE, Alarm
from polycnc.controllers.fanuc import (
    MODAL_ADDRESSES,
    MODAL_CODES,
    PANEL_SIGNALS,
    AlarmBit,
    bit_of,
    is_macro_alarm,
    read_state,
    shown,
)
from polycnc.controllers.fanuc.wire import POSITION_KINDS, Content, Request, Value8, text
from polycnc.nc import Group
from polycnc.servers.focas._command import (
    ALL,
    ATTRIBUTE,
    DATA,
    LENGTH,
    MOST_NUMBERS,
    NO_OPTION,
    NOT_THERE,
    NUMBER,
    RefusedError,
    View,
    answers,
    axes_of,
    given,
    named,
    padded,
)


@answers(0x18)
def system(view: View, request: Request) -> Content:
    """Return the 18 bytes that say which control this is."""
    profile = view.profile
    return {
        "addinfo": profile.additional_info,
        "max_axis": profile.most_axes,
        "cnc_type": profile.cnc_type,
        "mt_type": profile.machine_type,
        "series": profile.series,
        "version": profile.software,
        "axes": f"{view.control.axes:02d}",
    }


_LATER_RUN = {4: 3}
_LATER_MOTION = {3: 2}


@answers(0x19)
def state(view: View, request: Request) -> Content:
    """Return mode, run state, motion, functions, emergency stop, alarm and editing."""
    found = named(request, read_state(view.control))
    if not view.profile.old_states:
        found["run"] = _LATER_RUN.get(found["run"], found["run"])
        found["motion"] = _LATER_MOTION.get(found["motion"], found["motion"])
    return found


@answers(0xE1)
def handle_retrace(view: View, request: Request) -> Content:
    """Return the state of manual handle retrace: 0, since this control never retraces by the handle."""
    return {"hdck": bytes(4)}


@answers(0x98)
def machining_type(view: View, request: Request) -> Content:
    """Return the side of a compound machine that is chosen: 0, as it is on every other one."""
    return {"tmmode": 0}


_TYPES = (  # alarm groups by the type numbers of later series
    (AlarmBit.PS100 | AlarmBit.PS000 | AlarmBit.PS101 | AlarmBit.PS_OTHER | AlarmBit.PS5000, 3),
    (AlarmBit.OVERTRAVEL, 4),
    (AlarmBit.OVERHEAT, 5),
    (AlarmBit.SERVO | AlarmBit.APC, 6),
    (AlarmBit.EXTERNAL, 15),
)


_MACRO_ALARM = 8


def _type_of(view: View, alarm: Alarm) -> int:
    """Return the type of an alarm; only new series have one for those of macros (#3000)."""
    if view.profile.wide_values and is_macro_alarm(alarm):
        return _MACRO_ALARM
    bits = bit_of(alarm.number)
    return next(number for group, number in _TYPES if bits & group)


@answers(0x1A)
def alarm_bits(view: View, request: Request) -> Content:
    """Return the groups of the alarms that are on."""
    if view.profile.old_states:
        return {"alarms": int(view.control.power.alarm_bits)}
    later = 0
    for alarm in shown(view.control.control.alarms.active):
        later |= 1 << _type_of(view, alarm)
    return {"alarms": later}


_ALARM_HEAD = 16
_TEXTS = range(3)


@answers(0x23)
def alarms(view: View, request: Request) -> Content:
    """Return the alarms that are on, of one type or all, as many as are asked for and fit a frame."""
    kind, most, mode, size = request.arguments
    if not (0 <= most <= MOST_NUMBERS and 0 <= size <= 64):
        raise RefusedError(LENGTH)
    if not (ALL <= kind <= view.profile.last_alarm_type and mode in _TEXTS):
        raise RefusedError(ATTRIBUTE)
    rows = []
    names = [view.control.units.axis_name(axis) for axis in range(1, view.control.axes + 1)]
    for alarm in shown(view.control.control.alarms.active):
        number = _type_of(view, alarm)
        if kind in (ALL, number):
            axis = names.index(alarm.axis) + 1 if alarm.axis in names else 0
            words = text(alarm.text, size if mode else 0)
            length = len(words.rstrip(b"\0"))
            rows.append(
                {"number": alarm.number, "type": number, "axis": axis, "length": length, "text": words}
            )
    room = view.profile.most_body // (_ALARM_HEAD + size)
    return rows[: min(most, room)]


_MESSAGE_SIZE = 268
_OPERATOR, _MACRO_STOP = 0, 4


@answers(0x34)
def messages(view: View, request: Request) -> Content:
    """Return messages: those from outside (0), those of stops in macros (4); there are no others, so they are empty."""
    kind = request.arguments[0]
    if not 0 <= kind <= _MACRO_STOP:
        raise RefusedError(ATTRIBUTE)
    if not view.control.has_option("external_message"):
        raise RefusedError(NO_OPTION)
    made = [
        {"number": each.number, "type": kind, "length": len(words.rstrip(b"\0")), "text": words}
        for each in view.control.control.messages.shown
        if kind == (_MACRO_STOP if each.number == PROGRAM_MESSAGE else _OPERATOR)
        for words in [text(each.text, 256)]
    ]
    return made[: view.profile.most_body // _MESSAGE_SIZE]


# ---------------------------------------------------------------------- axes and spindle


_SKIP = "skip"


@answers(0x26)
def positions(view: View, request: Request) -> Content:
    """Return positions of a kind, of one axis or all."""
    kind, asked = request.arguments[:2]
    name = POSITION_KINDS.get(kind)
    if name is None:
        raise RefusedError(NUMBER)
    control = view.control
    made = []
    for axis in axes_of(view, asked):
        units = control.units.output_scale(axis) if name == "machine" else control.units.input_scale(axis)
        counts = (
            control.skip.positions[axis - 1] if name == _SKIP else getattr(view.positions[axis - 1], name)
        )
        made.append(Value8(counts, units.decimals))
    return padded(made, view, asked)


@answers(0x24)
def feed(view: View, request: Request) -> Content:
    """Return the actual feed: mm/min, with inch input 0.01 inch/min."""
    return {"feed": Value8(view.control.positions.feed(), 2 if view.control.units.inch_input else 0)}


@answers(0x25)
def spindle_speed(view: View, request: Request) -> Content:
    """Return the actual spindle speed."""
    return {"rpm": Value8.of(abs(view.control.control.spindle.state().actual_rpm), 0)}


@answers(0x89)
def axis_names(view: View, request: Request) -> Content:
    """Return the names of the axes."""
    names = (view.control.units.axis_name(axis) for axis in range(1, view.control.axes + 1))
    return [{"name": each[:1], "suffix": each[1:]} for each in names]


@answers(0x8A)
def spindle_names(view: View, request: Request) -> Content:
    """Return the name of the spindle."""
    return [{"name": "S", "suffix": "1"}]


_SPINDLES = 1


@answers(0xA4)
def counts(view: View, request: Request) -> Content:
    """Return how many spindles (1) or axes there are."""
    return {"count": 1 if request.arguments[0] == _SPINDLES else view.control.axes}


_LOAD_PERCENT, _KINDS_OF_METERS = 1, range(4)


@answers(0x56)
def servo_meter(view: View, request: Request) -> Content:
    """Return the load of the servo motors in percent.

    It follows the speed, as the current of `cnc_rdcurrent` does: 100 at the highest speed of the axis, no more than
    the torque override allows, and none with the servo off. Amperes this control does not know.
    """
    if request.arguments[0] != _LOAD_PERCENT:
        raise RefusedError(NOT_THERE if request.arguments[0] in _KINDS_OF_METERS else ATTRIBUTE)
    signals = view.control.signals
    made = []
    for number, axis in enumerate(view.control.control.axes().values(), 1):
        share = math.copysign(axis.load_percent, axis.velocity)
        most = signals.torque_override(number)
        made.append(Value8.of(0.0 if signals.state.servo_is_off(number) else max(-most, min(most, share)), 0))
    return padded(made, view)


_RAW_LOAD, _MOST_RPM, _LOAD_METER, _MOTOR_RPM = 0, 1, 4, 5


@answers(0x40)
def spindle(view: View, request: Request) -> Content:
    """Return the load of the spindle in percent, its highest speed, or its speed now.

    The load follows the speed, as that of the servo motors does. An old series answers the load meter with the code
    that makes the library ask otherwise.
    """
    kind, asked = request.arguments[:2]
    if asked not in (ALL, 1):
        raise RefusedError(ATTRIBUTE)
    most = view.control.machine.config.spindle.max_rpm
    rpm = abs(view.control.control.spindle.state().actual_rpm)
    if kind in (_RAW_LOAD, _LOAD_METER) and view.profile.wide_values:
        value = 100.0 * rpm / most
    elif kind in (_MOST_RPM, _MOTOR_RPM):
        value = most if kind == _MOST_RPM else rpm
    else:
        raise RefusedError(ATTRIBUTE if kind == _LOAD_METER else NOT_THERE)
    others = view.profile.most_spindles - 1 if asked == ALL else 0
    return [Value8.of(value, 0), *[0] * others]


_AXES, _OFFSET, _MACRO, _ZERO, _CUT = range(5)


@answers(0x1B)
def figures(view: View, request: Request) -> Content:
    """Return the decimals of positions, tool offsets, macro variables, work zero offsets or the cutting feed."""
    control = view.control
    least = control.units.increment.decimals + control.units.inch_input
    if request.arguments[0] in (_AXES, _ZERO):
        pairs = [
            (control.units.input_scale(axis).decimals, control.units.output_scale(axis).decimals)
            for axis in range(1, control.axes + 1)
        ]
    elif request.arguments[0] in (_OFFSET, _MACRO):
        pairs = [(max(least, 3) if request.arguments[0] == _MACRO else least,) * 2]
    elif request.arguments[0] == _CUT:
        pairs = [(2 if control.units.inch_input else 0,) * 2]
    else:
        raise RefusedError(ATTRIBUTE)
    decimals = [{"input_decimals": given, "output_decimals": shown} for given, shown in pairs]
    return {"count": len(pairs)}, decimals


# ---------------------------------------------------------------------- modal words


_BLOCKS = range(3)
_GROUPS = {
    0: Group.MOTION, 1: Group.PLANE, 2: Group.DISTANCE, 4: Group.FEED_MODE, 5: Group.UNITS,
    6: Group.RADIUS_COMPENSATION, 7: Group.LENGTH_COMPENSATION, 12: Group.SPINDLE_MODE, 13: Group.WORK_OFFSET,
    14: Group.STOPPING, 15: Group.ROTATION, 16: Group.POLAR,
}  # fmt: skip
_LAST_GROUP = 23
_WITH_DECIMAL = 1


@answers(0x96)
def modal_code(view: View, request: Request) -> Content:
    """Return the G code of a group that holds with the executed block or one of the next two.

    Of the blocks that come next only the groups of `cnc_modal` are known; what is not known is refused.
    """
    group, block = request.arguments[:2]
    if not 0 <= group <= _LAST_GROUP:
        raise RefusedError(NUMBER)
    if block not in _BLOCKS:
        raise RefusedError(ATTRIBUTE)
    code = code_of(view, group, block)
    if code is None:
        raise RefusedError(NOT_THERE)
    whole, _, tenth = code.partition(".")
    number = int(whole + tenth)
    return [{"group": group, "code": number, "tenths": _WITH_DECIMAL if tenth else 0}]


def code_of(view: View, group: int, block: int = 0) -> str | None:
    """Return the G code of a group that holds with a block, like 54.1; None where it is not known."""
    control = view.control
    if group in MODAL_CODES:
        value, _ = control.modal_data.block(block).g[group]
        return next(name for name, number in MODAL_CODES[group].items() if number == value)
    executed = control.execution.block
    word = executed.modal.g.get(_GROUPS[group]) if executed and not block and group in _GROUPS else None
    code = "" if word is None else word.removeprefix("G")
    return code if code.replace(".", "", 1).isdigit() else None


_COMMANDS = "DEFHLMNOST"
_FIRST_ADDRESS = 100
_HERE, _POINT, _NEGATIVE, _DIGITS = 0x80, 0x40, 0x20, 0x1F


@answers(0x97)
def commanded(view: View, request: Request) -> Content:
    """Return the last word of an address, or of ten of them, as it is written."""
    asked, block = request.arguments[:2]
    if block not in _BLOCKS:
        raise RefusedError(ATTRIBUTE)
    names = list(_COMMANDS) if asked == ALL else []
    if 0 <= asked - _FIRST_ADDRESS < len(MODAL_ADDRESSES):
        names = [MODAL_ADDRESSES[asked - _FIRST_ADDRESS]]
    if not names:
        raise RefusedError(NUMBER)
    words = view.control.modal_data.block(block).words
    made = []
    for name in names:
        word = words.get(name)
        written = "" if word is None else word.text
        digits = "".join(each for each in written if each.isdigit())
        value = int(digits or 0) * (-1 if written.startswith("-") else 1)
        flag = (_HERE if word is not None and word.here else 0) | (_POINT if "." in written else 0)
        flag |= (_NEGATIVE if value < 0 else 0) | len(digits) & _DIGITS
        which, decimals = int(name[1:] or 1), len(written.partition(".")[2])
        made.append({"letter": name[0], "which": which, "flag": flag, "value": value, "decimals": decimals})
    return made


_PANEL = {  # by the names of the record: those of the panel
    "mode": "mode", "handle_axis": "hndl_ax", "handle_step": "hndl_mv", "rapid_override": "rpd_ovrd",
    "jog_override": "jog_ovrd", "feed_override": "feed_ovrd", "spindle_override": "spdl_ovrd",
    "block_delete": "blck_del", "single_block": "sngl_blck", "machine_lock": "machn_lock", "dry_run": "dry_run",
    "protect": "mem_prtct", "feed_hold": "feed_hold",
}  # fmt: skip
_PANEL_BITS = {name: bit for bit, (name, _) in PANEL_SIGNALS.items()}


@answers(0x5D)
def panel(view: View, request: Request) -> Content:
    """Return the signals of the software operator's panel that the mask names; the others are 0."""
    mask = request.arguments[0]
    made = {}
    for field, name in _PANEL.items():
        bit = _PANEL_BITS.get(name)
        made[field] = view.control.panel.value(name) if bit is not None and mask >> bit & 1 else 0
    return made


# ---------------------------------------------------------------------- date and time


_DATE, _TIME = 0, 1


@answers(0x45)
def clock(view: View, request: Request) -> Content:
    """Return date and time, whichever was asked for: clients take the half that they want."""
    return named(request, view.control.clock.now)


@answers(0x46, writes=True)
def set_clock(view: View, request: Request) -> Content:
    """Set the date or the time of the control."""
    year, month, day, *time = given(request).values()
    now = view.control.clock.now
    try:
        if request.arguments[0] == _DATE:
            wanted = datetime.combine(datetime(year, month, day), now.time())
        elif request.arguments[0] == _TIME:
            wanted = datetime(now.year, now.month, now.day, *time)
        else:
            raise RefusedError(ATTRIBUTE)
        if not 1980 <= wanted.year < 2100:
            raise RefusedError(DATA)
    except ValueError:
        raise RefusedError(DATA) from None
    view.control.clock.set_now(wanted)
    return None
