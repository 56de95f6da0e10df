"""One connection of HTTP: bounded in number, in how long a question takes to come, and an answer to be read."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import NamedTuple, TypeAlias

import h11
from starlette.types import Receive, Scope, Send
from uvicorn.protocols.http.h11_impl import H11Protocol

from polycnc.servers.asgi._repeated import Repeated, repeated_of
from polycnc.servers.machines import Treatment, notice_loss

MOST_CONNECTIONS = 500
MOST_WAIT_S = 60.0
"""How long a question may take to come, a connection may stand without one, and an answer without being read."""
_LOOK_S = 5.0
_MOST_KEPT_BYTES = 2048  # of a question


class Refused(NamedTuple):
    """A refusal in the form of a door."""

    status: int
    headers: list[tuple[bytes, bytes]]
    body: bytes


Refuse: TypeAlias = Callable[[int, str, str], Refused]
"""Return the refusal for an HTTP status, what is wrong, and what to do."""

Treat: TypeAlias = Callable[[str], Treatment]
"""Count a request for a path, and say how it is to be treated."""


def treated_as_usual(_: str) -> Treatment:
    """Treat every request as usual."""
    return Treatment()


def refused_in_text(status: int, what: str, hint: str) -> Refused:
    """Return the refusal of a door that has no form of its own: a line of text."""
    return Refused(status, [(b"content-type", b"text/plain; charset=utf-8")], f"{what}. {hint}\n".encode())


class Connection(H11Protocol):
    """A connection that does not wait for ever for what a client does not send, or does not read."""

    refuse: Refuse
    treat: Treat

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Begin; beyond so many connections the oldest that has never asked makes room, else a refusal is answered."""
        super().connection_made(transport)
        notice_loss(transport)
        self._since_s = self.loop.time()
        self._unread = 0
        self._has_asked = False
        self._question = b""  # that came in one piece, and is being answered
        self._repeated: Repeated | None = None
        if len(self.connections) > MOST_CONNECTIONS and not self._make_room():
            self.app = self._crowded
        else:
            self._usual, self.app = self.app, self._treated
        self._looking = self.loop.call_later(_LOOK_S, self._look)

    def _make_room(self) -> bool:
        """End the oldest connection whose first question has not come; tell whether there is one."""
        others = [each for each in self.connections if isinstance(each, Connection) and each.is_silent]
        oldest = min(others, key=lambda each: each._since_s, default=self)
        if oldest is self:
            return False
        self.connections.discard(oldest)
        oldest.transport.abort()
        return True

    @property
    def is_silent(self) -> bool:
        """Whether its first question has not come, or not whole."""
        return not self._has_asked and (self.cycle is None or self.cycle.more_body)

    def data_received(self, data: bytes) -> None:
        """Answer a question that comes again, byte for byte, without reading it again; read every other one."""
        begins = self._stands()
        if begins and self._repeated is not None and data == self._repeated.question:
            answer = self._repeated.answer(self.server_state.default_headers)
            if answer is not None:
                self.transport.write(answer)
                self.on_response_complete()
                return
        self._question = data if begins and len(data) <= _MOST_KEPT_BYTES else b""
        super().data_received(data)

    def _stands(self) -> bool:
        """Tell whether all questions have been answered, whole, and the client has read the answers."""
        conn = self.conn
        return (
            conn.our_state is h11.IDLE
            and conn.their_state is h11.IDLE
            and not conn.trailing_data[0]
            and not self.transport.is_closing()
            and not self.transport.get_write_buffer_size()
        )

    def connection_lost(self, exc: Exception | None) -> None:
        """Forget it."""
        self._looking.cancel()
        super().connection_lost(exc)

    def send_400_response(self, msg: str) -> None:
        """Refuse what is no HTTP."""
        said = self.refuse(400, "this is no request of HTTP", "Ask by HTTP/1.1.")
        headers = [*said.headers, (b"connection", b"close")]
        try:
            self.transport.write(
                self.conn.send(h11.Response(status_code=said.status, headers=headers)) or b""
            )
            self.transport.write(self.conn.send(h11.Data(data=said.body)) or b"")
            self.transport.write(self.conn.send(h11.EndOfMessage()) or b"")
        except h11.LocalProtocolError:  # an answer has begun: nothing can be said any more
            pass
        self.transport.close()

    def _look(self) -> None:
        now_s = self.loop.time()
        if self.transport.is_closing() or self.transport.get_protocol() is not self:
            return  # it is over, or a stream
        if self._is_answered():
            self._since_s = now_s
        elif now_s - self._since_s >= MOST_WAIT_S:
            self.transport.abort()
            return
        self._looking = self.loop.call_later(_LOOK_S, self._look)

    def _is_answered(self) -> bool:
        """Tell whether a question is being answered, and the client reads what there is of the answer."""
        before, self._unread = self._unread, self.transport.get_write_buffer_size()
        if self._unread and self._unread == before:
            return False
        cycle = self.cycle
        return cycle is not None and not cycle.response_complete and not cycle.more_body

    def on_response_complete(self) -> None:
        """Wait for the next question."""
        self._since_s = self.loop.time()
        self._has_asked = True
        super().on_response_complete()

    def handle_websocket_upgrade(self, event: h11.Request) -> None:
        """Begin a stream, unless a scenario drops it."""
        if self.treat(event.target.decode("ascii", "replace").partition("?")[0]).drop:
            self.transport.abort()
            return
        super().handle_websocket_upgrade(event)

    async def _treated(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer, unless a scenario wants something else."""
        treatment = self.treat(scope["path"])
        if treatment.drop:
            self.transport.abort()
            while (await receive())["type"] != "http.disconnect":
                pass
            return
        if treatment.delay_s:
            await asyncio.sleep(treatment.delay_s)
        question = self._question
        await self._usual(scope, receive, send)
        self._repeated = repeated_of(question, scope)

    async def _crowded(self, scope: Scope, receive: Receive, send: Send) -> None:
        said = self.refuse(503, "too many connections", "Close some, or ask later.")
        headers = [*said.headers, (b"connection", b"close")]
        await send({"type": "http.response.start", "status": said.status, "headers": headers})
        await send({"type": "http.response.body", "body": said.body})


def connections_of(refuse: Refuse, treat: Treat) -> type[Connection]:
    """Return the connections of a door that refuses in its own form, and treats requests as a scenario says."""
    return type("Connection", (Connection,), {"refuse": staticmethod(refuse), "treat": staticmethod(treat)})
