"""Command blocks: what a command frame asks, and what its answer says, block for block in the same order."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from dataclasses import dataclass

from polycnc.errors import ProtocolError

CNC, PMC = 1, 2
"""Targets of a command."""

_COUNT = struct.Struct(">H")
_REQUEST = struct.Struct(">HHHHiiiiHH")
_REPLY = struct.Struct(">HHHHhHHH")
REQUEST_SIZE = _REQUEST.size
REPLY_SIZE = _REPLY.size


@dataclass(frozen=True, slots=True)
class Request:
    """Hold one command: target, path (from 1), command code, four numbers, and data if there are any.

    `tag` says what the data are; only parameter and diagnosis information is known to use it.
    """

    command: int
    arguments: tuple[int, int, int, int] = (0, 0, 0, 0)
    data: bytes = b""
    target: int = CNC
    path: int = 1
    tag: int = 0

    def __bytes__(self) -> bytes:
        size = REQUEST_SIZE + len(self.data)
        head = (size, self.target, self.path, self.command)
        return _REQUEST.pack(*head, *self.arguments, self.tag, len(self.data)) + self.data


@dataclass(frozen=True, slots=True)
class Reply:
    """Hold the answer to one command: a return code with two details, and the payload."""

    payload: bytes = b""
    status: int = 0
    detail: int = 0
    detail2: int = 0

    def to_wire(self, request: Request) -> bytes:
        """Return the block that answers `request`, whose target, path and command it repeats."""
        echo = (REPLY_SIZE + len(self.payload), request.target, request.path, request.command)
        return _REPLY.pack(*echo, self.status, self.detail, self.detail2, len(self.payload)) + self.payload


def read_requests(body: bytes) -> list[Request]:
    """Return the commands of a frame.

    Raises:
        ProtocolError: count and lengths do not fit the bytes.
    """
    requests = []
    for block in _blocks(body, REQUEST_SIZE):
        _, target, path, command, *rest = _REQUEST.unpack_from(block)
        first, second, third, fourth, tag, attached = rest
        data = block[REQUEST_SIZE:]
        if attached != len(data) and not (tag and not data):
            raise ProtocolError(
                f"command 0x{command:02X} announces {attached} bytes of data and brings {len(data)}"
            )
        requests.append(Request(command, (first, second, third, fourth), data, target, path, tag))
    return requests


def write_requests(requests: Sequence[Request]) -> bytes:
    """Return the body of a frame of commands."""
    return _COUNT.pack(len(requests)) + b"".join(map(bytes, requests))


def write_replies(requests: Sequence[Request], replies: Sequence[Reply]) -> bytes:
    """Return the body of the frame that answers `requests`, one block for each."""
    pairs = zip(requests, replies, strict=True)
    return _COUNT.pack(len(requests)) + b"".join(reply.to_wire(request) for request, reply in pairs)


def read_replies(body: bytes) -> list[tuple[Request, Reply]]:
    """Return the answers of a frame, each with the target, path and command that it repeats.

    Raises:
        ProtocolError: count and lengths do not fit the bytes.
    """
    replies = []
    for block in _blocks(body, REPLY_SIZE):
        _, target, path, command, status, detail, detail2, size = _REPLY.unpack_from(block)
        payload = block[REPLY_SIZE:]
        if size != len(payload):
            raise ProtocolError(f"answer 0x{command:02X} announces {size} bytes and brings {len(payload)}")
        replies.append((Request(command, target=target, path=path), Reply(payload, status, detail, detail2)))
    return replies


def _blocks(body: bytes, least: int) -> list[bytes]:
    """Cut a body into its blocks; each begins with its own length."""
    if len(body) < _COUNT.size:
        raise ProtocolError(f"a body of {len(body)} bytes has no count of blocks")
    (count,) = _COUNT.unpack_from(body)
    at = _COUNT.size
    blocks: list[bytes] = []
    for _ in range(count):
        size = _COUNT.unpack_from(body, at)[0] if len(body) >= at + _COUNT.size else 0
        if size < least or at + size > len(body):
            raise ProtocolError(
                f"block {len(blocks) + 1} of {count} has {size} bytes, {len(body) - at} are left"
            )
        blocks.append(body[at : at + size])
        at += size
    if at != len(body):
        raise ProtocolError(f"{len(body) - at} bytes follow the last of {count} blocks")
    return blocks
