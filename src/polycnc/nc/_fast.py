"""The compiled modal kernel: runs of plain motion blocks go straight from words into the channel queue.

It knows straight and circular motion, planes, units, absolute and incremental, exact stop and feed. At the first
block that holds anything else, or anything wrong, it stops without having changed anything for that block, and the
ordinary interpreter takes it. So it needs no errors of its own, and both ways give the same motion.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from polycnc.kernel import (
    RAPID,
    STOP,
    AxisLimits,
    Paths,
    Segments,
    append_arc,
    append_line,
    compiled,
    entry,
    free_slots,
)
from polycnc.nc._actions import Action
from polycnc.nc._arcs import ARC_OK, arc_by_center, arc_by_radius
from polycnc.nc._dialect import DialectTables
from polycnc.nc._modal import (
    ABSOLUTE,
    ARC_ABSOLUTE,
    ARC_RELATIVE,
    ARC_TOLERANCE,
    AXIS_P,
    AXIS_Q,
    EXACT_STOP,
    FEED,
    FEED_MODE,
    FEED_PER_MINUTE,
    INCH,
    MOTION,
    MOTION_ARC_CCW,
    MOTION_ARC_CW,
    MOTION_LINEAR,
    MOTION_RAPID,
    ORDINARY,
    RAPID_STOP,
    WORD_P,
    WORD_Q,
    Floats,
    Modal,
)
from polycnc.nc._scan import COMMENT, WordColumns
from polycnc.units import MM_PER_INCH

# Why it stopped.
ALL_DONE = 0
NOT_PLAIN = 1
QUEUE_FULL = 2

RESERVE = 8  # slots that the ordinary path may need for one block

_LETTERS = 26
_A = ord("A")
_F, _G, _I, _J, _K, _N, _R = (ord(letter) - _A for letter in "FGIJKNR")
_RAPID = int(Action.RAPID)
_LINEAR = int(Action.LINEAR)
_ARC_CW = int(Action.ARC_CW)
_ARC_CCW = int(Action.ARC_CCW)
_ABSOLUTE = int(Action.ABSOLUTE)
_INCREMENTAL = int(Action.INCREMENTAL)
_EXACT_STOP = int(Action.EXACT_STOP)
_CONTINUOUS = int(Action.CONTINUOUS)
_PER_MINUTE = int(Action.FEED_PER_MINUTE)


class FastWork(NamedTuple):
    """Scratch of the compiled kernel: words of one block by letter, and the point it goes to."""

    value: Floats  # [26]
    seen: npt.NDArray[np.uint8]  # [26]
    target: Floats  # [n]


def make_fast_work(axes: int) -> FastWork:
    """Allocate the scratch for `axes` axes."""
    return FastWork(np.zeros(_LETTERS), np.zeros(_LETTERS, np.uint8), np.zeros(axes))


@entry
def run_plain(
    words: WordColumns,
    block: int,
    tables: DialectTables,
    modal: Modal,
    seg: Segments,
    paths: Paths,
    g: int,
    limits: AxisLimits,
    work: FastWork,
) -> tuple[int, int]:
    """Interpret plain blocks from `block` on; return the first block that was not taken, and why."""
    n_blocks = int(words.counts[1])
    if modal.whole[ORDINARY] != 0:
        return block, NOT_PLAIN
    while block < n_blocks:
        if free_slots(paths, g) <= RESERVE:
            return block, QUEUE_FULL
        if (words.flags[block] & ~COMMENT) != 0 or words.skip_level[block] != 0:
            return block, NOT_PLAIN
        if not _run_block(words, block, tables, modal, seg, paths, g, limits, work):
            return block, NOT_PLAIN
        block += 1
    return block, ALL_DONE


@compiled
def _run_block(
    words: WordColumns,
    block: int,
    tables: DialectTables,
    modal: Modal,
    seg: Segments,
    paths: Paths,
    g: int,
    limits: AxisLimits,
    work: FastWork,
) -> bool:
    whole = modal.whole
    motion = whole[MOTION]
    absolute = whole[ABSOLUTE]
    exact_stop = whole[EXACT_STOP]
    feed_mode = whole[FEED_MODE]
    motion_seen = False
    distance_seen = False
    stop_seen = False
    feed_mode_seen = False
    axis_words = 0
    work.seen[:] = 0
    for w in range(words.first_word[block], words.first_word[block + 1]):
        letter = int(words.letter[w]) - _A
        if letter < 0 or letter >= _LETTERS:
            return False
        value = words.value[w]
        if letter == _G:
            code = int(value * 10.0 + 0.5)
            if value < 0.0 or code >= tables.g_action.shape[0] or value * 10.0 != code:
                return False
            action = tables.g_action[code]
            if action == _RAPID or action == _LINEAR or action == _ARC_CW or action == _ARC_CCW:
                if motion_seen:
                    return False
                motion_seen = True
                if action == _RAPID:
                    motion = MOTION_RAPID
                elif action == _LINEAR:
                    motion = MOTION_LINEAR
                elif action == _ARC_CW:
                    motion = MOTION_ARC_CW
                else:
                    motion = MOTION_ARC_CCW
            elif action == _ABSOLUTE or action == _INCREMENTAL:
                if distance_seen:
                    return False
                distance_seen = True
                absolute = 1 if action == _ABSOLUTE else 0
            elif action == _EXACT_STOP or action == _CONTINUOUS:
                if stop_seen:
                    return False
                stop_seen = True
                exact_stop = 1 if action == _EXACT_STOP else 0
            elif action == _PER_MINUTE and feed_mode == FEED_PER_MINUTE and not feed_mode_seen:
                feed_mode_seen = True
            else:
                return False  # planes, units and all else are rare enough for the ordinary path
            continue
        if work.seen[letter] != 0:
            return False
        work.seen[letter] = 1
        work.value[letter] = value * 1.0
        if modal.letter_axis[letter] >= 0:
            axis_words += 1
            if tables.least_input > 0.0 and words.point[w] == 0:
                return False
        elif letter == _I or letter == _J or letter == _K or letter == _R:
            if tables.least_input > 0.0 and words.point[w] == 0:
                return False
        elif letter != _N and letter != _F:
            return False
    return _go(
        words, block, modal, seg, paths, g, limits, work, motion, absolute, exact_stop, feed_mode, axis_words
    )


@compiled
def _go(
    words: WordColumns,
    block: int,
    modal: Modal,
    seg: Segments,
    paths: Paths,
    g: int,
    limits: AxisLimits,
    work: FastWork,
    motion: int,
    absolute: int,
    exact_stop: int,
    feed_mode: int,
    axis_words: int,
) -> bool:
    whole = modal.whole
    inch = MM_PER_INCH if whole[INCH] != 0 else 1.0
    feed = modal.real[FEED]
    if work.seen[_F] != 0:
        if feed_mode != FEED_PER_MINUTE or work.value[_F] <= 0.0:
            return False
        feed = work.value[_F] * inch
    has_center = work.seen[_I] + work.seen[_J] + work.seen[_K]
    is_arc = motion == MOTION_ARC_CW or motion == MOTION_ARC_CCW
    if axis_words + has_center + work.seen[_R] > 0:
        if (
            motion < MOTION_RAPID
            or motion > MOTION_ARC_CCW
            or (not is_arc and has_center + work.seen[_R] > 0)
        ):
            return False
        if motion != MOTION_RAPID and (feed <= 0.0 or feed_mode != FEED_PER_MINUTE):
            return False
        if not _target(modal, work, absolute):
            return False
        flags = RAPID if motion == MOTION_RAPID else 0
        if exact_stop != 0 or (motion == MOTION_RAPID and whole[RAPID_STOP] != 0):
            flags |= STOP
        speed = math.inf if motion == MOTION_RAPID else feed / 60.0
        tag = words.line[block]
        if is_arc:
            if not _arc(
                modal, seg, paths, g, limits, work, motion == MOTION_ARC_CW, has_center, speed, flags, tag
            ):
                return False
        else:
            if inch != 1.0 and motion == MOTION_LINEAR and _only_rotary(modal, work):
                return False
            append_line(seg, paths, g, limits, work.target, speed, flags, tag)
        for i in range(work.target.shape[0]):
            modal.position[i] = work.target[i]
    whole[MOTION] = motion
    whole[ABSOLUTE] = absolute
    whole[EXACT_STOP] = exact_stop
    modal.real[FEED] = feed
    return True


@compiled
def _target(modal: Modal, work: FastWork, absolute: int) -> bool:
    """Put the programmed end point into `work.target`; False if it lies outside the soft limits."""
    for i in range(work.target.shape[0]):
        work.target[i] = modal.position[i]
    for letter in range(_LETTERS):
        axis = modal.letter_axis[letter]
        if axis >= 0 and work.seen[letter] != 0:
            step = work.value[letter] * modal.scale[axis]
            work.target[axis] = step + modal.offset[axis] if absolute != 0 else modal.position[axis] + step
            if not modal.low[axis] <= work.target[axis] <= modal.high[axis]:
                return False
    return True


@compiled
def _only_rotary(modal: Modal, work: FastWork) -> bool:
    for i in range(work.target.shape[0]):
        if modal.rotary[i] == 0 and work.target[i] != modal.position[i]:
            return False
    return True


@compiled
def _arc(
    modal: Modal,
    seg: Segments,
    paths: Paths,
    g: int,
    limits: AxisLimits,
    work: FastWork,
    clockwise: bool,
    has_center: int,
    speed: float,
    flags: int,
    tag: int,
) -> bool:
    whole = modal.whole
    p, q = whole[AXIS_P], whole[AXIS_Q]
    in_plane = work.seen[whole[WORD_P]] + work.seen[whole[WORD_Q]]
    if p < 0 or q < 0 or in_plane != has_center or whole[ARC_ABSOLUTE] != 0:
        return False
    start_p, start_q = modal.position[p], modal.position[q]
    end_p, end_q = work.target[p], work.target[q]
    if work.seen[_R] != 0:
        if has_center != 0:
            return False
        radius = work.value[_R] * modal.scale[p]
        status, center_p, center_q, sweep, _ = arc_by_radius(
            start_p, start_q, end_p, end_q, radius, clockwise, modal.real[ARC_TOLERANCE]
        )
    else:
        if has_center == 0:
            return False
        center_p = start_p
        center_q = start_q
        if work.seen[whole[WORD_P]] != 0:
            center_p += work.value[whole[WORD_P]] * modal.scale[p]
        if work.seen[whole[WORD_Q]] != 0:
            center_q += work.value[whole[WORD_Q]] * modal.scale[q]
        status, center_p, center_q, sweep, _ = arc_by_center(
            start_p,
            start_q,
            end_p,
            end_q,
            center_p,
            center_q,
            clockwise,
            1,
            modal.real[ARC_TOLERANCE],
            modal.real[ARC_RELATIVE],
        )
    if status != ARC_OK:
        return False
    radius = math.hypot(start_p - center_p, start_q - center_q)
    if not (
        modal.low[p] <= center_p - radius
        and center_p + radius <= modal.high[p]
        and modal.low[q] <= center_q - radius
        and center_q + radius <= modal.high[q]
    ):
        return False  # the ordinary path looks closer
    return append_arc(seg, paths, g, limits, work.target, p, q, center_p, center_q, sweep, speed, flags, tag)
