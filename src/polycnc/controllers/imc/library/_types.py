"""The C types of the library's arguments, and which values a call refuses with which status.

A parameter of a function is annotated with one of these; what they check is checked before the card is asked.
"""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from typing import Annotated, Any, TypeAlias

from polycnc.controllers.imc.library._codes import (
    FIFO_SEL,
    IMC_INVALID_AXIS,
    IMC_INVALID_FIFO,
    IMC_INVALID_HANDLE,
    IMC_INVALID_PARAM,
    IMC_OUT_OF_RANGE,
    IMC_STATUS,
)
from polycnc.controllers.imc.library._network import IMC_HANDLE
from polycnc.controllers.imc.library._structs import (
    NIC_INFO,
    WR_MUL_DES,
    EventInfo,
    PFIFOSegData,
    PFIFOSegInfo,
)
from polycnc.controllers.library import (
    INOUT,
    OUT,
    Elements,
    LengthOf,
    Number,
    Opaque,
    Out,
    Pointer,
    Refused,
    Text,
    Whole,
    whole,
)

_INT, _SHORT, _WORD = ctypes.c_int32, ctypes.c_int16, ctypes.c_uint16


@dataclass(frozen=True, slots=True)
class AxisNumber:
    """The number of an axis of the card."""

    refusal: IMC_STATUS = IMC_INVALID_AXIS
    c: str = "IMC32"
    ctype: Any = _INT

    def take(self, value: Any, to: IMC_HANDLE) -> int:
        """Refuse axes that the card does not have."""
        if not 0 <= (axis := whole(value)) < to.axis_count:
            raise Refused(self.refusal)
        return axis


@dataclass(frozen=True, slots=True)
class Queues:
    """A queue that takes the instruction."""

    accepted: frozenset[int]
    c: str = "int"
    ctype: Any = _INT

    def take(self, value: Any, to: IMC_HANDLE) -> FIFO_SEL:
        """Refuse other queues."""
        if value not in self.accepted:
            raise Refused(IMC_INVALID_FIFO)
        return FIFO_SEL(value)


@dataclass(frozen=True, slots=True)
class Fixed:
    """A number that becomes fixed point: `bits` whole bits with sign, `fraction` bits after the point."""

    bits: int = 16
    fraction: int = 32
    c: str = "IMCFLOAT"
    ctype: Any = ctypes.c_double

    def take(self, value: Any, to: IMC_HANDLE) -> float:
        """Refuse what the fixed-point number cannot hold."""
        try:
            number = float(value)
        except OverflowError:
            raise Refused(IMC_OUT_OF_RANGE) from None
        most = 1 << (self.bits - 1)
        scaled = round(number * (1 << self.fraction)) if abs(number) <= most else None
        if scaled is None or not -most <= scaled / (1 << self.fraction) < most:
            raise Refused(IMC_OUT_OF_RANGE)
        return number


def _number(c: str, ctype: Any, low: int, high: int, refusal: IMC_STATUS = IMC_OUT_OF_RANGE) -> Whole:
    return Whole(c, ctype, low, high, refusal)


def _pointer(c: str, ctype: Any = None, of: Any = None) -> Pointer:
    return Pointer(c, ctype, IMC_INVALID_PARAM, of)


_INSTRUCTIONS = frozenset((FIFO_SEL.SEL_IFIFO, FIFO_SEL.SEL_QFIFO, FIFO_SEL.SEL_PFIFO1, FIFO_SEL.SEL_PFIFO2))

# fmt: off
# Numbers that are only stored may be given with or without sign, as a C compiler takes them.
IMC16: TypeAlias = Annotated[int, _number("IMC16", _SHORT, -0x8000, 0xFFFF)]
IMC32: TypeAlias = Annotated[int, _number("IMC32", _INT, -0x80000000, 0xFFFFFFFF)]
INT48: TypeAlias = Annotated[int, _number("__int64", ctypes.c_int64, -0x800000000000, 0xFFFFFFFFFFFF)]
INT: TypeAlias = Annotated[int, _number("int", _INT, -0x80000000, 0x7FFFFFFF)]
Location: TypeAlias = Annotated[int, _number("IMC16", _SHORT, 0, 1023, IMC_INVALID_PARAM)]
Bit: TypeAlias = Annotated[int, _number("IMC16", _SHORT, 0, 15, IMC_INVALID_PARAM)]
BitValue: TypeAlias = Annotated[int, _number("IMC16", _SHORT, 0, 1)]
ArcDirection: TypeAlias = Annotated[int, _number("IMC32", _INT, 0, 1)]
Positive: TypeAlias = Annotated[int, _number("IMC32", _INT, 1, 0x7FFFFFFF)]
Source: TypeAlias = Annotated[int, _number("IMC32", _INT, 0, 4)]
Count: TypeAlias = Annotated[int, _number("WORD", _WORD, 1, 0xFFFF), LengthOf("pdes")]
Count32: TypeAlias = Annotated[int, _number("WORD", _WORD, 1, 32), LengthOf("pdes")]
EventCount: TypeAlias = Annotated[int, _number("IMCU16", _WORD, 1, 31), LengthOf("pEvent")]
PointWords: TypeAlias = Annotated[int, _number("int", _INT, 1, 126), LengthOf("pdata")]
CaptureCount: TypeAlias = Annotated[int, _number("IMC32", _INT, 0, 120), LengthOf("pdata")]
TimeoutMs: TypeAlias = Annotated[int, _number("int", _INT, 1, 0x7FFFFFFF)]
OpenMode: TypeAlias = Annotated[int, _number("int", _INT, 0, 1)]
# fmt: on

Ratio: TypeAlias = Annotated[float, Fixed()]
Password: TypeAlias = Annotated[str | bytes | None, Text(null=True)]

Axis: TypeAlias = Annotated[int, AxisNumber()]
OtherAxis: TypeAlias = Annotated[int, AxisNumber(IMC_OUT_OF_RANGE)]
AxisIfAny: TypeAlias = Annotated[int, _number("IMC32", _INT, -0x80000000, 0xFFFFFFFF)]
"""An axis that does not matter for parameters of the card; the call looks at both."""

Queue: TypeAlias = Annotated[int, Queues(_INSTRUCTIONS)]
WaitQueue: TypeAlias = Annotated[int, Queues(_INSTRUCTIONS - {FIFO_SEL.SEL_IFIFO})]
PathQueue: TypeAlias = Annotated[int, Queues(frozenset((FIFO_SEL.SEL_PFIFO1, FIFO_SEL.SEL_PFIFO2)))]
PointQueue: TypeAlias = Annotated[
    int, Queues(frozenset((FIFO_SEL.SEL_CFIFO, FIFO_SEL.SEL_PFIFO1, FIFO_SEL.SEL_PFIFO2)))
]
AnyQueue: TypeAlias = Annotated[int, Queues(frozenset(FIFO_SEL))]

HANDLE: TypeAlias = Annotated[IMC_HANDLE, Opaque("IMC_HANDLE", IMC_INVALID_HANDLE)]
Adapters: TypeAlias = Annotated[NIC_INFO, _pointer("NIC_INFO *", NIC_INFO), OUT]
Descriptions: TypeAlias = Annotated[Elements[WR_MUL_DES], _pointer("pWR_MUL_DES", of=WR_MUL_DES)]
Filled: TypeAlias = Annotated[Descriptions, INOUT]
Events: TypeAlias = Annotated[Elements[EventInfo], _pointer("PEventInfo", of=EventInfo)]
Points: TypeAlias = Annotated[Elements[int], _pointer("short *", of=int)]
SegmentData: TypeAlias = Annotated[PFIFOSegData, _pointer("PFIFOSegData *", PFIFOSegData)]
SegmentInfo: TypeAlias = Annotated[PFIFOSegInfo, _pointer("PFIFOSegInfo *", PFIFOSegInfo)]

Opened: TypeAlias = Annotated[
    IMC_HANDLE | None, Opaque("IMC_HANDLE", IMC_INVALID_HANDLE), Out("Handle", "netcardsel")
]
Found: TypeAlias = Annotated[int, Number("int", _INT), Out("num")]
Data16: TypeAlias = Annotated[IMC16, Out("pdata", "axis", "PVOID")]
Data32: TypeAlias = Annotated[IMC32, Out("pdata", "axis", "PVOID")]
Data48: TypeAlias = Annotated[INT48, Out("pdata", "axis", "PVOID")]
DataBit: TypeAlias = Annotated[IMC16, Out("pdata", "bit", "PVOID")]
Captured: TypeAlias = Annotated[list[int], IMC32, Out("pdata", "axis")]
CapturedNumber: TypeAlias = Annotated[IMC32, Out("dataNum", "axis")]
CapturedLeft: TypeAlias = Annotated[IMC32, Out("lastNum", "axis")]
"""What a call reads: an argument in C, where the pointer stands before another one."""
