"""One call: bytes become arguments, the façade carries it out, its outputs become bytes."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

from polycnc.controllers.library import Opaque, Session
from polycnc.controllers.library.clib import Call, CLibrary, Slot, Way
from polycnc.errors import UsageError

_NULL = 0xFFFFFFFF
_SIZE = struct.Struct("<I")
_ANSWER = struct.Struct("<HHI")
_MOST_HANDLES = 65536  # that a client has ever had
_CARRIED_OUT, _REFUSED = 0, 1


class CallError(Exception):
    """A frame that no library of this table writes; the connection is of no more use."""


@dataclass(frozen=True, slots=True)
class Given:
    """What came for an argument: `content` is what goes in, `room` how much may be written, None of a null pointer."""

    slot: Slot
    content: bytes | None
    room: int | None


@dataclass(slots=True)
class Done:
    """A call that has been carried out, as far as it was."""

    name: str
    code: int | float | None
    outputs: list[bytes]
    refused: bool = False


@dataclass(slots=True)
class Caller:
    """Carry out calls of one client, in its session of the façade.

    `ways` takes the place of functions that are different for a client elsewhere.
    """

    library: CLibrary
    session: Session
    ways: dict[str, Callable[..., Any]] = field(default_factory=dict)
    _handles: dict[int, Any] = field(default_factory=dict)
    _numbers: dict[int, Call] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self._numbers = {each.number: each for each in self.library.calls}

    def carry_out(self, number: int, packed: bytes) -> tuple[Call, list[Given], Done]:
        """Carry out a call.

        Raises:
            CallError: There is no such call, or its arguments are not those of the table; nothing is carried out.
        """
        call = self._numbers.get(number)
        if call is None:
            raise CallError(f"there is no call {number}")
        given = list(_unpacked(call, packed))
        return call, given, self._done(call, given)

    def _done(self, call: Call, given: list[Given]) -> Done:
        name = call.function.name
        null = Done(name, self._code(call, self.library.null), [], True)
        if any(each.room is None for each in given if each.slot.writes and not each.slot.holder):
            return null
        function = self.ways.get(name) or getattr(self.session, name)
        values = self._values(given)
        self.session.refused = False
        try:
            answer = function(*values.values())
        except UsageError:
            return null
        results = list(answer) if isinstance(answer, tuple) else [answer]
        code = None if call.function.result == "void" else results.pop(0)
        if self.session.refused:
            return Done(name, code, [], True)
        return Done(name, code, list(self._outputs(given, values, results)))

    def _values(self, given: list[Given]) -> dict[str, Any]:
        """Return what the façade is given, by name and in order."""
        values = {each.slot.argument.name: self._value(each) for each in given if each.slot.argument.passed}
        for each in given:
            holder = values.get(each.slot.holder)
            if holder is not None:
                held = bytearray(each.room or 0) if each.slot.writes else bytearray(each.content or b"")
                setattr(holder, each.slot.member, held)
        return values

    def _outputs(self, given: list[Given], values: dict[str, Any], results: list[Any]) -> Iterator[bytes]:
        """Go through what is written, each cut to its room."""
        returned = iter(results)
        for each in given:
            if not each.slot.writes:
                continue
            argument = each.slot.argument
            if each.slot.holder:
                value = getattr(values[each.slot.holder], each.slot.member)
            else:
                value = next(returned) if argument.returned else values[argument.name]
            yield _changed(each, self._bytes(each.slot, value)[: each.room or 0])

    def _code(self, call: Call, code: int) -> int | float | None:
        if call.function.result == "void":
            return None
        if call.function.coded:
            return self.library.failures.get(call.function.name, code)
        zero: int | float = call.function.zero()
        return zero

    def _value(self, given: Given) -> Any:
        """Return what the façade is given; None for a null pointer."""
        slot, content = given.slot, given.content
        if not slot.reads:
            return slot.element() if slot.way is Way.RECORD else self._empty(given)
        if content is None:
            return None
        opaque = isinstance(slot.argument.type, Opaque)
        match slot.way:
            case Way.VALUE | Way.NUMBERS:
                numbers = _numbers(slot, content)
                if _is_many(slot):
                    return numbers
                value = numbers[0] if numbers else 0
                return self._handles.get(value, value) if opaque else value
            case Way.TEXT:
                return content.split(b"\0", 1)[0].decode("latin-1")
            case Way.MEMORY:
                return content
            case Way.RECORD:
                return slot.element.from_buffer_copy(content[: slot.width].ljust(slot.width, b"\0"))
        return self._records(slot, content)

    def _empty(self, given: Given) -> Any:
        return self._records(given.slot, bytes(given.room or 0)) if given.slot.way is Way.RECORDS else None

    def _records(self, slot: Slot, content: bytes) -> list[Any]:
        whole = range(0, len(content) - slot.width + 1, slot.width)
        return [slot.element.from_buffer_copy(content[at : at + slot.width]) for at in whole]

    def _bytes(self, slot: Slot, value: Any) -> bytes:
        """Return an output as it lies in the program's memory."""
        match slot.way:
            case Way.NUMBERS if isinstance(slot.argument.type, Opaque):
                return bytes(slot.element(self._number(value)))
            case Way.NUMBERS:
                numbers = value if isinstance(value, (list, tuple)) else [value]
                return b"".join(bytes(slot.element(each)) for each in numbers)
            case Way.TEXT:
                return str(value).encode("latin-1", "replace") + b"\0"
            case Way.RECORDS:
                return b"".join(bytes(each) for each in value)
        return bytes(value)

    def _number(self, handle: Any) -> int:
        """Return the number that stands for a handle; 0 for none."""
        if handle is None:
            return 0
        number = len(self._handles) + 1
        if number > _MOST_HANDLES:
            raise CallError(f"more than {_MOST_HANDLES} handles")
        self._handles[number] = handle
        return number


def _changed(given: Given, content: bytes) -> bytes:
    """Return what has to be written of records: no record behind the last one that the call has changed."""
    before, width = given.content, given.slot.width
    if given.slot.way is not Way.RECORDS or not before:
        return content
    count = len(content) // width
    while (
        count and content[(count - 1) * width : count * width] == before[(count - 1) * width : count * width]
    ):
        count -= 1
    return content[: count * width]


def _is_many(slot: Slot) -> bool:
    return getattr(slot.argument.type, "of", None) is int


def _numbers(slot: Slot, content: bytes) -> list[Any]:
    whole = range(0, len(content) - slot.width + 1, slot.width)
    return [slot.element.from_buffer_copy(content[at : at + slot.width]).value for at in whole]


def _unpacked(call: Call, packed: bytes) -> Iterator[Given]:
    """Go through the arguments in a frame.

    Raises:
        CallError: They are not as long as they have to be.
    """
    at = 0

    def taken(size: int) -> bytes:
        nonlocal at
        if size > len(packed) - at:
            raise CallError(f"{call.function.name} is cut at byte {len(packed)}")
        at += size
        return packed[at - size : at]

    def size() -> int | None:
        found: int = _SIZE.unpack(taken(4))[0]
        return None if found == _NULL else found

    for slot in call.slots:
        if slot.way is Way.VALUE:
            yield Given(slot, taken(slot.width), 0)
            continue
        content: bytes | None = b""
        room: int | None = 0
        if slot.reads:
            content = None if (count := size()) is None else taken(count)
        if slot.writes:
            room = size()
        yield Given(slot, content, room)
    if at != len(packed):
        raise CallError(f"{call.function.name} is followed by {len(packed) - at} bytes")


def answer_frame(call: Call, serial: int, done: Done, most: int) -> bytes:
    """Return the answer to a call: state, result, the sizes of all outputs, the outputs."""
    result = bytes(8)
    if isinstance(done.code, float):
        result = struct.pack("<d", done.code)
    elif done.code is not None:
        result = struct.pack("<q", int(done.code))
    writes = sum(each.writes for each in call.slots)
    outputs = done.outputs or [b""] * writes
    body = _ANSWER.pack(call.number, serial, _REFUSED if done.refused else _CARRIED_OUT) + result
    body += b"".join(_SIZE.pack(len(each)) for each in outputs) + b"".join(outputs)
    if len(body) > most:
        raise CallError(f"the answer to {done.name} has {len(body)} bytes")
    return _SIZE.pack(len(body)) + body
