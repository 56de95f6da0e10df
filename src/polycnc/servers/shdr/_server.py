"""The shell of the adapter: a TCP port on which agents read what changes."""

from __future__ import annotations

import asyncio

from polycnc.errors import UsageError
from polycnc.servers.machines import LOOPBACK, Crowd, ServedMachine, notice_loss, peers_of, treatment_of
from polycnc.servers.mtconnect import VERSIONS, model_of
from polycnc.servers.plant import see
from polycnc.servers.shdr._lines import Adapter, Session

PORT = 7878
_MOST_AGENTS = 32
_MOST_UNREAD = 1 << 22
_PIECE_BYTES = 1 << 14
_TURN_S = 0.1  # of the wall clock: so late an agent sees what was commanded while time stands still


class ShdrServer:
    """Serve one machine to agents; `version` decides which data items there are."""

    def __init__(
        self, machine: ServedMachine, version: str, *, address: str = LOOPBACK, port: int = PORT
    ) -> None:
        control = machine.control
        assert control is not None
        assert machine.find_control is not None
        self._machine = machine
        self._adapter = Adapter(model_of(machine.name, control, VERSIONS[version]), VERSIONS[version])
        self._see = see(machine.find_control)
        self._address, self._port = address, port
        self._server: asyncio.Server | None = None
        self._connected = Crowd[asyncio.StreamWriter](
            _MOST_AGENTS, lambda writer: writer not in self._spoken, lambda writer: writer.transport.abort()
        )
        self._spoken: set[asyncio.StreamWriter] = set()  # those that have sent a line
        self._agents: dict[asyncio.StreamWriter, None] = {}  # those that get what changes
        self._turns: asyncio.Task[None] | None = None

    @property
    def said(self) -> str:
        """Where it is."""
        return f"{self._address}:{self._port}"

    @property
    def clients(self) -> list[str]:
        """The addresses of the clients that are connected now."""
        return peers_of(writer.transport for writer in self._connected)

    async def start(self) -> None:
        """Listen.

        Raises:
            UsageError: The port is taken.
        """
        try:
            self._server = await asyncio.start_server(self._serve, self._address, self._port)
        except OSError as error:
            raise UsageError(
                f"shdr: cannot listen on {self._address}:{self._port}: {error.strerror or error}",
                hint="Take another port (--doors shdr=0 takes a free one).",
            ) from None
        self._port = self._server.sockets[0].getsockname()[1]
        self._adapter.look(self._see())
        self._machine.served.watch(self._look, lambda: bool(self._agents))
        self._turns = asyncio.get_running_loop().create_task(self._turn())

    async def close(self) -> None:
        """Stop listening and end every connection."""
        if self._turns is not None:
            self._turns.cancel()
        if self._server is not None:
            self._server.close()
        for writer in self._connected:
            writer.close()
        if self._server is not None:
            await self._server.wait_closed()

    async def _turn(self) -> None:
        while True:
            await asyncio.sleep(_TURN_S)
            if self._agents:
                self._machine.keeper.submit(self._look, lambda _: None)

    def _look(self) -> None:
        """Send all agents what has changed; one that does not read is disconnected."""
        lines = self._adapter.look(self._see())
        for writer in tuple(self._agents) if lines else ():
            self._send(writer, lines)

    @staticmethod
    def _send(writer: asyncio.StreamWriter, data: bytes) -> None:
        if writer.transport.get_write_buffer_size() > _MOST_UNREAD:
            writer.transport.abort()
        elif data:
            writer.write(data)

    def _begin(self, writer: asyncio.StreamWriter) -> None:
        """Send a new agent everything, at the present cycle."""
        self._look()
        self._send(writer, self._adapter.everything())
        self._agents[writer] = None

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        if not self._connected.join(writer):
            writer.close()
            return
        notice_loss(writer.transport)
        session = Session()
        try:
            if not await self._treated(writer):
                return
            self._machine.keeper.submit(lambda: self._begin(writer), lambda _: None)
            while data := await reader.read(_PIECE_BYTES):
                if b"\n" in data:
                    self._spoken.add(writer)
                for _ in range(data.count(b"\n")):
                    if not await self._treated(writer):
                        return
                self._machine.keeper.submit(self._look, lambda _: None)
                self._send(writer, session.receive(data))
        except (OSError, asyncio.CancelledError):
            pass  # it has gone, or the door closes
        finally:
            self._connected.leave(writer)
            self._spoken.discard(writer)
            self._agents.pop(writer, None)
            writer.close()

    async def _treated(self, writer: asyncio.StreamWriter) -> bool:
        """Count a connection or a command, and do what a scenario wants with it; tell whether it is answered."""
        treatment = treatment_of([self._machine], "shdr")
        if treatment.drop:
            writer.transport.abort()
        elif treatment.delay_s:
            await asyncio.sleep(treatment.delay_s)
        return not treatment.drop
