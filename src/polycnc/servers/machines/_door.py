"""A door: what answers clients of one protocol, for one machine or for all of a process."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

from polycnc.servers.machines._log import Log
from polycnc.servers.machines._machine import OpenDoor, ServedMachine

LOOPBACK = "127.0.0.1"


class Door(OpenDoor, Protocol):
    """Answer clients of a protocol, in the running event loop, from `start` to `close`."""

    async def start(self) -> None:
        """Listen.

        Raises:
            UsageError: Something else is there; nothing is open.
        """

    async def close(self) -> None:
        """Stop listening and end every connection."""


@dataclass(frozen=True, slots=True)
class Wanted:
    """What is wanted of a door: `port` None is the usual one, 0 a free one; `path` is that of a terminal, "" for none.

    `token` is what clients of a protocol that knows one have to show, None if it is open. `keep` is a folder in which
    the door may keep what has to outlive the process (a certificate), `node_sets` one of files that the door reads;
    None where there is none.
    """

    address: str = LOOPBACK
    port: int | None = None
    path: str = ""
    token: str | None = None
    log: Log = field(default_factory=Log)
    keep: Path | None = None
    node_sets: Path | None = None


@dataclass(frozen=True, slots=True)
class DoorKind:
    """A row of the table of doors.

    `controllers` are the kinds of machines that it can serve, empty: all. `open_door` makes the door, which listens
    once it is started. A `shared` one answers for all machines of the process, another one for a single machine.
    `knows_token`: its protocol has a place for a secret. `commands`: its clients can do something to the machine.
    `lasts` says why opening it takes seconds, if it does.
    """

    name: str
    port: int
    open_door: Callable[[Sequence[ServedMachine], Wanted], Door]
    controllers: frozenset[str] = frozenset()
    shared: bool = False
    knows_token: bool = False
    commands: bool = True
    lasts: str = ""

    def serves(self, machine: ServedMachine) -> bool:
        """Tell whether it can answer for a machine."""
        return not self.controllers or machine.kind in self.controllers
