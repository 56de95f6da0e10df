"""What a segment is part of: block records after one integer per segment.

The tag of a segment is a block reference: line in the low bits, one bit that tells two executions in a row of
the same block apart, and above them the number of a context. A context is what many blocks share: the program,
the calls that led to it and the modal state. Blocks of the reference interpreter have the context that they leave
behind. A run of plain blocks shares the context that stood before it; the modal words that such blocks may change
(motion, absolute or incremental, F, S, T, D, and M codes of a laser) are read again from the text when somebody asks.
So a plain block costs its integer and nothing else.

Equal contexts are one context, and those that nothing refers to any more are dropped (`keep`), so a program that
loops for hours needs no more memory than its first round.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from polycnc.nc.dialect._dialect import Dialect, DialectTables
from polycnc.nc.modal._actions import IN_FORCE, Action, Group
from polycnc.nc.modal._modal import (
    ABSOLUTE,
    ARC_ABSOLUTE,
    EXACT_PATH,
    EXACT_STOP,
    FEED_MODE,
    INCH,
    MOTION,
    PLANE,
)
from polycnc.nc.modal._modal_snapshot import ModalSnapshot
from polycnc.nc.modal._placement import NO_PLACEMENT, NO_SHIFTS, Placement, Shifts
from polycnc.nc.records._replay import PLAIN_MOTIONS, Replay, RunBegin, coolant_after, latest, replay_of
from polycnc.nc.text._program import ProgramText
from polycnc.nc.text._scan import ScanRules, scan, word_columns
from polycnc.units import MM_PER_INCH

LINE_MASK = (1 << 31) - 1
AGAIN = 1 << 31  # told apart from the execution just before
CONTEXT_SHIFT = 32
_CONTEXTS = 1 << 20  # numbers of contexts: a reference stays exact as a float64, as the recorder keeps it
_MOST_READ = 32
_FEW = 4096  # so many contexts are kept without asking who needs them

_SEQUENCE = re.compile(r"\s*(?:/[1-9]?)?\s*[Nn]\s*([0-9]+)")
_MOTIONS = {a.sets: a for a in (*PLAIN_MOTIONS, Action.CUBIC_SPLINE, Action.QUADRATIC_SPLINE, Action.NURBS)}


@dataclass(frozen=True, slots=True)
class Call:
    """A call under way: the program and the line that hold it, and which of its repetitions runs (from 1)."""

    program: str
    line: int
    repeat: int = 1


@dataclass(frozen=True, slots=True)
class ModalWords:
    """The modal words in force: G codes by their group, and the other addresses as programmed.

    `speed` is in rpm, or m/min with constant surface speed. `tool` is in the spindle, `next_tool` comes with the
    next tool change; `d` is None before the first D word. `m` are the M codes of the last block that had any,
    `coolant` those of the coolant that is on.
    `zero` is where program zero lies in machine coordinates (mm, degree), one value per axis; `work` are the work
    offsets of all groups, `placement` what the program has shifted, scaled and turned besides, `shifts` by how much.
    """

    g: dict[Group, str]
    feed: float
    speed: float
    spindle_direction: int
    tool: int
    next_tool: int
    d: int | None
    h: int
    m: tuple[int, ...]
    inch: bool
    zero: tuple[float, ...]
    work: tuple[str, ...] = ()
    placement: Placement = NO_PLACEMENT
    shifts: Shifts = NO_SHIFTS
    spindle_oriented: bool = False
    coolant: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class BlockRecord:
    """A block of a program as it is executed: where it stands, what it says, and what holds with it.

    `line` counts from 1, of the `lines` that its program has, `offset` is the byte where it begins, `sequence` its N
    word. `stack` holds the calls that led to it, the outermost first; it is empty in the main program.
    """

    program: str
    line: int
    offset: int
    sequence: int | None
    text: str
    stack: tuple[Call, ...]
    modal: ModalWords
    lines: int = 0


class Zero(NamedTuple):
    """Where program zero lies: `offset` in machine coordinates (mm, degree), one value per axis.

    It is the sum of the work offsets `work`, of what the program has shifted, and of the tool's length.
    """

    offset: tuple[float, ...]
    work: tuple[str, ...] = ()
    inch: bool = False


_Key: TypeAlias = tuple[ProgramText, tuple[Call, ...], ModalSnapshot, RunBegin | None]


class SavedRecords(NamedTuple):
    """Hold contexts by their numbers, the number of the next one, and how many are enough, to go back to."""

    contexts: dict[int, _Key]
    next: int
    enough: int


@dataclass(slots=True)
class _Context:
    text: ProgramText
    stack: tuple[Call, ...]
    modal: ModalSnapshot
    begin: RunBegin | None  # of a run of plain blocks
    replay: Replay | None = None
    speaks: bool = False  # the run says something of the spindle

    def key(self) -> _Key:
        return self.text, self.stack, self.modal, self.begin


def line_of(tag: int) -> int:
    """Return the line of the block that a tag refers to."""
    return tag & LINE_MASK


class BlockRecords:
    """Give out block references for the segments of one channel, and read them back."""

    def __init__(
        self, dialect: Dialect, rules: ScanRules, tables: DialectTables, columns: int, *, laser: bool
    ) -> None:
        self._tables = tables
        self._laser = laser
        self._rules = rules
        self._columns = columns  # blocks of one run of plain blocks at the most
        self._contexts: dict[int, _Context] = {}
        self._known: dict[_Key, int] = {}
        self._next = 1
        self._enough = _FEW
        self._last: tuple[_Key | None, int] = None, 0  # and what is added to a line
        self._codes = _codes(dialect)
        self._read: dict[int, BlockRecord] = {}  # the last records that were read

    def reference(self, text: ProgramText, stack: tuple[Call, ...], modal: ModalSnapshot, line: int) -> int:
        """Return the reference of a block after which `modal` is in force."""
        return self._base((text, stack, modal, None)) | line

    def run_base(
        self, text: ProgramText, stack: tuple[Call, ...], modal: ModalSnapshot, begin: RunBegin
    ) -> int:
        """Return what is added to a line for its reference, for a run of plain blocks from `begin` on."""
        return self._base((text, stack, modal, begin))

    def note_spoken(self, base: int) -> None:
        """Take note that the run of plain blocks with this base says something of the spindle."""
        self._contexts[base >> CONTEXT_SHIFT].speaks = True

    def block(self, tag: int) -> BlockRecord | None:
        """Return the record of a block; None for a tag that is no reference, or of a context since dropped."""
        if (known := self._read.get(tag)) is not None:
            return known
        context = self._contexts.get(tag >> CONTEXT_SHIFT)
        if context is None:
            return None
        line = tag & LINE_MASK
        offset = context.text.line_start(line)
        text = context.text.line(offset)
        number = _SEQUENCE.match(text)
        if len(self._read) >= _MOST_READ:
            self._read.clear()
        self._read[tag] = record = BlockRecord(
            program=context.text.name,
            line=line,
            offset=offset,
            sequence=int(number[1]) if number else None,
            text=text,
            stack=context.stack,
            modal=self._words(context, line),
            lines=context.text.lines,
        )
        return record

    def words(self, text: ProgramText, modal: ModalSnapshot) -> ModalWords:
        """Return the modal words of a state of preparation."""
        return self._words(_Context(text, (), modal, None), 0)

    def lasting_words(self, tag: int) -> ModalWords | None:
        """Return the modal words with a block, but motion, distance and feed as its run of plain blocks began.

        It reads no text, whatever the length of the run; None for a tag that is no reference.
        """
        context = self._contexts.get(tag >> CONTEXT_SHIFT)
        return None if context is None else self.words(context.text, context.modal)

    def zero(self, tag: int) -> Zero | None:
        """Return where program zero lies with the block of a tag, None where that is not known."""
        context = self._contexts.get(tag >> CONTEXT_SHIFT)
        if context is None:
            return None
        modal = context.modal
        inch = bool(np.frombuffer(modal.whole, np.int64)[INCH])
        return Zero(tuple(np.frombuffer(modal.offset).tolist()), modal.work, inch)

    def depth(self, tag: int) -> int:
        """Return how many calls led to the block of a tag."""
        context = self._contexts.get(tag >> CONTEXT_SHIFT)
        return 0 if context is None else len(context.stack)

    def tool(self, tag: int) -> int:
        """Return the tool in the spindle with the block of a tag, 0 where that is not known."""
        context = self._contexts.get(tag >> CONTEXT_SHIFT)
        return 0 if context is None else context.modal.tool

    def motion(self, tag: int) -> Action | None:
        """Return what the block of a tag moves by: the drilling cycle that is on, or the latest motion word."""
        context = self._contexts.get(tag >> CONTEXT_SHIFT)
        if context is None:
            return None
        if context.modal.cycle:
            return Action[context.modal.cycle.upper()]
        motion = float(context.modal.whole[MOTION])
        if context.begin is not None:
            replay = self._replay(context, context.begin)
            motion = latest(replay.motion, bisect_right(replay.lines, tag & LINE_MASK) - 1, motion)
        return _MOTIONS.get(int(motion))

    def motions(self, tags: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
        """Return what `motion` says of each of some tags, which have one context; 0 for nothing."""
        context = self._contexts.get(int(tags[0]) >> CONTEXT_SHIFT)
        if context is None or context.modal.cycle or context.begin is None:
            return np.full(len(tags), self.motion(int(tags[0])) or 0, np.int64)
        # Of a long program each run is asked about once or twice: what is not known yet is not kept either.
        replay = context.replay or self._read_run(context.text, context.begin)
        blocks, motions = replay.motion
        block = np.searchsorted(np.array(replay.lines, np.int64), tags & LINE_MASK, side="right") - 1
        said = np.searchsorted(np.array(blocks, np.int64), block, side="right")
        found = [float(context.modal.whole[MOTION]), *motions]
        actions = np.array([_MOTIONS.get(int(motion), 0) for motion in found], np.int64)
        return actions[said]

    def laser(self, tags: npt.NDArray[np.int64]) -> npt.NDArray[np.float64]:
        """Return S, direction (M3 1, M4 -1) and programmed feed (mm/s) with the blocks of some tags [tags, 3].

        The tags have one context; all are 0 where that is not known.
        """
        context = self._contexts.get(int(tags[0]) >> CONTEXT_SHIFT)
        found = np.zeros((len(tags), 3))
        if context is None:
            return found
        modal = context.modal
        inch = bool(np.frombuffer(modal.whole, np.int64)[INCH])
        found[:] = modal.spindle.speed, modal.spindle.direction, modal.feed
        if context.begin is not None:
            replay = context.replay or self._read_run(context.text, context.begin)
            block = np.searchsorted(np.array(replay.lines, np.int64), tags & LINE_MASK, side="right") - 1
            for column, said in enumerate((replay.speed, replay.direction, replay.feed)):
                latest = np.searchsorted(np.array(said[0], np.int64), block, side="right")
                found[:, column] = np.concatenate((found[:1, column], said[1]))[latest]
        found[:, 2] *= (MM_PER_INCH if inch else 1.0) / 60.0
        return found

    def spindle_turns(self, tags: npt.NDArray[np.int64]) -> npt.NDArray[np.float64]:
        """Return S with the blocks of some tags, which have one context: below zero with M4, 0 where it is at rest.

        A spindle that was started without S counts as 1, with S0 it is at rest.
        """
        context = self._contexts.get(int(tags[0]) >> CONTEXT_SHIFT)
        if context is None:
            return np.zeros(len(tags))
        spindle = context.modal.spindle
        if not context.speaks:
            return np.full(len(tags), (spindle.speed if spindle.speed_said else 1.0) * spindle.direction)
        speed, direction = self.laser(tags)[:, :2].T
        if not spindle.speed_said and context.begin is not None:
            said = self._replay(context, context.begin)
            first = said.lines[said.speed[0][0]] if said.speed[0] else None
            speed = (
                np.where((tags & LINE_MASK) < first, 1.0, speed) if first is not None else np.ones(len(tags))
            )
        return np.asarray(speed * direction, np.float64)

    def surface_clamp(self, tag: int) -> float | None:
        """Return how fast the spindle may turn where S is a surface speed (m/min), None where it is not."""
        context = self._contexts.get(tag >> CONTEXT_SHIFT)
        spindle = None if context is None else context.modal.spindle
        return spindle.clamp if spindle is not None and spindle.surface_speed else None

    def source(self, tag: int) -> ProgramText | None:
        """Return the text that the block of a tag stands in."""
        context = self._contexts.get(tag >> CONTEXT_SHIFT)
        return None if context is None else context.text

    def program(self, tag: int) -> str | None:
        """Return the name of the program that a tag refers to."""
        context = self._contexts.get(tag >> CONTEXT_SHIFT)
        return None if context is None else context.text.name

    def programs(self, tag: int) -> tuple[str, ...]:
        """Return the names of the program that a tag refers to, and of those that led there by calls."""
        context = self._contexts.get(tag >> CONTEXT_SHIFT)
        return () if context is None else (context.text.name, *(call.program for call in context.stack))

    def snapshot(self) -> SavedRecords:
        """Return all contexts, to go back to."""
        contexts = {number: context.key() for number, context in self._contexts.items()}
        return SavedRecords(contexts, self._next, self._enough)

    def restore(self, saved: SavedRecords) -> None:
        """Go back to a snapshot."""
        # Whether a run speaks is asked to save time: what is not known is looked up in its text.
        self._contexts = {
            number: _Context(*key, speaks=key[-1] is not None) for number, key in saved.contexts.items()
        }
        self._next, self._enough = saved.next, saved.enough
        self._read.clear()
        self._known = {key: number for number, key in saved.contexts.items()}
        self._last = None, 0

    # ------------------------------------------------------------------ keeping few of them

    @property
    def crowded(self) -> bool:
        """Whether it is time to ask which contexts are still needed."""
        return len(self._contexts) > self._enough

    def keep(self, tags: Iterable[int]) -> None:
        """Drop every context that none of these tags refers to."""
        needed = {tag >> CONTEXT_SHIFT for tag in tags}
        self._read.clear()
        self._contexts = {n: context for n, context in self._contexts.items() if n in needed}
        self._known = {key: n for key, n in self._known.items() if n in needed}
        self._last = None, 0
        self._enough = max(_FEW, 2 * len(self._contexts))

    def _base(self, key: _Key) -> int:
        if key == self._last[0]:
            return self._last[1]
        number = self._known.get(key)
        if number is None:
            number = self._next
            while number in self._contexts:
                number = number % (_CONTEXTS - 1) + 1
            self._next = number % (_CONTEXTS - 1) + 1
            self._contexts[number] = _Context(*key)
            self._known[key] = number
        self._last = key, number << CONTEXT_SHIFT
        return self._last[1]

    # ------------------------------------------------------------------ modal words

    def _words(self, context: _Context, line: int) -> ModalWords:
        modal = context.modal
        whole: list[int] = np.frombuffer(modal.whole, np.int64).tolist()
        feed, spindle, m = modal.feed, modal.spindle, modal.m_codes
        next_tool, d = modal.selected_tool, modal.compensation_tool
        if context.begin is not None:
            replay = self._replay(context, context.begin)
            block = bisect_right(replay.lines, line) - 1
            whole[MOTION] = int(latest(replay.motion, block, whole[MOTION]))
            whole[ABSOLUTE] = int(latest(replay.absolute, block, whole[ABSOLUTE]))
            feed = latest(replay.feed, block, feed)
            spindle = replace(spindle, speed=latest(replay.speed, block, spindle.speed))
            next_tool = int(latest(replay.next_tool, block, next_tool))
            if (said := latest(replay.d, block, -1.0)) >= 0.0:
                d = int(said)
            if (said := latest(replay.m, block, -1.0)) >= 0.0:
                m = (int(said),)
            turns = int(latest(replay.direction, block, float(spindle.direction)))
            switched = replay.coolant[1][: bisect_right(replay.coolant[0], block)]
            coolant = coolant_after(spindle.coolant, switched, self._tables.m_sense)
            spindle = replace(spindle, direction=turns, coolant=coolant)
        g = {action.group: code for action in _actions(modal, whole) if (code := self._codes.get(action))}
        if name := next((name for name in modal.work if name), ""):
            g[Group.WORK_OFFSET] = name
        return ModalWords(
            g=g,
            feed=feed,
            speed=spindle.speed,
            spindle_direction=spindle.direction,
            tool=modal.tool,
            next_tool=next_tool,
            d=d,
            h=modal.length_tool,
            m=m,
            inch=bool(whole[INCH]),
            zero=tuple(np.frombuffer(modal.offset).tolist()),
            work=modal.work,
            placement=modal.placement,
            shifts=modal.shifts,
            spindle_oriented=spindle.oriented,
            coolant=spindle.coolant,
        )

    def _replay(self, context: _Context, begin: RunBegin) -> Replay:
        if context.replay is None:
            context.replay = self._read_run(context.text, begin)
        return context.replay

    def _read_run(self, text: ProgramText, begin: RunBegin) -> Replay:
        columns = word_columns(self._columns)
        rules = self._rules if begin.feeds is None else self._rules._replace(open_words=True)
        scan(text.data, begin.offset, begin.line, rules, columns)
        return replay_of(columns, self._tables, text, begin.feeds, laser=self._laser)


def _codes(dialect: Dialect) -> dict[Action, str]:
    """Return the G code of every action of a dialect; the first that it names."""
    codes: dict[Action, str] = {}
    for code, name in dialect.g.items():
        codes.setdefault(Action[name.upper()], f"G{code}")
    return codes


def _stopping(whole: list[int]) -> Action:
    if whole[EXACT_STOP]:
        return Action.EXACT_STOP
    return Action.EXACT_PATH if whole[EXACT_PATH] else Action.CONTINUOUS


def _actions(modal: ModalSnapshot, whole: list[int]) -> list[Action]:
    """Return what is in force, one action of every modal group."""
    values = {
        Group.PLANE: whole[PLANE],
        Group.UNITS: whole[INCH],
        Group.DISTANCE: whole[ABSOLUTE],
        Group.ARC_DISTANCE: whole[ARC_ABSOLUTE],
        Group.FEED_MODE: whole[FEED_MODE],
        Group.SPINDLE_MODE: int(modal.spindle.surface_speed),
        Group.RADIUS_COMPENSATION: modal.side,
        Group.LENGTH_COMPENSATION: modal.length_sign,
        Group.RETRACT: int(modal.retract_to_initial),
    }
    found = [*(IN_FORCE[each] for each in values.items()), _stopping(whole)]
    if modal.cycle:
        found.append(Action[modal.cycle.upper()])
    else:
        found.append(Action.CYCLE_CANCEL)
        if whole[MOTION] in _MOTIONS:
            found.append(_MOTIONS[whole[MOTION]])
    return found
