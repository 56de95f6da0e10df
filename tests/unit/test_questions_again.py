"""A question that comes again, byte for byte, has the answer that it has when it is read again."""

from __future__ import annotations

import asyncio
import re
from collections.abc import Awaitable, Callable

import h11
import pytest

from polycnc.servers.machines import ServedMachine, Treatment, Wanted
from polycnc.servers.process import DOORS, Machinery
from support.http_app import served_machine

pytest.importorskip("fastapi", reason="pip install 'polycnc[serve]'")

PATHS = {"http": b"/api/machines/m/status", "mtconnect": b"/m/current?path=//Path"}
LIMIT_S = 30.0


class Client:
    """A client on one connection."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter, path: bytes) -> None:
        self.reader, self.writer = reader, writer
        self.question = b"GET %b HTTP/1.1\r\nHost: localhost\r\n\r\n" % path

    async def ask(self, question: bytes = b"") -> tuple[bytes, bytes]:
        self.writer.write(question or self.question)
        return await self.answer()

    async def answer(self) -> tuple[bytes, bytes]:
        """Return status and headers, but for the date, and the body."""
        head = await asyncio.wait_for(self.reader.readuntil(b"\r\n\r\n"), LIMIT_S)
        length = re.search(rb"content-length: (\d+)", head)
        assert length is not None
        return re.sub(rb"date: [^\r]*\r\n", b"", head), await self.reader.readexactly(int(length[1]))


def served(name: str, visit: Callable[[Client, ServedMachine], Awaitable[None]]) -> None:
    """Visit a door of a machine whose time stands, by one connection."""

    async def run() -> None:
        machine = served_machine("plain", Machinery("m", "mill3"))
        door = DOORS[name].open_door([machine], Wanted(port=0))
        await door.start()
        try:
            port = int(door.said.rpartition(":")[2])
            client = Client(*await asyncio.open_connection("127.0.0.1", port), PATHS[name])
            await visit(client, machine)
            client.writer.close()
        finally:
            await door.close()
            machine.close()

    asyncio.run(run())


@pytest.mark.parametrize("name", PATHS)
def test_it_is_read_once_and_answered_as_it_is_by_then(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    read: list[bytes] = []
    receive = h11.Connection.receive_data

    def received(self: h11.Connection, data: bytes) -> None:
        read.append(data)
        receive(self, data)

    monkeypatch.setattr(h11.Connection, "receive_data", received)

    async def visit(client: Client, machine: ServedMachine) -> None:
        first = await client.ask()
        assert first[0].startswith(b"HTTP/1.1 200 ")
        assert [await client.ask(), await client.ask()] == [first, first]
        assert read == [client.question]
        machine.control.set_overrides(feed=0.6)  # type: ignore[union-attr]
        _, changed = await client.ask()
        assert changed != first[1]
        # in pieces, and two at once, it is read as every other one
        begun, rest = client.question[:9], client.question[9:]
        client.writer.write(begun)
        while read[-1] != begun:
            await asyncio.sleep(0)
        assert (await client.ask(rest))[1] == changed
        assert (await client.ask(client.question * 2))[1] == changed
        assert (await client.answer())[1] == changed
        assert (await client.ask())[1] == changed
        longer = client.question.replace(b"\r\n\r\n", b"\r\nContent-Length: 5\r\n\r\nab")
        for _ in range(2):
            assert (await client.ask(longer))[1] == changed
            client.writer.write(b"cde")
        closing = client.question.replace(b"\r\n\r\n", b"\r\nConnection: close\r\n\r\n")
        head, last = await client.ask(closing)
        assert b"connection: close" in head.lower()
        assert last == changed
        assert await client.reader.read() == b""

    served(name, visit)


@pytest.mark.parametrize("name", PATHS)
def test_a_scenario_and_a_failure_come_first(name: str) -> None:
    async def visit(client: Client, machine: ServedMachine) -> None:
        first = await client.ask()
        asked: list[str] = []

        def treat(door: str) -> Treatment:
            asked.append(door)
            return Treatment()

        machine.treat = treat
        assert await client.ask() == first
        assert asked == [name]
        machine.treat_as_usual()
        assert await client.ask() == first
        machine.keeper.failed.set_exception(ValueError("broken"))
        head, _ = await client.ask()
        assert head.startswith(b"HTTP/1.1 5")
        machine.keeper.failed.exception()

    served(name, visit)


def test_each_is_counted() -> None:
    async def visit(client: Client, _: ServedMachine) -> None:
        for _k in range(3):
            await client.ask()
        figures = await client.ask(b"GET /metrics HTTP/1.1\r\nHost: localhost\r\n\r\n")
        assert b'polycnc_http_requests_total{status="200"} 3.0' in figures[1]

    served("http", visit)
