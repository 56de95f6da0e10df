"""What the compiled modal kernel works with: what letters are, what one block says, and what lasts."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from polycnc.machine import MachineConfig
from polycnc.nc.blocks._events import EventRun
from polycnc.nc.dialect._dialect import DialectTables
from polycnc.nc.fast._carried import (
    AUXILIARY_S,
    CARRIED_COLUMNS,
    IS_LASER,
    MAKES_EVENTS,
    NONE,
    START_S,
    TOP_SPEED,
    Carried,
)
from polycnc.nc.modal._actions import OUTPUT_BIT, OUTPUT_VALUE
from polycnc.nc.modal._modal import NO_AXIS, Floats, Ints, Modal, has_diameters

# What a letter is, besides G.
UNKNOWN = 0
NUMBER = 1
LENGTH = 2
LASTING = 3
OUTPUT = 4

# Columns of `said`: what a block says, and the letters of each sort as bits.
SAYS_MOTION, SAYS_ABSOLUTE, SEEN, AXES, CENTERS, RADIUS, MARKED, SAYS_SENSE, EVENTS, FIRST_EVENT = range(10)
_SAID_COLUMNS = 10

LETTERS = 26
LETTER_A = ord("A")
_D, _E, _F, _H, _I, _J, _K, _M, _N, _P, _Q, _R, _S, _T = (
    ord(letter) - LETTER_A for letter in "DEFHIJKMNPQRST"
)


class FastWork(NamedTuple):
    """Scratch of the compiled kernel: what letters are, what one block says, and the point it goes to."""

    role: npt.NDArray[np.int8]  # [26]
    axis_letter: npt.NDArray[np.int8]  # [n] letter of each axis, NO_AXIS if its name is longer
    value: Floats  # [26]
    said: Ints
    target: Floats  # [n]
    marks: Ints  # [blocks, 2] of blocks with words and without motion: segment count before which they stand, tag
    carried: Floats
    events: Floats  # [most, 3] of the present call: see `EventRun`
    event_tags: Ints  # [most]
    arc: Floats  # [3] centre and sweep of the arc of the present block
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
    blocks: int,
    *,
    marks: bool = False,
    feed_needs_point: bool = False,
    machine: MachineConfig,
    answers: bool = False,
) -> FastWork:
    """Allocate the scratch for the axes of `modal`; `blocks` is the most of one call, with `marks` they are marked.

    With `feed_needs_point` F counts increments where lengths do, if it has no decimal point. With `answers` the path
    stands at functions for whoever runs it: blocks with S and M are no plain ones then, but for the power of a laser.
    """
    role = np.full(LETTERS, UNKNOWN, np.int8)
    role[[_N, _F]] = NUMBER
    role[[_D, _H]] = LASTING
    if tables.selects:
        role[_T] = LASTING
    if OUTPUT_BIT in tables.m_sense or OUTPUT_VALUE in tables.m_sense:
        role[[_P, _E, _Q]] = OUTPUT
    carried = np.full(CARRIED_COLUMNS, NONE)
    spindle, times = machine.spindle, machine.times
    carried[TOP_SPEED] = spindle.max_rpm
    carried[MAKES_EVENTS], carried[IS_LASER] = not answers, spindle.laser
    carried[START_S], carried[AUXILIARY_S] = times.spindle_start_s, times.auxiliary_s
    if feed_needs_point:
        role[_F] = LENGTH
    if not has_diameters(modal):  # else centres and radii are scaled otherwise than positions
        role[[_I, _J, _K, _R]] = LENGTH
    for code in machine.programs.remaps:
        role[ord(code[0]) - LETTER_A] = UNKNOWN
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
        np.zeros((blocks if marks else 0, 2), np.int64),
        carried,
        np.zeros((2 * blocks, 3)),
        np.zeros(2 * blocks, np.int64),
        np.zeros(3),
        tables.m_sense,
    )


def with_room(work: FastWork, blocks: int) -> FastWork:
    """Return the scratch with room for calls of so many blocks; the same where it has that already."""
    if 2 * blocks <= len(work.events):
        return work
    return work._replace(
        marks=np.zeros((blocks if len(work.marks) else 0, 2), np.int64),
        events=np.zeros((2 * blocks, 3)),
        event_tags=np.zeros(2 * blocks, np.int64),
    )


def begin_run(work: FastWork, first_event: int, *, functions: bool) -> None:
    """Say before a call how its events are numbered, and whether S and M are words of plain blocks."""
    work.said[FIRST_EVENT] = first_event
    work.role[[_S, _M]] = LASTING if functions else UNKNOWN


def events_made(work: FastWork) -> EventRun | None:
    """Return the events of the last call, None if there are none; the last ones may wait for a motion yet."""
    made = work.said[EVENTS]
    if not made:
        return None
    said = work.events[:made].T.copy()
    return EventRun(said[0], said[1], said[2], work.event_tags[:made].copy())


def marked(work: FastWork) -> list[tuple[int, int]]:
    """Return the marks of the last call."""
    return [(count, tag) for count, tag in work.marks[: work.said[MARKED]].tolist()]
