"""The C types of the library's arguments, and which values a call refuses with which status.

A parameter of a function is annotated with one of these; what they check is checked before the card is asked.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from operator import index
from typing import Annotated, Any, Protocol, TypeAlias, TypeVar

from polycnc.controllers.imc.library._codes import (
    FIFO_SEL,
    IMC_INVALID_AXIS,
    IMC_INVALID_FIFO,
    IMC_INVALID_PARAM,
    IMC_OK,
    IMC_OUT_OF_RANGE,
    IMC_STATUS,
)
from polycnc.controllers.imc.library._structs import (
    NIC_INFO,
    WR_MUL_DES,
    EventInfo,
    PFIFOSegData,
    PFIFOSegInfo,
)

T_co = TypeVar("T_co", covariant=True)


class Elements(Protocol[T_co]):
    """A list, or an array of C."""

    def __len__(self) -> int: ...

    def __getitem__(self, index: int, /) -> T_co: ...


class CType(Protocol):
    """A type of C, and what a call makes of a value."""

    @property
    def c(self) -> str:
        """Return its name in C."""
        ...

    def check(self, value: Any, axes: int) -> IMC_STATUS:
        """Return IMC_OK, or why a card with `axes` axes cannot be given this value."""
        ...


@dataclass(frozen=True, slots=True)
class Whole:
    """A whole number within limits."""

    c: str
    low: int
    high: int
    refusal: IMC_STATUS = IMC_OUT_OF_RANGE

    def check(self, value: Any, axes: int) -> IMC_STATUS:
        """Refuse what is beyond the limits."""
        return IMC_OK if self.low <= index(value) <= self.high else self.refusal


@dataclass(frozen=True, slots=True)
class AxisNumber:
    """The number of an axis of the card."""

    c: str = "IMC32"
    refusal: IMC_STATUS = IMC_INVALID_AXIS

    def check(self, value: Any, axes: int) -> IMC_STATUS:
        """Refuse axes that the card does not have."""
        return IMC_OK if 0 <= index(value) < axes else self.refusal


@dataclass(frozen=True, slots=True)
class Queues:
    """A queue that takes the instruction."""

    accepted: frozenset[int]
    c: str = "int"

    def check(self, value: Any, axes: int) -> IMC_STATUS:
        """Refuse other queues."""
        return IMC_OK if value in self.accepted else IMC_INVALID_FIFO


@dataclass(frozen=True, slots=True)
class Fixed:
    """A number that becomes fixed point: `bits` whole bits with sign, `fraction` bits behind the point."""

    c: str = "IMCFLOAT"
    bits: int = 16
    fraction: int = 32

    def check(self, value: Any, axes: int) -> IMC_STATUS:
        """Refuse what the fixed-point number cannot hold."""
        if not math.isfinite(value):
            return IMC_OUT_OF_RANGE
        limit = 1 << (self.bits - 1 + self.fraction)
        return IMC_OK if -limit <= round(value * (1 << self.fraction)) < limit else IMC_OUT_OF_RANGE


@dataclass(frozen=True, slots=True)
class Pointer:
    """A structure or an array, which has to be there."""

    c: str

    def check(self, value: Any, axes: int) -> IMC_STATUS:
        """Refuse a null pointer."""
        return IMC_INVALID_PARAM if value is None else IMC_OK


_INSTRUCTIONS = frozenset((FIFO_SEL.SEL_IFIFO, FIFO_SEL.SEL_QFIFO, FIFO_SEL.SEL_PFIFO1, FIFO_SEL.SEL_PFIFO2))

# Numbers that are only stored may be given with or without sign, as a C compiler takes them.
IMC16: TypeAlias = Annotated[int, Whole("IMC16", -0x8000, 0xFFFF)]
IMC32: TypeAlias = Annotated[int, Whole("IMC32", -0x80000000, 0xFFFFFFFF)]
INT48: TypeAlias = Annotated[int, Whole("__int64", -0x800000000000, 0xFFFFFFFFFFFF)]
INT: TypeAlias = Annotated[int, Whole("int", -0x80000000, 0x7FFFFFFF)]
Location: TypeAlias = Annotated[int, Whole("IMC16", 0, 1023, IMC_INVALID_PARAM)]
Bit: TypeAlias = Annotated[int, Whole("IMC16", 0, 15, IMC_INVALID_PARAM)]
BitValue: TypeAlias = Annotated[int, Whole("IMC16", 0, 1)]
ArcDirection: TypeAlias = Annotated[int, Whole("IMC32", 0, 1)]
Positive: TypeAlias = Annotated[int, Whole("IMC32", 1, 0x7FFFFFFF)]
Source: TypeAlias = Annotated[int, Whole("IMC32", 0, 4)]
Count: TypeAlias = Annotated[int, Whole("WORD", 1, 0xFFFF)]
Count32: TypeAlias = Annotated[int, Whole("WORD", 1, 32)]
EventCount: TypeAlias = Annotated[int, Whole("IMCU16", 1, 31)]
PointWords: TypeAlias = Annotated[int, Whole("int", 1, 126)]
CaptureCount: TypeAlias = Annotated[int, Whole("IMC32", 0, 120)]
TimeoutMs: TypeAlias = Annotated[int, Whole("int", 1, 0x7FFFFFFF)]
OpenMode: TypeAlias = Annotated[int, Whole("int", 0, 1)]

Ratio: TypeAlias = Annotated[float, Fixed()]

Axis: TypeAlias = Annotated[int, AxisNumber()]
OtherAxis: TypeAlias = Annotated[int, AxisNumber(refusal=IMC_OUT_OF_RANGE)]
AxisIfAny: TypeAlias = Annotated[int, Whole("IMC32", -0x80000000, 0xFFFFFFFF)]
"""An axis that does not matter for parameters of the card; the call looks at both."""

Queue: TypeAlias = Annotated[int, Queues(_INSTRUCTIONS)]
WaitQueue: TypeAlias = Annotated[int, Queues(_INSTRUCTIONS - {FIFO_SEL.SEL_IFIFO})]
PathQueue: TypeAlias = Annotated[int, Queues(frozenset((FIFO_SEL.SEL_PFIFO1, FIFO_SEL.SEL_PFIFO2)))]
PointQueue: TypeAlias = Annotated[int, Queues(frozenset((FIFO_SEL.SEL_CFIFO,)))]
AnyQueue: TypeAlias = Annotated[int, Queues(frozenset(FIFO_SEL))]

Adapters: TypeAlias = Annotated[NIC_INFO, Pointer("NIC_INFO *")]
Descriptions: TypeAlias = Annotated[Elements[WR_MUL_DES], Pointer("pWR_MUL_DES")]
Events: TypeAlias = Annotated[Elements[EventInfo], Pointer("PEventInfo")]
Points: TypeAlias = Annotated[Elements[int], Pointer("short *")]
SegmentData: TypeAlias = Annotated[PFIFOSegData, Pointer("PFIFOSegData *")]
SegmentInfo: TypeAlias = Annotated[PFIFOSegInfo, Pointer("PFIFOSegInfo *")]
