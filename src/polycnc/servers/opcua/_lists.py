"""The lists of a machine that objects come to and go from: jobs and tools, and the events that tell of it."""

from __future__ import annotations

import copy
from collections.abc import Awaitable, Callable, Sequence
from datetime import datetime
from typing import Any

from asyncua import ua

from polycnc.servers.opcua._model import Listing
from polycnc.servers.opcua._moment import Fixed
from polycnc.servers.opcua._space import Bound, Space
from polycnc.servers.opcua._tree import LISTINGS
from polycnc.servers.plant import Seen

_ADDED, _DELETED = 1, 2
_SERVER = ua.NodeId(2253)


class Lists:
    """The lists of one machine; `event` is a model change to be filled in, `send` sends it."""

    def __init__(
        self, space: Space, place: str, fixed: Fixed, event: Any, send: Callable[[Any], Awaitable[None]]
    ) -> None:
        self._space = space
        self._place = place
        self._fixed = fixed
        self._event = event
        event.data_types["Changes"] = (
            ua.VariantType.ExtensionObject
        )  # the library takes the type's node for it
        self._send = send
        self._there: dict[str, dict[str, list[Bound]]] = {listing.path: {} for listing in LISTINGS}
        self.versions: dict[str, int] = {listing.path: 0 for listing in LISTINGS}
        self._changes: list[tuple[ua.NodeId, ua.NodeId, int]] = []
        self._sent = 0
        self._seen: tuple[object, object] | None = None

    async def follow(self, seen: Seen) -> tuple[list[ua.NodeId], list[Bound]]:
        """Add and remove what has come and gone; return the nodes of members that are no more, and new members."""
        of = seen.inventory.tools, seen.status.channels[0].program
        if self._seen is not None and of[0] is self._seen[0] and of[1] == self._seen[1]:
            return [], []
        self._seen = of
        gone: list[ua.NodeId] = []
        come: list[Bound] = []
        for listing in LISTINGS:
            there, names = self._there[listing.path], listing.names(seen)
            if there.keys() == set(names):
                continue
            self.versions[listing.path] += 1
            wanted = set(names)
            for name in [each for each in there if each not in wanted]:
                gone += [each.node for each in there.pop(name)]
                node, of_type = self._object(listing, name)
                await self._space.remove(node)
                self._changes.append((node, of_type, _DELETED))
            for name in [each for each in names if each not in there]:
                made = self._space.add_items(self._place, ua.NodeId(), "", listing.items(name), self._fixed)
                there[name] = made
                come += made
                self._changes.append((*self._object(listing, name), _ADDED))
        return gone, come

    def _object(self, listing: Listing, name: str) -> tuple[ua.NodeId, ua.NodeId]:
        first = listing.items(name)[0]
        return self._space.at(self._place, first.path), self._space.node_of(first.type)

    async def tell(self, time: datetime) -> None:
        """Send one event of what has changed since the last time."""
        changes, self._changes = self._changes, []
        if not changes:
            return
        self._sent += 1
        event = copy.copy(self._event)
        event.EventId = f"{self._place}:{self._sent}".encode()
        event.Time = event.ReceiveTime = time
        event.SourceNode, event.SourceName, event.emitting_node = _SERVER, "Server", _SERVER
        event.Message = ua.LocalizedText(f"objects of {self._fixed.name} came or went")
        event.Changes = _structures(changes)
        await self._send(event)


def _structures(
    changes: Sequence[tuple[ua.NodeId, ua.NodeId, int]],
) -> list[ua.ModelChangeStructureDataType]:
    return [
        ua.ModelChangeStructureDataType(Affected=node, AffectedType=of_type, Verb=verb)
        for node, of_type, verb in changes
    ]
