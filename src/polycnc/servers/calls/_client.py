"""What one client sends, without sockets: its hello, then frames of calls; what it gets back."""

from __future__ import annotations

import json
import struct
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from polycnc.controllers.library.clib import CLibrary, Slot, Way
from polycnc.errors import UsageError
from polycnc.servers.calls._caller import Caller
from polycnc.servers.calls._frames import CallError, Done, Given, answer_frame
from polycnc.servers.machines import AS_USUAL, Treatment

MAGIC = b"PNCCALL1"
_HELLO = struct.Struct("<8sBBH16s16s16s")
_WELCOME = struct.Struct("<8si")
_HEAD = struct.Struct("<HH")
_SIZE = struct.Struct("<I")
_BEGIN = _SIZE.size + _HEAD.size
_MOST = 65536
_MOST_BEHIND = 4 * _MOST  # bytes that wait to be carried out
_WIDTHS = (4, 8)


@dataclass(frozen=True, slots=True)
class Hello:
    """What a library says of itself."""

    name: str
    version: str
    table: bytes
    pointer: int
    packing: int

    @classmethod
    def of(cls, said: bytes) -> Hello:
        """Read a hello.

        Raises:
            CallError: It is none.
        """
        magic, pointer, packing, _, name, version, table = _HELLO.unpack(said)
        if magic != MAGIC or pointer not in _WIDTHS:
            raise CallError("a client that does not say hello")
        return cls(_text(name), _text(version), table, pointer, packing)


def _text(said: bytes) -> str:
    return said.split(b"\0", 1)[0].decode("ascii", "replace")


class Trace:
    """Write every call as a line of JSON: name, arguments, answer, outputs, machine time.

    Raises:
        UsageError: The file cannot be written.
    """

    def __init__(self, path: Path) -> None:
        try:
            self._file = path.open("a", encoding="utf-8")
        except (OSError, ValueError) as error:
            why = error.strerror if isinstance(error, OSError) else error
            raise UsageError(f"{path}: cannot be written: {why}", hint="Name another file.") from None

    def write(self, time_s: float, given: list[Given], done: Done) -> None:
        """Write a call."""
        outputs = iter(done.outputs)
        into = {each.slot.argument.name: _shown(each.slot, each.content) for each in given if each.slot.reads}
        out = {}
        for each in given:
            if each.slot.writes and done.outputs:
                out[each.slot.argument.name] = _shown(each.slot, next(outputs))
        line = {"time_s": round(time_s, 6), "call": done.name, "in": into, "code": done.code, "out": out}
        self._file.write(json.dumps(line) + "\n")
        self._file.flush()

    def close(self) -> None:
        """Close the file."""
        self._file.close()


def _shown(slot: Slot, content: Any) -> Any:
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


@dataclass(slots=True)
class CallClient:
    """Take the bytes of one client and return what it gets; after `ended` it gets nothing more.

    `find` returns the caller for a library, or None if no machine here has it. `tell` is told in a sentence what was
    refused. Whole frames are carried out one after the other. `treat` counts a call and says how it is
    to be treated: what is dropped ends the connection and is not carried out, and `delay_s` is how much later all
    answers of the last bytes come.
    """

    find: Callable[[str], Caller | None]
    tell: Callable[[str], None] = lambda _: None
    trace: Trace | None = None
    now_s: Callable[[], float] = lambda: 0.0
    treat: Callable[[], Treatment] = lambda: AS_USUAL
    ended: bool = False
    dropped: bool = False
    delay_s: float = 0.0
    caller: Caller | None = None
    _behind: bytearray = field(default_factory=bytearray)

    def receive(self, data: bytes) -> bytes:
        """Carry out what is whole with these bytes."""
        if self.ended:
            return b""
        self._behind += data
        self.delay_s = 0.0
        sent = list[bytes]()
        try:
            if len(self._behind) > _MOST_BEHIND:
                raise CallError(f"more than {_MOST_BEHIND} bytes wait")
            while self._behind and not self.ended and (more := self._one()) is not None:
                sent.append(more)
        except CallError as error:
            self.tell(str(error))
            self.ended = True
        return b"".join(sent)

    def _one(self) -> bytes | None:
        """Return the answer to the next whole thing, None if there is none.

        Raises:
            CallError: It is nothing that a library sends.
        """
        behind = self._behind
        if self.caller is None:
            if not MAGIC.startswith(behind[: len(MAGIC)]):
                raise CallError("a client that does not say hello")
            return self._welcomed(self._taken(_HELLO.size)) if len(behind) >= _HELLO.size else None
        if len(behind) < _SIZE.size:
            return None
        (size,) = _SIZE.unpack_from(behind)
        if not _HEAD.size <= size <= _MOST - _SIZE.size:
            raise CallError(f"a frame of {size} bytes")
        if len(behind) < _SIZE.size + size:
            return None
        treatment = self.treat()
        if treatment.drop:
            self.ended = self.dropped = True
            return None
        self.delay_s = max(self.delay_s, treatment.delay_s)
        number, serial = _HEAD.unpack_from(behind, _SIZE.size)
        call, given, done = self.caller.carry_out(number, self._taken(_SIZE.size + size)[_BEGIN:])
        if self.trace is not None:
            self.trace.write(self.now_s(), given, done)
        return answer_frame(call, serial, done, _MOST - _SIZE.size)

    def _taken(self, size: int) -> bytes:
        made = bytes(self._behind[:size])
        del self._behind[:size]
        return made

    def _welcomed(self, said: bytes) -> bytes:
        """Answer a hello: with 0, or with the code that every call gets."""
        hello = Hello.of(said)
        caller = self.find(hello.name)
        if caller is None:
            raise CallError(f"no machine here has the library {hello.name}")
        refusal = _unfit(hello, caller.library)
        if refusal:
            self.tell(refusal)
            self.ended = True
            return _WELCOME.pack(MAGIC, caller.library.version)
        self.caller = caller
        return _WELCOME.pack(MAGIC, 0)


def _unfit(hello: Hello, library: CLibrary) -> str:
    """Return what is wrong with a library, "" if nothing is."""
    if hello.table != library.table_hash:
        return f"{hello.name} {hello.version} has another table of functions: make it anew with polycnc clib"
    return f"{hello.name} packs structures to {hello.packing} bytes" if hello.packing else ""
