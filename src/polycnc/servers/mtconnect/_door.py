"""The door: the agent on its port; streams wait for slow readers and end where those fall behind."""

from __future__ import annotations

import asyncio
import contextlib
import time
from collections.abc import Sequence
from functools import partial

from starlette.types import ASGIApp, Receive, Scope, Send

from polycnc.errors import PolycncError
from polycnc.servers.asgi import AsgiDoor, Refused, Said, answers_again
from polycnc.servers.machines import (
    LOOPBACK,
    ServedMachine,
    Treatment,
    Wanted,
    machines_of_path,
    treatment_of,
)
from polycnc.servers.mtconnect._agent import Agent, Answer, StreamAsked
from polycnc.servers.mtconnect._device import model_of
from polycnc.servers.mtconnect._errors import AgentError, Code
from polycnc.servers.mtconnect._json import as_json
from polycnc.servers.mtconnect._query import Asked, asked_of
from polycnc.servers.mtconnect._rows import USUAL_VERSION, VERSIONS, Version
from polycnc.servers.plant import Seen, see

PORT = 5000
_XML, _JSON = b"text/xml; charset=utf-8", b"application/json"
_BOUNDARY = b"polycnc-a1f04c9b7d3e"
_WANTED_S = 60.0  # of the machine's time, after which nobody seems to want to see what happens
_YOUNG_S = 10.0  # in which a machine waits for the first who wants to
_BACK = frozenset({"sample"})
"""Requests for what was observed before they came; what is asked now is looked at now."""
_LEAST_BEAT_S = 0.01  # between two pieces of a stream, whatever interval is asked for
_MOST_STREAMS = 100
_MOST_WAIT_S = 30.0  # for a client that does not read
_METHODS = ("GET", "HEAD")
_OK = 200
_MOST_BODY_BYTES = 1 << 16


class Observed:
    """Machines with the agent that observes them: by itself as their time passes, and before every answer."""

    def __init__(self, machines: Sequence[ServedMachine], version: Version, instance: int) -> None:
        self._machines = machines
        devices, self._looks = [], list[_Look]()
        for machine in machines:
            control = machine.control
            assert control is not None
            devices.append(model_of(machine.name, control, version))
        self.agent = Agent(devices, version, instance)
        for number, machine in enumerate(machines):
            look = _Look(self.agent, number, machine)
            look()
            machine.served.watch(look, look.is_wanted)
            self._looks.append(look)

    def look(self, asked: Asked) -> None:
        """Let the machines that a request is about live up to now, and look at them.

        Raises:
            AgentError: There is no such device, or its time cannot pass any more.
        """
        goes_back = asked.request in _BACK
        for number in self.agent.numbers(asked):
            look = self._looks[number]
            try:
                self._machines[number].ask_at_once(look.for_history if goes_back else look)
            except AgentError:
                raise
            except PolycncError as error:
                raise AgentError(Code.INTERNAL_ERROR, error.what, hint=error.hint) from None

    def are_usual(self, asked: Asked) -> bool:
        """Tell whether no scenario has anything to do with a request."""
        return all(self._machines[number].is_usual for number in self.agent.numbers(asked))


class _Look:
    """Look at one machine."""

    def __init__(self, agent: Agent, number: int, machine: ServedMachine) -> None:
        self._agent = agent
        self._number = number
        assert machine.find_control is not None
        self._see = see(machine.find_control)
        self._clock = machine.served.clock
        self._most_cycles = self._clock.cycles_for(_WANTED_S)
        self._asked = self._clock.cycles - self._most_cycles + self._clock.cycles_for(_YOUNG_S)

    def is_wanted(self) -> bool:
        """Tell whether a client asked for what had been in the last minute of the machine's time, or it is young."""
        return abs(self._clock.cycles - self._asked) < self._most_cycles

    def for_history(self) -> None:
        """Look, as a client asks who wants to see what happens until it asks again."""
        self._asked = self._clock.cycles
        self()

    def __call__(self) -> None:
        seen: Seen = self._see()
        self._agent.observe(self._number, seen)


class App:
    """The application: GET and HEAD, documents and streams; `hosts` are those that it is asked as, None for any."""

    def __init__(self, observed: Observed, hosts: frozenset[str] | None) -> None:
        self._observed = observed
        self._hosts = hosts
        self._streams = 0

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request."""
        if scope["type"] != "http":
            if scope["type"] == "websocket":
                await receive()
                await send({"type": "websocket.close", "code": 1008})
            return
        raw = scope.get("raw_path") or scope["path"].encode()
        path = raw.decode("ascii", "replace").partition("?")[0]
        try:
            self._check(scope)
            asked = asked_of(path, scope["query_string"])
            self._observed.look(asked)
            answer = self._observed.agent.answer(asked)
            if isinstance(answer, StreamAsked) and self._streams >= _MOST_STREAMS:
                raise AgentError(Code.TOO_MANY, f"{_MOST_STREAMS} streams are open", hint="End one.")
        except AgentError as error:
            answer = self._observed.agent.refusal(error, path)
        kind = _kind_of(scope)
        if isinstance(answer, Answer):
            if answer.status == _OK:
                answers_again(scope, lambda: self._again(asked, kind))
            await _send_document(send, answer, kind, closes=_body_bytes(scope) > _MOST_BODY_BYTES)
            return
        self._streams += 1
        try:
            await self._stream(asked, answer, kind, receive, send)
        finally:
            self._streams -= 1

    def _again(self, asked: Asked, kind: bytes) -> Said | None:
        """Answer once more what can be answered, unless a scenario wants something else."""
        try:
            if not self._observed.are_usual(asked):
                return None
            self._observed.look(asked)
            answer = self._observed.agent.answer(asked)
        except AgentError:
            return None
        if not isinstance(answer, Answer):
            return None
        document = _in_kind(answer, kind)
        return Said(_headers(document, kind), document)

    def _check(self, scope: Scope) -> None:
        """Refuse what is asked by other methods, or by a name that is not that of this computer."""
        if scope["method"] not in _METHODS:
            raise AgentError(
                Code.UNSUPPORTED, f"{scope['method'][:20]} is not served", hint="MTConnect reads: use GET."
            )
        if _body_bytes(scope) > _MOST_BODY_BYTES:
            raise AgentError(Code.INVALID_REQUEST, "a body is not read here", hint="Ask by the URL alone.")
        if self._hosts is None:
            return
        given = [value.decode("latin-1") for name, value in scope["headers"] if name == b"host"]
        host = (
            given[0].rpartition(":")[0] if given and given[0].rpartition(":")[2].isdigit() else "".join(given)
        )
        if len(given) > 1 or (given and host.strip("[]").lower() not in self._hosts):
            raise AgentError(
                Code.INVALID_REQUEST, "this host is not served here", hint="Ask by the address of the door."
            )

    async def _stream(
        self, asked: Asked, stream: StreamAsked, kind: bytes, receive: Receive, send: Send
    ) -> None:
        """Send documents until the client leaves, or reads so slowly that what it would get next is lost."""
        await send({
            "type": "http.response.start", "status": 200,
            "headers": [(b"content-type", b"multipart/x-mixed-replace;boundary=" + _BOUNDARY),
                        (b"cache-control", b"no-store"), (b"x-content-type-options", b"nosniff")],
        })  # fmt: skip
        gone = asyncio.ensure_future(_until_gone(receive))
        number, last = stream.first, time.monotonic()
        try:
            while not gone.done():
                due = time.monotonic() - last >= stream.heartbeat_s
                try:
                    self._observed.look(asked)
                    document, number = stream.next(number, due)
                except AgentError as error:
                    document = self._observed.agent.refusal(error, f"/{asked.request}").document
                    await _send_part(send, document, kind)
                    break
                if document is not None:
                    await _send_part(send, document, kind)
                    last = time.monotonic()
                wait_s = max(
                    _LEAST_BEAT_S, min(stream.interval_s, last + stream.heartbeat_s - time.monotonic())
                )
                await asyncio.wait([gone], timeout=wait_s)
            await send({"type": "http.response.body", "body": b"--" + _BOUNDARY + b"--\r\n"})
        except (OSError, TimeoutError):
            pass  # the client has left, or does not read
        finally:
            gone.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await gone


async def _until_gone(receive: Receive) -> None:
    while (await receive())["type"] != "http.disconnect":
        pass


async def _send_part(send: Send, document: bytes, kind: bytes) -> None:
    """Send a piece of a stream.

    Raises:
        TimeoutError: The client does not read.
    """
    document = as_json(document) if kind == _JSON else document
    head = b"--%b\r\nContent-type: %b\r\nContent-length: %d\r\n\r\n" % (_BOUNDARY, kind, len(document))
    message = {"type": "http.response.body", "body": head + document + b"\r\n", "more_body": True}
    await asyncio.wait_for(send(message), _MOST_WAIT_S)


def _body_bytes(scope: Scope) -> int:
    """Return how long the body of a request is; without end if it comes in chunks."""
    if any(name == b"transfer-encoding" for name, _ in scope["headers"]):
        return _MOST_BODY_BYTES + 1
    return max((int(value) for name, value in scope["headers"] if name == b"content-length"), default=0)


def _kind_of(scope: Scope) -> bytes:
    """Return the type of what a client wants: JSON if it asks for that alone, XML otherwise."""
    accepted = b",".join(value for name, value in scope["headers"] if name == b"accept").lower()
    return _JSON if b"json" in accepted and b"xml" not in accepted else _XML


def _headers(document: bytes, kind: bytes) -> list[tuple[bytes, bytes]]:
    return [
        (b"content-type", kind), (b"content-length", str(len(document)).encode()),
        (b"cache-control", b"no-store"), (b"x-content-type-options", b"nosniff"),
    ]  # fmt: skip


def _in_kind(answer: Answer, kind: bytes) -> bytes:
    return as_json(answer.document) if kind == _JSON else answer.document


async def _send_document(send: Send, answer: Answer, kind: bytes, *, closes: bool) -> None:
    document = _in_kind(answer, kind)
    headers = _headers(document, kind)
    if closes:  # the rest of what the client sends is not read
        headers.append((b"connection", b"close"))
    if answer.status == Code.UNSUPPORTED.status:
        headers.append((b"allow", ", ".join(_METHODS).encode()))
    await send({"type": "http.response.start", "status": answer.status, "headers": headers})
    await send({"type": "http.response.body", "body": document})


def _refuse(agent: Agent, status: int, what: str, hint: str) -> Refused:
    """Return an error document for what a connection refuses."""
    code = Code.TOO_MANY if status == Code.TOO_MANY.status else Code.INVALID_REQUEST
    said = agent.refusal(AgentError(code, what, hint=hint), "/")
    return Refused(said.status, _headers(said.document, _XML), said.document)


class MTConnectDoor(AsgiDoor):
    """Serve machines as devices of one agent; `version` is a key of VERSIONS."""

    def __init__(
        self, machines: Sequence[ServedMachine], wanted: Wanted, version: str = USUAL_VERSION
    ) -> None:
        observed = Observed(machines, VERSIONS[version], max(1, int(time.time())))
        loopback = wanted.address in (LOOPBACK, "::1", "localhost") or wanted.address.startswith("127.")
        hosts = frozenset({"localhost", LOOPBACK, "::1", wanted.address}) if loopback else None
        app: ASGIApp = App(observed, hosts)
        port = PORT if wanted.port is None else wanted.port

        def treat(path: str) -> Treatment:
            return treatment_of(machines_of_path(machines, path), "mtconnect")

        super().__init__("mtconnect", app, wanted.address, port, partial(_refuse, observed.agent), treat)
