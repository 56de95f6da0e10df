"""The operation history and the alarm history, which the control samples by itself until it is stopped."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime
from enum import IntEnum
from typing import Any, TypeAlias

from polycnc.cnc import Alarm
from polycnc.controllers.fanuc.device._alarms import bit_of
from polycnc.controllers.fanuc.device._device_state import SamplingState
from polycnc.controllers.fanuc.device._power import Power
from polycnc.machine import Store

NAMES = " XGYF"
"""Letters of monitored signals by their number in the histories (Manual 000, cnc_rdhissgnl); 0 is none."""
_ALARMS = "cnc.alarm_history"
SHARED = frozenset({8, 10, 11, 12, 14, 43, 44, 46})
"""Addresses of G that show switches of the control, whoever has turned them."""
_SHOWN = "FG"
Note: TypeAlias = Callable[[str, int, int, int], None]
"""Is told letter and address of a byte that has changed, and what it was and is."""
_KEEP_OPERATIONS = 1000
_KEEP_ALARMS = 50


class Kind(IntEnum):
    """Kinds of records. Ruling: the manual gives no numbers for the last two."""

    KEY = 0
    SIGNAL = 1
    ALARM = 2
    DATE = 3
    TIME = 4


@dataclass(frozen=True, slots=True)
class Monitored:
    """A signal byte whose changes are noted where `mask` has ones; without a letter there is none."""

    letter: str = ""
    address: int = 0
    mask: int = 0


class Histories:
    """Sample and read both histories of a Power Mate; both are durable. `byte` returns that of an F or G address."""

    def __init__(
        self, store: Store, power: Power, byte: Callable[[str, int], int], state: SamplingState
    ) -> None:
        self._store = store
        self._power = power
        self._byte = byte
        self._operations = store.history("fanuc.operation_history")
        self._alarms = store.history("fanuc.alarm_history")
        self._source = store.history(_ALARMS)
        self._state = store.area("fanuc.history", int)
        self._signals = store.area("fanuc.history_signals", dict)
        self._monitored = {int(entry): Monitored(**each) for entry, each in self._signals.load().items()}
        self._shown: dict[tuple[str, int], int] = {}
        self.state = state
        self._active: tuple[Alarm, ...] = ()

    # ------------------------------------------------------------------ sampling

    @property
    def is_awake(self) -> bool:
        """Whether the next cycle may bring something to note."""
        return self._watches_changes or self._power.control.alarms.active != self._active

    def look(self) -> None:
        """Note what a cycle has brought, in that cycle."""
        self.sample(force=False)

    def switched_on(self) -> None:
        """Note date and time at which the power came on; sampling goes on, from the signals that there are then."""
        self.state.stopped = False
        self._shown.clear()
        now = self._power.control.clock.now
        self._note({"kind": Kind.DATE, "date": [now.year % 100, now.month, now.day], "power": 1})
        self._note({"kind": Kind.TIME, "time": [now.hour, now.minute, now.second], "power": 1})

    def stop(self) -> None:
        """Stop sampling: the records and their numbers stay until it begins again."""
        self.sample()
        self.state.stopped = True

    def start(self) -> None:
        """Go on with sampling; what happened in between was not noted."""
        self.sample()
        self.state.stopped = False

    def press_key(self, code: int) -> None:
        """Note that a key of the MDI panel was pressed, by its code (0 to 255)."""
        self.sample()
        self._note({"kind": Kind.KEY, "code": code})

    def note_signal(self, letter: str, address: int, old: int, new: int) -> None:
        """Note the change of a signal byte, if it is monitored and one of its masked bits has changed."""
        self._shown[letter, address] = new
        for each in self._monitored.values():
            if (each.letter, each.address) == (letter, address) and (old ^ new) & each.mask:
                self._note({"kind": Kind.SIGNAL, "letter": letter, "at": address, "old": old, "new": new})
                return

    def sample(self, *, force: bool = True) -> None:
        """Look at what has happened: alarms, and signals that nobody gives: those of F, and of G what has a switch.

        Not forced it looks at the alarms that are on, which is quick.
        """
        active = self._power.control.alarms.active
        if not force and active == self._active and not self._watches_changes:
            return
        self._active = active
        seen = self._state.get("seen", 0)
        for entry in self._source.read(after=seen):
            self._state["seen"] = entry.number
            if entry.content["number"] >= 0 and not self.state.stopped:
                self._note_alarm(entry.content)
        for each in self._monitored.values():
            if each.letter in _SHOWN:
                new = self._byte(each.letter, each.address)
                old = self._shown.get((each.letter, each.address), new)
                self._shown[each.letter, each.address] = new
                if old != new:
                    self.note_signal(each.letter, each.address, old, new)

    def _note_alarm(self, content: dict[str, Any]) -> None:
        names = self._power.control.machine.config.axis_names
        name = content["axis"]
        axis = names.index(name) + 1 if name in names else 0
        number = content["number"]
        self._note({"kind": Kind.ALARM, "group": int(bit_of(number)), "number": number})
        self._alarms.append(
            {"number": number, "axis": axis or -1, "time": content["time"], "text": content["text"]}
        )
        self._alarms.trim(_KEEP_ALARMS)

    def _note(self, content: dict[str, Any]) -> None:
        if not self.state.stopped:
            self._operations.append({**content, "kind": int(content["kind"])})
            self._operations.trim(_KEEP_OPERATIONS)

    @property
    def _watches_changes(self) -> bool:
        return any(
            each.letter == "F" or (each.letter == "G" and each.address in SHARED)
            for each in self._monitored.values()
        )

    # ------------------------------------------------------------------ reading

    def operations(self) -> list[dict[str, Any]]:
        """Return the operation history, oldest first."""
        return [entry.content for entry in self._operations.read()]

    def alarms(self) -> list[tuple[int, int, datetime, str]]:
        """Return number, axis (-1: none), time and text of past alarms, oldest first."""
        return [
            (each["number"], each["axis"], datetime.fromisoformat(each["time"]), each["text"])
            for each in (entry.content for entry in self._alarms.read())
        ]

    def clear_operations(self) -> None:
        """Forget the operation history."""
        self._operations.trim(0)

    def clear_alarms(self) -> None:
        """Forget the alarm history."""
        self.sample()
        self._alarms.trim(0)

    # ------------------------------------------------------------------ monitored signals

    def monitored(self, entry: int) -> Monitored:
        """Return a monitored signal by its number, 1 to 20."""
        return self._monitored.get(entry, Monitored())

    def monitor(self, entries: dict[int, Monitored]) -> None:
        """Set monitored signals by their numbers; the others stay."""
        self.sample()
        with self._store.transaction():
            for entry, each in entries.items():
                self._signals[str(entry)] = {
                    "letter": each.letter,
                    "address": each.address,
                    "mask": each.mask,
                }
        self._monitored.update(entries)
        self.sample()
