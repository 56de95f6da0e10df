"""Functions that say where programmed positions lie: shifts, pole and scale, a turned workpiece, external tables."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from polycnc.nc.blocks import _motion as motion
from polycnc.nc.blocks._block import BlockContext
from polycnc.nc.blocks._handlers import carries_out
from polycnc.nc.blocks._words import GWord, check_angle, code_text, whole_number
from polycnc.nc.modal._actions import Action
from polycnc.nc.modal._frame import Rotation
from polycnc.nc.modal._modal import AXIS_P, AXIS_Q, AXIS_R, NO_AXIS, PLANE_LETTERS, PLANE_XY, set_plane
from polycnc.nc.modal._placement import Placement, Vector, total

LARGEST_FACTOR = 1000.0
_SHIFTS = {
    Action.CONTOUR_SHIFT: "contour",
    Action.PROGRAM_SHIFT: "program",
    Action.PROGRAM_SHIFT_ADD: "additive",
}
_OFF: dict[Action, dict[str, Any]] = {
    Action.CONTOUR_SHIFT_OFF: {"contour": ()},
    Action.PROGRAM_SHIFT_OFF: {"program": (), "additive": ()},
    Action.PROGRAM_SHIFT_ADD_OFF: {"additive": ()},
    Action.WORKPIECE_POSITION_OFF: {"position": (), "position_deg": 0.0},
    Action.POLE_SCALING_OFF: {"poles": {}, "factors": {}, "angle_deg": 0.0},
    Action.EXTERNAL_OFFSET_OFF: {"offsets": ()},
}
_TABLES = "KV"


@carries_out(*_SHIFTS)
def shift(block: BlockContext, g: GWord) -> None:
    """Shift the contour or program zero."""
    name, placement = _SHIFTS[g.action], block.after.placement
    changed: dict[str, Any] = {name: _vector(block, g, getattr(placement, name))}
    _put(block, replace(placement, **changed))


@carries_out(*_OFF)
def leave(block: BlockContext, g: GWord) -> None:
    """Leave what one of the other codes has put in force."""
    _put(block, replace(block.after.placement, **_OFF[g.action]))


@carries_out(Action.WORKPIECE_POSITION)
def place_workpiece(block: BlockContext, g: GWord) -> None:
    """Say where the workpiece lies, and how it is turned."""
    placement, angle = block.after.placement, _angle(block)
    values = motion.axis_words(block)
    vector = _vector(block, g, placement.position, values) if values else placement.position
    kept = placement.position_deg if angle is None else angle
    _put(block, replace(placement, position=vector, position_deg=kept))


@carries_out(Action.POLE)
def set_pole(block: BlockContext, g: GWord) -> None:
    """Set the pole of scaling and rotation."""
    placement = block.after.placement
    _put(block, replace(placement, poles={**placement.poles, **motion.named_axes(block, g)}))


@carries_out(Action.EXTERNAL_OFFSET)
def add_offset(block: BlockContext, g: GWord) -> None:
    """Add an external work offset."""
    placement = block.after.placement
    kept = (name for name in placement.offsets if name != f"G{g.code}")
    _put(block, replace(placement, offsets=(*kept, f"G{g.code}")))


@carries_out(Action.EXTERNAL_TOOL, Action.EXTERNAL_TOOL_OFF, Action.GENERAL_TOOL, Action.GENERAL_TOOL_OFF)
def set_tool_data(block: BlockContext, g: GWord) -> None:
    """Add or leave external or general tool data."""
    placement = block.after.placement
    external = g.action in (Action.EXTERNAL_TOOL, Action.EXTERNAL_TOOL_OFF)
    others = tuple(each for each in placement.compensations if (each % 100 == 45) != external)
    on = g.action in (Action.EXTERNAL_TOOL, Action.GENERAL_TOOL)
    _put(block, replace(placement, compensations=(*others, int(g.word.value)) if on else others))


def _put(block: BlockContext, placement: Placement) -> None:
    """Take a placement over; the axes stay where they are."""
    state = block.after
    axes = len(state.axis_names)
    plane = state.plane[:2]
    turn = placement.turn(plane)
    rotation = None
    if placement.angle_deg:
        poles = placement.poles.get(plane[0], 0.0), placement.poles.get(plane[1], 0.0)
        rotation = Rotation(*plane, *poles, placement.angle_deg)
    scales = {axis: (placement.poles.get(axis, 0.0), each) for axis, each in placement.factors.items()}
    state.placement = placement
    state.frame = replace(state.frame, scales=scales, rotation=rotation, outer=turn)
    inner = total(axes, placement.contour, placement.program, placement.additive)
    state.place_zero(
        replace(
            state.coordinates,
            inner=np.array(inner),
            outer=np.array(total(axes, placement.position)),
            turn=turn,
            external=placement.offsets,
            compensations=placement.compensations,
        )
    )


@carries_out(Action.POLE_SCALING)
def scale(block: BlockContext, g: GWord) -> None:
    """Scale axes about the pole, and turn the plane."""
    placement = block.after.placement
    angle = _angle(block)
    factors: dict[int, float] = {}
    for index, name in enumerate(block.after.axis_names):
        word = block.words.take(name)
        if word is None:
            continue
        if word.value == 0.0 or abs(word.value) > LARGEST_FACTOR:
            raise block.problem(
                f"the factor {name}{code_text(word.value)} is no scale",
                f"Write a number up to {LARGEST_FACTOR:g}; a negative one mirrors.",
                word,
            )
        factors[index] = word.value
    if angle is None and not factors:
        raise block.problem(f"G{g.code} without a factor or an angle", "Name axes, or add R.", g.word)
    kept = placement.angle_deg if angle is None else angle
    _put(block, replace(placement, factors={**placement.factors, **factors}, angle_deg=kept))


def _angle(block: BlockContext) -> float | None:
    angle = None if "R" in block.after.axis_names else block.words.value("R")
    if angle is None:
        return None
    check_angle(angle, block.words.first("R"), block.problem)
    if NO_AXIS in block.after.plane[:2]:
        letters = block.after.plane_letters[:2]
        raise block.problem(
            f"the machine has no plane {letters} to turn", "Remove R.", block.words.first("R")
        )
    return angle


def _vector(block: BlockContext, g: GWord, old: Vector, values: dict[int, float] | None = None) -> Vector:
    """Return a vector with the axes that the block names changed."""
    found = total(len(block.after.axis_names), old)
    for axis, value in (values or motion.named_axes(block, g)).items():
        found[axis] = value
    return tuple(found)


@carries_out(Action.PLANE_BY_AXES)
def select_plane(block: BlockContext, g: GWord) -> None:
    """Take the two axes that the block names as the plane; their values are its pole."""
    names = block.after.axis_names
    place = {word.place: name for name, word in block.words.unused() if name in names}
    order = [names.index(place[at]) for at in sorted(place)]
    values = motion.named_axes(block, g)
    letters = "".join(names[axis] for axis in order)
    plane = next((n for n, each in enumerate(PLANE_LETTERS) if set(each[:2]) == set(letters)), None)
    if len(order) != 2 or plane is None:
        raise block.problem(
            f"G{g.code} takes two axes of X, Y and Z", "Name the main axis first, then the other.", g.word
        )
    if block.after.cycle.action:
        raise block.problem("the plane changes while a drilling cycle is active", "Cancel it first.", g.word)
    modal = block.after.modal
    set_plane(modal, plane)
    if PLANE_LETTERS[plane][:2] != letters:
        whole = modal.whole
        whole[AXIS_P], whole[AXIS_Q] = order
        third = ({0, 1, 2} if plane == PLANE_XY else {whole[AXIS_R]}) - set(order)
        whole[AXIS_R] = next(iter(third), NO_AXIS)
    state = block.after
    state.placement = replace(state.placement, plane=(order[0], order[1]))
    poles = {axis: value for axis, value in values.items() if value or axis in state.placement.poles}
    if poles:
        _put(block, replace(state.placement, poles={**state.placement.poles, **poles}))


@carries_out(Action.SELECT_TABLES)
def select_tables(block: BlockContext, g: GWord) -> None:
    chosen = [letter for letter in _TABLES if letter in block.words.by_letter]
    if not chosen:
        raise block.problem(f"G{g.code} without a table", "Add K or V and its number.", g.word)
    for letter in chosen:
        word = block.words.take(letter)
        assert word is not None
        number = whole_number(word, "the number of a table", block.problem)
        if not block.after.tables.select(letter, number):
            raise block.problem(f"there is no table {letter}{number}", "See the tables of the control.", word)
    block.after.take_changes()
