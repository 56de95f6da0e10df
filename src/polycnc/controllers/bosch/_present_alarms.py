"""Alarms of the control among the errors that GETERR and the information window show (Manual 003, 4.13)."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from datetime import datetime

from polycnc.cnc import Alarm, AlarmKind
from polycnc.controllers.bosch.system import ALL_CHANNELS, Category, ErrorList, PresentError


class PresentAlarms:
    """Keep the errors of the alarms that are on; `numbers` are those that the manual gives to alarms by name."""

    def __init__(self, errors: ErrorList, numbers: dict[str, int]) -> None:
        self._errors = errors
        self._numbers = numbers
        self._noted: dict[Alarm, PresentError] = {}

    def note(self, alarms: Sequence[Alarm], known: Collection[tuple[str, int | None]], now: datetime) -> None:
        """Note alarms that have come, and forget those that have gone; `known` stop a run by themselves."""
        for gone in self._noted.keys() - set(alarms):
            error = self._noted.pop(gone)
            self._errors.errors = [each for each in self._errors.errors if each[:4] != error[:4]]
        for alarm in alarms:
            if (
                alarm in self._noted
                or alarm.kind is AlarmKind.PROGRAM
                or (alarm.name, alarm.channel) in known
            ):
                continue
            channel = ALL_CHANNELS if alarm.channel is None else alarm.channel + 1
            category = Category.PLC if alarm.kind is AlarmKind.PLC else Category.CONTROL_OR_DRIVE
            number = self._numbers.get(alarm.name, 0)
            error = self._noted[alarm] = PresentError(number, channel, category, alarm.text, now)
            self._errors.errors.append(error)
