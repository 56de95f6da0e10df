"""What a reset, an alarm and a change of mode have in common: they break off or stop what channels and axes do."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from polycnc.cnc._alarms import Alarm
from polycnc.cnc._control_channel import ControlChannel
from polycnc.cnc._control_parts import ControlParts

PROGRAM_MESSAGE = 3006
"""Number of the message of a stop in a program of the first channel; those of the others follow."""


def break_off(of: ControlParts, channels: Sequence[ControlChannel]) -> None:
    """Let everything brake, and forget what was under way."""
    for channel in channels:
        of.manual.stop_all(channel.axes)
        channel.reset()
        of.messages.withdraw(PROGRAM_MESSAGE + channel.path)
    of.functions.withdraw(channels)
    if len(channels) == len(of.channels):
        of.plc.cancel()  # what nobody waits for as well


def stop_for(of: ControlParts, alarms: Iterable[Alarm]) -> None:
    """Stop what these alarms stop."""
    for alarm in alarms:
        for channel in of.chosen(alarm.channel):
            of.manual.stop_all(channel.axes)
            channel.fail()
