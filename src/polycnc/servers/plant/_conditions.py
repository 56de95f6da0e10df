"""What is wrong with a machine, sorted by what it is about: its alarms as the conditions that a plant watches."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from polycnc.cnc import Alarm, AlarmKind, Status


class About(StrEnum):
    """What a trouble is about; a condition of every door."""

    SYSTEM = "system"
    LOGIC = "logic"  # the PLC
    MOTION = "motion"  # the program, of one channel
    TRAVEL = "travel"  # the limits of one axis
    DRIVE = "drive"  # the servo drive of one axis
    SPINDLE = "spindle"
    LINK = "link"  # between this door and the machine: in one process it does not fail


_BY_KIND = {
    AlarmKind.PROGRAM: About.MOTION,
    AlarmKind.SERVO: About.DRIVE,
    AlarmKind.TRAVEL: About.TRAVEL,
    AlarmKind.SPINDLE: About.SPINDLE,
    AlarmKind.PLC: About.LOGIC,
    AlarmKind.EMERGENCY: About.SYSTEM,
    AlarmKind.SYSTEM: About.SYSTEM,
}
_OF_AN_AXIS = (About.TRAVEL, About.DRIVE)


@dataclass(frozen=True, slots=True)
class Trouble:
    """An alarm that is on: the control's number and text, what it is about, and `key`, which tells it from others.

    `axis` is that of a travel or drive, `channel` that of a program. `qualifier` is "low", "high" or "".
    """

    about: About
    key: str
    code: str
    text: str
    axis: str = ""
    channel: int = 0
    qualifier: str = ""


def troubles(status: Status) -> tuple[Trouble, ...]:
    """Return what is wrong, oldest first."""
    return tuple(map(_trouble, status.alarms))


def _trouble(alarm: Alarm) -> Trouble:
    about = _BY_KIND[alarm.kind]
    if about in _OF_AN_AXIS and alarm.axis is None:
        about = About.SYSTEM
    qualifier = next((each for each in ("low", "high") if alarm.name.endswith(f"_{each}")), "")
    key = ":".join(str(each) for each in (alarm.name, alarm.axis or "", alarm.channel or 0, alarm.cycle))
    axis = alarm.axis or "" if about in _OF_AN_AXIS else ""
    return Trouble(about, key, str(alarm.number), alarm.text, axis, alarm.channel or 0, qualifier)
