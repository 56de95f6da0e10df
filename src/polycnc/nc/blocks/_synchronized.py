"""Motions that go with the spindle, by a lead that the block names: G33, G33.1 and the passes of LinuxCNC's G76.

Source: LinuxCNC G-code manual, "G33", "G33.1", "G76 Threading Cycle". Lengths along X are radii.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from polycnc.errors import ProgramError
from polycnc.nc.blocks import _limits as limits
from polycnc.nc.blocks import _motion as motion
from polycnc.nc.blocks import _turning_moves as turns
from polycnc.nc.blocks._block import BlockContext
from polycnc.nc.blocks._moves import Feed, Line, Point, QueueItem, Wait
from polycnc.nc.blocks._turning import MOST_PASSES
from polycnc.nc.blocks._words import whole_number
from polycnc.nc.modal._actions import Action, Group
from polycnc.nc.modal._modal import length_scale
from polycnc.units import SECONDS_PER_MINUTE

SYNCHRONIZED = tuple(each.title for each in (Action.SYNCHRONIZED, Action.TAP_AND_BACK, Action.THREADING))
"""The names of these motions."""
_STEEPEST_DEG = 80.0
_BEGIN, _END = 1, 2  # of L: where a thread tapers
_TURN = {1: "M3", -1: "M4"}


def moves(block: BlockContext) -> list[QueueItem]:
    """Return the moves of a block with such a motion in force; none if it has no position.

    Raises:
        ProgramError: a word is missing or makes no sense, the spindle is at rest, an axis cannot follow it.
    """
    name = block.after.turning.motion
    values = motion.axis_words(block)
    if not values and not any(letter in "PIJK" for letter, _ in block.words.unused()):
        if Group.MOTION in block.words.g and "motion code alone" in block.dialect.refuses:
            raise block.problem("a thread without an axis", "Say where it ends.", block.move_word)
        return []
    if not values:
        raise block.problem("a thread without an axis", "Say where it ends.", block.move_word)
    turns.refuse_compensation(block)
    if name == Action.THREADING.title:
        return list(_threading(block, values))
    lead = block.words.length("K")
    if lead is None or lead <= 0.0:
        raise block.problem(
            "a thread without a lead above zero", "Add K and the way of each turn.", block.move_word
        )
    end = motion.target(block, values)
    limits.check(block, end)
    feed = _feed(block, block.start, end, lead * length_scale(block.after.modal))
    there = Line(block.start, end, feed, False, name == Action.TAP_AND_BACK.title, block.line)
    if name == Action.SYNCHRONIZED.title:
        return [there]
    direction = block.after.spindle.direction
    return [
        there,
        Wait(0.0, block.line, (_TURN[-direction],), with_spindle=True),
        Line(end, block.start, feed, False, True, block.line),
        Wait(0.0, block.line, (_TURN[direction],)),
    ]


def _feed(block: BlockContext, start: Point, end: Point, lead: float) -> Feed:
    """Return the feed of a move that goes `lead` mm along its path with each turn of the spindle."""
    rpm = turns.thread_rpm(block, start, "The spindle would turn faster with each pass")
    return turns.with_spindle(block, start, end, lead * rpm / SECONDS_PER_MINUTE)


# ------------------------------------------------------------------ G76


@dataclass(frozen=True, slots=True)
class _Thread:
    """The words of G76: `offset` (I) from the drive line to the crest, below zero outside; depths of passes."""

    pitch: float
    offset: float
    first: float
    full: float
    degression: float
    slope: float
    springs: int
    taper: float
    tapers_in: bool
    tapers_out: bool

    def depths(self) -> Iterator[float]:
        """Yield how deep each pass is, from the drive line."""
        crest = abs(self.offset)
        number, depth = 1, crest + self.first
        while depth < crest + self.full:
            yield depth
            number += 1
            depth = crest + self.first * number ** (1.0 / self.degression)
        yield from [crest + self.full] * (1 + self.springs)


def _threading(block: BlockContext, values: dict[int, float]) -> Iterator[QueueItem]:
    x, z = turns.axes(block)
    if wrong := [axis for axis in values if axis != z]:
        name = block.after.axis_names[wrong[0]]
        raise block.problem(
            f"a thread of several passes moves along Z, not {name}", "Remove it.", block.words.first(name)
        )
    if block.after.frame.active:
        raise block.problem(
            "a thread of several passes in turned coordinates",
            "Take a work offset without R.",
            block.move_word,
        )
    start = block.start
    end = motion.target(block, values)[z]
    way = -1.0 if end < start[z] else 1.0
    thread = _thread(block, x, abs(end - start[z]))
    outside = 1.0 if thread.offset > 0.0 else -1.0
    slope = -way * thread.slope
    last = end + thread.full * slope
    tapered = thread.taper * way
    taper_lead = thread.pitch * math.hypot(thread.taper, thread.full) / thread.taper if thread.taper else 0.0
    crest = abs(thread.offset)
    at = start

    def to(radius: float, along: float, lead: float = 0.0) -> QueueItem:
        nonlocal at
        point = list(start)
        point[x], point[z] = radius, along
        begin, at = at, tuple(point)
        limits.check(block, at)
        feed = _feed(block, begin, at, lead) if lead else Feed()
        return Line(begin, at, feed, not lead, not lead, block.line)

    for depth in thread.depths():
        shift = (depth - crest) * slope
        bottom = start[x] + outside * depth
        top = bottom - outside * thread.full
        clear = bottom - outside * (crest + thread.full)
        yield to(clear, start[z] - shift)
        if thread.tapers_in:
            yield to(top, start[z] - shift, taper_lead)
            yield to(bottom, start[z] - shift + tapered, taper_lead)
        else:
            yield to(bottom, start[z] - shift)
        if thread.tapers_out:
            yield to(bottom, last - shift - tapered, thread.pitch)
            yield to(top, last - shift, taper_lead)
        else:
            yield to(bottom, last - shift, thread.pitch)
        yield to(clear, last - shift)
    yield to(start[x], end)


def _refused(block: BlockContext, what: str, hint: str, letter: str) -> ProgramError:
    return block.problem(what, hint, block.words.first(letter) or block.move_word)


def _thread(block: BlockContext, x: int, length: float) -> _Thread:
    """Take the words of G76; `length` is that of the thread, mm."""
    words, modal = block.words, block.after.modal
    scale, radial = length_scale(modal), float(modal.scale[x])
    pitch, offset, first, full = _depths(block)
    degression = max(1.0, words.value("R") or 1.0)
    if (full / first) ** degression > MOST_PASSES:
        raise _refused(block, "a thread of too many passes", "Check J, K and R.", "J")
    angle = words.value("Q") or 0.0
    if abs(angle) > _STEEPEST_DEG:
        hint = "Write about half the thread's angle."
        raise _refused(block, f"the compound slide angle Q{angle:g} is too steep", hint, "Q")
    word = words.take("H")
    springs = (
        0 if word is None else whole_number(word, "a number of spring passes", block.problem, MOST_PASSES)
    )
    taper, ends = _tapers(block, length)
    slope = math.tan(math.radians(angle))
    depths = offset * radial, first * radial, full * radial
    return _Thread(
        pitch * scale, *depths, degression, slope, springs, taper, bool(ends & _BEGIN), bool(ends & _END)
    )


def _depths(block: BlockContext) -> tuple[float, float, float, float]:
    """Take pitch, crest, first and whole depth, in the units of the program."""
    pitch, offset, first, full = (block.words.length(letter) for letter in "PIJK")
    if pitch is None or offset is None or first is None or full is None:
        raise _refused(block, "a thread of several passes without P, I, J and K", "Add them.", "Z")
    if pitch <= 0.0:
        raise _refused(block, "the pitch is not above zero", "Write P above 0.", "P")
    if offset == 0.0:
        hint = "Write I below 0 outside, above 0 inside."
        raise _refused(block, "I is 0, so the crest lies in the drive line", hint, "I")
    if not 0.0 < first < full:
        what = "the first depth J is not between 0 and the whole depth K"
        raise _refused(block, what, "Write J below K.", "J")
    return pitch, offset, first, full


def _tapers(block: BlockContext, length: float) -> tuple[float, int]:
    """Take the length of the tapers (mm) and where they are."""
    taper = (block.words.length("E") or 0.0) * length_scale(block.after.modal)
    word = block.words.take("L")
    ends = 0 if word is None else whole_number(word, "where the thread tapers", block.problem, _BEGIN | _END)
    if ends and taper <= 0.0:
        raise _refused(block, "a taper (L) without its length", "Add E above 0.", "L")
    if taper * ends.bit_count() > length:
        raise _refused(block, "the tapers are longer than the thread", "Write a shorter E.", "E")
    return (taper, ends) if ends else (0.0, 0)
