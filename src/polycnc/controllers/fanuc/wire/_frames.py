"""Frames of the FOCAS Ethernet protocol: ten bytes of header, then a body; big endian throughout."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass
from enum import IntEnum

from polycnc.errors import ProtocolError

SYNC = b"\xa0\xa0\xa0\xa0"
CLIENT_VERSION = 1
"""What every client writes into the version field."""

_HEADER = struct.Struct(">4sHHH")
_STATUS = struct.Struct(">HhHH")
HEADER_SIZE = _HEADER.size


class FrameType(IntEnum):
    """What a frame is: function group in the high byte, direction in the low one.

    Directions: 1 request, 2 reply, 3 status, 4 data without a reply.
    """

    OPEN = 0x0101
    OPENED = 0x0102
    OPEN_REFUSED = 0x0103
    CLOSE = 0x0201
    CLOSED = 0x0202
    DOWNLOAD_START = 0x1101
    DOWNLOAD_STARTED = 0x1102
    DOWNLOAD_START_STATUS = 0x1103
    DOWNLOAD_DATA = 0x1204
    DOWNLOAD_END = 0x1301
    DOWNLOAD_ENDED = 0x1302
    DOWNLOAD_END_STATUS = 0x1303
    UPLOAD_START = 0x1501
    UPLOAD_STARTED = 0x1502
    UPLOAD_START_STATUS = 0x1503
    UPLOAD_DATA = 0x1604
    UPLOAD_FINISHED = 0x1701
    UPLOAD_ACKNOWLEDGED = 0x1702
    UPLOAD_MORE = 0x1804
    UPLOAD_END = 0x1901
    UPLOAD_END_STATUS = 0x1903
    COMMANDS = 0x2101
    ANSWERS = 0x2102
    COMMANDS_REFUSED = 0x2103


_NAMES = {int(kind): kind.name for kind in FrameType}


@dataclass(frozen=True, slots=True)
class Frame:
    """Hold one frame; `bytes(frame)` is what goes over the wire.

    `type` is a number, since a peer may send one that `FrameType` does not know.
    """

    type: int
    body: bytes = b""
    version: int = CLIENT_VERSION

    def __bytes__(self) -> bytes:
        return _HEADER.pack(SYNC, self.version, self.type, len(self.body)) + self.body

    @property
    def name(self) -> str:
        """The name of the frame's type, or its number."""
        return _NAMES.get(self.type, f"0x{self.type:04X}")


class FrameReader:
    """Collect bytes as they come and return whole frames; a body has at most `most_body` bytes."""

    def __init__(self, most_body: int = 0xFFFF) -> None:
        self._most_body = most_body
        self._bytes = bytearray()

    def feed(self, data: bytes) -> Iterator[Frame]:
        """Add bytes and return the frames that are complete, each when it is asked for.

        Raises:
            ProtocolError: the bytes are no frame; the stream cannot be found again.
        """
        self._bytes += data
        return self._frames()

    def _frames(self) -> Iterator[Frame]:
        while len(self._bytes) >= HEADER_SIZE:
            sync, version, kind, size = _HEADER.unpack_from(self._bytes)
            if sync != SYNC:
                raise ProtocolError(
                    f"a frame begins with {sync.hex(' ')}, not with {SYNC.hex(' ')}",
                    hint="Something that does not speak FOCAS is connected, or bytes were lost.",
                )
            if size > self._most_body:
                raise ProtocolError(
                    f"a frame announces {size} bytes, more than {self._most_body}",
                    hint="Cut the request into smaller ones.",
                )
            if len(self._bytes) < HEADER_SIZE + size:
                return
            body = bytes(self._bytes[HEADER_SIZE : HEADER_SIZE + size])
            del self._bytes[: HEADER_SIZE + size]
            yield Frame(kind, body, version)
        if not SYNC.startswith(self._bytes[: len(SYNC)]):
            raise ProtocolError(
                f"a frame begins with {self._bytes[:4].hex(' ')}, not with {SYNC.hex(' ')}",
                hint="Something that does not speak FOCAS is connected, or bytes were lost.",
            )

    @property
    def pending(self) -> int:
        """How many bytes of a frame that is not complete yet are held."""
        return len(self._bytes)


def status_body(code: int, detail: int = 0, number: int = 0) -> bytes:
    """Return the 8 bytes of a status frame: return code, its detail, the data number it is about."""
    return _STATUS.pack(0, code, detail, number)


def read_status(body: bytes) -> tuple[int, int, int]:
    """Return code, detail and data number of a status frame's body.

    Raises:
        ProtocolError: the body has not 8 bytes.
    """
    if len(body) != _STATUS.size:
        raise ProtocolError(f"a status has {len(body)} bytes, not {_STATUS.size}")
    _, code, detail, number = _STATUS.unpack(body)
    return code, detail, number
