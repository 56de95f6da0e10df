"""Functions about the control itself: system, state, alarms, figures, servo values, messages (Manual 000)."""

from __future__ import annotations

import math
from typing import Annotated

from polycnc.cnc import PROGRAM_MESSAGE
from polycnc.controllers.fanuc.data._configuration import (
    CNC_SOFTWARE,
    DRAM_MODULES,
    END_OF_LIST,
    FROM_MODULES,
    PMC_MODULES,
    SOFTWARE,
    SRAM_MODULES,
    SUB_BOARDS,
)
from polycnc.controllers.fanuc.data._increment import Increment
from polycnc.controllers.fanuc.device._alarms import AlarmBit, bit_of, shown
from polycnc.controllers.fanuc.device._power_mate import PowerMate
from polycnc.controllers.fanuc.device._state import read_state
from polycnc.controllers.fanuc.library._call import call, check_length
from polycnc.controllers.fanuc.library._codes import EW
from polycnc.controllers.fanuc.library._network import Link
from polycnc.controllers.fanuc.library._structs import (
    ALMINFO,
    HEADER,
    MSG_SIZE,
    ODBALM,
    ODBST,
    ODBSYS,
    ODBSYSC,
    OPMSG,
)
from polycnc.controllers.library import INOUT, LONG, SHORT, LengthOf, Many, Out, Pointer, Refused

_END = -1
_ALARM_SIZES = (4, 38)
_USED_BITS = int(AlarmBit(0x857F))
_MACRO_MESSAGE = 4
_MESSAGE_NUMBERS = (range(100, 1000), range(2000, 2100))
_MESSAGE_OPTIONS = ("external_message", "external_data_input")
_MESSAGE_HEADER = 6
_AXIS_DATA, _TOOL_OFFSET, _MACRO = range(3)
_FIGURES = (8, 7, 8)
_MM_MIN = 60.0


@call
def cnc_sysinfo(link: Link) -> tuple[EW, Annotated[ODBSYS, Out("sysinfo")]]:
    """Read kind, software and number of axes; texts do not end in a zero (Manual 000, cnc_sysinfo)."""
    device = link.read("cnc_sysinfo")
    series, version = SOFTWARE[device.model]
    return EW.EW_OK, ODBSYS(
        max_axis=device.max_axis,
        cnc_type=b"PM",
        mt_type=device.model.rjust(2).encode(),
        series=series.encode(),
        version=version.encode(),
        axes=str(device.axes).rjust(2).encode(),
    )


@call
def cnc_sysconfig(link: Link) -> tuple[EW, Annotated[ODBSYSC, Out("sysinfo")]]:
    """Read software and modules of the control; -1 is what is not there (Manual 000, cnc_sysconfig)."""
    device = link.read("cnc_sysconfig")
    parts = device.configuration
    made = ODBSYSC(
        soft_id=[CNC_SOFTWARE, END_OF_LIST],
        svo_soft=parts.servo.encode(),
        pmc_soft=parts.pmc.encode(),
        lad_soft=parts.ladder.ljust(6).encode(),
        mcr_soft=[1, *parts.macro_executor.encode()] if parts.macro_executor else [0xFF],
        frmmin=FROM_MODULES[parts.from_module],
        drmmin=DRAM_MODULES[parts.dram_module],
        srmmin=SRAM_MODULES[parts.sram_module],
        pmcmin=PMC_MODULES[parts.pmc_module],
        sv1min=0,
        sv3min=_there(device.axes > 2),
        sv5min=_there(device.axes > 4),
        sicmin=_there(parts.sic),
        posmin=_there(parts.position_lsi),
        submin=SUB_BOARDS[parts.sub_board],
        hdiio=_there(parts.high_speed_skip),
    )
    series, version = SOFTWARE[device.model]
    made.s_series[0].value = series.encode()
    made.s_version[0].value = version.encode()
    return EW.EW_OK, made


def _there(module: bool) -> int:
    return 0 if module else -1


@call
def cnc_statinfo(link: Link) -> tuple[EW, Annotated[ODBST, Out("statinfo")]]:
    """Read mode, run state, motion, functions, emergency stop, alarm and editing (Manual 000, cnc_statinfo)."""
    state = read_state(link.read("cnc_statinfo"), uploading=link.upload is not None)
    return EW.EW_OK, ODBST(
        aut=state.aut,
        run=state.run,
        motion=state.motion,
        mstb=state.mstb,
        emergency=state.emergency,
        alarm=state.alarm,
        edit=state.edit,
    )


@call
def cnc_alarm(link: Link) -> tuple[EW, Annotated[ODBALM, Out("alarm")]]:
    """Read the groups of the alarms that are on, as bits (Manual 000, cnc_alarm)."""
    return EW.EW_OK, ODBALM(data=int(link.read("cnc_alarm").power.alarm_bits))


@call
def cnc_rdalminfo(
    link: Link, type: SHORT, alm_type: SHORT, length: Annotated[SHORT, LengthOf("alarminfo")]
) -> tuple[EW, Annotated[ALMINFO, Out("alarminfo")]]:
    """Read number, axis and, with `type` 1, text of alarms of the chosen groups (Manual 000, cnc_rdalminfo).

    Ruling: as many alarms as `length` has room for, oldest first; after the last one stands FFFFH.
    """
    if type not in (0, 1):
        raise Refused(EW.EW_NUMBER)
    size = _ALARM_SIZES[type]
    if length < size + 2 or (length - 2) % size:
        raise Refused(EW.EW_LENGTH)
    if not alm_type & _USED_BITS:
        raise Refused(EW.EW_ATTRIB)
    device = link.read("cnc_rdalminfo", type, alm_type)
    room = (length - 2) // size
    made = HEADER.make("ALMINFO", ALARMS=room)()
    part = made.u.alm2 if type else made.u.alm1
    part.data_end = _END
    wanted = [each for each in shown(device.control.alarms.active) if int(bit_of(each.number)) & alm_type]
    for k, each in enumerate(wanted[:room]):
        part.alm[k].axis = _axis_number(device, each.axis)
        part.alm[k].alm_no = each.number
        if type:
            text = each.text.encode("ascii", "replace")[:32]
            part.alm[k].msg_len = len(text)
            part.alm[k].alm_msg = text
    if len(wanted) < room:
        part.alm[len(wanted)].axis = _END
    return EW.EW_OK, made


def _axis_number(device: PowerMate, name: str | None) -> int:
    names = device.machine.config.axis_names
    return names.index(name) + 1 if name in names else 0


@call
def cnc_getfigure(
    link: Link, data_type: SHORT
) -> tuple[
    EW,
    Annotated[int, SHORT, Out("valid_fig")],
    Annotated[list[int], SHORT, Out("dec_fig_in"), Many("MAX_AXIS")],
    Annotated[list[int], SHORT, Out("dec_fig_out"), Many("MAX_AXIS")],
]:
    """Read digits and decimals of axis data, tool offsets and macro variables (Manual 000, cnc_getfigure).

    Ruling: of tool offsets and macro variables the decimals stand in the first element of both arrays.
    """
    if data_type not in (_AXIS_DATA, _TOOL_OFFSET, _MACRO):
        raise Refused(EW.EW_ATTRIB)
    device = link.read("cnc_getfigure", data_type)
    none = [0] * device.max_axis
    if data_type == _AXIS_DATA:
        axes = range(1, device.axes + 1)
        read = [device.units.input_scale(axis).decimals for axis in axes]
        shown_ = [device.units.output_scale(axis).decimals for axis in axes]
        return (EW.EW_OK, _FIGURES[data_type], read + none[device.axes :], shown_ + none[device.axes :])
    increment = device.units.increment
    if data_type == _MACRO and increment is Increment.IS_A:
        increment = Increment.IS_B
    decimals = increment.decimals + int(device.units.inch_input)
    return EW.EW_OK, _FIGURES[data_type], [decimals, *none[1:]], [decimals, *none[1:]]


@call
def cnc_rdcurrent(link: Link) -> tuple[EW, Annotated[list[int], LONG, Out("crrnt"), Many("MAX_AXIS")]]:
    """Read the motor current of each axis (Manual 000, cnc_rdcurrent).

    Ruling: parameter 2086 is the current at the highest speed of the axis, and the current follows the speed; the
    torque override limits it, and with the servo off there is none.
    """
    device = link.read("cnc_rdcurrent")
    found = [0] * device.max_axis
    for k, axis in enumerate(device.control.axes().values()):
        rated = device.parameters.value(2086, k + 1)
        share = math.copysign(axis.load_percent / 100.0, axis.velocity)
        most = device.signals.torque_override(k + 1) / 100.0
        if not device.signals.state.servo_is_off(k + 1):
            found[k] = round(rated * max(-most, min(most, share)))
    return EW.EW_OK, found


@call
def cnc_rdsrvspeed(link: Link) -> tuple[EW, Annotated[list[int], LONG, Out("speed"), Many("MAX_AXIS")]]:
    """Read the actual speed of each axis (Manual 000, cnc_rdsrvspeed). Ruling: mm/min, deg/min."""
    device = link.read("cnc_rdsrvspeed")
    speeds = [round(axis.velocity * _MM_MIN) for axis in device.control.axes().values()]
    return EW.EW_OK, speeds + [0] * (device.max_axis - len(speeds))


@call
def cnc_rdloopgain(link: Link) -> tuple[EW, Annotated[list[int], LONG, Out("gain"), Many("MAX_AXIS")]]:
    """Read the loop gain of each axis (Manual 000, cnc_rdloopgain). Ruling: 0.01/s, parameter 1825."""
    device = link.read("cnc_rdloopgain")
    gains = [device.parameters.value(1825, axis) for axis in range(1, device.axes + 1)]
    return EW.EW_OK, gains + [0] * (device.max_axis - len(gains))


# ---------------------------------------------------------------------- messages


def _messages(device: PowerMate, *types: int) -> list[OPMSG]:
    """Return the messages of these types that are shown, oldest first: 0 from outside, 4 stops in macros (#3006)."""
    found = []
    for each in device.control.messages.shown:
        outside = any(each.number in numbers for numbers in _MESSAGE_NUMBERS)
        kind = 0 if outside else _MACRO_MESSAGE if each.number == PROGRAM_MESSAGE else -1
        if kind in types:
            text = each.text.encode("ascii", "replace")[: MSG_SIZE - 1]
            found.append(OPMSG(datano=each.number, type=kind, char_num=len(text), data=text))
    return found


def _check_message_options(device: PowerMate) -> None:
    if not all(map(device.has_option, _MESSAGE_OPTIONS)):
        raise Refused(EW.EW_NOOPT)


@call
def cnc_rdopmsg(
    link: Link, type: SHORT, length: Annotated[SHORT, LengthOf("opmsg")]
) -> tuple[EW, Annotated[OPMSG, Out("opmsg")]]:
    """Read the first message to the operator; its number is -1 if there is none (Manual 000, cnc_rdopmsg)."""
    check_length(length, _MESSAGE_HEADER + MSG_SIZE)
    if type != 0:
        raise Refused(EW.EW_ATTRIB)
    _check_message_options(link.device)
    found = _messages(link.read("cnc_rdopmsg"), 0)
    return EW.EW_OK, found[0] if found else OPMSG(datano=_END)


@call
def cnc_rdopmsg3(
    link: Link, type: SHORT, num: Annotated[SHORT, INOUT]
) -> tuple[EW, SHORT, Annotated[list[OPMSG], Pointer("OPMSG *", of=OPMSG), Out("opmsg"), Many("num")]]:
    """Read at most `num` messages to the operator, 0 from outside, 4 of macros, -1 all; return how many there were."""
    if num < 1:
        raise Refused(EW.EW_LENGTH)
    if type not in (-1, 0, _MACRO_MESSAGE):
        raise Refused(EW.EW_ATTRIB)
    _check_message_options(link.device)
    found = _messages(link.read("cnc_rdopmsg3"), *((0, _MACRO_MESSAGE) if type == -1 else (type,)))[:num]
    return EW.EW_OK, len(found), found


__all__ = [
    "cnc_alarm",
    "cnc_getfigure",
    "cnc_rdalminfo",
    "cnc_rdcurrent",
    "cnc_rdloopgain",
    "cnc_rdopmsg",
    "cnc_rdopmsg3",
    "cnc_rdsrvspeed",
    "cnc_statinfo",
    "cnc_sysconfig",
    "cnc_sysinfo",
]
