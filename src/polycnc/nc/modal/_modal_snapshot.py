"""What was in force with one block."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

from polycnc.nc.modal._placement import Placement, Shifts


@dataclass(frozen=True, slots=True)
class Spindle:
    """Hold what the program asked of the spindle: direction 1 clockwise, -1 counter-clockwise, 0 stopped or `oriented`.

    `speed` is in revolutions per minute, or in m/min with constant surface speed; then the spindle turns with `clamp`
    revolutions per minute at the most. `speed_said` tells S0 from a program that leaves the speed to the operator.
    `coolant` are the M codes of coolant that is on.
    """

    speed: float = 0.0
    speed_said: bool = False
    direction: int = 0
    surface_speed: bool = False
    clamp: float = math.inf
    oriented: bool = False
    coolant: tuple[int, ...] = ()


class ModalSnapshot(NamedTuple):
    """Hold what was in force with one block, to be shown while it is executed; see `ChannelState`."""

    whole: bytes  # `Modal.whole`
    feed: float  # as programmed
    offset: bytes  # `Modal.offset`
    work: tuple[str, ...]
    spindle: Spindle
    cycle: str
    retract_to_initial: bool
    tool: int
    selected_tool: int
    side: int
    compensation_tool: int | None
    length_sign: int
    length_tool: int
    m_codes: tuple[int, ...]
    placement: Placement
    shifts: Shifts
