"""The reference interpreter: one block at a time, everything a block can say, and every error.

A block is a value (`_block`) that goes through the steps (`_steps`). What waits comes after them: radius compensation
may hold moves back. When all has succeeded the block is committed: its state becomes the channel's, and its items go
into the queue. Else it is dropped.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from typing import TypeVar
from weakref import WeakMethod

from polycnc.errors import ProgramError
from polycnc.nc.blocks._block import BlockContext, ChannelRules
from polycnc.nc.blocks._channel_state import ChannelState
from polycnc.nc.blocks._compensation_errors import CompensationError
from polycnc.nc.blocks._limits import check_path, up_to_limits
from polycnc.nc.blocks._messages import Messages
from polycnc.nc.blocks._moves import Arc, Line, QueueItem, Stop, Wait
from polycnc.nc.blocks._outcomes import NEXT, Continuation, Outcome, Problem
from polycnc.nc.blocks._queue import QueueWriter
from polycnc.nc.blocks._steps import take_steps
from polycnc.nc.dialect._dialect import Dialect
from polycnc.nc.modal._actions import Family
from polycnc.nc.modal._frame import UNTURNED
from polycnc.nc.modal._modal import FEED, FEED_MODE, FEED_NUMBER, FEED_PER_MINUTE, MOTION, ORDINARY
from polycnc.nc.modal._modal_snapshot import ModalSnapshot
from polycnc.nc.records._block_records import AGAIN
from polycnc.nc.text._not_words import statements, syntax_hint
from polycnc.nc.text._place import Place
from polycnc.nc.text._program import ProgramText
from polycnc.nc.text._scan import STATEMENT
from polycnc.nc.text._scan_plain import Block

F = TypeVar("F", bound=Callable[..., object])
_ASSUMED_FEED_MM_MIN = 1000.0


class Interpreter:
    """Execute blocks of one channel: change the state and give items to the queue.

    `call_problem` says what is against calling a sub-program from an offset of a text, None if nothing is. `reference`
    gives the reference of the record of the block on a line, with what it leaves in force.
    """

    def __init__(
        self,
        dialect: Dialect,
        state: ChannelState,
        messages: Messages,
        queue: QueueWriter,
        call_problem: Callable[[int, ProgramText, int], Problem | None],
        reference: Callable[[int, ModalSnapshot], int],
    ) -> None:
        self.dialect = dialect
        self.state = state
        self.messages = messages
        self._queue = queue
        self._reference = reference
        run = WeakMethod(self._run)  # the rules are the interpreter's own
        self._rules = ChannelRules(dialect, state, call_problem, lambda block: _alive(run)(block))
        self._not_blocks = NotBlocks(dialect)
        self._after = state.copy()  # what the present block changes
        self._last_tag = 0
        self._text = ProgramText.from_text("")
        self._held_text = self._text  # of the move that radius compensation holds back
        self._refused: BlockContext | None = None

    def execute(self, text: ProgramText, block: Block) -> Outcome:
        """Execute one block of `text`.

        Raises:
            ProgramError: the block cannot be executed; nothing has been changed or queued for it, but what leads up to
                a soft limit at which the dialect lets moves stop.
        """
        self._tell_of_probe()
        self._text = text
        self.messages.line = block.line
        self.state.take_changes()
        self._after.take(self.state)
        if self._after.compensation.active:
            self._after.compensation = self._after.compensation.copy()
        context = BlockContext(self._rules, text, block, self.state, self._after, self.dialect, block.line)
        self._refused = context  # until it has been carried out
        try:
            self._run(context)
        except CompensationError as error:
            placed = self._placed(error, block.line)
            if not _stops(placed):
                raise placed from None
            context.passed.append(placed)
        if context.passed:
            self._stop_at_limit(context)
        self._commit(context)
        self._refused = None
        if context.goes_on is not None and context.outcome is NEXT:
            return Outcome(Continuation.GO_ON, place=context.goes_on)
        return context.outcome

    def _tell_of_probe(self) -> None:
        """Tell the program once how the last probing move went.

        Raises:
            ProgramError: it did not do what it was for.
        """
        probe = self.state.probe
        if probe is None or not probe.code:
            return
        self.state.probe = replace(probe, code="")
        if (problem := probe.problem) is not None:
            what, hint = problem
            raise ProgramError(what, position=self._text.position(probe.place), hint=hint)

    def _commit(self, block: BlockContext) -> None:
        """Put what a block has done in force, report it and queue it."""
        state, before = self.state, block.before
        corners = before.path_tolerance_mm, before.merge_mm
        state.take(block.after)
        for text in block.notes:
            self.messages.add(text)
        for tag in block.marks:
            self._queue.mark(tag)
        if block.compensated:
            self._held_text = block.text
        if corners != (state.path_tolerance_mm, state.merge_mm):
            self._queue.set_tolerance(state.path_tolerance_mm, state.merge_mm)
        self._queue.put_block(block.items)

    def _stop_at_limit(self, block: BlockContext) -> None:
        """Queue what a block does until an axis is on its soft limit; what compensation holds back comes before.

        Raises:
            ProgramError: tells of the limit.
        """
        held = _tips(block.after, block.after.compensation.flush())
        block.items, limit = self._up_to_limits([*block.items, *held])
        self._commit(block)
        error = next((each for each in block.passed if each.limit == limit), block.passed[0])
        error.limit = limit or error.limit
        raise error

    def _up_to_limits(
        self, items: Iterable[QueueItem]
    ) -> tuple[list[QueueItem], tuple[str, bool, bool] | None]:
        """Return what comes before a soft limit, and the one that an axis is on first."""
        kept, at = up_to_limits(items, self._rules.low, self._rules.high)
        return kept, None if at is None else (self.state.axis_names[at[0]], at[1], True)

    def finish(self) -> None:
        """Give out what radius compensation still holds back, at the end of the program.

        Raises:
            ProgramError: the last move cannot be compensated.
        """
        self._tell_of_probe()
        state = self.state
        try:
            items = self._flushed()
            if (corner := state.corner) is not None:
                state.corner = None
                raise ProgramError(
                    f"{corner.word} at the end of the program",
                    position=self._text.line_position(corner.move.line),
                    hint="A corner needs a straight move after it.",
                )
            if (curve := state.nurbs) is not None:
                state.nurbs = None
                state.mode = Family.MOVE
                raise ProgramError(
                    f"the program ends in a curve (G{curve.code})",
                    position=self._text.line_position(curve.line),
                    hint="End the curve with G5.3.",
                )
        finally:
            state.compensation.reset()
        for item in items:
            self._queue.put(item)

    def drain(self, text: ProgramText, line: int) -> None:
        """Let preparation stop after everything that has been emitted; radius compensation holds nothing back.

        Raises:
            ProgramError: the last move cannot be compensated.
        """
        items = self._flushed()
        self._text = text
        wait = Wait(0.0, line, stop=Stop.DRAIN).tagged(self._next_tag(line, self.state.snapshot()))
        for item in (*items, wait):
            self._queue.put(item)

    def _flushed(self) -> list[QueueItem]:
        items: list[QueueItem] = []
        try:
            items += _tips(self.state, self.state.compensation.flush())
            self._check_path(self.state, items)
        except CompensationError as error:
            placed = self._placed(error)
            if _stops(placed):
                kept, limit = self._up_to_limits(items)
                self._queue.put_block(kept)
                placed.limit = limit or placed.limit
            raise placed from None
        return items

    def _placed(self, error: CompensationError, line: int | None = None) -> ProgramError:
        """Add the place to an error of radius compensation, which knows its line only; `line` is that of the block."""
        position = (self._text if error.line == line else self._held_text).line_position(error.line)
        placed = ProgramError(error.what, position=position, hint=error.hint, code=error.code)
        placed.limit = error.limit
        return placed

    # ------------------------------------------------------------------ one block

    def _run(self, block: BlockContext) -> None:
        """Send a block through the steps, and its moves through what holds moves back."""
        if block.block.flags & STATEMENT:
            raise self._not_blocks.problem(block.text, block.block)
        take_steps(block)
        self._tag(block)
        self._compensate(block)

    def _tag(self, block: BlockContext) -> None:
        """Give the items the reference of the block's record, another one than the block just before has.

        A block with words and without items is noted as such.
        """
        marks = not block.items and self._queue.marks is not None and not block.measured
        if not block.items and not (marks and block.block.words):
            return
        whole = block.after.modal.whole
        in_force, whole[MOTION] = int(whole[MOTION]), block.shows
        tag = self._next_tag(block.line, block.after.snapshot())
        whole[MOTION] = in_force
        if marks:
            block.marks.append(tag)
        else:
            block.items = [item.tagged(tag) for item in block.items]

    def _next_tag(self, line: int, modal: ModalSnapshot) -> int:
        tag = self._reference(line, modal)
        if tag == self._last_tag:
            tag ^= AGAIN
        self._last_tag = tag
        return tag

    def _compensate(self, block: BlockContext) -> None:
        """Let radius compensation take the moves, and give what the queue gets now."""
        state = block.after
        if block.change is not None:
            block.change()
        stage = state.compensation
        if stage.active:
            block.compensated |= any(isinstance(item, (Line, Arc)) for item in block.items)
            if block.dialect.inverse_time_as_programmed:
                block.items = [self._queue.with_speed(item) for item in block.items]
            block.items = [out for item in block.items for out in _with_tip(state, item, stage.push(item))]
            self._check_path(state, block.items)
        whole = state.modal.whole
        whole[ORDINARY] = (
            stage.active
            or state.mode is not Family.MOVE
            or state.corner is not None
            or state.spline_way is not None
            or (state.probe is not None and state.probe.code != "")
            or state.placement.once != 0  # the next block takes it back
            or whole[FEED_MODE] != FEED_PER_MINUTE
            or (state.frame is not UNTURNED and state.frame.active)
        )

    def _check_path(self, state: ChannelState, items: Iterable[QueueItem]) -> None:
        for item in items:
            if isinstance(item, (Line, Arc)):
                check_path(state, item, stops_at_limits=self._rules.stops_at_limits)

    # ------------------------------------------------------------------ what one block leaves for the next

    def snapshot(self) -> tuple[int, ProgramText, ProgramText]:
        """Return what one block leaves for the next besides the state, to go back to."""
        return self._last_tag, self._held_text, self._text

    def restore(self, saved: tuple[int, ProgramText, ProgramText]) -> None:
        """Go back to a snapshot."""
        self._last_tag, self._held_text, self._text = saved

    @property
    def last_tag(self) -> int:
        """The reference of the last block that was executed."""
        return self._last_tag

    def tag_of(self, line: int) -> int:
        """Return the tag of a block that was refused, with the modal state before it."""
        return self._reference(line, self.state.snapshot())

    def mark(self, line: int) -> None:
        """Note a block that does nothing on the path, to be stepped to."""
        if self._queue.marks is not None:
            self._queue.mark(self._next_tag(line, self.state.snapshot()))

    def past_refused(self) -> Place | None:
        """Go on after the block that was refused, to look for errors that do not follow from it.

        Its feed counts, and a feed that is missing is missed once. Returns where the program goes on after its contour.
        """
        refused, self._refused = self._refused, None
        if refused is None:
            return None
        modal, after = self.state.modal, refused.after.modal
        if refused.unfed is not None:
            modal.real[FEED] = modal.real[FEED_NUMBER] = _ASSUMED_FEED_MM_MIN
            if not self.state.compensation.active:
                modal.position[:] = refused.unfed
        elif modal.whole[FEED_MODE] == after.whole[FEED_MODE]:
            modal.real[FEED], modal.real[FEED_NUMBER] = after.real[FEED], after.real[FEED_NUMBER]
        return refused.goes_on

    def leave_compensation(self) -> None:
        """Go on without radius compensation, to look for errors after a path that cannot be followed."""
        self.state.compensation.reset()
        self.state.side = 0


def _alive(method: WeakMethod[F]) -> F:
    found = method()
    assert found is not None
    return found


def _with_tip(state: ChannelState, item: QueueItem, pushed: Iterable[QueueItem]) -> Iterator[QueueItem]:
    """Yield what compensation gives for an item as moves of the tool's tip."""
    if isinstance(item, (Line, Arc)):
        state.tip = state.tip.with_programmed(item.end)
    yield from _tips(state, pushed)


def _tips(state: ChannelState, pushed: Iterable[QueueItem]) -> Iterator[QueueItem]:
    for out in pushed:
        if isinstance(out, (Line, Arc)):
            state.tip, out = state.tip.applied(out)
        yield out


def _stops(error: ProgramError) -> bool:
    """Tell whether a move is carried out up to the soft limit that it would pass."""
    return error.limit is not None and error.limit[2]


_LANGUAGES = (
    "Name the dialect of the control that they are for, like --dialect fanuc for custom macros or bosch for CPL, "
    "or post the program without them."
)


class Unread(ProgramError):  # noqa: N818  it is one like any
    """A statement that the language of the dialect has left, as it refused the program."""


class NotBlocks:
    """Say what is wrong with lines that are no words; statements of a language make one error a program."""

    def __init__(self, dialect: Dialect) -> None:
        self._name = dialect.name
        self._has_language = dialect.language != "none"
        self._rules = dialect.text
        self._known: tuple[ProgramText, int, int] | None = None  # a program, its first statement, how many

    def problem(self, text: ProgramText, block: Block) -> ProgramError:
        """Return what is wrong with a line."""
        wrong = syntax_hint(
            text.content[block.offset : text.line_end(block.offset)].decode("latin-1"), self._rules
        )
        if wrong is not None:
            position = text.position(block.offset + wrong.place)
            return ProgramError(wrong.what, position=position, hint=wrong.hint)
        if self._has_language:
            what = f"dialect '{self._name}' reads no statement like this"
            return Unread(what, position=text.line_position(block.line), hint="Check the line.")
        if self._known is None or self._known[0] is not text:
            self._known = (text, *statements(text, self._rules))
        _, first, count = self._known
        blocks = "1 block has them" if count <= 1 else f"{count} blocks have them, this is the first"
        return ProgramError(
            f"dialect '{self._name}' reads no variables, expressions or program flow ({blocks})",
            position=text.line_position(first or block.line),
            hint=_LANGUAGES,
        )
