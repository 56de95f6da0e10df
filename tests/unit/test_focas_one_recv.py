"""Clients that take each reply by one `recv`, and lines that cut or join what is sent: everything arrives.

Client, line and server share one event loop: what has arrived is taken before a timer of the server acts, so that
nothing here depends on how busy the computer is.
"""

from __future__ import annotations

import asyncio
import socket
from collections.abc import Awaitable, Callable

import pytest

from polycnc.controllers.fanuc import PowerMate
from polycnc.controllers.fanuc.wire import Frame, FrameReader, FrameType, Request, status_body, write_requests
from polycnc.machine import Wall
from polycnc.servers.focas import (
    COMMANDS,
    PROFILES,
    WRITING,
    FocasControl,
    FocasServer,
    ServedControl,
    load_profile,
)
from polycnc.servers.machines import Keeper
from support.focas_scenes import SCENES, scene_control

PROGRAM = "O1234\n" + "N10G1X-12.375F600\n" * 150 + "M30\n"
START = b"\0\0\0\1" + b"O1234-O1234".ljust(512, b"\0")


class Still(Wall):
    """A wall clock that stands still: the machine does too."""

    def now_s(self) -> float:
        return 0.0


class Client:
    """One that believes that one `recv` brings one reply."""

    def __init__(self, line: socket.socket) -> None:
        self.line, self.loop = line, asyncio.get_running_loop()

    async def ask(self, kind: FrameType, body: bytes = b"") -> Frame:
        await self.loop.sock_sendall(self.line, bytes(Frame(kind, body)))
        (frame,) = FrameReader().feed(await self.loop.sock_recv(self.line, 4096))
        return frame

    async def upload(self, start: bytes) -> tuple[Frame, bytes]:
        """Return the reply and what follows it, which is taken as it comes."""
        reply, reader, text = await self.ask(FrameType.UPLOAD_START, start), FrameReader(), b""
        while len(reply.body) > 4:
            for frame in reader.feed(await self.loop.sock_recv(self.line, 1500)):
                if frame.type == FrameType.UPLOAD_FINISHED:
                    await self.loop.sock_sendall(self.line, bytes(Frame(FrameType.UPLOAD_ACKNOWLEDGED)))
                    return reply, text
                assert frame.type == FrameType.UPLOAD_DATA
                text += frame.body
        return reply, text


def served(profile: str, control: PowerMate, visit: Callable[[int], Awaitable[None]]) -> None:
    """Serve a control as long as a visit takes."""

    async def run() -> None:
        keeper = Keeper(ServedControl(control), Still())
        server = FocasServer(keeper, control, load_profile(profile), port=0)
        await server.start()
        try:
            await asyncio.wait_for(visit(server.port), 60)
        finally:
            await server.close()
            keeper.close()

    asyncio.run(run())


async def connected(port: int) -> Client:
    line = socket.socket()
    line.setblocking(False)
    await asyncio.get_running_loop().sock_connect(line, ("127.0.0.1", port))
    return Client(line)


@pytest.mark.parametrize("profile", PROFILES)
def test_every_reply_comes_alone(profile: str) -> None:
    control = scene_control(profile).control

    async def visit(port: int) -> None:
        client = await connected(port)
        assert (await client.ask(FrameType.OPEN, b"\0\2")).type == FrameType.OPENED
        for _, requests in SCENES:
            assert (await client.ask(FrameType.COMMANDS, write_requests(requests))).type == FrameType.ANSWERS
        for target, code in sorted(set(COMMANDS) - WRITING):
            asked = write_requests([Request(code, (1, 1, 1, 1), bytes(256), target)])
            assert (await client.ask(FrameType.COMMANDS, asked)).type == FrameType.ANSWERS
        assert (await client.ask(FrameType.CLOSE)).type == FrameType.CLOSED
        client.line.close()

    served(profile, control, visit)


@pytest.mark.parametrize("profile", PROFILES)
def test_programs_go_both_ways_with_one_recv_for_a_reply(profile: str) -> None:
    control = PowerMate(2)

    async def visit(port: int) -> None:
        client = await connected(port)
        await client.ask(FrameType.OPEN, b"\0\1")
        assert (await client.ask(FrameType.DOWNLOAD_START, b"\0\0\0\1" + bytes(512))).type == 0x1102
        text = f"\n{PROGRAM}%".encode()
        for at in range(0, len(text), 700):
            await client.loop.sock_sendall(
                client.line, bytes(Frame(FrameType.DOWNLOAD_DATA, text[at : at + 700]))
            )
        assert (await client.ask(FrameType.DOWNLOAD_END)).type == FrameType.DOWNLOAD_ENDED
        for _ in range(2):
            reply, came = await client.upload(START)
            assert (reply.type, came) == (FrameType.UPLOAD_STARTED, f"%\n{PROGRAM}%".encode())
        assert (await client.ask(FrameType.UPLOAD_END)).body == status_body(13)
        assert (await client.ask(FrameType.CLOSE)).type == FrameType.CLOSED
        client.line.close()

    served(profile, control, visit)


async def passed_on(
    source: asyncio.StreamReader, target: asyncio.StreamWriter, forward: Callable[[bytes], list[bytes]]
) -> None:
    """Pass bytes on as a line does that cuts or joins them."""
    while data := await source.read(4096):
        for piece in forward(data):
            target.write(piece)
            await target.drain()
            await asyncio.sleep(0)
    target.close()


def cutting(data: bytes) -> list[bytes]:
    return [data[at : at + 3] for at in range(0, len(data), 3)]


class Joining:
    """Hold what belongs to an upload back until it has ended, and pass the rest on."""

    def __init__(self) -> None:
        self.held = b""

    def __call__(self, data: bytes) -> list[bytes]:
        self.held += data
        names = [frame.type for frame in FrameReader().feed(self.held)]
        if names[-1:] == [FrameType.UPLOAD_DATA] or names == [FrameType.UPLOAD_STARTED]:
            return []
        data, self.held = self.held, b""
        return [data]


@pytest.mark.parametrize("make", [lambda: cutting, Joining], ids=["cut", "joined"])
@pytest.mark.parametrize("profile", ["16i", "31i"])
def test_a_program_goes_out_through_a_line_that_cuts_or_joins(
    profile: str, make: Callable[[], Callable[[bytes], list[bytes]]]
) -> None:
    control = PowerMate(2)
    control.programs.register(1234, PROGRAM)

    async def visit(port: int) -> None:
        async def between(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
            there, back = await asyncio.open_connection("127.0.0.1", port)
            await asyncio.gather(passed_on(reader, back, cutting), passed_on(there, writer, make()))

        line = await asyncio.start_server(between, "127.0.0.1", 0)
        reader, writer = await asyncio.open_connection(*line.sockets[0].getsockname())
        frames, got = FrameReader(), list[Frame]()

        async def sent(frame: Frame, last: FrameType) -> None:
            writer.write(bytes(frame))
            while not got or got[-1].type != last:
                got.extend(frames.feed(await reader.read(4096)))

        await sent(Frame(FrameType.OPEN, b"\0\1"), FrameType.OPENED)
        await sent(Frame(FrameType.UPLOAD_START, START), FrameType.UPLOAD_FINISHED)
        text = b"".join(frame.body for frame in got if frame.type == FrameType.UPLOAD_DATA)
        assert text == f"%\n{PROGRAM}%".encode()
        writer.write(bytes(Frame(FrameType.UPLOAD_ACKNOWLEDGED)))
        await sent(Frame(FrameType.CLOSE), FrameType.CLOSED)
        writer.close()
        line.close()

    served(profile, control, visit)


def test_a_client_that_goes_while_a_program_goes_out_gives_its_session_back() -> None:
    control = PowerMate(2)
    control.programs.register(1234, PROGRAM)
    held: list[FocasControl] = []

    async def run() -> None:
        keeper = Keeper(ServedControl(control), Still())
        server = FocasServer(keeper, control, load_profile("31i"), port=0)
        held.append(server.control)
        await server.start()
        client = await connected(server.port)
        await client.ask(FrameType.OPEN, b"\0\1")
        await client.ask(FrameType.UPLOAD_START, START)
        client.line.close()
        while server.control.sessions[1]:
            await asyncio.sleep(0.001)
        await server.close()
        keeper.close()

    asyncio.run(asyncio.wait_for(run(), 60))
    assert held[0].sessions[1] == 0
