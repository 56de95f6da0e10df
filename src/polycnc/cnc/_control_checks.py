"""What keeps a command of the operator from being carried out, said with what to do about it."""

from __future__ import annotations

from collections.abc import Sequence

from polycnc.cnc._alarms import Alarm
from polycnc.cnc._control_channel import ControlChannel
from polycnc.cnc._control_data import Mode
from polycnc.cnc._manual import ManualMotion
from polycnc.cnc._program_memory import ProgramMemory
from polycnc.cnc._refusal import ControlError, Refusal
from polycnc.cnc._status import Emergency
from polycnc.nc import IncomingText, ProgramText


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


def check_ready(emergency: Emergency, alarms: Sequence[Alarm]) -> None:
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
        first = alarms[0]
        raise ControlError(Refusal.ALARM, f"alarm {first.number}: {first.text}", hint="Clear it and reset.")


def check_hands_off(channel: ControlChannel, manual: ManualMotion) -> None:
    """Refuse to execute a program with axes that are moved by hand.

    Raises:
        ControlError: One of the channel's axes is.
    """
    if manual.moves(channel.axes):
        raise ControlError(Refusal.RUNNING, "axes are moved by hand", hint="Wait until they stop.")


def check_referenced(channel: ControlChannel, manual: ManualMotion) -> None:
    """Refuse to execute a program with axes that do not know where they are.

    Raises:
        ControlError: One of the channel's axes is not referenced.
    """
    referenced = manual.referenced
    missing = [axis for axis in channel.axes if not referenced[axis]]
    if missing:
        raise ControlError(
            Refusal.NOT_REFERENCED,
            f"axis {', '.join(missing)} is not referenced",
            hint="Reference it in REF.",
        )


def text_to_begin(channel: ControlChannel, programs: ProgramMemory, *, is_mdi: bool) -> ProgramText:
    """Return the text that a start executes, as it is in the memory now.

    Raises:
        ControlError: There is none.
    """
    text = channel.mdi if is_mdi else channel.program
    if text is None:
        raise ControlError(
            Refusal.NOT_FOUND,
            "there is no MDI text" if is_mdi else "no program is selected",
            hint="Put in a text." if is_mdi else "Select a program.",
        )
    if isinstance(text, IncomingText):
        if text.closed:
            raise ControlError(Refusal.NOT_FOUND, f"{text.name} has ended", hint="Open another program.")
        return text
    return programs.text(text.name) if not is_mdi and text.name in programs else text


def wrong_mode(mode: Mode, what: str, *modes: Mode) -> ControlError:
    """Return the refusal of a command that `mode` does not have."""
    names = " or ".join(modes)
    return ControlError(Refusal.MODE, f"not in {mode}: {what} only in {names}", hint=f"Select {names}.")


def share_axes(channels: Sequence[ControlChannel], shares: Sequence[tuple[str, ...]]) -> None:
    """Give channels their axes anew.

    Raises:
        ControlError: A channel whose axes change executes a program; nothing has changed.
    """
    pairs = zip(channels, shares, strict=True)
    changing = [(channel, axes) for channel, axes in pairs if set(axes) != set(channel.axes)]
    for channel, _ in changing:
        check_over(channel)
        channel.check_rest()
    for channel, axes in changing:
        channel.share(axes)
