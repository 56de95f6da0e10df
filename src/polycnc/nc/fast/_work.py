"""What the compiled modal kernel works with: what letters are, what one block says, and what lasts."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from polycnc.nc.dialect._dialect import DialectTables
from polycnc.nc.fast._carried import CARRIED_COLUMNS, NONE, TOP_SPEED, Carried
from polycnc.nc.modal._modal import NO_AXIS, Floats, Ints, Modal, has_diameters

# What a letter is, besides G.
UNKNOWN = 0
NUMBER = 1
LENGTH = 2
LASTING = 3

# Columns of `said`: what a block says, and the letters of each sort as bits.
SAYS_MOTION, SAYS_ABSOLUTE, SEEN, AXES, CENTERS, RADIUS, MARKED, SAYS_SENSE = range(8)
_SAID_COLUMNS = 8

LETTERS = 26
LETTER_A = ord("A")
_D, _F, _H, _I, _J, _K, _M, _N, _R, _S, _T = (ord(letter) - LETTER_A for letter in "DFHIJKMNRST")


class FastWork(NamedTuple):
    """Scratch of the compiled kernel: what letters are, what one block says, and the point it goes to."""

    role: npt.NDArray[np.int8]  # [26]
    axis_letter: npt.NDArray[np.int8]  # [n] letter of each axis, NO_AXIS if its name is longer
    value: Floats  # [26]
    said: Ints
    target: Floats  # [n]
    marks: Ints  # [blocks, 2] of blocks with words and without motion: segment count before which they stand, tag
    carried: Floats
    m_sense: npt.NDArray[np.int8]  # of each M code, see `DialectTables`


def carry(work: FastWork, carried: Carried) -> None:
    """Let the words of `carried` be in force."""
    work.carried[:TOP_SPEED] = carried


def carried_by(work: FastWork) -> Carried:
    """Return the words that are in force behind the last call."""
    return Carried(*work.carried[:TOP_SPEED].tolist())


def make_fast_work(
    modal: Modal,
    tables: DialectTables,
    marks: int = 0,
    *,
    feed_needs_point: bool = False,
    laser_top: float | None = None,
) -> FastWork:
    """Allocate the scratch for the axes of `modal`; `marks` is the most blocks of one call, or 0 for no marks.

    With `feed_needs_point` F counts increments where lengths do, if it has no decimal point. S and the M codes of the
    spindle are plain on a machine with a laser, whose highest power is `laser_top`.
    """
    role = np.full(LETTERS, UNKNOWN, np.int8)
    role[[_N, _F]] = NUMBER
    role[[_D, _H]] = LASTING
    if tables.selects:
        role[_T] = LASTING
    carried = np.full(CARRIED_COLUMNS, NONE)
    if laser_top is not None:
        role[[_S, _M]] = LASTING
        carried[TOP_SPEED] = laser_top
    if feed_needs_point:
        role[_F] = LENGTH
    if not has_diameters(modal):  # else centres and radii are scaled otherwise than positions
        role[[_I, _J, _K, _R]] = LENGTH
    axis_letter = np.full(len(modal.position), NO_AXIS, np.int8)
    said = np.zeros(_SAID_COLUMNS, np.int64)
    said[CENTERS] = 1 << _I | 1 << _J | 1 << _K
    said[RADIUS] = 1 << _R
    for letter, axis in enumerate(modal.letter_axis):
        if axis != NO_AXIS:
            role[letter] = LENGTH
            axis_letter[axis] = letter
            said[AXES] |= 1 << letter
    said[RADIUS] &= ~said[AXES]  # on a machine with an axis R it is that axis
    target = np.zeros(len(modal.position))
    return FastWork(
        role,
        axis_letter,
        np.zeros(LETTERS),
        said,
        target,
        np.zeros((marks, 2), np.int64),
        carried,
        tables.m_sense,
    )


def marked(work: FastWork) -> list[tuple[int, int]]:
    """Return the marks of the last call."""
    return [(count, tag) for count, tag in work.marks[: work.said[MARKED]].tolist()]
