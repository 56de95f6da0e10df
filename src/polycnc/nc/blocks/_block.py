"""A block as a value: what it says, the state before it and after it, what it gives to the queue, what it reports.

It is made for one block, goes once through the steps (`_steps`) and is dropped. A block that is refused has changed
nothing: what it did, it did to the value.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from polycnc.errors import ProgramError
from polycnc.nc.blocks._channel_state import ChannelState
from polycnc.nc.blocks._corners import Corner
from polycnc.nc.blocks._moves import Point, QueueItem
from polycnc.nc.blocks._outcomes import NEXT, Outcome, Problem
from polycnc.nc.blocks._words import NUMBERS, BlockWords, WordSorter
from polycnc.nc.dialect._dialect import Dialect
from polycnc.nc.modal._actions import Group
from polycnc.nc.modal._modal import (
    MODULO_AXIS,
    MOTION_NONE,
    NO_AXIS,
)
from polycnc.nc.text._place import Place
from polycnc.nc.text._program import ProgramText, TextRules
from polycnc.nc.text._scan_plain import Block, Word


class ChannelRules:
    """What all blocks of a channel share, and what they ask of others.

    Args:
        dialect: what codes mean.
        state: a state of the channel, for what no block changes.
        call_problem: says what is against calling a sub-program from an offset of a text; None if nothing is.
        execute: sends a block through the steps, for a cycle that executes the blocks of its contour.
    """

    __slots__ = (
        "call_problem", "dialect", "execute", "high", "increment", "low", "modulo", "sorter", "stops_at_limits",
        "text_rules", "ways",
    )  # fmt: skip

    def __init__(
        self,
        dialect: Dialect,
        state: ChannelState,
        call_problem: Callable[[int, ProgramText, int], Problem | None],
        execute: Callable[[BlockContext], None],
    ) -> None:
        self.dialect = dialect
        self.sorter = WordSorter(dialect)
        self.increment = dialect.increment
        self.stops_at_limits = dialect.soft_limits == "at_limit"
        self.text_rules: TextRules = dialect.text
        self.low: list[float] = state.modal.low.tolist()
        self.high: list[float] = state.modal.high.tolist()
        self.modulo = [int(kind) == MODULO_AXIS for kind in state.modal.rotary]
        names = state.axis_names
        # Addresses of ways: without meaning where the machine has such an axis, or lacks the one they stand for.
        self.ways = {
            letter: names.index(name)
            for letter, name in dialect.incremental.items()
            if letter not in names and name in names
        }
        self.call_problem = call_problem
        self.execute = execute


@dataclass(slots=True)
class BlockContext:
    """Hold one block on its way through the steps.

    `before` is in force until the block is committed, and no step changes it; `after` is a copy, and what the steps
    change. `items` are moves and waits for the queue, `notes` messages, `marks` the references of blocks that give
    the queue nothing. `outcome` says how the program goes on, `goes_on` where, after a contour that has been cut.
    `exact_stop` tells that it comes to rest at its end, `shows` which motion its record shows.
    `speed` is the S word where it is a spindle speed, `holds` a move that waits for its corner. `change` starts or ends
    radius compensation when all else is right; `compensated` tells that moves went through it. A block of a contour
    that is only `measured` leaves no marks. `passed` are soft limits at which its moves stop, `unfed` is where a move
    ends that has no feed.
    """

    rules: ChannelRules
    text: ProgramText
    block: Block
    before: ChannelState
    after: ChannelState
    dialect: Dialect
    line: int
    measured: bool = False
    words: BlockWords = field(default_factory=BlockWords)
    items: list[QueueItem] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    marks: list[int] = field(default_factory=list)
    outcome: Outcome = NEXT
    goes_on: Place | None = None
    speed: Word | None = None
    holds: Corner | None = None
    change: Callable[[], None] | None = None
    compensated: bool = False
    passed: list[ProgramError] = field(default_factory=list)
    unfed: Point | None = None
    exact_stop: bool = False
    shows: int = MOTION_NONE

    def problem(self, what: str, hint: str, word: Word | None) -> ProgramError:
        """Return an error about this block, at `word` if there is one."""
        return ProgramError(what, position=self.text.position(self._place(word)), hint=hint)

    def note(self, text: str) -> None:
        """Report something to the operator, once the block has been executed."""
        self.notes.append(text)

    @property
    def start(self) -> Point:
        """The programmed position, in machine coordinates."""
        return tuple(self.after.modal.position.tolist())

    @property
    def move_word(self) -> Word | None:
        """The word that best shows what the block wants to move."""
        return self.words.g_word(Group.MOTION) or self.words.first(*self.after.axis_names, *"IJKR")

    def plane(self, what: str, word: Word | None) -> tuple[int, int, int]:
        """Return the axes of the working plane: first, second, and normal or NO_AXIS.

        Raises:
            ProgramError: the machine lacks one of the first two; `what` needs them.
        """
        p, q, r = self.after.plane
        if NO_AXIS in (p, q):
            raise self.problem(
                f"{what} in the plane {self.after.plane_letters[:2]}, which this machine does not have",
                "Select a plane of the machine's axes with G17, G18 or G19.",
                word,
            )
        return p, q, r

    def within(self, block: Block, after: ChannelState, *, measured: bool) -> BlockContext:
        """Return a block of a contour that this block executes, on a state; they report together."""
        return BlockContext(
            self.rules,
            self.text,
            block,
            self.before,
            after,
            self.dialect,
            block.line,
            measured,
            notes=self.notes,
            marks=self.marks,
            passed=self.passed,
        )

    def _place(self, word: Word | None) -> int:
        if word is not None:
            return word.place
        words = self.block.words
        for each in words:
            if each.letter not in NUMBERS:
                return each.place
        return words[0].place if words else self.block.offset
