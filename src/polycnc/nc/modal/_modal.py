"""The modal state of a program, in arrays that compiled and ordinary interpretation share.

What only the ordinary path needs (cycles, tools, the spindle) lives in `ChannelState`; what a plain motion
block reads or writes lives here.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from polycnc.machine import LARGEST_POSITION
from polycnc.units import MM_PER_INCH

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

# Columns of `whole`.
MOTION, PLANE, AXIS_P, AXIS_Q, AXIS_R, WORD_P, WORD_Q, ABSOLUTE, ARC_ABSOLUTE, FEED_MODE = range(10)
EXACT_STOP, RAPID_STOP, INCH = 10, 11, 12
ORDINARY = 13  # something is active that only the ordinary path knows
EXACT_PATH = 14  # the path rests in corners, and goes on where there are none
STOPS_SUPPRESSED = 15  # exact stops do not act, whatever was programmed
WHOLE_COLUMNS = 16

# Columns of `real`.
FEED, ARC_TOLERANCE, ARC_RELATIVE = 0, 1, 2
FEED_NUMBER = 3  # the feed as it was programmed: of moves that only turn, it is in degrees in any unit
SLOWEST_AXIS = 4  # the highest speed of the slowest axis, mm/s or deg/s
ARC_INCH_TOLERANCE = 5  # that of arcs where G20 is in force
ARC_SHORT_RADIUS = 6
ARC_MOST = 7  # how many tolerances an arc may be off however large it is
REAL_COLUMNS = 8

# Values of MOTION; a drilling cycle leaves it as it was.
MOTION_NONE = -1
MOTION_RAPID = 0
MOTION_LINEAR = 1
MOTION_ARC_CW = 2
MOTION_ARC_CCW = 3
MOTION_CUBIC = 4  # a spline is traversed by its own block only: these are never in force after it
MOTION_QUADRATIC = 5
MOTION_NURBS = 6  # up to the block that ends it

# Values of PLANE.
PLANE_XY = 0
PLANE_ZX = 1
PLANE_YZ = 2
PLANE_LETTERS = ("XYZ", "ZXY", "YZX")
CENTER_LETTERS = ("IJ", "KI", "JK")

# Values of FEED_MODE.
FEED_PER_MINUTE = 0
FEED_PER_REVOLUTION = 1
FEED_INVERSE_TIME = 2

# Values of `rotary`.
LINEAR_AXIS = 0
ROTARY_AXIS = 1
MODULO_AXIS = 2  # positions repeat every turn

NO_AXIS = -1

LARGEST = LARGEST_POSITION

TURN_DEG = 360.0


class Modal(NamedTuple):
    """Hold the modal state of one channel with n axes.

    `machine position = program value * scale + offset`; `position` is the last programmed position in machine
    coordinates, before tool radius compensation.
    """

    whole: Ints
    real: Floats
    position: Floats  # [n]
    offset: Floats  # [n] work offset, G92 shift and tool length together
    scale: Floats  # [n] mm per program unit, 1 for rotary axes
    rotary: npt.NDArray[np.uint8]  # [n] LINEAR_AXIS, ROTARY_AXIS or MODULO_AXIS
    low: Floats  # [n] soft limits, at most LARGEST
    high: Floats  # [n]
    letter_axis: Ints  # [26] axis of each letter, NO_AXIS if it is none


def make_modal(
    names: Sequence[str],
    rotary: Sequence[int],
    low: Sequence[float],
    high: Sequence[float],
    slowest_axis: float = math.inf,
) -> Modal:
    """Make the state at program start for axes of these names; set the dialect's initial state afterwards.

    `rotary` says of each axis whether it is a LINEAR_AXIS, a ROTARY_AXIS or a MODULO_AXIS.
    """
    letter_axis = np.full(26, NO_AXIS, np.int64)
    for index, name in enumerate(names):
        if len(name) == 1:
            letter_axis[ord(name) - ord("A")] = index
    n = len(names)
    modal = Modal(
        *_columns(n),
        rotary=np.array(rotary, np.uint8),
        low=np.maximum(np.array(low, np.float64), -LARGEST),
        high=np.minimum(np.array(high, np.float64), LARGEST),
        letter_axis=letter_axis,
    )
    modal.scale[:] = 1.0
    modal.whole[ABSOLUTE] = 1
    modal.real[SLOWEST_AXIS] = slowest_axis
    set_plane(modal, PLANE_XY)
    return modal


def set_plane(modal: Modal, plane: int) -> None:
    """Select the working plane; axes that the machine lacks become NO_AXIS."""
    whole = modal.whole
    whole[PLANE] = plane
    for column, letter in zip((AXIS_P, AXIS_Q, AXIS_R), PLANE_LETTERS[plane], strict=True):
        whole[column] = modal.letter_axis[ord(letter) - ord("A")]
    for column, letter in zip((WORD_P, WORD_Q), CENTER_LETTERS[plane], strict=True):
        whole[column] = ord(letter) - ord("A")


def set_inch(modal: Modal, inch: bool) -> None:
    """Select inch or metric words; rotary axes stay in degrees."""
    before = MM_PER_INCH if modal.whole[INCH] else 1.0
    modal.whole[INCH] = inch
    # What is left beside the unit is 1, or 0.5 where words are diameters.
    linear = modal.scale / before * (MM_PER_INCH if inch else 1.0)
    modal.scale[:] = np.where(modal.rotary != 0, 1.0, linear)


def set_diameters(modal: Modal, axes: Sequence[int]) -> None:
    """Let words of these axes be diameters: positions are radii."""
    for axis in axes:
        modal.scale[axis] *= 0.5


def set_diameter(modal: Modal, axis: int, diameter: bool) -> None:
    """Let words of an axis be diameters, or what they are to others."""
    modal.scale[axis] = length_scale(modal) * (0.5 if diameter else 1.0)


def length_scale(modal: Modal) -> float:
    """Return mm per program unit of what is no position: radii, centres, ways."""
    return MM_PER_INCH if modal.whole[INCH] else 1.0


def has_diameters(modal: Modal) -> bool:
    """Tell whether words of an axis are diameters."""
    return bool(np.any((modal.rotary == 0) & (modal.scale != length_scale(modal))))


def short_way(wanted_deg: float, position_deg: float) -> float:
    """Return `wanted_deg` plus the whole turns that bring it next to `position_deg`; half a turn goes up."""
    return wanted_deg - TURN_DEG * math.ceil((wanted_deg - position_deg - 0.5 * TURN_DEG) / TURN_DEG)


CHANGING = slice(0, 5)
"""The columns of `Modal` that blocks may change: up to `scale`."""


def _columns(axes: int) -> tuple[Ints, Floats, Floats, Floats, Floats]:
    """Return the columns that blocks may change, as parts of one array: so all are copied at once."""
    memory = np.zeros(WHOLE_COLUMNS + REAL_COLUMNS + 3 * axes)
    begin = WHOLE_COLUMNS + REAL_COLUMNS
    first, second, third = (memory[begin + k * axes : begin + (k + 1) * axes] for k in range(3))
    return memory[:WHOLE_COLUMNS].view(np.int64), memory[WHOLE_COLUMNS:begin], first, second, third


def changing(modal: Modal) -> Floats:
    """Return the columns that blocks may change, as one array to be copied: the numbers in it mean nothing."""
    memory: Floats | None = modal.whole.base
    assert memory is not None
    return memory


def copy_modal(modal: Modal) -> Modal:
    """Return the same state with columns of its own for what blocks may change."""
    whole, real, position, offset, scale = _columns(len(modal.position))
    made = modal._replace(whole=whole, real=real, position=position, offset=offset, scale=scale)
    changing(made)[:] = changing(modal)
    return made
