"""What the door of a sender holds beside the control."""

from __future__ import annotations

from dataclasses import dataclass, field, fields

from polycnc.servers.grbl._codes import GrblAlarm


@dataclass(slots=True)
class DoorState:
    """What goes on: `locked` by an alarm, `halted` until a reset, `seen` alarms of the control.

    `cancels` is a jog that is being broken off, `door` the safety door, `coolant` the M codes of coolant that is on.
    """

    locked: bool = False
    halted: bool = False
    seen: bool = False
    checking: bool = False
    sleeping: bool = False
    homing: bool = False
    jogging: bool = False
    cancels: bool = False
    door: bool = False
    alarm_to_say: GrblAlarm | None = None
    coolant: frozenset[str] = field(default_factory=frozenset)

    def begin_again(self) -> None:
        """Begin as after a reset; alarms that the control has stay known."""
        fresh = DoorState(seen=self.seen)
        for each in fields(self):
            setattr(self, each.name, getattr(fresh, each.name))
