"""Alarms of a control as events: one when an alarm comes, one when it goes."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from datetime import UTC, datetime
from typing import Any

from asyncua import ua

from polycnc.cnc import AlarmKind, PastAlarm, Status

SEVERITIES = {
    AlarmKind.EMERGENCY: 1000, AlarmKind.SYSTEM: 900, AlarmKind.SERVO: 800, AlarmKind.SPINDLE: 800,
    AlarmKind.TRAVEL: 700, AlarmKind.PLC: 600, AlarmKind.PROGRAM: 500,
}  # fmt: skip
_Key = tuple[int, str, str | None]


class AlarmEvents:
    """Send the alarms of a machine.

    `kinds` are events to be filled in, each with the name of its field for the number and the objects that emit it.
    """

    def __init__(
        self,
        subscriptions: Any,
        kinds: Sequence[tuple[Any, str, tuple[ua.NodeId, ...]]],
        machine: str,
        interface: ua.NodeId,
    ) -> None:
        self._subscriptions = subscriptions
        self._kinds = kinds
        self._machine = machine
        self._interface = interface
        self._on: dict[_Key, AlarmKind] = {}
        self._revision: int | None = None
        self._count = 0

    async def follow(self, status: Status, past: Sequence[PastAlarm], revision: int) -> None:
        """Tell what came and went since the last time; what came and went between is reported, too."""
        time = status.now.replace(tzinfo=UTC)
        now = {(each.number, each.text, each.axis): each.kind for each in status.alarms}
        news = 0 if self._revision is None else revision - self._revision
        self._revision = revision
        short = [
            each for each in past[max(0, len(past) - news) :] if news > 0
            and (each.number, each.text, each.axis) not in now
            and (each.number, each.text, each.axis) not in self._on
        ]  # fmt: skip
        for key, kind in now.items():
            if key not in self._on:
                await self._send(key, kind, True, time)
        for each in short:
            key = each.number, each.text, each.axis
            await self._send(key, each.kind, True, time)
            await self._send(key, each.kind, False, time)
        for key, kind in self._on.items():
            if key not in now:
                await self._send(key, kind, False, time)
        self._on = now

    async def _send(self, key: _Key, kind: AlarmKind, on: bool, time: datetime) -> None:
        number, text, axis = key
        self._count += 1
        for template, number_field, emitters in self._kinds:
            condition = f"{self._machine}/{number_field}/{number}/{axis or ''}"
            values = {
                "EventId": f"{self._machine}:{self._count}".encode(),
                "Time": time,
                "ReceiveTime": datetime.now(UTC),
                "SourceNode": self._interface,
                "SourceName": axis or self._machine,
                "Message": ua.LocalizedText(text),
                "Severity": SEVERITIES[kind],
                "ConditionName": f"{kind.value} {number}",
                "NodeId": ua.NodeId(condition, 1),
                "Retain": on,
                "ActiveState": ua.LocalizedText("Active" if on else "Inactive"),
                "ActiveState/Id": on,
                "EnabledState": ua.LocalizedText("Enabled"),
                "EnabledState/Id": True,
                "AckedState": ua.LocalizedText("Acknowledged"),
                "AckedState/Id": True,
                "Quality": ua.StatusCode(),
                number_field: str(number),
            }
            event = copy.copy(template)
            for name, value in values.items():
                if name in event.data_types:
                    setattr(event, name, value)
            for emitter in emitters:
                emitted = copy.copy(event)
                emitted.emitting_node = emitter
                await self._subscriptions.trigger_event(emitted)
