"""The ordinary interpreter: one block at a time, everything a block can say, and every error.

A block's words take effect in one fixed order, whatever order they stand in: feed mode and feed, spindle, tool,
auxiliary functions, dwell, plane, units, radius and length compensation, work offset, stopping, absolute or
incremental, retract level, then the non-modal functions or the motion, at last program stop and end.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum

from polycnc.errors import ProgramError
from polycnc.nc._actions import Action, Group, MAction
from polycnc.nc._auxiliary import Auxiliary
from polycnc.nc._channel_state import ChannelState
from polycnc.nc._compensation import CompensationError, RadiusCompensation, Side
from polycnc.nc._coordinates import MACHINE_ZERO
from polycnc.nc._cycle_blocks import CycleBlocks
from polycnc.nc._dialect import Dialect
from polycnc.nc._messages import Messages
from polycnc.nc._modal import (
    ABSOLUTE,
    ARC_ABSOLUTE,
    AXIS_P,
    AXIS_Q,
    AXIS_R,
    EXACT_STOP,
    FEED,
    FEED_INVERSE_TIME,
    FEED_MODE,
    FEED_PER_MINUTE,
    FEED_PER_REVOLUTION,
    INCH,
    MOTION,
    MOTION_ARC_CCW,
    MOTION_ARC_CW,
    MOTION_LINEAR,
    MOTION_NONE,
    MOTION_RAPID,
    NO_AXIS,
    ORDINARY,
    PLANE_XY,
    PLANE_YZ,
    PLANE_ZX,
    set_inch,
    set_plane,
)
from polycnc.nc._motion import MotionBuilder
from polycnc.nc._moves import Feed, Line, QueueItem, Wait
from polycnc.nc._program import ProgramText
from polycnc.nc._scan import MESSAGE, STATEMENT
from polycnc.nc._scan_plain import Block, Word
from polycnc.nc._words import BlockWords, GWord, dwell_seconds, sort_words
from polycnc.units import MM_PER_INCH

_PLANES = {Action.PLANE_XY: PLANE_XY, Action.PLANE_ZX: PLANE_ZX, Action.PLANE_YZ: PLANE_YZ}
_MOTIONS = {
    Action.RAPID: MOTION_RAPID,
    Action.LINEAR: MOTION_LINEAR,
    Action.ARC_CW: MOTION_ARC_CW,
    Action.ARC_CCW: MOTION_ARC_CCW,
}
_FEED_MODES = {
    Action.FEED_PER_MINUTE: FEED_PER_MINUTE,
    Action.FEED_PER_REVOLUTION: FEED_PER_REVOLUTION,
    Action.FEED_INVERSE_TIME: FEED_INVERSE_TIME,
}
_SIDES = {Action.COMP_LEFT: Side.LEFT, Action.COMP_RIGHT: Side.RIGHT}
_LENGTH_SIGNS = {Action.LENGTH_PLUS: 1.0, Action.LENGTH_MINUS: -1.0}


class Control(Enum):
    """What comes after a block."""

    NEXT = "next"
    CALL = "call"
    RETURN = "return"
    STOP = "stop"
    END = "end"


@dataclass(frozen=True, slots=True)
class Outcome:
    """Say how the program goes on; a call names the sub-program and how often it runs."""

    control: Control = Control.NEXT
    program: int = 0
    repeats: int = 1


class Interpreter:
    """Execute blocks of one channel: change the modal state and give queue items to `put`."""

    def __init__(
        self,
        dialect: Dialect,
        state: ChannelState,
        messages: Messages,
        put: Callable[[QueueItem], None],
        set_tolerance: Callable[[float], None] = lambda tolerance_mm: None,
    ) -> None:
        self.dialect = dialect
        self.state = state
        self.messages = messages
        self.compensation = RadiusCompensation()
        self._put = put
        self._set_tolerance = set_tolerance
        self._text = ProgramText.from_text("")
        self._block: Block | None = None
        self._change_compensation: Callable[[], None] | None = None
        self._motion = MotionBuilder(state, self.fail)
        self._auxiliary = Auxiliary(state, messages, self.fail)
        self._cycles = CycleBlocks(state, dialect, self._motion, self.fail)

    def execute(self, text: ProgramText, block: Block) -> Outcome:
        """Execute one block of `text`.

        Raises:
            ProgramError: the block cannot be executed; nothing has been changed or queued for it.
        """
        self._text, self._block = text, block
        self.messages.line = block.line
        if block.flags & STATEMENT:
            raise self.fail(
                "this statement needs a language that the dialect does not have",
                "Expressions, variables and statements are not part of plain DIN 66025 blocks.",
                None,
            )
        if block.flags & MESSAGE and block.message:
            self.messages.add(f"MSG: {block.message}")
        with self.state.unchanged_on_error():
            try:
                return self._execute(sort_words(block, self.dialect, self.fail), block.line)
            except CompensationError as error:
                raise self._placed(error) from None

    def finish(self) -> None:
        """Give out what radius compensation still holds back, at the end of the program."""
        for item in self.compensation.flush():
            self._put(item)
        self.compensation.reset()

    def fail(self, what: str, hint: str, word: Word | None) -> ProgramError:
        """Return an error about the present block, at `word` if there is one."""
        place = self._place(word)
        return ProgramError(what, position=self._text.position(place), hint=hint)

    def _place(self, word: Word | None) -> int:
        if word is not None:
            return word.place
        assert self._block is not None
        return self._block.words[0].place if self._block.words else self._block.offset

    def _placed(self, error: CompensationError) -> ProgramError:
        """Add the place to an error of radius compensation, which knows its line only."""
        return ProgramError(
            error.what, position=self._text.line_position(error.line), hint=error.hint, code=error.code
        )

    def _execute(self, words: BlockWords, line: int) -> Outcome:
        for letter in "NO:":  # block and program numbers
            words.take(letter)
        self._change_compensation = None
        items: list[QueueItem] = []
        self._set_feed(words)
        items += self._auxiliary.before_motion(words, line)
        items += self._dwell(words, line)
        self._set_plane_and_units(words)
        self._set_compensation(words, line)
        self._set_length(words)
        self._set_work_offset(words)
        self._set_stopping(words)
        self._set_distance(words)
        if g := words.g.get(Group.NON_MODAL):
            moves = self._non_modal(words, g, line)
        else:
            moves = self._move(words, line)
        outcome = self._outcome(words)
        self._refuse_unused(words)
        if self._change_compensation is not None:  # only now: a refused block must leave it alone
            self._change_compensation()
        after = self._auxiliary.after_motion(words, line)
        compensated = [out for item in (*items, *moves, *after) for out in self.compensation.push(item)]
        self._set_tolerance(self.state.path_tolerance_mm)
        for item in compensated:
            self._put(item)
        self._note_position(moves)
        return outcome

    # ------------------------------------------------------------------ modal words

    def _set_feed(self, words: BlockWords) -> None:
        whole = self.state.modal.whole
        if g := words.g.get(Group.FEED_MODE):
            mode = _FEED_MODES[g.action]
            if mode != whole[FEED_MODE]:
                self.state.modal.real[FEED] = 0.0  # a number in another unit
            whole[FEED_MODE] = mode
        if g := words.g.get(Group.SPINDLE_MODE):
            self.state.spindle.surface_speed = g.action is Action.CONSTANT_SURFACE_SPEED
        self.state.feed_words = 0.0
        word = words.by_letter.get("F")
        if word is None or (Group.DWELL in words.g and "F" in self.dialect.dwell):
            return
        words.take("F")
        if word.value <= 0.0:
            raise self.fail(f"the feed {word.value:g} is not above zero", "Write a positive F.", word)
        # A unit word in the same block applies to it.
        inch = bool(whole[INCH])
        if g := words.g.get(Group.UNITS):
            inch = g.action is Action.INCH
        self.state.feed_words = word.value
        if whole[FEED_MODE] != FEED_INVERSE_TIME:
            self.state.modal.real[FEED] = word.value * (MM_PER_INCH if inch else 1.0)

    def _dwell(self, words: BlockWords, line: int) -> list[Wait]:
        if Group.DWELL not in words.g:
            return []
        for letter, unit in self.dialect.dwell.items():
            word = words.take(letter)
            if word is None:
                continue
            if word.value < 0.0:
                raise self.fail(f"the dwell {word.value:g} is negative", "Write a time from 0 up.", word)
            return [Wait(self._dwell_s(word, unit), line)]
        raise self.fail(
            "a dwell (G4) without a time",
            f"Add {' or '.join(self.dialect.dwell)}.",
            words.g[Group.DWELL].word,
        )

    def _dwell_s(self, word: Word, unit: str) -> float:
        if unit == "rev":
            rpm = self.state.spindle.speed if self.state.spindle.direction else 0.0
            if rpm <= 0.0:
                raise self.fail(
                    "a dwell in revolutions with the spindle at rest", "Start the spindle first.", word
                )
            return word.value * 60.0 / rpm
        return dwell_seconds(word, unit)

    def _set_plane_and_units(self, words: BlockWords) -> None:
        if g := words.g.get(Group.PLANE):
            set_plane(self.state.modal, _PLANES[g.action])
        if g := words.g.get(Group.UNITS):
            set_inch(self.state.modal, g.action is Action.INCH)

    def _set_compensation(self, words: BlockWords, line: int) -> None:
        state = self.state
        d_word = words.take("D")
        if d_word is not None:
            state.compensation_tool = self._tool_number(d_word)
        g = words.g.get(Group.RADIUS_COMPENSATION)
        if g is None:
            return
        if g.action is Action.COMP_OFF:
            state.compensation = 0
            self._change_compensation = self.compensation.cancel
        else:
            whole = state.modal.whole
            plane = (int(whole[AXIS_P]), int(whole[AXIS_Q]), int(whole[AXIS_R]))
            if NO_AXIS in plane[:2]:
                raise self.fail(
                    "radius compensation in a plane that this machine lacks",
                    "Select a plane with G17, G18 or G19.",
                    g.word,
                )
            tool = state.compensation_tool if d_word is not None or state.compensation_tool else state.tool
            state.compensation = int(_SIDES[g.action])
            start, side, radius = self.compensation.start, _SIDES[g.action], self._tool_radius(tool, g)
            self._change_compensation = lambda: start(side, radius, plane, line)

    def _tool_number(self, word: Word) -> int:
        if word.value < 0 or word.value != int(word.value):
            raise self.fail(
                f"{word.letter}{word.value:g} is not a tool offset number",
                "Write a whole number from 0 up.",
                word,
            )
        return int(word.value)

    def _tool_radius(self, tool: int, g: GWord) -> float:
        data = self.state.machine.tools.get(tool)
        if data is None:
            if tool:
                self.messages.add(f"G{g.code} D{tool}: the tool table has no such entry; radius 0 mm is used")
            else:
                self.messages.add(f"G{g.code} without tool data; radius 0 mm is used")
            return 0.0
        return data.radius_mm + data.wear_radius_mm

    def _set_length(self, words: BlockWords) -> None:
        g = words.g.get(Group.LENGTH_COMPENSATION)
        h_word = words.take("H")
        if g is None:
            return
        axis = int(self.state.modal.letter_axis[ord("Z") - ord("A")])
        if axis == NO_AXIS:
            raise self.fail("tool length compensation on a machine without a Z axis", "Take it out.", g.word)
        if g.action is Action.LENGTH_OFF:
            self.state.coordinates.set_length(axis, 0.0)
            return
        tool = self.state.tool if h_word is None else self._tool_number(h_word)
        data = self.state.machine.tools.get(tool)
        length = 0.0
        if data is not None:
            length = data.length_mm + data.wear_length_mm
        elif tool:
            self.messages.add(f"G{g.code} H{tool}: the tool table has no such entry; length 0 mm is used")
        self.state.coordinates.set_length(axis, _LENGTH_SIGNS[g.action] * length)

    def _set_work_offset(self, words: BlockWords) -> None:
        g = words.g.get(Group.WORK_OFFSET)
        if g is None:
            return
        name = MACHINE_ZERO if g.action is Action.WORK_OFFSET_OFF else f"G{g.code}"
        if name and name not in self.state.machine.offsets:
            self.messages.add(f"{name}: the machine has no such work offset; zero is used")
        self.state.coordinates.select_work_offset(name)

    def _set_stopping(self, words: BlockWords) -> None:
        g = words.g.get(Group.STOPPING)
        self._motion.exact_stop_block = Group.EXACT_STOP_BLOCK in words.g
        if g is None:
            return
        self.state.modal.whole[EXACT_STOP] = g.action is Action.EXACT_STOP
        if g.action is Action.CONTINUOUS:
            self._set_path_tolerance(words)

    def _set_path_tolerance(self, words: BlockWords) -> None:
        """Take over how far corners may be rounded: P, else what the machine allows."""
        tolerance = words.take("P") if Group.DWELL not in words.g else None
        words.take("Q")
        if tolerance is None:
            self.state.path_tolerance_mm = self.state.machine.path.path_tolerance_mm
            return
        if tolerance.value < 0.0:
            raise self.fail("the path tolerance P is negative", "Write P from 0 up.", tolerance)
        inch = MM_PER_INCH if self.state.modal.whole[INCH] else 1.0
        self.state.path_tolerance_mm = tolerance.value * inch

    def _set_distance(self, words: BlockWords) -> None:
        if g := words.g.get(Group.DISTANCE):
            self.state.modal.whole[ABSOLUTE] = g.action is Action.ABSOLUTE
        if g := words.g.get(Group.ARC_DISTANCE):
            self.state.modal.whole[ARC_ABSOLUTE] = g.action is Action.ARC_CENTER_ABSOLUTE
        if g := words.g.get(Group.RETRACT):
            self.state.cycle.retract_to_initial = g.action is Action.RETRACT_INITIAL
        if g := words.g.get(Group.IGNORED):
            self.messages.add(f"G{g.code} has no effect here and is ignored")

    # ------------------------------------------------------------------ motion

    def _non_modal(self, words: BlockWords, g: GWord, line: int) -> list[QueueItem]:
        """Carry out a function that uses the axis words of the block for itself; a motion word is only modal."""
        self._motion_of(words)
        match g.action:
            case Action.SET_POSITION:
                self._set_position(words, g)
            case Action.CLEAR_SET_POSITION:
                self.state.coordinates.clear_shift()
            case Action.REFERENCE_RETURN:
                return self._reference_return(words, line)
            case Action.MACHINE_COORDINATES:
                return self._machine_move(words, g, line)
            case _:
                raise self.fail(f"G{g.code} is not carried out here", "Take it out.", g.word)
        return []

    def _set_position(self, words: BlockWords, g: GWord) -> None:
        if self.compensation.active:
            raise self.fail(
                f"G{g.code} while radius compensation is active", "Cancel it with G40 first.", g.word
            )
        values = self._motion.axis_words(words)
        if not values:
            raise self.fail(
                f"G{g.code} without an axis", "Name the axes and the positions they shall read.", g.word
            )
        for axis, value in values.items():
            self.state.coordinates.set_position(axis, value)

    def _reference_return(self, words: BlockWords, line: int) -> list[QueueItem]:
        """Go to the intermediate point that the axis words name, then with these axes (all, if none) to home."""
        values = self._motion.axis_words(words)
        moves: list[QueueItem] = []
        if values:
            moves.append(self._motion.line(self._motion.target(values), True, line))
        middle = moves[-1].end if moves and isinstance(moves[-1], Line) else self._motion.start
        home = tuple(
            axis.home if index in values or not values else middle[index]
            for index, axis in enumerate(self.state.machine.axes)
        )
        moves.append(Line(middle, home, Feed(), True, True, line))
        return moves

    def _machine_move(self, words: BlockWords, g: GWord, line: int) -> list[QueueItem]:
        motion = self._motion_of(words)
        if motion not in (MOTION_RAPID, MOTION_LINEAR):
            raise self.fail(f"G{g.code} goes with G0 or G1 only", "Write G0 or G1 in the block.", g.word)
        if self.compensation.active:
            raise self.fail(
                f"G{g.code} while radius compensation is active", "Cancel it with G40 first.", g.word
            )
        end = self._motion.target(self._motion.axis_words(words), machine_coordinates=True)
        return [self._motion.line(end, motion == MOTION_RAPID, line)]

    def _motion_of(self, words: BlockWords) -> int:
        """Take over the motion words of the block and return the motion in force."""
        whole = self.state.modal.whole
        for group in (Group.CYCLE_CANCEL, Group.MOTION):
            g = words.g.get(group)
            if g is None:
                continue
            if g.action in _MOTIONS:
                whole[MOTION] = _MOTIONS[g.action]
            else:
                whole[MOTION] = MOTION_NONE
            self._cycles.select(g)
        return int(whole[MOTION])

    def _move(self, words: BlockWords, line: int) -> list[QueueItem]:
        motion = self._motion_of(words)
        if self._cycles.active:
            if self.compensation.active:
                raise self.fail(
                    "a drilling cycle while radius compensation is active", "Cancel it with G40 first.", None
                )
            return self._cycles.expand(words, line)
        has_center = any(letter in words.by_letter for letter in "IJKR") and motion >= MOTION_ARC_CW
        values = self._motion.axis_words(words)
        if not values and not has_center:
            return []
        if motion == MOTION_NONE:
            raise self.fail(
                "axis words without a motion",
                "Write G0, G1, G2, G3 or a cycle in this or an earlier block.",
                None,
            )
        return [self._motion.move(words, self._motion.target(values), motion, line)]

    def _note_position(self, moves: list[QueueItem]) -> None:
        """Remember the programmed position, which is not compensated."""
        for item in reversed(moves):
            if not isinstance(item, Wait):
                self.state.modal.position[:] = item.end
                break
        self.state.modal.whole[ORDINARY] = self.compensation.active or self._cycles.active

    # ------------------------------------------------------------------ end of the block

    def _outcome(self, words: BlockWords) -> Outcome:
        for m in words.m:
            match m.action:
                case MAction.PROGRAM_END:
                    return Outcome(Control.END)
                case MAction.PROGRAM_STOP | MAction.OPTIONAL_STOP:
                    return Outcome(Control.STOP)
                case MAction.SUB_CALL:
                    return self._call(words, m.word)
                case MAction.SUB_RETURN:
                    return Outcome(Control.RETURN)
                case _:
                    pass
        return Outcome()

    def _call(self, words: BlockWords, at: Word) -> Outcome:
        program = words.value("P")
        if program is None or program != int(program) or program < 0:
            raise self.fail(
                f"M{at.value:g} without a program number", "Write P and the number of the sub-program.", at
            )
        repeats = words.value("L")
        if repeats is not None and (repeats != int(repeats) or repeats < 0):
            raise self.fail(
                "the number of repetitions L is not a whole number", "Write L1, L2, ...", words.take("L")
            )
        return Outcome(Control.CALL, int(program), 1 if repeats is None else int(repeats))

    def _refuse_unused(self, words: BlockWords) -> None:
        for word in words.unused():
            name = word.letter if word.index is None else f"{word.letter}{word.index}"
            if name in self.dialect.ignored_addresses:
                self.messages.add(f"'{name}' has no effect here and is ignored")
                continue
            if word.letter in "XYZABCUVW":
                names = ", ".join(axis.name for axis in self.state.machine.axes)
                raise self.fail(
                    f"there is no axis '{name}' on machine '{self.state.machine.name}', or nothing that uses it here",
                    f"Its axes are {names}; choose another with --machine.",
                    word,
                )
            raise self.fail(
                f"'{name}' has no meaning in this block",
                "Take it out, or add the function it belongs to.",
                word,
            )
