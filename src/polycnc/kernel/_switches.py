"""Switches and encoder marks along an axis: limit switches, reference switch, index pulses, software limits.

A switch is on within a stretch of the axis. What happens between two cycles is not lost: a switch that was
passed over shows both edges, and an edge or an index pulse carries the position where it lies.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from polycnc.kernel._jit import compiled

LIMIT_LOW = 0
LIMIT_HIGH = 1
REFERENCE = 2
SWITCHES_PER_AXIS = 3

SOFT_INSIDE = 0
SOFT_LOW = -1
SOFT_HIGH = 1

# Positions are machine positions in axis units.
SWITCH_ROW = np.dtype(
    [
        # Written by the caller: the stretch where the switch is on, ends included.
        ("on_from", np.float64),
        ("on_to", np.float64),
        # Results; the positions keep the last edge.
        ("level", np.int64),
        ("rising_position", np.float64),
        ("falling_position", np.float64),
    ],
    align=True,
)

MARKS_ROW = np.dtype(
    [
        # Written by the caller.
        ("index_origin", np.float64),  # position of an index pulse, infinite without any
        ("index_pitch", np.float64),  # distance of the next pulse, 0 for a single one
        ("index_armed", np.int64),  # 1 latches the next pulse, which clears it
        ("soft_low", np.float64),
        ("soft_high", np.float64),
        ("soft_enabled", np.int64),
        # Results.
        ("index_crossed", np.int64),  # pulses passed in the last cycle, negative downwards
        ("index_position", np.float64),  # the first pulse of the last crossing
        ("index_latched", np.int64),  # stays 1 until the caller clears it
        ("index_latch", np.float64),
        ("index_latch_direction", np.int64),  # +1 or -1
    ],
    align=True,
)


class Switches(NamedTuple):
    """What n axes can run over; the last axis of [n, 3] is LIMIT_LOW, LIMIT_HIGH, REFERENCE."""

    switch: npt.NDArray[np.void]  # [n, 3] of SWITCH_ROW
    rising: npt.NDArray[np.uint8]  # [n, 3] result: the switch came on in the last cycle
    falling: npt.NDArray[np.uint8]  # [n, 3] result: the switch went off in the last cycle
    marks: npt.NDArray[np.void]  # [n] of MARKS_ROW


def make_switches(axes: int) -> Switches:
    """Make `axes` axes without switches, index pulses or software limits."""
    each = (axes, SWITCHES_PER_AXIS)
    switch = np.zeros(each, SWITCH_ROW)
    switch["on_from"] = np.inf
    switch["on_to"] = -np.inf
    marks = np.zeros(axes, MARKS_ROW)
    marks["index_origin"] = np.inf
    marks["soft_low"] = -np.inf
    marks["soft_high"] = np.inf
    return Switches(switch, np.zeros(each, np.uint8), np.zeros(each, np.uint8), marks)


@compiled
def _switch(row: np.void, actual: float, last_actual: float) -> tuple[bool, bool]:
    """Set the level and return whether the switch came on and went off; ends belong to the stretch."""
    low = row["on_from"]
    high = row["on_to"]
    row["level"] = 1 if low <= actual <= high else 0
    if low > high:
        return False, False
    if actual >= last_actual:
        rises = bool(last_actual < low <= actual)
        falls = bool(last_actual <= high < actual)
        entry, leave = low, high
    else:
        rises = bool(last_actual > high >= actual)
        falls = bool(last_actual >= low > actual)
        entry, leave = high, low
    if rises:
        row["rising_position"] = entry
    if falls:
        row["falling_position"] = leave
    return rises, falls


@compiled
def index_crossings(origin: float, pitch: float, actual: float, last_actual: float) -> tuple[int, float]:
    """Return the pulses passed from `last_actual` to `actual`, negative downwards, and where the first lies.

    A pulse that is reached counts, a pulse that is left does not, so none is counted twice.
    """
    if pitch <= 0.0:
        if last_actual < origin <= actual:
            return 1, origin
        if actual <= origin < last_actual:
            return -1, origin
        return 0, origin
    if actual >= last_actual:
        before = math.floor((last_actual - origin) / pitch)
        return math.floor((actual - origin) / pitch) - before, origin + (before + 1) * pitch
    before = math.ceil((last_actual - origin) / pitch)
    return math.ceil((actual - origin) / pitch) - before, origin + (before - 1) * pitch


@compiled
def _index(marks: np.void, actual: float, last_actual: float) -> None:
    """Count the index pulses of this cycle, and latch the first if the latch is armed."""
    crossed, position = index_crossings(marks["index_origin"], marks["index_pitch"], actual, last_actual)
    marks["index_crossed"] = crossed
    if crossed != 0:
        marks["index_position"] = position
        if marks["index_armed"] != 0:
            marks["index_armed"] = 0
            marks["index_latched"] = 1
            marks["index_latch"] = position
            marks["index_latch_direction"] = 1 if crossed > 0 else -1


@compiled
def switches_cycle(i: int, switches: Switches, actual: float, last_actual: float) -> None:
    """Set levels, edges and index pulses of axis `i` for its way of this cycle."""
    for j in range(SWITCHES_PER_AXIS):
        rises, falls = _switch(switches.switch[i, j], actual, last_actual)
        switches.rising[i, j] = 1 if rises else 0
        switches.falling[i, j] = 1 if falls else 0
    _index(switches.marks[i], actual, last_actual)


@compiled
def soft_limit(i: int, switches: Switches, position: float) -> int:
    """Return SOFT_LOW or SOFT_HIGH if `position` is beyond a software limit of axis `i`, else SOFT_INSIDE."""
    marks = switches.marks[i]
    if marks["soft_enabled"] != 0:
        if position < marks["soft_low"]:
            return SOFT_LOW
        if position > marks["soft_high"]:
            return SOFT_HIGH
    return SOFT_INSIDE
