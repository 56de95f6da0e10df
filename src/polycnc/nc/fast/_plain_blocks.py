"""The compiled modal kernel: runs of plain motion blocks go straight from words into the channel queue.

It knows straight and circular motion, absolute and incremental, feed, the power of a laser, and words that only
choose a tool. At the first block that holds anything else, or anything wrong, it stops without having changed
anything for that block, and the reference interpreter takes it. So it needs no errors of its own, and both ways give
the same motion.

A compiled call costs by the arrays that it hands over, so what runs for every block takes those it needs.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from polycnc.kernel import (
    NOT_MERGED,
    NOT_SMALL,
    RAPID,
    STOP,
    AxisLimits,
    Paths,
    Segments,
    add_line,
    append_arc,
    append_line,
    append_small_arc,
    close_line,
    compiled,
    entry,
    merge_line,
)
from polycnc.machine import LONGEST_BLOCK_S
from polycnc.nc.blocks._arcs import ARC_OK, arc_by_center, arc_by_radius
from polycnc.nc.dialect._dialect import DialectTables
from polycnc.nc.fast._carried import (
    CARRIED_WORDS,
    FUNCTIONS,
    OUTPUT_WORDS,
    changes_power,
    lasts,
    sense_of,
    take_note,
)
from polycnc.nc.fast._put_events import fits, put_events
from polycnc.nc.fast._work import (
    AXES,
    CENTERS,
    EVENTS,
    LASTING,
    LENGTH,
    LETTER_A,
    LETTERS,
    MARKED,
    NUMBER,
    OUTPUT,
    RADIUS,
    SAYS_ABSOLUTE,
    SAYS_MOTION,
    SAYS_SENSE,
    SEEN,
    FastWork,
)
from polycnc.nc.modal._actions import Action
from polycnc.nc.modal._modal import (
    ABSOLUTE,
    ARC_ABSOLUTE,
    ARC_INCH_TOLERANCE,
    ARC_MOST,
    ARC_RELATIVE,
    ARC_SHORT_RADIUS,
    ARC_TOLERANCE,
    AXIS_P,
    AXIS_Q,
    EXACT_STOP,
    FEED,
    FEED_MODE,
    FEED_NUMBER,
    FEED_PER_MINUTE,
    INCH,
    LARGEST,
    LINEAR_AXIS,
    MODULO_AXIS,
    MOTION,
    MOTION_ARC_CCW,
    MOTION_ARC_CW,
    MOTION_LINEAR,
    MOTION_RAPID,
    ORDINARY,
    RAPID_STOP,
    SLOWEST_AXIS,
    STOPS_SUPPRESSED,
    WORD_P,
    WORD_Q,
    Floats,
    Ints,
    Modal,
    short_way,
)
from polycnc.nc.text._scan import COMMENT, OPEN_VALUE, WordColumns
from polycnc.units import MM_PER_INCH

# Why it stopped.
ALL_DONE = 0
NOT_PLAIN = 1
QUEUE_FULL = 2

RESERVE = 8  # slots that the ordinary path may need for one block

_F, _G, _M, _N, _R = (ord(letter) - LETTER_A for letter in "FGMNR")
_F_BIT = 1 << _F
_RAPID = int(Action.RAPID)
_LINEAR = int(Action.LINEAR)
_ARC_CW = int(Action.ARC_CW)
_ARC_CCW = int(Action.ARC_CCW)
_ABSOLUTE_WORD = int(Action.ABSOLUTE)
_INCREMENTAL_WORD = int(Action.INCREMENTAL)
_PER_MINUTE_WORD = int(Action.FEED_PER_MINUTE)

_short_way = compiled(short_way)


@entry(
    steps=lambda words, block, n_blocks, *_: 2 * (n_blocks - block) + 1,
    spared=lambda end, words, block, n_blocks, *_: 2 * (n_blocks - end[0]),
)
def run_plain(
    words: WordColumns,
    block: int,
    n_blocks: int,
    base: int,
    tables: DialectTables,
    modal: Modal,
    seg: Segments,
    paths: Paths,
    g: int,
    limits: AxisLimits,
    work: FastWork,
) -> tuple[int, int]:
    """Interpret plain blocks from `block` up to `n_blocks`; return the first block that was not taken, and why.

    `base` is added to the line of a block for its reference.
    """
    work.said[MARKED] = 0
    work.said[EVENTS] = 0
    if modal.whole[ORDINARY] != 0:
        return block, NOT_PLAIN
    return _run(words, block, n_blocks, base, tables, modal, seg, paths, g, limits, work)


@compiled
def _run(
    words: WordColumns,
    block: int,
    n_blocks: int,
    base: int,
    tables: DialectTables,
    modal: Modal,
    seg: Segments,
    paths: Paths,
    g: int,
    limits: AxisLimits,
    work: FastWork,
) -> tuple[int, int]:
    whole = modal.whole
    said = work.said
    path = paths.row
    inch = MM_PER_INCH if whole[INCH] != 0 else 1.0
    while block < n_blocks:
        if path[g]["capacity"] - (path[g]["tail"] - path[g]["head"]) <= RESERVE:
            return block, QUEUE_FULL
        if (words.flags[block] & ~COMMENT) != 0 or words.skip_level[block] != 0:
            return block, NOT_PLAIN
        first, after = words.first_word[block], words.first_word[block + 1]
        if not _read(
            words.letter,
            words.value,
            words.point,
            first,
            after,
            tables.g_action,
            tables.least_input,
            whole,
            work,
        ):
            return block, NOT_PLAIN
        if said[SEEN] & (FUNCTIONS | OUTPUT_WORDS) and not fits(paths, g, work):
            return block, NOT_PLAIN
        seen = said[SEEN]
        motion = said[SAYS_MOTION]
        feed, feed_number = modal.real[FEED], modal.real[FEED_NUMBER]
        if seen & _F_BIT:
            feed_number = work.value[_F]
            feed = feed_number * inch
            if whole[FEED_MODE] != FEED_PER_MINUTE or feed <= 0.0:
                return block, NOT_PLAIN
        powers = False
        if seen & CARRIED_WORDS:
            powers = changes_power(seen, said[SAYS_SENSE], work.value, work.carried)
        tag = base + int(words.line[block])
        moves, stopped, joined, before = False, False, NOT_MERGED, 0
        circular = seen & (said[CENTERS] | said[RADIUS])
        if (seen & said[AXES]) | circular:
            is_arc = motion >= MOTION_ARC_CW
            if (circular != 0 and not is_arc) or motion < MOTION_RAPID:
                return block, NOT_PLAIN
            if motion != MOTION_RAPID and (feed <= 0.0 or whole[FEED_MODE] != FEED_PER_MINUTE):
                return block, NOT_PLAIN
            if not _target(
                modal.position, modal.scale, modal.offset, modal.low, modal.high, modal.rotary, work
            ):
                return block, NOT_PLAIN
            flags = RAPID if motion == MOTION_RAPID else 0
            stops = whole[EXACT_STOP] != 0 and whole[STOPS_SUPPRESSED] == 0
            if stops or (motion == MOTION_RAPID and whole[RAPID_STOP] != 0):
                flags |= STOP
            speed = math.inf if motion == MOTION_RAPID else feed / 60.0
            if (
                feed != feed_number
                and motion == MOTION_LINEAR
                and _only_rotary(modal.rotary, modal.position, work.target)
            ):
                speed = feed_number / 60.0
            if _reach(modal.position, work.target) > LONGEST_BLOCK_S * min(speed, modal.real[SLOWEST_AXIS]):
                return block, NOT_PLAIN  # it may never end: the ordinary path looks closer
            if is_arc and not _arc(modal, work, speed):
                return block, NOT_PLAIN
            moves = True
            if powers and path[g]["merged"] > 0:
                close_line(seg, paths, g, limits)
            if seen & FUNCTIONS:
                stopped = put_events(seg, paths, g, limits, work, tag)
            before = path[g]["tail"]
            if is_arc:
                p, q = whole[AXIS_P], whole[AXIS_Q]
                center_p, center_q, sweep = work.arc[0], work.arc[1], work.arc[2]
                joined = NOT_SMALL
                if path[g]["merge_mm"] > 0.0:
                    joined = append_small_arc(
                        seg, paths, g, limits, work.target, p, q, center_p, center_q, sweep, speed, flags, tag
                    )
                if joined == NOT_SMALL:
                    if path[g]["merged"] > 0:
                        close_line(seg, paths, g, limits)
                    append_arc(
                        seg, paths, g, limits, work.target, p, q, center_p, center_q, sweep, speed, flags, tag
                    )
                    joined = NOT_MERGED
                moves = joined == NOT_MERGED
            elif path[g]["tolerance_mm"] > 0.0:
                if path[g]["merged"] > 0:
                    joined = merge_line(seg, paths, g, limits, work.target, speed, flags, tag)
                moves = joined == NOT_MERGED
                if moves:
                    moves = append_line(seg, paths, g, limits, work.target, speed, flags, tag)
            else:
                moves = add_line(
                    seg.row,
                    seg.start,
                    seg.end,
                    path,
                    paths.queued,
                    g,
                    limits.feed_axis,
                    work.target,
                    speed,
                    flags,
                    tag,
                )
            for i in range(work.target.shape[0]):
                modal.position[i] = work.target[i]
        else:
            if powers and path[g]["merged"] > 0:
                close_line(seg, paths, g, limits)
            if seen & FUNCTIONS:
                stopped = put_events(seg, paths, g, limits, work, tag)
        if seen & CARRIED_WORDS:
            take_note(seen, said[SAYS_SENSE], work.value, work.carried)
        if not moves and not stopped and work.marks.shape[0] > 0 and first < after:
            work.marks[said[MARKED], 0] = path[g]["tail"] if joined == NOT_MERGED else before - 1
            work.marks[said[MARKED], 1] = tag if joined == NOT_MERGED else joined
            said[MARKED] += 1
        whole[MOTION] = motion
        whole[ABSOLUTE] = said[SAYS_ABSOLUTE]
        modal.real[FEED], modal.real[FEED_NUMBER] = feed, feed_number
        block += 1
    return block, ALL_DONE


@compiled
def _read(
    letters: npt.NDArray[np.uint8],
    values: Floats,
    points: npt.NDArray[np.uint8],
    first: int,
    after: int,
    g_action: npt.NDArray[np.int16],
    least_input: float,
    whole: Ints,
    work: FastWork,
) -> bool:
    """Put what the words of a block say into `work`; False at the first that is not plain."""
    motion = whole[MOTION]
    absolute = whole[ABSOLUTE]
    groups = 0  # modal groups that had a word, as bits
    seen = 0
    for w in range(first, after):
        letter = int(letters[w]) - LETTER_A
        if letter < 0 or letter >= LETTERS:
            return False
        value = values[w]
        if letter == _G:
            if not 0.0 <= value < 1000.0:
                return False
            code = int(value * 10.0 + 0.5)
            if code >= g_action.shape[0] or value * 10.0 != code:
                return False
            action = g_action[code]
            if action in (_LINEAR, _RAPID, _ARC_CW, _ARC_CCW):
                group = 1
                motion = _motion_of(action)
            elif action in (_ABSOLUTE_WORD, _INCREMENTAL_WORD):
                group = 2
                absolute = 1 if action == _ABSOLUTE_WORD else 0
            elif action == _PER_MINUTE_WORD and whole[FEED_MODE] == FEED_PER_MINUTE:
                group = 4
            else:
                return False  # planes, units and all else are rare enough for the ordinary path
            if groups & group:
                return False
            groups |= group
            continue
        bit = 1 << letter
        if letter == _N and w > first:
            return False  # some dialects refuse a block number behind other words
        if seen & bit or not _is_plain(letter, value, points[w], least_input, work):
            return False
        seen |= bit
        work.value[letter] = value
    said = work.said
    said[SAYS_MOTION], said[SAYS_ABSOLUTE], said[SEEN] = motion, absolute, seen
    return True


@compiled
def _is_plain(letter: int, value: float, point: int, least_input: float, work: FastWork) -> bool:
    """Tell whether a word besides G is one that the kernel knows; an M code leaves what it means in `work`."""
    role = work.role[letter]
    if role == LASTING:
        if letter == _M:
            work.said[SAYS_SENSE] = sense_of(value, work.m_sense)
        # Records read these words again from the text: their numbers have to stand there.
        return point != OPEN_VALUE and lasts(letter, value, work.said[SAYS_SENSE], work.carried)
    if role == OUTPUT:
        return point != OPEN_VALUE
    return bool(role == NUMBER or (role == LENGTH and (least_input <= 0.0 or point != 0)))


@compiled
def _motion_of(action: int) -> int:
    if action == _LINEAR:
        return MOTION_LINEAR
    if action == _RAPID:
        return MOTION_RAPID
    return MOTION_ARC_CW if action == _ARC_CW else MOTION_ARC_CCW


@compiled
def _target(
    position: Floats,
    scale: Floats,
    offset: Floats,
    low: Floats,
    high: Floats,
    rotary: npt.NDArray[np.uint8],
    work: FastWork,
) -> bool:
    """Put the programmed end point into `work.target`; False if it lies outside the soft limits."""
    seen = work.said[SEEN]
    absolute = work.said[SAYS_ABSOLUTE]
    for i in range(work.target.shape[0]):
        at = position[i]
        letter = int(work.axis_letter[i])  # uncompiled, the shift below would stay within 8 bits
        if letter >= 0 and seen & (1 << letter):
            step = work.value[letter] * scale[i]
            if absolute != 0:
                at = step + offset[i]
                if rotary[i] == MODULO_AXIS:
                    if not -LARGEST <= at <= LARGEST:
                        return False
                    at = _short_way(at, position[i])
            else:
                at += step
        if not low[i] <= at <= high[i]:
            return False
        work.target[i] = at
    return True


@compiled
def _reach(start: Floats, end: Floats) -> float:
    """Return at least the length of a straight move."""
    reach = 0.0
    for i in range(end.shape[0]):
        reach += abs(end[i] - start[i])
    return reach


@compiled
def _only_rotary(rotary: npt.NDArray[np.uint8], start: Floats, end: Floats) -> bool:
    linear = 0
    for i in range(end.shape[0]):
        if rotary[i] == LINEAR_AXIS and end[i] != start[i]:
            linear += 1
    return linear == 0


@compiled
def _arc(
    modal: Modal,
    work: FastWork,
    speed: float,
) -> bool:
    """Put the centre and the sweep of an arc into `work.arc`; False if it is not plain."""
    whole = modal.whole
    seen = work.said[SEEN]
    clockwise = work.said[SAYS_MOTION] == MOTION_ARC_CW
    p, q = whole[AXIS_P], whole[AXIS_Q]
    bit_p, bit_q = 1 << whole[WORD_P], 1 << whole[WORD_Q]
    center = seen & work.said[CENTERS]
    has_radius = (seen & work.said[RADIUS]) != 0
    if p < 0 or q < 0 or center & ~(bit_p | bit_q) or whole[ARC_ABSOLUTE] != 0 or has_radius == (center != 0):
        return False
    start_p, start_q = modal.position[p], modal.position[q]
    end_p, end_q = work.target[p], work.target[q]
    if has_radius:
        status, center_p, center_q, sweep, _ = arc_by_radius(
            start_p,
            start_q,
            end_p,
            end_q,
            work.value[_R] * modal.scale[p],
            clockwise,
            modal.real[ARC_SHORT_RADIUS],
        )
    else:
        center_p, center_q = start_p, start_q
        if center & bit_p:
            center_p += work.value[whole[WORD_P]] * modal.scale[p]
        if center & bit_q:
            center_q += work.value[whole[WORD_Q]] * modal.scale[q]
        status, center_p, center_q, sweep, _ = arc_by_center(
            start_p,
            start_q,
            end_p,
            end_q,
            center_p,
            center_q,
            clockwise,
            modal.real[ARC_INCH_TOLERANCE if whole[INCH] else ARC_TOLERANCE],
            modal.real[ARC_RELATIVE],
            modal.real[ARC_MOST],
        )
    if status != ARC_OK:
        return False
    dp, dq = start_p - center_p, start_q - center_q
    radius = math.sqrt(dp * dp + dq * dq)
    if not (
        modal.low[p] <= center_p - radius
        and center_p + radius <= modal.high[p]
        and modal.low[q] <= center_q - radius
        and center_q + radius <= modal.high[q]
    ):
        return False  # the ordinary path looks closer
    reach = radius * abs(sweep) + _reach(modal.position, work.target)
    if reach > LONGEST_BLOCK_S * min(speed, modal.real[SLOWEST_AXIS]):
        return False
    work.arc[0], work.arc[1], work.arc[2] = center_p, center_q, sweep
    return True
