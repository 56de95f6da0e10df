"""Words that last from block to block and stop nothing: the power of a laser, and words that only choose a tool."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from polycnc.kernel import compiled
from polycnc.nc.blocks._words import LARGEST_NUMBER
from polycnc.nc.modal._actions import NO_SENSE

# Columns of `carried`: NONE before the first; of M the code.
SPEED, SENSE, M_CODE, TOOL, RADIUS_TOOL, LENGTH_TOOL, TOP_SPEED = range(7)
CARRIED_COLUMNS = 7
NONE = -1.0

_D, _H, _M, _S, _T = (ord(letter) - ord("A") for letter in "DHMST")
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
def sense_of(code: float, m_sense: npt.NDArray[np.int8]) -> int:
    """Return which way an M code lets the spindle turn, NO_SENSE for all others."""
    if not 0.0 <= code < m_sense.shape[0] or code != math.floor(code):
        return NO_SENSE
    return int(m_sense[int(code)])


@compiled
def lasts(letter: int, value: float, sense: int, carried: Floats) -> bool:
    """Tell whether a word is such that it is only taken note of; an H that changes a length is not."""
    if letter == _M:
        return sense != NO_SENSE
    if letter == _S:
        return bool(0.0 <= value <= carried[TOP_SPEED])
    if letter == _H:
        return bool(carried[LENGTH_TOOL] != NONE and value == carried[LENGTH_TOOL])
    return 0.0 <= value <= LARGEST_NUMBER and value % 1.0 == 0.0


@compiled
def changes_power(seen: int, sense: int, value: Floats, carried: Floats) -> bool:
    """Tell whether a block changes the power of a laser."""
    speaks = (seen & 1 << _S) != 0 and value[_S] != carried[SPEED]
    return bool(speaks or ((seen & 1 << _M) != 0 and sense != carried[SENSE]))


@compiled
def take_note(seen: int, sense: int, value: Floats, carried: Floats) -> None:
    """Keep what a block says that lasts."""
    if seen & 1 << _S:
        carried[SPEED] = value[_S]
    if seen & 1 << _M:
        carried[SENSE], carried[M_CODE] = sense, value[_M]
    if seen & 1 << _T:
        carried[TOOL] = value[_T]
    if seen & 1 << _D:
        carried[RADIUS_TOOL] = value[_D]
