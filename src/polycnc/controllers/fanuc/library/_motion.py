"""Axis motion by direct commands, and operation signals (Manual 000, axis movement control); not on a Power Mate-D.

Commands for an axis whose parameter 8010 is 0, or any with 8003#7 = 0, are refused with EW_PARAM.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Annotated, TypeAlias

from polycnc.controllers.fanuc.device._device_state import PATHS, Block, Order
from polycnc.controllers.fanuc.device._power_mate import PowerMate
from polycnc.controllers.fanuc.library._call import call
from polycnc.controllers.fanuc.library._codes import EW
from polycnc.controllers.fanuc.library._network import Link
from polycnc.controllers.fanuc.library._structs import ODBEXEC, ODBFIN, ODBOPDI, ODBPOS
from polycnc.controllers.library import IN, LONG, SHORT, Bytes, Many, Out, Refused

_POSITION = 6
_MOST = 99_999_999
_DWELLS_MS = range(1, 99_999_999 + 1)
_AXIS_BITS = 0x3F
_ENABLED = 7
Positions: TypeAlias = Annotated[bytes, Bytes("ODBPOS *"), Many("axis")]
Answer: TypeAlias = tuple[EW, Annotated[ODBEXEC, Out("odb")]]


def _check_model(link: Link) -> PowerMate:
    if link.device.model == "D":
        raise Refused(EW.EW_FUNC)
    return link.device


def _check_enabled(device: PowerMate) -> None:
    if not device.parameters.bit(8003, _ENABLED):
        raise Refused(EW.EW_PARAM)


def _values(device: PowerMate, count: int, data: bytes) -> tuple[tuple[int, int], ...]:
    """Return axis numbers and values of a command."""
    if not 1 <= count <= device.axes:
        raise Refused(EW.EW_ATTRIB)
    if len(data) < count * _POSITION:
        raise Refused(EW.EW_LENGTH)
    found = [ODBPOS.unpack(data[k : k + _POSITION]) for k in range(0, count * _POSITION, _POSITION)]
    if len({each.idata for each in found}) < count or not all(
        1 <= each.idata <= device.axes for each in found
    ):
        raise Refused(EW.EW_ATTRIB)
    return tuple((each.idata, each.ldata) for each in found)


def _order(link: Link, path: int, block: Block) -> tuple[EW, ODBEXEC]:
    """Put a command into a buffer, after all checks; EW_REJECT where an alarm or a stop would drop it."""
    device = link.device
    _check_enabled(device)
    if not all(device.parameters.value(8010, axis) for axis in block.axes):
        raise Refused(EW.EW_PARAM)
    if not device.axis_motion.is_ready:
        raise Refused(EW.EW_REJECT)
    if not device.axis_motion.has_room(path):
        raise Refused(EW.EW_BUSY)
    device = link.command()
    device.axis_motion.put(path, block)
    return EW.EW_OK, _buffers(device)


def _check_path(path: int, nmod: int) -> None:
    if not 1 <= path <= PATHS:
        raise Refused(EW.EW_PATH)
    if nmod not in (0, 1):
        raise Refused(EW.EW_DATA)


def _move(
    link: Link, order: Order, path: int, nmod: int, axis: int, feed: int, data: bytes
) -> tuple[EW, ODBEXEC]:
    device = _check_model(link)
    _check_path(path, nmod)
    values = _values(device, axis, data)
    if any(abs(value) > _MOST for _, value in values) or (
        order in (Order.ABSOLUTE, Order.INCREMENTAL) and feed < 1
    ):
        raise Refused(EW.EW_DATA)
    if order is Order.DWELL and not all(value in _DWELLS_MS for _, value in values):
        raise Refused(EW.EW_DATA)
    return _order(link, path, Block(order, values, feed, bool(nmod)))


def _buffers(device: PowerMate) -> ODBEXEC:
    """Return the buffer states. Ruling: path x has bit x-1 of byte x-1; the other bits are 0."""
    made = ODBEXEC()
    for path in range(1, PATHS + 1):
        for row, used in enumerate(device.axis_motion.buffers(path)):
            made.cdata[row][path - 1] = used << path - 1
    return made


@call
def cnc_refpoint(link: Link, path_no: SHORT, nmod: SHORT, axis: SHORT) -> Answer:
    """Return one axis to its reference position; `axis` is its number (Manual 000, cnc_refpoint)."""
    device = _check_model(link)
    _check_path(path_no, nmod)
    if not 1 <= axis <= device.axes:
        raise Refused(EW.EW_ATTRIB)
    return _order(link, path_no, Block(Order.REFERENCE, ((axis, 0),), flag=bool(nmod)))


@call
def cnc_abspoint(link: Link, path_no: SHORT, nmod: SHORT, axis: SHORT, feed: LONG, idb: Positions) -> Answer:
    """Move `axis` axes to coordinates, at `feed` (Manual 000, cnc_abspoint).

    Ruling: feed in mm/min or deg/min, of an inch machine in 0.01 inch/min.
    """
    return _move(link, Order.ABSOLUTE, path_no, nmod, axis, feed, idb)


@call
def cnc_incpoint(link: Link, path_no: SHORT, nmod: SHORT, axis: SHORT, feed: LONG, idb: Positions) -> Answer:
    """Move `axis` axes by distances, at `feed` (Manual 000, cnc_incpoint)."""
    return _move(link, Order.INCREMENTAL, path_no, nmod, axis, feed, idb)


@call
def cnc_dwell(link: Link, path_no: SHORT, nmod: SHORT, axis: SHORT, idb: Positions) -> Answer:
    """Let a path stand for a time in milliseconds, the longest of those given (Manual 000, cnc_dwell)."""
    return _move(link, Order.DWELL, path_no, nmod, axis, 0, idb)


@call
def cnc_coordre(link: Link, path_no: SHORT, nmod: SHORT, axis: SHORT, idb: Positions) -> Answer:
    """Let the coordinates of axes be what is given (Manual 000, cnc_coordre).

    Ruling: absolute positions and cnc_abspoint count from there; the work offsets of programs stay.
    """
    return _move(link, Order.SET, path_no, nmod, axis, 0, idb)


@call
def cnc_exebufstat(link: Link) -> Answer:
    """Read which execution buffers hold a command (Manual 000, cnc_exebufstat)."""
    _check_enabled(_check_model(link))
    return EW.EW_OK, _buffers(link.read("cnc_exebufstat"))


@call
def cnc_finstate(link: Link) -> tuple[EW, Annotated[ODBFIN, Out("odb")]]:
    """Read the completion flags (Manual 000, cnc_finstate); path x has bit x-1 of byte x-1."""
    _check_enabled(_check_model(link))
    flags = link.read("cnc_finstate").axis_motion.state.finished
    return EW.EW_OK, ODBFIN(cdata=[int(flag) << k for k, flag in enumerate(flags)])


@call
def cnc_setfin(link: Link, idb: Annotated[ODBFIN, IN]) -> EW:
    """Take back the completion flags whose bits are 1 (Manual 000, cnc_setfin)."""
    _check_enabled(_check_model(link))
    flags = link.command().axis_motion.state.finished
    for k in range(PATHS):
        if idb.cdata[k] >> k & 1:
            flags[k] = False
    return EW.EW_OK


# ---------------------------------------------------------------------- operation signals

_MODE_SIGNALS = {0: 0x00, 1: 0x01, 2: 0x03, 3: 0x85, 4: 0x05, 5: 0x04, 7: 0x04}
_INC, _HANDLE = 5, 7


def _level(address: int, mask: int) -> Callable[[PowerMate, int, int], None]:
    def give(device: PowerMate, axis: int, value: int) -> None:
        device.signals.give_bits(address, mask, mask if value else 0)

    return give


def _select(device: PowerMate, axis: int, value: int) -> None:
    device.signals.give_bits(43, 0xA7, _MODE_SIGNALS[value])
    if value in (_INC, _HANDLE):
        device.select_mode("INC" if value == _INC else "HND")


def _jog(device: PowerMate, axis: int, value: int) -> None:
    axes = range(device.axes) if axis == 0 else (axis - 1,)
    mask = sum(1 << k for k in axes)
    minus = bool(value & 8)
    start = bool(value & 1)
    device.signals.give_bits(100, mask, mask if start and not minus else 0)
    device.signals.give_bits(102, mask, mask if start and minus else 0)


def _torque_mode(device: PowerMate, axis: int, value: int) -> None:
    device.signals.state.torque_mode = value


_SIGNALS: dict[int, tuple[Callable[[int], bool], Callable[[PowerMate, int, int], None]]] = {
    1: (lambda value: value in (0, 1), _level(8, 0x10)),
    2: (lambda value: value in (0, 1), _level(8, 0x20)),
    3: (lambda value: value in (0, 1), _level(8, 0x80)),
    4: (lambda value: not value & ~_AXIS_BITS, lambda device, axis, value: device.signals.give(126, value)),
    7: (lambda value: value in (0, 1), _level(19, 0x80)),
    8: (lambda value: value in (0, 1), _level(7, 0x04)),
    9: (lambda value: value in _MODE_SIGNALS, _select),
    10: (lambda value: True, lambda device, axis, value: device.signals.give(12, 255 - (value % 255))),
    12: (lambda value: not value & ~_AXIS_BITS, _torque_mode),
    13: (lambda value: True, lambda device, axis, value: device.signals.set_torque_override(axis, value)),
    14: (lambda value: not value & ~0x09, _jog),
    15: (lambda value: value in (0, 1), _level(46, 0x02)),
}
_OF_AXES: Sequence[int] = (13, 14)


@call
def cnc_opdi(link: Link, number: SHORT, idb: Annotated[ODBOPDI, IN]) -> EW:
    """Give the control an operation signal (Manual 000, cnc_opdi); it stays until it is given anew.

    Ruling: as on the machine, a start comes when signal 8 goes off again.
    """
    device = _check_model(link)
    if number not in _SIGNALS:
        raise Refused(EW.EW_NUMBER)
    valid, give = _SIGNALS[number]
    if number in _OF_AXES and not 0 <= idb.axis <= device.axes:
        raise Refused(EW.EW_ATTRIB)
    value = int(idb.u.cdata)
    if not valid(value):
        raise Refused(EW.EW_DATA)
    give(link.command(), idb.axis, value)
    return EW.EW_OK


__all__ = [
    "cnc_abspoint",
    "cnc_coordre",
    "cnc_dwell",
    "cnc_exebufstat",
    "cnc_finstate",
    "cnc_incpoint",
    "cnc_opdi",
    "cnc_refpoint",
    "cnc_setfin",
]
