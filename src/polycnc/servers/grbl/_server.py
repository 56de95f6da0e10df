"""The shell of the sender door: a TCP port and a pseudo terminal, in an event loop."""

from __future__ import annotations

import asyncio
import math
import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from polycnc.errors import UsageError
from polycnc.servers.machines import AS_USUAL, Owner, Treatment, notice_loss, peers_of

if TYPE_CHECKING:
    from polycnc.servers.grbl._core import GrblCore
    from polycnc.servers.grbl._watching import GrblWatch

PORT = 8123
_TURN_S = 0.01  # between two looks at what goes on, which is less than a sender's buffer lasts
_PIECE_BYTES = 4096
_MOST_UNREAD = 1 << 20  # bytes that a client may leave unread
_ENDS = (b"\n", b"?")
_REQUESTS = re.compile(rb"[^\n?]*[\n?]|[^\n?]+")
"""Pieces that end with a line or a question."""
_SILENT_S = 5.0
"""How long a sender may send nothing at all before another one takes its place; senders ask for a status."""
_OTHER = b"[MSG:Another sender is connected]\r\n"


class GrblServer:
    """Let a sender reach `core`: one at a time on a TCP port (0: a free one), besides one on a pseudo terminal.

    `terminal` is a path that leads to the terminal, "" for none. `owner` carries out what the core does. `treat` counts
    a line or a `?` of the port, and says how it is to be treated, unless all `is_usual`.
    """

    def __init__(
        self,
        owner: Owner,
        core: GrblCore | GrblWatch,
        *,
        address: str = "127.0.0.1",
        port: int = PORT,
        terminal: str = "",
        treat: Callable[[], Treatment] = lambda: AS_USUAL,
        is_usual: Callable[[], bool] = lambda: True,
    ) -> None:
        self._treat, self._is_usual = treat, is_usual
        self._owner = owner
        self._core = core
        self.address = address
        self.port = port
        self._path = terminal
        self._server: asyncio.Server | None = None
        self._client: asyncio.StreamWriter | None = None
        self._silent_since_s = math.inf  # of the client, which has sent something then
        self._terminal: _Terminal | None = None
        self._from_terminal = False
        self._turns: asyncio.Task[None] | None = None

    @property
    def said(self) -> str:
        """Where it is."""
        return f"{self.address}:{self.port}" + (f" and {self._path}" if self._path else "")

    @property
    def clients(self) -> list[str]:
        """The address of the sender that is connected now, or the terminal that it writes to."""
        if self._client is not None:
            return peers_of([self._client.transport])
        return [self._path] if self._path and self._from_terminal else []

    async def start(self) -> None:
        """Listen.

        Raises:
            UsageError: The port is taken, or there is something at the terminal's path; nothing is open.
        """
        if self._path:
            self._terminal = _Terminal(self._path, self._of_terminal)
        try:
            self._server = await asyncio.start_server(self._serve, self.address, self.port)
        except OSError as error:
            self._close_terminal()
            raise UsageError(
                f"cannot listen on {self.address}:{self.port}: {error.strerror or error}",
                hint="Take another port, or 0 for a free one.",
            ) from None
        self.port = self._server.sockets[0].getsockname()[1]
        if self._terminal is not None:
            self._from_terminal = True
            self._owner.submit(self._core.greet, self._answer)
        self._turns = asyncio.get_running_loop().create_task(self._let_go_on())

    async def close(self) -> None:
        """Stop listening and end every connection."""
        if self._turns is not None:
            self._turns.cancel()
        self._close_terminal()
        if self._server is not None:
            self._server.close()
        if self._client is not None:
            self._client.close()
        if self._server is not None:
            await self._server.wait_closed()

    def _close_terminal(self) -> None:
        if self._terminal is not None:
            self._terminal.close()
            self._terminal = None

    # ------------------------------------------------------------------ senders

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        if self._client is not None:
            if asyncio.get_running_loop().time() - self._silent_since_s < _SILENT_S:
                writer.write(_OTHER)
                writer.close()
                return
            self._client.transport.abort()
        self._client, self._from_terminal = writer, False
        self._silent_since_s = asyncio.get_running_loop().time()
        notice_loss(writer.transport)
        self._owner.submit(self._core.greet, self._answer)
        try:
            while data := await reader.read(_PIECE_BYTES):
                if self._client is not writer:
                    return  # another one has taken its place
                self._silent_since_s = math.inf
                for piece in [data] if self._is_usual() else _REQUESTS.findall(data):
                    if piece[-1:] in _ENDS:
                        treatment = self._treat()
                        if treatment.drop:
                            writer.transport.abort()
                            return
                        if treatment.delay_s:
                            await asyncio.sleep(treatment.delay_s)
                    self._receive(piece)
                await asyncio.sleep(0)
        except (OSError, asyncio.CancelledError):
            pass  # it has gone, or the door closes
        finally:
            if self._client is writer:
                self._client = None
            writer.close()

    def _of_terminal(self, data: bytes) -> None:
        if self._client is not None:
            if self._terminal is not None:
                self._terminal.write(_OTHER)
            return
        self._from_terminal = True
        self._receive(data)

    def _receive(self, data: bytes) -> None:
        self._owner.submit(lambda: self._core.receive(data), self._answer)

    def _answer(self, data: bytes) -> None:
        """Give the present sender what the core says."""
        if not data:
            return
        if self._from_terminal:
            if self._terminal is not None:
                self._terminal.write(data)
        elif self._client is not None:
            if self._client.transport.get_write_buffer_size() > _MOST_UNREAD:
                self._client.transport.abort()
                return
            self._client.write(data)

    async def _let_go_on(self) -> None:
        while True:
            await asyncio.sleep(_TURN_S)
            if self._client is not None or self._core.busy:
                self._owner.submit(self._core.turn, self._answer)


class _Terminal:
    """A pseudo terminal that a sender opens like a serial port; `receive` gets what it writes."""

    def __init__(self, path: str, receive: Callable[[bytes], None]) -> None:
        try:
            import pty
            import tty
        except ImportError:
            raise UsageError(
                "this system has no pseudo terminals", hint="Let the sender connect to the TCP port."
            ) from None
        self._path = Path(path)
        if self._path.is_symlink() and not self._path.exists():
            self._path.unlink()  # of a process that is gone
        self._master, self._slave = pty.openpty()
        tty.setraw(self._slave)
        os.set_blocking(self._master, False)
        try:
            self._path.symlink_to(os.ttyname(self._slave))
        except OSError as error:
            os.close(self._master)
            os.close(self._slave)
            raise UsageError(
                f"cannot make the terminal {path}: {error.strerror}", hint="Name a path that is free."
            ) from None
        self._receive = receive
        asyncio.get_running_loop().add_reader(self._master, self._read)

    def write(self, data: bytes) -> None:
        """Send to whoever has the terminal open; what nobody reads is lost once its buffer is full."""
        try:
            os.write(self._master, data)
        except OSError:
            return

    def close(self) -> None:
        """Take the terminal away."""
        asyncio.get_running_loop().remove_reader(self._master)
        self._path.unlink(missing_ok=True)
        os.close(self._slave)
        os.close(self._master)

    def _read(self) -> None:
        try:
            data = os.read(self._master, _PIECE_BYTES)
        except OSError:
            return
        self._receive(data)
