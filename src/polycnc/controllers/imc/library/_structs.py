"""The structures of the function library, as they lie in the memory of a C program (manual 004, 6).

Sizes, gaps, unions and what becomes of a number that is too large are as in C.
"""

# ruff: noqa: N801  the names are the manual's

from __future__ import annotations

from typing import Self

from polycnc.controllers.imc.core._event_codes import EventCommand, constant_words
from polycnc.controllers.imc.core._event_codes import EventType as Trigger
from polycnc.controllers.imc.library import _declared
from polycnc.controllers.imc.library._declared import HEADER


class NIC_INFO(_declared.NIC_INFO):
    """The network adapters of the PC: up to 16 descriptions; the index of one is the `netcardsel` of a call."""

    __slots__ = ()

    def descriptions(self) -> list[str]:
        """Return the descriptions that are not empty."""
        texts = (entry.value.decode("latin-1") for entry in self.description)
        return [text for text in texts if text]


class WR_MUL_DES(_declared.WR_MUL_DES):
    """One parameter of several that are read or written together: `len` words, the low one first."""

    __slots__ = ()

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


class EventInfo(_declared.EventInfo):
    """One event: a command, when it acts, two operands, and where the result goes (0: nowhere)."""

    __slots__ = ()

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


class PFIFOSegData(_declared.PFIFOSegData):
    """A segment: where the axes end, and for an arc its centre and direction (0 clockwise, -1 counter-clockwise)."""

    __slots__ = ()

    @classmethod
    def of(cls, *ends: int, center: tuple[int, int] = (0, 0), direction: int = 0) -> Self:
        """Return a segment that ends at these coordinates."""
        made = cls(datanum=len(ends), dir=direction)
        made.SegEndData[0 : len(ends)] = list(ends)
        made.CenterX, made.CenterY = center
        return made


class PFIFOSegInfo(_declared.PFIFOSegInfo):
    """A segment with its speed and the speed at its end."""

    __slots__ = ()

    @classmethod
    def of(cls, speed: int, end_speed: int, data: PFIFOSegData) -> Self:
        """Return a segment with speeds (S16.16, pulses per ms)."""
        return cls(speed, end_speed, data)


STRUCTURES = HEADER.layouts
"""What lies where, by the structure's name."""

# fmt: off
__all__ = [
    "NIC_INFO", "STRUCTURES", "WR_MUL_DES", "EventInfo", "PFIFOSegData", "PFIFOSegInfo",
]
# fmt: on
