"""Frames of calls: the arguments in one, and the answer."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import Any, NamedTuple

from polycnc.controllers.library.clib import Call, Slot, Way

NULL = 0xFFFFFFFF
MOST = 66_560
"""Bytes of a frame."""
SIZE = struct.Struct("<I")
HEAD = struct.Struct("<IHH")
"""How many bytes follow, the number of the call, its serial number."""
CARRIED_OUT, REFUSED = 0, 1
_DOUBLE = 8
_FORMATS = {1: "b", 2: "h", 4: "i", 8: "q"}


class CallError(Exception):
    """A frame that no library of this table writes; the connection is of no more use."""


class Given(NamedTuple):
    """What came for an argument: `content` is what goes in, `room` how much may be written, None of a null pointer."""

    slot: Slot
    content: Any
    """A number of `Way.VALUE`, else bytes."""
    room: int | None


@dataclass(slots=True)
class Done:
    """A call that has been carried out, as far as it was."""

    name: str
    code: int | float | None
    outputs: list[bytes]
    refused: bool = False


class Layout:
    """How the arguments of a call lie in a frame."""

    def __init__(self, call: Call) -> None:
        self.call = call
        self._values = [
            struct.Struct(f"<{form_of(each)}") if each.way is Way.VALUE else SIZE for each in call.slots
        ]
        self._written = sum(each.writes for each in call.slots)
        result = "d" if call.function.result == "double" else "q"
        self._answer = struct.Struct(f"<IHHI{result}{self._written}I")

    def unpacked(self, packed: bytes) -> list[Given]:
        """Return the arguments in a frame.

        Raises:
            CallError: They are not as long as they have to be.
        """
        at = 0
        given: list[Given] = []
        for slot, value in zip(self.call.slots, self._values, strict=True):
            if slot.way is Way.VALUE:
                given.append(Given(slot, self._number(value, packed, at), 0))
                at += value.size
                continue
            content: bytes | None = b""
            room: int | None = 0
            if slot.reads:
                size = self._size(packed, at)
                at += SIZE.size
                content = None if size is None else packed[at : at + size]
                at += size or 0
            if slot.writes:
                room = self._size(packed, at)
                at += SIZE.size
            given.append(Given(slot, content, room))
        if at > len(packed):
            raise self._cut(packed)
        if at < len(packed):
            raise CallError(f"{self.call.function.name} is followed by {len(packed) - at} bytes")
        return given

    def answered(self, serial: int, done: Done) -> bytes:
        """Return the answer to a call: state, result, the sizes of all outputs, the outputs.

        Raises:
            CallError: It is too long.
        """
        outputs = done.outputs or [b""] * self._written
        sizes = [*map(len, outputs)]
        size = self._answer.size - SIZE.size + sum(sizes)
        if size > MOST - SIZE.size:
            raise CallError(f"the answer to {done.name} has {size} bytes")
        state = REFUSED if done.refused else CARRIED_OUT
        head = self._answer.pack(size, self.call.number, serial, state, done.code or 0, *sizes)
        return head + b"".join(outputs)

    def _size(self, packed: bytes, at: int) -> int | None:
        """Return a size in a frame; None of a null pointer."""
        found: int = self._number(SIZE, packed, at)
        return None if found == NULL else found

    def _number(self, form: struct.Struct, packed: bytes, at: int) -> Any:
        if at + form.size > len(packed):
            raise self._cut(packed)
        return form.unpack_from(packed, at)[0]

    def _cut(self, packed: bytes) -> CallError:
        return CallError(f"{self.call.function.name} is cut at byte {len(packed)}")


def form_of(slot: Slot) -> str:
    """Return the format of a number: a float, or so many bytes with a sign or without; of a pointer, its size."""
    if slot.way is not Way.VALUE:
        return "I"
    below = slot.element(-1).value
    if isinstance(below, float):
        return "d" if slot.width == _DOUBLE else "f"
    form = _FORMATS[slot.width]
    return form if below < 0 else form.upper()
