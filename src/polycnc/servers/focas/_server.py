"""The shell of the protocol: TCP connections of one control, each with a session of its own.

A host owns the control. What a client sends is taken between two control cycles, so what one frame asks is answered
from one cycle.
"""

from __future__ import annotations

import asyncio
import contextlib
import socket
from typing import Any

from polycnc.controllers.fanuc import PowerMate
from polycnc.errors import UsageError
from polycnc.machine import Host
from polycnc.servers.focas._control import FocasControl
from polycnc.servers.focas._profile import Profile
from polycnc.servers.focas._session import Ending, Session

PORT = 8193
LOOPBACK = "127.0.0.1"
_READ = 1 << 14


class FocasServer:
    """Serve the control of a running `host` on `address`:`port`; port 0 takes a free one, see `port`."""

    def __init__(
        self,
        host: Host[Any],
        control: PowerMate,
        profile: Profile,
        *,
        address: str = "127.0.0.1",
        port: int = PORT,
    ) -> None:
        self.port = port
        self.address = address
        self._host = host
        self._control = FocasControl(control, profile)
        self._server: asyncio.Server | None = None
        self._open: set[asyncio.Task[None]] = set()

    async def start(self) -> None:
        """Listen.

        Raises:
            UsageError: The address or port cannot be listened on.
        """
        try:
            self._server = await asyncio.start_server(self._serve, self.address, self.port)
        except OSError as error:
            raise UsageError(
                f"cannot listen on {self.address}:{self.port}: {error.strerror or error}",
                hint="Choose another port; another server may have this one.",
            ) from None
        self.port = self._server.sockets[0].getsockname()[1]

    async def serve_forever(self) -> None:
        """Serve until cancelled."""
        assert self._server is not None
        await self._server.serve_forever()

    async def close(self) -> None:
        """Stop listening and end every connection."""
        if self._server is not None:
            self._server.close()
        for task in tuple(self._open):
            task.cancel()
        await asyncio.gather(*self._open, return_exceptions=True)

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        task = asyncio.current_task()
        assert task is not None
        self._open.add(task)
        session = Session(self._control)
        line: socket.socket = writer.get_extra_info("socket")
        line.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        try:
            while session.ending is None and (data := await reader.read(_READ)):
                sent = await self._take(session, data)
                if sent:
                    writer.write(sent)
                    await writer.drain()
        except ConnectionError:
            pass
        finally:
            self._open.discard(task)
            if session.ending is Ending.RESET:
                writer.transport.abort()
            with contextlib.suppress(ConnectionError):
                writer.close()
            with contextlib.suppress(Exception):  # the host may have been closed before
                self._host.post(lambda _: session.lost())

    async def _take(self, session: Session, data: bytes) -> bytes:
        return await asyncio.wrap_future(self._host.post(lambda _: session.receive(data)))
