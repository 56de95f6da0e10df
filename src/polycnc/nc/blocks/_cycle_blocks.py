"""Drilling cycle blocks: words into levels, the expansion of `_cycles` into moves and waits.

Levels are those of the program, without work offset and tool length, until they become moves: so the stored words
of a cycle follow a new work offset, and errors name the numbers that were written.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from polycnc.nc.blocks._auxiliary import whole_number
from polycnc.nc.blocks._channel_state import ChannelState, Cycle
from polycnc.nc.blocks._cycles import (
    SHIFTING,
    TAPPING,
    CycleError,
    CyclePlace,
    CycleStep,
    CycleWords,
    Spindle,
    StepKind,
    expand_cycle,
)
from polycnc.nc.blocks._motion import MotionBuilder
from polycnc.nc.blocks._moves import Feed, Line, Point, QueueItem, Wait
from polycnc.nc.blocks._words import BlockWords, Fail, GWord, dwell_seconds
from polycnc.nc.dialect._dialect import Dialect
from polycnc.nc.modal._modal import (
    ABSOLUTE,
    AXIS_P,
    AXIS_Q,
    AXIS_R,
    FEED,
    FEED_INVERSE_TIME,
    FEED_MODE,
    FEED_PER_REVOLUTION,
    NO_AXIS,
    PLANE,
    PLANE_LETTERS,
)
from polycnc.nc.text._scan_plain import Word

_SPINDLES: dict[int, Spindle] = {1: "forward", -1: "reverse", 0: "stopped"}
_TURN = {1: "M3", -1: "M4"}
MOST_HOLES = 9999
_BACK_BORE = "cycle_back_bore"
# The words that most errors of a cycle are about.
_TROUBLE_LETTERS = {
    "upwards": "RZ",
    "peck": "Q",
    "back": "K",
    "dwell": "P",
}


@dataclass
class CycleBlocks:
    """Expand the blocks of the active drilling cycle."""

    state: ChannelState
    dialect: Dialect
    motion: MotionBuilder
    fail: Fail

    @property
    def active(self) -> bool:
        """Whether a cycle is active: every block with a position drills."""
        return bool(self.state.cycle.action)

    def begin(self, g: GWord) -> None:
        """Begin the cycle of a G word; the words of a cycle that was active stay in force."""
        cycle = self.state.cycle
        initial = cycle.initial
        if not cycle.action:
            axis = int(self.state.modal.whole[AXIS_R])
            initial = float(self.state.modal.position[axis]) if axis != NO_AXIS else 0.0
        self.state.cycle = replace(cycle, action=g.action.name.lower(), code=g.word.value, initial=initial)

    def cancel(self) -> None:
        """Leave the cycle and forget its words."""
        if self.active:
            self.state.cycle = Cycle(retract_to_initial=self.state.cycle.retract_to_initial)
            self.state.rigid_tap = False

    def expand(self, words: BlockWords, line: int) -> list[QueueItem]:
        """Return the moves of a block with an active cycle; none if it has no position.

        Raises:
            ProgramError: a word is missing or does not make sense, a limit would be passed.
        """
        whole = self.state.modal.whole
        axes = (int(whole[AXIS_P]), int(whole[AXIS_Q]), int(whole[AXIS_R]))
        code = f"G{self.state.cycle.code:g}"
        if NO_AXIS in axes:
            letters = PLANE_LETTERS[int(whole[PLANE])]
            raise self.fail(
                f"{code} needs the axes {', '.join(letters)} here, and the machine lacks one of them",
                "Select a plane of the machine's axes with G17, G18 or G19.",
                self.motion.place(),
            )
        drills = "R" in words.by_letter or any(name in words.by_letter for name in self.state.axis_names)
        self.state.cycle = replace(
            self.state.cycle, words=self.state.cycle.words.then(self._words(words, axes))
        )
        cycle = self.state.cycle
        if not drills:
            return []
        if self.state.side:
            raise self.fail(
                f"{code} while radius compensation is active",
                "Cancel it with G40 first.",
                self.motion.place(),
            )
        if whole[FEED_MODE] == FEED_INVERSE_TIME:
            raise self.fail(
                f"{code} with inverse time feed (G93)", "Select G94 or G95 first.", self.motion.place()
            )
        frame = self.state.frame
        if frame.factor(axes[2]) != 1.0:
            raise self.fail(
                f"{code} with a scaled or mirrored drilling axis is not supported yet",
                "Scale the axes of the plane only (I, J).",
                self.motion.place(),
            )
        if frame.active and not whole[ABSOLUTE] and cycle.words.repeats > 1:
            raise self.fail(
                f"{code}: a row of holes on a turned, scaled or polar frame is not supported yet",
                "Write each hole in a block of its own.",
                self.motion.place(),
            )
        values = self.motion.axis_words()
        start = self.motion.start
        hole = self.motion.target(values)
        incremental = not whole[ABSOLUTE]
        spindle = self.state.spindle
        rigid = self._is_rigid
        direction = TAPPING[cycle.action] * (spindle.speed > 0.0) if rigid else spindle.direction
        offset = float(self.state.modal.offset[axes[2]])
        place = CyclePlace(
            hole_mm=(hole[axes[0]], hole[axes[1]]),
            initial_mm=cycle.initial - offset,
            level_mm=start[axes[2]] - offset,
            retract="initial" if cycle.retract_to_initial else "r",
            increment_mm=(hole[axes[0]] - start[axes[0]], hole[axes[1]] - start[axes[1]])
            if incremental
            else (0.0, 0.0),
            spindle=_SPINDLES[direction],
            spindle_rpm=self.motion.rpm(start, start),
            rigid=rigid,
        )
        try:
            settings = self.dialect.cycle_settings()
            steps = expand_cycle(cycle.action, self._with_pitch(cycle), place, settings, code=code)
        except CycleError as error:
            at = words.first(*_TROUBLE_LETTERS.get(error.reason, "")) or self.motion.place()
            raise self.fail(error.what, error.hint, at) from None
        return self._items(steps, start, hole, axes, line) if steps else []

    @property
    def _is_rigid(self) -> bool:
        """Whether the active cycle is a tapping cycle that turns the spindle itself."""
        rigid = self.state.rigid_tap or self.dialect.cycles.rigid_tap
        return rigid and self.state.cycle.action in TAPPING

    def _with_pitch(self, cycle: Cycle) -> CycleWords:
        """Return the words of a cycle; with feed per revolution the feed is the pitch of a thread."""
        modal = self.state.modal
        if cycle.action in TAPPING and modal.whole[FEED_MODE] == FEED_PER_REVOLUTION:
            return replace(cycle.words, pitch_mm=float(modal.real[FEED]))
        return cycle.words

    def _words(self, words: BlockWords, axes: tuple[int, int, int]) -> CycleWords:
        modal = self.state.modal
        cycle = self.state.cycle
        scale = float(modal.scale[axes[2]])
        is_back_bore = cycle.action == _BACK_BORE

        def length(letter: str) -> float | None:
            value = words.length(letter)
            return None if value is None else value * scale

        retract = None if "R" in self.state.axis_names else length("R")
        depth = length(self.state.axis_names[axes[2]])
        back = length("K") if is_back_bore else None
        if not modal.whole[ABSOLUTE]:
            initial = cycle.initial - float(modal.offset[axes[2]])
            retract = None if retract is None else initial + retract
            r_level = retract if retract is not None else cycle.words.retract_mm
            if depth is not None and r_level is not None:
                depth += r_level
            bottom = depth if depth is not None else cycle.words.depth_mm
            if back is not None and bottom is not None:
                back += bottom
        dwell = words.take("P")
        shift_p, shift_q = (length("I"), length("J")) if cycle.action in SHIFTING else (None, None)
        return CycleWords(
            depth_mm=depth,
            retract_mm=retract,
            peck_mm=length("Q"),
            dwell_s=None if dwell is None else dwell_seconds(dwell, self.dialect.dwell.get("P", "s")),
            shift_mm=None if shift_p is None and shift_q is None else (shift_p or 0.0, shift_q or 0.0),
            back_mm=back,
            repeats=self._repeats(words, is_back_bore),
        )

    def _repeats(self, words: BlockWords, is_back_bore: bool) -> int:
        """Take L, or K where it is no level: how many holes."""
        letters = [each for each in self.dialect.cycles.repeats if not (each == "K" and is_back_bore)]
        found: list[Word] = [word for each in letters if (word := words.take(each))]
        if len(found) > 1:
            raise self.fail("L and K both say how many holes to drill", "Write one of them.", found[1])
        return whole_number(found[0], "a number of holes", self.fail, MOST_HOLES) if found else 1

    def _items(
        self, steps: list[CycleStep], start: Point, hole: Point, axes: tuple[int, int, int], line: int
    ) -> list[QueueItem]:
        items: list[QueueItem] = []
        offset = float(self.state.modal.offset[axes[2]])
        at = list(start)
        for index, value in enumerate(hole):
            if index not in axes and value != at[index]:
                before, at[index] = tuple(at), value
                items.append(self._line(before, tuple(at), True, line))
        for step in steps:
            before = tuple(at)
            match step.kind:
                case StepKind.RAPID_PLANE:
                    at[axes[0]], at[axes[1]] = step.first_mm, step.second_mm
                    items.append(self._line(before, tuple(at), True, line))
                case StepKind.RAPID_AXIS:
                    at[axes[2]] = step.level_mm + offset
                    items.append(self._line(before, tuple(at), True, line))
                case StepKind.FEED_AXIS:
                    at[axes[2]] = step.level_mm + offset
                    items.append(self._line(before, tuple(at), False, line, step.feed_mm_s))
                case StepKind.DWELL:
                    items.append(Wait(step.duration_s, line))
                case _:
                    event = self._event(step.kind)
                    if event:
                        items.append(Wait(0.0, line, (event,)))
        return items

    def _line(self, start: Point, end: Point, rapid: bool, line: int, feed_mm_s: float = 0.0) -> Line:
        self.motion.check_limits(end)
        if rapid:
            return Line(start, end, Feed(), True, True, line)
        feed = Feed(speed_mm_s=feed_mm_s) if feed_mm_s > 0.0 else self.motion.feed(start, end)
        return Line(start, end, feed, False, True, line)

    def _event(self, kind: StepKind) -> str:
        """Return the auxiliary function of a step as a program would write it; overrides have none."""
        rigid = self._is_rigid
        direction = TAPPING[self.state.cycle.action] if rigid else self.state.spindle.direction
        return {
            StepKind.SPINDLE_STOP: "M5",
            StepKind.SPINDLE_START: _TURN.get(direction, "M5"),
            StepKind.SPINDLE_REVERSE: _TURN.get(-direction, "M5"),
            StepKind.SPINDLE_ORIENT: "M19",
            StepKind.PROGRAM_STOP: "M0",
        }.get(kind, "")
