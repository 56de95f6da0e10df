"""The structures of the function library, as they lie in the memory of a C program (manual 004, 6).

Sizes, gaps, unions and what becomes of a number that is too large are as in C.
"""

# ruff: noqa: N801  the names are the manual's

from __future__ import annotations

import ctypes
from typing import Annotated, Self, TypeAlias

from polycnc.controllers.imc.core._event_codes import EventCommand, constant_words
from polycnc.controllers.imc.core._event_codes import EventType as Trigger
from polycnc.controllers.library import Number, Structure, Texts, Times, Union, layouts, structure

ADAPTERS_MOST = 16
DESCRIPTION_SIZE = 256
SEGMENT_AXES_MOST = 16

WORD: TypeAlias = Annotated[int, Number("WORD", ctypes.c_uint16)]
IMC16: TypeAlias = Annotated[int, Number("IMC16", ctypes.c_int16)]
IMC32: TypeAlias = Annotated[int, Number("IMC32", ctypes.c_int32)]
INT64: TypeAlias = Annotated[int, Number("__int64", ctypes.c_int64)]
Words: TypeAlias = Annotated[ctypes.Array[ctypes.c_uint16], Number("WORD", ctypes.c_uint16)]
Numbers32: TypeAlias = Annotated[ctypes.Array[ctypes.c_int32], Number("IMC32", ctypes.c_int32)]


@structure()
class NIC_INFO(Structure):
    """The network adapters of the PC: up to 16 descriptions; the index of one is the `netcardsel` of a call."""

    description: Annotated[Texts, Times(ADAPTERS_MOST, DESCRIPTION_SIZE)]

    def descriptions(self) -> list[str]:
        """Return the descriptions that are not empty."""
        texts = (entry.value.decode("latin-1") for entry in self.description)
        return [text for text in texts if text]


@structure()
class WR_MUL_DES(Structure):
    """One parameter of several that are read or written together: `len` words, the low one first."""

    addr: WORD
    axis: WORD
    len: WORD
    data: Annotated[Words, Times(4)]

    @classmethod
    def of(cls, addr: int, axis: int = 0, length: int = 1, value: int = 0) -> Self:
        """Return the description of a parameter, with what to write into it."""
        made = cls(addr=addr, axis=axis, len=length)
        for k in range(3):
            made.data[k] = value >> (16 * k) & 0xFFFF
        return made

    @property
    def value(self) -> int:
        """Return the words as one signed number."""
        words = self.data[0 : self.len]
        return int.from_bytes(b"".join(word.to_bytes(2, "little") for word in words), "little", signed=True)


@structure()
class Src2Param(Structure):
    """Second operand of an event: a parameter."""

    Src2_loc: IMC16
    Src2_axis: IMC16
    reserve: IMC32


@structure()
class Src2Data16(Structure):
    """Second operand of an event: a constant of 16 bits."""

    data: IMC16
    reserve1: IMC16
    reserve2: IMC32


@structure()
class Src2Data32(Structure):
    """Second operand of an event: a constant of 32 bits."""

    data: IMC32
    reserve: IMC32


@structure()
class Operand2(Union):
    """Second operand of an event; the command says which member counts."""

    param: Src2Param
    data16: Src2Data16
    data32: Src2Data32
    data48: INT64


@structure()
class EventInfo(Structure):
    """One event: a command, when it acts, two operands, and where the result goes (0: nowhere)."""

    EventCMD: IMC16
    EventType: IMC16
    Src1_loc: IMC16
    Src1_axis: IMC16
    Src2: Operand2
    dest_loc: IMC16
    dest_axis: IMC16
    reserve: IMC32

    @classmethod
    def of(
        cls,
        command: EventCommand,
        when: Trigger = Trigger.IMC_Allways,
        *,
        src1: tuple[int, int] = (0, 0),
        src2: tuple[int, int] | int = 0,
        dest: tuple[int, int] = (0, 0),
    ) -> Self:
        """Return an event; operands are (address, axis), or a constant where the command takes one."""
        made = cls(EventCMD=command, EventType=when)
        made.Src1_loc, made.Src1_axis = src1
        made.dest_loc, made.dest_axis = dest
        if isinstance(src2, tuple):
            made.Src2.param.Src2_loc, made.Src2.param.Src2_axis = src2
        elif constant_words(command) == 1:
            made.Src2.data16.data = src2
        elif constant_words(command) == 2:
            made.Src2.data32.data = src2
        else:
            made.Src2.data48 = src2
        return made


@structure()
class PFIFOSegData(Structure):
    """A segment: where the axes end, and for an arc its centre and direction (0 clockwise, -1 counter-clockwise)."""

    datanum: IMC32
    SegEndData: Annotated[Numbers32, Times(SEGMENT_AXES_MOST)]
    CenterX: IMC32
    CenterY: IMC32
    dir: IMC32

    @classmethod
    def of(cls, *ends: int, center: tuple[int, int] = (0, 0), direction: int = 0) -> Self:
        """Return a segment that ends at these coordinates."""
        made = cls(datanum=len(ends), dir=direction)
        made.SegEndData[0 : len(ends)] = list(ends)
        made.CenterX, made.CenterY = center
        return made


@structure()
class PFIFOSegInfo(Structure):
    """A segment with its speed and the speed at its end."""

    SegTgVel: IMC32
    SegEndVel: IMC32
    data: PFIFOSegData

    @classmethod
    def of(cls, speed: int, end_speed: int, data: PFIFOSegData) -> Self:
        """Return a segment with speeds (S16.16, pulses per ms)."""
        return cls(speed, end_speed, data)


STRUCTURES = layouts(NIC_INFO, WR_MUL_DES, EventInfo, PFIFOSegData, PFIFOSegInfo)
"""What lies where, by the structure's name."""

# fmt: off
__all__ = [
    "NIC_INFO", "STRUCTURES", "WR_MUL_DES", "EventInfo", "PFIFOSegData", "PFIFOSegInfo",
]
# fmt: on
