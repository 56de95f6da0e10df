"""One connection of HTTP: bounded in number, in the time that a question may take to come, and in how it is refused."""

from __future__ import annotations

import asyncio
from typing import Any

import h11
from starlette.types import Receive, Scope, Send
from uvicorn.protocols.http.h11_impl import H11Protocol

from polycnc.servers.http._problem import problem
from polycnc.servers.machines import notice_loss

MOST_CONNECTIONS = 500
MOST_WAIT_S = 60.0
"""How long a question may take to come, and a connection may stand without one."""
_LOOK_S = 5.0


class Connection(H11Protocol):
    """A connection that does not wait for ever for what a client does not send."""

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Begin; beyond so many connections only a refusal is answered."""
        super().connection_made(transport)
        notice_loss(transport)
        self._since_s = self.loop.time()
        if len(self.connections) > MOST_CONNECTIONS:
            self.app = _crowded
        self._looking = self.loop.call_later(_LOOK_S, self._look)

    def connection_lost(self, exc: Exception | None) -> None:
        """Forget it."""
        self._looking.cancel()
        super().connection_lost(exc)

    def send_400_response(self, msg: str) -> None:
        """Refuse what is no HTTP."""
        said = problem(400, "this is no request of HTTP", "Ask by HTTP/1.1.")
        headers = [*said.raw_headers, (b"connection", b"close")]
        try:
            self.transport.write(self.conn.send(h11.Response(status_code=400, headers=headers)) or b"")
            self.transport.write(self.conn.send(h11.Data(data=bytes(said.body))) or b"")
            self.transport.write(self.conn.send(h11.EndOfMessage()) or b"")
        except h11.LocalProtocolError:  # an answer has begun: nothing can be said any more
            pass
        self.transport.close()

    def _look(self) -> None:
        now_s, cycle = self.loop.time(), self.cycle
        if self.transport.is_closing() or self.transport.get_protocol() is not self:
            return  # it is over, or a stream
        if cycle is not None and not cycle.response_complete and not cycle.more_body:
            self._since_s = now_s  # it is being answered
        elif now_s - self._since_s >= MOST_WAIT_S:
            self.transport.abort()
            return
        self._looking = self.loop.call_later(_LOOK_S, self._look)

    def on_response_complete(self) -> None:
        """Wait for the next question."""
        self._since_s = self.loop.time()
        super().on_response_complete()


async def _crowded(scope: Scope, receive: Receive, send: Send) -> None:
    answer: Any = problem(503, "too many connections", "Close some, or ask later.")
    answer.headers["connection"] = "close"
    await answer(scope, receive, send)
