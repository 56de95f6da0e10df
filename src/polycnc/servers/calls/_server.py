"""The shell of the door: TCP connections, each a client with a session of the façade of its own."""

from __future__ import annotations

import asyncio
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import cast

from polycnc.controllers.library.clib import PORT
from polycnc.errors import UsageError
from polycnc.servers.calls._caller import Caller
from polycnc.servers.calls._client import CallClient
from polycnc.servers.calls._libraries import LIBRARIES
from polycnc.servers.calls._linger import Linger
from polycnc.servers.calls._trace import Trace
from polycnc.servers.machines import (
    AS_USUAL,
    LOOPBACK,
    Crowd,
    Log,
    ServedMachine,
    Treatment,
    notice_loss,
    peers_of,
)

_MOST_CLIENTS = 256
_HELLO_S = 10.0
_ATTENTION_S = 0.01  # how late a client that listens hears of an interrupt
_READ = 16_384  # bytes at once


class CallsServer:
    """Answer C programs for machines whose kind has a library; port 0 takes a free one, see `port`."""

    def __init__(
        self,
        machines: Sequence[ServedMachine],
        *,
        address: str = LOOPBACK,
        port: int = PORT,
        log: Log | None = None,
        trace: Path | None = None,
    ) -> None:
        self.address, self.port = address, port
        self.lines = Crowd[_Line](_MOST_CLIENTS, lambda each: each.is_new, lambda each: each.abort())
        kinds = dict.fromkeys(each.kind for each in machines)
        self._libraries = {LIBRARIES[kind].load().name: kind for kind in kinds}
        for kind in kinds:
            LIBRARIES[kind].load().prepare()  # no client waits for it
        self._machines = machines
        self._log = log or Log()
        self.trace = None if trace is None else Trace(trace)
        self._server: asyncio.Server | None = None

    @property
    def said(self) -> str:
        """Where it listens."""
        return f"{self.address}:{self.port}"

    @property
    def clients(self) -> list[str]:
        """The addresses of the clients that are connected now."""
        return peers_of(line.transport for line in self.lines)

    async def start(self) -> None:
        """Listen.

        Raises:
            UsageError: The address or port cannot be listened on.
        """
        loop = asyncio.get_running_loop()
        try:
            self._server = await loop.create_server(
                lambda: _Line(self), self.address, self.port, reuse_address=True
            )
        except OSError as error:
            raise UsageError(
                f"cannot listen on {self.address}:{self.port}: {error.strerror or error}",
                hint="Choose another port or address; another server may have this one.",
            ) from None
        self.port = self._server.sockets[0].getsockname()[1]

    async def close(self) -> None:
        """Stop listening and end every connection."""
        if self._server is not None:
            self._server.close()
        for line in self.lines:
            line.abort()
        await asyncio.sleep(0)  # lets the connections tell that they are lost
        if self.trace is not None:
            self.trace.close()

    def adopt(self, transport: asyncio.Transport, data: bytes) -> None:
        """Answer a connection that somebody else has taken, and that began with these bytes."""
        line = _Line(self)
        transport.set_protocol(line)
        line.connection_made(transport)
        line.take(data)

    def find(self, name: str, packing: int) -> tuple[Caller, list[ServedMachine]] | None:
        """Return a caller of a library in a packing, else in the manual's, and the machines that it reaches."""
        kind = self._libraries.get(name)
        if kind is None:
            return None
        machines = [each for each in self._machines if each.kind == kind]
        served = LIBRARIES[kind]
        library = served.load()
        return served.make(
            library.packed(packing) or library, [each.device for each in machines], None
        ), machines

    def tell(self, sentence: str) -> None:
        """Write what was refused into the log."""
        self._log.write("refused", door="calls", reason=sentence)


class _Line(asyncio.BufferedProtocol):
    """One connection. While time cannot pass for it, or its peer takes nothing, nothing more is read.

    It reads into a buffer of its own: asyncio's has 256 kB for each read, which costs more than a whole call.
    """

    transport: asyncio.Transport

    def __init__(self, server: CallsServer) -> None:
        self._server = server
        self._machines: list[ServedMachine] = []
        self._others: list[ServedMachine] = []  # but the first
        self._client = CallClient(self._find, server.tell, server.trace, self._now_s, self._treat, self._push)
        self._attention: asyncio.TimerHandle | None = None
        self._later: asyncio.TimerHandle | None = None
        self._waiting = b""  # what is sent then
        self._is_full = False  # the peer takes nothing
        self._limit: asyncio.TimerHandle | None = None
        self._buffer = memoryview(bytearray(_READ))

    def _find(self, name: str, packing: int) -> Caller | None:
        found = self._server.find(name, packing)
        if found is None:
            return None
        caller, self._machines = found
        self._others = self._machines[1:]
        return caller

    def _now_s(self) -> float:
        return self._machines[0].device.clock.now_s if self._machines else 0.0

    def _treat(self) -> Treatment:
        if self._machines[0].is_usual and not self._others:
            return AS_USUAL
        found = [each.treat("calls") for each in self._machines]
        return Treatment(any(each.drop for each in found), max(each.delay_s for each in found))

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        # Not every event loop derives its own from that class.
        self.transport = transport = cast(asyncio.Transport, transport)
        notice_loss(transport)
        self._linger = Linger(transport, self._buffer)
        if not self._server.lines.join(self):
            self._server.tell(f"more than {_MOST_CLIENTS} clients")
            transport.abort()
            return
        self._limit = asyncio.get_running_loop().call_later(_HELLO_S, self.abort)

    @property
    def is_new(self) -> bool:
        """Whether it has not said which library it wants."""
        return not self._machines

    def get_buffer(self, sizehint: int) -> memoryview:
        return self._buffer

    def buffer_updated(self, nbytes: int) -> None:
        self.take(bytes(self._buffer[:nbytes]))
        if self._machines:
            for count in self._linger.received():
                self.take(bytes(self._buffer[:count]))

    def _push(self, sent: bytes) -> None:
        """Send an interrupt, unless the client takes none."""
        if self._later is not None:
            self._waiting += sent
        elif not (self._is_full or self.transport.is_closing()):
            self.transport.write(sent)

    def _attend(self) -> None:
        """Let time pass for a client that listens, until its connection ends."""
        for each in self._machines:
            each.keeper.submit(lambda: None, lambda _: None)
        self._attention = asyncio.get_running_loop().call_later(_ATTENTION_S, self._attend)

    def take(self, data: bytes) -> None:
        """Carry out what is whole with these bytes."""
        if not self._machines:  # a hello reaches no machine
            self._send(self._client.receive(data))
            return
        for each in self._others:
            each.keeper.submit(lambda: None, lambda _: None)  # lets its time pass
        if not self._machines[0].keeper.submit(partial(self._client.receive, data), self._send):
            self.abort()

    def _send(self, sent: bytes) -> None:
        if self._later is not None:  # answers keep their order
            self._waiting += sent
        elif self._client.delay_s and sent:  # the next call is not read before it is answered
            self.transport.pause_reading()
            self._waiting = sent
            self._later = asyncio.get_running_loop().call_later(self._client.delay_s, self._send_late)
        else:
            self._send_now(sent)

    def _send_late(self) -> None:
        self._later = None
        if not self._is_full:
            self.transport.resume_reading()
        self._send_now(self._waiting)

    def _send_now(self, sent: bytes) -> None:
        if sent:
            self.transport.write(sent)
        if self._machines and self._limit is not None:
            self._limit.cancel()
            self._limit = None
        if self._client.ended:
            self.transport.close()
        elif self._attention is None and self._client.caller is not None and self._client.caller.listens:
            self._attend()

    def pause_writing(self) -> None:
        self._is_full = True
        self.transport.pause_reading()

    def resume_writing(self) -> None:
        self._is_full = False
        if self._later is None:
            self.transport.resume_reading()

    def connection_lost(self, error: Exception | None) -> None:
        self._server.lines.leave(self)
        self._linger.close()
        if self._later is not None:
            self._later.cancel()
        for timer in (self._limit, self._attention):
            if timer is not None:
                timer.cancel()
        caller = self._client.caller
        if caller is not None:
            self._client.ended = True
            self._machines[0].keeper.submit(caller.session.detach, lambda _: None)

    def abort(self) -> None:
        """End the connection at once."""
        self.transport.abort()
