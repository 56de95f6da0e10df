"""Drilling cycle blocks: words into levels, the expansion of `_cycles` into moves and waits.

Levels are those of the program, without work offset and tool length, until they become moves: so the stored words
of a cycle follow a new work offset, and errors name the numbers that were written.
"""

from __future__ import annotations

from dataclasses import replace

from polycnc.nc.blocks import _feeds as feeds
from polycnc.nc.blocks import _limits as limits
from polycnc.nc.blocks import _motion as motion
from polycnc.nc.blocks._block import BlockContext
from polycnc.nc.blocks._channel_state import Cycle
from polycnc.nc.blocks._cycles import (
    DWELLING,
    PECKING,
    SHIFTING,
    TAPPING,
    CycleError,
    CyclePlace,
    CycleStep,
    CycleWords,
    Spindle,
    StepKind,
    expand_cycle,
)
from polycnc.nc.blocks._moves import Feed, Line, Point, QueueItem, Wait
from polycnc.nc.blocks._polar_words import POLAR_LETTERS, further_polar_places
from polycnc.nc.blocks._words import GWord, dwell_seconds, whole_number
from polycnc.nc.modal._actions import Family, Group
from polycnc.nc.modal._modal import (
    ABSOLUTE,
    FEED,
    FEED_INVERSE_TIME,
    FEED_MODE,
    FEED_PER_REVOLUTION,
    NO_AXIS,
    length_scale,
)
from polycnc.nc.text._scan_plain import Word

_SPINDLES: dict[int, Spindle] = {1: "forward", -1: "reverse", 0: "stopped"}
_TURN = {1: "M3", -1: "M4"}
MOST_HOLES = 9999
_BACK_BORE = "cycle_back_bore"
# The words that most errors of a cycle are about.
_LETTERS_OF_REASON = {"upwards": "RZ", "peck": "Q", "back": "K", "dwell": "P"}


def begin(block: BlockContext, g: GWord) -> None:
    """Begin the cycle of a G word; the words of a cycle that was active stay in force."""
    block.after.leave_turning()
    cycle = block.after.cycle
    initial = cycle.initial
    if not cycle.action:
        axis = block.after.plane[2]
        initial = float(block.after.modal.position[axis]) if axis != NO_AXIS else 0.0
    if _strict(block) and g.word.value != cycle.code:
        cycle = replace(cycle, words=CycleWords())
    block.after.cycle = replace(cycle, action=g.action.title, code=g.word.value, initial=initial)
    block.after.mode = Family.DRILLING


def moves(block: BlockContext) -> list[QueueItem]:
    """Return the moves of a block with an active cycle; none if it has no position.

    Raises:
        ProgramError: a word is missing or does not make sense, a limit would be passed.
    """
    whole, words = block.after.modal.whole, block.words
    axes = block.after.plane
    code = f"G{block.after.cycle.code:g}"
    if NO_AXIS in axes:
        letters = block.after.plane_letters
        raise block.problem(
            f"{code} needs the axes {', '.join(letters)} here, and the machine lacks one of them",
            "Select a plane of the machine's axes with G17, G18 or G19.",
            block.move_word,
        )
    drills = _drills(block, axes, code)
    if not drills and _strict(block):
        return []
    cycle = _with_words(block, block.after.cycle.words.then(_words(block, axes)))
    block.after.cycle = cycle
    if not drills:
        return []
    _refuse_state(block, cycle, axes[2], code)
    start = block.start
    further = further_polar_places(block, cycle.words.repeats)
    hole = motion.target(block, motion.axis_words(block))
    place = _place(block, cycle, start, hole, axes)
    if further:
        place = replace(place, further_mm=further)
    try:
        levels = _with_pitch(block, cycle)
        if block.dialect.cycles.levels_as_written and not whole[ABSOLUTE]:
            levels = levels.absolute(place.initial_mm)
        steps = expand_cycle(cycle.action, levels, place, block.dialect.cycles, code=code)
    except CycleError as error:
        at = words.first(*_LETTERS_OF_REASON.get(error.reason, "")) or block.move_word
        raise block.problem(error.what, error.hint, at) from None
    return _items(block, steps, start, hole, axes) if steps else []


def _strict(block: BlockContext) -> bool:
    """Tell whether a cycle takes the words that are its own only."""
    return "words of another cycle" in block.dialect.refuses


def _drills(block: BlockContext, axes: tuple[int, int, int], code: str) -> bool:
    """Tell whether there is a word left that says where to drill.

    Raises:
        ProgramError: it is of an axis that the dialect does not move in a cycle, or there is none beside the code.
    """
    words, names = block.words, block.after.axis_names
    places = (*POLAR_LETTERS, *names) if _strict(block) else ("R", *POLAR_LETTERS, *names)
    drills = any(name in words.by_letter and name not in words.used for name in places)
    if drills and _strict(block):
        others = [name for index, name in enumerate(names) if index not in axes]
        if (word := words.first(*others)) is not None:
            raise block.problem(f"{code} with axis {word.letter}", "Turn it in a block before.", word)
    elif Group.MOTION in words.g and "motion code alone" in block.dialect.refuses:
        raise block.problem(f"{code} without an axis", "Say where it drills.", block.move_word)
    return drills


def _with_words(block: BlockContext, words: CycleWords) -> Cycle:
    """Return the active cycle with its words; where the dialect keeps a dwell, a tapping cycle without one takes it."""
    cycle = block.after.cycle
    last = cycle.last_dwell_s if words.dwell_s is None else words.dwell_s
    if block.dialect.cycles.keeps_dwell and cycle.action in TAPPING:
        words = replace(words, dwell_s=last)
    return replace(cycle, words=words, last_dwell_s=last)


def _refuse_state(block: BlockContext, cycle: Cycle, axis: int, code: str) -> None:
    """Refuse what a cycle cannot drill with: compensation, inverse time feed, some frames."""
    state, whole = block.after, block.after.modal.whole
    if state.side:
        what, hint = "while radius compensation is active", "Cancel it with G40 first."
    elif whole[FEED_MODE] == FEED_INVERSE_TIME:
        what, hint = "with inverse time feed (G93)", "Select G94 or G95 first."
    elif state.frame.factor(axis) != 1.0:
        what = "with a scaled or mirrored drilling axis is not supported yet"
        hint = "Scale the axes of the plane only (I, J)."
    elif state.frame.active and not whole[ABSOLUTE] and cycle.words.repeats > 1:
        raise block.problem(
            f"{code}: a row of holes on a turned, scaled or polar frame is not supported yet",
            "Write each hole in a block of its own.",
            block.move_word,
        )
    else:
        return
    raise block.problem(f"{code} {what}", hint, block.move_word)


def _place(
    block: BlockContext, cycle: Cycle, start: Point, hole: Point, axes: tuple[int, int, int]
) -> CyclePlace:
    """Return where the cycle drills, and how the spindle turns there."""
    p, q, r = axes
    modal, spindle = block.after.modal, block.after.spindle
    rigid = _is_rigid(block)
    direction = TAPPING[cycle.action] * (spindle.speed > 0.0) if rigid else spindle.direction
    offset = float(modal.offset[r])
    way = (0.0, 0.0) if modal.whole[ABSOLUTE] else (hole[p] - start[p], hole[q] - start[q])
    return CyclePlace(
        hole_mm=(hole[p], hole[q]),
        initial_mm=cycle.initial - offset,
        level_mm=start[r] - offset,
        retract="initial" if cycle.retract_to_initial else "r",
        increment_mm=way,
        spindle=_SPINDLES[direction],
        spindle_rpm=feeds.rpm(block, start, start),
        rigid=rigid,
        taps_either_way="G84 with M4" not in block.dialect.refuses,
    )


def _is_rigid(block: BlockContext) -> bool:
    """Whether the active cycle is a tapping cycle that turns the spindle itself."""
    rigid = block.after.rigid_tap or block.dialect.cycles.rigid_tap
    return rigid and block.after.cycle.action in TAPPING


def _with_pitch(block: BlockContext, cycle: Cycle) -> CycleWords:
    """Return the words of a cycle; with feed per revolution the feed is the pitch of a thread."""
    modal = block.after.modal
    if cycle.action in TAPPING and modal.whole[FEED_MODE] == FEED_PER_REVOLUTION:
        return replace(cycle.words, pitch_mm=float(modal.real[FEED]))
    return cycle.words


def _words(block: BlockContext, axes: tuple[int, int, int]) -> CycleWords:
    modal = block.after.modal
    cycle = block.after.cycle
    is_back_bore = cycle.action == _BACK_BORE

    def length(letter: str, scale: float = float(modal.scale[axes[2]])) -> float | None:
        value = block.words.length(letter)
        return None if value is None else value * scale

    # R and Q are radii also where the axis has diameters.
    retract = None if "R" in block.after.axis_names else length("R", length_scale(modal))
    depth = length(block.after.axis_names[axes[2]])
    back = length("K") if is_back_bore else None
    if not modal.whole[ABSOLUTE] and not block.dialect.cycles.levels_as_written:
        initial = cycle.initial - float(modal.offset[axes[2]])
        retract = None if retract is None else initial + retract
        r_level = retract if retract is not None else cycle.words.retract_mm
        if depth is not None and r_level is not None:
            depth += r_level
        bottom = depth if depth is not None else cycle.words.depth_mm
        if back is not None and bottom is not None:
            back += bottom
    retract = _level_before(block, axes[2]) if retract is None else retract
    pecks = cycle.action in PECKING or not _strict(block)
    return CycleWords(
        depth_mm=depth,
        retract_mm=retract,
        peck_mm=length("Q", length_scale(modal)) if pecks else None,
        dwell_s=_dwell(block, cycle),
        shift_mm=_shift(length("I"), length("J")) if cycle.action in SHIFTING else None,
        back_mm=back,
        repeats=_repeats(block, is_back_bore),
    )


def _shift(p: float | None, q: float | None) -> tuple[float, float] | None:
    return None if p is None and q is None else (p or 0.0, q or 0.0)


def _level_before(block: BlockContext, axis: int) -> float | None:
    """Return where the axis stood before a cycle that has never had R; None where R must be there."""
    cycle = block.after.cycle
    may_begin = block.dialect.cycles.begins_without_r and cycle.action != _BACK_BORE
    if not may_begin or cycle.words.retract_mm is not None:
        return None
    block.note(f"G{cycle.code:g} without R: it retracts to where the axis stood before the cycle")
    return cycle.initial - float(block.after.modal.offset[axis])


def _dwell(block: BlockContext, cycle: Cycle) -> float | None:
    """Take P (s): any cycle has one, or those that wait only; these need one then.

    Raises:
        ProgramError: there is none where one is needed.
    """
    waits = cycle.action in DWELLING
    if _strict(block) and not waits and cycle.action not in TAPPING:
        return None
    word = block.words.take("P")
    if word is not None:
        return dwell_seconds(word, block.dialect.dwell.get("P", "s"))
    if waits and _strict(block) and cycle.words.dwell_s is None:
        hint = "Program it in the first block of the cycle."
        raise block.problem(f"G{cycle.code:g} needs a dwell (P)", hint, block.move_word)
    return None


def _repeats(block: BlockContext, is_back_bore: bool) -> int:
    """Take L, or K where it is no level: how many holes."""
    letters = [each for each in block.dialect.cycles.repeats if not (each == "K" and is_back_bore)]
    found: list[Word] = [word for each in letters if (word := block.words.take(each))]
    if len(found) > 1:
        raise block.problem("L and K both say how many holes to drill", "Write one of them.", found[1])
    if not found:
        return 1
    count = whole_number(found[0], "a number of holes", block.problem, MOST_HOLES)
    if count == 0 and not block.dialect.cycles.no_hole:
        raise block.problem("a cycle that drills no hole", "Use 1 or more, or leave the block out.", found[0])
    return count


def _items(
    block: BlockContext, steps: list[CycleStep], start: Point, hole: Point, axes: tuple[int, int, int]
) -> list[QueueItem]:
    items: list[QueueItem] = []
    offset = float(block.after.modal.offset[axes[2]])
    at = list(start)
    for index, value in enumerate(hole):
        if index not in axes and value != at[index]:
            before, at[index] = tuple(at), value
            items.append(_line(block, before, tuple(at), True))
    locked = False
    for step in steps:
        before = tuple(at)
        match step.kind:
            case StepKind.RAPID_PLANE:
                at[axes[0]], at[axes[1]] = step.first_mm, step.second_mm
                items.append(_line(block, before, tuple(at), True))
            case StepKind.RAPID_AXIS:
                at[axes[2]] = step.level_mm + offset
                items.append(_line(block, before, tuple(at), True))
            case StepKind.FEED_AXIS:
                at[axes[2]] = step.level_mm + offset
                line = _line(block, before, tuple(at), False, step.feed_mm_s)
                if step.synchronous:
                    line = replace(line, feed=replace(line.feed, with_spindle=True))
                items.append(line)
            case StepKind.DWELL:
                items.append(Wait(step.duration_s, block.line, with_spindle=locked))
            case StepKind.OVERRIDE_OFF | StepKind.OVERRIDE_ON:
                locked = step.kind is StepKind.OVERRIDE_OFF
            case _:
                event = _event(block, step.kind)
                if event:
                    items.append(Wait(0.0, block.line, (event,), with_spindle=locked))
    return items


def _line(block: BlockContext, start: Point, end: Point, rapid: bool, feed_mm_s: float = 0.0) -> Line:
    limits.check(block, end)
    if rapid:
        return Line(start, end, Feed(), True, True, block.line)
    feed = Feed(speed_mm_s=feed_mm_s) if feed_mm_s > 0.0 else feeds.feed(block, start, end)
    return Line(start, end, feed, False, True, block.line)


def _event(block: BlockContext, kind: StepKind) -> str:
    """Return the auxiliary function of a step as a program would write it; overrides have none."""
    rigid = _is_rigid(block)
    direction = TAPPING[block.after.cycle.action] if rigid else block.after.spindle.direction
    return {
        StepKind.SPINDLE_STOP: "M5",
        StepKind.SPINDLE_START: _TURN.get(direction, "M5"),
        StepKind.SPINDLE_REVERSE: _TURN.get(-direction, "M5"),
        StepKind.SPINDLE_ORIENT: "M19",
        StepKind.PROGRAM_STOP: "M0",
    }.get(kind, "")
