"""What clients ask for, as lines of JSON that people read and that can be carried out once more."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from polycnc.controllers.library import Opaque
from polycnc.controllers.library.clib import Call, Slot, Way
from polycnc.errors import UsageError
from polycnc.servers.calls._frames import Done, Given


class Trace:
    """Write every call as a line: machine time, client, name, arguments, answer, outputs, and the room for them.

    Raises:
        UsageError: The file cannot be written.
    """

    def __init__(self, path: Path) -> None:
        try:
            self._file = path.open("a", encoding="utf-8")
        except (OSError, ValueError) as error:
            why = error.strerror if isinstance(error, OSError) else error
            raise UsageError(f"{path}: cannot be written: {why}", hint="Name another file.") from None
        self._clients = 0

    def next_client(self) -> int:
        """Return the number of a client that has come: the first is 1."""
        self._clients += 1
        return self._clients

    def write(self, time_s: float, client: int, given: list[Given], done: Done) -> None:
        """Write a call."""
        into = {each.slot.argument.name: shown(each.slot, each.content) for each in given if each.slot.reads}
        line = {"time_s": round(time_s, 6), "client": client, "call": done.name, "in": into}
        rooms = {each.slot.argument.name: each.room for each in given if each.slot.writes}
        if rooms:
            line["room"] = rooms
        line |= {"code": done.code, "out": outputs(given, done)}
        self._file.write(json.dumps(line) + "\n")
        self._file.flush()

    def close(self) -> None:
        """Close the file."""
        self._file.close()


def outputs(given: list[Given], done: Done) -> dict[str, Any]:
    """Return what a call has written, by argument; nothing of one that was refused."""
    written = [each.slot for each in given if each.slot.writes] if done.outputs else []
    return {
        slot.argument.name: shown(slot, content) for slot, content in zip(written, done.outputs, strict=True)
    }


def shown(slot: Slot, content: Any) -> Any:
    """Return a value as people read it: numbers, a text, else hexadecimal bytes."""
    if content is None or slot.way is Way.VALUE:
        return content
    if slot.way is Way.TEXT:
        return content.split(b"\0", 1)[0].decode("latin-1")
    if slot.way is Way.NUMBERS:
        whole = range(0, len(content) - slot.width + 1, slot.width)
        numbers = [slot.element.from_buffer_copy(content[at : at + slot.width]).value for at in whole]
        return numbers[0] if len(numbers) == 1 else numbers
    return content.hex()


def given_of(call: Call, into: Any, rooms: Any) -> list[Given]:
    """Return the arguments of a call from what a trace says.

    Raises:
        KeyError, TypeError, ValueError: It is not what a trace says.
    """
    made = []
    for slot in call.slots:
        name = slot.argument.name
        room = 0 if slot.way is Way.VALUE else rooms[name] if slot.writes else 0
        if not (room is None or (isinstance(room, int) and 0 <= room < 1 << 16)):
            raise ValueError(f"room for {name}")
        made.append(Given(slot, _content(slot, into[name]) if slot.reads else b"", room))
    return made


def _content(slot: Slot, value: Any) -> Any:
    if slot.way is Way.VALUE:
        if not isinstance(value, int | float) or (
            isinstance(value, float) and not isinstance(slot.element(0).value, float)
        ):
            raise TypeError(slot.argument.name)
        return slot.element(value).value if not isinstance(slot.argument.type, Opaque) else value
    if value is None:
        return None
    if slot.way is Way.TEXT:
        return value.encode("latin-1") + b"\0"
    if slot.way is Way.NUMBERS:
        numbers = value if isinstance(value, list) else [value]
        return b"".join(bytes(slot.element(each)) for each in numbers)
    return bytes.fromhex(value)
