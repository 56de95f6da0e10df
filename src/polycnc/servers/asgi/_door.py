"""The door: an application on a port, in the event loop of the machines."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import socket
from collections.abc import Iterator

import uvicorn
from starlette.types import ASGIApp

from polycnc.errors import UsageError
from polycnc.servers.asgi._connection import Refuse, Treat, connections_of, treated_as_usual
from polycnc.servers.machines import peers_of

_END_S = 0.5


_LOGGER = logging.getLogger("uvicorn.error")
_LOGGER.propagate = False  # what goes wrong is in the log of requests, no traceback on the screen
_LOGGER.addHandler(logging.NullHandler())


class _Server(uvicorn.Server):
    @contextlib.contextmanager
    def capture_signals(self) -> Iterator[None]:
        """Leave signals to the process."""
        yield


class AsgiDoor:
    """Serve an application on one port; `name` is the door's, `refuse` its form of what a connection refuses.

    `treat` says with every request what happens to it.
    """

    def __init__(
        self,
        name: str,
        app: ASGIApp,
        address: str,
        port: int,
        refuse: Refuse,
        treat: Treat = treated_as_usual,
    ) -> None:
        self._name = name
        self._address = address
        self._port = port
        self._server = _Server(
            uvicorn.Config(
                app,
                log_config=None,
                access_log=False,
                lifespan="off",
                ws="websockets-sansio",
                ws_max_size=1 << 16,
                http=connections_of(refuse, treat),
                timeout_keep_alive=30,
                timeout_graceful_shutdown=None,
                server_header=False,
            )
        )
        self._socket: socket.socket | None = None
        self._task: asyncio.Task[None] | None = None

    @property
    def said(self) -> str:
        """Its URL."""
        host = f"[{self._address}]" if ":" in self._address else self._address
        return f"http://{host}:{self._port}"

    @property
    def clients(self) -> list[str]:
        """The addresses of the clients that are connected now."""
        return peers_of(each.transport for each in self._server.server_state.connections)

    async def start(self) -> None:
        """Listen.

        Raises:
            UsageError: The address or port cannot be listened on.
        """
        family = socket.AF_INET6 if ":" in self._address else socket.AF_INET
        # with the protocol named, asyncio sends each piece at once: a head does not wait for the body's acknowledgement
        listening = socket.socket(family, socket.SOCK_STREAM, socket.IPPROTO_TCP)
        listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            listening.bind((self._address, self._port))
            listening.listen(128)
        except OSError as error:
            listening.close()
            raise UsageError(
                f"{self._name}: cannot listen on {self._address}:{self._port}: {error.strerror or error}",
                hint=f"Choose another port (--doors {self._name}=0 takes a free one); this one may be taken.",
            ) from None
        listening.setblocking(False)
        self._socket = listening
        self._port = listening.getsockname()[1]
        self._task = asyncio.ensure_future(self._server.serve(sockets=[listening]))

    async def close(self) -> None:
        """Stop listening and end every connection."""
        self._server.should_exit = self._server.force_exit = True
        if self._task is not None:
            _, left = await asyncio.wait([self._task], timeout=_END_S)
            if left:
                self._task.cancel()
                await asyncio.wait([self._task], timeout=_END_S)
        if self._socket is not None:
            self._socket.close()
