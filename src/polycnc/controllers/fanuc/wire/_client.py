"""A client of a FOCAS server: one connection for commands, another while a program is transferred."""

from __future__ import annotations

import socket
from collections.abc import Sequence

from polycnc.controllers.fanuc.wire._blocks import Reply, Request, read_replies, write_requests
from polycnc.controllers.fanuc.wire._frames import Frame, FrameReader, FrameType, read_status
from polycnc.errors import ProtocolError

_TRANSFER, _COMMANDS = 1, 2
_NO_PROGRAM = 5
_NAME_SIZE = 512
_MOST_RECEIVED = 65536
_PIECE = 1024
_STATUSES = {
    FrameType.OPEN_REFUSED,
    FrameType.COMMANDS_REFUSED,
    FrameType.DOWNLOAD_START_STATUS,
    FrameType.DOWNLOAD_END_STATUS,
    FrameType.UPLOAD_START_STATUS,
}


class WireRefusedError(Exception):
    """A frame that a control has answered with a code instead of data."""

    def __init__(self, code: int, detail: int = 0) -> None:
        super().__init__(f"code {code}, detail {detail}")
        self.code, self.detail = code, detail


class Connection:
    """One connection, opened for commands or for transfers.

    Raises:
        OSError: Nobody answers in time.
        ProtocolError: Who answers does not speak the protocol.
        WireRefusedError: The control takes no more sessions.
    """

    def __init__(self, host: str, port: int, timeout_s: float | None, channel: int) -> None:
        self._socket = socket.create_connection((host, port), timeout_s)
        try:
            self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self._reader = FrameReader()
            self._frames: list[Frame] = []
            self.exchange(FrameType.OPEN, channel.to_bytes(2, "big"), FrameType.OPENED)
        except BaseException:
            self._socket.close()
            raise

    def send(self, kind: FrameType, body: bytes = b"") -> None:
        """Send a frame."""
        self._socket.sendall(bytes(Frame(kind, body)))

    def receive(self) -> Frame:
        """Return the next frame; a status is raised.

        Raises:
            OSError: The connection is lost, or nothing comes in time.
            ProtocolError: It is no frame.
            WireRefusedError: It is a status.
        """
        while not self._frames:
            data = self._socket.recv(_MOST_RECEIVED)
            if not data:
                raise ConnectionResetError("the control has closed the connection")
            self._frames += self._reader.feed(data)
        frame = self._frames.pop(0)
        if frame.type in _STATUSES:
            code, detail, _ = read_status(frame.body)
            raise WireRefusedError(code, detail)
        return frame

    def exchange(self, kind: FrameType, body: bytes, expected: FrameType) -> Frame:
        """Send a frame and return the one that answers it; see `receive`."""
        self.send(kind, body)
        frame = self.receive()
        if frame.type != expected:
            raise ProtocolError(f"{frame.name} came where {expected.name} was expected")
        return frame

    def close(self) -> None:
        """Say good-bye and close, as far as the peer still listens."""
        try:
            self.exchange(FrameType.CLOSE, b"", FrameType.CLOSED)
        except (OSError, ProtocolError, WireRefusedError):
            pass
        finally:
            self._socket.close()


class Client:
    """Ask a control over the network; `timeout_s` is how long it may take to answer, None for ever.

    Raises:
        OSError: As `Connection`, so for `ProtocolError` and `WireRefusedError`.
    """

    def __init__(self, host: str, port: int, timeout_s: float | None) -> None:
        self._place = host, port, timeout_s
        self._commands = Connection(host, port, timeout_s, _COMMANDS)

    def ask(self, requests: Sequence[Request]) -> list[Reply]:
        """Return the answers to commands, which are carried out in one cycle of the control.

        Raises:
            OSError: The connection is lost.
            ProtocolError: The answers do not fit the commands.
            WireRefusedError: The control refuses them all.
        """
        frame = self._commands.exchange(FrameType.COMMANDS, write_requests(requests), FrameType.ANSWERS)
        answers = read_replies(frame.body)
        asked = [(each.target, each.command) for each in requests]
        if [(each.target, each.command) for each, _ in answers] != asked:
            raise ProtocolError("the answers do not fit the commands")
        return [reply for _, reply in answers]

    def upload(self, name: str) -> bytes:
        """Return the text of a program; errors as for `ask`."""
        connection = Connection(*self._place, _TRANSFER)
        try:
            frame = connection.exchange(FrameType.UPLOAD_START, _start(name), FrameType.UPLOAD_STARTED)
            if len(frame.body) == 4:
                raise WireRefusedError(int.from_bytes(frame.body[2:], "big", signed=True))
            text = bytearray()
            while (frame := connection.receive()).type == FrameType.UPLOAD_DATA:
                text += frame.body
            if frame.type != FrameType.UPLOAD_FINISHED:
                raise ProtocolError(f"{frame.name} came within a program")
            connection.send(FrameType.UPLOAD_ACKNOWLEDGED)
            if not text:  # as old series say that there is no such program
                raise WireRefusedError(_NO_PROGRAM)
            return bytes(text)
        finally:
            connection.close()

    def download(self, text: bytes) -> None:
        """Send a program, from its first line feed to the last %; errors as for `ask`."""
        connection = Connection(*self._place, _TRANSFER)
        try:
            connection.exchange(FrameType.DOWNLOAD_START, _start(""), FrameType.DOWNLOAD_STARTED)
            for at in range(0, len(text), _PIECE):
                connection.send(FrameType.DOWNLOAD_DATA, text[at : at + _PIECE])
            connection.exchange(FrameType.DOWNLOAD_END, b"", FrameType.DOWNLOAD_ENDED)
        finally:
            connection.close()

    def close(self) -> None:
        """Give up the connection."""
        self._commands.close()


def _start(name: str) -> bytes:
    return b"\0\0\0\1" + name.encode("latin-1").ljust(_NAME_SIZE, b"\0")
