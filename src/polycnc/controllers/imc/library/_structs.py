"""The structures of the function library, as they lie in the memory of a C program (manual 004, 6).

They are `ctypes` structures, so sizes, gaps, unions and what becomes of a number that is too large are as in C.
"""

# ruff: noqa: N801  the names are the manual's

from __future__ import annotations

import ctypes
from typing import Any, ClassVar, Self

from polycnc.controllers.imc.core._event_codes import EventCommand, constant_words
from polycnc.controllers.imc.core._event_codes import EventType as Trigger
from polycnc.errors import UsageError

ADAPTERS_MOST = 16
DESCRIPTION_SIZE = 256
SEGMENT_AXES_MOST = 16


class Record(ctypes.LittleEndianStructure):
    """A structure that can be turned into bytes and back."""

    def pack(self) -> bytes:
        """Return the structure as it lies in memory."""
        return bytes(self)

    @classmethod
    def unpack(cls, memory: bytes) -> Self:
        """Return the structure that lies in `memory`.

        Raises:
            UsageError: `memory` has another size than the structure.
        """
        if len(memory) != ctypes.sizeof(cls):
            raise UsageError(
                f"{cls.__name__} has {ctypes.sizeof(cls)} bytes, not {len(memory)}",
                hint="pass exactly one structure",
            )
        return cls.from_buffer_copy(memory)

    def __eq__(self, other: object) -> bool:
        return bytes(self) == bytes(other) if isinstance(other, type(self)) else NotImplemented

    def __hash__(self) -> int:
        return hash(bytes(self))


class NIC_INFO(Record):
    """The network adapters of the PC: up to 16 descriptions; the index of one is the `netcardsel` of a call."""

    description: Any  # of 16 times 256 characters
    _fields_: ClassVar = [("description", ctypes.c_char * DESCRIPTION_SIZE * ADAPTERS_MOST)]

    def descriptions(self) -> list[str]:
        """Return the descriptions that are not empty."""
        texts = (entry.value.decode("latin-1") for entry in self.description)
        return [text for text in texts if text]


class WR_MUL_DES(Record):
    """One parameter of several that are read or written together: `len` words, the low one first."""

    addr: int
    axis: int
    len: int
    data: ctypes.Array[ctypes.c_uint16]
    _fields_: ClassVar = [
        ("addr", ctypes.c_uint16),
        ("axis", ctypes.c_uint16),
        ("len", ctypes.c_uint16),
        ("data", ctypes.c_uint16 * 4),
    ]

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


class Src2Param(Record):
    """Second operand of an event: a parameter."""

    Src2_loc: int
    Src2_axis: int
    reserve: int
    _fields_: ClassVar = [
        ("Src2_loc", ctypes.c_int16),
        ("Src2_axis", ctypes.c_int16),
        ("reserve", ctypes.c_int32),
    ]


class Src2Data16(Record):
    """Second operand of an event: a constant of 16 bits."""

    data: int
    reserve1: int
    reserve2: int
    _fields_: ClassVar = [
        ("data", ctypes.c_int16),
        ("reserve1", ctypes.c_int16),
        ("reserve2", ctypes.c_int32),
    ]


class Src2Data32(Record):
    """Second operand of an event: a constant of 32 bits."""

    data: int
    reserve: int
    _fields_: ClassVar = [("data", ctypes.c_int32), ("reserve", ctypes.c_int32)]


class Operand2(ctypes.LittleEndianUnion):
    """Second operand of an event; the command says which member counts."""

    param: Src2Param
    data16: Src2Data16
    data32: Src2Data32
    data48: int
    _fields_: ClassVar = [
        ("param", Src2Param),
        ("data16", Src2Data16),
        ("data32", Src2Data32),
        ("data48", ctypes.c_int64),
    ]


class EventInfo(Record):
    """One event: a command, when it acts, two operands, and where the result goes (0: nowhere)."""

    EventCMD: int
    EventType: int
    Src1_loc: int
    Src1_axis: int
    Src2: Operand2
    dest_loc: int
    dest_axis: int
    reserve: int
    _fields_: ClassVar = [
        ("EventCMD", ctypes.c_int16),
        ("EventType", ctypes.c_int16),
        ("Src1_loc", ctypes.c_int16),
        ("Src1_axis", ctypes.c_int16),
        ("Src2", Operand2),
        ("dest_loc", ctypes.c_int16),
        ("dest_axis", ctypes.c_int16),
        ("reserve", ctypes.c_int32),
    ]

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


class PFIFOSegData(Record):
    """A segment: where the axes end, and for an arc its centre and direction (0 clockwise, -1 counter-clockwise)."""

    datanum: int
    SegEndData: ctypes.Array[ctypes.c_int32]
    CenterX: int
    CenterY: int
    dir: int
    _fields_: ClassVar = [
        ("datanum", ctypes.c_int32),
        ("SegEndData", ctypes.c_int32 * SEGMENT_AXES_MOST),
        ("CenterX", ctypes.c_int32),
        ("CenterY", ctypes.c_int32),
        ("dir", ctypes.c_int32),
    ]

    @classmethod
    def of(cls, *ends: int, center: tuple[int, int] = (0, 0), direction: int = 0) -> Self:
        """Return a segment that ends at these coordinates."""
        made = cls(datanum=len(ends), dir=direction)
        made.SegEndData[0 : len(ends)] = list(ends)
        made.CenterX, made.CenterY = center
        return made


class PFIFOSegInfo(Record):
    """A segment with its speed and the speed at its end."""

    SegTgVel: int
    SegEndVel: int
    data: PFIFOSegData
    _fields_: ClassVar = [
        ("SegTgVel", ctypes.c_int32),
        ("SegEndVel", ctypes.c_int32),
        ("data", PFIFOSegData),
    ]

    @classmethod
    def of(cls, speed: int, end_speed: int, data: PFIFOSegData) -> Self:
        """Return a segment with speeds (S16.16, pulses per ms)."""
        return cls(speed, end_speed, data)
