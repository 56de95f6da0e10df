"""Motion blocks: end points, straight lines, arcs, and the limits they must keep."""

from __future__ import annotations

import math
from dataclasses import dataclass

from polycnc.nc._arcs import (
    ARC_NO_RADIUS,
    ARC_OFF_CIRCLE,
    ARC_OK,
    ARC_RADIUS_AT_SAME_POINT,
    ARC_RADIUS_TOO_SMALL,
    TWO_PI,
    arc_by_center,
    arc_by_radius,
    arc_extents,
)
from polycnc.nc._channel_state import ChannelState
from polycnc.nc._modal import (
    ABSOLUTE,
    ARC_ABSOLUTE,
    ARC_RELATIVE,
    ARC_TOLERANCE,
    AXIS_P,
    AXIS_Q,
    AXIS_R,
    CENTER_LETTERS,
    EXACT_STOP,
    FEED,
    FEED_INVERSE_TIME,
    FEED_MODE,
    FEED_PER_REVOLUTION,
    INCH,
    MOTION_ARC_CW,
    MOTION_RAPID,
    NO_AXIS,
    PLANE,
    PLANE_LETTERS,
    RAPID_STOP,
)
from polycnc.nc._moves import Arc, Feed, Line, Move, Point
from polycnc.nc._words import BlockWords, Fail
from polycnc.units import MM_PER_INCH, SECONDS_PER_MINUTE

_ARC_TROUBLE = {
    ARC_NO_RADIUS: ("the arc has no radius", "Give the centre (I J K) or a radius R that is not zero."),
    ARC_RADIUS_TOO_SMALL: (
        "the radius is {off:.6g} mm too small to reach the end point",
        "R must be at least half the distance between start and end.",
    ),
    ARC_RADIUS_AT_SAME_POINT: (
        "an arc with R ends where it starts, so its centre is unknown",
        "Write a full circle with I J K.",
    ),
    ARC_OFF_CIRCLE: (
        "the end point is {off:.6g} mm off the circle about the given centre",
        "Check I J K, or raise 'arc_tolerance_mm' of the dialect.",
    ),
}


@dataclass
class MotionBuilder:
    """Turn the words of a motion block into moves, by the modal state."""

    state: ChannelState
    fail: Fail
    exact_stop_block: bool = False

    def axis_words(self, words: BlockWords) -> dict[int, float]:
        """Take the axis words of a block: axis index -> value in program units times scale (mm or degree)."""
        found = {}
        for index, axis in enumerate(self.state.machine.axes):
            word = words.take(axis.name)
            if word is not None:
                found[index] = word.value * float(self.state.modal.scale[index])
        return found

    def target(self, axis_values: dict[int, float], machine_coordinates: bool = False) -> Point:
        """Return the machine position that axis words ask for; axes without a word stay."""
        modal = self.state.modal
        point = [float(p) for p in modal.position]
        for index, value in axis_values.items():
            if machine_coordinates:
                point[index] = value
            elif modal.whole[ABSOLUTE]:
                point[index] = value + float(modal.offset[index])
            else:
                point[index] += value
        return tuple(point)

    def check_limits(self, point: Point, what: str = "would go to") -> None:
        """Refuse a point outside the soft limits.

        Raises:
            ProgramError: names the axis, the position and the limit.
        """
        for axis, value, low, high in zip(
            self.state.machine.axes, point, self.state.modal.low, self.state.modal.high, strict=True
        ):
            if not low <= value <= high:
                limit = low if value < low else high
                raise self.fail(
                    f"axis {axis.name} {what} {value:.3f} {axis.unit}, past its soft limit of {limit:.3f} {axis.unit}",
                    "Check the program, the work offset and the machine's soft limits (machine coordinates).",
                    None,
                )

    def line(self, end: Point, rapid: bool, line: int) -> Line:
        """Return a straight move from the programmed position to `end`."""
        self.check_limits(end)
        start = self.start
        feed = Feed() if rapid else self.feed(start, end)
        stop = self.exact_stop or (rapid and bool(self.state.modal.whole[RAPID_STOP]))
        return Line(start, end, feed, rapid, stop, line)

    @property
    def start(self) -> Point:
        """The programmed position, in machine coordinates."""
        return tuple(float(p) for p in self.state.modal.position)

    @property
    def exact_stop(self) -> bool:
        """Whether the present block comes to rest at its end."""
        return bool(self.state.modal.whole[EXACT_STOP]) or self.exact_stop_block

    def feed(self, start: Point, end: Point, *, arc: bool = False) -> Feed:
        """Return the feed of a move by the active feed mode; an arc moves although it may end where it starts.

        Raises:
            ProgramError: no feed, or feed per revolution with the spindle at rest.
        """
        modal, state = self.state.modal, self.state
        mode = modal.whole[FEED_MODE]
        if mode == FEED_INVERSE_TIME:
            if state.feed_words <= 0.0:
                raise self.fail(
                    "a feed move with inverse time (G93) needs its own F",
                    "Add F to every G1, G2, G3 block.",
                    None,
                )
            return Feed(duration_s=SECONDS_PER_MINUTE / state.feed_words)
        if modal.real[FEED] <= 0.0:
            raise self.fail("a feed move without a feed", "Program F in this or an earlier block.", None)
        value = float(modal.real[FEED])
        if (
            modal.whole[INCH]
            and not arc
            and all(rotary or a == b for a, b, rotary in zip(start, end, modal.rotary, strict=True))
        ):
            value /= MM_PER_INCH  # only rotary axes move: the feed is in degrees
        if mode == FEED_PER_REVOLUTION:
            rpm = self.spindle_rpm(start, end)
            if rpm <= 0.0:
                raise self.fail(
                    "feed per revolution (G95) with the spindle at rest",
                    "Start the spindle with S and M3 or M4.",
                    None,
                )
            return Feed(speed_mm_s=value * rpm / SECONDS_PER_MINUTE)
        return Feed(speed_mm_s=value / SECONDS_PER_MINUTE)

    def spindle_rpm(self, start: Point, end: Point) -> float:
        """Return the spindle speed; with constant surface speed at the middle of the block's X."""
        spindle = self.state.spindle
        if spindle.direction == 0:
            return 0.0
        if not spindle.surface_speed:
            return spindle.speed
        x = int(self.state.modal.letter_axis[ord("X") - ord("A")])
        diameter = 0.0 if x == NO_AXIS else abs(start[x] + end[x])  # twice the mean radius
        top = self.state.machine.spindle.max_rpm
        return top if diameter <= 0.0 else min(top, spindle.speed * 1000.0 / (math.pi * diameter))

    def arc(self, words: BlockWords, end: Point, motion: int, line: int) -> Arc:
        """Return a circular move to `end` by centre (I J K) or radius (R).

        Raises:
            ProgramError: no centre, a centre word outside the plane, an end point off the circle, a soft limit.
        """
        modal = self.state.modal
        whole = modal.whole
        p, q, r = int(whole[AXIS_P]), int(whole[AXIS_Q]), int(whole[AXIS_R])
        plane = int(whole[PLANE])
        if NO_AXIS in (p, q):
            raise self.fail(
                f"an arc in plane {PLANE_LETTERS[plane][:2]}, but this machine lacks one of these axes",
                "Select a plane of the machine's axes with G17, G18 or G19.",
                None,
            )
        start = self.start
        clockwise = motion == MOTION_ARC_CW
        turns = self._turns(words)
        status, center_p, center_q, sweep, off = self._circle(
            words, start, end, p, q, plane, clockwise, turns
        )
        if status != ARC_OK:
            what, hint = _ARC_TROUBLE[status]
            raise self.fail(what.format(off=off), hint, None)
        self.check_limits(end)
        low, high = arc_extents(start[p], start[q], end[p], end[q], center_p, center_q, sweep)
        for corner in (low, high):
            point = list(end)
            point[p], point[q] = corner
            self.check_limits(tuple(point), "would pass")
        return Arc(
            start=start,
            end=end,
            center=(center_p, center_q),
            sweep_rad=sweep,
            plane=(p, q, r),
            feed=self.feed(start, end, arc=True),
            exact_stop=self.exact_stop,
            line=line,
        )

    def _turns(self, words: BlockWords) -> int:
        turns = words.value("P")
        if turns is None:
            return 1
        if turns != int(turns) or turns < 1:
            raise self.fail(
                "the number of turns P of an arc is not a whole number from 1 up",
                "Write P1, P2, ...",
                words.take("P"),
            )
        return int(turns)

    def _circle(
        self,
        words: BlockWords,
        start: Point,
        end: Point,
        p: int,
        q: int,
        plane: int,
        clockwise: bool,
        turns: int,
    ) -> tuple[int, float, float, float, float]:
        modal = self.state.modal
        tolerance = float(modal.real[ARC_TOLERANCE])
        radius = words.value("R")
        center = {}
        for letter in "IJK":
            word = words.take(letter)
            if word is None:
                continue
            if letter not in CENTER_LETTERS[plane]:
                raise self.fail(
                    f"'{letter}' is no centre word of plane {PLANE_LETTERS[plane][:2]}",
                    f"Use {' and '.join(CENTER_LETTERS[plane])}, or select another plane.",
                    word,
                )
            center[letter] = word.value
        if radius is not None:
            if center:
                raise self.fail(
                    "an arc has both a radius R and a centre", "Write one of them.", words.take("R")
                )
            status, center_p, center_q, sweep, off = arc_by_radius(
                start[p], start[q], end[p], end[q], radius * float(modal.scale[p]), clockwise, tolerance
            )
            return status, center_p, center_q, sweep + math.copysign(TWO_PI * (turns - 1), sweep), off
        if not center:
            raise self.fail("an arc needs a centre or a radius", "Add I J K or R.", None)
        at = []
        for axis, letter in zip((p, q), CENTER_LETTERS[plane], strict=True):
            value = center.get(letter)
            if modal.whole[ARC_ABSOLUTE]:
                at.append(
                    start[axis]
                    if value is None
                    else value * float(modal.scale[axis]) + float(modal.offset[axis])
                )
            else:
                at.append(start[axis] + (0.0 if value is None else value * float(modal.scale[axis])))
        return arc_by_center(
            start[p],
            start[q],
            end[p],
            end[q],
            at[0],
            at[1],
            clockwise,
            turns,
            tolerance,
            float(modal.real[ARC_RELATIVE]),
        )

    def move(self, words: BlockWords, end: Point, motion: int, line: int) -> Move:
        """Return the move of a G0, G1, G2 or G3 block."""
        if motion >= MOTION_ARC_CW:
            return self.arc(words, end, motion, line)
        return self.line(end, motion == MOTION_RAPID, line)
