"""Words that last from block to block and stop nothing: the power of a laser, and words that only choose a tool."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from polycnc.kernel import compiled
from polycnc.nc.blocks._words import LARGEST_NUMBER
from polycnc.nc.modal._actions import COOLANT_OFF, COOLANT_ON, NO_SENSE

# Columns of `carried`: NONE before the first; of M the code.
SPEED, SENSE, M_CODE, TOOL, RADIUS_TOOL, LENGTH_TOOL, TOP_SPEED = range(7)
# Whether words may stop the path, whether those of the spindle are a laser's power, and how long functions take.
MAKES_EVENTS, IS_LASER, START_S, AUXILIARY_S = range(7, 11)
CARRIED_COLUMNS = 11
NONE = -1.0

_D, _H, _M, _S, _T = (ord(letter) - ord("A") for letter in "DHMST")
S_COLUMN = _S
FUNCTIONS = 1 << _S | 1 << _M
CARRIED_WORDS = 1 << _S | 1 << _M | 1 << _T | 1 << _D

Floats = npt.NDArray[np.float64]


class Carried(NamedTuple):
    """Words that last from block to block without a stop, NONE where there is none.

    `speed` and `sense` are those of a laser, `m_code` is the last M code said, `tool` comes with the next change,
    `radius_tool` is D, and `length_tool` an H that changes nothing if it is said again.
    """

    speed: float
    sense: float
    m_code: float
    tool: float
    radius_tool: float
    length_tool: float


@compiled
def switches_coolant(sense: int) -> bool:
    """Tell whether what an M code does is to switch coolant."""
    return sense in (COOLANT_ON, COOLANT_OFF)


@compiled
def sense_of(code: float, m_sense: npt.NDArray[np.int8]) -> int:
    """Return what an M code switches, see `M_SENSES`, or NO_SENSE."""
    if not 0.0 <= code < m_sense.shape[0] or code != math.floor(code):
        return NO_SENSE
    return int(m_sense[int(code)])


@compiled
def lasts(letter: int, value: float, sense: int, carried: Floats) -> bool:
    """Tell whether a word is such that it is only taken note of; an H that changes a length is not."""
    if letter == _M:
        return sense != NO_SENSE and not (switches_coolant(sense) and carried[MAKES_EVENTS] == 0.0)
    if letter == _S:
        return bool(0.0 <= value <= carried[TOP_SPEED])
    if letter == _H:
        return bool(carried[LENGTH_TOOL] != NONE and value == carried[LENGTH_TOOL])
    return 0.0 <= value <= LARGEST_NUMBER and value % 1.0 == 0.0


@compiled
def changes_power(seen: int, sense: int, value: Floats, carried: Floats) -> bool:
    """Tell whether a block changes the power of a laser."""
    if carried[IS_LASER] == 0.0:
        return False
    speaks = (seen & 1 << _S) != 0 and value[_S] != carried[SPEED]
    turns = (seen & 1 << _M) != 0 and not switches_coolant(sense)
    return bool(speaks or (turns and sense != carried[SENSE]))


@compiled
def events_of(seen: int, sense: int, value: Floats, carried: Floats) -> tuple[float, float, float]:
    """Return S alone, an M code, each NONE for none, and how long the function of the M code takes.

    They are what a block stops the path for, in this order; S beside a code of the spindle belongs to that.
    """
    speaks, functions = (seen & 1 << _S) != 0, (seen & 1 << _M) != 0
    turns = functions and not switches_coolant(sense)
    laser = carried[IS_LASER] != 0.0
    alone = value[_S] if speaks and not turns and not laser else NONE
    if not functions or (turns and laser):
        return alone, NONE, 0.0
    if not turns:
        return alone, value[_M], carried[AUXILIARY_S]
    changes = speaks or sense != carried[SENSE]
    return alone, value[_M], carried[START_S] if changes else 0.0


@compiled
def take_note(seen: int, sense: int, value: Floats, carried: Floats) -> None:
    """Keep what a block says that lasts."""
    if seen & 1 << _S:
        carried[SPEED] = value[_S]
    if seen & 1 << _M:
        carried[M_CODE] = value[_M]
        if not switches_coolant(sense):
            carried[SENSE] = sense
    if seen & 1 << _T:
        carried[TOOL] = value[_T]
    if seen & 1 << _D:
        carried[RADIUS_TOOL] = value[_D]
