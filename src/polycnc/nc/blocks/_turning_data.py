"""G10 of turning controls: the work coordinate shift, work offsets, and offsets of tools with the place of their tip.

X, Y, Z set a value, U, V, W add to it; R sets the nose radius, C adds to it (FANUC B-63524EN, 14.5.2). Where G91 makes
positions ways (G code system B), X, Y, Z and R add.
"""

from __future__ import annotations

from polycnc.nc.blocks._block import BlockContext
from polycnc.nc.blocks._tables import ADDITIONAL_OFFSETS, COMMON_OFFSET, additional_offset
from polycnc.nc.blocks._word_checks import refuse_rest
from polycnc.nc.blocks._words import GWord, whole_number
from polycnc.nc.modal._modal import ABSOLUTE, length_scale

GEOMETRY = 10_000
"""What P counts from where geometry offsets are set, not wear."""
MOST_OFFSETS = 999
_LAST_TIP = 9
_FIELDS = {False: ("wear_x_mm", "wear_z_mm", "wear_radius_mm"), True: ("x_mm", "z_mm", "radius_mm")}


def set_turning_data(block: BlockContext, g: GWord) -> None:
    """Change the table of tools or of work offsets.

    Raises:
        ProgramError: a word is missing, or has no meaning here.
    """
    table, number = block.words.take("L"), block.words.take("P")
    if number is None:
        raise block.problem(
            f"G{g.code} without P",
            "Add P: 0 shifts the work coordinates, 1 and up are wear offsets, 10001 and up geometry.",
            g.word,
        )
    if table is not None:
        kind = whole_number(table, "a kind of data", block.problem)
        if kind not in (2, 20):
            raise block.problem(
                f"G{g.code} L{kind} is not supported yet", "L2 and L20 set work offsets.", table
            )
        largest = 6 if kind == 2 else ADDITIONAL_OFFSETS
        place = whole_number(number, "a work offset", block.problem, largest)
        if kind == 20 and place == 0:
            raise block.problem("there is no G54.1 P0", "Write P1 and up.", number)
        own = f"G{53 + place}" if kind == 2 else additional_offset(place)
        _set_offset(block, g, COMMON_OFFSET if kind == 2 and place == 0 else own)
        return
    place = whole_number(number, "a number of an offset", block.problem, GEOMETRY + MOST_OFFSETS)
    if place == 0:
        _set_offset(block, g, COMMON_OFFSET)
    elif MOST_OFFSETS < place <= GEOMETRY:
        raise block.problem(
            f"there is no offset P{place}", "Write P1 and up for wear, P10001 and up for geometry.", number
        )
    else:
        _set_tool(block, g, place % GEOMETRY, _FIELDS[place > GEOMETRY])


def _set_offset(block: BlockContext, g: GWord, name: str) -> None:
    old = block.after.tables.work_offset(name)
    names = block.after.axis_names
    values = {
        index: value
        for index, letter in enumerate(names)
        if (value := _value(block, letter, old[index])) is not None
    }
    if not values:
        raise block.problem(f"G{g.code} without an axis", "Name the axes.", g.word)
    refuse_rest(block, g)
    block.after.tables.set_offset(name, values)
    block.after.take_changes()


def _set_tool(block: BlockContext, g: GWord, number: int, fields: tuple[str, str, str]) -> None:
    tool = block.after.tables.tool(number)
    changes: dict[str, float] = {}
    for letter, field in zip("XZ", fields[:2], strict=True):
        if (value := _value(block, letter, getattr(tool, field))) is not None:
            changes[field] = value
    if (radius := _radius(block, getattr(tool, fields[2]))) is not None:
        if radius < 0.0 and fields[2] == "radius_mm":
            raise block.problem("the radius is negative", "Check R or C.", block.words.first("R", "C"))
        changes[fields[2]] = radius
    if (tip := block.words.take("Q")) is not None:
        changes["tip"] = whole_number(tip, "the place of a tip", block.problem, _LAST_TIP)
    refuse_rest(block, g)
    if not changes:
        raise block.problem(f"G{g.code} P{number} without a value", "Add X or U, Z or W, R, or Q.", g.word)
    block.after.tables.set_tool(number, **changes)


def _value(block: BlockContext, name: str, old: float) -> float | None:
    """Take what an axis is set to (mm or degree, of X a radius), by its position or a way; None if it is not."""
    names = block.after.axis_names
    if name not in names:
        return None
    scale = float(block.after.modal.scale[names.index(name)])
    value = block.words.length(name)
    way_letter = next((way for way, axis in block.dialect.incremental.items() if axis == name), "")
    way = block.words.length(way_letter) if way_letter else None
    if value is not None and way is not None:
        raise block.problem(
            f"{way_letter} and {name} both change {name}", "Write one of them.", block.words.first(way_letter)
        )
    if way is not None:
        return old + way * scale
    return None if value is None else value * scale + _base(block, old)


def _radius(block: BlockContext, old: float) -> float | None:
    scale = length_scale(block.after.modal)
    value, more = block.words.length("R"), block.words.length("C")
    if value is not None and more is not None:
        raise block.problem("R and C both change the radius", "Write one of them.", block.words.first("C"))
    if more is not None:
        return old + more * scale
    return None if value is None else value * scale + _base(block, old)


def _base(block: BlockContext, old: float) -> float:
    """Return what a value is added to: the old one after G91."""
    return 0.0 if block.after.modal.whole[ABSOLUTE] else old
