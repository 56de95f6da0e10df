"""Motion blocks: axis words, end points, straight lines; the mode of motion of G0, G1, G2 and G3."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

from polycnc.nc.blocks import _feeds as feeds
from polycnc.nc.blocks import _limits as limits
from polycnc.nc.blocks._arc_blocks import arc
from polycnc.nc.blocks._block import BlockContext
from polycnc.nc.blocks._corner_blocks import held
from polycnc.nc.blocks._moves import Feed, Line, Point, QueueItem, Wait
from polycnc.nc.blocks._polar_words import POLAR_LETTERS, polar_words
from polycnc.nc.blocks._words import GWord
from polycnc.nc.modal._actions import Family, Group
from polycnc.nc.modal._frame import UNTURNED, Polar
from polycnc.nc.modal._modal import (
    ABSOLUTE,
    LARGEST,
    MOTION,
    MOTION_ARC_CW,
    MOTION_NONE,
    MOTION_RAPID,
    NO_AXIS,
    RAPID_STOP,
    short_way,
)


def begin(block: BlockContext, g: GWord) -> None:
    """Put G0, G1, G2, G3 or no motion in force."""
    state = block.after
    if state.mode is not Family.MOVE:
        state.leave_drilling()
        state.leave_turning()
    state.modal.whole[MOTION] = g.value


def moves(block: BlockContext) -> list[QueueItem]:
    """Return the moves of a G0, G1, G2 or G3 block; none without a position.

    Raises:
        ProgramError: axis words without a motion, or what is wrong with the move.
    """
    whole = block.after.modal.whole
    motion = int(whole[MOTION])
    values = axis_words(block)
    bends = motion >= MOTION_ARC_CW and any(letter in "IJKR" for letter, _ in block.words.unused())
    if not values and not bends:
        alone = motion >= MOTION_ARC_CW and Group.MOTION in block.words.g
        if alone and "motion code alone" in block.dialect.refuses:
            raise block.problem("an arc without words", "Add its end and I J K or R.", block.move_word)
        return []
    if motion == MOTION_NONE:
        raise block.problem(
            "axis words without a motion",
            "Write G0, G1, G2, G3 or a cycle in this or an earlier block.",
            block.move_word,
        )
    end = target(block, values)
    if motion >= MOTION_ARC_CW:
        found = arc(block, end, motion == MOTION_ARC_CW)
        return [line(block, end, False) if found is None else found]
    if motion == MOTION_RAPID:
        return [line(block, end, True)]
    if block.after.spindle.surface_speed:
        limits.check(block, end)
        cuts = list(cut(block, block.start, end))
    else:
        cuts = [line(block, end, False)]
    return held(block, cuts) if block.dialect.corner_words else [*cuts]


def axis_words(block: BlockContext) -> dict[int, float]:
    """Take the axis words of the block: axis index -> value in mm or degree, not placed yet."""
    found = {}
    modal, names = block.after.modal, block.after.axis_names
    if "@" in block.words.by_letter or "^" in block.words.by_letter:
        found.update(polar_words(block))
    for letter, value in block.words.lengths(names):
        index = names.index(letter)
        found[index] = value * float(modal.scale[index])
    if ways := block.rules.ways:
        for letter, value in block.words.lengths(ways):
            index = ways[letter]
            if index in found:
                name = names[index]
                raise block.problem(
                    f"{letter} and {name} both say where {name} goes",
                    "Write one of them.",
                    block.words.by_letter[letter],
                )
            here = float(modal.position[index] - modal.offset[index])
            found[index] = here + value * float(modal.scale[index])
    return found


def named_axes(block: BlockContext, g: GWord) -> dict[int, float]:
    """Take the axis words of a code that needs one.

    Raises:
        ProgramError: there is none.
    """
    values = axis_words(block)
    if not values:
        raise block.problem(f"G{g.code} without an axis", "Name the axes.", g.word)
    return values


def axis_word_left(block: BlockContext) -> bool:
    """Tell whether there is an axis word that nothing has taken."""
    names = (*block.after.axis_names, *block.rules.ways, *POLAR_LETTERS)
    return any(letter in names for letter, _ in block.words.unused())


def target(block: BlockContext, axis_values: dict[int, float], machine_coordinates: bool = False) -> Point:
    """Return the machine position that axis words ask for; axes without a word stay."""
    modal, frame = block.after.modal, block.after.frame
    point: list[float] = modal.position.tolist()
    absolute = bool(modal.whole[ABSOLUTE])
    if frame is not UNTURNED and frame.active and not machine_coordinates and axis_values:
        return _framed_target(block, axis_values, absolute)
    for index, value in axis_values.items():
        if machine_coordinates:
            point[index] = turned(block, index, value, point[index])
        elif absolute:
            point[index] = turned(block, index, value + float(modal.offset[index]), point[index])
        else:
            point[index] += value
    return tuple(point)


def _framed_target(block: BlockContext, axis_values: dict[int, float], absolute: bool) -> Point:
    """Return the same where positions are turned, scaled, mirrored or polar."""
    modal = block.after.modal
    frame = block.after.frame
    point: list[float] = modal.position.tolist()
    offset: list[float] = modal.offset.tolist()
    programmed = frame.back([a - b for a, b in zip(point, offset, strict=True)])
    changed = set(axis_values)
    plane = block.after.plane[:2]
    if frame.polar is not None and NO_AXIS not in plane and changed & set(plane):
        polar = _polar(block, frame.polar, axis_values, programmed, absolute)
        block.after.frame = replace(frame, polar=polar)
        programmed[plane[0]], programmed[plane[1]] = polar.point()
        changed |= set(plane)
        others = {axis: value for axis, value in axis_values.items() if axis not in plane}
    else:
        others = axis_values
    for axis, value in others.items():
        programmed[axis] = value if absolute else programmed[axis] + value
    for turn in (frame.rotation, frame.outer):
        if turn is not None and changed & {turn.p, turn.q}:
            changed |= {turn.p, turn.q}
    found = frame.forward(programmed)
    for axis in changed:
        wanted = found[axis] + offset[axis]
        point[axis] = turned(block, axis, wanted, point[axis]) if absolute else wanted
    return tuple(point)


def _polar(
    block: BlockContext, polar: Polar, axis_values: dict[int, float], programmed: list[float], absolute: bool
) -> Polar:
    modal = block.after.modal
    p, q, _ = block.after.plane
    if p in axis_values:
        center = (0.0, 0.0) if absolute else (programmed[p], programmed[q])
        polar = replace(polar, center=center, radius=axis_values[p])
    if q in axis_values:
        angle = axis_values[q] / float(modal.scale[q])  # degrees, whatever the unit of lengths
        polar = replace(polar, angle_deg=angle if absolute else polar.angle_deg + angle)
    return polar


def turned(block: BlockContext, axis: int, wanted: float, position: float) -> float:
    """Return where an axis goes for position `wanted`: the short way if positions repeat."""
    if block.rules.modulo[axis] and abs(wanted) <= LARGEST:
        return short_way(wanted, position)
    return wanted


def line(block: BlockContext, end: Point, rapid: bool) -> Line:
    """Return a straight move from the programmed position to `end`."""
    rules, whole = block.rules, block.after.modal.whole
    if any(not low <= value <= high for value, low, high in zip(end, rules.low, rules.high, strict=True)):
        limits.check(block, end)
    begin: Point = tuple(block.after.modal.position.tolist())
    feed = Feed() if rapid else feeds.feed(block, begin, end)
    stop = block.exact_stop or (rapid and bool(whole[RAPID_STOP]))
    return Line(begin, end, feed, rapid, stop, block.line)


def note_position(block: BlockContext) -> None:
    """Remember the programmed position that the items lead to, which is not compensated."""
    position, corner = block.after.modal.position, block.after.corner
    if corner is not None:
        position[:] = corner.move.end
        return
    for item in reversed(block.items):
        if not isinstance(item, Wait):
            position[:] = item.end
            return


def cut(block: BlockContext, begin: Point, end: Point) -> Iterator[Line]:
    """Yield a straight cut, in parts where the spindle's speed reaches its clamp on the way.

    Within a part the speed of constant surface speed is that at its middle, which takes the same time as one that
    changes all along: that grows with X.
    """
    points = [begin, *feeds.clamp_points(block, begin, end), end]
    last = len(points) - 2
    for number, (a, b) in enumerate(pairwise(points)):
        yield Line(a, b, feeds.feed(block, a, b), False, block.exact_stop and number == last, block.line)
