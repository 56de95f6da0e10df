"""The ordinary interpreter: one block at a time, everything a block can say, and every error.

A block's words take effect in one fixed order, whatever order they stand in: units and plane, feed mode and
feed, spindle, tool and auxiliary functions, dwell, tool length, radius compensation, work offset, stopping,
absolute or incremental, retract level, then the non-modal functions or the motion, at last program stop, call
or end.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace

from polycnc.errors import ProgramError
from polycnc.nc.blocks._auxiliary import Auxiliary
from polycnc.nc.blocks._channel_state import ChannelState
from polycnc.nc.blocks._compensation import CompensationError
from polycnc.nc.blocks._contours import (
    ContourTrouble,
    contour_blocks,
    holds_cycle,
    names_x_and_z,
    numbered_block,
    without_compensation,
)
from polycnc.nc.blocks._corner_blocks import NUMBERS, CornerBlocks
from polycnc.nc.blocks._cycle_blocks import CycleBlocks
from polycnc.nc.blocks._frames import Frames
from polycnc.nc.blocks._messages import Messages
from polycnc.nc.blocks._modes import Modes
from polycnc.nc.blocks._motion import MotionBuilder
from polycnc.nc.blocks._moves import Arc, Line, QueueItem, Spline, Stop, Wait
from polycnc.nc.blocks._non_modal import NonModal
from polycnc.nc.blocks._nurbs import NurbsBlocks
from polycnc.nc.blocks._outcomes import JUMPS, NEXT, Control, Outcome, Outcomes, Trouble
from polycnc.nc.blocks._placing import Placing
from polycnc.nc.blocks._queue import QueueWriter
from polycnc.nc.blocks._splines import SplineBlocks
from polycnc.nc.blocks._turning_blocks import TurningBlocks
from polycnc.nc.blocks._word_checks import WordChecks
from polycnc.nc.blocks._words import BlockWords, GWord, sort_words
from polycnc.nc.dialect._dialect import Dialect
from polycnc.nc.modal._actions import Action, Family, Group
from polycnc.nc.modal._modal import (
    FEED_MODE,
    FEED_PER_MINUTE,
    MOTION,
    MOTION_ARC_CW,
    MOTION_LINEAR,
    MOTION_NONE,
    MOTION_NURBS,
    ORDINARY,
)
from polycnc.nc.records._block_records import AGAIN
from polycnc.nc.text._not_words import slip, statements
from polycnc.nc.text._place import Place
from polycnc.nc.text._program import ProgramText
from polycnc.nc.text._scan import MESSAGE, STATEMENT
from polycnc.nc.text._scan_plain import Block, Word

_CURVED = (Family.SPLINE, Family.CURVE)
_STATED = (Group.MOTION, Group.DISTANCE)
_LANGUAGES = (
    "Name the dialect of the control that they are for, like --dialect fanuc for custom macros or bosch for CPL, "
    "or post the program without them."
)

_REMARKS = re.compile(rb"\([^)\r\n]*\)")


def _moves_only(g: GWord) -> tuple[str, str]:
    return f"a contour of G{g.code} with a call, a cycle, a stop or an end", "Let it hold moves only."


class Interpreter:
    """Execute blocks of one channel: change the state and give items to the queue.

    `call_trouble` says what is against calling a sub-program from an offset of a text, None if nothing is. `reference`
    gives the reference of the record of the block on a line, when all that the block changes has been changed.
    """

    def __init__(
        self,
        dialect: Dialect,
        state: ChannelState,
        messages: Messages,
        queue: QueueWriter,
        call_trouble: Callable[[int, ProgramText, int], Trouble | None],
        reference: Callable[[int], int],
    ) -> None:
        self.dialect = dialect
        self.state = state
        self.messages = messages
        self._queue = queue
        self._reference = reference
        self._last_tag = 0
        self._text = ProgramText.from_text("")
        self._held_text = self._text  # of the move that radius compensation holds back
        self._block: Block | None = None
        self._rules = dialect.text_rules()
        self._statements: tuple[ProgramText, int, int] | None = (
            None  # a program, its first statement, how many
        )
        self._motion = MotionBuilder(state, dialect, messages, self.fail)
        self._auxiliary = Auxiliary(
            state, messages, self._motion, self.fail, turret=dialect.tool_word == "turret"
        )
        self._modes = Modes(state, dialect, messages, self._auxiliary, self.fail)
        self._non_modal = NonModal(state, messages, self._motion, self.fail)
        self._frames = Frames(state, dialect, self._motion, self.fail)
        self._placing = Placing(state, self._motion, self.fail)
        self._cycles = CycleBlocks(state, dialect, self._motion, self.fail)
        self._turning = TurningBlocks(state, dialect, self._motion, self.fail)
        self._splines = SplineBlocks(state, self._motion, self.fail)
        self._nurbs = NurbsBlocks(state, self._motion, self._splines, self.fail, self._leave_cycles)
        self._checks = WordChecks(state, dialect, messages, self.fail)
        self._corners = CornerBlocks(state, self._motion, self.fail)
        self._outcomes = Outcomes(
            dialect, self.fail, lambda program, place: call_trouble(program, self._text, place)
        )
        self._nurbs = NurbsBlocks(state, self._motion, self._splines, self.fail, self._leave_cycles)
        self._behind: Place | None = None  # where the program goes on, behind a contour that a cycle has cut
        self._capturing = False

    def execute(self, text: ProgramText, block: Block) -> Outcome:
        """Execute one block of `text`.

        Raises:
            ProgramError: the block cannot be executed; nothing has been changed or queued for it.
        """
        self._text, self._block, self._behind = text, block, None
        self.messages.begin(block.line)
        self.state.coordinates.take_changes()
        saved = self.state.save()
        try:
            outcome, items = self._execute(block)
        except BaseException as error:
            self.state.restore(saved)
            self.messages.take_back()
            if isinstance(error, CompensationError):
                raise self._placed(error) from None
            raise
        state, plain = self.state, saved.plain
        if (state.path_tolerance_mm, state.merge_mm) != (plain.path_tolerance_mm, plain.merge_mm):
            self._queue.set_tolerance(state.path_tolerance_mm, state.merge_mm)
        self._queue.put_block(items)
        return self._going_on(outcome)

    def _going_on(self, outcome: Outcome) -> Outcome:
        """Return how the program goes on: behind a contour that has been cut."""
        if self._behind is None or outcome is not NEXT:
            return outcome
        return Outcome(Control.GO_ON, place=self._behind)

    def finish(self) -> None:
        """Give out what radius compensation still holds back, at the end of the program.

        Raises:
            ProgramError: the last move cannot be compensated.
        """
        try:
            items = self._flushed()
            if (corner := self.state.corner) is not None:
                self.state.corner = None
                raise ProgramError(
                    f"{corner.word} at the end of the program",
                    position=self._text.line_position(corner.move.line),
                    hint="A corner needs a straight move behind it.",
                )
            if (curve := self.state.nurbs) is not None:
                self.state.nurbs = None
                raise ProgramError(
                    f"the program ends in a curve (G{curve.code})",
                    position=self._text.line_position(curve.line),
                    hint="End the curve with G5.3.",
                )
        finally:
            self.state.compensation.reset()
        for item in items:
            self._queue.put(item)

    def drain(self, text: ProgramText, line: int) -> None:
        """Let preparation stop behind everything that has been given out; radius compensation holds nothing back.

        Raises:
            ProgramError: the last move cannot be compensated.
        """
        items = self._flushed()
        self._text, self._block = text, None
        for item in (*items, *self._tagged([Wait(0.0, line, stop=Stop.DRAIN)], line)):
            self._queue.put(item)

    def _flushed(self) -> list[QueueItem]:
        try:
            items = list(self._tips(self.state.compensation.flush()))
            self._check_path(items)
        except CompensationError as error:
            raise self._placed(error) from None
        return items

    def fail(self, what: str, hint: str, word: Word | None) -> ProgramError:
        """Return an error about the present block, at `word` if there is one."""
        return ProgramError(what, position=self._text.position(self._place(word)), hint=hint)

    def _no_words(self, block: Block) -> ProgramError:
        """Return what is wrong with a line that is no words; statements of a language make one error a program."""
        text, rules = self._text, self._rules
        wrong = slip(text.content[block.offset : text.line_end(block.offset)].decode("latin-1"), rules)
        if wrong is not None:
            position = text.position(block.offset + wrong.place)
            return ProgramError(wrong.what, position=position, hint=wrong.hint)
        if self._statements is None or self._statements[0] is not text:
            self._statements = (text, *statements(text, rules))
        _, first, count = self._statements
        blocks = "1 block has them" if count <= 1 else f"{count} blocks have them, this is the first"
        return ProgramError(
            f"dialect '{self.dialect.name}' reads no variables, expressions or program flow ({blocks})",
            position=text.line_position(first or block.line),
            hint=_LANGUAGES,
        )

    def _place(self, word: Word | None) -> int:
        if word is not None:
            return word.place
        assert self._block is not None
        words = self._block.words
        for each in words:
            if each.letter not in NUMBERS:
                return each.place
        return words[0].place if words else self._block.offset

    def _count(self, code: str) -> int:
        """Return in how many blocks of the present program text a G code stands."""
        pattern = rb"[Gg][ \t]*0*" + re.escape(code.encode()) + rb"(?![0-9.])"
        content = _REMARKS.sub(lambda found: b" " * len(found[0]), self._text.content)
        return len({content.rfind(b"\n", 0, found.start()) for found in re.finditer(pattern, content)})

    def _placed(self, error: CompensationError) -> ProgramError:
        """Add the place to an error of radius compensation, which knows its line only."""
        here = self._block is not None and error.line == self._block.line
        position = (self._text if here else self._held_text).line_position(error.line)
        return ProgramError(error.what, position=position, hint=error.hint, code=error.code)

    # ------------------------------------------------------------------ one block

    def _execute(self, block: Block) -> tuple[Outcome, list[QueueItem]]:
        if block.flags & STATEMENT:
            raise self._no_words(block)
        if block.flags & MESSAGE and block.message:
            self.messages.add(f"MSG: {block.message}")
        line = block.line
        words = sort_words(block, self.dialect, self.fail, self._count)
        self._checks.refuse_contradictions(words)
        self._nurbs.refuse_others(words)
        self._checks.leave_out(words)
        self._motion.begin(words)
        for letter in NUMBERS:
            words.take(letter)
        outcome = self._outcomes.outcome(words) if words.m else NEXT
        modes = self._modes
        modes.set_units_and_plane(words)
        modes.set_feed(words)
        items: list[QueueItem] = [*self._auxiliary.before_motion(words, line), *modes.dwell(words, line)]
        modes.set_length(words)
        change_compensation = modes.radius_compensation(words, line)
        modes.set_work_offset(words)
        modes.set_others(words)
        for group in (Group.ROTATION, Group.POLAR):
            if g := words.g.get(group):
                self._frames.set_modal(g, words)
        items += self._moved(words, line, functions=bool(items))
        if words.left_out:
            self._checks.take_parameters(words)
        self._checks.refuse_unused(words)
        if words.m:
            items += self._auxiliary.after_motion(words, line, block.message)
            if codes := tuple(m.code for m in words.m if m.action not in JUMPS):
                self.state.m_codes = codes
        self._motion.check_times(items)
        self._note_position(items)
        if self.dialect.notes_codes:
            self._note_codes(words)
        whole = self.state.modal.whole
        in_force = whole[MOTION]
        if self._is_spline(words) or self.state.nurbs is not None:  # for the record of this block
            g = words.g.get(Group.MOTION)
            whole[MOTION] = g.value if g is not None else MOTION_NURBS
        tagged = self._tagged(items, line, words_stand=bool(block.words))
        whole[MOTION] = in_force
        return outcome, self._compensated(tagged, change_compensation)

    def _tagged(self, items: list[QueueItem], line: int, *, words_stand: bool = True) -> list[QueueItem]:
        """Return the items with the reference of the block's record, another one than the block just before has.

        A block with words and without items is noted as such.
        """
        if not items:
            if words_stand:
                self.mark(line)
            return items
        tag = self._next_tag(line)
        return [item.tagged(tag) for item in items]

    def _next_tag(self, line: int) -> int:
        tag = self._reference(line)
        if tag == self._last_tag:
            tag ^= AGAIN
        self._last_tag = tag
        return tag

    def snapshot(self) -> tuple[int, ProgramText, ProgramText]:
        """Return what one block leaves for the next besides the state, to go back to."""
        return self._last_tag, self._held_text, self._text

    def restore(self, saved: tuple[int, ProgramText, ProgramText]) -> None:
        """Go back to a snapshot."""
        self._last_tag, self._held_text, self._text = saved
        self._block = None

    @property
    def last_tag(self) -> int:
        """The reference of the last block that was executed."""
        return self._last_tag

    def mark(self, line: int) -> None:
        """Note a block that does nothing on the path, to be stepped to."""
        if self._queue.marks is not None and not self._capturing:
            self._queue.mark(self._next_tag(line))

    def _compensated(self, items: list[QueueItem], change: Callable[[], None] | None) -> list[QueueItem]:
        """Return what of the items the queue gets now; radius compensation may hold moves back."""
        stage = self.state.compensation
        if change is not None:
            change()
        if stage.active:
            push = stage.push
            moves = any(isinstance(item, (Line, Arc)) for item in items)
            items = [out for item in items for out in self._with_tip(item, push(item))]
            self._check_path(items)
            if moves:
                self._held_text = self._text
        whole = self.state.modal.whole
        whole[ORDINARY] = (
            stage.active
            or self._cycles.active
            or self._turning.active
            or self.state.corner is not None
            or self.state.spline_way is not None
            or self.state.nurbs is not None
            or self.state.placement.once != 0  # the next block takes it back
            or whole[FEED_MODE] != FEED_PER_MINUTE
            or self.state.frame.active
        )
        return items

    def _with_tip(self, item: QueueItem, pushed: Iterable[QueueItem]) -> Iterator[QueueItem]:
        """Yield what compensation gives for an item as moves of the tool's tip."""
        state = self.state
        if isinstance(item, (Line, Arc)):
            state.tip = state.tip.with_programmed(item.end)
        yield from self._tips(pushed)

    def _tips(self, pushed: Iterable[QueueItem]) -> Iterator[QueueItem]:
        for out in pushed:
            if isinstance(out, (Line, Arc)):
                self.state.tip, out = self.state.tip.applied(out)
            yield out

    def _check_path(self, items: list[QueueItem]) -> None:
        for item in items:
            if isinstance(item, (Line, Arc)):
                self._motion.check_path(item)

    def leave_compensation(self) -> None:
        """Go on without radius compensation, to look for errors behind a path that cannot be followed."""
        self.state.compensation.reset()
        self.state.side = 0

    # ------------------------------------------------------------------ motion

    def _leave_cycles(self) -> None:
        self._cycles.cancel()
        self._turning.cancel()

    def _motion_in_force(self, words: BlockWords) -> int:
        """Take over a motion word of the block and return the motion in force."""
        whole = self.state.modal.whole
        if Group.CYCLE_CANCEL in words.g:
            self._cycles.cancel()
        g = words.g.get(Group.MOTION)
        match g.action.family if g else None:
            case Family.MOVE:
                assert g is not None
                self._leave_cycles()
                whole[MOTION] = g.value
            case Family.TURNING:
                assert g is not None
                self._cycles.cancel()
                self._turning.begin(g)
                whole[MOTION] = MOTION_LINEAR
            case Family.DRILLING:
                assert g is not None
                self._turning.cancel()
                self._cycles.begin(g)
        return int(whole[MOTION])

    @staticmethod
    def _is_spline(words: BlockWords) -> bool:
        g = words.g.get(Group.MOTION)
        return g is not None and g.action.family in _CURVED

    def _is_nurbs(self, words: BlockWords) -> bool:
        g = words.g.get(Group.MOTION)
        return self.state.nurbs is not None or (g is not None and g.action.family is Family.CURVE)

    def _move(self, words: BlockWords, line: int) -> list[QueueItem]:
        motion = self._motion_in_force(words)
        if Group.DWELL in words.g:
            if self._motion.axis_word_left():
                code = words.g[Group.DWELL].code
                raise self.fail(
                    f"a dwell (G{code}) and a move in one block",
                    "Write them in two blocks.",
                    self._left_axis(words),
                )
            return []
        if g := words.g.get(Group.NON_MODAL):
            match g.action.family:
                case Family.FRAME:
                    self._frames.carry_out(g, words)
                    return []
                case Family.PLACING:
                    self._placing.carry_out(g, words)
                    return []
                case Family.TURNING_CYCLE:
                    return self._turning.cycle(g, words, line)
                case Family.CONTOUR_CYCLE:
                    return self._contour_cycle(g, words, line)
            return list(self._non_modal.carry_out(g, motion, line))
        if self._is_nurbs(words):
            return list(self._nurbs.block(words, line))
        if self._is_spline(words):
            return list(self._splines.moves(words.g[Group.MOTION], line))
        if self._cycles.active:
            return self._cycles.expand(words, line)
        if self._turning.active:
            return self._turning.expand(words, line)
        values = self._motion.axis_words()
        if not values and not (motion >= MOTION_ARC_CW and words.first(*"IJKR")):
            return []
        if motion == MOTION_NONE:
            raise self.fail(
                "axis words without a motion",
                "Write G0, G1, G2, G3 or a cycle in this or an earlier block.",
                self._motion.place(),
            )
        moves = self._motion.moves(self._motion.target(values), motion, line)
        if motion == MOTION_LINEAR and self.dialect.corner_words:
            return self._corners.held(list(moves), words)
        return list(moves)

    def _moved(self, words: BlockWords, line: int, *, functions: bool) -> list[QueueItem]:
        """Return the block's moves, with the move before it that waits for its corner."""
        moves = self._move(words, line)
        if moves and not self._is_spline(words):
            self.state.spline_way = None
        if not self.dialect.corner_words:
            return moves
        if functions and self.state.corner is not None:
            raise self._corners.no_straight_move(self.state.corner)
        return self._corners.joined(moves, words)

    def _contour_cycle(self, g: GWord, words: BlockWords, line: int) -> list[QueueItem]:
        """Return the moves of a cycle about a contour, which stands in other blocks: from P to Q."""
        numbers = self._turning.contour_words(g, words)
        if numbers is None:
            self._turning.set_parameters(g, words)
            return []
        blocks = self._contour(*numbers, g)
        start = self._motion.start
        if g.action is Action.TURN_FINISH:
            self._checks.refuse_unused(words)
            found = [item for block in blocks for item in self._of_contour(block, g)]
            self._corners.refuse_open(g)
            return [*found, *self._turning.back_to(start, line)]
        state = self.state
        saved = state.save()
        self._capturing = True
        try:
            moves = [
                item
                for block in blocks
                for item in self._of_contour(without_compensation(block, self.dialect), g)
                if isinstance(item, (Line, Arc))
            ]
            self._corners.refuse_open(g)
        finally:
            self._capturing = False
            state.restore(saved)
        both = names_x_and_z(blocks[0], self.dialect) if blocks else False
        return self._turning.contour_cycle(g, words, moves, line, both_axes=both)

    def _of_contour(self, block: Block, g: GWord) -> list[QueueItem]:
        """Execute a block of a contour within the present block; return its moves."""
        outer, words, stops = self._block, self._motion.words, self._motion.exact_stop_block
        self._block = block
        try:
            outcome, items = self._execute(block)
            if outcome is not NEXT or any(isinstance(item, Spline) for item in items):
                raise self.fail(*_moves_only(g), None)
        finally:
            self._block, self._motion.words, self._motion.exact_stop_block = outer, words, stops
        self._note_position(items)
        return items

    def _contour(self, first: int, last: int, g: GWord) -> list[Block]:
        """Return the blocks from number `first` to `last`; where they follow here, the program goes on behind."""
        assert self._block is not None
        text, here = self._text, self._block.end
        begin = numbered_block(text, first, here, len(text), self._rules)
        blocks = contour_blocks(
            text, begin or numbered_block(text, first, 0, here, self._rules), (first, last), self._rules
        )
        if isinstance(blocks, ContourTrouble):
            raise self.fail(*blocks, g.word)
        if any(block.flags & STATEMENT for block in blocks):
            raise self.fail(
                f"a contour of G{g.code} with statements is not supported yet", "Write plain words.", g.word
            )
        if any(holds_cycle(block, self.dialect) for block in blocks):
            raise self.fail(*_moves_only(g), g.word)
        self._behind = Place(text, blocks[-1].end, blocks[-1].line + 1) if begin else None
        return [block for block in blocks if block.words]

    def _left_axis(self, words: BlockWords) -> Word | None:
        return next((word for letter, word in words.unused() if letter in self.state.axis_names), None)

    def _note_position(self, items: list[QueueItem]) -> None:
        """Remember the programmed position, which is not compensated."""
        if self.state.corner is not None:
            self.state.modal.position[:] = self.state.corner.move.end
            return
        for item in reversed(items):
            if not isinstance(item, Wait):
                self.state.modal.position[:] = item.end
                return

    def _note_codes(self, words: BlockWords) -> None:
        """Keep the G codes of the block, the latest last; motion and distance are in the modal state."""
        said = {int(g.word.value) for group, g in words.g.items() if group not in _STATED}
        said |= {int(g.word.value) for g in words.ignored}
        placement = self.state.placement
        alone = words.g.get(Group.NON_MODAL) or words.g.get(Group.DWELL)
        once = int(alone.word.value) if alone else 0
        new = said and not said <= {*placement.codes[-1:]}
        if new or once != placement.once:
            kept = (code for code in placement.codes if code not in said)
            plane = None if Group.PLANE in words.g else placement.plane
            codes = (*kept, *sorted(said))
            self.state.placement = replace(placement, codes=codes, once=once, plane=plane)
