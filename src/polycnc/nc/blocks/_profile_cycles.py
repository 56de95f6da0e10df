"""Turning cycles about a profile that stands in a sub-program: G70 to G72 of LinuxCNC. X in them is a radius.

Source: LinuxCNC G-code manual, "G70", "G71", "G72".
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from polycnc.nc.blocks import _turning_moves as turns
from polycnc.nc.blocks._block import BlockContext
from polycnc.nc.blocks._handlers import carries_out
from polycnc.nc.blocks._moves import GeometryError, QueueItem
from polycnc.nc.blocks._profile_cuts import Cut, Roughing, finish, rough
from polycnc.nc.blocks._profiles import NEAR, Part
from polycnc.nc.blocks._turning import Piece, Step
from polycnc.nc.blocks._words import GWord, whole_number
from polycnc.nc.modal._actions import Action, Family
from polycnc.nc.modal._modal import (
    ABSOLUTE,
    ARC_ABSOLUTE,
    MOTION,
    MOTION_ARC_CCW,
    MOTION_ARC_CW,
    MOTION_LINEAR,
    MOTION_RAPID,
    RAPID_STOP,
    length_scale,
)
from polycnc.nc.text._scan_plain import Block

_MOST_PASSES = 1000
_MOTIONS = {
    Action.RAPID: MOTION_RAPID,
    Action.LINEAR: MOTION_LINEAR,
    Action.ARC_CW: MOTION_ARC_CW,
    Action.ARC_CCW: MOTION_ARC_CCW,
}


@carries_out(Action.PROFILE_FINISH, Action.PROFILE_ROUGH, Action.PROFILE_FACE)
def cut_profile(block: BlockContext, g: GWord) -> list[QueueItem]:
    """Return the moves of the cycle.

    Raises:
        ProgramError: a word or the profile is missing, the profile cannot be cut, or a limit would be passed.
    """
    _check(block, g)
    number = block.words.take("Q")
    if number is None:
        raise block.problem(f"G{g.code} without Q", "Add Q and the number of the sub-program.", g.word)
    if block.block.profile is None:
        name = whole_number(number, "a sub-program", block.problem)
        raise block.problem(
            f"there is no sub-program O{name} in this file", f"Write O{name} SUB and its profile.", number
        )
    here = _here(block)
    begin = _point(block, dict(block.words.lengths("XZ")), here)
    parts = list(_parts(block, g, block.block.profile, begin))
    cuts = [Cut(begin, rapid=True)] if begin != here else []
    if len(parts) > 1:
        try:
            cuts += _cuts(block, g, parts, begin)
        except GeometryError as error:
            raise block.problem(f"G{g.code}: {error.what}", error.hint, g.word) from None
    return list(_items(block, g, cuts))


def _check(block: BlockContext, g: GWord) -> None:
    state = block.after
    if g.action is not Action.PROFILE_FINISH:
        turns.refuse_compensation(block)
    if state.frame.active:
        raise block.problem(f"G{g.code} in turned coordinates", "Take a work offset without R.", g.word)
    if set(state.plane[:2]) != set(turns.axes(block)):
        raise block.problem(f"G{g.code} outside the plane of X and Z", "Select G18 first.", g.word)


def _here(block: BlockContext) -> complex:
    """Return where the tool stands, X as a radius, in the units of the program."""
    modal, unit = block.after.modal, length_scale(block.after.modal)
    x, z = (float(modal.position[axis] - modal.offset[axis]) / unit for axis in turns.axes(block))
    return complex(z, x)


def _point(block: BlockContext, values: dict[str, float], at: complex) -> complex:
    """Return the point that X and Z of a line say, from another point on."""
    modal = block.after.modal
    scale = float(modal.scale[turns.axes(block)[0]]) / length_scale(modal)
    absolute = bool(modal.whole[ABSOLUTE])
    z, x = (
        0.0 if absolute and letter in values else place for letter, place in (("Z", at.real), ("X", at.imag))
    )
    z, x = z + values.get("Z", 0.0), x + values.get("X", 0.0) * scale
    if absolute:  # on a machine with axes U and W these words are ways all the same
        z, x = z + values.get("W", 0.0), x + values.get("U", 0.0) * scale
    return complex(z, x)


def _or(value: float | None, other: float) -> float:
    return other if value is None else value


def _cuts(block: BlockContext, g: GWord, parts: list[Part], begin: complex) -> list[Cut]:
    words = block.words
    distance, depth = _or(words.value("D"), 0.0), words.take("I")
    if g.action is Action.PROFILE_FINISH:
        last, passes = _or(words.value("E"), 0.0), int(_or(words.value("P"), 1.0))
        if passes > _MOST_PASSES:
            raise GeometryError(f"{passes} passes", f"Write up to {_MOST_PASSES}.")
        return finish(parts, distance, last, passes)
    if depth is not None and depth.value <= 0.0:
        raise block.problem("the depth of a cut is not above zero", "Write a positive I.", depth)
    retract = words.take("R")
    if retract is not None and retract.value < 0.0:
        raise block.problem("the retract is negative", "Write R from 0 up.", retract)
    displacement = complex(_or(words.value("W"), 0.0), _or(words.value("U"), 0.0))
    numbers = Roughing(
        round(g.word.value * 10.0) % 10,
        distance,
        1.0 if depth is None else depth.value,
        0.5 if retract is None else retract.value,
        displacement,
    )
    return rough(parts, numbers, along_x=g.action is Action.PROFILE_FACE)


def _parts(block: BlockContext, g: GWord, profile: tuple[Block, ...], begin: complex) -> Iterator[Part]:
    """Yield the moves of a profile: of its words those of motion, X and Z, arcs and corners count."""
    motion, at = int(block.after.modal.whole[MOTION]), begin
    for row in profile:
        values: dict[str, float] = {}
        for word in row.words:
            if word.letter == "G":
                motion = _MOTIONS.get(block.dialect.g_action(word.value) or Action.MOTION_OFF, motion)
            else:
                values[word.letter] = word.value
        end = _point(block, values, at)
        if end == at or motion not in _MOTIONS.values():
            at = end
            continue
        if motion in (MOTION_RAPID, MOTION_LINEAR):
            yield Part(at, end)
        else:
            ccw = motion == MOTION_ARC_CCW
            yield Part(at, end, _center(block, g, at, end, values, ccw), ccw)
        if values.keys() >= {"A", "C"}:
            raise block.problem(
                f"G{g.code}: A and C at one corner of the profile", "Write one of them.", g.word
            )
        for letter in "AC":
            if letter in values:
                yield Part(end, end, None, False, values[letter], letter == "A")
        at = end


def _center(
    block: BlockContext, g: GWord, at: complex, end: complex, values: dict[str, float], ccw: bool
) -> complex:
    if "R" in values:
        way, radius = end - at, values["R"]
        square = radius * radius - abs(way) ** 2 / 4.0
        if square < 0.0:
            raise block.problem(
                f"G{g.code}: an arc of the profile is longer than its R allows", "Check R.", g.word
            )
        aside = 1j * math.sqrt(square) / abs(way) * way
        return (at + end) / 2.0 + (aside if ccw else -aside)
    if "I" not in values and "K" not in values:
        raise block.problem(
            f"G{g.code}: an arc of the profile without a centre", "Add I and K, or R.", g.word
        )
    center = complex(values.get("K", 0.0), values.get("I", 0.0))
    return center if block.after.modal.whole[ARC_ABSOLUTE] else at + center


def _motion(cut: Cut) -> int:
    if cut.center is None:
        return MOTION_RAPID if cut.rapid else MOTION_LINEAR
    return MOTION_ARC_CCW if cut.ccw else MOTION_ARC_CW


def _items(block: BlockContext, g: GWord, cuts: list[Cut]) -> Iterator[QueueItem]:
    state, unit = block.after, length_scale(block.after.modal)
    x, z = turns.axes(block)
    offset = complex(float(state.modal.offset[z]), float(state.modal.offset[x]))
    at = complex(block.start[z], block.start[x])
    steps = []
    for cut in cuts:
        end = cut.end * unit + offset
        if abs(end - at) < NEAR * unit:
            continue
        point = end.imag, end.real
        arc = None
        if cut.center is not None:
            center = cut.center * unit + offset
            turn = ((end - center) / (at - center)) if at != center else 1.0
            sweep = math.atan2(turn.imag, turn.real) % (2.0 * math.pi)
            sweep = sweep if cut.ccw else sweep - 2.0 * math.pi
            arc = Piece((at.imag, at.real), point, (center.imag, center.real), sweep)
        steps.append(Step(point, cut.rapid, arc))
        at = end
    state.leave_drilling()
    state.leave_turning()
    state.mode = Family.MOVE
    state.modal.whole[MOTION] = _motion(cuts[-1]) if cuts else MOTION_RAPID
    stops = block.exact_stop or bool(state.modal.whole[RAPID_STOP])
    yield from turns.items(block, steps, block.start, stops=stops)
