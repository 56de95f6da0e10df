"""G10 of turning controls: the work coordinate shift, work offsets, and offsets of tools with the place of their tip.

X, Y, Z set a value, U, V, W add to it; R sets the nose radius, C adds to it (FANUC B-63524EN, 14.5.2).
"""

from __future__ import annotations

from dataclasses import dataclass

from polycnc.nc.blocks._auxiliary import whole_number
from polycnc.nc.blocks._channel_state import ChannelState
from polycnc.nc.blocks._tables import ADDITIONAL_OFFSETS, COMMON_OFFSET, additional_offset
from polycnc.nc.blocks._words import BlockWords, Fail, GWord
from polycnc.nc.dialect._dialect import Dialect
from polycnc.nc.modal._modal import length_scale

GEOMETRY = 10_000
"""What P counts from where geometry offsets are set, not wear."""
MOST_OFFSETS = 999
_LAST_TIP = 9
_FIELDS = {False: ("wear_x_mm", "wear_z_mm", "wear_radius_mm"), True: ("x_mm", "z_mm", "radius_mm")}


@dataclass
class TurningData:
    """Carry out G10 of a turning control."""

    state: ChannelState
    dialect: Dialect
    fail: Fail

    def carry_out(self, g: GWord, words: BlockWords) -> None:
        """Change the table of tools or of work offsets.

        Raises:
            ProgramError: a word is missing, or has no meaning here.
        """
        table, number = words.take("L"), words.take("P")
        if number is None:
            raise self.fail(
                f"G{g.code} without P",
                "Add P: 0 shifts the work coordinates, 1 and up are wear offsets, 10001 and up geometry.",
                g.word,
            )
        if table is not None:
            kind = whole_number(table, "a kind of data", self.fail)
            if kind not in (2, 20):
                raise self.fail(
                    f"G{g.code} L{kind} is not supported yet", "L2 and L20 set work offsets.", table
                )
            largest = 6 if kind == 2 else ADDITIONAL_OFFSETS
            place = whole_number(number, "a work offset", self.fail, largest)
            if kind == 20 and place == 0:
                raise self.fail("there is no G54.1 P0", "Write P1 and up.", number)
            own = f"G{53 + place}" if kind == 2 else additional_offset(place)
            self._set_offset(g, COMMON_OFFSET if kind == 2 and place == 0 else own, words)
            return
        place = whole_number(number, "a number of an offset", self.fail, GEOMETRY + MOST_OFFSETS)
        if place == 0:
            self._set_offset(g, COMMON_OFFSET, words)
        elif MOST_OFFSETS < place <= GEOMETRY:
            raise self.fail(
                f"there is no offset P{place}",
                "Write P1 and up for wear, P10001 and up for geometry.",
                number,
            )
        else:
            self._set_tool(g, place % GEOMETRY, _FIELDS[place > GEOMETRY], words)

    def _set_offset(self, g: GWord, name: str, words: BlockWords) -> None:
        old = self.state.tables.work_offset(name)
        names = self.state.axis_names
        values = {
            index: value
            for index, letter in enumerate(names)
            if (value := self._value(words, letter, old[index])) is not None
        }
        if not values:
            raise self.fail(f"G{g.code} without an axis", "Name the axes.", g.word)
        self._refuse_rest(words)
        self.state.tables.set_offset(name, values)
        self.state.coordinates.take_changes()

    def _set_tool(self, g: GWord, number: int, fields: tuple[str, str, str], words: BlockWords) -> None:
        tool = self.state.tables.tool(number)
        changes: dict[str, float] = {}
        for letter, field in zip("XZ", fields[:2], strict=True):
            if (value := self._value(words, letter, getattr(tool, field))) is not None:
                changes[field] = value
        if (radius := self._radius(words, getattr(tool, fields[2]))) is not None:
            if radius < 0.0 and fields[2] == "radius_mm":
                raise self.fail("the radius is negative", "Check R or C.", words.first("R", "C"))
            changes[fields[2]] = radius
        if (tip := words.take("Q")) is not None:
            changes["tip"] = whole_number(tip, "the place of a tip", self.fail, _LAST_TIP)
        if not changes:
            raise self.fail(f"G{g.code} P{number} without a value", "Add X or U, Z or W, R, or Q.", g.word)
        self._refuse_rest(words)
        self.state.tables.set_tool(number, **changes)

    def _value(self, words: BlockWords, name: str, old: float) -> float | None:
        """Take what an axis is set to (mm or degree, of X a radius), by its position or a way; None if it is not."""
        names = self.state.axis_names
        if name not in names:
            return None
        scale = float(self.state.modal.scale[names.index(name)])
        value = words.length(name)
        way_letter = next((way for way, axis in self.dialect.incremental.items() if axis == name), "")
        way = words.length(way_letter) if way_letter else None
        if value is not None and way is not None:
            raise self.fail(
                f"{way_letter} and {name} both change {name}", "Write one of them.", words.first(way_letter)
            )
        if way is not None:
            return old + way * scale
        return None if value is None else value * scale

    def _radius(self, words: BlockWords, old: float) -> float | None:
        scale = length_scale(self.state.modal)
        value, more = words.length("R"), words.length("C")
        if value is not None and more is not None:
            raise self.fail("R and C both change the radius", "Write one of them.", words.first("C"))
        if more is not None:
            return old + more * scale
        return None if value is None else value * scale

    def _refuse_rest(self, words: BlockWords) -> None:
        """Refuse what is left in the block before anything is written that cannot be taken back."""
        for name, word in words.unused():
            if name not in self.dialect.ignored_addresses:
                raise self.fail(f"'{name}' cannot stand beside G10", "Take it out.", word)
