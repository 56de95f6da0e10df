"""Modal words: what holds until it is said otherwise, from units to the work offset."""

from __future__ import annotations

from dataclasses import replace

from polycnc.kernel import EXACT_PATH as EXACT_PATH_TOLERANCE
from polycnc.machine import LONGEST_BLOCK_S
from polycnc.nc.blocks._block import BlockContext
from polycnc.nc.blocks._coordinates import MACHINE_ZERO, work_group
from polycnc.nc.blocks._handlers import carries_out
from polycnc.nc.blocks._moves import Wait
from polycnc.nc.blocks._tables import ADDITIONAL_OFFSETS, additional_offset
from polycnc.nc.blocks._words import GWord, code_text, dwell_seconds, whole_number
from polycnc.nc.modal._actions import Action, Group
from polycnc.nc.modal._modal import (
    ABSOLUTE,
    ARC_ABSOLUTE,
    EXACT_PATH,
    EXACT_STOP,
    FEED,
    FEED_MODE,
    INCH,
    NO_AXIS,
    PLANE,
    set_diameter,
    set_inch,
    set_plane,
)
from polycnc.nc.text._scan_plain import Word
from polycnc.units import MM_PER_INCH, SECONDS_PER_MINUTE

INCREMENTS_PER_INCH_STEP = 0.1  # an increment in inch is a tenth of the number that it is in mm
_DEFAULT_WORK_OFFSET = "G54"
_SHORTEST_MS = 100.0  # less is hardly meant as milliseconds
_TIME_LETTERS_WITH_INCREMENTS = "XU"


@carries_out(Group.UNITS)
def set_units(block: BlockContext, g: GWord) -> None:
    """Carry out inch or metric words."""
    set_inch(block.after.modal, bool(g.value))


@carries_out(Group.DIAMETERS)
def set_diameters(block: BlockContext, g: GWord) -> None:
    """Carry out what X words are: diameters or radii."""
    modal = block.after.modal
    axis = block.after.axis("X")
    if axis == NO_AXIS:
        raise block.problem(f"G{g.code} on a machine without an X axis", "Remove it.", g.word)
    set_diameter(modal, axis, g.action is Action.DIAMETERS)


def count_increments(block: BlockContext) -> None:
    """Let lengths without a decimal point count increments.

    Say once that they are small: who forgets the point loses the part.
    """
    words = block.words
    words.increment = block.rules.increment * (
        INCREMENTS_PER_INCH_STEP if block.after.modal.whole[INCH] else 1.0
    )
    found = (words.by_letter.get(letter) for letter in (*block.after.axis_names, *"IJKR"))
    if any(word is not None and word.value and not word.point for word in found):
        block.note(
            f"lengths without a decimal point count {words.increment:g} in dialect '{block.dialect.name}'"
        )


@carries_out(Group.PLANE)
def select_plane(block: BlockContext, g: GWord) -> None:
    """Select the working plane.

    Raises:
        ProgramError: the plane changes while a function depends on it.
    """
    modal = block.after.modal
    if g.value == modal.whole[PLANE]:
        return
    if block.after.side:
        raise block.problem(
            "the plane changes while radius compensation is active", "Cancel it with G40 first.", g.word
        )
    if block.after.cycle.action and Group.CYCLE_CANCEL not in block.words.g:
        raise block.problem(
            "the plane changes while a drilling cycle is active", "Cancel it with G80 first.", g.word
        )
    set_plane(modal, g.value)


@carries_out(Group.FEED_MODE)
def set_feed_mode(block: BlockContext, g: GWord) -> None:
    """Carry out what F means; a number that meant something else is none."""
    modal = block.after.modal
    if g.value != modal.whole[FEED_MODE] or "feeds of before" in block.dialect.refuses:
        modal.real[FEED] = 0.0
    modal.whole[FEED_MODE] = g.value


@carries_out(Group.DWELL)
def dwell(block: BlockContext, g: GWord) -> list[Wait]:
    """Return the wait of a dwell.

    Raises:
        ProgramError: a dwell without a time, or with one that cannot be meant.
    """
    letter = dwell_letter(block)
    word = block.words.take(letter)
    if word is None:
        letters = " or ".join(", ".join(block.dialect.dwell).rsplit(", ", 1))
        raise block.problem(f"a dwell (G{g.code}) without a time", f"Add {letters} and the time.", g.word)
    seconds = _dwell_s(block, word, block.dialect.dwell[letter])
    if not 0.0 <= seconds <= LONGEST_BLOCK_S:
        what = "negative" if seconds < 0.0 else "longer than 116 days"
        raise block.problem(
            f"the dwell {word.letter}{code_text(word.value)} is {what}",
            "Write a time from 0 up, and mind its unit.",
            word,
        )
    if 0.0 < word.value < _SHORTEST_MS and seconds != word.value and block.dialect.dwell[letter] == "s_or_ms":
        block.note(
            f"{word.letter}{code_text(word.value)} is {word.value:g} ms: with a decimal point it counts seconds"
        )
    return [Wait(seconds, block.line)]


def dwell_letter(block: BlockContext) -> str:
    """Return the address that gives the time of a dwell; empty if none is there."""
    return next((letter for letter in block.dialect.dwell if letter in block.words.by_letter), "")


def _dwell_s(block: BlockContext, word: Word, unit: str) -> float:
    if unit == "rev":
        spindle = block.after.spindle
        rpm = spindle.speed if spindle.direction else 0.0
        if rpm <= 0.0:
            raise block.problem("a dwell in revolutions with the spindle at rest", "Start it first.", word)
        return word.value * SECONDS_PER_MINUTE / rpm
    if block.dialect.increment and not word.point and word.letter in _TIME_LETTERS_WITH_INCREMENTS:
        return word.value * block.dialect.increment
    return dwell_seconds(word, unit)


@carries_out(Group.WORK_OFFSET)
def set_work_offset(block: BlockContext, g: GWord) -> None:
    """Carry out a work offset, or leaving one."""
    state = block.after
    additional = g.action in (Action.ADDITIONAL_OFFSET, Action.ADDITIONAL_OFFSET_110)
    group = 0 if additional else work_group(g.word.value)
    if g.action is Action.WORK_OFFSET_OFF:
        state.place_zero(state.coordinates.with_work_offset(group, MACHINE_ZERO))
        return
    if g.action is Action.ADDITIONAL_OFFSET:
        name = additional_offset(_additional_number(block))
    elif g.action is Action.ADDITIONAL_OFFSET_110:
        name = additional_offset(int(g.word.value) - 109)
    else:
        name = f"G{g.code}"
    offsets = state.machine.offsets
    if not state.tables.has_offset(name) and (offsets or name != _DEFAULT_WORK_OFFSET):
        block.note(f"{name}: the machine has no such work offset; zero is used")
    state.place_zero(state.coordinates.with_work_offset(group, name))
    if block.dialect.turns_work:
        state.turn_work()


def _additional_number(block: BlockContext) -> int:
    word = block.words.take("P")
    if word is None:
        return 1
    number = whole_number(word, "an additional work offset", block.problem, ADDITIONAL_OFFSETS)
    if number == 0:
        raise block.problem("there is no G54.1 P0", "Write P1 and up.", word)
    return number


@carries_out(Group.STOPPING)
def set_stopping(block: BlockContext, g: GWord) -> None:
    """Carry out whether blocks come to rest, and how far corners may be rounded."""
    state, whole = block.after, block.after.modal.whole
    whole[EXACT_STOP] = g.action is Action.EXACT_STOP
    if g.action is Action.CONTINUOUS:
        _set_path_tolerance(block)
    elif g.action is Action.EXACT_PATH:
        state.path_tolerance_mm = EXACT_PATH_TOLERANCE
    whole[EXACT_PATH] = g.action is Action.EXACT_PATH


@carries_out(Group.DISTANCE)
def set_distance(block: BlockContext, g: GWord) -> None:
    """Carry out whether axis words are positions or ways."""
    block.after.modal.whole[ABSOLUTE] = g.value


@carries_out(Group.ARC_DISTANCE)
def set_arc_distance(block: BlockContext, g: GWord) -> None:
    """Carry out whether centre words are positions or ways."""
    block.after.modal.whole[ARC_ABSOLUTE] = g.value


@carries_out(Group.RETRACT)
def set_retract(block: BlockContext, g: GWord) -> None:
    """Carry out how far drilling cycles retract."""
    block.after.cycle = replace(block.after.cycle, retract_to_initial=bool(g.value))


def report_ignored(block: BlockContext) -> None:
    """Report codes that have no effect; cancels that have nothing to cancel are not worth it."""
    for ignored in block.words.ignored:
        if ignored.action is Action.NOTHING:
            block.words.take("P")
            block.words.take("Q")
            continue
        block.note(f"G{ignored.code} has no effect here and is ignored")


def _set_path_tolerance(block: BlockContext) -> None:
    """Take over how far corners may be rounded: P, else what the dialect and the machine allow.

    Where the dialect merges lines, Q is how far their points may be from the one that they become: P without it.
    """
    state, dialect = block.after, block.dialect
    tolerance = None if Group.DWELL in block.words.g else block.words.take("P")
    merging = block.words.take("Q")
    for word, what in ((tolerance, "path"), (merging if dialect.merges_lines else None, "merging")):
        if word is not None and word.value < 0.0:
            hint = f"Write {word.letter} from 0 up."
            raise block.problem(f"the {what} tolerance {word.letter} is negative", hint, word)
    inch = MM_PER_INCH if state.modal.whole[INCH] else 1.0
    if dialect.merges_lines:
        merged = merging or tolerance
        state.merge_mm = 0.0 if merged is None else merged.value * inch
    if tolerance is None or (tolerance.value == 0.0 and dialect.free_corners):
        state.path_tolerance_mm = dialect.path_tolerance_mm(state.machine.path)
    else:
        state.path_tolerance_mm = tolerance.value * inch
