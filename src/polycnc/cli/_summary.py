"""What ``polycnc run`` says for people: times, lengths, axes, tools, messages."""

from __future__ import annotations

from enum import StrEnum
from typing import TYPE_CHECKING

from polycnc.cli._output import bold, bold_red, columns, say, say_problem
from polycnc.units import MM_PER_INCH

if TYPE_CHECKING:
    from polycnc.runner import RunResult

_NUMBERS = (1, 2, 3)


class Units(StrEnum):
    """Units of lengths and feeds in a summary."""

    MM = "mm"
    INCH = "inch"


class _Lengths:
    """Lengths (mm), feeds (mm/min) and positions as texts in the units wanted."""

    def __init__(self, units: Units) -> None:
        inch = units is Units.INCH
        self._factor = 1.0 / MM_PER_INCH if inch else 1.0
        self.unit = "in" if inch else "mm"
        self._decimals = 4 if inch else 3
        self._feed_decimals = 2 if inch else 1

    def length(self, value_mm: float) -> str:
        return f"{value_mm * self._factor:,.{self._decimals}f} {self.unit}"

    def feed(self, value_mm_min: float) -> str:
        return f"{value_mm_min * self._factor:,.{self._feed_decimals}f} {self.unit}/min"

    def position(self, value: float, unit: str) -> str:
        """Return a position without its unit and without a sign of zero; degrees stay degrees."""
        return f"{value * self._factor:z,.{self._decimals}f}" if unit == "mm" else f"{value:z,.3f}"

    def name(self, unit: str) -> str:
        return self.unit if unit == "mm" else unit


def print_summary(result: RunResult, units: Units = Units.MM) -> None:
    """Print what a run gave."""
    from polycnc.runner import counted, time_text

    for alarm in result.alarms:
        say_problem(str(alarm), lead=bold_red("alarm: "))
    if result.alarms and not result.blocks:
        return
    lengths = _Lengths(units)
    reason = f": {result.guessed}" if result.guessed else ""
    say(f"program    {result.program}")
    say(
        f"           {counted(result.blocks, 'block')}, dialect {result.dialect}{reason}, machine {result.machine}"
    )
    if result.alarms and result.time_s == 0.0:
        _print_messages(result)
        return
    say(lead="time       " + bold(time_text(result.time_s)))
    parts = [
        ("  cutting", time_text(result.cutting_time_s), lengths.length(result.cutting_path_mm)),
        ("  rapid", time_text(result.rapid_time_s), lengths.length(result.rapid_path_mm)),
        ("  waiting", time_text(result.waiting_time_s), ""),
    ]
    for line in columns(parts if result.waiting_time_s else parts[:2], right=_NUMBERS):
        say(line)
    _print_operations(result)
    say(f"path       {lengths.length(result.path_mm)}, cut with up to {lengths.feed(result.top_feed_mm_min)}")
    header = ("axis", "lowest", "highest", "end", "(machine coordinates)")
    axes = [
        (
            f"  {axis}",
            *(
                lengths.position(value, result.axis_units[axis])
                for value in (low, high, result.end_position_mm[axis])
            ),
            lengths.name(result.axis_units[axis]),
        )
        for axis, (low, high) in result.extents_mm.items()
    ]
    for line in columns([header, *axes], right=_NUMBERS):
        say(line)
    if result.machined is not None:
        removed, left = result.removed_mm3 / 1000.0, result.machined.stock.volume_mm3 / 1000.0
        say(f"removed    {removed:,.3f} cm3 of {removed + left:,.3f} cm3")
        if cut := _hardest(result.machined.engagement.most):
            say(f"  most     {cut}")
        if result.machined.idle_s:
            say(f"  idle     {time_text(result.machined.idle_s)} of feed removed nothing")
        if result.machined.comparison is not None:
            say(f"  target   {result.machined.comparison}")
    _print_messages(result)
    for collision in result.collisions:
        place = "" if collision.position is None else f"{collision.position}: "
        say_problem(f"{place}{collision}", lead=bold_red("collision: "))


def _hardest(most: tuple[float, float, float, float]) -> str:
    """Return the greatest figures of the cuts that are known."""
    rate, deep, wide, chip = most
    texts = ((rate * 0.06, "cm3/min"), (deep, "mm deep"), (wide, "mm wide"), (chip, "mm a chip"))
    return ", ".join(f"{value:,.3f} {what}" for value, what in texts if value > 0.0)


def _print_messages(result: RunResult) -> None:
    for message in result.messages:
        times = f" ({message.count} times)" if message.count > 1 else ""
        place = f"line {message.line}: " if message.line else ""
        say(f"message    {place}{message.text}{times}")


def _print_operations(result: RunResult) -> None:
    """Print the operations with their tools, where there is more than one."""
    from polycnc.runner import time_text

    if len(result.operations) < 2:
        return
    rows = [
        (
            f"  T{each.tool}",
            time_text(each.time_s),
            time_text(each.cutting_s),
            time_text(each.rapid_s),
            each.name,
        )
        for each in result.operations
    ]
    for line in columns([("tool", "time", "cutting", "rapid", "operation"), *rows], right=_NUMBERS):
        say(line)
