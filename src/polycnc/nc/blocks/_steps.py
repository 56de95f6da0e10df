"""The steps that a block goes through, in one fixed order, whatever order its words stand in.

Each takes the block and does its part if a word asks for it: how numbers are meant, feed, spindle, tool and auxiliary
functions, dwell, tool compensation, work offset, stopping, absolute or incremental, retract level; then the function or
the motion of the block; at last program stops and ends. What no step has taken is refused.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TypeAlias

from polycnc.errors import ProgramError
from polycnc.machine import LONGEST_BLOCK_S
from polycnc.nc.blocks import _auxiliary as auxiliary
from polycnc.nc.blocks import _limits as limits
from polycnc.nc.blocks import _modal_words as modal_words
from polycnc.nc.blocks._block import BlockContext
from polycnc.nc.blocks._codes import CODES, MOTION_MODES
from polycnc.nc.blocks._corner_blocks import joined, no_straight_move
from polycnc.nc.blocks._handlers import refuse_compensation
from polycnc.nc.blocks._motion import axis_word_left, note_position
from polycnc.nc.blocks._moves import Line, QueueItem
from polycnc.nc.blocks._nurbs import refuse_others
from polycnc.nc.blocks._outcomes import JUMPS, Continuation, Outcome
from polycnc.nc.blocks._tool_words import compensate_length, compensate_radius
from polycnc.nc.blocks._word_checks import (
    leave_out,
    refuse_contradictions,
    refuse_remaps,
    refuse_unused,
    take_parameters,
)
from polycnc.nc.blocks._words import code_text, whole_number
from polycnc.nc.modal._actions import Action, Family, Group, MAction
from polycnc.nc.modal._modal import (
    EXACT_STOP,
    FEED,
    FEED_INVERSE_TIME,
    FEED_MODE,
    FEED_NUMBER,
    INCH,
    MOTION,
    MOTION_NURBS,
    SLOWEST_AXIS,
    STOPS_SUPPRESSED,
)
from polycnc.nc.text._scan import MESSAGE
from polycnc.nc.text._scan_plain import Word
from polycnc.units import MM_PER_INCH

Step: TypeAlias = Callable[[BlockContext], None]

_OF_ONE_BLOCK = (Family.SPLINE, Family.CURVE)
_UNCOMPENSATED = (Family.FRAME, Family.PLACING)
_STATED = (Group.MOTION, Group.DISTANCE)
_OUTCOMES = {
    MAction.PROGRAM_END: Outcome(Continuation.END),
    MAction.PROGRAM_STOP: Outcome(Continuation.STOP),
    MAction.OPTIONAL_STOP: Outcome(Continuation.STOP),
    MAction.SUB_RETURN: Outcome(Continuation.RETURN),
}


def words(block: BlockContext) -> None:
    """Sort the words, and refuse those that cannot stand in one block."""
    if block.block.flags & MESSAGE and block.block.message:
        block.note(f"MSG: {block.block.message}")
    if block.block.note:
        block.note(block.block.note)
    found = block.words
    if remaps := block.after.machine.programs.remaps:
        refuse_remaps(block, remaps)
    block.rules.sorter.sort(found, block.block, block.text, block.problem)
    if len(found.g) > 1:
        refuse_contradictions(block)
    if block.after.nurbs is not None:
        refuse_others(block)
    if found.left_out:
        leave_out(block)
    block.notes += found.remarks


def ends(block: BlockContext) -> None:
    """Say how the program goes on, by the M codes."""
    for m in block.words.m:
        if m.action is MAction.SUB_CALL:
            block.outcome = _call(block, f"M{m.code}", m.word)
            return
        if m.action is MAction.SUB_RETURN and "P" in block.words.by_letter:
            raise block.problem(
                f"M{m.code} P: a return to a block number cannot be carried out",
                "Remove P, or call another sub-program.",
                block.words.by_letter["P"],
            )
        if m.action in _OUTCOMES:
            block.outcome = _OUTCOMES[m.action]
            return


def _call(block: BlockContext, code: str, at: Word) -> Outcome:
    p_word, l_word = block.words.take("P"), block.words.take("L")
    if p_word is None:
        raise block.problem(f"{code} without a sub-program", "Add P and the number of the sub-program.", at)
    program = whole_number(p_word, "the number of a program", block.problem)
    repeats = 1 if l_word is None else whole_number(l_word, "a number of repetitions", block.problem)
    if l_word is None and program > 9999 and block.dialect.sub_program.repeats_in_p:
        repeats, program = divmod(program, 10_000)
    if problem := block.rules.call_problem(program, block.text, p_word.place):
        what, hint, number = problem
        error = block.problem(what, hint, p_word)
        error.code = number
        raise error
    return Outcome(Continuation.CALL, program, repeats)


def code(*groups: Group) -> Step:
    """Return the step that carries out the words of modal groups."""

    def step(block: BlockContext) -> None:
        for group in groups:
            if g := block.words.g.get(group):
                block.items += CODES[g.action](block, g) or ()

    return step


def increments(block: BlockContext) -> None:
    """Let numbers without a decimal point be increments."""
    if block.rules.increment:
        modal_words.count_increments(block)


def feed(block: BlockContext) -> None:
    """Carry out F.

    Raises:
        ProgramError: a feed that is not above zero.
    """
    state, modal = block.after, block.after.modal
    state.feed_word = 0.0
    word = block.words.by_letter.get("F")
    if word is None or "F" in block.words.used:
        return
    if Group.DWELL in block.words.g and modal_words.dwell_letter(block) == "F":
        return
    block.words.used.add("F")
    value = word.value
    if value <= 0.0:
        raise block.problem(f"the feed {code_text(value)} is not above zero", "Write a positive F.", word)
    if (least := block.dialect.numbers.feed_least_input) and not word.point:
        value *= least * (modal_words.INCREMENTS_PER_INCH_STEP if modal.whole[INCH] else 1.0)
        block.note(
            f"F without a decimal point counts {least:g} mm in dialect '{block.dialect.name}': "
            f"F{code_text(word.value)} is {code_text(value)}"
        )
    state.feed_word = value
    if modal.whole[FEED_MODE] != FEED_INVERSE_TIME:
        modal.real[FEED] = value * (MM_PER_INCH if modal.whole[INCH] else 1.0)
        modal.real[FEED_NUMBER] = value


def spindle(block: BlockContext) -> None:
    """Carry out S and what it means."""
    if "S" in block.words.by_letter or Group.SPINDLE_MODE in block.words.g:
        auxiliary.spindle_speed(block)


def tool(block: BlockContext) -> None:
    """Carry out T."""
    if "T" in block.words.by_letter:
        auxiliary.select_tool(block)


def functions(block: BlockContext) -> None:
    """Carry out M codes that come before the motion, and let a laser's power change."""
    if block.words.m:
        auxiliary.functions(block)
    if block.after.machine.spindle.laser:
        auxiliary.laser_power(block)


def length(block: BlockContext) -> None:
    """Carry out tool length compensation."""
    if "H" in block.words.by_letter or Group.LENGTH_COMPENSATION in block.words.g:
        compensate_length(block)


def radius(block: BlockContext) -> None:
    """Carry out radius compensation."""
    alone = block.words.g.get(Group.NON_MODAL)
    if alone is not None and alone.action.family is Family.PROFILE:
        return  # D is a distance
    if "D" in block.words.by_letter or Group.RADIUS_COMPENSATION in block.words.g:
        compensate_radius(block)


def held(block: BlockContext) -> None:
    """Refuse codes that the dialect holds back with radius compensation; G40 in the same block comes first.

    Raises:
        ProgramError: there is one.
    """
    held = block.dialect.held_by_compensation
    if not held or not (block.after.side or block.before.side):
        return
    for m in block.words.m:
        if block.before.side and f"M{m.code}" in held:
            raise _refusal(block, f"M{m.code}", m.word)
    for group, g in block.words.g.items():
        if group not in held:
            continue
        twice = group is Group.RADIUS_COMPENSATION
        if (twice and g.value and block.before.side) or (not twice and block.after.side):
            raise _refusal(block, f"G{g.code}", g.word)


def _refusal(block: BlockContext, code: str, word: Word) -> ProgramError:
    return block.problem(f"{code} while radius compensation is active", "Cancel it with G40 first.", word)


def rest(block: BlockContext) -> None:
    """Say whether this block comes to rest at its end, and report what has no effect."""
    whole = block.after.modal.whole
    stops_here = bool(whole[EXACT_STOP]) or Group.EXACT_STOP_BLOCK in block.words.g
    block.exact_stop = stops_here and not whole[STOPS_SUPPRESSED]
    if block.words.ignored:
        modal_words.report_ignored(block)


def motion(block: BlockContext) -> None:
    """Carry out the function of the block, or go where it says, after the move that waits for its corner."""
    moves = _moves(block)
    state = block.after
    if moves and state.spline_way is not None and not _is_spline(block):
        state.spline_way = None
    if block.dialect.corner_words:
        if block.items and state.corner is not None:
            raise no_straight_move(block, state.corner)
        moves = joined(block, moves)
    block.items += moves


def _moves(block: BlockContext) -> list[QueueItem]:
    state, g = block.after, block.words.g
    if Group.CYCLE_CANCEL in g:
        state.leave_drilling()
    mode = None
    if word := g.get(Group.MOTION):
        assert word.action.family is not None
        mode = MOTION_MODES[word.action.family]
        mode.begin(block, word)
    if pause := g.get(Group.DWELL):
        bends = word is not None and word.action in (Action.ARC_CW, Action.ARC_CCW)
        if bends and word is not None and block.dialect.dwell_before_move:
            raise block.problem(f"G{pause.code} and G{word.code} both use P", "Write two blocks.", word.word)
        if axis_word_left(block) and not block.dialect.dwell_before_move:
            raise block.problem(
                f"a dwell (G{pause.code}) and a move in one block",
                "Write them in two blocks.",
                next((left for letter, left in block.words.unused() if letter in state.axis_names), None),
            )
        if not axis_word_left(block):
            return []
    if code := g.get(Group.NON_MODAL):
        if code.action.family in _UNCOMPENSATED and code.action is not Action.SET_TABLES:
            refuse_compensation(block, code)
        return [*(CODES[code.action](block, code) or ())]
    if mode is None or not _is_spline(block):
        mode = MOTION_MODES[state.mode]
    return [*mode.moves(block)]


def _is_spline(block: BlockContext) -> bool:
    word = block.words.g.get(Group.MOTION)
    return word is not None and word.action.family in _OF_ONE_BLOCK


def unused(block: BlockContext) -> None:
    """Refuse words that no step has taken."""
    if block.words.by_letter.keys() <= block.words.used:
        return
    if block.words.left_out:
        take_parameters(block)
    refuse_unused(block)


def stops(block: BlockContext) -> None:
    """Stop or end the program after the motion."""
    if block.words.m:
        block.items += auxiliary.stops(block)
        if codes := tuple(m.code for m in block.words.m if m.action not in JUMPS):
            block.after.m_codes = codes


def times(block: BlockContext) -> None:
    """Refuse what would take longer than anybody waits; a straight move seldom needs a closer look."""
    slowest = float(block.after.modal.real[SLOWEST_AXIS])
    for item in block.items:
        if isinstance(item, Line) and not item.feed.duration_s:
            speed = slowest if item.rapid else min(slowest, item.feed.speed_mm_s)
            reach = sum(abs(b - a) for a, b in zip(item.start, item.end, strict=True))
            if reach <= LONGEST_BLOCK_S * speed:
                continue
        limits.check_time(block, item)


def position(block: BlockContext) -> None:
    """Remember where the block has led, and which motion it shows: a spline is in force for its own block only."""
    state, word = block.after, block.words.g.get(Group.MOTION)
    if block.items or state.corner is not None:
        note_position(block)
    if word is not None and _is_spline(block):
        block.shows = word.value
    else:
        block.shows = MOTION_NURBS if state.nurbs is not None else int(state.modal.whole[MOTION])


def codes(block: BlockContext) -> None:
    """Keep the G codes of the block, the latest last; motion and distance are in the modal state."""
    if not block.dialect.notes_codes:
        return
    g = block.words.g
    said = {int(each.word.value) for group, each in g.items() if group not in _STATED}
    said |= {int(each.word.value) for each in block.words.ignored}
    placement = block.after.placement
    alone = g.get(Group.NON_MODAL) or g.get(Group.DWELL)
    once = int(alone.word.value) if alone else 0
    new = said and not said <= {*placement.codes[-1:]}
    if new or once != placement.once:
        kept = (code for code in placement.codes if code not in said)
        named = None if Group.PLANE in g else placement.plane
        block.after.placement = replace(placement, codes=(*kept, *sorted(said)), once=once, plane=named)


STEPS: tuple[Step, ...] = (
    words, ends, code(Group.UNITS, Group.DIAMETERS), increments, code(Group.PLANE, Group.FEED_MODE),
    feed, spindle, tool, functions, code(Group.DWELL), length, radius, held,
    code(Group.WORK_OFFSET, Group.STOPPING, Group.DISTANCE, Group.ARC_DISTANCE, Group.RETRACT), rest,
    code(Group.ROTATION, Group.POLAR), motion, unused, stops, times, position, codes,
)  # fmt: skip
"""What a block goes through, in this order."""


def take_steps(block: BlockContext) -> None:
    """Send a block through the steps.

    Raises:
        ProgramError: the block cannot be executed; its value is dropped.
    """
    for step in STEPS:
        step(block)
