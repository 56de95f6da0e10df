"""What has changed in a machine since it was last looked at, as changes of data items."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from polycnc.cnc import Inventory, Status
from polycnc.servers.mtconnect._assets import CUTTING_TOOL, Asset, Assets
from polycnc.servers.mtconnect._device import DeviceModel, Item, part_of, plain_text
from polycnc.servers.mtconnect._observations import FAULT, NORMAL, UNAVAILABLE
from polycnc.servers.plant import Place, Scope, Seen, Trouble, Value, troubles

_OWN = (Scope.AXIS, Scope.SPINDLE)


class Change(NamedTuple):
    """A data item has a value that it did not have; the fields are those of an observation."""

    item: Item
    value: str
    code: str = ""
    key: str = ""
    text: str = ""
    qualifier: str = ""
    kind: str = ""


class Looked(NamedTuple):
    """What came of a look: the machine's time (ISO, UTC), changes, and the tools that changed or went."""

    time: str
    changes: list[Change]
    tools: list[Asset]


def time_text(status: Status) -> str:
    """Return the machine's date and time, to the millisecond."""
    return status.now.isoformat(timespec="milliseconds") + "Z"


class _Group:
    """The items of one place, each with its number in the device; `part` is what they were read of last."""

    def __init__(self, place: Place) -> None:
        self.place = place
        self.part: object = None
        self.rows: list[tuple[int, Callable[[Seen, Any], Value]]] = []


_NEVER: Any = object()


class Recorder:
    """Look at one machine; the first look brings every data item."""

    def __init__(self, device: DeviceModel) -> None:
        self._device = device
        groups: dict[Place, _Group] = {}
        for number, item in enumerate(device.values):
            assert item.read is not None
            assert item.place is not None
            groups.setdefault(item.place, _Group(item.place)).rows.append((number, item.read))
        self._groups = tuple(groups.values())
        self._values: list[Value] = [_NEVER] * len(device.values)
        self._inventory: Inventory | None = None
        self._texts: dict[Item, str] = {}
        self._last: Status | None = None
        self._troubles: dict[str, Trouble] = {}
        self._messages: tuple[object, ...] = ()
        self.assets = Assets(device.name, device.uuid)

    def look(self, seen: Seen) -> Looked:
        """Return what has changed."""
        status = seen.status
        time = time_text(status)
        if status is self._last and seen.inventory.tools is self.assets.tools:
            return Looked(time, [], [])
        first, self._last = self._last is None, status
        changes = self._of_values(seen)
        if first:
            changes += [Change(item, NORMAL) for item in self._device.conditions.values()]
        changes += self._of_troubles(status)
        changes += self._of_messages(status, first)
        tools = self._of_tools(seen, time, first, changes)
        return Looked(time, changes, tools)

    def _of_values(self, seen: Seen) -> list[Change]:
        """Return the items whose text has changed, in the order of the device."""
        status, values = seen.status, self._values
        same_inventory = seen.inventory is self._inventory
        self._inventory = seen.inventory
        changed: list[int] = []
        for group in self._groups:
            of = part_of(group.place, status)
            if (
                group.place.scope in _OWN
            ):  # all of it is in one part: an axis at rest is not read item by item
                part = of or status.spindle
                if same_inventory and part == group.part:
                    continue
                group.part = part
            for number, read in group.rows:
                value = read(seen, of)
                if value != values[number]:
                    values[number] = value
                    changed.append(number)
        changes = []
        for number in sorted(changed):
            item = self._device.values[number]
            text = item.write(values[number]) or UNAVAILABLE
            if text != self._texts.get(item):
                self._texts[item] = text
                changes.append(Change(item, text))
        return changes

    def _of_troubles(self, status: Status) -> list[Change]:
        if not status.alarms and not self._troubles:
            return []
        now = {each.key: each for each in troubles(status)}
        if now == self._troubles:
            return []
        gone = [each for key, each in self._troubles.items() if key not in now]
        come = [each for key, each in now.items() if key not in self._troubles]
        self._troubles = now
        left = {self._item(each) for each in now.values()}
        changes = [Change(item, NORMAL) for item in dict.fromkeys(map(self._item, gone)) if item not in left]
        changes += [
            Change(self._item(each), NORMAL, each.code, each.key) for each in gone if self._item(each) in left
        ]
        changes += [
            Change(self._item(each), FAULT, each.code, each.key, plain_text(each.text), each.qualifier)
            for each in come
        ]
        return changes

    def _item(self, trouble: Trouble) -> Item:
        return self._device.conditions[trouble.about, trouble.axis, trouble.channel]

    def _of_messages(self, status: Status, first: bool) -> list[Change]:
        item = self._device.special.get("MESSAGE")
        before, self._messages = self._messages, status.messages
        if item is None or (status.messages == before and not first):
            return []
        new = [each for each in status.messages if each not in before]
        if not new and (first or not status.messages):
            return [Change(item, UNAVAILABLE)]
        return [Change(item, plain_text(each.text), str(each.number)) for each in new]

    def _of_tools(self, seen: Seen, time: str, first: bool, changes: list[Change]) -> list[Asset]:
        if not first and seen.inventory.tools is self.assets.tools:
            return []
        before = self.assets.count
        changed, removed = self.assets.update(seen.inventory.tools, time)
        special = self._device.special
        for kind, assets in (("ASSET_CHANGED", changed), ("ASSET_REMOVED", removed)):
            if (item := special.get(kind)) is None:
                continue
            if first:
                changes.append(Change(item, UNAVAILABLE, kind=CUTTING_TOOL))
            else:
                changes += [Change(item, each.id, kind=CUTTING_TOOL) for each in assets]
        item = special.get("ASSET_COUNT")
        if item is not None and (first or before != self.assets.count):
            changes.append(Change(item, str(self.assets.count)))
        return [*changed, *removed]
