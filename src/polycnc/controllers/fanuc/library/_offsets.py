"""Functions about tool offsets (Manual 000, NC data files)."""

from __future__ import annotations

from typing import Annotated

from polycnc.controllers.fanuc.data._tool_offsets import MEMORY_TYPE
from polycnc.controllers.fanuc.library._call import call, check_length
from polycnc.controllers.fanuc.library._codes import ALL_AXES, EW
from polycnc.controllers.fanuc.library._network import Link
from polycnc.controllers.fanuc.library._structs import IODBTO, ODBTLINF, ODBTOFS
from polycnc.controllers.library import IN, LONG, SHORT, LengthOf, Out, Refused

ALL_TYPES = ALL_AXES
_SINGLE = 8
_HEADER = 6


def _check_numbers(link: Link, *numbers: int) -> None:
    count = link.device.tool_offsets.count
    if any(not 1 <= number <= count for number in numbers) or sorted(numbers) != list(numbers):
        raise Refused(EW.EW_NUMBER)


def _check_type(type: int, *allowed: int) -> None:
    if type not in allowed:
        raise Refused(EW.EW_ATTRIB)


def _write(link: Link, values: dict[int, int]) -> EW:
    limit = link.device.tool_offsets.limit
    if any(abs(value) > limit for value in values.values()):
        raise Refused(EW.EW_DATA)
    link.command().tool_offsets.set_all(values)
    return EW.EW_OK


@call
def cnc_rdtofs(
    link: Link, number: SHORT, type: SHORT, length: Annotated[SHORT, LengthOf("tofs")]
) -> tuple[EW, Annotated[ODBTOFS, Out("tofs")]]:
    """Read a tool offset, in increments (Manual 000, cnc_rdtofs)."""
    check_length(length, _SINGLE)
    _check_numbers(link, number)
    _check_type(type, MEMORY_TYPE)
    value = link.read("cnc_rdtofs", number).tool_offsets.get(number)
    return EW.EW_OK, ODBTOFS(datano=number, type=type, data=value)


@call
def cnc_wrtofs(link: Link, number: SHORT, type: SHORT, length: SHORT, data: LONG) -> EW:
    """Write a tool offset, in increments (Manual 000, cnc_wrtofs). Ruling: out of range it is EW_DATA."""
    check_length(length, _SINGLE)
    _check_numbers(link, number)
    _check_type(type, MEMORY_TYPE)
    return _write(link, {number: data})


@call
def cnc_rdtofsr(
    link: Link, s_number: SHORT, type: SHORT, e_number: SHORT, length: Annotated[SHORT, LengthOf("tofsr")]
) -> tuple[EW, Annotated[IODBTO, Out("tofsr")]]:
    """Read a range of tool offsets (Manual 000, cnc_rdtofsr)."""
    check_length(length, _HEADER + 4 * max(1, e_number - s_number + 1))
    _check_numbers(link, s_number, e_number)
    _check_type(type, MEMORY_TYPE, ALL_TYPES)
    data = IODBTO(datano_s=s_number, type=type, datano_e=e_number)
    if e_number - s_number >= len(data.u.m_ofs):
        raise Refused(EW.EW_LENGTH)
    offsets = link.read("cnc_rdtofsr", s_number, e_number).tool_offsets
    for k in range(e_number - s_number + 1):
        data.u.m_ofs[k] = offsets.get(s_number + k)
    return EW.EW_OK, data


@call
def cnc_wrtofsr(link: Link, length: Annotated[SHORT, LengthOf("tofsr")], tofsr: Annotated[IODBTO, IN]) -> EW:
    """Write a range of tool offsets, all or none (Manual 000, cnc_wrtofsr)."""
    first, last = tofsr.datano_s, tofsr.datano_e
    check_length(length, _HEADER + 4 * max(1, last - first + 1))
    _check_numbers(link, first, last)
    _check_type(tofsr.type, MEMORY_TYPE, ALL_TYPES)
    if last - first >= len(tofsr.u.m_ofs):
        raise Refused(EW.EW_LENGTH)
    return _write(link, {first + k: int(tofsr.u.m_ofs[k]) for k in range(last - first + 1)})


@call
def cnc_rdtofsinfo(link: Link) -> tuple[EW, Annotated[ODBTLINF, Out("tlinf")]]:
    """Tell type and size of the tool offset memory (Manual 000, cnc_rdtofsinfo)."""
    count = link.read("cnc_rdtofsinfo").tool_offsets.count
    return EW.EW_OK, ODBTLINF(ofs_type=MEMORY_TYPE, use_no=count)


__all__ = ["cnc_rdtofs", "cnc_rdtofsinfo", "cnc_rdtofsr", "cnc_wrtofs", "cnc_wrtofsr"]
