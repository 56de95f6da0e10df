"""Compensation of tools: their data, length (G43, G44, G49, H), and radius (G40, G41, G42, D)."""

from __future__ import annotations

import math

from polycnc.machine import ToolConfig
from polycnc.nc.blocks._block import BlockContext
from polycnc.nc.blocks._channel_state import of_another_channel
from polycnc.nc.blocks._compensation import Leads, Side
from polycnc.nc.blocks._tip import TIPS, TipShift
from polycnc.nc.blocks._tool_offsets import OFFSETS, diameter_of, shift_by_tool, tool_data
from polycnc.nc.blocks._words import GWord, whole_number
from polycnc.nc.modal._actions import Action, Family, Group
from polycnc.nc.modal._modal import NO_AXIS, PLANE, PLANE_YZ, PLANE_ZX
from polycnc.nc.text._scan_plain import Word

_BY_DIAMETER = (Action.COMP_LEFT_DIAMETER, Action.COMP_RIGHT_DIAMETER)


def compensate_length(block: BlockContext) -> None:
    """Carry out tool length compensation: G43, G44, G49 and H.

    Raises:
        ProgramError: there is no Z axis, or H is no tool.
    """
    g = block.words.g.get(Group.LENGTH_COMPENSATION)
    if g is not None and g.action in OFFSETS:
        shift_by_tool(block, g)
    elif g is not None or not block.dialect.shifts_by_code_alone:
        _compensate_along_z(block, g)


def _compensate_along_z(block: BlockContext, g: GWord | None) -> None:
    state, coordinates = block.after, block.after.coordinates
    sign = coordinates.length_sign if g is None else g.value
    if g is None and "H" not in block.words.by_letter:
        return
    if g is None and sign == 0:
        if not block.dialect.h_compensates:
            return  # an H that is left over is reported as such
        sign = 1
    if block.dialect.h_compensates and g is None and block.words.by_letter["H"].value == 0.0:
        sign = 0
    h_word = block.words.take("H")
    axis = state.axis("Z")
    if axis == NO_AXIS:
        if sign and of_another_channel("Z") in block.after.axis_names:
            raise block.problem(
                "tool length compensation along axis Z, which belongs to another channel",
                "Remove it, or execute the program in that channel.",
                h_word if g is None else g.word,
            )
        if sign and g is not None:
            raise block.problem(
                "tool length compensation on a machine without a Z axis", "Remove it.", g.word
            )
        return
    tool = block.after.tool if h_word is None else whole_number(h_word, "a tool offset number", block.problem)
    if sign == 0:
        state.place_zero(coordinates.with_length({}, 0))
        block.after.length_tool = 0
        return
    data = tool_data(block, tool)
    block.after.length_tool = tool
    shift = {axis: sign * (data.length_mm + data.wear_length_mm)}
    state.place_zero(coordinates.with_length(shift, sign))


def compensate_radius(block: BlockContext) -> None:
    """Carry out G40, G41, G42 and D; `block.change` changes the stage, when all else is right.

    Raises:
        ProgramError: D is no tool, or the plane is not there.
    """
    state = block.after
    g = block.words.g.get(Group.RADIUS_COMPENSATION)
    given = None if g is None or g.action not in _BY_DIAMETER else diameter_of(block, g)
    d_word = _d_word(block, g)
    if d_word is not None:
        state.compensation_tool = whole_number(d_word, "a tool offset number", block.problem)
    if g is not None:
        state.side = g.value
        if state.side == 0:
            block.change = state.compensation.cancel
            return
        if given is not None and block.words.by_letter["D"].value < 0.0:
            state.side = -state.side
    elif state.side == 0 or d_word is None:
        return
    plane = block.plane("radius compensation", None if g is None else g.word)
    tool = state.tool if state.compensation_tool is None else state.compensation_tool
    data = tool_data(block, tool) if given is None else given
    radius = data.radius_mm + data.wear_radius_mm
    radius += state.tables.tool_radius(state.placement.compensations)
    tip = _tip(block, data, radius)
    if "compensation outside X Y and X Z" in block.dialect.refuses:
        _check_plane(block, data.tip, None if g is None else g.word)

    def start() -> None:
        state.compensation = state.compensation.copy()
        state.compensation.start(
            Side(state.side),
            radius,
            plane,
            block.line,
            Leads(
                block.dialect.lead_in_by_arc,
                block.dialect.leads_out_at_once,
                block.dialect.lead_in_beside_itself,
                block.dialect.rapids_across_corners,
                math.sin(block.dialect.retraced_rad),
            ),
        )
        if tip != state.tip.vector:
            state.tip = TipShift(tip)

    block.change = start


def _d_word(block: BlockContext, g: GWord | None) -> Word | None:
    """Take D, on some controls beside the code of a side only."""
    alone = g is None or not g.value
    other = block.words.g.get(Group.NON_MODAL)
    cuts = other is not None and other.action.family in (Family.CONTOUR_CYCLE, Family.TURNING_CYCLE)
    return None if alone and (cuts or "D alone" in block.dialect.refuses) else block.words.take("D")


def _check_plane(block: BlockContext, tip: int, word: Word | None) -> None:
    """Refuse a plane in which the control does not compensate: Y Z, and with a turning tool all but X Z."""
    plane = int(block.after.modal.whole[PLANE])
    if plane == PLANE_YZ or (tip and plane != PLANE_ZX):
        tool = " with a turning tool" if tip else ""
        hint = "Select G18 for turning tools, G17 or G18 for others."
        raise block.problem(f"radius compensation in this plane{tool}", hint, word)


def _tip(block: BlockContext, data: ToolConfig, radius: float) -> tuple[tuple[int, float], ...]:
    """Return the way from the middle of a tool's nose to its tip, by axis; none for a tool without a tip."""
    ways = zip("XZ", TIPS[data.tip], strict=True)
    named = [(block.after.axis(name), way * radius) for name, way in ways]
    return tuple(named) if any(way for _, way in named) else ()
