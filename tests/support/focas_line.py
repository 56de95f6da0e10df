"""A client of a served control over real sockets, and the process that serves it."""

from __future__ import annotations

import itertools
import os
import socket
from contextlib import suppress
from pathlib import Path

from polycnc.controllers.fanuc.wire import (
    Frame,
    FrameReader,
    FrameType,
    Reply,
    Request,
    Value8,
    read_replies,
    write_requests,
)
from support.started import Started, started


class Line:
    """A connection to a served control."""

    def __init__(
        self, port: int, channel: int = 2, address: str = "127.0.0.1", timeout_s: float = 60.0
    ) -> None:
        self.socket = socket.create_connection((address, port), timeout=timeout_s)
        self.frames = FrameReader()
        self.got: list[Frame] = []
        try:
            self.opened = self.ask(Frame(FrameType.OPEN, channel.to_bytes(2, "big")))
        except BaseException:
            self.socket.close()
            raise
        self.socket.settimeout(60.0)

    def ask(self, frame: Frame) -> Frame:
        """Send a frame and return the next one that comes."""
        self.socket.sendall(bytes(frame))
        return self.next()

    def next(self) -> Frame:
        """Return the next frame.

        Raises:
            ConnectionError: The connection has ended.
        """
        while not self.got:
            data = self.socket.recv(65536)
            if not data:
                raise ConnectionError("the connection has ended")
            self.got += self.frames.feed(data)
        return self.got.pop(0)

    def commands(self, *requests: Request) -> list[Reply]:
        """Return the answers to one frame of commands."""
        answer = self.ask(Frame(FrameType.COMMANDS, write_requests(requests)))
        assert answer.type == FrameType.ANSWERS
        return [reply for _, reply in read_replies(answer.body)]

    def payload(self, command: int, *arguments: int, data: bytes = b"", target: int = 1) -> bytes:
        """Return the payload of a command that succeeds."""
        padded = (*arguments, 0, 0, 0, 0)
        (reply,) = self.commands(Request(command, (padded[0], padded[1], padded[2], padded[3]), data, target))
        assert reply.status == 0, (hex(command), reply.status)
        return reply.payload

    def close(self) -> None:
        """Close the connection."""
        self.socket.close()


_TRIED = itertools.count()


def free_port() -> int:
    """Return a port that nobody listens on, below those that the system gives to whoever connects meanwhile."""
    for number in _TRIED:
        port = 20_000 + (os.getpid() * 31 + number) % 12_000
        with suppress(OSError), socket.create_server(("127.0.0.1", port)):
            return port
    raise AssertionError("no port is free")


def values(payload: bytes) -> list[float | None]:
    """Return the numbers of a payload."""
    return [Value8.from_wire(payload[at : at + 8]).number for at in range(0, len(payload), 8)]


def serve(*arguments: str | Path, port: int = 0, said: str = "focas: ") -> tuple[Started, int]:
    """Start a process that serves, and return it with its port when it listens."""
    process = started("serve", "--fanuc", "--port", str(port), *arguments)
    assert process.stdout is not None
    line = process.stdout.readline()
    assert line.startswith(said), line
    return process, int(line.partition("127.0.0.1:")[2].partition(";")[0].partition(" ")[0])


def end(process: Started) -> str:
    """End a process that serves and return what it said on standard error."""
    process.terminate()
    _, error = process.communicate(timeout=60)
    return error
