"""The door: the application on a port, in the event loop of the machines."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import socket
from collections.abc import Iterator, Sequence

import uvicorn

from polycnc.errors import UsageError
from polycnc.servers.http._app import make_app
from polycnc.servers.http._connection import Connection
from polycnc.servers.machines import ServedMachine, Wanted

PORT = 8080
_END_S = 0.5


_LOGGER = logging.getLogger("uvicorn.error")
_LOGGER.propagate = False  # what goes wrong is in the log of requests, no traceback on the screen
_LOGGER.addHandler(logging.NullHandler())


class _Server(uvicorn.Server):
    @contextlib.contextmanager
    def capture_signals(self) -> Iterator[None]:
        """Leave signals to the process."""
        yield


class HttpDoor:
    """Serve machines by HTTP on one port."""

    def __init__(self, machines: Sequence[ServedMachine], wanted: Wanted) -> None:
        self._address = wanted.address
        self._port = PORT if wanted.port is None else wanted.port
        app = make_app(machines, token=wanted.token, log=wanted.log, hosts=(wanted.address,))
        self._server = _Server(
            uvicorn.Config(
                app,
                log_config=None,
                access_log=False,
                lifespan="off",
                ws="websockets-sansio",
                ws_max_size=1 << 16,
                http=Connection,
                timeout_keep_alive=30,
                timeout_graceful_shutdown=None,
                server_header=False,
            )
        )
        self._socket: socket.socket | None = None
        self._task: asyncio.Task[None] | None = None

    @property
    def said(self) -> str:
        """The URL of the page."""
        host = f"[{self._address}]" if ":" in self._address else self._address
        return f"http://{host}:{self._port}"

    async def start(self) -> None:
        """Listen.

        Raises:
            UsageError: The address or port cannot be listened on.
        """
        family = socket.AF_INET6 if ":" in self._address else socket.AF_INET
        listening = socket.socket(family, socket.SOCK_STREAM)
        listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            listening.bind((self._address, self._port))
            listening.listen(128)
        except OSError as error:
            listening.close()
            raise UsageError(
                f"http: cannot listen on {self._address}:{self._port}: {error.strerror or error}",
                hint="Choose another port (--doors http=0 takes a free one); another server may have this one.",
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
