"""What keeps a command of the operator from being carried out, said with what to do about it."""

from __future__ import annotations

from polycnc.cnc._alarms import AlarmList
from polycnc.cnc._control_channel import ControlChannel
from polycnc.cnc._control_data import Mode
from polycnc.cnc._refusal import ControlError, Refusal
from polycnc.cnc._status import Emergency


def check_over(channel: ControlChannel) -> None:
    """Refuse what changes the program of a channel while it is executed.

    Raises:
        ControlError: A program is being executed or is interrupted.
    """
    if channel.active or channel.interrupted or channel.broken:
        raise ControlError(
            Refusal.RUNNING,
            "a program is being executed or is interrupted",
            hint="Wait for its end, or reset it.",
        )


def check_ready(emergency: Emergency, alarms: AlarmList) -> None:
    """Refuse to move anything by program while something is wrong.

    Raises:
        ControlError: The emergency stop is or was on, or there is an alarm.
    """
    if emergency is not Emergency.OFF:
        on = emergency is Emergency.ON
        raise ControlError(
            Refusal.EMERGENCY,
            "the emergency stop is on" if on else "the emergency stop was on",
            hint="Release it and reset." if on else "Reset first.",
        )
    if alarms:
        first = alarms.active[0]
        raise ControlError(Refusal.ALARM, f"alarm {first.number}: {first.text}", hint="Clear it and reset.")


def wrong_mode(mode: Mode, what: str, *modes: Mode) -> ControlError:
    """Return the refusal of a command that `mode` does not have."""
    names = " or ".join(modes)
    return ControlError(Refusal.MODE, f"not in {mode}: {what} only in {names}", hint=f"Select {names}.")
