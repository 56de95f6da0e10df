"""What a report says of a control: what it executes, at which line, and where its axes are."""

from __future__ import annotations

from collections.abc import Iterator

from polycnc.cnc import ChannelStatus, Status
from polycnc.testing._text import number_text, table, time_text


def control_text(status: Status) -> str:
    """Return the lines about a control without a vendor, or about one that is around it."""
    several = len(status.channels) > 1
    lines = [time_text(status.time_s, status.cycle, f"mode {status.mode}")]
    if status.emergency != "off":
        lines.append(f"emergency stop: {status.emergency}")
    for number, channel in enumerate(status.channels):
        lines += [f"channel {number}:"] * several
        lines += _executed(channel)
    lines += [f"alarm {alarm.number}: {alarm.text}" for alarm in status.alarms]
    lines += [f"message {message.number}: {message.text}" for message in status.messages]
    axes = status.axes.values()
    rows = [(each.name, *map(number_text, (each.machine, each.work, each.to_go)), each.unit) for each in axes]
    return "\n".join([*lines, *table(("axis", "machine", "work", "to go", ""), rows)])


def _executed(channel: ChannelStatus) -> Iterator[str]:
    """Yield what a channel has to do with its program."""
    if channel.program is None and channel.block is None:
        yield "no program is selected"
        return
    yield f"program {channel.program}: {channel.run_state}"
    if (block := channel.block) is not None:
        for call in block.stack:
            yield f"called from {call.program}:{call.line}"
        yield f"{block.program}:{block.line}: {block.text}"
    if channel.functions:
        yield f"waits for {', '.join(channel.functions)}"
