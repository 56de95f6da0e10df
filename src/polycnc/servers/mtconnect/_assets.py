"""Cutting tools as assets: those of the tool table, and those that were in it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from polycnc.cnc import Tool
from polycnc.servers.mtconnect._device import plain_text
from polycnc.servers.plant import asset_id

MOST_ASSETS = 4096
CUTTING_TOOL = "CuttingTool"


@dataclass(frozen=True, slots=True)
class Asset:
    """A tool as it was at a time of its machine (ISO, UTC)."""

    id: str
    number: int
    tool: Tool
    device_uuid: str
    time: str
    removed: bool = False

    @property
    def description(self) -> str:
        """What the tool table says of it."""
        return plain_text(self.tool.description)


class Assets:
    """The tools of one machine, the one that changed last at the end; the oldest are dropped beyond `most`."""

    def __init__(self, device: str, uuid: str, most: int = MOST_ASSETS) -> None:
        self._device = device
        self._uuid = uuid
        self._most = most
        self.tools: Mapping[int, Tool] = {}
        """The tool table that was last taken over."""
        self._known: dict[str, Asset] = {}

    def update(self, tools: Mapping[int, Tool], time: str) -> tuple[list[Asset], list[Asset]]:
        """Take over a tool table; return what has changed or come, and what was removed."""
        if tools is self.tools:
            return [], []
        before, self.tools = self.tools, tools
        changed = [
            Asset(asset_id(self._device, number), number, tool, self._uuid, time)
            for number, tool in tools.items()
            if before.get(number) != tool
        ]
        removed = [
            replace(known, removed=True, time=time)
            for number in before
            if number not in tools and (known := self._known.get(asset_id(self._device, number)))
        ]
        for asset in (*changed, *removed):
            self._known.pop(asset.id, None)
            self._known[asset.id] = asset
        while len(self._known) > self._most:
            del self._known[next(iter(self._known))]
        return changed, removed

    def all(self, *, removed: bool = False) -> list[Asset]:
        """Return them, the newest first, with `removed` those too that are no longer in the table."""
        return [each for each in reversed(self._known.values()) if removed or not each.removed]

    def find(self, name: str) -> Asset | None:
        """Return one, None if there is none of this name."""
        return self._known.get(name)

    @property
    def count(self) -> int:
        """How many are in the table."""
        return sum(not each.removed for each in self._known.values())
