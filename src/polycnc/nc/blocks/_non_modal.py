"""Functions that take the axis words of their block for themselves: G28, G30, G53 (one block), G92, G92.1."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

from polycnc.machine import first_contact
from polycnc.nc.blocks import _limits as limits
from polycnc.nc.blocks import _motion as motion
from polycnc.nc.blocks._block import BlockContext
from polycnc.nc.blocks._handlers import carries_out, refuse_compensation
from polycnc.nc.blocks._moves import Feed, Line, QueueItem, Stop, Wait
from polycnc.nc.blocks._probe import Probe
from polycnc.nc.blocks._words import GWord, whole_number
from polycnc.nc.modal._actions import Action
from polycnc.nc.modal._modal import (
    ABSOLUTE,
    FEED_INVERSE_TIME,
    FEED_MODE,
    MOTION,
    MOTION_LINEAR,
    MOTION_RAPID,
)

REFERENCE_POSITIONS = 4
PROBES = {
    Action.PROBE_CONTACT: (False, True),
    Action.PROBE_TOWARDS: (False, False),
    Action.PROBE_LEAVE: (True, True),
    Action.PROBE_AWAY: (True, False),
}
"""Probing moves that tell the program: whether each leaves the workpiece, and whether a miss is an error."""


@carries_out(Action.SKIP_MOVE)
def skip_move(block: BlockContext, g: GWord) -> list[QueueItem]:
    """Go straight at feed until the skip signal comes, at the latest to the end; what follows waits for it."""
    refuse_compensation(block, g)
    values = motion.axis_words(block)
    if not values:
        raise block.problem(f"G{g.code} without an axis", "Say how far to go at the most.", g.word)
    move = replace(motion.line(block, motion.target(block, values), False), exact_stop=True)
    block.after.skip_position = move.end
    wait = Wait(0.0, block.line, stop=Stop.DRAIN)
    block.after.probe = Probe(frozenset(values))
    return [Wait(0.0, block.line, stop=Stop.PROBE), move, wait]


@carries_out(Action.PROBE_MOVE, Action.PROBE_IN_PASSING)
def probe_move(block: BlockContext, g: GWord) -> list[QueueItem]:
    """Go straight at feed until the probe switches, or measure in passing; preparation waits for the end."""
    in_passing = g.action is Action.PROBE_IN_PASSING
    move = _measuring_move(block, g, one_axis=in_passing)
    stop = Stop.PROBE_IN_PASSING if in_passing else Stop.PROBE
    return [Wait(0.0, block.line, stop=stop), move, Wait(0.0, block.line, stop=Stop.DRAIN)]


@carries_out(*PROBES)
def probe(block: BlockContext, g: GWord) -> list[QueueItem]:
    """Go straight at feed until the probe switches; the program is notified where it does not."""
    if block.after.modal.whole[FEED_MODE] == FEED_INVERSE_TIME:
        raise block.problem(f"G{g.code} with inverse time feed (G93)", "Select G94 first.", g.word)
    move = _measuring_move(block, g)
    if move.end == move.start:
        raise block.problem(f"G{g.code} to where the probe is", "Say how far to go at the most.", g.word)
    leaves, needed = PROBES[g.action]
    block.after.probe = Probe(
        frozenset(range(len(block.after.axis_names))),
        leaves=leaves,
        code=g.code,
        place=g.word.place,
        needed=needed,
    )
    return [Wait(0.0, block.line, stop=Stop.PROBE), move, Wait(0.0, block.line, stop=Stop.DRAIN)]


@carries_out(Action.PROBE_FIXED_STOP)
def go_to_fixed_stop(block: BlockContext, g: GWord) -> list[QueueItem]:
    """Go to a stop that the axes cannot pass, at the most to the end; it is met without going beyond."""
    move = _measuring_move(block, g)
    probe = block.after.probe
    assert probe is not None
    machine = block.after.machine
    if (met := first_contact(machine.surfaces, machine.axis_names, move.start, move.end)) is not None:
        block.after.probe = replace(probe, position=met)
        move = replace(move, end=met)
    return [move, Wait(0.0, block.line, stop=Stop.DRAIN)]


def _measuring_move(block: BlockContext, g: GWord, *, one_axis: bool = False) -> Line:
    refuse_compensation(block, g)
    values = motion.axis_words(block)
    if not values or (one_axis and len(values) > 1):
        count = "one axis" if one_axis else "an axis"
        raise block.problem(f"G{g.code} needs {count}", "Say how far to go at the most.", g.word)
    measured = frozenset(values) if one_axis else frozenset(range(len(block.after.axis_names)))
    block.after.probe = Probe(measured, one_axis)
    return replace(motion.line(block, motion.target(block, values), False), exact_stop=True)


@carries_out(Action.CLEAR_SET_POSITION)
def clear_position(block: BlockContext, g: GWord) -> None:
    """Cancel the shift of program zero."""
    refuse_compensation(block, g, side=False)
    block.after.place_zero(block.after.coordinates.without_shift())


@carries_out(Action.SUSPEND_POSITION, Action.RESUME_POSITION)
def suspend_position(block: BlockContext, g: GWord) -> None:
    """Suspend the shift of program zero, or put it in force again."""
    refuse_compensation(block, g, side=False)
    shifted = g.action is Action.RESUME_POSITION
    block.after.place_zero(replace(block.after.coordinates, shifted=shifted))


@carries_out(Action.SET_SHIFT)
def set_shift(block: BlockContext, g: GWord) -> None:
    """Put the shift of some axes where the words say, in place of what set it before."""
    refuse_compensation(block, g, side=False)
    values = motion.named_axes(block, g)
    block.after.place_zero(block.after.coordinates.with_shift_of(values))


@carries_out(Action.KEEP_REFERENCE, Action.KEEP_REFERENCE_POINT)
def keep_reference(block: BlockContext, g: GWord) -> None:
    """Make the present position the first or second reference position."""
    refuse_compensation(block, g, stage=False)
    first, second = block.after.references
    here = block.start
    block.after.references = (here, second) if g.action is Action.KEEP_REFERENCE else (first, here)


@carries_out(Action.SET_POSITION)
def set_position(block: BlockContext, g: GWord) -> None:
    """Shift program zero so that the present position reads these values."""
    refuse_compensation(block, g, side=False)
    if block.after.frame.active and not block.dialect.turns_work:
        raise block.problem(
            f"G{g.code} while positions are turned, scaled or mirrored",
            "Cancel rotation, scaling and mirroring first.",
            g.word,
        )
    values = motion.axis_words(block)
    if not values and "S" not in block.words.by_letter:  # S is the spindle's clamp
        raise block.problem(
            f"G{g.code} without an axis", "Name the axes and the positions they shall read.", g.word
        )
    state = block.after
    here = state.frame.back(state.here)
    if values:
        ways = {axis: here[axis] - value for axis, value in values.items()}
        state.place_zero(state.coordinates.with_shift(ways))


def _reference_number(block: BlockContext, g: GWord) -> int:
    """Take P: which reference position, the second if there is none."""
    word = block.words.take("P")
    number = 2 if word is None else whole_number(word, "a reference position", block.problem)
    if not 2 <= number <= REFERENCE_POSITIONS:
        raise block.problem(
            f"there is no reference position P{number}", f"Write P2 to P{REFERENCE_POSITIONS}.", word
        )
    known = any(len(axis.reference_positions) > number - 2 for axis in block.after.machine.axes)
    if not known and not (number == 2 and block.after.references[1] is not None):
        block.note(
            f"G{g.code}: the machine file has no reference position {number}: the home position is used"
        )
    return number


@carries_out(Action.REFERENCE_RETURN, Action.REFERENCE_POINT)
def return_to_reference(block: BlockContext, g: GWord) -> list[Line]:
    """Go to the point that the axis words name, then with these axes (all, if none) to a reference position."""
    number = 1 if g.action is Action.REFERENCE_RETURN else _reference_number(block, g)
    refuse_compensation(block, g, stage=False)
    values = motion.axis_words(block)
    start = block.start
    middle = motion.target(block, values)
    limits.check(block, middle, "would pass")
    kept = block.after.references[number - 1] if number <= len(block.after.references) else None
    home = tuple(
        motion.turned(
            block, index, axis.reference_position(number) if kept is None else kept[index], middle[index]
        )
        for index, axis in enumerate(block.after.machine.axes)
    )
    home = _home_of(block, values, middle, home)
    limits.check(block, home, "would go home to")
    if kept is None:
        _remark_home(block, g, [index for index in range(len(home)) if index in values or not values])
    return [
        Line(start, middle, Feed(), True, True, block.line),
        Line(middle, home, Feed(), True, True, block.line),
    ]


def _home_of(
    block: BlockContext, named: Collection[int], middle: tuple[float, ...], home: tuple[float, ...]
) -> tuple[float, ...]:
    """Return where the named axes, all if there are none, are at home: those of the turned work offset, if it turns."""
    if not named:
        return home
    turn = block.after.coordinates.turn
    zero = block.after.modal.offset.tolist()
    places = [list(middle), list(home)]
    if turn is not None:
        places = [
            block.after.frame.back([at - of for at, of in zip(each, zero, strict=True)]) for each in places
        ]
    chosen = [there if axis in named else at for axis, (at, there) in enumerate(zip(*places, strict=True))]
    if turn is None:
        return tuple(chosen)
    return tuple(at + of for at, of in zip(block.after.frame.forward(chosen), zero, strict=True))


def _remark_home(block: BlockContext, g: GWord, axes: list[int]) -> None:
    """Say that home is the part's zero, where it is: on hardly any machine it is."""
    machine, offset = block.after.machine, block.after.modal.offset
    linear = [index for index in axes if machine.axes[index].kind == "linear"]
    if linear and all(machine.axes[index].home == offset[index] for index in linear):
        block.note(
            f"G{g.code}: home lies at the part's zero on machine '{machine.name}'; a machine file says where it is"
        )


@carries_out(Action.MACHINE_COORDINATES)
def move_in_machine_coordinates(block: BlockContext, g: GWord) -> list[Line]:
    """Go straight to a point in machine coordinates."""
    refuse_compensation(block, g, stage=False)
    in_force = block.after.modal.whole[MOTION]
    if in_force not in (MOTION_RAPID, MOTION_LINEAR) or block.after.cycle.action:
        raise block.problem(f"G{g.code} goes with G0 or G1 only", "Write G0 or G1 in this block.", g.word)
    if not block.dialect.machine_coordinates_in_g91 and not block.after.modal.whole[ABSOLUTE]:
        raise block.problem(f"G{g.code} with incremental positions (G91)", "Select G90 first.", g.word)
    if not (words := motion.axis_words(block)):
        return []
    end = motion.target(block, words, machine_coordinates=True)
    return [motion.line(block, end, bool(in_force == MOTION_RAPID))]
