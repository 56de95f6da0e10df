"""Words that last from block to block and stop nothing: the power of a laser, and words that only choose a tool."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from polycnc.kernel import compiled
from polycnc.nc.blocks._words import LARGEST_NUMBER
from polycnc.nc.modal._actions import COOLANT_OFF, COOLANT_ON, NO_SENSE, OUTPUT_BIT, OUTPUT_VALUE

# Columns of `carried`: NONE before the first; of M the code.
SPEED, SENSE, M_CODE, TOOL, RADIUS_TOOL, LENGTH_TOOL, TOP_SPEED = range(7)
# Whether words may stop the path, whether those of the spindle are a laser's power, and how long functions take.
MAKES_EVENTS, IS_LASER, START_S, AUXILIARY_S = range(7, 11)
CARRIED_COLUMNS = 11
NONE = -1.0

_D, _E, _H, _M, _P, _Q, _S, _T = (ord(letter) - ord("A") for letter in "DEHMPQST")
S_COLUMN, M_COLUMN, Q_COLUMN = _S, _M, _Q
FUNCTIONS = 1 << _S | 1 << _M
OUTPUT_WORDS = 1 << _E | 1 << _P | 1 << _Q
BIT = -2.0  # number of an output whose words are only P
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
def is_output(seen: int, sense: int) -> bool:
    """Tell whether a block has an output in step with motion."""
    return (seen & 1 << _M) != 0 and sense in (OUTPUT_BIT, OUTPUT_VALUE)


@compiled
def turns_spindle(seen: int, sense: int) -> bool:
    """Tell whether a block has an M code of the spindle."""
    return (seen & 1 << _M) != 0 and not switches_coolant(sense) and not is_output(seen, sense)


@compiled
def words_fit(seen: int, sense: int, value: Floats, carried: Floats) -> bool:
    """Tell whether the words of outputs in a block are those of its output; the power of a laser becomes S."""
    words = seen & OUTPUT_WORDS
    if not is_output(seen, sense):
        return words == 0
    if seen & 1 << _S:
        return False
    if sense == OUTPUT_BIT:
        return bool(words == 1 << _P and _is_number(value[_P]))
    if words != (1 << _E | 1 << _Q) or not _is_number(value[_E]):
        return False
    return bool(not is_power(value, carried) or 0.0 <= value[_Q] <= carried[TOP_SPEED])


@compiled
def is_power(value: Floats, carried: Floats) -> bool:
    """Tell whether the output of a block, which has a value, is the power of a laser."""
    return bool(carried[IS_LASER] != 0.0 and value[_E] == 0.0)


@compiled
def output_of(sense: int, value: Floats) -> tuple[float, float]:
    """Return the number of the output of a block and its value, which is the number of a BIT."""
    return (BIT, value[_P]) if sense == OUTPUT_BIT else (value[_E], value[_Q])


@compiled
def _is_number(value: float) -> bool:
    return 0.0 <= value <= LARGEST_NUMBER and value % 1.0 == 0.0


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
    return _is_number(value)


@compiled
def changes_power(seen: int, sense: int, value: Floats, carried: Floats) -> bool:
    """Tell whether a block changes the power of a laser."""
    if carried[IS_LASER] == 0.0:
        return False
    speaks = (seen & 1 << _S) != 0 and value[_S] != carried[SPEED]
    return bool(speaks or (turns_spindle(seen, sense) and sense != carried[SENSE]))


@compiled
def events_of(seen: int, sense: int, value: Floats, carried: Floats) -> tuple[float, float, float]:
    """Return S alone, an M code, each NONE for none, and how long the function of the M code takes.

    They are what a block stops the path for, in this order; S beside a code of the spindle belongs to that.
    """
    speaks, functions = (seen & 1 << _S) != 0, (seen & 1 << _M) != 0
    turns = turns_spindle(seen, sense)
    laser = carried[IS_LASER] != 0.0
    alone = value[_S] if speaks and not turns and not laser else NONE
    if not functions or (turns and laser) or is_output(seen, sense):
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
        if turns_spindle(seen, sense):
            carried[SENSE] = sense
    if seen & 1 << _T:
        carried[TOOL] = value[_T]
    if seen & 1 << _D:
        carried[RADIUS_TOOL] = value[_D]
