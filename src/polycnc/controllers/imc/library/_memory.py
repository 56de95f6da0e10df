"""Functions that write and read parameters, and that make a queue wait for them (manual 004, 3.1 to 3.4)."""

# ruff: noqa: N802, N803  the names are the manual's

from __future__ import annotations

from polycnc.controllers.imc.core._instructions import ChangeBits, WaitParam, WaitTime, Write, WriteMany
from polycnc.controllers.imc.library._call import LIBRARY, card_call, check_place, send, signed
from polycnc.controllers.imc.library._codes import IMC_OK, IMC_OUT_OF_RANGE, IMC_STATUS
from polycnc.controllers.imc.library._network import IMC_HANDLE
from polycnc.controllers.imc.library._structs import WR_MUL_DES
from polycnc.controllers.imc.library._types import (
    IMC16,
    IMC32,
    INT48,
    AxisIfAny,
    Bit,
    BitValue,
    Count,
    Count32,
    Data16,
    Data32,
    Data48,
    DataBit,
    Descriptions,
    Filled,
    Location,
    Queue,
    WaitQueue,
)
from polycnc.controllers.library import Refused


@card_call
def IMC_SetMulParam(Handle: IMC_HANDLE, pdes: Descriptions, ArrNum: Count, fifoSel: Queue) -> IMC_STATUS:
    """Write the first `ArrNum` parameters of `pdes` in the same control cycle (Manual 004, 3.1.1)."""
    writes = []
    for each, axis in _elements(Handle, pdes, ArrNum, written=True):
        writes.append(Write(each.addr, each.value, axis, each.len))
    return send(Handle, fifoSel, WriteMany(tuple(writes)))


@card_call
def IMC_SetParam16(
    Handle: IMC_HANDLE, paramloc: Location, thedata: IMC16, axis: AxisIfAny, fifoSel: Queue
) -> IMC_STATUS:
    """Write one word: of a wider parameter the low one (Manual 004, 3.1.2)."""
    return _write(Handle, paramloc, thedata, axis, fifoSel, 1)


@card_call
def IMC_SetParam32(
    Handle: IMC_HANDLE, paramloc: Location, thedata: IMC32, axis: AxisIfAny, fifoSel: Queue
) -> IMC_STATUS:
    """Write two words, whatever the second belongs to (Manual 004, 3.1.2)."""
    return _write(Handle, paramloc, thedata, axis, fifoSel, 2)


@card_call
def IMC_SetParam48(
    Handle: IMC_HANDLE, paramloc: Location, thedata: INT48, axis: AxisIfAny, fifoSel: Queue
) -> IMC_STATUS:
    """Write three words, whatever the others belong to (Manual 004, 3.1.2)."""
    return _write(Handle, paramloc, thedata, axis, fifoSel, 3)


@card_call
def IMC_SetParamBit(
    Handle: IMC_HANDLE, paramloc: Location, bit: Bit, val: BitValue, axis: AxisIfAny, fifoSel: Queue
) -> IMC_STATUS:
    """Set or clear a bit of a word in the card (Manual 004, 3.2.1)."""
    mask = 1 << bit
    return _change(Handle, paramloc, mask, 0 if val else mask, axis, fifoSel)


@card_call
def IMC_ORXORParam(
    Handle: IMC_HANDLE, paramloc: Location, ORdata: IMC16, XORdata: IMC16, axis: AxisIfAny, fifoSel: Queue
) -> IMC_STATUS:
    """Replace a word by (word OR `ORdata`) XOR `XORdata`, in the card (Manual 004, 3.2.2)."""
    return _change(Handle, paramloc, ORdata & 0xFFFF, XORdata & 0xFFFF, axis, fifoSel)


@card_call
def IMC_TurnParamBit(
    Handle: IMC_HANDLE, paramloc: Location, bit: Bit, axis: AxisIfAny, fifoSel: Queue
) -> IMC_STATUS:
    """Invert a bit of a word in the card (Manual 004, 3.2.3)."""
    return _change(Handle, paramloc, 0, 1 << bit, axis, fifoSel)


@card_call
def IMC_GetParam16(Handle: IMC_HANDLE, paramloc: Location, axis: AxisIfAny) -> tuple[IMC_STATUS, Data16]:
    """Return a word: of a wider parameter the low one (Manual 004, 3.3.1)."""
    return IMC_OK, _read(Handle, paramloc, axis, 1)


@card_call
def IMC_GetParam32(Handle: IMC_HANDLE, paramloc: Location, axis: AxisIfAny) -> tuple[IMC_STATUS, Data32]:
    """Return two words, whatever the second belongs to (Manual 004, 3.3.1)."""
    return IMC_OK, _read(Handle, paramloc, axis, 2)


@card_call
def IMC_GetParam48(Handle: IMC_HANDLE, paramloc: Location, axis: AxisIfAny) -> tuple[IMC_STATUS, Data48]:
    """Return three words, whatever the others belong to (Manual 004, 3.3.1)."""
    return IMC_OK, _read(Handle, paramloc, axis, 3)


@card_call
def IMC_GetParamBit(
    Handle: IMC_HANDLE, paramloc: Location, bit: Bit, axis: AxisIfAny
) -> tuple[IMC_STATUS, DataBit]:
    """Return a bit of a word (Manual 004, 3.3.2)."""
    return IMC_OK, _read(Handle, paramloc, axis, 1) >> bit & 1


@card_call
def IMC_GetMulParam(Handle: IMC_HANDLE, pdes: Filled, NumofArr: Count32) -> IMC_STATUS:
    """Read up to 32 parameters at one moment into the `data` of `pdes` (Manual 004, 3.3.3)."""
    elements = _elements(Handle, pdes, NumofArr, written=False)
    card = Handle.reach_later()
    for each, axis in elements:
        words = card.read_words(each.addr, axis, each.len)
        each.data[0 : each.len] = [int(word) & 0xFFFF for word in words]
    return IMC_OK


@card_call
def IMC_WaitTime(Handle: IMC_HANDLE, time: IMC32, fifoSel: WaitQueue) -> IMC_STATUS:
    """Make a queue wait `time` ms, for ever with 0 or -1 (Manual 004, 3.4.1)."""
    return send(Handle, fifoSel, WaitTime(signed_32(time)))


@card_call
def IMC_WaitParamBit(
    Handle: IMC_HANDLE,
    paramloc: Location,
    bit: Bit,
    val: BitValue,
    timeout: IMC32,
    axis: AxisIfAny,
    fifoSel: WaitQueue,
) -> IMC_STATUS:
    """Make a queue wait until a bit is `val`, at most `timeout` ms (Manual 004, 3.4.2)."""
    return _wait(Handle, paramloc, 1 << bit, val << bit, timeout, axis, fifoSel)


@card_call
def IMC_WaitParam(
    Handle: IMC_HANDLE, paramloc: Location, data: IMC16, timeout: IMC32, axis: AxisIfAny, fifoSel: WaitQueue
) -> IMC_STATUS:
    """Make a queue wait until a word is `data`, at most `timeout` ms (Manual 004, 3.4.3)."""
    return _wait(Handle, paramloc, 0xFFFF, data, timeout, axis, fifoSel)


@card_call
def IMC_WaitParamMask(
    Handle: IMC_HANDLE,
    paramloc: Location,
    mask: IMC16,
    data: IMC16,
    timeout: IMC32,
    axis: AxisIfAny,
    fifoSel: WaitQueue,
) -> IMC_STATUS:
    """Make a queue wait until a word AND `mask` is `data`, at most `timeout` ms (Manual 004, 3.4.4)."""
    return _wait(Handle, paramloc, mask, data, timeout, axis, fifoSel)


def signed_32(value: int) -> int:
    """Return a number of 32 bits with sign."""
    return ((value & 0xFFFFFFFF) ^ 0x80000000) - 0x80000000


def _write(handle: IMC_HANDLE, address: int, value: int, axis: int, fifo: int, words: int) -> IMC_STATUS:
    axis = check_place(handle, address, axis, written=True)
    return send(handle, fifo, Write(address, value, axis, words))


def _change(handle: IMC_HANDLE, address: int, ors: int, xors: int, axis: int, fifo: int) -> IMC_STATUS:
    axis = check_place(handle, address, axis, written=True)
    return send(handle, fifo, ChangeBits(address, ors, xors, axis))


def _wait(
    handle: IMC_HANDLE, address: int, mask: int, data: int, timeout: int, axis: int, fifo: int
) -> IMC_STATUS:
    axis = check_place(handle, address, axis)
    wait = WaitParam(address, data & 0xFFFF, signed_32(timeout), axis, mask & 0xFFFF)
    return send(handle, fifo, wait)


def _read(handle: IMC_HANDLE, address: int, axis: int, words: int) -> int:
    axis = check_place(handle, address, axis)
    return signed(handle.reach_later().read_words(address, axis, words))


def _elements(
    handle: IMC_HANDLE, described: Descriptions, count: int, *, written: bool
) -> list[tuple[WR_MUL_DES, int]]:
    """Return the first elements, all of which the card has, each with the axis to ask for.

    Raises:
        Refused: There are not so many, or one names what the card does not have.
    """
    if count > len(described):
        raise Refused(IMC_OUT_OF_RANGE)
    elements = [described[k] for k in range(count)]
    if any(not 1 <= each.len <= 3 for each in elements):
        raise Refused(IMC_OUT_OF_RANGE)
    return [(each, check_place(handle, each.addr, each.axis, written=written)) for each in elements]


# Other names: as the manual misprints them, and for what its print has lost.
IMC_GetPatamBit = LIBRARY.alias("IMC_GetPatamBit", IMC_GetParamBit)

# fmt: off
__all__ = [
    "IMC_GetMulParam", "IMC_GetParam16", "IMC_GetParam32", "IMC_GetParam48", "IMC_GetParamBit",
    "IMC_GetPatamBit", "IMC_ORXORParam", "IMC_SetMulParam", "IMC_SetParam16", "IMC_SetParam32",
    "IMC_SetParam48", "IMC_SetParamBit", "IMC_TurnParamBit", "IMC_WaitParam", "IMC_WaitParamBit",
    "IMC_WaitParamMask", "IMC_WaitTime",
]
# fmt: on
