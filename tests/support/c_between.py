"""A connection with somebody in between, who spoils what the server answers."""

from __future__ import annotations

import socket
import threading
from collections.abc import Callable
from contextlib import suppress

_WELCOME = 12


class Between:
    """Take clients to a door, and its answers back, each through `spoil`; what has None ends the connection."""

    def __init__(self, place: str) -> None:
        self.spoil: Callable[[bytes], bytes | None] = lambda answer: answer
        self.is_last = False  # the connection ends behind the next answer
        host, _, port = place.rpartition(":")
        self._to = (host, int(port))
        self._server = socket.create_server(("127.0.0.1", 0))
        self.place = f"127.0.0.1:{self._server.getsockname()[1]}"
        threading.Thread(target=self._serve, daemon=True).start()

    def _serve(self) -> None:
        with suppress(OSError):
            while True:
                client, _ = self._server.accept()
                threading.Thread(target=self._carry, args=(client,), daemon=True).start()

    def _carry(self, client: socket.socket) -> None:
        with suppress(OSError), client, socket.create_connection(self._to) as server:
            for line in (client, server):
                line.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            server.sendall(client.recv(60, socket.MSG_WAITALL))
            client.sendall(server.recv(_WELCOME, socket.MSG_WAITALL))
            while call := client.recv(70_000):
                server.sendall(call)
                answer = self.spoil(_whole(server))
                if answer is not None:
                    client.sendall(answer)
                if answer is None or self.is_last:
                    return

    def close(self) -> None:
        """Take no client any more."""
        self._server.close()


def _whole(server: socket.socket) -> bytes:
    head = server.recv(4, socket.MSG_WAITALL)
    return head + server.recv(int.from_bytes(head, "little"), socket.MSG_WAITALL)
