"""Functions that change how programmed positions are meant: G51, G50, G51.1, G50.1, G68, G69, G16, G15, G52, G10."""

from __future__ import annotations

import math
from dataclasses import replace

from polycnc.nc.blocks import _motion as motion
from polycnc.nc.blocks._block import BlockContext
from polycnc.nc.blocks._handlers import carries_out, refuse_compensation
from polycnc.nc.blocks._tables import ADDITIONAL_OFFSETS, COMMON_OFFSET, WORK_SYSTEMS, additional_offset
from polycnc.nc.blocks._tool_offsets import set_tool
from polycnc.nc.blocks._turned_offsets import other_frame, zero_that_reads
from polycnc.nc.blocks._turning_data import set_turning_data
from polycnc.nc.blocks._word_checks import refuse_rest
from polycnc.nc.blocks._words import GWord, check_angle, code_text, whole_number
from polycnc.nc.modal._actions import Action
from polycnc.nc.modal._frame import Polar, Rotation
from polycnc.nc.modal._modal import ABSOLUTE, NO_AXIS

LARGEST_FACTOR = 1000.0
LARGEST_OFFSET_NUMBER = 999
_FACTORS = "IJK"
_TOOL_FIELDS = {1: "length_mm", 10: "length_mm", 11: "wear_length_mm", 12: "radius_mm", 13: "wear_radius_mm"}


@carries_out(Action.SCALING)
def scale(block: BlockContext, g: GWord) -> None:
    """Scale about a point."""
    block.after.frame = replace(block.after.frame, scales=_scales(block, g))


@carries_out(Action.SCALING_OFF)
def scale_off(block: BlockContext, _: GWord) -> None:
    """Leave scaling."""
    block.after.frame = replace(block.after.frame, scales={})


@carries_out(Action.MIRROR)
def mirror(block: BlockContext, g: GWord) -> None:
    """Mirror axes about positions."""
    mirrors = {**block.after.frame.mirrors, **motion.named_axes(block, g)}
    block.after.frame = replace(block.after.frame, mirrors=mirrors)


@carries_out(Action.MIRROR_OFF)
def mirror_off(block: BlockContext, _: GWord) -> None:
    """Leave mirroring of the axes that are named, of all if none is."""
    named = motion.axis_words(block)
    kept = {axis: at for axis, at in block.after.frame.mirrors.items() if named and axis not in named}
    block.after.frame = replace(block.after.frame, mirrors=kept)


@carries_out(Action.ROTATION)
def rotate(block: BlockContext, g: GWord) -> None:
    """Turn the plane about a point."""
    block.after.frame = replace(block.after.frame, rotation=_rotation(block, g))


@carries_out(Action.ROTATION_OFF)
def rotate_off(block: BlockContext, _: GWord) -> None:
    """Leave rotation."""
    block.after.frame = replace(block.after.frame, rotation=None)


@carries_out(Action.POLAR)
def polar(block: BlockContext, g: GWord) -> None:
    """Read the words of the plane as radius and angle."""
    p, q, _ = block.plane(f"G{g.code}", g.word)
    frame = block.after.frame
    here = frame.back(block.after.here)
    at = Polar((0.0, 0.0), math.hypot(here[p], here[q]), math.degrees(math.atan2(here[q], here[p])))
    block.after.frame = replace(frame, polar=at)


@carries_out(Action.POLAR_OFF)
def polar_off(block: BlockContext, _: GWord) -> None:
    """Leave polar coordinates."""
    block.after.frame = replace(block.after.frame, polar=None)


def _rotation(block: BlockContext, g: GWord) -> Rotation:
    p, q, _ = block.plane(f"G{g.code}", g.word)
    angle = block.words.length("R")
    if angle is None:
        raise block.problem(f"G{g.code} without an angle", "Add R and the angle in degrees.", g.word)
    check_angle(angle, block.words.first("R"), block.problem)
    values = motion.axis_words(block)
    if wrong := [axis for axis in values if axis not in (p, q)]:
        name = block.after.axis_names[wrong[0]]
        raise block.problem(
            f"axis {name} is not in the plane that G{g.code} turns",
            "Select another plane before, or remove the word.",
            block.words.first(name),
        )
    center = block.after.here
    if not block.after.modal.whole[ABSOLUTE]:
        values = {}  # the centre is where the tool stands
    return Rotation(p, q, values.get(p, center[p]), values.get(q, center[q]), angle)


def _scales(block: BlockContext, g: GWord) -> dict[int, tuple[float, float]]:
    here = block.after.here
    centers = motion.axis_words(block)
    if not block.after.modal.whole[ABSOLUTE]:
        centers = {axis: here[axis] + value for axis, value in centers.items()}
    linear = [index for index, axis in enumerate(block.after.machine.axes) if axis.kind == "linear"]
    letters = [letter for letter in _FACTORS if letter in block.words.by_letter]
    factors: dict[int, float] = {}
    if "P" in block.words.by_letter:
        if letters:
            raise block.problem(
                f"G{g.code} with P and {letters[0]}", "Write one factor P, or I J K.", block.words.first("P")
            )
        common = _factor(block, "P")
        factors = dict.fromkeys(centers or linear, common)
    elif letters:
        for letter, name in zip(_FACTORS, "XYZ", strict=True):
            axis = block.after.axis(name)
            if letter in letters:
                factor = _factor(block, letter)
                if axis != NO_AXIS:
                    factors[axis] = factor
    else:
        raise block.problem(f"G{g.code} without a factor", "Add P, or I J K.", g.word)
    return {axis: (centers.get(axis, here[axis]), factor) for axis, factor in factors.items()}


def _factor(block: BlockContext, letter: str) -> float:
    word = block.words.take(letter)
    assert word is not None
    factor = word.value if word.point else word.value * block.dialect.scaling_unit
    if factor == 0.0 or abs(factor) > LARGEST_FACTOR or (letter == "P" and factor < 0.0):
        raise block.problem(
            f"the factor {letter}{code_text(word.value)} is no scale",
            f"Without a point it counts {block.dialect.scaling_unit:g}; write it like {letter}1.5.",
            word,
        )
    return factor


# ------------------------------------------------------------------ coordinate systems and offsets


@carries_out(Action.LOCAL_COORDINATES)
def set_local(block: BlockContext, g: GWord) -> None:
    values = motion.named_axes(block, g)
    incremental = not block.after.modal.whole[ABSOLUTE]
    block.after.place_zero(block.after.coordinates.with_local(values, add=incremental))


@carries_out(Action.SET_DATA)
def set_data(block: BlockContext, g: GWord) -> None:
    if block.dialect.tool_word == "turret":
        set_turning_data(block, g)
        return
    table_word = block.words.take("L")
    if table_word is None:
        raise block.problem(f"G{g.code} without L", "Add L2, L20, or L10 to L13.", g.word)
    table = whole_number(table_word, "a kind of data", block.problem)
    number_word = block.words.take("P")
    if number_word is None and table != 2:
        raise block.problem(f"G{g.code} L{table} without P", "Add P and the number.", g.word)
    largest = {2: 6, 20: ADDITIONAL_OFFSETS}.get(table, LARGEST_OFFSET_NUMBER)
    number = (
        0
        if number_word is None
        else whole_number(number_word, "a number of these data", block.problem, largest)
    )
    if table in (2, 20):
        _set_work_offset(block, g, table, number)
    elif table in _TOOL_FIELDS:
        _set_tool(block, g, _TOOL_FIELDS[table], number)
    else:
        raise block.problem(
            f"G{g.code} L{table} is not supported yet",
            "L2 and L20 set work offsets, L10 to L13 tool offsets.",
            table_word,
        )


@carries_out(Action.SET_WORK_ZERO)
def set_work_zero(block: BlockContext, g: GWord) -> None:
    """Set G54 to G59 (P1 to P6; P0: the active one): L2 to the values, L20 so that the position reads them."""
    table_word, number_word = block.words.take("L"), block.words.take("P")
    if table_word is None or number_word is None:
        raise block.problem(f"G{g.code} without L and P", "Add L2 or L20, and P0 to P6.", g.word)
    table = whole_number(table_word, "a kind of data", block.problem)
    if table not in (2, 20):
        raise block.problem(
            f"G{g.code} L{table} is not supported", "L2 and L20 set work offsets.", table_word
        )
    number = whole_number(number_word, "a work offset", block.problem, 6)
    active = block.after.coordinates.work[0]
    name = f"G{53 + number}" if number else active
    values = motion.named_axes(block, g)
    if table == 20:
        here = block.after.here
        old = block.after.tables.work_offset(active) if active else (0.0,) * len(here)
        values = {axis: old[axis] + here[axis] - value for axis, value in values.items()}
    refuse_rest(block, g)
    block.after.tables.set_offset(name, values)
    block.after.take_changes()


@carries_out(Action.SET_TABLES)
def set_tables(block: BlockContext, g: GWord) -> None:
    """Set a work offset (L2, L20) or a tool (L1, L10, L11)."""
    table_word, number_word = block.words.take("L"), block.words.take("P")
    if table_word is None or number_word is None:
        raise block.problem(f"G{g.code} without L and P", "Add L1, L2, L10, L11 or L20, and P.", g.word)
    table = whole_number(table_word, "a kind of data", block.problem)
    if table in (1, 10, 11):
        number = whole_number(number_word, "a tool number", block.problem)
        set_tool(block, g, table, number)
    elif table in (2, 20):
        number = whole_number(number_word, "a work offset", block.problem, len(WORK_SYSTEMS))
        active = block.after.coordinates.work[0]
        name = WORK_SYSTEMS[number - 1] if number else active
        if name == active:
            refuse_compensation(block, g)
        _set_system(block, g, table, name)
    else:
        raise block.problem(
            f"G{g.code} L{table} is not there",
            "L2 and L20 set work offsets, L1, L10 and L11 tools.",
            table_word,
        )


def _set_system(block: BlockContext, g: GWord, table: int, name: str) -> None:
    state, tables = block.after, block.after.tables
    values = motion.axis_words(block)
    angle = block.words.value("R")
    if angle is not None:
        check_angle(angle, block.words.first("R"), block.problem)
    if table == 20:
        if angle is not None:
            raise block.problem(f"G{g.code} L20 with R", "Turn with L2.", block.words.first("R"))
        if other_frame(state):
            raise block.problem(
                f"G{g.code} L20 while positions are turned or scaled", "Cancel that first.", g.word
            )
        values = zero_that_reads(state, name, values)
    if angle is not None and NO_AXIS in (state.axis("X"), state.axis("Y")):
        raise block.problem("the machine has no plane XY to turn", "Remove R.", block.words.first("R"))
    refuse_rest(block, g)
    tables.set_offset(name, values)
    if angle is not None:
        tables.set_turn(name, angle)
    if name == state.coordinates.work[0]:
        state.coordinates = replace(state.coordinates, selected=None)
    state.take_changes()
    if name == state.coordinates.work[0]:
        state.turn_work()


def _set_work_offset(block: BlockContext, g: GWord, table: int, number: int) -> None:
    if table == 20 and number == 0:
        raise block.problem("there is no G54.1 P0", "Write P1 and up.", block.words.first("P"))
    if table == 2:
        name = COMMON_OFFSET if number == 0 else f"G{53 + number}"
    else:
        name = additional_offset(number)
    values = motion.named_axes(block, g)
    tables = block.after.tables
    if not block.after.modal.whole[ABSOLUTE]:
        old = tables.work_offset(name)
        values = {axis: old[axis] + value for axis, value in values.items()}
    refuse_rest(block, g)
    tables.set_offset(name, values)
    block.after.take_changes()


def _set_tool(block: BlockContext, g: GWord, field: str, number: int) -> None:
    value = block.words.length("R")
    if value is None:
        raise block.problem(f"G{g.code} without R", "Add R and the value.", g.word)
    if number == 0:
        raise block.problem("tool offset 0 is always zero", "Write P1 and up.", block.words.first("P"))
    axis = block.after.axis("Z")
    value *= 1.0 if axis == NO_AXIS else float(block.after.modal.scale[axis])
    if not block.after.modal.whole[ABSOLUTE]:
        value += getattr(block.after.tables.tool(number), field)
    if field == "radius_mm" and value < 0.0:
        raise block.problem("the radius is negative", "Write R from 0 up.", block.words.first("R"))
    refuse_rest(block, g)
    block.after.tables.set_tool(number, **{field: value})
