"""Alarms with numbers and texts, what clears them, their history, and messages to the operator."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from types import MappingProxyType
from typing import TypeAlias

from polycnc.cnc._refusal import ControlError, Refusal
from polycnc.errors import ProgramError, shown
from polycnc.machine import Clock, Store

_ALARMS = "cnc.alarm_history"
_MESSAGES = "cnc.message_history"
MOST_MESSAGE_CHARACTERS = 255


class AlarmKind(StrEnum):
    """What an alarm is about; doors sort alarms by it."""

    PROGRAM = "program"
    SERVO = "servo"
    TRAVEL = "travel"
    SPINDLE = "spindle"
    PLC = "plc"
    EMERGENCY = "emergency"
    SYSTEM = "system"


class ClearedBy(StrEnum):
    """What takes an alarm away."""

    RESET = "reset"
    CAUSE = "cause"  # goes by itself when its cause has gone
    POWER = "power"  # stays until the control is switched off


@dataclass(frozen=True, slots=True)
class AlarmRow:
    """Describe one alarm of a control; `text` may hold {axis} and {detail}."""

    number: int
    kind: AlarmKind
    text: str
    cleared_by: ClearedBy = ClearedBy.RESET


AlarmTable: TypeAlias = Mapping[str, AlarmRow]

# fmt: off
ALARMS: AlarmTable = MappingProxyType({
    "program":               AlarmRow(100, AlarmKind.PROGRAM, "{detail}"),
    "soft_limit_low":        AlarmRow(210, AlarmKind.TRAVEL, "axis {axis} is at its lower software limit"),
    "soft_limit_high":       AlarmRow(211, AlarmKind.TRAVEL, "axis {axis} is at its upper software limit"),
    "limit_switch_low":      AlarmRow(212, AlarmKind.TRAVEL, "axis {axis} is on its lower limit switch"),
    "limit_switch_high":     AlarmRow(213, AlarmKind.TRAVEL, "axis {axis} is on its upper limit switch"),
    "reference_not_found":   AlarmRow(220, AlarmKind.SERVO, "axis {axis} found no {detail} on its whole travel"),
    "following_error":       AlarmRow(230, AlarmKind.SERVO, "axis {axis}: the following error is above its limit"),
    "function_failed":       AlarmRow(310, AlarmKind.PLC, "{detail}"),
    "function_not_answered": AlarmRow(311, AlarmKind.PLC, "{detail} was not answered in time"),
    "emergency_stop":        AlarmRow(400, AlarmKind.EMERGENCY, "emergency stop", ClearedBy.CAUSE),
})
# fmt: on
"""The alarms of a control without a vendor, by the name that the code uses; a vendor has its own numbers and texts.

Errors of a program are "program", or "program CODE" where a vendor has a number for the error's code; moves past a soft
limit "program soft_limit_low" or "..._high" where a vendor has such rows."""


@dataclass(frozen=True, slots=True)
class Alarm:
    """An alarm that is on: `name` as the code knows it, `number` and `text` as the control shows them.

    `channel` is the one that it stops; None: all of them.
    """

    name: str
    number: int
    kind: AlarmKind
    text: str
    axis: str | None
    cycle: int
    cleared_by: ClearedBy
    channel: int | None = None

    @property
    def key(self) -> tuple[str, str | None, int | None]:
        """What tells alarms that are on apart."""
        return self.name, self.axis, self.channel


@dataclass(frozen=True, slots=True)
class PastAlarm:
    """An entry of the alarm history; `time` is the machine's date and time, as ISO text."""

    number: int
    kind: AlarmKind
    text: str
    axis: str | None
    time: str


@dataclass(frozen=True, slots=True)
class OperatorMessage:
    """A message to the operator that is shown."""

    number: int
    text: str
    cycle: int


class AlarmList:
    """Hold the alarms that are on, in the order in which they came, and a bounded durable history.

    `owners` says which channel an axis belongs to where there are several.
    """

    def __init__(
        self,
        store: Store,
        clock: Clock,
        table: AlarmTable = ALARMS,
        *,
        keep: int = 100,
        owners: Mapping[str, int] | None = None,
    ) -> None:
        self._clock = clock
        self._table = table
        self._keep = keep
        self._history = store.history(_ALARMS)
        self.owners = dict(owners or {})
        self.active: tuple[Alarm, ...] = ()
        """The alarms that are on, oldest first."""
        self.revision = 0
        """Grows with every change of the history."""
        past = self._history.last(1)
        self.last_time: str | None = past[-1].content["time"] if past else None
        """When the last alarm of the history came, by the machine's date and time (ISO), even if it is gone."""
        self._active: dict[tuple[str, str | None, int | None], Alarm] = {}

    def _change(self, active: dict[tuple[str, str | None, int | None], Alarm]) -> None:
        self._active = active
        self.active = tuple(active.values())
        self._clock.changes += 1

    def __bool__(self) -> bool:
        return bool(self._active)

    def of(self, channel: int) -> tuple[Alarm, ...]:
        """Return the alarms that stop a channel, oldest first."""
        return tuple(alarm for alarm in self._active.values() if alarm.channel in (None, channel))

    def of_program(self, error: ProgramError) -> tuple[str, str | None]:
        """Return name and axis of the alarm for an error of a program: a row of its own in the table, or "program"."""
        if error.limit is not None:
            axis, upper, reached = error.limit
            name = f"{'' if reached else 'program '}soft_limit_{'high' if upper else 'low'}"
            if name in self._table:
                return name, axis
        name = f"program {error.code}"
        return (name if error.code and name in self._table else "program"), None

    def owner(self, axis: str) -> int | None:
        """Return the channel of an axis, None where there is only one."""
        return self.owners.get(axis)

    def has(self, name: str, axis: str | None = None, channel: int | None = None) -> bool:
        """Tell whether an alarm is on."""
        return (name, axis, self._channel(axis, channel)) in self._active

    def _channel(self, axis: str | None, channel: int | None) -> int | None:
        if not self.owners:
            return None
        return channel if axis is None else self.owners.get(axis)

    def put(
        self, name: str, *, axis: str | None = None, detail: str = "", channel: int | None = None
    ) -> Alarm:
        """Put an alarm on and note it in the history; one that is on already stays as it is.

        It stops the channel of its axis, else `channel`, all of them if that is None.

        Raises:
            ControlError: There is no alarm of this name; nothing has changed.
        """
        channel = self._channel(axis, channel)
        if known := self._active.get((name, axis, channel)):
            return known
        row = self._table.get(name)
        if row is None:
            raise ControlError(
                Refusal.NOT_FOUND, f"there is no alarm {shown(name)}", hint="Use one of the control's table."
            )
        text = row.text.format(axis=axis, detail=detail)
        alarm = Alarm(name, row.number, row.kind, text, axis, self._clock.cycles, row.cleared_by, channel)
        self.last_time = self._clock.now.isoformat()
        self._history.append(
            {"number": row.number, "kind": row.kind.value, "text": text, "axis": axis, "time": self.last_time}
        )
        self._history.trim(self._keep)
        self.revision += 1
        self._change({**self._active, alarm.key: alarm})
        return alarm

    def reset(self, channel: int | None = None) -> None:
        """Take away the alarms that a reset clears: of one channel alone, or all."""
        self._change(
            {
                key: alarm
                for key, alarm in self._active.items()
                if alarm.cleared_by is not ClearedBy.RESET
                or (channel is not None and alarm.channel != channel)
            }
        )

    def cause_gone(self, name: str, axis: str | None = None) -> None:
        """Take an alarm away whose cause has gone, if that is what clears it."""
        alarm = self._active.get((name, axis, self._channel(axis, None)))
        if alarm is not None and alarm.cleared_by is ClearedBy.CAUSE:
            self._change({key: each for key, each in self._active.items() if each is not alarm})

    def history(self) -> tuple[PastAlarm, ...]:
        """Return the history, oldest first."""
        return tuple(
            PastAlarm(
                entry.content["number"],
                AlarmKind(entry.content["kind"]),
                entry.content["text"],
                entry.content["axis"],
                entry.content["time"],
            )
            for entry in self._history.read()
        )

    def clear_history(self) -> None:
        """Forget the history; the alarms that are on stay."""
        self._history.trim(0)
        self.revision += 1
        self.last_time = None
        self._clock.changes += 1

    def snapshot(self) -> tuple[Alarm, ...]:
        """Return the alarms that are on, to go back to; the history is durable and stays."""
        return self.active

    def restore(self, alarms: tuple[Alarm, ...]) -> None:
        """Go back to a snapshot."""
        self._change({alarm.key: alarm for alarm in alarms})


class OperatorMessages:
    """Hold the messages to the operator that are shown, one per number, and a bounded durable history."""

    def __init__(self, store: Store, clock: Clock, *, keep: int = 100) -> None:
        self._clock = clock
        self._keep = keep
        self._history = store.history(_MESSAGES)
        self.revision = 0
        """Grows with every change of the history."""
        self.shown: tuple[OperatorMessage, ...] = ()
        """The messages that are shown, oldest first."""

    def _change(self, *shown: OperatorMessage) -> None:
        self.shown = shown
        self._clock.changes += 1

    def show(self, number: int, text: str) -> OperatorMessage:
        """Show a message, in place of one with the same number.

        Raises:
            ControlError: The number is negative, or the text is empty, too long or of several lines.
        """
        if number < 0 or not text.strip() or len(text) > MOST_MESSAGE_CHARACTERS or "\n" in text:
            raise ControlError(
                Refusal.DATA,
                f"message {number} cannot be shown: {text[:40]!r}",
                hint=f"Give a number from 0 and one line of 1 to {MOST_MESSAGE_CHARACTERS} characters.",
            )
        message = OperatorMessage(number, text, self._clock.cycles)
        self._history.append({"number": number, "text": text, "time": self._clock.now.isoformat()})
        self._history.trim(self._keep)
        self.revision += 1
        self._change(*(each for each in self.shown if each.number != number), message)
        return message

    def withdraw(self, number: int | None = None) -> None:
        """Take a message away, or all; one that is not shown needs no taking away."""
        self._change(*(each for each in self.shown if number is not None and each.number != number))

    def history(self) -> tuple[tuple[int, str, str], ...]:
        """Return number, text and time (ISO) of the past messages, oldest first."""
        return tuple(
            (entry.content["number"], entry.content["text"], entry.content["time"])
            for entry in self._history.read()
        )

    def snapshot(self) -> tuple[OperatorMessage, ...]:
        """Return the messages that are shown, to go back to."""
        return self.shown

    def restore(self, messages: tuple[OperatorMessage, ...]) -> None:
        """Go back to a snapshot."""
        self._change(*messages)
