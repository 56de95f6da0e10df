"""Functions about parameters and settings (Manual 000, NC data files)."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterable, Sequence
from typing import Annotated

from polycnc.controllers.fanuc.data._parameter_rows import Attribute, Kind, ParameterRow
from polycnc.controllers.fanuc.data._parameters import NO_AXIS, Change
from polycnc.controllers.fanuc.device._power_mate import PowerMate
from polycnc.controllers.fanuc.library._call import call, check_length
from polycnc.controllers.fanuc.library._codes import ALL_AXES, EW
from polycnc.controllers.fanuc.library._network import Link
from polycnc.controllers.fanuc.library._structs import IODBPSD, ODBPARAIF
from polycnc.controllers.library import IN, INOUT, SHORT, USHORT, Bytes, LengthOf, Out, Refused, variant

_HEADER = 4
_ALL_IN_RECORD = 0xFF
_NO_NUMBER = -1
_FORMATS = {Kind.BIT: "b", Kind.BYTE: "b", Kind.WORD: "h", Kind.TWO_WORD: "l"}
_ONE = {Kind.BIT: "cdata", Kind.BYTE: "cdata", Kind.WORD: "idata", Kind.TWO_WORD: "ldata"}


def _readable(row: ParameterRow) -> bool:
    return Attribute.NOT_READABLE not in row.attributes


def _is_setting(row: ParameterRow) -> bool:
    return Attribute.SETTING in row.attributes


def _wrapped(row: ParameterRow, value: int) -> int:
    """Return a value as the signed number of its width that C reads."""
    bits = 8 * row.kind.size
    value &= (1 << bits) - 1
    return value - (1 << bits) if value >> bits - 1 else value


def _meant(row: ParameterRow, value: int) -> int:
    """Return the value that a signed number of C stands for."""
    unsigned = row.kind is Kind.BIT or Attribute.UNSIGNED in row.attributes
    return value & ((1 << 8 * row.kind.size) - 1) if unsigned else value


def _check_axis(row: ParameterRow, axis: int, device: PowerMate) -> None:
    """Refuse an axis that does not fit a parameter.

    Ruling: a parameter that has one value is read and written alone with axis 0 only.
    """
    fits = axis == ALL_AXES or 1 <= axis <= device.max_axis if row.per_axis else axis == NO_AXIS
    if not fits:
        raise Refused(EW.EW_ATTRIB)


def _axes_of(row: ParameterRow, axis: int, count: int) -> Sequence[int]:
    if not row.per_axis:
        return (NO_AXIS,)
    return range(1, count + 1) if axis == ALL_AXES else (axis,)


def _row(device: PowerMate, number: int, wanted: Callable[[ParameterRow], bool]) -> ParameterRow:
    row = device.parameters.rows.get(number)
    if row is None or not wanted(row):
        raise Refused(EW.EW_NUMBER)
    return row


def _values(device: PowerMate, row: ParameterRow, axes: Iterable[int]) -> list[int]:
    return [_wrapped(row, device.parameters.value(row.number, axis)) for axis in axes]


def _check_changes(device: PowerMate, changes: Sequence[Change], *, settings: bool = False) -> None:
    """Refuse values out of range, parameters of options that are not fitted, and what must not be written."""
    if any(not each.row.fits(each.value) for each in changes):
        raise Refused(EW.EW_DATA)
    if any(not device.has_option(each.row.option) for each in changes):
        raise Refused(EW.EW_NOOPT)
    if any(Attribute.WRITE_PROTECTED in each.row.attributes for each in changes):
        raise Refused(EW.EW_PROT)
    if not settings and not device.state.parameters_writable:
        raise Refused(EW.EW_PROT)


# ---------------------------------------------------------------------- one


@call
def cnc_rdparam(
    link: Link, number: SHORT, axis: SHORT, length: Annotated[SHORT, LengthOf("param")]
) -> tuple[EW, Annotated[IODBPSD, Out("param")]]:
    """Read a parameter, of one axis or of all (Manual 000, cnc_rdparam).

    Ruling: one that cannot be read is EW_NUMBER.
    """
    device = link.device
    check_length(length, _HEADER + 1)
    row = _row(device, number, _readable)
    axes = _axes_of(row, axis, device.axes)
    check_length(length, _HEADER + row.kind.size * len(axes))
    _check_axis(row, axis, device)
    values = _values(link.read("cnc_rdparam", number, axis), row, axes)
    data = IODBPSD(datano=number, type=axis)
    name = _ONE[row.kind]
    if len(axes) == 1 and axis != ALL_AXES:
        setattr(data.u, name, values[0])
    else:
        for k, value in enumerate(values):
            getattr(data.u, f"{name}s")[k] = value
    return EW.EW_OK, data


@call
def cnc_wrparam(link: Link, length: Annotated[SHORT, LengthOf("param")], param: Annotated[IODBPSD, IN]) -> EW:
    """Write a parameter, of one axis or of all (Manual 000, cnc_wrparam). Ruling: out of range it is EW_DATA."""
    device, axis = link.device, param.type
    check_length(length, _HEADER + 1)
    row = _row(device, param.datano, lambda row: True)
    axes = _axes_of(row, axis, device.axes)
    check_length(length, _HEADER + row.kind.size * len(axes))
    _check_axis(row, axis, device)
    values = getattr(param.u, f"{_ONE[row.kind]}s")
    changes = tuple(Change(row, each, _meant(row, values[k])) for k, each in enumerate(axes))
    _check_changes(device, changes)
    link.command().parameters.write(changes)
    return EW.EW_OK


# ---------------------------------------------------------------------- records


def _record(device: PowerMate, row: ParameterRow, axis: int) -> bytes:
    """Return number, type, values, and a byte that makes the record even."""
    axes = _axes_of(row, axis, device.max_axis)
    in_record = NO_AXIS if not row.per_axis else _ALL_IN_RECORD if axis == ALL_AXES else axis
    head = struct.pack("<hh", row.number, int(row.kind) << 8 | in_record)
    data = head + struct.pack(f"<{len(axes)}{_FORMATS[row.kind]}", *_values(device, row, axes))
    return data + b"\0" * (len(data) % 2)


def _read_records(
    link: Link,
    what: str,
    first: int,
    axis: int,
    last: int,
    length: int,
    wanted: Callable[[ParameterRow], bool],
) -> tuple[int, int, bytes]:
    device = link.device
    check_length(length, _HEADER + 2)
    rows = [row for row in device.parameters.rows.values() if first <= row.number <= last and wanted(row)]
    if first < 0 or not rows:
        raise Refused(EW.EW_NUMBER)
    if axis not in (NO_AXIS, ALL_AXES) and not 1 <= axis <= device.max_axis:
        raise Refused(EW.EW_ATTRIB)
    if axis == NO_AXIS and any(row.per_axis for row in rows):
        raise Refused(EW.EW_ATTRIB)
    needed = sum(len(_record(device, row, axis)) for row in rows)
    check_length(length, needed)
    device = link.read(what, first, last, axis)
    return rows[0].number, rows[-1].number, b"".join(_record(device, row, axis) for row in rows)


def _changes(device: PowerMate, data: bytes, wanted: Callable[[ParameterRow], bool]) -> tuple[Change, ...]:
    """Return what a sequence of records says; its type attribute is not looked at, as the manual's sample sets 0."""
    changes: list[Change] = []
    at, before = 0, _NO_NUMBER
    while at < len(data):
        if len(data) - at < _HEADER + 2:
            raise Refused(EW.EW_LENGTH)
        number, kind = struct.unpack_from("<hH", data, at)
        row = _row(device, number, wanted)
        if number < before:
            raise Refused(EW.EW_NUMBER)
        axis = kind & 0xFF
        axis = ALL_AXES if axis == _ALL_IN_RECORD else axis
        slots = _axes_of(row, axis, device.max_axis)
        size = _HEADER + row.kind.size * len(slots)
        if len(data) - at < size + size % 2:
            raise Refused(EW.EW_LENGTH)
        _check_axis(row, axis, device)
        values = struct.unpack_from(f"<{len(slots)}{_FORMATS[row.kind]}", data, at + _HEADER)
        changes += [
            Change(row, slot, _meant(row, value))
            for slot, value in zip(slots, values, strict=True)
            if slot <= device.axes
        ]
        at, before = at + size + size % 2, number
    return tuple(changes)


def _write_records(
    link: Link, length: int, data: bytes, wanted: Callable[[ParameterRow], bool], *, settings: bool
) -> EW:
    if length < 1 or len(data) < length:
        raise Refused(EW.EW_LENGTH)
    changes = _changes(link.device, data[:length], wanted)
    _check_changes(link.device, changes, settings=settings)
    link.command().parameters.write(changes)
    return EW.EW_OK


@call
def cnc_rdparar(
    link: Link,
    s_number: Annotated[SHORT, INOUT],
    axis: SHORT,
    e_number: Annotated[SHORT, INOUT],
    length: Annotated[SHORT, INOUT, LengthOf("param")],
) -> tuple[EW, SHORT, SHORT, SHORT, Annotated[bytes, Bytes("void *"), Out("param")]]:
    """Read a range of parameters as records (Manual 000, cnc_rdparar).

    The numbers returned are the first and the last that were read, the length is that of the records.
    """
    first, last, data = _read_records(link, "cnc_rdparar", s_number, axis, e_number, length, _readable)
    return EW.EW_OK, first, last, len(data), data


@call
def cnc_wrparas(
    link: Link, length: Annotated[SHORT, LengthOf("param")], param: Annotated[bytes, Bytes("void *")]
) -> EW:
    """Write parameters from records of ascending numbers, all or none (Manual 000, cnc_wrparas)."""
    return _write_records(link, length, param, lambda row: True, settings=False)


@call
def cnc_rdparainfo(
    link: Link, s_number: SHORT, read_no: USHORT
) -> tuple[EW, Annotated[ODBPARAIF, Out("paraif")]]:
    """Tell which parameters there are from a number on, and their attributes (Manual 000, cnc_rdparainfo).

    Ruling: before the first and after the last parameter there is number -1.
    """
    rows = list(link.device.parameters.rows.values())
    found = [k for k, row in enumerate(rows) if row.number >= s_number]
    if read_no == 0:
        raise Refused(EW.EW_LENGTH)
    if s_number < 0 or not found:
        raise Refused(EW.EW_NUMBER)
    link.read("cnc_rdparainfo", s_number)
    first = found[0]
    chosen = rows[first : first + read_no]
    after = first + len(chosen)
    info = variant(ODBPARAIF, info=len(chosen))(
        info_no=len(chosen),
        prev_no=rows[first - 1].number if first else _NO_NUMBER,
        next_no=rows[after].number if after < len(rows) else _NO_NUMBER,
    )
    for entry, row in zip(info.info, chosen, strict=True):
        entry.prm_no, entry.prm_type = row.number, row.type_word
    return EW.EW_OK, info


@call
def cnc_rdsetr(
    link: Link,
    s_number: Annotated[SHORT, INOUT],
    axis: SHORT,
    e_number: Annotated[SHORT, INOUT],
    length: Annotated[SHORT, INOUT, LengthOf("set")],
) -> tuple[EW, SHORT, SHORT, SHORT, Annotated[bytes, Bytes("void *"), Out("set")]]:
    """Read a range of settings, as `cnc_rdparar` (Manual 000, cnc_rdsetr). Ruling: other parameters are left out."""
    first, last, data = _read_records(link, "cnc_rdsetr", s_number, axis, e_number, length, _is_setting)
    return EW.EW_OK, first, last, len(data), data


@call
def cnc_wrsets(
    link: Link, length: Annotated[SHORT, LengthOf("set")], set: Annotated[bytes, Bytes("void *")]
) -> EW:
    """Write settings from records of ascending numbers, all or none (Manual 000, cnc_wrsets)."""
    return _write_records(link, length, set, _is_setting, settings=True)


__all__ = [
    "cnc_rdparainfo",
    "cnc_rdparam",
    "cnc_rdparar",
    "cnc_rdsetr",
    "cnc_wrparam",
    "cnc_wrparas",
    "cnc_wrsets",
]
