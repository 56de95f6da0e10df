"""Functions about custom macro variables (Manual 000, NC data files)."""

from __future__ import annotations

from typing import Annotated

from polycnc.controllers.fanuc.data._macro_variables import (
    Value,
    binary_pair,
    decimal_pair,
    from_binary,
    from_decimal,
)
from polycnc.controllers.fanuc.device._power_mate import PowerMate
from polycnc.controllers.fanuc.library._call import call, check_length
from polycnc.controllers.fanuc.library._codes import EW
from polycnc.controllers.fanuc.library._network import Link
from polycnc.controllers.fanuc.library._structs import IODBMR, ODBM, ODBMVINF
from polycnc.controllers.library import IN, LONG, SHORT, LengthOf, Out, Refused, variant
from polycnc.nc.macro import LOCALS

_SINGLE = 10
_HEADER = 6
_ENTRY = 6
DECIMAL = 0


def _block(link: Link, first: int, last: int) -> range:
    """Return the numbers of a range that lies in one block of variables.

    Raises:
        Refused: It does not. Ruling: nor may it reach across a gap.
    """
    block = link.device.macros.block(first)
    if block is None or last not in block or last < first:
        raise Refused(EW.EW_NUMBER)
    return range(first, last + 1)


def _pair(link: Link, device: PowerMate, number: int) -> tuple[int, int]:
    if number <= LOCALS:
        value, kept = device.custom_macros.local(number), None
    else:
        value, kept = device.macros.get(number), device.macros.pair(number)
    if link.macro_type != DECIMAL:
        return binary_pair(value)
    return kept or decimal_pair(value)


def _value(link: Link, mantissa: int, exponent: int) -> Value | None:
    try:
        return (from_decimal if link.macro_type == DECIMAL else from_binary)(mantissa, exponent)
    except ValueError:
        raise Refused(EW.EW_DATA) from None


def _check_writable(numbers: range) -> None:
    if numbers[0] <= LOCALS:
        raise Refused(EW.EW_NUMBER)  # ruling: local variables have no number to write to


@call
def cnc_rdmacro(
    link: Link, number: SHORT, length: Annotated[SHORT, LengthOf("macro")]
) -> tuple[EW, Annotated[ODBM, Out("macro")]]:
    """Read a local or common variable, in the number form of the handle (Manual 000, cnc_rdmacro)."""
    check_length(length, _SINGLE)
    _block(link, number, number)
    mantissa, exponent = _pair(link, link.read("cnc_rdmacro", number), number)
    return EW.EW_OK, ODBM(datano=number, mcr_val=mantissa, dec_val=exponent)


@call
def cnc_wrmacro(link: Link, number: SHORT, length: SHORT, mcr_val: LONG, dec_val: SHORT) -> EW:
    """Write a common variable, in the number form of the handle (Manual 000, cnc_wrmacro)."""
    check_length(length, _SINGLE)
    _check_writable(_block(link, number, number))
    value = _value(link, mcr_val, dec_val)
    link.command().macros.set_all({number: value})
    return EW.EW_OK


@call
def cnc_rdmacror(
    link: Link, s_number: SHORT, e_number: SHORT, length: Annotated[SHORT, LengthOf("macror")]
) -> tuple[EW, Annotated[IODBMR, Out("macror")]]:
    """Read a range of variables (Manual 000, cnc_rdmacror)."""
    check_length(length, _HEADER + _ENTRY * max(1, e_number - s_number + 1))
    numbers = _block(link, s_number, e_number)
    device = link.read("cnc_rdmacror", s_number, e_number)
    data = variant(IODBMR, data=len(numbers))(datano_s=s_number, datano_e=e_number)
    for entry, number in zip(data.data, numbers, strict=True):
        entry.mcr_val, entry.dec_val = _pair(link, device, number)
    return EW.EW_OK, data


@call
def cnc_wrmacror(
    link: Link, length: Annotated[SHORT, LengthOf("macror")], macror: Annotated[IODBMR, IN]
) -> EW:
    """Write a range of common variables, all or none (Manual 000, cnc_wrmacror)."""
    first, last = macror.datano_s, macror.datano_e
    check_length(length, _HEADER + _ENTRY * max(1, last - first + 1))
    numbers = _block(link, first, last)
    _check_writable(numbers)
    if len(numbers) > len(macror.data):
        raise Refused(EW.EW_LENGTH)
    values = {
        number: _value(link, entry.mcr_val, entry.dec_val)
        for number, entry in zip(numbers, macror.data, strict=False)
    }
    link.command().macros.set_all(values)
    return EW.EW_OK


@call
def cnc_rdmacroinfo(link: Link) -> tuple[EW, Annotated[ODBMVINF, Out("mvinf")]]:
    """Tell which variables there are (Manual 000, cnc_rdmacroinfo)."""
    common = link.read("cnc_rdmacroinfo").macros.common
    return EW.EW_OK, ODBMVINF(use_no1=LOCALS, use_no2=int(common))


@call
def cnc_getmactype(link: Link) -> tuple[EW, Annotated[SHORT, Out("macro_type")]]:
    """Return the number form of this handle: 0 is decimal, any other binary (Manual 000, cnc_getmactype)."""
    link.command()
    return EW.EW_OK, link.macro_type


@call
def cnc_setmactype(link: Link, macro_type: SHORT) -> EW:
    """Choose the number form of this handle: 0 is decimal, any other binary (Manual 000, cnc_setmactype)."""
    link.command()
    link.macro_type = macro_type
    return EW.EW_OK


__all__ = [
    "cnc_getmactype",
    "cnc_rdmacro",
    "cnc_rdmacroinfo",
    "cnc_rdmacror",
    "cnc_setmactype",
    "cnc_wrmacro",
    "cnc_wrmacror",
]
