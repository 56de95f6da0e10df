"""Keep the values of a machine's nodes at what its status says; only what has changed is written."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC
from typing import Any

from asyncua import ua
from asyncua.server.address_space import AddressSpace

from polycnc.cnc import Control, Status
from polycnc.servers.machines import ServedMachine
from polycnc.servers.opcua._alarms import AlarmEvents
from polycnc.servers.opcua._cnc import POSITION
from polycnc.servers.opcua._model import Member
from polycnc.servers.opcua._moment import At, Fixed
from polycnc.servers.opcua._space import NOT_SUPPORTED, Bound, Position, data_of
from polycnc.servers.plant import Seen, see

_NONE = object()
_VALUE = ua.AttributeIds.Value


class Publisher:
    """One machine's nodes in both views, and its alarms as events."""

    def __init__(
        self,
        machine: ServedMachine,
        fixed: Fixed,
        bound: Sequence[Bound],
        space: AddressSpace,
        index: dict[str, int],
        alarms: AlarmEvents,
    ) -> None:
        self.machine = machine
        self.fixed = fixed
        self._bound = [(each, data_of(each.member, index)[0]) for each in bound]
        self._space = space
        self._alarms = alarms
        self._last: Status | None = None
        self._values: list[Any] = [_NONE] * len(self._bound)
        self._see = see(self._control)

    async def refresh(self) -> None:
        """Write what has changed since the last time; the values are those of one cycle.

        Raises:
            MachineError: The machine's time cannot pass any more.
        """
        await self._publish(*await self.machine.ask(self._read))

    async def begin(self) -> None:
        """Write everything for the first time; no machine time passes."""
        await self._publish(*self._read())

    def at(self, number: int, name: str) -> At:
        """Return the present cycle, for a channel or axis."""
        return At(self._see(), self.fixed, number, name)

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
        moments: dict[tuple[int, str], At] = {}
        for number, (each, variant) in enumerate(self._bound):
            item = each.item
            key = item.channel, item.about
            if (at := moments.get(key)) is None:
                at = moments[key] = At(seen, self.fixed, *key)
            value = None if each.member.read is None else each.member.read(at)
            if value != self._values[number]:
                self._values[number] = value
                await self._write(each, variant, value, time)
        await self._alarms.follow(status, seen.inventory.alarms, revision)

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
        return ua.DataValue(ua.Variant(None), NOT_SUPPORTED, SourceTimestamp=time)
    return ua.DataValue(ua.Variant(value, variant), SourceTimestamp=time)
