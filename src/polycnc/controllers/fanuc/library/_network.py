"""The nodes that the library reaches, its handles, and how time passes by calls."""

from __future__ import annotations

import threading
from collections.abc import Hashable
from dataclasses import dataclass

from polycnc.controllers.fanuc.device._power_mate import PowerMate
from polycnc.controllers.fanuc.device._transfer import Upload
from polycnc.controllers.fanuc.library._codes import EW
from polycnc.controllers.fanuc.library._remote import RemoteLink, reached
from polycnc.controllers.fanuc.wire import Client
from polycnc.controllers.library import Handles, Refused
from polycnc.controllers.library import Session as AnySession
from polycnc.errors import UsageError
from polycnc.machine import Polling, Way

NODES = range(8)
DEFAULT_NODE = 0


@dataclass(eq=False, slots=True)
class Node:
    """A control on the bus; `fault` is a code that calls answer instead of reaching it, for tests of programs."""

    number: int
    device: PowerMate
    polling: Polling
    clock: Way | None
    fault: EW = EW.EW_OK


@dataclass(eq=False, slots=True)
class Link:
    """What a handle stands for: a node, and what belongs to this handle alone."""

    node: Node
    upload: Upload | None = None
    macro_type: int = 0

    @property
    def device(self) -> PowerMate:
        """The control."""
        return self.node.device

    def read(self, *thing: Hashable) -> PowerMate:
        """Return the control for a call that reads `thing`; time passes before it if that is read again."""
        self.node.polling.read(self.node.device, thing)
        return self.node.device

    def command(self) -> PowerMate:
        """Return the control for a call that reads nothing."""
        self.node.polling.call(self.node.device)
        return self.node.device

    def reach(self) -> None:
        """Look whether the control answers: before anything else, as what is wrong with a call is for it to say.

        Raises:
            Refused: The node has a fault.
        """
        if self.node.fault is not EW.EW_OK:
            raise Refused(self.node.fault)
        if self.upload is not None and self.upload.power_ups != self.device.power_ups:
            self.upload = None


_LOCK = threading.RLock()


class Session(AnySession):
    """A program that has loaded the library; calls of all programs are carried out one at a time.

    Several programs may have the same control on their bus, so a lock for each would not do.
    """

    def __init__(self) -> None:
        super().__init__()
        self.lock = _LOCK
        self.nodes: dict[int, Node] = {}
        self.default_node = DEFAULT_NODE
        self.open: Handles[Link | RemoteLink] = Handles(EW.EW_HANDLE, 1, 0xFFFF)

    def attach(self, node: int, device: PowerMate, clock: Way | None = None) -> Node:
        """Put a control on the bus as node 0 to 7; one that is there is taken away with its handles.

        `clock` says how calls that read let time pass: `Poll(1)` one cycle when a program reads the same again. With
        None only `PowerMate.advance` does. Controls with the same clock are kept in step.

        Raises:
            UsageError: There is no such node.
        """
        if node not in NODES:
            raise UsageError(f"there is no node {node}", hint="Nodes are 0 to 7.")
        with self.lock:
            self.detach(node)
            polling = next(
                (each.polling for each in self.nodes.values() if clock is not None and each.clock == clock),
                None,
            )
            if polling is None:
                polling = Polling(
                    clock, lambda: [each.device for each in self.nodes.values() if each.clock == clock]
                )
            self.nodes[node] = made = Node(node, device, polling, clock)
        return made

    def detach(self, node: int | None = None) -> None:
        """Take a control off the bus, or all (None); its handles are of no more use."""
        with self.lock:
            for number in [number for number in self.nodes if node is None or number == node]:
                gone = self.nodes.pop(number)
                for handle, link in self.open.items():
                    if isinstance(link, Link) and link.node is gone:
                        self.free(handle)
            if node is None:
                self.default_node = DEFAULT_NODE

    def link(self, node: int) -> int:
        """Return a new handle of a node.

        Raises:
            Refused: There is no such node, nothing is there, or it has a fault.
        """
        if node not in NODES:
            raise Refused(EW.EW_NUMBER)
        there = self.nodes.get(node)
        if there is None:
            raise Refused(EW.EW_HSSB)
        if there.fault is not EW.EW_OK:
            raise Refused(there.fault)
        return self.open.add(Link(there))

    def connect(self, host: str, port: int, timeout_s: float | None) -> int:
        """Return a new handle of a control on the network.

        Raises:
            Refused: It is not there, takes no more sessions, or does not speak the protocol.
        """
        client = reached(lambda: Client(host, port, timeout_s))
        return self.open.add(RemoteLink(client))

    def find(self, handle: int) -> Link | RemoteLink:
        """Return what a handle stands for.

        Raises:
            Refused: It is none.
        """
        return self.open.find(handle)

    def free(self, handle: int) -> None:
        """Let a handle go; a download that it has begun is broken off.

        Raises:
            Refused: It is none.
        """
        link = self.open.free(handle)
        if isinstance(link, RemoteLink):
            link.client.close()
            return
        transfer = link.device.transfer
        if transfer is not None and transfer.owner is link:
            link.device.transfer = None
