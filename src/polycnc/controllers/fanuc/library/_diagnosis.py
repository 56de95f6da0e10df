"""Diagnosis data (Manual 000, cnc_diagnoss and cnc_diagnosr)."""

from __future__ import annotations

from typing import Annotated

from polycnc.controllers.fanuc.data._diagnosis import DIAGNOSIS, Diagnosis
from polycnc.controllers.fanuc.device._power_mate import PowerMate
from polycnc.controllers.fanuc.library._call import call, check_length
from polycnc.controllers.fanuc.library._codes import ALL_AXES, EW
from polycnc.controllers.fanuc.library._network import Link
from polycnc.controllers.fanuc.library._structs import ODBDGN
from polycnc.controllers.library import INOUT, SHORT, Bytes, LengthOf, Out, Refused

_HEADER = 4
_NO_AXIS = 0


def _check_axis(row: Diagnosis, axis: int, axes: int) -> None:
    """Refuse an axis that is none, or no axis where the data have axes."""
    if axis != ALL_AXES and not _NO_AXIS <= axis <= axes:
        raise Refused(EW.EW_ATTRIB)
    if row.per_axis and axis == _NO_AXIS:
        raise Refused(EW.EW_ATTRIB)


def _values(device: PowerMate, row: Diagnosis, axis: int) -> list[int]:
    if not row.per_axis:
        return [int(row.value(device, 0))]
    if axis != ALL_AXES:
        return [int(row.value(device, axis)) if axis <= device.axes else 0]
    return [int(row.value(device, each)) for each in range(1, device.axes + 1)]


def _packed(row: Diagnosis, values: list[int]) -> bytes:
    size = row.kind.size
    return b"".join((value & (1 << 8 * size) - 1).to_bytes(size, "little") for value in values)


@call
def cnc_diagnoss(
    link: Link, number: SHORT, axis: SHORT, length: Annotated[SHORT, LengthOf("diag")]
) -> tuple[EW, Annotated[ODBDGN, Out("diag")]]:
    """Read one diagnosis number, of one axis or of all (-1) (Manual 000, cnc_diagnoss)."""
    device = link.device
    row = DIAGNOSIS.get(number)
    if row is not None:
        count = device.axes if row.per_axis and axis == ALL_AXES else 1
        check_length(length, _HEADER + row.kind.size * count)
    if row is None:
        raise Refused(EW.EW_NUMBER)
    _check_axis(row, axis, device.max_axis)
    device = link.read("cnc_diagnoss", number, axis)
    data = bytearray(ODBDGN(datano=number, type=axis if row.per_axis else _NO_AXIS).pack())
    packed = _packed(row, _values(device, row, axis))
    data[_HEADER : _HEADER + len(packed)] = packed
    return EW.EW_OK, ODBDGN.unpack(bytes(data))


@call
def cnc_diagnosr(
    link: Link,
    s_number: Annotated[SHORT, INOUT],
    axis: SHORT,
    e_number: Annotated[SHORT, INOUT],
    length: Annotated[SHORT, INOUT, LengthOf("diag")],
) -> tuple[EW, SHORT, SHORT, SHORT, Annotated[bytes, Bytes("void *"), Out("diag")]]:
    """Read a range of diagnosis numbers; what comes back says what was read (Manual 000, cnc_diagnosr).

    Each begins with its number and type, and has an even number of bytes; of all axes there is room for all that the
    control could have.
    """
    device = link.device
    rows = {number: row for number, row in DIAGNOSIS.items() if s_number <= number <= e_number}
    room = {number: _room(row, axis, device.max_axis) for number, row in rows.items()}
    check_length(length, sum(room.values()))
    if not rows or s_number < 0:
        raise Refused(EW.EW_NUMBER)
    for row in rows.values():
        _check_axis(row, axis, device.max_axis)
    device = link.read("cnc_diagnosr", s_number, axis, e_number)
    made = b""
    for number, row in rows.items():
        kind = int(row.kind) << 8 | (axis if row.per_axis else _NO_AXIS) & 0xFF
        head = number.to_bytes(2, "little") + kind.to_bytes(2, "little")
        made += (head + _packed(row, _values(device, row, axis))).ljust(room[number], b"\0")
    return EW.EW_OK, min(rows), max(rows), len(made), made


def _room(row: Diagnosis, axis: int, most: int) -> int:
    """Return the bytes of one number in the result."""
    size = _HEADER + row.kind.size * (most if row.per_axis and axis == ALL_AXES else 1)
    return size + size % 2


__all__ = ["cnc_diagnosr", "cnc_diagnoss"]
