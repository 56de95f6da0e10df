"""Functions that change how programmed positions are meant: G51, G50, G51.1, G50.1, G68, G69, G16, G15, G52, G10."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from polycnc.nc.blocks._auxiliary import whole_number
from polycnc.nc.blocks._channel_state import ChannelState
from polycnc.nc.blocks._motion import MotionBuilder
from polycnc.nc.blocks._tables import ADDITIONAL_OFFSETS, COMMON_OFFSET, additional_offset
from polycnc.nc.blocks._turning_data import TurningData
from polycnc.nc.blocks._words import BlockWords, Fail, GWord, code_text
from polycnc.nc.dialect._dialect import Dialect
from polycnc.nc.modal._actions import Action
from polycnc.nc.modal._frame import Frame, Polar, Rotation
from polycnc.nc.modal._modal import ABSOLUTE, AXIS_P, AXIS_Q, NO_AXIS, PLANE, PLANE_LETTERS

LARGEST_FACTOR = 1000.0
LARGEST_OFFSET_NUMBER = 999
_FACTORS = "IJK"
_TOOL_FIELDS = {
    1: "length_mm",
    10: "length_mm",
    11: "wear_length_mm",
    12: "radius_mm",
    13: "wear_radius_mm",
}


@dataclass
class Frames:
    """Carry out these functions."""

    state: ChannelState
    dialect: Dialect
    motion: MotionBuilder
    fail: Fail

    def carry_out(self, g: GWord, words: BlockWords) -> None:
        """Change the frame, or the tables.

        Raises:
            ProgramError: a word is missing, or has no meaning here.
        """
        state = self.state
        if state.side or state.compensation.active:
            raise self.fail(
                f"G{g.code} while radius compensation is active", "Cancel it with G40 first.", g.word
            )
        frame = state.frame
        match g.action:
            case Action.SCALING:
                state.frame = replace(frame, scales=self._scales(g, words))
            case Action.SCALING_OFF:
                state.frame = replace(frame, scales={})
            case Action.MIRROR:
                state.frame = replace(frame, mirrors={**frame.mirrors, **self._axes(g)})
            case Action.MIRROR_OFF:
                named = self.motion.axis_words()
                kept = {axis: at for axis, at in frame.mirrors.items() if named and axis not in named}
                state.frame = replace(frame, mirrors=kept)
            case Action.LOCAL_COORDINATES:
                self._local(g)
            case Action.SET_WORK_ZERO:
                self._set_work_zero(g, words)
            case _:
                self._set_data(g, words)

    def set_modal(self, g: GWord, words: BlockWords) -> None:
        """Carry out rotation and polar coordinates, which go with other functions in a block."""
        frame = self.state.frame
        match g.action:
            case Action.ROTATION:
                self.state.frame = replace(frame, rotation=self._rotation(g, words))
            case Action.ROTATION_OFF:
                self.state.frame = replace(frame, rotation=None)
            case Action.POLAR:
                p, q = self._plane(g)
                self.state.frame = replace(frame, polar=self._polar_here(frame, p, q))
            case _:
                self.state.frame = replace(frame, polar=None)

    def _plane(self, g: GWord) -> tuple[int, int]:
        whole = self.state.modal.whole
        p, q = int(whole[AXIS_P]), int(whole[AXIS_Q])
        if NO_AXIS in (p, q):
            letters = PLANE_LETTERS[int(whole[PLANE])][:2]
            raise self.fail(
                f"G{g.code} in the plane {letters}, which this machine does not have",
                "Select a plane of the machine's axes with G17, G18 or G19.",
                g.word,
            )
        return p, q

    def _here(self) -> list[float]:
        """Return the programmed position (mm or degree)."""
        modal = self.state.modal
        return self.state.frame.back((modal.position - modal.offset).tolist())

    def _axes(self, g: GWord) -> dict[int, float]:
        values = self.motion.axis_words()
        if not values:
            raise self.fail(f"G{g.code} without an axis", "Name the axes.", g.word)
        return values

    # ------------------------------------------------------------------ rotation, polar coordinates

    def _rotation(self, g: GWord, words: BlockWords) -> Rotation:
        p, q = self._plane(g)
        angle = words.length("R")
        if angle is None:
            raise self.fail(f"G{g.code} without an angle", "Add R and the angle in degrees.", g.word)
        if not math.isfinite(angle) or abs(angle) > 360_000.0:
            raise self.fail(
                f"the angle R{code_text(angle)} is too large", "Write up to a turn.", words.first("R")
            )
        values = self.motion.axis_words()
        if wrong := [axis for axis in values if axis not in (p, q)]:
            name = self.state.axis_names[wrong[0]]
            raise self.fail(
                f"axis {name} is not in the plane that G{g.code} turns",
                "Select another plane before, or take the word out.",
                words.first(name),
            )
        modal = self.state.modal
        center = (modal.position - modal.offset).tolist()
        if not modal.whole[ABSOLUTE]:
            values = {}  # the centre is where the tool stands
        return Rotation(p, q, values.get(p, center[p]), values.get(q, center[q]), angle)

    def _polar_here(self, frame: Frame, p: int, q: int) -> Polar:
        here = self._here()
        return Polar((0.0, 0.0), math.hypot(here[p], here[q]), math.degrees(math.atan2(here[q], here[p])))

    # ------------------------------------------------------------------ scaling

    def _scales(self, g: GWord, words: BlockWords) -> dict[int, tuple[float, float]]:
        here = (self.state.modal.position - self.state.modal.offset).tolist()
        centers = self.motion.axis_words()
        if not self.state.modal.whole[ABSOLUTE]:
            centers = {axis: here[axis] + value for axis, value in centers.items()}
        linear = [index for index, axis in enumerate(self.state.machine.axes) if axis.kind == "linear"]
        letters = [letter for letter in _FACTORS if letter in words.by_letter]
        factors: dict[int, float] = {}
        if "P" in words.by_letter:
            if letters:
                raise self.fail(
                    f"G{g.code} with P and {letters[0]}", "Write one factor P, or I J K.", words.first("P")
                )
            common = self._factor("P", words)
            factors = dict.fromkeys(centers or linear, common)
        elif letters:
            for letter, name in zip(_FACTORS, "XYZ", strict=True):
                axis = int(self.state.modal.letter_axis[ord(name) - ord("A")])
                if letter in letters:
                    factor = self._factor(letter, words)
                    if axis != NO_AXIS:
                        factors[axis] = factor
        else:
            raise self.fail(f"G{g.code} without a factor", "Add P, or I J K.", g.word)
        return {axis: (centers.get(axis, here[axis]), factor) for axis, factor in factors.items()}

    def _factor(self, letter: str, words: BlockWords) -> float:
        word = words.take(letter)
        assert word is not None
        factor = word.value if word.point else word.value * self.dialect.scaling_unit
        if factor == 0.0 or abs(factor) > LARGEST_FACTOR or (letter == "P" and factor < 0.0):
            raise self.fail(
                f"the factor {letter}{code_text(word.value)} is no scale",
                f"Without a point it counts {self.dialect.scaling_unit:g}; write it like {letter}1.5.",
                word,
            )
        return factor

    # ------------------------------------------------------------------ coordinate systems and offsets

    def _local(self, g: GWord) -> None:
        values = self._axes(g)
        incremental = not self.state.modal.whole[ABSOLUTE]
        self.state.coordinates.set_local(values, add=incremental)

    def _set_data(self, g: GWord, words: BlockWords) -> None:
        if self.dialect.tool_word == "turret":
            TurningData(self.state, self.dialect, self.fail).carry_out(g, words)
            return
        table_word = words.take("L")
        if table_word is None:
            raise self.fail(f"G{g.code} without L", "Add L2, L20, or L10 to L13.", g.word)
        table = whole_number(table_word, "a kind of data", self.fail)
        number_word = words.take("P")
        if number_word is None and table != 2:
            raise self.fail(f"G{g.code} L{table} without P", "Add P and the number.", g.word)
        largest = {2: 6, 20: ADDITIONAL_OFFSETS}.get(table, LARGEST_OFFSET_NUMBER)
        number = (
            0
            if number_word is None
            else whole_number(number_word, "a number of these data", self.fail, largest)
        )
        if table in (2, 20):
            self._set_work_offset(g, table, number, words)
        elif table in _TOOL_FIELDS:
            self._set_tool(g, _TOOL_FIELDS[table], number, words)
        else:
            raise self.fail(
                f"G{g.code} L{table} is not supported yet",
                "L2 and L20 set work offsets, L10 to L13 tool offsets.",
                table_word,
            )

    def _set_work_zero(self, g: GWord, words: BlockWords) -> None:
        """Set G54 to G59 (P1 to P6; P0: the active one): L2 to the values, L20 so that the position reads them."""
        table_word, number_word = words.take("L"), words.take("P")
        if table_word is None or number_word is None:
            raise self.fail(f"G{g.code} without L and P", "Add L2 or L20, and P0 to P6.", g.word)
        table = whole_number(table_word, "a kind of data", self.fail)
        if table not in (2, 20):
            raise self.fail(
                f"G{g.code} L{table} is not supported", "L2 and L20 set work offsets.", table_word
            )
        number = whole_number(number_word, "a work offset", self.fail, 6)
        active = self.state.coordinates.work[0]
        name = f"G{53 + number}" if number else active
        values = self._axes(g)
        if table == 20:
            modal, tables = self.state.modal, self.state.tables
            here = (modal.position - modal.offset).tolist()
            old = tables.work_offset(active) if active else (0.0,) * len(here)
            values = {axis: old[axis] + here[axis] - value for axis, value in values.items()}
        self._refuse_rest(words)
        self.state.tables.set_offset(name, values)
        self.state.coordinates.take_changes()

    def _set_work_offset(self, g: GWord, table: int, number: int, words: BlockWords) -> None:
        if table == 20 and number == 0:
            raise self.fail("there is no G54.1 P0", "Write P1 and up.", words.first("P"))
        if table == 2:
            name = COMMON_OFFSET if number == 0 else f"G{53 + number}"
        else:
            name = additional_offset(number)
        values = self._axes(g)
        tables = self.state.tables
        if not self.state.modal.whole[ABSOLUTE]:
            old = tables.work_offset(name)
            values = {axis: old[axis] + value for axis, value in values.items()}
        self._refuse_rest(words)
        tables.set_offset(name, values)
        self.state.coordinates.take_changes()

    def _set_tool(self, g: GWord, field: str, number: int, words: BlockWords) -> None:
        value = words.length("R")
        if value is None:
            raise self.fail(f"G{g.code} without R", "Add R and the value.", g.word)
        if number == 0:
            raise self.fail("tool offset 0 is always zero", "Write P1 and up.", words.first("P"))
        axis = int(self.state.modal.letter_axis[ord("Z") - ord("A")])
        value *= 1.0 if axis == NO_AXIS else float(self.state.modal.scale[axis])
        if not self.state.modal.whole[ABSOLUTE]:
            value += getattr(self.state.tables.tool(number), field)
        if field == "radius_mm" and value < 0.0:
            raise self.fail("the radius is negative", "Write R from 0 up.", words.first("R"))
        self._refuse_rest(words)
        self.state.tables.set_tool(number, **{field: value})

    def _refuse_rest(self, words: BlockWords) -> None:
        """Refuse what is left in the block before anything is written that cannot be taken back."""
        for name, word in words.unused():
            if name not in self.dialect.ignored_addresses:
                raise self.fail(f"'{name}' cannot stand beside G10", "Take it out.", word)
