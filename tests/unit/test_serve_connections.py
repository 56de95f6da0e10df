"""Clients that vanish, stop half way, or come in crowds: bounded in time and number, and nobody else waits for them."""

from __future__ import annotations

import asyncio
import socket
import struct
from collections.abc import Awaitable, Callable
from typing import Any, TypeVar

import pytest

from polycnc.controllers.fanuc.wire import Frame, FrameType
from polycnc.servers.calls import LIBRARIES
from polycnc.servers.machines import Wanted, tell_errors
from polycnc.servers.process import DOORS, Machinery
from support.http_app import served_machine

pytest.importorskip("fastapi", reason="pip install 'polycnc[serve]'")

R = TypeVar("R")
SHORT_S = 0.05


def with_door(name: str, kind: str, machinery: Machinery, visit: Callable[[int], Awaitable[R]]) -> R:
    """Open a door of a machine on a free port, and visit it in the same event loop."""

    async def run() -> R:
        machine = served_machine(kind, machinery)
        door = DOORS[name].open_door([machine], Wanted(port=0))
        await door.start()
        try:
            return await visit(int(door.said.rpartition(":")[2]))
        finally:
            await door.close()
            machine.close()

    return asyncio.run(run())


async def ended(reader: asyncio.StreamReader) -> bytes:
    """Return what still comes until the connection ends."""
    try:
        return await asyncio.wait_for(reader.read(), 60)
    except ConnectionError:
        return b""


DOORS_OF_HTTP = {
    "http": (b"/health", b"application/problem+json"),
    "mtconnect": (b"/probe", b"text/xml; charset=utf-8"),
}
"""What each answers, and how it refuses."""
of_http = pytest.mark.parametrize("name", DOORS_OF_HTTP)


def ask(name: str, head: bytes = b"") -> bytes:
    return b"GET %b HTTP/1.1\r\nHost: localhost\r\n%b\r\n" % (DOORS_OF_HTTP[name][0], head)


def short(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("polycnc.servers.asgi._connection.MOST_WAIT_S", SHORT_S)
    monkeypatch.setattr("polycnc.servers.asgi._connection._LOOK_S", SHORT_S)


@of_http
@pytest.mark.parametrize(
    "begun",
    [
        "",
        "GET /hea",
        "PUT /api/machines/m/programs/O1 HTTP/1.1\r\nHost: localhost\r\nContent-Length: 9\r\n\r\nO1",
    ],
)
def test_a_question_that_never_comes_ends_its_connection(
    name: str, begun: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    short(monkeypatch)

    async def visit(port: int) -> None:
        reader, writer = await asyncio.open_connection("127.0.0.1", port)
        writer.write(begun.encode())
        said = await ended(reader)
        assert not said or (name == "mtconnect" and said.startswith(b"HTTP/1.1 405 "))
        writer.close()

    with_door(name, "plain", Machinery("m", "mill3"), visit)


async def asking(loop: asyncio.AbstractEventLoop, line: socket.socket, question: bytes) -> None:
    while True:
        await loop.sock_sendall(line, question)
        await asyncio.sleep(0)


@pytest.mark.parametrize(("name", "path"), [("http", b"/openapi.json"), ("mtconnect", b"/probe")])
def test_an_answer_that_is_never_read_ends_its_connection(
    name: str, path: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    short(monkeypatch)

    async def visit(port: int) -> None:
        loop = asyncio.get_running_loop()
        with socket.socket() as line:
            line.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            line.setblocking(False)
            await loop.sock_connect(line, ("127.0.0.1", port))
            question = b"GET %b HTTP/1.1\r\nHost: localhost\r\n\r\n" % path
            await loop.sock_sendall(line, question * 500)
            with pytest.raises(ConnectionError):  # answers that nobody reads, until it is over
                await asyncio.wait_for(asking(loop, line, question), 60)

    with_door(name, "plain", Machinery("m", "mill3"), visit)


@of_http
def test_beyond_the_number_of_connections_each_is_told(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("polycnc.servers.asgi._connection.MOST_CONNECTIONS", 3)

    async def visit(port: int) -> None:
        lines = [await asyncio.open_connection("127.0.0.1", port) for _ in range(3)]
        for reader, writer in lines:
            writer.write(ask(name))
            assert (await reader.readline()).startswith(b"HTTP/1.1 200 ")
        reader, writer = await asyncio.open_connection("127.0.0.1", port)
        writer.write(ask(name))
        said = await ended(reader)
        assert said.startswith(b"HTTP/1.1 503 ")
        assert DOORS_OF_HTTP[name][1] in said
        for _, other in (*lines, (reader, writer)):
            other.close()
        for _ in range(500):  # until it is noticed that they have gone
            reader, writer = await asyncio.open_connection("127.0.0.1", port)
            writer.write(ask(name))
            answered = (await reader.readline()).startswith(b"HTTP/1.1 200 ")
            writer.close()
            if answered:
                return
            await asyncio.sleep(0.01)
        raise AssertionError("there is no room again")

    with_door(name, "plain", Machinery("m", "mill3"), visit)


@of_http
@pytest.mark.parametrize(
    "sent", [b"\x16\x03\x01\x02\x00\x01", b"GET / SPDY/3\r\n\r\n", b"\r\n\r\n\x00\x00\xff\r\n\r\n"]
)
def test_what_is_no_http_is_refused_in_the_form_of_the_door(name: str, sent: bytes) -> None:
    async def visit(port: int) -> None:
        reader, writer = await asyncio.open_connection("127.0.0.1", port)
        writer.write(sent + b"\r\n\r\n")
        said = await ended(reader)
        assert said.startswith(b"HTTP/1.1 400 ")
        assert DOORS_OF_HTTP[name][1] in said
        writer.close()

    with_door(name, "plain", Machinery("m", "mill3"), visit)


@pytest.mark.parametrize("head", [b"Content-Length: 65537\r\n", b"Transfer-Encoding: chunked\r\n"])
def test_a_body_that_an_agent_does_not_read_ends_its_connection_with_the_refusal(head: bytes) -> None:
    async def visit(port: int) -> None:
        reader, writer = await asyncio.open_connection("127.0.0.1", port)
        writer.write(ask("mtconnect", head) + b"1\r\nx\r\n")
        said = await ended(reader)
        assert said.startswith(b"HTTP/1.1 400 ")
        assert b"a body is not read here" in said
        writer.close()

    with_door("mtconnect", "plain", Machinery("m", "mill3"), visit)


def test_a_download_that_stops_half_way_blocks_no_other_for_long(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("polycnc.servers.focas._server.LEAST_PATIENCE_S", 0.3)
    opening = bytes(Frame(FrameType.OPEN, b"\0\1"))
    start = bytes(Frame(FrameType.DOWNLOAD_START, b"\0\0\0\1" + b"N:".ljust(512, b"\0")))

    async def open_line(port: int) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
        reader, writer = await asyncio.open_connection("127.0.0.1", port)
        writer.write(opening)
        assert await asyncio.wait_for(reader.read(4096), 60)
        writer.write(start)
        return reader, writer

    async def visit(port: int) -> None:
        reader, writer = await open_line(port)
        first = await asyncio.wait_for(reader.read(4096), 60)
        other, other_writer = await open_line(port)
        assert await asyncio.wait_for(other.read(4096), 60) != first  # refused: one comes in already
        assert await ended(reader) == b""
        again, again_writer = await open_line(port)
        assert await asyncio.wait_for(again.read(4096), 60) == first
        for each in (writer, other_writer, again_writer):
            each.close()

    with_door("focas", "fanuc", Machinery("m"), visit)


def test_a_connection_that_is_never_opened_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("polycnc.servers.focas._server.LEAST_PATIENCE_S", SHORT_S)

    async def visit(port: int) -> None:
        reader, writer = await asyncio.open_connection("127.0.0.1", port)
        assert await ended(reader) == b""
        writer.close()

    with_door("focas", "fanuc", Machinery("m"), visit)


CROWDED: dict[str, tuple[str, bytes, bytes]] = {
    "http": ("plain", b"GET /health HTTP/1.1\r\nHost: localhost\r\n\r\n", b"HTTP/1.1 200 "),
    "mtconnect": ("plain", b"GET /probe HTTP/1.1\r\nHost: localhost\r\n\r\n", b"HTTP/1.1 200 "),
    "shdr": ("plain", b"* PING\n", b"2000-01-01T"),
    "grbl": ("plain", b"?", b"Grbl 1.1"),
    "focas": ("fanuc", bytes(Frame(FrameType.OPEN, b"\0\1")), b"\xa0\xa0\xa0\xa0"),
    "calls": ("fanuc", (4).to_bytes(4, "little") + b"none", b""),
}
"""How each door is spoken to, and how what it says begins; b"" for anything, its end as well."""


async def _crowd(name: str, port: int, count: int) -> None:
    """Open so many connections, most of which say half of something; one that comes after them is answered."""
    _, hello, begins = CROWDED[name]

    async def said(writes: bytes) -> bytes:
        reader, writer = await asyncio.open_connection("127.0.0.1", port)
        writer.write(writes)
        try:
            return await asyncio.wait_for(reader.read(1 << 14), 60)
        except ConnectionError:
            return b""
        finally:
            writer.close()

    lines: list[socket.socket] = []
    try:
        for number in range(count):
            line = socket.create_connection(("127.0.0.1", port), timeout=60)
            lines.append(line)
            line.sendall(hello[: number % len(hello)])
            if number % 50 == 0:
                await asyncio.sleep(0)
        while_crowded = await said(hello)
        refused = not while_crowded or b"Another sender" in while_crowded
        assert refused or while_crowded.lstrip().startswith(begins), (name, while_crowded)
    finally:
        for line in lines:
            line.close()
    for _ in range(200):  # those that have gone are noticed
        answer = await said(hello)
        if answer.lstrip().startswith(begins) and (answer or not begins):
            return
        await asyncio.sleep(0.01)
    raise AssertionError(f"{name} answers nobody after a crowd")


def _visit_crowded(name: str, count: int) -> None:
    kind = CROWDED[name][0]

    async def visit(port: int) -> None:
        await _crowd(name, port, count)

    with_door(name, kind, Machinery("m", "mill3" if kind == "plain" else None), visit)


def test_a_crowd_of_half_begun_questions_stops_no_door() -> None:
    """Each door, 120 connections that say nothing or a part of something, of which some are cut in each place."""
    assert set(CROWDED) | {"opcua"} == set(DOORS)
    for name in CROWDED:
        _visit_crowded(name, 120)


@pytest.mark.long
def test_thousands_of_half_begun_questions_stop_no_door() -> None:
    for name in CROWDED:
        _visit_crowded(name, 4_000)


SILENT = {
    "http": b"GET /hea",
    "mtconnect": b"",
    "shdr": b"* PI",
    "grbl": b"",
    "focas": b"\xa0\xa0",
    "calls": b"PNC",
}
"""What a client sends that says nothing whole."""


@pytest.mark.parametrize("name", SILENT)
def test_who_says_nothing_makes_room_for_who_asks(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """More silent connections than a door takes: whoever asks is answered, and who has asked before stays."""
    for place, most in {"asgi._connection.MOST_CONNECTIONS": 4, "shdr._server._MOST_AGENTS": 4,
                        "grbl._server._SILENT_S": 0.0, "focas._server.MOST_LINES": 4,
                        "calls._server._MOST_CLIENTS": 4}.items():  # fmt: skip
        monkeypatch.setattr(f"polycnc.servers.{place}", most)
    kind, hello, begins = CROWDED[name]
    if name == "calls":
        table = LIBRARIES["fanuc"].load().table_hash
        hello = b"PNCCALL1" + bytes([8, 0, 0, 0]) + struct.pack("<16s16s16s", b"fwlib32", b"7.5", table)

    async def ask(port: int) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
        reader, writer = await asyncio.open_connection("127.0.0.1", port)
        writer.write(hello)
        said = await asyncio.wait_for(reader.read(1 << 14), 60)
        assert said.lstrip().startswith(begins), said
        return reader, writer

    async def visit(port: int) -> None:
        known = [] if name == "grbl" else [await ask(port)]  # one sender at a time
        silent = [await asyncio.open_connection("127.0.0.1", port) for _ in range(9)]
        for _, writer in silent:
            writer.write(SILENT[name])
        for _ in range(100):  # looks at the connections, however long they take
            await asyncio.sleep(0)
        known.append(await ask(port))
        for reader, writer in known:
            assert not reader.at_eof()
            writer.close()
        for _, writer in silent:
            writer.close()

    with_door(name, kind, Machinery("m", "mill3" if kind == "plain" else None), visit)


def test_a_system_without_files_is_told_once_in_a_word() -> None:
    told: list[tuple[str, str]] = []

    async def run() -> None:
        loop = asyncio.get_running_loop()
        tell_errors(loop, lambda kind, text: told.append((kind, text)))
        context: dict[str, Any] = {"message": "accept", "exception": OSError(24, "Too many open files")}
        loop.call_exception_handler(context)

    asyncio.run(run())
    assert told == [
        ("crowded", "no more connections can be taken: the system gives this process no more files")
    ]
