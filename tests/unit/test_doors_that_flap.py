"""Doors under a scenario: a dropped request is not carried out, a late one comes late, the others as usual."""

from __future__ import annotations

import asyncio
import struct
from collections.abc import Awaitable, Callable
from typing import Any

import pytest

from polycnc.controllers.fanuc.clib import FWLIB
from polycnc.servers.machines import ServedMachine, Wanted
from polycnc.servers.process import DOORS, Machinery
from polycnc.servers.scenarios import Script, Story
from support.http_app import served_machine

pytest.importorskip("fastapi", reason="pip install 'polycnc[serve]'")

LATE_S = 0.06
NUMBERS = {each.function.name: each.number for each in FWLIB.calls}
HELLO = b"PNCCALL1\x08\0\0\0" + struct.pack("<16s16s16s", b"fwlib32", b"7.5", FWLIB.table_hash)
OPEN = struct.pack("<IHHI", 8, NUMBERS["cnc_allclibhndl"], 9, 2)
GET = b"GET %b HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n"


class Line:
    """A connection, and how it is asked."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self.reader, self.writer = reader, writer

    async def ask(self, *pieces: bytes, until: bytes = b"\n") -> bytes:
        """Send pieces and return what comes until these bytes; what was read before that is part of it."""
        for each in pieces:
            self.writer.write(each)
            await asyncio.sleep(0)
        return await asyncio.wait_for(self.reader.readuntil(until), 60)


async def of_http(line: Line, path: bytes) -> bytes:
    line.writer.write(GET % path)
    return await asyncio.wait_for(line.reader.readexactly(15), 60)


async def of_calls(line: Line) -> bytes:
    line.writer.write(HELLO)
    assert await line.reader.readexactly(12) == b"PNCCALL1" + bytes(4)
    for at in range(0, len(OPEN), 5):
        line.writer.write(OPEN[at : at + 5])
        await asyncio.sleep(0)
    return await asyncio.wait_for(line.reader.readexactly(26), 60)


async def of_grbl(line: Line) -> bytes:
    await line.ask(until=b"]\r\n")
    return await line.ask(b"G91", b"X0\n")


async def of_question(line: Line) -> bytes:
    await line.ask(until=b"]\r\n")
    return await line.ask(b"?", until=b">")


async def of_shdr(line: Line) -> bytes:
    return await line.ask(until=b"\n")


ASK: dict[str, tuple[str, str, Callable[[Line], Awaitable[bytes]]]] = {
    "http": ("http", "plain", lambda line: of_http(line, b"/api/machines/m/status")),
    "mtconnect": ("mtconnect", "plain", lambda line: of_http(line, b"/m/current")),
    "calls": ("calls", "fanuc", of_calls),
    "grbl": ("grbl", "plain", of_grbl),
    "grbl question": ("grbl", "plain", of_question),
    "shdr": ("shdr", "plain", of_shdr),
}


def asked(case: str, count: int, *steps: dict[str, Any]) -> tuple[list[str], list[float]]:
    """Ask a door so many times, each on a connection of its own; return what came, and how long it took (s)."""
    name, kind, ask = ASK[case]

    async def run() -> tuple[list[str], list[float]]:
        machine: ServedMachine = served_machine(kind, Machinery("m", "mill3" if kind == "plain" else None))
        machine.served.scenario = Story(Script.model_validate({"step": steps}, strict=False), machine)
        door = DOORS[name].open_door([machine], Wanted(port=0))
        await door.start()
        came, took = [], []
        try:
            for _ in range(count):
                line = Line(*await asyncio.open_connection("127.0.0.1", int(door.said.rpartition(":")[2])))
                begin_s = asyncio.get_running_loop().time()
                try:
                    came.append("answered" if await ask(line) else "")
                except (asyncio.IncompleteReadError, ConnectionError):
                    came.append("reset")
                took.append(asyncio.get_running_loop().time() - begin_s)
                line.writer.close()
            return came, took
        finally:
            await door.close()
            machine.close()

    return asyncio.run(run())


@pytest.mark.parametrize("case", ASK)
def test_dropped_requests_reset_their_connections_and_the_next_ones_are_answered(case: str) -> None:
    step = {"name": "cut", "do": "drop", "door": ASK[case][0], "at_request": 2, "for_requests": 2}
    came, _ = asked(case, 4, step)
    assert came == ["answered", "reset", "reset", "answered"]


@pytest.mark.parametrize("case", ASK)
def test_late_answers_come_late_and_are_whole(case: str) -> None:
    step = {
        "name": "slow", "do": "latency", "door": ASK[case][0], "at_request": 2, "for_requests": 1,
        "with": {"delay_s": LATE_S},
    }  # fmt: skip
    came, took = asked(case, 3, step)
    assert came == ["answered"] * 3
    assert took[1] >= LATE_S - 1e-3


@pytest.mark.parametrize("case", ["http", "grbl", "calls"])
def test_what_happens_to_another_door_changes_nothing(case: str) -> None:
    came, _ = asked(case, 2, {"name": "cut", "do": "drop", "door": "opcua", "at_s": 0.0})
    assert came == ["answered"] * 2


def test_a_dropped_call_is_not_carried_out_and_those_before_it_are() -> None:
    async def run() -> tuple[bool, bool]:
        machine = served_machine("fanuc", Machinery("m"))
        step = {"name": "cut", "do": "drop", "door": "calls", "at_request": 3}
        machine.served.scenario = Story(Script.model_validate({"step": (step,)}, strict=False), machine)
        door = DOORS["calls"].open_door([machine], Wanted(port=0))
        await door.start()
        write = struct.Struct("<IHHHhhiH")
        numbers = (NUMBERS["cnc_wrmacro"], 9, 1)
        calls = [write.pack(write.size - 4, *numbers, number, 10, 31415, 3) for number in (103, 104)]
        try:
            reader, writer = await asyncio.open_connection("127.0.0.1", int(door.said.rpartition(":")[2]))
            writer.write(HELLO + OPEN + b"".join(calls))
            came = await reader.read(-1)  # the answers before it have come, however the bytes were cut
            at, answers = 12, 0
            while at < len(came):
                at, answers = at + 4 + int.from_bytes(came[at : at + 4], "little"), answers + 1
            assert (at, answers) == (len(came), 2)
            writer.close()
            device: Any = machine.device
            macros = device.custom_macros
            return macros.variables.get(103) is not None, macros.variables.get(104) is not None
        finally:
            await door.close()
            machine.close()

    assert asyncio.run(run()) == (True, False)
