"""Motion blocks: end points, straight lines, arcs, and the limits they must keep."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from itertools import pairwise

from polycnc.machine import LONGEST_BLOCK_S
from polycnc.nc.blocks._arcs import (
    ARC_NO_RADIUS,
    ARC_OFF_CIRCLE,
    ARC_OK,
    ARC_RADIUS_AT_SAME_POINT,
    ARC_RADIUS_TOO_SMALL,
    ARC_TOO_LARGE,
    TWO_PI,
    arc_by_center,
    arc_by_radius,
    arc_extents,
)
from polycnc.nc.blocks._channel_state import ChannelState
from polycnc.nc.blocks._compensation import CompensationError
from polycnc.nc.blocks._messages import Messages
from polycnc.nc.blocks._moves import Arc, Feed, Line, Move, Point, QueueItem, Spline, Wait
from polycnc.nc.blocks._words import BlockWords, Fail, code_text
from polycnc.nc.dialect._dialect import Dialect
from polycnc.nc.modal._actions import Group
from polycnc.nc.modal._frame import Polar
from polycnc.nc.modal._modal import (
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
    FEED_NUMBER,
    FEED_PER_REVOLUTION,
    LARGEST,
    MODULO_AXIS,
    MOTION_ARC_CW,
    MOTION_RAPID,
    NO_AXIS,
    PLANE,
    PLANE_LETTERS,
    RAPID_STOP,
    STOPS_SUPPRESSED,
    length_scale,
    short_way,
)
from polycnc.nc.text._scan_plain import Word
from polycnc.units import SECONDS_PER_MINUTE

LIMIT_ROUNDING = 1e-6
"""A position this little past a soft limit (mm or degree) is one on it, reached by rounding."""

_SECONDS_PER_DAY = 86_400.0
_SECONDS_PER_YEAR = 365.25 * _SECONDS_PER_DAY
_TOO_LONG = "the block would take {}"
_LONGEST_DAYS = LONGEST_BLOCK_S / _SECONDS_PER_DAY
_TOO_LONG_HINT = f"No block may take longer than {_LONGEST_DAYS:.0f} days: check the feed and the way."

_ARC_TROUBLE = {
    ARC_NO_RADIUS: (
        "the arc has no radius",
        "Give the way from the start to the centre (I J K), or a radius R that is not 0.",
    ),
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
        "Check the end point and the centre (I J K); the dialect's [arcs] says how much is tolerated.",
    ),
    ARC_TOO_LARGE: ("the radius of the arc is larger than any machine", "Check R, or I J K."),
}


@dataclass
class MotionBuilder:
    """Turn the words of a motion block into moves, by the modal state."""

    state: ChannelState
    dialect: Dialect
    messages: Messages
    fail: Fail
    exact_stop_block: bool = False
    words: BlockWords = field(default_factory=BlockWords)

    def __post_init__(self) -> None:
        self._low = self.state.modal.low.tolist()
        self._high = self.state.modal.high.tolist()
        names = self.state.axis_names
        # Addresses of ways: without meaning where the machine has such an axis, or lacks the one they stand for.
        self._ways = [
            (letter, name)
            for letter, name in self.dialect.incremental.items()
            if letter not in names and name in names
        ]
        self._modulo = [int(kind) == MODULO_AXIS for kind in self.state.modal.rotary]

    def begin(self, words: BlockWords) -> None:
        """Begin a block with these words."""
        self.words = words
        self.exact_stop_block = Group.EXACT_STOP_BLOCK in words.g

    def axis_words(self) -> dict[int, float]:
        """Take the axis words of the block: axis index -> value in mm or degree, not placed yet."""
        found = {}
        by_letter = self.words.by_letter
        modal = self.state.modal
        for index, name in enumerate(self.state.axis_names):
            if name in by_letter:
                value = self.words.length(name)
                if value is not None:
                    found[index] = value * float(modal.scale[index])
        for letter, name in self._ways:
            if letter in by_letter and (value := self.words.length(letter)) is not None:
                index = self.state.axis_names.index(name)
                if index in found:
                    raise self.fail(
                        f"{letter} and {name} both say where {name} goes",
                        "Write one of them.",
                        by_letter[letter],
                    )
                here = float(modal.position[index] - modal.offset[index])
                found[index] = here + value * float(modal.scale[index])
        return found

    def is_diameter(self, axis: int) -> bool:
        """Tell whether words of a linear axis are diameters."""
        return float(self.state.modal.scale[axis]) < 0.75 * length_scale(self.state.modal)

    def axis_word_left(self) -> bool:
        """Tell whether there is an axis word that nothing has taken."""
        names = (*self.state.axis_names, *(letter for letter, _ in self._ways))
        return any(letter in names for letter, _ in self.words.unused())

    def target(self, axis_values: dict[int, float], machine_coordinates: bool = False) -> Point:
        """Return the machine position that axis words ask for; axes without a word stay."""
        modal = self.state.modal
        point: list[float] = modal.position.tolist()
        absolute = bool(modal.whole[ABSOLUTE])
        if self.state.frame.active and not machine_coordinates and axis_values:
            return self._framed_target(axis_values, absolute)
        for index, value in axis_values.items():
            if machine_coordinates:
                point[index] = self.turned(index, value, point[index])
            elif absolute:
                point[index] = self.turned(index, value + float(modal.offset[index]), point[index])
            else:
                point[index] += value
        return tuple(point)

    def _framed_target(self, axis_values: dict[int, float], absolute: bool) -> Point:
        """Return the same where positions are turned, scaled, mirrored or polar."""
        modal = self.state.modal
        frame = self.state.frame
        point: list[float] = modal.position.tolist()
        offset: list[float] = modal.offset.tolist()
        programmed = frame.back([a - b for a, b in zip(point, offset, strict=True)])
        changed = set(axis_values)
        plane = int(modal.whole[AXIS_P]), int(modal.whole[AXIS_Q])
        if frame.polar is not None and NO_AXIS not in plane and changed & set(plane):
            polar = self._polar(frame.polar, axis_values, programmed, absolute)
            self.state.frame = replace(frame, polar=polar)
            programmed[plane[0]], programmed[plane[1]] = polar.point()
            changed |= set(plane)
            others = {axis: value for axis, value in axis_values.items() if axis not in plane}
        else:
            others = axis_values
        for axis, value in others.items():
            programmed[axis] = value if absolute else programmed[axis] + value
        for turn in (frame.rotation, frame.outer):
            if turn is not None and changed & {turn.p, turn.q}:
                changed |= {turn.p, turn.q}
        found = frame.forward(programmed)
        for axis in changed:
            wanted = found[axis] + offset[axis]
            point[axis] = self.turned(axis, wanted, point[axis]) if absolute else wanted
        return tuple(point)

    def _polar(
        self, polar: Polar, axis_values: dict[int, float], programmed: list[float], absolute: bool
    ) -> Polar:
        modal = self.state.modal
        p, q = int(modal.whole[AXIS_P]), int(modal.whole[AXIS_Q])
        if p in axis_values:
            center = (0.0, 0.0) if absolute else (programmed[p], programmed[q])
            polar = replace(polar, center=center, radius=axis_values[p])
        if q in axis_values:
            angle = axis_values[q] / float(modal.scale[q])  # degrees, whatever the unit of lengths
            polar = replace(polar, angle_deg=angle if absolute else polar.angle_deg + angle)
        return polar

    def turned(self, axis: int, wanted: float, position: float) -> float:
        """Return where an axis goes for position `wanted`: the short way if positions repeat."""
        if self._modulo[axis] and abs(wanted) <= LARGEST:
            return short_way(wanted, position)
        return wanted

    def check_limits(self, point: Point, what: str = "would go to") -> None:
        """Refuse a point outside the soft limits.

        With radius compensation it is the compensated path that counts in the plane, see `check_path`.

        Raises:
            ProgramError: names the axis, the position and the limit.
        """
        whole = self.state.modal.whole
        compensated = self.state.side != 0 or self.state.compensation.active
        later = (int(whole[AXIS_P]), int(whole[AXIS_Q])) if compensated else ()
        if trouble := self._limit_trouble(point, what, later):
            index, text, hint = trouble
            axis = self.state.axis_names[index]
            error = self.fail(text, hint, self.words.first(axis))
            error.limit = axis, point[index] > self._high[index]
            raise error

    def check_path(self, item: Move) -> None:
        """Refuse a compensated move that leaves the soft limits.

        Raises:
            CompensationError: names the axis, the position and the limit.
        """
        time_s = self._least_time_s(item)
        if not time_s <= LONGEST_BLOCK_S:
            what = _TOO_LONG.format(_duration_text(time_s))
            raise CompensationError(
                f"with radius compensation {what}", reason="time", line=item.line, hint=_TOO_LONG_HINT
            )
        for point, what in _points(item):
            if trouble := self._limit_trouble(point, what):
                _, text, hint = trouble
                raise CompensationError(
                    f"with radius compensation {text}", reason="limit", line=item.line, hint=hint
                )

    def check_times(self, items: Iterable[QueueItem]) -> None:
        """Refuse a move or a dwell that would take longer than anybody waits (`LONGEST_BLOCK_S`).

        Raises:
            ProgramError: says how long, and names what makes it so.
        """
        for item in items:
            time_s = self._least_time_s(item)
            if not time_s <= LONGEST_BLOCK_S:
                raise self.fail(
                    _TOO_LONG.format(_duration_text(time_s)), _TOO_LONG_HINT, self._slow_word(item)
                )

    def _least_time_s(self, item: QueueItem) -> float:
        """Return the time that an item takes at the least: at its feed, and at the speeds of the axes."""
        if isinstance(item, Wait):
            return item.duration_s
        ways = [abs(b - a) for a, b in zip(item.start, item.end, strict=True)]
        length = item.length_mm if isinstance(item, Spline) else math.hypot(*ways)
        if isinstance(item, Arc):
            p, q = item.plane[:2]
            radius = math.hypot(item.start[p] - item.center[0], item.start[q] - item.center[1])
            length = math.hypot(length, radius * item.sweep_rad)
            ways[p] = ways[q] = radius * abs(item.sweep_rad) / 2.0
        axes = max(way / axis.vmax for way, axis in zip(ways, self.state.machine.axes, strict=True))
        if isinstance(item, Line) and item.rapid:
            return axes
        if item.feed.duration_s > 0.0:
            return max(axes, item.feed.duration_s)
        return max(axes, length / item.feed.speed_mm_s) if item.feed.speed_mm_s > 0.0 else math.inf

    def _slow_word(self, item: QueueItem) -> Word | None:
        if isinstance(item, Wait):
            return self.words.first("P", "X", "U", "F")
        return self.words.first("F") or self.place()

    def _limit_trouble(
        self, point: Point, what: str, but: tuple[int, ...] = ()
    ) -> tuple[int, str, str] | None:
        """Return the axis whose limit a point passes, what is wrong and what to do; None if all is well."""
        for index, value in enumerate(point):
            low, high = self._low[index], self._high[index]
            if low - LIMIT_ROUNDING <= value <= high + LIMIT_ROUNDING or index in but:
                continue
            axis = self.state.machine.axes[index]
            limit = low if value < low else high
            if abs(limit) == LARGEST:
                text = f"axis {axis.name} {what} {value:.6g} {axis.unit}, further than any machine"
                return index, text, "Check the number."
            return (
                index,
                f"axis {axis.name} {what} {value:.3f} {axis.unit}, past its soft limit of "
                f"{limit:.3f} {axis.unit}",
                "Check the program, the work offset and the machine's soft limits (machine coordinates).",
            )
        return None

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
        return tuple(self.state.modal.position.tolist())

    @property
    def exact_stop(self) -> bool:
        """Whether the present block comes to rest at its end."""
        whole = self.state.modal.whole
        return not whole[STOPS_SUPPRESSED] and (bool(whole[EXACT_STOP]) or self.exact_stop_block)

    def place(self) -> Word | None:
        """Return the word that best shows what the block wants to move."""
        return self.words.g_word(Group.MOTION) or self.words.first(*self.state.axis_names, *"IJKR")

    def feed(self, start: Point, end: Point, straight: bool = True) -> Feed:
        """Return the feed of a move by the active feed mode.

        Raises:
            ProgramError: no feed, or feed per revolution with the spindle at rest.
        """
        modal = self.state.modal
        mode = modal.whole[FEED_MODE]
        if mode == FEED_INVERSE_TIME:
            if self.state.feed_word <= 0.0:
                raise self.fail(
                    "a feed move with inverse time (G93) needs its own F",
                    "Add F to every block with G1, G2 or G3.",
                    self.place(),
                )
            return Feed(duration_s=SECONDS_PER_MINUTE / self.state.feed_word)
        value = float(modal.real[FEED])
        if value <= 0.0:
            raise self.fail(
                "a feed move without a feed", "Program F in this or an earlier block.", self.place()
            )
        if straight and all(rotary or a == b for a, b, rotary in zip(start, end, modal.rotary, strict=True)):
            value = float(modal.real[FEED_NUMBER])  # only rotary axes move: the feed is in degrees
        if mode == FEED_PER_REVOLUTION:
            rpm = self.rpm(start, end) if self.state.spindle.direction else 0.0
            if rpm <= 0.0:
                raise self.fail(
                    "feed per revolution (G95) with the spindle at rest",
                    "Start the spindle with S and M3 or M4 first.",
                    self.place(),
                )
            value *= rpm
        return Feed(speed_mm_s=value / SECONDS_PER_MINUTE)

    def rpm(self, start: Point, end: Point) -> float:
        """Return the spindle speed; with constant surface speed at the middle of the block's X."""
        spindle = self.state.spindle
        if not spindle.surface_speed:
            return spindle.speed
        modal = self.state.modal
        x = int(modal.letter_axis[ord("X") - ord("A")])
        # Twice the mean radius, from the axis of the workpiece: program zero.
        diameter = 0.0 if x == NO_AXIS else abs(start[x] + end[x] - 2.0 * float(modal.offset[x]))
        top = min(self.state.machine.spindle.max_rpm, spindle.clamp)
        return top if diameter <= 0.0 else min(top, spindle.speed * 1000.0 / (math.pi * diameter))

    def moves(self, end: Point, motion: int, line: int) -> list[Move]:
        """Return the moves of a G0, G1, G2 or G3 block: one, or more where the spindle's speed says so."""
        if motion >= MOTION_ARC_CW:
            return [self._arc(end, motion == MOTION_ARC_CW, line)]
        if motion == MOTION_RAPID or not self.state.spindle.surface_speed:
            return [self.line(end, motion == MOTION_RAPID, line)]
        self.check_limits(end)
        return list(self.cut(self.start, end, line))

    def cut(self, start: Point, end: Point, line: int) -> Iterator[Line]:
        """Yield a straight cut, in parts where the spindle's speed reaches its clamp on the way.

        Within a part the speed of constant surface speed is that at its middle, which takes the same time as one that
        changes all along: that grows with X.
        """
        points = [start, *self._clamp_points(start, end), end]
        last = len(points) - 2
        for number, (a, b) in enumerate(pairwise(points)):
            yield Line(a, b, self.feed(a, b), False, self.exact_stop and number == last, line)

    def _clamp_points(self, start: Point, end: Point) -> list[Point]:
        spindle, modal = self.state.spindle, self.state.modal
        x = int(modal.letter_axis[ord("X") - ord("A")])
        if not spindle.surface_speed or x == NO_AXIS or modal.whole[FEED_MODE] != FEED_PER_REVOLUTION:
            return []
        way = end[x] - start[x]
        if way == 0.0:
            return []
        top = min(self.state.machine.spindle.max_rpm, spindle.clamp)
        radius = spindle.speed * 1000.0 / (2.0 * math.pi * top)
        center = float(modal.offset[x])
        shares = sorted((center + side * radius - start[x]) / way for side in (-1.0, 1.0))
        return [
            tuple(a + share * (b - a) for a, b in zip(start, end, strict=True))
            for share in shares
            if 1e-9 < share < 1.0 - 1e-9
        ]

    def _arc(self, end: Point, clockwise: bool, line: int) -> Move:
        """Return a circular move to `end` by centre (I J K) or radius (R), or the line that stands for it.

        Raises:
            ProgramError: no centre, a centre word outside the plane, an end point off the circle, a limit.
        """
        whole = self.state.modal.whole
        p, q, r = int(whole[AXIS_P]), int(whole[AXIS_Q]), int(whole[AXIS_R])
        if NO_AXIS in (p, q):
            letters = PLANE_LETTERS[int(whole[PLANE])][:2]
            raise self.fail(
                f"an arc in the plane {letters}, which this machine does not have",
                "Select a plane of the machine's axes with G17, G18 or G19.",
                self.place(),
            )
        center = self._center_words(int(whole[PLANE]))
        radius = None if "R" in self.state.axis_names else self.words.length("R")
        if not center and radius is None:
            if self.dialect.arcs.no_center == "line":
                self.messages.add("an arc with neither centre nor radius goes straight to its end point")
                return self.line(end, False, line)
            raise self.fail(
                "an arc needs a centre or a radius",
                "Add I J K or R, or write G1 if the move is straight.",
                self.place(),
            )
        if center and radius is not None:
            raise self.fail(
                "an arc has both a radius R and a centre", "Write one of them.", self.words.first("R")
            )
        start = self.start
        frame = self.state.frame
        if frame.active:
            clockwise ^= frame.turns_over(p, q)
            if center and abs(frame.factor(p)) != abs(frame.factor(q)):
                raise self.fail(
                    "an arc with a centre between axes of different scale", "Write it with R.", self.place()
                )
            if radius is not None:
                radius *= max(abs(frame.factor(p)), abs(frame.factor(q)))
        center_p, center_q, sweep = self._circle(start, end, p, q, center, radius, clockwise)
        extra = TWO_PI * (self._turns() - 1)
        sweep = sweep - extra if clockwise else sweep + extra
        feed = self.feed(start, end, straight=False)
        arc = Arc(start, end, (center_p, center_q), sweep, (p, q, r), feed, self.exact_stop, line)
        for passed, what in _points(arc):
            self.check_limits(passed, what)
        return arc

    def _center_words(self, plane: int) -> dict[str, float]:
        """Take I J K; one that is not of the plane may stand there if it is 0."""
        center = {}
        for letter in "IJK":
            value = self.words.length(letter)
            if value is None:
                continue
            if letter in CENTER_LETTERS[plane]:
                center[letter] = value
            elif value != 0.0:
                raise self.fail(
                    f"'{letter}' is no centre word of the plane {PLANE_LETTERS[plane][:2]}",
                    f"Use {' and '.join(CENTER_LETTERS[plane])}, or select another plane (G17, G18, G19).",
                    self.words.first(letter),
                )
        return center

    def _turns(self) -> int:
        turns = self.words.value("P") if self.dialect.arcs.turns else None
        if turns is None:
            return 1
        if not turns.is_integer() or not 1 <= turns <= LARGEST:
            raise self.fail(
                f"the number of turns P{code_text(turns)} of an arc is not a whole number from 1 up",
                "Write P1, P2, ...",
                self.words.first("P"),
            )
        return int(turns)

    def _circle(
        self,
        start: Point,
        end: Point,
        p: int,
        q: int,
        center: dict[str, float],
        radius: float | None,
        clockwise: bool,
    ) -> tuple[float, float, float]:
        """Return the centre and the sweep of an arc of up to one turn."""
        modal = self.state.modal
        tolerance = float(modal.real[ARC_TOLERANCE])
        ends = start[p], start[q], end[p], end[q]
        if radius is not None:
            found = arc_by_radius(*ends, radius * length_scale(modal), clockwise, tolerance)
        else:
            letters = CENTER_LETTERS[int(modal.whole[PLANE])]
            if self.state.frame.active:
                at = self._framed_center([center.get(letter, 0.0) for letter in letters], start, p, q)
            else:
                at = [
                    self._center(axis, center.get(letter), start)
                    for axis, letter in zip((p, q), letters, strict=True)
                ]
            found = arc_by_center(*ends, at[0], at[1], clockwise, tolerance, float(modal.real[ARC_RELATIVE]))
        status, center_p, center_q, sweep, off = found
        if status != ARC_OK:
            what, hint = _ARC_TROUBLE[status]
            raise self.fail(
                what.format(off=off), hint, self.words.first(*("R" if radius is not None else "IJK"))
            )
        return center_p, center_q, sweep

    def _framed_center(self, center: list[float], start: Point, p: int, q: int) -> list[float]:
        modal = self.state.modal
        u, v = (value * length_scale(modal) for value in center)
        if not modal.whole[ARC_ABSOLUTE]:
            u, v = self.state.frame.vector(p, q, u, v)
            return [start[p] + u, start[q] + v]
        point = self.state.frame.back((modal.position - modal.offset).tolist())
        point[p], point[q] = u, v
        found = self.state.frame.forward(point)
        return [found[axis] + float(modal.offset[axis]) for axis in (p, q)]

    def _center(self, axis: int, value: float | None, start: Point) -> float:
        modal = self.state.modal
        if value is None:
            return start[axis]
        length = value * length_scale(modal)
        return length + float(modal.offset[axis]) if modal.whole[ARC_ABSOLUTE] else start[axis] + length


def _duration_text(time_s: float) -> str:
    """Return a time that nobody waits for."""
    if not time_s < math.inf:
        return "for ever"
    years = time_s / _SECONDS_PER_YEAR
    return f"{years:.3g} years" if years >= 1.0 else f"{time_s / _SECONDS_PER_DAY:.0f} days"


def _points(item: Move) -> Iterator[tuple[Point, str]]:
    """Yield the points of a move that must be inside the limits, and how it comes there."""
    yield item.end, "would go to"
    if isinstance(item, Arc):
        p, q = item.plane[:2]
        ends = item.start[p], item.start[q], item.end[p], item.end[q]
        for corner in arc_extents(*ends, *item.center, item.sweep_rad):
            point = list(item.end)
            point[p], point[q] = corner
            yield tuple(point), "would pass"
