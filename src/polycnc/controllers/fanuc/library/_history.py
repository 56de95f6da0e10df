"""The operation history and the alarm history (Manual 000, operation history)."""

from __future__ import annotations

from typing import Annotated, Any

from polycnc.controllers.fanuc.device._history import NAMES, Kind, Monitored
from polycnc.controllers.fanuc.device._pmc_memory import exists
from polycnc.controllers.fanuc.library._call import call
from polycnc.controllers.fanuc.library._codes import EW
from polycnc.controllers.fanuc.library._network import Link
from polycnc.controllers.fanuc.library._structs import HISTORY_SIGNALS, IODBSIG, ODBAHIS, ODBHIS, ODBHIS_DATA
from polycnc.controllers.library import IN, SHORT, USHORT, LengthOf, Out, Refused, variant

_HEADER = 6
_OPERATION, _ALARM = 8, 48
_OPERATIONS, _ALARMS = 0, 1
_TEXT = 32


@call
def cnc_stopophis(link: Link) -> EW:
    """Stop sampling both histories, so that they can be read (Manual 000, cnc_stopophis)."""
    link.command().history.stop()
    return EW.EW_OK


@call
def cnc_startophis(link: Link) -> EW:
    """Go on with sampling (Manual 000, cnc_startophis)."""
    link.command().history.start()
    return EW.EW_OK


def _check_stopped(link: Link) -> None:
    if not link.device.history.state.stopped:
        raise Refused(EW.EW_FUNC)


@call
def cnc_rdophisno(link: Link) -> tuple[EW, Annotated[USHORT, Out("hisno")]]:
    """Read how many records the operation history has (Manual 000, cnc_rdophisno)."""
    _check_stopped(link)
    return EW.EW_OK, len(link.read("cnc_rdophisno").history.operations())


@call
def cnc_rdalmhisno(link: Link) -> tuple[EW, Annotated[USHORT, Out("hisno")]]:
    """Read how many records the alarm history has (Manual 000, cnc_rdalmhisno)."""
    _check_stopped(link)
    return EW.EW_OK, len(link.read("cnc_rdalmhisno").history.alarms())


def _check_range(link: Link, first: int, last: int, length: int, size: int) -> None:
    _check_stopped(link)
    if first >= 1 and last >= first and length != _HEADER + size * (last - first + 1):
        raise Refused(EW.EW_LENGTH)
    if not 1 <= first <= last:
        raise Refused(EW.EW_NUMBER)


@call
def cnc_rdophistry(
    link: Link, s_no: USHORT, e_no: USHORT, length: Annotated[USHORT, LengthOf("his")]
) -> tuple[EW, Annotated[ODBHIS, Out("his")]]:
    """Read records of the operation history, 1 is the oldest (Manual 000, cnc_rdophistry).

    Ruling: the length must be that of all records asked for; `e_no` says which was the last that there is.
    """
    _check_range(link, s_no, e_no, length, _OPERATION)
    found = link.device.history.operations()
    if s_no > len(found):
        raise Refused(EW.EW_NUMBER)
    found = link.read("cnc_rdophistry", s_no).history.operations()
    made = variant(ODBHIS, data=e_no - s_no + 1)(s_no=s_no, e_no=min(e_no, len(found)))
    for record, each in zip(made.data, found[s_no - 1 : e_no], strict=False):
        _fill(record, each)
    return EW.EW_OK, made


def _fill(record: ODBHIS_DATA, content: dict[str, Any]) -> None:
    """Write a record as its kind has it."""
    kind = Kind(content["kind"])
    record.rec_alm.rec_type = int(kind)
    match kind:
        case Kind.KEY:
            record.rec_mdi.key_code = content["code"]
        case Kind.SIGNAL:
            record.rec_sgn.sig_name = NAMES.index(content["letter"])
            record.rec_sgn.sig_old = content["old"]
            record.rec_sgn.sig_new = content["new"]
            record.rec_sgn.sig_no = content["at"]
        case Kind.ALARM:
            record.rec_alm.alm_grp = content["group"]
            record.rec_alm.alm_no = content["number"]
        case Kind.DATE:
            date = record.rec_date
            date.year, date.month, date.day = content["date"]
            date.pw_flag = content["power"]
        case Kind.TIME:
            time = record.rec_time
            time.hour, time.minute, time.second = content["time"]
            time.pw_flag = content["power"]


@call
def cnc_rdalmhistry(
    link: Link, s_no: USHORT, e_no: USHORT, length: Annotated[USHORT, LengthOf("his")]
) -> tuple[EW, Annotated[ODBAHIS, Out("his")]]:
    """Read records of the alarm history, 1 is the oldest (Manual 000, cnc_rdalmhistry)."""
    _check_range(link, s_no, e_no, length, _ALARM)
    if e_no > len(link.device.history.alarms()):
        raise Refused(EW.EW_NUMBER)
    found = link.read("cnc_rdalmhistry", s_no).history.alarms()[s_no - 1 : e_no]
    made = variant(ODBAHIS, alm_his=e_no - s_no + 1)(s_no=s_no, e_no=e_no)
    for record, (number, axis, time, text) in zip(made.alm_his, found, strict=True):
        record.alm_no, record.axis_no = number, axis
        record.year, record.month, record.day = time.year % 100, time.month, time.day
        record.hour, record.minute, record.second = time.hour, time.minute, time.second
        message = text.encode("ascii", "replace")[:_TEXT]
        record.len_msg, record.alm_msg = len(message), message
    return EW.EW_OK, made


@call
def cnc_clearophis(link: Link, slct: SHORT) -> EW:
    """Clear the operation history (0) or the alarm history (1) (Manual 000, cnc_clearophis)."""
    if slct not in (_OPERATIONS, _ALARMS):
        raise Refused(EW.EW_ATTRIB)
    history = link.command().history
    if slct == _OPERATIONS:
        history.clear_operations()
    else:
        history.clear_alarms()
    return EW.EW_OK


@call
def cnc_rdhissgnl(link: Link) -> tuple[EW, Annotated[IODBSIG, Out("sig")]]:
    """Read which signals the operation history watches (Manual 000, cnc_rdhissgnl)."""
    history = link.read("cnc_rdhissgnl").history
    made = IODBSIG()
    for entry, each in enumerate(made.data, 1):
        signal = history.monitored(entry)
        each.ent_no = entry
        each.sig_no, each.mask_pat = signal.address, signal.mask
        each.sig_name = NAMES.index(signal.letter) if signal.letter else 0
    return EW.EW_OK, made


@call
def cnc_wrhissgnl(link: Link, sig: Annotated[IODBSIG, IN]) -> EW:
    """Choose signals for the operation history; entries that are not named stay (Manual 000, cnc_wrhissgnl)."""
    if not 1 <= sig.type <= HISTORY_SIGNALS:
        raise Refused(EW.EW_ATTRIB)
    entries = {}
    for each in list(sig.data)[: sig.type]:
        if not 1 <= each.ent_no <= HISTORY_SIGNALS or not 0 <= each.sig_name < len(NAMES):
            raise Refused(EW.EW_DATA)
        letter = NAMES[each.sig_name].strip()
        if letter and not exists(letter, each.sig_no, each.sig_no):
            raise Refused(EW.EW_DATA)
        entries[each.ent_no] = Monitored(letter, each.sig_no, each.mask_pat) if letter else Monitored()
    link.command().history.monitor(entries)
    return EW.EW_OK


__all__ = [
    "cnc_clearophis",
    "cnc_rdalmhisno",
    "cnc_rdalmhistry",
    "cnc_rdhissgnl",
    "cnc_rdophisno",
    "cnc_rdophistry",
    "cnc_startophis",
    "cnc_stopophis",
    "cnc_wrhissgnl",
]
