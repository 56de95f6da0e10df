"""Keep the values of a machine's nodes at what its status says; only what has changed is written."""

from __future__ import annotations

import asyncio
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC
from typing import Any

from asyncua import ua
from asyncua.server.address_space import AddressSpace

from polycnc.cnc import Control, Status
from polycnc.servers.machines import ServedMachine
from polycnc.servers.opcua._alarms import AlarmEvents
from polycnc.servers.opcua._cnc import POSITION
from polycnc.servers.opcua._lists import Lists
from polycnc.servers.opcua._model import Member
from polycnc.servers.opcua._moment import At, Fixed
from polycnc.servers.opcua._space import NOT_SUPPORTED, Bound, Position, data_of
from polycnc.servers.plant import Seen, see

_NONE = object()
_VALUE = ua.AttributeIds.Value
_GOOD = ua.StatusCode()


class _Unchanging(ua.DataValue):
    """A value that nothing changes: monitored items keep it as it is instead of copying all its parts."""

    def __deepcopy__(self, memo: dict[int, Any]) -> _Unchanging:
        return self


@dataclass(slots=True)
class _Shown:
    """A member, how its values are sent, and the one that its node has."""

    bound: Bound
    variant: ua.VariantType
    value: Any = _NONE


class Publisher:
    """One machine's nodes in both views, and its alarms as events."""

    def __init__(
        self,
        machine: ServedMachine,
        fixed: Fixed,
        bound: Sequence[Bound],
        space: AddressSpace,
        index: dict[str, int],
        lists: Lists,
        alarms: AlarmEvents,
    ) -> None:
        self.machine = machine
        self.fixed = fixed
        self._index = index
        self._shown: dict[ua.NodeId, _Shown] = {}
        self._show(bound)
        self._lists = lists
        self._space = space
        self._alarms = alarms
        self._last: Status | None = None
        self._see = see(self._control)
        self._turn = asyncio.Lock()

    async def refresh(self) -> None:
        """Write what has changed since the last time; the values are those of one cycle, none older than those before.

        Raises:
            MachineError: The machine's time cannot pass any more.
        """
        async with self._turn:
            await self._publish(*await self.machine.ask(self._read))

    async def begin(self) -> None:
        """Write everything for the first time; no machine time passes."""
        await self._publish(*self._read())

    def at(self, number: int, name: str) -> At:
        """Return the present cycle, for a channel or axis."""
        return At(self._see(), self.fixed, number, name, self._lists.versions)

    def _control(self) -> Control:
        control = self.machine.control
        assert control is not None
        return control

    def _read(self) -> tuple[Seen, int]:
        return self._see(), self._control().alarms.revision

    async def _publish(self, seen: Seen, revision: int) -> None:
        status = seen.status
        if status is self._last:
            return
        self._last = status
        time = status.now.replace(tzinfo=UTC)
        gone, come = await self._lists.follow(seen)
        for node in gone:
            self._shown.pop(node, None)
        self._show(come)
        moments: dict[tuple[int, str], At] = {}
        for shown in list(self._shown.values()):
            each, item = shown.bound, shown.bound.item
            key = item.channel, item.about
            if (at := moments.get(key)) is None:
                at = moments[key] = At(seen, self.fixed, *key, self._lists.versions)
            value = None if each.member.read is None else each.member.read(at)
            if value != shown.value and each.node in self._space:
                shown.value = value
                await self._write(each, shown.variant, value, time)
        await self._lists.tell(time)
        await self._alarms.follow(status, seen.inventory.alarms, revision)

    def _show(self, bound: Sequence[Bound]) -> None:
        self._shown |= {each.node: _Shown(each, data_of(each.member, self._index)[0]) for each in bound}

    async def _write(self, bound: Bound, variant: ua.VariantType, value: Any, time: Any) -> None:
        await self._space.write_attribute_value(
            bound.node, _VALUE, _data_value(bound.member, variant, value, time)
        )
        for at, node in enumerate(bound.parts):
            part = None if value is None else value[at]
            await self._space.write_attribute_value(node, _VALUE, _plain(part, ua.VariantType.Double, time))


def _data_value(member: Member, variant: ua.VariantType, value: Any, time: Any) -> ua.DataValue:
    if value is not None and member.data == POSITION:
        value = Position(*value)
    elif value is not None and member.data == "LocalizedText":
        value = ua.LocalizedText(value)
    return _plain(value, variant, time)


def _plain(value: Any, variant: ua.VariantType, time: Any) -> ua.DataValue:
    if value is None:
        return _Unchanging(ua.Variant(None), NOT_SUPPORTED, SourceTimestamp=time)
    return _Unchanging(ua.Variant(value, variant), _GOOD, SourceTimestamp=time)
