"""Functions that say where programmed positions lie: shifts, pole and scale, a turned workpiece, external tables."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

from polycnc.nc.blocks._auxiliary import whole_number
from polycnc.nc.blocks._channel_state import ChannelState
from polycnc.nc.blocks._motion import MotionBuilder
from polycnc.nc.blocks._words import BlockWords, Fail, GWord, code_text
from polycnc.nc.modal._actions import Action
from polycnc.nc.modal._frame import Rotation
from polycnc.nc.modal._modal import (
    AXIS_P,
    AXIS_Q,
    AXIS_R,
    NO_AXIS,
    PLANE,
    PLANE_LETTERS,
    PLANE_XY,
    set_plane,
)
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


@dataclass
class Placing:
    """Carry out these functions; none of them moves an axis."""

    state: ChannelState
    motion: MotionBuilder
    fail: Fail

    def carry_out(self, g: GWord, words: BlockWords) -> None:
        """Change where programmed positions lie.

        Raises:
            ProgramError: Radius compensation is active, or a word is missing or has no meaning here.
        """
        state, placement = self.state, self.state.placement
        if state.side or state.compensation.active:
            raise self.fail(
                f"G{g.code} while radius compensation is active", "Cancel it with G40 first.", g.word
            )
        if g.action in _SHIFTS:
            name = _SHIFTS[g.action]
            changed: dict[str, Any] = {name: self._vector(g, getattr(placement, name))}
            self._put(replace(placement, **changed))
        elif g.action in _OFF:
            self._put(replace(placement, **_OFF[g.action]))
        elif g.action is Action.PLANE_BY_AXES:
            self._select_plane(g)
        elif g.action is Action.SELECT_TABLES:
            self._select_tables(g, words)
        else:
            self._put(self._changed(g, words, placement))

    def _changed(self, g: GWord, words: BlockWords, placement: Placement) -> Placement:
        code = int(g.word.value)
        match g.action:
            case Action.WORKPIECE_POSITION:
                angle = self._angle(words)
                values = self.motion.axis_words()
                vector = self._vector(g, placement.position, values) if values else placement.position
                kept = placement.position_deg if angle is None else angle
                return replace(placement, position=vector, position_deg=kept)
            case Action.POLE:
                return replace(placement, poles={**placement.poles, **self._axes(g)})
            case Action.POLE_SCALING:
                return self._scaled(g, words, placement)
            case Action.EXTERNAL_OFFSET:
                kept_names = (name for name in placement.offsets if name != f"G{g.code}")
                return replace(placement, offsets=(*kept_names, f"G{g.code}"))
            case (
                Action.EXTERNAL_TOOL
                | Action.EXTERNAL_TOOL_OFF
                | Action.GENERAL_TOOL
                | Action.GENERAL_TOOL_OFF
            ):
                external = g.action in (Action.EXTERNAL_TOOL, Action.EXTERNAL_TOOL_OFF)
                others = tuple(each for each in placement.compensations if (each % 100 == 45) != external)
                on = g.action in (Action.EXTERNAL_TOOL, Action.GENERAL_TOOL)
                return replace(placement, compensations=(*others, code) if on else others)
            case _:
                raise self.fail(f"G{g.code} cannot be carried out", "Take it out.", g.word)

    def _put(self, placement: Placement) -> None:
        """Take a placement over; the axes stay where they are."""
        state = self.state
        axes = len(state.axis_names)
        whole = state.modal.whole
        plane = int(whole[AXIS_P]), int(whole[AXIS_Q])
        turn = placement.turn(plane)
        rotation = None
        if placement.angle_deg:
            poles = placement.poles.get(plane[0], 0.0), placement.poles.get(plane[1], 0.0)
            rotation = Rotation(*plane, *poles, placement.angle_deg)
        scales = {axis: (placement.poles.get(axis, 0.0), each) for axis, each in placement.factors.items()}
        state.placement = placement
        state.frame = replace(state.frame, scales=scales, rotation=rotation, outer=turn)
        inner = total(axes, placement.contour, placement.program, placement.additive)
        state.coordinates.place(inner, total(axes, placement.position), turn)
        state.coordinates.set_external(placement.offsets, placement.compensations)

    def _scaled(self, g: GWord, words: BlockWords, placement: Placement) -> Placement:
        angle = self._angle(words)
        factors: dict[int, float] = {}
        for index, name in enumerate(self.state.axis_names):
            word = words.take(name)
            if word is None:
                continue
            if word.value == 0.0 or abs(word.value) > LARGEST_FACTOR:
                raise self.fail(
                    f"the factor {name}{code_text(word.value)} is no scale",
                    f"Write a number up to {LARGEST_FACTOR:g}; a negative one mirrors.",
                    word,
                )
            factors[index] = word.value
        if angle is None and not factors:
            raise self.fail(f"G{g.code} without a factor or an angle", "Name axes, or add R.", g.word)
        kept = placement.angle_deg if angle is None else angle
        return replace(placement, factors={**placement.factors, **factors}, angle_deg=kept)

    def _angle(self, words: BlockWords) -> float | None:
        angle = None if "R" in self.state.axis_names else words.value("R")
        if angle is None:
            return None
        if not math.isfinite(angle) or abs(angle) > 360_000.0:
            raise self.fail(
                f"the angle R{code_text(angle)} is too large", "Write up to a turn.", words.first("R")
            )
        whole = self.state.modal.whole
        if NO_AXIS in (whole[AXIS_P], whole[AXIS_Q]):
            letters = PLANE_LETTERS[int(whole[PLANE])][:2]
            raise self.fail(f"the machine has no plane {letters} to turn", "Take R out.", words.first("R"))
        return angle

    def _axes(self, g: GWord) -> dict[int, float]:
        values = self.motion.axis_words()
        if not values:
            raise self.fail(f"G{g.code} without an axis", "Name the axes.", g.word)
        return values

    def _vector(self, g: GWord, old: Vector, values: dict[int, float] | None = None) -> Vector:
        """Return a vector with the axes that the block names changed."""
        found = total(len(self.state.axis_names), old)
        for axis, value in (values or self._axes(g)).items():
            found[axis] = value
        return tuple(found)

    def _select_plane(self, g: GWord) -> None:
        """Take the two axes that the block names as the plane; their values are its pole."""
        names = self.state.axis_names
        place = {word.place: name for name, word in self.motion.words.unused() if name in names}
        order = [names.index(place[at]) for at in sorted(place)]
        values = self._axes(g)
        letters = "".join(names[axis] for axis in order)
        plane = next((n for n, each in enumerate(PLANE_LETTERS) if set(each[:2]) == set(letters)), None)
        if len(order) != 2 or plane is None:
            raise self.fail(
                f"G{g.code} takes two axes of X, Y and Z", "Name the main axis first, then the other.", g.word
            )
        if self.state.cycle.action:
            raise self.fail("the plane changes while a drilling cycle is active", "Cancel it first.", g.word)
        modal = self.state.modal
        set_plane(modal, plane)
        if PLANE_LETTERS[plane][:2] != letters:
            whole = modal.whole
            whole[AXIS_P], whole[AXIS_Q] = order
            third = ({0, 1, 2} if plane == PLANE_XY else {whole[AXIS_R]}) - set(order)
            whole[AXIS_R] = next(iter(third), NO_AXIS)
        state = self.state
        state.placement = replace(state.placement, plane=(order[0], order[1]))
        poles = {axis: value for axis, value in values.items() if value or axis in state.placement.poles}
        if poles:
            self._put(replace(state.placement, poles={**state.placement.poles, **poles}))

    def _select_tables(self, g: GWord, words: BlockWords) -> None:
        chosen = [letter for letter in _TABLES if letter in words.by_letter]
        if not chosen:
            raise self.fail(f"G{g.code} without a table", "Add K or V and its number.", g.word)
        for letter in chosen:
            word = words.take(letter)
            assert word is not None
            number = whole_number(word, "the number of a table", self.fail)
            if not self.state.tables.select(letter, number):
                raise self.fail(f"there is no table {letter}{number}", "See the tables of the control.", word)
        self.state.coordinates.take_changes()
