"""Answer the frames of a C library without a connection, for machines whose time passes by the program's own calls."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from polycnc.errors import UsageError
from polycnc.machine import Poll
from polycnc.servers.calls import LIBRARIES, CallClient, Caller
from polycnc.servers.process import KINDS, Machinery
from polycnc.servers.setup import Flags, plan_of

FILE = "POLYCNC_SERVED"
"""The variable of the environment that names a file of `polycnc serve`."""
_POLL = Poll(1)


class Inside:
    """Clients of one library, by number, and the machines that they reach.

    Time passes only where a program reads the same again in the same cycle, one cycle each time.
    """

    def __init__(self, name: str, devices: Sequence[Any]) -> None:
        self._kind = next((kind for kind, each in LIBRARIES.items() if each.load().name == name), "")
        self.devices = devices
        self._clients: dict[int, CallClient] = {}

    def receive(self, client: int, data: bytes) -> bytes:
        """Carry out what a client sends; nothing comes back to one that has been ended."""
        found = self._clients.get(client)
        if found is None:
            found = self._clients[client] = CallClient(self._find)
        return found.receive(data)

    def shut(self, client: int) -> None:
        """Forget a client, and let go what it has open."""
        found = self._clients.pop(client, None)
        if found is not None and found.caller is not None:
            found.caller.session.detach()

    def _find(self, name: str, packing: int) -> Caller | None:
        if not self.devices:
            return None
        served = LIBRARIES[self._kind]
        library = served.load()
        if library.name != name:
            return None
        return served.make(library.packed(packing) or library, self.devices, _POLL)


def inside(name: str) -> Inside:
    """Return what answers the library of a name: the machines of its kind in the file `POLYCNC_SERVED`, else one.

    Raises:
        UsageError: There is no such library, or the file cannot be served.
    """
    kind = next((kind for kind, each in LIBRARIES.items() if each.load().name == name), None)
    if kind is None:
        raise UsageError(f"there is no C library '{name[:40]}'", hint="Build it with polycnc clib.")
    file = os.environ.get(FILE)
    wanted = [Machinery()]
    if file:
        plan = plan_of(Flags(file=Path(file), kinds={}))
        wanted = [each.machinery for each in plan.machines if each.kind == kind]
    devices = [KINDS[kind](each).device for each in wanted]
    for each in devices:
        each.advance(1)  # as served machines begin
    return Inside(name, devices)
