"""The shell of the protocol: TCP connections of one control, each with a session of its own.

What a client sends is taken between two control cycles, so what one frame asks is answered from one cycle.
"""

from __future__ import annotations

import asyncio
import contextlib
import socket
import struct
from typing import Any, cast

from polycnc.controllers.fanuc import PowerMate
from polycnc.errors import UsageError
from polycnc.machine import Host
from polycnc.servers.calls import MAGIC, CallsServer
from polycnc.servers.focas._control import FocasControl
from polycnc.servers.focas._faults import FaultKind, Faults, PresentFaults
from polycnc.servers.focas._profile import Profile
from polycnc.servers.focas._session import Ending, Session, State
from polycnc.servers.machines import (
    Crowd,
    HostOwner,
    Keeper,
    Owner,
    Patience,
    ServedMachine,
    notice_loss,
    peers_of,
)

PORT = 8193
LOOPBACK = "127.0.0.1"
_LISTEN_BEAT_S = 0.05
MOST_LINES = 1000
LEAST_PATIENCE_S = 30.0
"""How long a connection may stand before it is opened, and a program may stop coming: others wait for it."""
_HALF = frozenset({State.NEW, State.DOWNLOADING})


class FocasServer:
    """Serve a control on `address`:`port`; port 0 takes a free one, see `port`.

    `owner` lets its time pass: a running host, or a `Keeper`. `faults` are those of the script that it follows.
    Programs that come through the C library, told by their first bytes, are answered by `calls`.
    """

    def __init__(
        self,
        owner: Owner | Host[Any],
        control: PowerMate,
        profile: Profile,
        *,
        address: str = LOOPBACK,
        port: int = PORT,
        faults: Faults | None = None,
    ) -> None:
        self.port = port
        self.address = address
        self.owner: Owner = HostOwner(owner) if isinstance(owner, Host) else owner
        keep = isinstance(owner, Keeper) and owner.pace.rate >= 1.0
        self.control = FocasControl(control, profile, faults, keep=keep)
        self.calls: CallsServer | None = None
        self._server: asyncio.Server | None = None
        self.lines = Crowd[_Line](MOST_LINES, lambda each: each.is_new, lambda each: each.abort())
        self._watch: asyncio.TimerHandle | None = None
        self._task: asyncio.Task[None] | None = None  # keeps it from being collected

    @classmethod
    def of(cls, machine: ServedMachine, profile: Profile, *, address: str, port: int) -> FocasServer:
        """Return the door of a served Power Mate; faults of its scenario act on the connections too."""
        control = machine.device
        assert isinstance(control, PowerMate)
        faults = PresentFaults(lambda: machine.served.scenario)
        made = cls(machine.keeper, control, profile, address=address, port=port, faults=faults)
        machine.served.on_scenario(made.look_again)
        made.calls = CallsServer([machine])
        return made

    @property
    def said(self) -> str:
        """Where it listens."""
        return f"{self.address}:{self.port}"

    @property
    def clients(self) -> list[str]:
        """The addresses of the clients that are connected now."""
        found = peers_of(each.transport for each in self.lines)
        return sorted([*found, *(self.calls.clients if self.calls is not None else [])])

    async def start(self) -> None:
        """Listen.

        Raises:
            UsageError: The address or port cannot be listened on.
        """
        try:
            await self._listen()
        except OSError as error:
            raise UsageError(
                f"cannot listen on {self.address}:{self.port}: {error.strerror or error}",
                hint="Choose another port or address; another server may have this one.",
            ) from None
        assert self._server is not None
        self.port = self._server.sockets[0].getsockname()[1]
        self.look_again()

    def look_again(self) -> None:
        """Follow the script that holds now, where it says that nothing listens."""
        if (
            self._watch is None
            and self._server is not None
            and self.control.faults.knows(FaultKind.UNREACHABLE)
        ):
            self._follow()

    async def _listen(self) -> None:
        loop = asyncio.get_running_loop()
        self._server = await loop.create_server(
            lambda: _Line(self), self.address, self.port, reuse_address=True
        )

    def _follow(self) -> None:
        """Listen, or do not, as the script says now."""
        loop = asyncio.get_running_loop()
        away = self.control.faults.has(FaultKind.UNREACHABLE)
        if away and self._server is not None:
            self._server.close()
            self._server = None
        elif not away and self._server is None:
            self._task = loop.create_task(self._come_back())
            return
        followed = away or self.control.faults.knows(FaultKind.UNREACHABLE)
        self._watch = loop.call_later(_LISTEN_BEAT_S, self._follow) if followed else None

    async def _come_back(self) -> None:
        with contextlib.suppress(OSError):  # somebody else has the port: tried again
            await self._listen()
        self._follow()

    async def serve_forever(self) -> None:
        """Serve until cancelled."""
        await asyncio.get_running_loop().create_future()

    async def close(self) -> None:
        """Stop listening and end every connection."""
        if self._watch is not None:
            self._watch.cancel()
        if self._server is not None:
            self._server.close()
        for line in self.lines:
            line.abort()
        if self.calls is not None:
            await self.calls.close()
        await asyncio.sleep(0)  # lets the connections tell that they are lost


class _Line(asyncio.Protocol):
    """One connection: bytes in and out of a session.

    Nothing more is read while a reply waits for its time, for the peer to take bytes, or for the next turn, so a client
    that only sends fills nobody's memory and keeps nobody else waiting.
    """

    transport: asyncio.Transport

    def __init__(self, server: FocasServer) -> None:
        self._server = server
        self._session = Session(server.control)
        self._full = self._waiting = self._gone = False
        self._patience = Patience(self.abort)
        self._new = True

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        # Not every event loop derives its own from that class.
        self.transport = transport = cast(asyncio.Transport, transport)
        notice_loss(transport)
        if self._server.lines.join(self):
            self._patience.begin(LEAST_PATIENCE_S)
        else:
            transport.abort()

    @property
    def is_new(self) -> bool:
        """Whether it has not been opened yet."""
        return self._session.state is State.NEW

    def data_received(self, data: bytes) -> None:
        session, calls = self._session, self._server.calls
        if self._new and calls is not None and data[:1] == MAGIC[:1]:
            self._end()
            calls.adopt(self.transport, data)
            return
        self._new = False
        if session.ending is None:
            self._server.owner.submit(lambda: session.receive(data), self._answer)

    def _answer(self, sent: bytes) -> None:
        session = self._session
        if self._gone:
            return
        if session.delay_s:
            delay_s, session.delay_s = session.delay_s, 0.0
            self._hold(True)
            asyncio.get_running_loop().call_later(delay_s, self._send, sent)
        else:
            self._send(sent)

    def _send(self, sent: bytes) -> None:
        session = self._session
        if self._gone:
            return
        if session.state in _HALF:
            self._patience.begin(LEAST_PATIENCE_S)
        else:
            self._patience.end()
        if sent:
            self.transport.write(sent)
        if session.ending is Ending.RESET:
            self._reset()
        elif session.ending is Ending.CLOSE:
            self.transport.close()
        elif session.more:
            self._hold(True)
            asyncio.get_running_loop().call_later(session.pause_s, self._go_on)
        else:
            self._hold(False)

    def _go_on(self) -> None:
        session = self._session
        if not self._gone and not self._full:
            self._server.owner.submit(lambda: session.receive(b""), self._answer)

    def _reset(self) -> None:
        """End with a reset, as controls do, not with the end of the stream; what was written goes out before."""
        line: socket.socket = self.transport.get_extra_info("socket")
        line.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        self.transport.close()

    def _hold(self, waiting: bool) -> None:
        if waiting != self._waiting:
            self._waiting = waiting
            self._read()

    def _read(self) -> None:
        if self.transport.is_closing():
            return
        if self._waiting or self._full:
            self.transport.pause_reading()
        else:
            self.transport.resume_reading()

    def pause_writing(self) -> None:
        self._full = True
        self._read()

    def resume_writing(self) -> None:
        self._full = False
        self._read()
        if self._session.more:
            self._go_on()

    def connection_lost(self, error: Exception | None) -> None:
        self._end()

    def _end(self) -> None:
        """End the session."""
        self._gone = True
        self._patience.end()
        self._server.lines.leave(self)
        self._server.owner.submit(self._session.lost, lambda _: None)

    def abort(self) -> None:
        """End the connection at once."""
        self.transport.abort()
