"""Bytes of any kind, cut anywhere, at a connection of OPC UA: nothing escapes, and what waits stays bounded."""

from __future__ import annotations

import asyncio
import logging
import random
import struct
from typing import Any

import pytest

pytest.importorskip("asyncua", reason="pip install 'polycnc[opcua]'")

from asyncua import ua
from asyncua.common.connection import TransportLimits
from asyncua.crypto.security_policies import SecurityPolicyFactory, SecurityPolicyNone

from polycnc.servers.opcua._bounds import CHUNK_BYTES, MESSAGE_BYTES, MOST_CHUNKS, Connection
from polycnc.servers.opcua._identity import Users
from polycnc.servers.opcua._standard import bounded_server

URL = b"opc.tcp://127.0.0.1:4840"
HELLO = b"HELF" + struct.pack("<7I", 32 + len(URL), 0, 65536, 65536, 0, 0, len(URL)) + URL
POLICY = b"http://opcfoundation.org/UA/SecurityPolicy#None"
HEADER = b"\x00\x00" + bytes(8) + struct.pack("<IIiI", 1, 0, -1, 0) + b"\x00\x00\x00"  # of a request
OPEN_BODY = (
    struct.pack("<Ii", 0, len(POLICY)) + POLICY + struct.pack("<ii", -1, -1) + struct.pack("<II", 1, 1)
    + b"\x01\x00\xbe\x01" + HEADER + struct.pack("<IIIiI", 0, 0, 1, -1, 3_600_000)
)  # fmt: skip
OPEN = b"OPNF" + struct.pack("<I", 8 + len(OPEN_BODY)) + OPEN_BODY
KINDS = (b"MSGF", b"MSGC", b"MSGA", b"OPNF", b"CLOF", b"HELF", b"ACKF", b"ERRF")


class Line(asyncio.Transport):
    """A transport that forgets what it is given."""

    def __init__(self) -> None:
        super().__init__()
        self.closed = False

    def get_extra_info(self, name: str, default: Any = None) -> Any:
        return ("127.0.0.1", 40000)

    def get_write_buffer_size(self) -> int:
        return 0

    def write(self, data: Any) -> None:
        pass

    def close(self) -> None:
        self.closed = True

    abort = close


def chunks(chosen: random.Random) -> bytes:
    """Return what a client might send, with something wrong in it."""
    parts = [HELLO, OPEN]
    for _ in range(chosen.randint(0, 6)):
        body = chosen.randbytes(chosen.choice((0, 4, 24, 200)))
        size = chosen.choice((8 + len(body), 0, 7, 9, 1 << 16, 1 << 31, (1 << 32) - 1))
        parts.append(chosen.choice(KINDS) + struct.pack("<I", size) + body)
    chosen.shuffle(parts)
    whole = bytearray(b"".join(parts))
    for _ in range(chosen.randint(0, 4)):
        whole[chosen.randrange(len(whole))] = chosen.randrange(256)
    return bytes(whole[: chosen.randint(1, len(whole))])


@pytest.fixture(autouse=True)
def _no_log(monkeypatch: pytest.MonkeyPatch) -> None:
    """What the library says of such bytes is not always text that a report could hold."""
    monkeypatch.setattr(logging.getLogger("asyncua"), "disabled", True)
    monkeypatch.setattr(logging.root.manager, "disable", logging.CRITICAL)


async def attack(cases: int, seed: int) -> None:
    chosen = random.Random(seed)
    server = bounded_server(Users(None))
    server.max_pending_activation_seconds = 0.0
    limits = TransportLimits(CHUNK_BYTES, CHUNK_BYTES, MOST_CHUNKS, MESSAGE_BYTES)
    policies = [SecurityPolicyFactory(SecurityPolicyNone, ua.MessageSecurityMode.None_)]
    closing: list[asyncio.Task[Any]] = []
    for _ in range(cases):
        line = Line()
        connection = Connection(server, policies, [], closing, limits)
        connection.connection_made(line)
        data = chunks(chosen)
        at = 0
        while at < len(data) and not line.closed:
            piece = chosen.randint(1, 400)
            connection.data_received(data[at : at + piece])
            at += piece
            assert len(connection._buffer) <= CHUNK_BYTES + 400
            await asyncio.sleep(0)
        connection.connection_lost(None)
        await asyncio.gather(*closing, connection._task, return_exceptions=True)
        closing.clear()
    server.method_service.stop()


def test_nothing_escapes_a_connection() -> None:
    asyncio.run(attack(10_000, 20261126))


@pytest.mark.long
def test_nothing_escapes_a_connection_long() -> None:
    asyncio.run(attack(1_000_000, 7))
