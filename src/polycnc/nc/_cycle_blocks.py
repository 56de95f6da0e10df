"""Drilling cycle blocks: words into levels, the expansion of `_cycles` into moves and waits."""

from __future__ import annotations

from dataclasses import dataclass

from polycnc.nc._channel_state import ChannelState
from polycnc.nc._cycles import (
    CYCLES,
    CycleError,
    CyclePlace,
    CycleStep,
    CycleWords,
    Spindle,
    StepKind,
    expand_cycle,
)
from polycnc.nc._dialect import Dialect
from polycnc.nc._modal import ABSOLUTE, AXIS_P, AXIS_Q, AXIS_R, NO_AXIS
from polycnc.nc._motion import MotionBuilder
from polycnc.nc._moves import Feed, Line, Point, QueueItem, Wait
from polycnc.nc._words import BlockWords, Fail, GWord, dwell_seconds

_SPINDLES: dict[int, Spindle] = {1: "forward", -1: "reverse", 0: "stopped"}
_TURN = {1: "M3", -1: "M4"}


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

    def select(self, g: GWord) -> None:
        """Take over a word of the motion group: a cycle begins, any other motion ends it."""
        cycle = self.state.cycle
        action = g.action.name.lower()
        if action not in CYCLES:
            cycle.action = ""
            cycle.words = CycleWords()
            return
        if not cycle.action:
            axis = int(self.state.modal.whole[AXIS_R])
            cycle.initial = float(self.state.modal.position[axis]) if axis != NO_AXIS else 0.0
        cycle.action = action

    def expand(self, words: BlockWords, line: int) -> list[QueueItem]:
        """Return the moves of a block with an active cycle; none if it has no position or cycle word.

        Raises:
            ProgramError: a word is missing or does not make sense, a limit would be passed.
        """
        whole = self.state.modal.whole
        axes = (int(whole[AXIS_P]), int(whole[AXIS_Q]), int(whole[AXIS_R]))
        if NO_AXIS in axes:
            raise self.fail(
                "a drilling cycle in a plane that this machine lacks",
                "Select a plane with G17, G18 or G19.",
                None,
            )
        named = {axis for axis in range(len(self.state.machine.axes)) if self._name(axis) in words.by_letter}
        programmed = self._words(words, axes)
        if not named and programmed == CycleWords():
            return []
        cycle = self.state.cycle
        cycle.words = cycle.words.then(programmed)
        values = self.motion.axis_words(words)
        values.pop(axes[2], None)
        start = self.motion.start
        hole = self.motion.target(values)
        incremental = not whole[ABSOLUTE]
        spindle = self.state.spindle
        place = CyclePlace(
            hole_mm=(hole[axes[0]], hole[axes[1]]),
            initial_mm=cycle.initial,
            level_mm=start[axes[2]],
            retract="initial" if cycle.retract_to_initial else "r",
            increment_mm=(hole[axes[0]] - start[axes[0]], hole[axes[1]] - start[axes[1]])
            if incremental
            else (0.0, 0.0),
            spindle=_SPINDLES[spindle.direction],
            spindle_rpm=spindle.speed,
        )
        try:
            steps = expand_cycle(cycle.action, cycle.words, place, self.dialect.cycle_settings())
        except CycleError as error:
            raise self.fail(error.what, error.hint, None) from None
        return self._items(steps, start, hole, axes, line)

    def _name(self, axis: int) -> str:
        return self.state.machine.axes[axis].name

    def _words(self, words: BlockWords, axes: tuple[int, int, int]) -> CycleWords:
        modal = self.state.modal
        cycle = self.state.cycle
        scale = float(modal.scale[axes[2]])
        offset = float(modal.offset[axes[2]])
        absolute = bool(modal.whole[ABSOLUTE])

        def length(letter: str) -> float | None:
            value = words.value(letter)
            return None if value is None else value * scale

        retract, depth = length("R"), length(self._name(axes[2]))
        if absolute:
            retract = None if retract is None else retract + offset
            depth = None if depth is None else depth + offset
        else:
            retract = None if retract is None else cycle.initial + retract
            r_level = retract if retract is not None else cycle.words.retract_mm
            if depth is not None and r_level is not None:
                depth += r_level
        dwell = words.take("P")
        shift_p, shift_q = length("I"), length("J")
        back = length("K")
        repeats = words.take("L")
        if repeats is not None and (repeats.value < 0 or repeats.value != int(repeats.value)):
            raise self.fail("the number of repetitions L is not a whole number", "Write L1, L2, ...", repeats)
        return CycleWords(
            depth_mm=depth,
            retract_mm=retract,
            peck_mm=length("Q"),
            dwell_s=None if dwell is None else dwell_seconds(dwell, self.dialect.dwell.get("P", "s")),
            shift_mm=None if shift_p is None and shift_q is None else (shift_p or 0.0, shift_q or 0.0),
            back_mm=None if back is None else back + (offset if absolute else depth or 0.0),
            repeats=1 if repeats is None else int(repeats.value),
        )

    def _items(
        self, steps: list[CycleStep], start: Point, hole: Point, axes: tuple[int, int, int], line: int
    ) -> list[QueueItem]:
        items: list[QueueItem] = []
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
                    at[axes[2]] = step.level_mm
                    items.append(self._line(before, tuple(at), True, line))
                case StepKind.FEED_AXIS:
                    at[axes[2]] = step.level_mm
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
        direction = self.state.spindle.direction
        return {
            StepKind.SPINDLE_STOP: "M5",
            StepKind.SPINDLE_START: _TURN.get(direction, "M5"),
            StepKind.SPINDLE_REVERSE: _TURN.get(-direction, "M5"),
            StepKind.SPINDLE_ORIENT: "M19",
            StepKind.PROGRAM_STOP: "M0",
        }.get(kind, "")
