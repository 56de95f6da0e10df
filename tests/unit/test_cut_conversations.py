"""The bytes of a conversation cut anywhere, one by one, or all at once: each door gives the same answers."""

from __future__ import annotations

import asyncio
import random
import re
import struct
from collections.abc import Iterable

import pytest

from polycnc.controllers.fanuc.wire import Frame, FrameType, Request, write_requests
from polycnc.servers.calls import LIBRARIES
from polycnc.servers.machines import Wanted
from polycnc.servers.process import DOORS, Machinery
from support.http_app import served_machine
from support.often import share

pytest.importorskip("fastapi", reason="pip install 'polycnc[serve]'")

QUIET_TURNS = 50  # of the event loop that the door is in, however long they take


FWLIB = LIBRARIES["fanuc"].load()
NUMBERS = {each.function.name: each.number for each in FWLIB.calls}


def commands(*codes: int) -> bytes:
    requests = [Request(code, (1, 1, 1, 0), b"", 1) for code in codes]
    return bytes(Frame(FrameType.COMMANDS, write_requests(requests)))


def question(method: str, path: str, body: str = "", more: str = "") -> bytes:
    head = f"{method} {path} HTTP/1.1\r\nHost: localhost\r\nContent-Length: {len(body)}\r\n{more}\r\n"
    return (head + body).encode()


def call(name: str, packed: bytes) -> bytes:
    return struct.pack("<IHH", 4 + len(packed), NUMBERS[name], 513) + packed


FOCAS = [
    bytes(Frame(FrameType.OPEN, b"\0\2")), commands(0x18), commands(0x19, 0x26, 0x0E), commands(0x15),
    commands(0x7777), commands(), bytes(Frame(FrameType.CLOSE)),
]  # fmt: skip
HTTP = [
    question("GET", "/api/machines/m/status"),
    question("PUT", "/api/machines/m/programs/O0012", "O12\nG4 X1.\nM30\n"),
    b"GET /api/machines/m/programs/O0012 HTTP/1.1\r\nhost:localhost\r\n\r\n",
    question("POST", "/api/machines/m/commands", '{"command": "select_program", "program": "O0012"}'),
    b"PUT /api/machines/m/programs/O0013 HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n"
    b"5\r\nO0013\r\n4\r\n\nM30\r\n0\r\n\r\n",
    question("GET", "/api/machines/m/programs", more="Connection: close\r\n"),
]
MTCONNECT = [
    question("GET", "/current?path=//DataItem[@category=%22SAMPLE%22]"), question("GET", "/probe"),
    question("GET", "/sample?from=1&count=3"), question("GET", "/x?count=1e9", more="Connection: close\r\n"),
]  # fmt: skip
GRBL = [b"?", b"$I\n", b"G1 X\n", b"$1", b"0=3\n?", b"(a?b)\n", b"$$\n", b"\x91\x91", b"?$X\r\n", b"Q\n"]
SHDR = [b"* PING\n", b"* PING\r\n", b"nonsense\n", b"x" * 2000 + b"\n", b"* PING\n"]
CALLS = [
    b"PNCCALL1" + bytes([8, 0, 0, 0]) + struct.pack("<16s16s16s", b"fwlib32", b"7.5", FWLIB.table_hash),
    call("cnc_allclibhndl", struct.pack("<I", 2)),
    call("cnc_wrmacro", struct.pack("<HhhiH", 1, 103, 10, 31415, 3)),
    call("cnc_rdmacro", struct.pack("<HhhI", 1, 103, 10, 10)),
    call("cnc_rdmacro", b"cut"),
]
CONVERSATIONS: dict[str, tuple[str, list[bytes]]] = {
    "focas": ("fanuc", FOCAS), "http": ("plain", HTTP), "mtconnect": ("plain", MTCONNECT), "grbl": ("plain", GRBL),
    "shdr": ("plain", SHDR), "calls": ("fanuc", CALLS),
}  # fmt: skip
_CHANGES = re.compile(
    rb'(?:date|polycnc-number): [^\r]*|creationTime="[^"]*"|instanceId="[^"]*"|requestTime="[^"]*"'
)


async def talk(name: str, pieces: Iterable[bytes]) -> bytes:
    """Say pieces to a new machine's door, each in a turn of its own; return all that is answered."""
    kind = CONVERSATIONS[name][0]
    machine = served_machine(kind, Machinery("m", "mill3" if kind == "plain" else None))
    door = DOORS[name].open_door([machine], Wanted(port=0))
    await door.start()
    reader, writer = await asyncio.open_connection("127.0.0.1", int(door.said.rpartition(":")[2]))
    try:
        for piece in pieces:
            writer.write(piece)
            await asyncio.sleep(0)
            await asyncio.sleep(0)
        return _CHANGES.sub(b"", await all_that_comes(reader))
    finally:
        writer.close()
        await door.close()
        machine.close()


async def all_that_comes(reader: asyncio.StreamReader) -> bytes:
    """Return what comes until the end, or until nothing has come for some turns after something has."""
    said = b""
    while True:
        reading = asyncio.ensure_future(reader.read(1 << 16))
        for turn in range(60_000):
            if reading.done() or (said and turn >= QUIET_TURNS):
                break
            await asyncio.sleep(0.001)
        if not reading.done():
            reading.cancel()
            return said
        if reading.exception() is not None or not reading.result():
            return said
        said += reading.result()


def cuts(name: str) -> list[list[bytes]]:
    """Return a conversation in pieces: at once, byte by byte, and cut at random places."""
    whole = b"".join(CONVERSATIONS[name][1])
    chosen = random.Random(7)
    made = [[whole], [whole[at : at + 1] for at in range(len(whole))]]
    for _ in range(share(6)):
        places = sorted(chosen.sample(range(1, len(whole)), min(5, len(whole) - 1)))
        made.append([whole[a:b] for a, b in zip([0, *places], [*places, len(whole)], strict=True)])
    return made


@pytest.mark.parametrize("name", CONVERSATIONS)
def test_answers_are_the_same_however_the_bytes_come(name: str) -> None:
    expected = asyncio.run(talk(name, CONVERSATIONS[name][1]))
    assert len(expected) > 8 * len(CONVERSATIONS[name][1])
    for pieces in cuts(name):
        assert asyncio.run(talk(name, pieces)) == expected, [len(piece) for piece in pieces][:20]
