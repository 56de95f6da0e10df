"""What one client sends, without sockets: its hello, then frames of calls; what it gets back."""

from __future__ import annotations

import struct
from collections.abc import Callable
from dataclasses import dataclass, field

from polycnc.controllers.library.clib import CLibrary
from polycnc.servers.calls._caller import Caller
from polycnc.servers.calls._frames import HEAD, MOST, SIZE, CallError
from polycnc.servers.calls._quick import BEGIN, Quick
from polycnc.servers.calls._trace import Trace
from polycnc.servers.machines import AS_USUAL, Treatment

MAGIC = b"PNCCALL1"
_HELLO = struct.Struct("<8sBBH16s16s16s")
_WELCOME = struct.Struct("<8si")
_INTERRUPT = struct.Struct("<IHHi")
_LEAST = HEAD.size - SIZE.size
_MOST_BEHIND = 4 * MOST  # bytes that wait to be carried out
_WIDTHS = (4, 8)
_NOT_QUICK = (0, None)


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


@dataclass(slots=True)
class CallClient:
    """Take the bytes of one client and return what it gets; after `ended` it gets nothing more.

    `find` returns the caller for a library and a packing, or None if no machine here has it. `tell` is told in a
    sentence what was refused. Whole frames are carried out one after the other. `treat` counts a call and says how it
    is to be treated: what is dropped ends the connection after the answers before it and is not carried out, and
    `delay_s` is how much later all answers of the last bytes come. `push` sends what comes unasked, interrupts.
    """

    find: Callable[[str, int], Caller | None]
    tell: Callable[[str], None] = lambda _: None
    trace: Trace | None = None
    now_s: Callable[[], float] = lambda: 0.0
    treat: Callable[[], Treatment] = lambda: AS_USUAL
    push: Callable[[bytes], None] = lambda _: None
    ended: bool = False
    delay_s: float = 0.0
    caller: Caller | None = None
    number: int = 0
    _behind: bytearray = field(default_factory=bytearray)

    def receive(self, data: bytes) -> bytes:
        """Carry out what is whole with these bytes."""
        if self.ended:
            return b""
        self.delay_s = 0.0
        sent: list[bytes] = []
        try:
            if not self._behind:
                if (quick := self._quick(data)) is not None:
                    return quick(data) if self._is_treated() else b""
                at = self._go(data, sent)
                if at != len(data):
                    self._behind += data[at:]
            else:
                self._behind += data
                if len(self._behind) > _MOST_BEHIND:
                    raise CallError(f"more than {_MOST_BEHIND} bytes wait")
                del self._behind[: self._go(self._behind, sent)]
        except CallError as error:
            self.tell(str(error))
            self.ended = True
        return sent[0] if len(sent) == 1 else b"".join(sent)

    def _quick(self, data: bytes) -> Quick | None:
        """Return what answers bytes that are one whole frame of a call that has a quick way."""
        if self.caller is None or self.trace is not None:
            return None
        size, quick = self.caller.quick.get(data[:BEGIN], _NOT_QUICK)
        return quick if size == len(data) else None

    def _go(self, there: bytes | bytearray, sent: list[bytes]) -> int:
        """Answer one whole thing after the other; return how many bytes they had.

        Raises:
            CallError: Something is nothing that a library sends.
        """
        at, most = 0, len(there)
        while at < most and not self.ended:
            if self.caller is None:
                if not MAGIC.startswith(there[: len(MAGIC)]):
                    raise CallError("a client that does not say hello")
                if most < _HELLO.size:
                    break
                sent.append(self._welcomed(bytes(there[: _HELLO.size])))
                at = _HELLO.size
                continue
            if most - at < HEAD.size:
                if most - at >= SIZE.size:
                    _checked(*SIZE.unpack_from(there, at))
                break
            size, number, serial = HEAD.unpack_from(there, at)
            end = at + _checked(size)
            if most < end:
                break
            answer = self._answered(self.caller, number, serial, bytes(there[at + HEAD.size : end]))
            if answer is None:
                break
            sent.append(answer)
            at = end
        return at

    def _answered(self, caller: Caller, number: int, serial: int, packed: bytes) -> bytes | None:
        """Carry out a call and return its answer; None if it is dropped."""
        if not self._is_treated():
            return None
        layout, done = caller.carry_out(number, packed)
        if self.trace is not None:
            self.trace.write(self.now_s(), self.number, layout.unpacked(packed), done)
        return layout.answered(serial, done)

    def _is_treated(self) -> bool:
        """Count a call, and tell whether it is carried out."""
        treatment = self.treat()
        if treatment.drop:
            self.ended = True
            return False
        if treatment.delay_s > self.delay_s:
            self.delay_s = treatment.delay_s
        return True

    def _welcomed(self, said: bytes) -> bytes:
        """Answer a hello: with 0, or with the code that every call gets."""
        hello = Hello.of(said)
        caller = self.find(hello.name, hello.packing)
        if caller is None:
            raise CallError(f"no machine here has the library {hello.name}")
        refusal = _unfit(hello, caller.library)
        if refusal:
            self.tell(refusal)
            self.ended = True
            return _WELCOME.pack(MAGIC, caller.library.version)
        self.caller = caller
        caller.push = lambda lines: self.push(_INTERRUPT.pack(_INTERRUPT.size - SIZE.size, 0, 0, lines))
        self.number = 0 if self.trace is None else self.trace.next_client()
        return _WELCOME.pack(MAGIC, 0)


def _checked(size: int) -> int:
    """Return how many bytes a frame has that says how many follow.

    Raises:
        CallError: They are too few or too many.
    """
    if not _LEAST <= size <= MOST - SIZE.size:
        raise CallError(f"a frame of {size} bytes")
    return SIZE.size + size


def _unfit(hello: Hello, library: CLibrary) -> str:
    """Return what is wrong with a library, "" if nothing is."""
    if hello.packing != library.packing:
        return f"{hello.name} packs structures to {hello.packing} bytes"
    if hello.table != library.table_hash:
        return f"{hello.name} {hello.version} has another table of functions: make it anew with polycnc clib"
    return ""
