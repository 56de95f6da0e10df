"""Modal words: what holds until it is said otherwise, from units to the work offset."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from polycnc.kernel import EXACT_PATH as EXACT_PATH_TOLERANCE
from polycnc.machine import LONGEST_BLOCK_S, ToolConfig
from polycnc.nc.blocks._auxiliary import Auxiliary, whole_number
from polycnc.nc.blocks._channel_state import ChannelState, of_another_channel
from polycnc.nc.blocks._compensation import Side
from polycnc.nc.blocks._coordinates import MACHINE_ZERO, work_group
from polycnc.nc.blocks._messages import Messages
from polycnc.nc.blocks._moves import Wait
from polycnc.nc.blocks._tables import ADDITIONAL_OFFSETS, additional_offset
from polycnc.nc.blocks._tip import TIPS, TipShift
from polycnc.nc.blocks._words import BlockWords, Fail, code_text, dwell_seconds
from polycnc.nc.dialect._dialect import Dialect
from polycnc.nc.modal._actions import Action, Group
from polycnc.nc.modal._modal import (
    ABSOLUTE,
    ARC_ABSOLUTE,
    AXIS_P,
    AXIS_Q,
    AXIS_R,
    EXACT_PATH,
    EXACT_STOP,
    FEED,
    FEED_INVERSE_TIME,
    FEED_MODE,
    FEED_NUMBER,
    INCH,
    NO_AXIS,
    PLANE,
    PLANE_LETTERS,
    set_inch,
    set_plane,
)
from polycnc.nc.text._scan_plain import Word
from polycnc.units import MM_PER_INCH, SECONDS_PER_MINUTE

_INCREMENTS_PER_INCH_STEP = 0.1  # an increment in inch is a tenth of the number that it is in mm
_DEFAULT_WORK_OFFSET = "G54"
_TIME_LETTERS_WITH_INCREMENTS = "XU"


@dataclass
class Modes:
    """Carry out the modal words of a block."""

    state: ChannelState
    dialect: Dialect
    messages: Messages
    auxiliary: Auxiliary
    fail: Fail

    def set_units_and_plane(self, words: BlockWords) -> None:
        """Carry out the words that say how the numbers of the block are meant.

        Raises:
            ProgramError: the plane changes while a function depends on it.
        """
        modal = self.state.modal
        if g := words.g.get(Group.UNITS):
            set_inch(modal, bool(g.value))
        if self.dialect.increment:
            words.increment = self.dialect.increment * (
                _INCREMENTS_PER_INCH_STEP if modal.whole[INCH] else 1.0
            )
            self._tell_of_increments(words)
        g = words.g.get(Group.PLANE)
        if g is None or g.value == modal.whole[PLANE]:
            return
        if self.state.side:
            raise self.fail(
                "the plane changes while radius compensation is active", "Cancel it with G40 first.", g.word
            )
        if self.state.cycle.action and Group.CYCLE_CANCEL not in words.g:
            raise self.fail(
                "the plane changes while a drilling cycle is active", "Cancel it with G80 first.", g.word
            )
        set_plane(modal, g.value)

    def _tell_of_increments(self, words: BlockWords) -> None:
        """Say once that positions without a decimal point are small: who forgets the point loses the part."""
        found = (words.by_letter.get(letter) for letter in (*self.state.axis_names, *"IJKR"))
        if any(word is not None and word.value and not word.point for word in found):
            self.messages.add(
                f"lengths without a decimal point count {words.increment:g} in dialect '{self.dialect.name}'"
            )

    def set_feed(self, words: BlockWords) -> None:
        """Carry out the feed mode and F.

        Raises:
            ProgramError: a feed that is not above zero.
        """
        state, modal = self.state, self.state.modal
        if g := words.g.get(Group.FEED_MODE):
            mode = g.value
            if mode != modal.whole[FEED_MODE]:
                modal.real[FEED] = 0.0  # a number in another unit
            modal.whole[FEED_MODE] = mode
        state.feed_word = 0.0
        if self._dwell_letter(words) == "F":
            return
        word = words.take("F")
        if word is None:
            return
        value = word.value
        if value <= 0.0:
            raise self.fail(f"the feed {code_text(value)} is not above zero", "Write a positive F.", word)
        if (least := self.dialect.numbers.feed_least_input) and not word.point:
            value *= least * (_INCREMENTS_PER_INCH_STEP if modal.whole[INCH] else 1.0)
            self.messages.add(
                f"F without a decimal point counts {least:g} mm in dialect '{self.dialect.name}': "
                f"F{code_text(word.value)} is {code_text(value)}"
            )
        state.feed_word = value
        if modal.whole[FEED_MODE] != FEED_INVERSE_TIME:
            modal.real[FEED] = value * (MM_PER_INCH if modal.whole[INCH] else 1.0)
            modal.real[FEED_NUMBER] = value

    def dwell(self, words: BlockWords, line: int) -> list[Wait]:
        """Return the wait of a dwell, if there is one.

        Raises:
            ProgramError: a dwell without a time, or with one that cannot be meant.
        """
        g = words.g.get(Group.DWELL)
        if g is None:
            return []
        letter = self._dwell_letter(words)
        word = words.take(letter)
        if word is None:
            letters = " or ".join(", ".join(self.dialect.dwell).rsplit(", ", 1))
            raise self.fail(f"a dwell (G{g.code}) without a time", f"Add {letters} and the time.", g.word)
        seconds = self._dwell_s(word, self.dialect.dwell[letter])
        if not 0.0 <= seconds <= LONGEST_BLOCK_S:
            what = "negative" if seconds < 0.0 else "longer than anybody waits"
            raise self.fail(
                f"the dwell {word.letter}{code_text(word.value)} is {what}", "Write a time from 0 up.", word
            )
        return [Wait(seconds, line)]

    def _dwell_letter(self, words: BlockWords) -> str:
        """Return the address that gives the time of the block's dwell; empty if there is none."""
        if Group.DWELL not in words.g:
            return ""
        return next((letter for letter in self.dialect.dwell if letter in words.by_letter), "")

    def _dwell_s(self, word: Word, unit: str) -> float:
        if unit == "rev":
            spindle = self.state.spindle
            rpm = spindle.speed if spindle.direction else 0.0
            if rpm <= 0.0:
                raise self.fail("a dwell in revolutions with the spindle at rest", "Start it first.", word)
            return word.value * SECONDS_PER_MINUTE / rpm
        if self.dialect.increment and not word.point and word.letter in _TIME_LETTERS_WITH_INCREMENTS:
            return word.value * self.dialect.increment
        return dwell_seconds(word, unit)

    def set_length(self, words: BlockWords) -> None:
        """Carry out tool length compensation: G43, G44, G49 and H.

        Raises:
            ProgramError: there is no Z axis, or H is no tool.
        """
        g = words.g.get(Group.LENGTH_COMPENSATION)
        coordinates = self.state.coordinates
        sign = coordinates.length_sign if g is None else g.value
        if g is None and "H" not in words.by_letter:
            return
        if g is None and sign == 0:
            if not self.dialect.h_compensates:
                return  # an H that is left over is reported as such
            sign = 1
        if self.dialect.h_compensates and g is None and words.by_letter["H"].value == 0.0:
            sign = 0
        h_word = words.take("H")
        axis = int(self.state.modal.letter_axis[ord("Z") - ord("A")])
        if axis == NO_AXIS:
            if sign and of_another_channel("Z") in self.state.axis_names:
                raise self.fail(
                    "tool length compensation along axis Z, which belongs to another channel",
                    "Take it out, or execute the program in that channel.",
                    h_word if g is None else g.word,
                )
            if sign and g is not None:
                raise self.fail(
                    "tool length compensation on a machine without a Z axis", "Take it out.", g.word
                )
            return
        if sign == 0:
            coordinates.set_length(axis, 0)
            self.state.length_tool = 0
            return
        tool = self.state.tool if h_word is None else whole_number(h_word, "a tool offset number", self.fail)
        data = self.auxiliary.tool_data(tool)
        self.state.length_tool = tool
        coordinates.set_length(axis, sign, data.length_mm + data.wear_length_mm)

    def set_work_offset(self, words: BlockWords) -> None:
        """Carry out a work offset, or leaving one."""
        g = words.g.get(Group.WORK_OFFSET)
        if g is None:
            return
        additional = g.action in (Action.ADDITIONAL_OFFSET, Action.ADDITIONAL_OFFSET_110)
        group = 0 if additional else work_group(g.word.value)
        if g.action is Action.WORK_OFFSET_OFF:
            self.state.coordinates.select_work_offset(group, MACHINE_ZERO)
            return
        if g.action is Action.ADDITIONAL_OFFSET:
            name = additional_offset(self._additional_number(words))
        elif g.action is Action.ADDITIONAL_OFFSET_110:
            name = additional_offset(int(g.word.value) - 109)
        else:
            name = f"G{g.code}"
        offsets = self.state.machine.offsets
        if not self.state.tables.has_offset(name) and (offsets or name != _DEFAULT_WORK_OFFSET):
            self.messages.add(f"{name}: the machine has no such work offset; zero is used")
        self.state.coordinates.select_work_offset(group, name)

    def _additional_number(self, words: BlockWords) -> int:
        word = words.take("P")
        if word is None:
            return 1
        number = whole_number(word, "an additional work offset", self.fail, ADDITIONAL_OFFSETS)
        if number == 0:
            raise self.fail("there is no G54.1 P0", "Write P1 and up.", word)
        return number

    def set_others(self, words: BlockWords) -> None:
        """Carry out stopping, absolute or incremental, and retract level; note what has no effect."""
        state, whole = self.state, self.state.modal.whole
        g = words.g
        if stopping := g.get(Group.STOPPING):
            whole[EXACT_STOP] = stopping.action is Action.EXACT_STOP
            if stopping.action is Action.CONTINUOUS:
                self._set_path_tolerance(words)
            elif stopping.action is Action.EXACT_PATH:
                state.path_tolerance_mm = EXACT_PATH_TOLERANCE
            whole[EXACT_PATH] = stopping.action is Action.EXACT_PATH
        if distance := g.get(Group.DISTANCE):
            whole[ABSOLUTE] = distance.value
        if distance := g.get(Group.ARC_DISTANCE):
            whole[ARC_ABSOLUTE] = distance.value
        if retract := g.get(Group.RETRACT):
            state.cycle = replace(state.cycle, retract_to_initial=bool(retract.value))
        for ignored in words.ignored:
            if ignored.action is Action.NOTHING:
                words.take("P")
                words.take("Q")
                continue
            self.messages.add(f"G{ignored.code} has no effect here and is ignored")

    def _set_path_tolerance(self, words: BlockWords) -> None:
        """Take over how far corners may be rounded: P, else what the dialect and the machine allow.

        Where the dialect merges lines, Q is how far their points may be from the one that they become: P without it.
        """
        state, dialect = self.state, self.dialect
        tolerance = None if Group.DWELL in words.g else words.take("P")
        merging = words.take("Q")
        for word, what in ((tolerance, "path"), (merging if dialect.merges_lines else None, "merging")):
            if word is not None and word.value < 0.0:
                hint = f"Write {word.letter} from 0 up."
                raise self.fail(f"the {what} tolerance {word.letter} is negative", hint, word)
        inch = MM_PER_INCH if state.modal.whole[INCH] else 1.0
        if dialect.merges_lines:
            merged = merging or tolerance
            state.merge_mm = 0.0 if merged is None else merged.value * inch
        if tolerance is None or (tolerance.value == 0.0 and dialect.free_corners):
            state.path_tolerance_mm = dialect.path_tolerance_mm(state.machine.path)
        else:
            state.path_tolerance_mm = tolerance.value * inch

    def radius_compensation(self, words: BlockWords, line: int) -> Callable[[], None] | None:
        """Carry out G40, G41, G42 and D; return what changes the stage, to be called when all else is right.

        Raises:
            ProgramError: D is no tool, or the plane is not there.
        """
        state = self.state
        g = words.g.get(Group.RADIUS_COMPENSATION)
        d_word = words.take("D")
        if d_word is not None:
            state.compensation_tool = whole_number(d_word, "a tool offset number", self.fail)
        if g is not None:
            state.side = g.value
            if state.side == 0:
                return state.compensation.cancel
        elif state.side == 0 or d_word is None:
            return None
        whole = state.modal.whole
        plane = (int(whole[AXIS_P]), int(whole[AXIS_Q]), int(whole[AXIS_R]))
        if NO_AXIS in plane[:2]:
            letters = PLANE_LETTERS[int(whole[PLANE])][:2]
            raise self.fail(
                f"radius compensation in the plane {letters}, which this machine does not have",
                "Select a plane of the machine's axes with G17, G18 or G19.",
                None if g is None else g.word,
            )
        tool = state.tool if state.compensation_tool is None else state.compensation_tool
        data = self.auxiliary.tool_data(tool)
        radius = data.radius_mm + data.wear_radius_mm
        radius += state.tables.tool_radius(state.placement.compensations)
        tip = self._tip(data, radius)

        def start() -> None:
            state.compensation.start(Side(state.side), radius, plane, line)
            if tip != state.tip.vector:
                state.tip = TipShift(tip)

        return start

    def _tip(self, data: ToolConfig, radius: float) -> tuple[tuple[int, float], ...]:
        """Return the way from the middle of a tool's nose to its tip, by axis; none for a tool without a tip."""
        letters = self.state.modal.letter_axis
        ways = zip("XZ", TIPS[data.tip], strict=True)
        named = [(int(letters[ord(name) - ord("A")]), way * radius) for name, way in ways]
        return tuple(named) if any(way for _, way in named) else ()
