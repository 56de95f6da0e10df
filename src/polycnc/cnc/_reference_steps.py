"""How an axis finds its reference point, as data: each step goes one way until something happens, then brakes.

The reference switch is on from the lower end of the travel up to its edge, so going down finds it and going up leaves
it. The index pulse lies above the edge or below it.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from polycnc.machine import AxisConfig


class Until(StrEnum):
    """What ends a step."""

    ON = "reference switch"
    OFF = "end of the reference switch"
    INDEX = "index pulse"


@dataclass(frozen=True, slots=True)
class Step:
    """Go in a direction, fast or creeping, until something happens."""

    direction: int
    fast: bool
    until: Until


FIND = Step(-1, True, Until.ON)
LEAVE_FAST = Step(1, True, Until.OFF)
LEAVE = Step(1, False, Until.OFF)
ENTER = Step(-1, False, Until.ON)
INDEX_UP = Step(1, False, Until.INDEX)
INDEX_DOWN = Step(-1, False, Until.INDEX)

SWITCH_ONLY = (FIND, LEAVE)
SWITCH_THEN_INDEX_ABOVE = (FIND, LEAVE, INDEX_UP)
SWITCH_THEN_INDEX_BELOW = (FIND, LEAVE, ENTER, INDEX_DOWN)


def reference_steps(axis: AxisConfig, position: float, on_switch: bool) -> tuple[Step, ...]:
    """Return the steps of an axis that stands at `position`; none if it has neither switch nor index pulse."""
    switch, index = axis.reference_switch, axis.index_pulse
    if switch is None:
        if index is None:
            return ()
        return (INDEX_UP if index > position else INDEX_DOWN,)
    found: tuple[Step, ...] = SWITCH_ONLY
    if index is not None:
        found = SWITCH_THEN_INDEX_ABOVE if index > switch else SWITCH_THEN_INDEX_BELOW
    return (LEAVE_FAST, *found) if on_switch else found
