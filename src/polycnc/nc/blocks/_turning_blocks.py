"""Blocks of turning and threading cycles: words into the numbers of `_turning`, its steps into moves.

P and Q of G74, G75 and G76 count increments without a point; depths, retracts and tapers are radii, allowances along X
diameters where X is one.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from polycnc.nc.blocks._auxiliary import whole_number
from polycnc.nc.blocks._channel_state import ChannelState
from polycnc.nc.blocks._motion import MotionBuilder
from polycnc.nc.blocks._moves import Arc, Feed, Line, QueueItem
from polycnc.nc.blocks._moves import Point as AxisPoint
from polycnc.nc.blocks._turning import (
    MOST_PASSES,
    SAME_MM,
    Pecking,
    Piece,
    Point,
    Roughing,
    Step,
    Threading,
    TurningError,
    box,
    exchanged,
    peck,
    repeat,
    rough,
    threads,
)
from polycnc.nc.blocks._turning_pockets import rough_pockets
from polycnc.nc.blocks._words import BlockWords, Fail, GWord
from polycnc.nc.dialect._dialect import Dialect
from polycnc.nc.modal._actions import Action
from polycnc.nc.modal._modal import FEED, FEED_MODE, FEED_PER_REVOLUTION, INCH, NO_AXIS
from polycnc.units import MM_PER_INCH, SECONDS_PER_MINUTE

_INCREMENT_MM = 0.001
_INCREMENT_INCH = 0.0001


@dataclass
class TurningBlocks:
    """Carry out turning cycles."""

    state: ChannelState
    dialect: Dialect
    motion: MotionBuilder
    fail: Fail

    @property
    def active(self) -> bool:
        """Whether a turning motion is in force: a thread or a single cut."""
        return bool(self.state.turning.motion)

    def begin(self, g: GWord) -> None:
        """Put a turning motion in force."""
        self.state.turning = replace(
            self.state.turning, motion=g.action.title, corner=(None, None), taper=0.0
        )

    def cancel(self) -> None:
        """Leave it."""
        if self.active:
            self.state.turning = replace(self.state.turning, motion="", corner=(None, None), taper=0.0)

    # ------------------------------------------------------------------ motions in force

    def expand(self, words: BlockWords, line: int) -> list[QueueItem]:
        """Return the moves of a block with such a motion; none if it has no position.

        Raises:
            ProgramError: a word is missing, or the spindle is at rest, or a limit would be passed.
        """
        turning = self.state.turning
        is_thread = turning.motion in ("thread", "thread_changing")
        taper_word = words.by_letter.get("R") if not is_thread else None
        taper = self._length(words, "R") if taper_word is not None else None
        values = self.motion.axis_words()
        if not values and taper is None:
            return []
        self._refuse_compensation(words)
        end = self.motion.target(values)
        if turning.motion == "thread":
            return list(self._items([Step(self._plane_point(end), thread=True)], end, line, stops=False))
        if turning.motion == "thread_changing":
            return list(self._changing_thread(end, words, line))
        x, z = self._axes()
        corner = tuple(
            end[axis] if axis in values else kept for axis, kept in zip((x, z), turning.corner, strict=True)
        )
        turning = replace(
            turning,
            corner=(corner[0], corner[1]),
            taper=turning.taper if taper is None else taper,
        )
        self.state.turning = turning
        if corner[0] is None or corner[1] is None:
            raise self.fail(
                "a cutting cycle without X (U) or Z (W)", "Give both in its first block.", self.motion.place()
            )
        start = self._here()
        to = corner[0], corner[1]
        try:
            if turning.motion == "face_cycle":
                steps = exchanged(box(start[::-1], to[::-1], turning.taper))
            else:
                chamfer = turning.chamfer * self._lead() if turning.motion == "thread_cycle" else 0.0
                steps = box(
                    start, to, turning.taper, thread=turning.motion == "thread_cycle", chamfer=chamfer
                )
        except TurningError as error:
            raise self.fail(error.what, error.hint, self.motion.place()) from None
        return list(self._items(steps, end, line))

    # ------------------------------------------------------------------ cycles with a contour

    def contour_words(self, g: GWord, words: BlockWords) -> tuple[int, int] | None:
        """Take P and Q, the first and the last block of a contour; None in a block that gives parameters only."""
        if "P" not in words.by_letter and "Q" not in words.by_letter:
            if g.action is Action.TURN_FINISH:
                raise self.fail(
                    f"G{g.code} without a contour", "Add P and Q, its first and last block.", g.word
                )
            return None
        numbers = []
        for letter in "PQ":
            word = words.take(letter)
            if word is None:
                raise self.fail(
                    f"G{g.code} without {letter}", "Give P and Q, the first and last block.", g.word
                )
            numbers.append(whole_number(word, "a block number", self.fail))
        return numbers[0], numbers[1]

    def set_parameters(self, g: GWord, words: BlockWords) -> None:
        """Keep what the first block of G71, G72 or G73 says."""
        turning = self.state.turning
        match g.action:
            case Action.TURN_ROUGH:
                depth, escape = self._length(words, "U"), self._length(words, "R")
                turning = replace(
                    turning, rough=(_or(depth, turning.rough[0]), _or(escape, turning.rough[1]))
                )
            case Action.FACE_ROUGH:
                depth, escape = self._length(words, "W"), self._length(words, "R")
                turning = replace(turning, face=(_or(depth, turning.face[0]), _or(escape, turning.face[1])))
            case _:
                u, w = self._length(words, "U"), self._length(words, "W")
                passes = words.take("R")
                count = (
                    turning.relief[2]
                    if passes is None
                    else whole_number(passes, "a number of passes", self.fail)
                )
                turning = replace(
                    turning, relief=(_or(u, turning.relief[0]), _or(w, turning.relief[1]), count)
                )
        self.state.turning = turning

    def contour_cycle(
        self, g: GWord, words: BlockWords, moves: Sequence[Line | Arc], line: int, *, both_axes: bool
    ) -> list[QueueItem]:
        """Return the moves of G71, G72 or G73 about a contour; `both_axes`: its first block names X and Z.

        Raises:
            ProgramError: the contour cannot be roughed, a word makes no sense, a limit would be passed.
        """
        self._refuse_compensation(words)
        turning = self.state.turning
        u, w = self._length(words, "U") or 0.0, self._length(words, "W") or 0.0
        allowance = u * self._diameter_share(), w
        pieces = self._pieces(moves)
        if not pieces:
            raise self.fail(f"G{g.code}: the contour moves nothing", "Check P and Q.", g.word)
        first_rapid = bool(getattr(moves[0], "rapid", False))
        cut = rough_pockets if both_axes else rough
        try:
            if g.action is Action.TURN_ROUGH:
                steps = cut(pieces, Roughing(*turning.rough, allowance), first_rapid=first_rapid)
            elif g.action is Action.FACE_ROUGH:
                turned = [piece.exchanged() for piece in pieces]
                numbers = Roughing(*turning.face, allowance[::-1])
                steps = exchanged(cut(turned, numbers, first_rapid=first_rapid))
            else:
                relief = turning.relief
                steps = repeat(pieces, relief[:2], relief[2], allowance, first_rapid=first_rapid)
        except TurningError as error:
            raise self.fail(f"G{g.code}: {error.what}", error.hint, g.word) from None
        return list(self._items(steps, self.motion.start, line))

    def back_to(self, start: AxisPoint, line: int) -> list[QueueItem]:
        """Return the rapid to where a finishing cut began."""
        x, z = self._axes()
        return list(self._items([Step((start[x], start[z]), rapid=True)], self.motion.start, line))

    def _pieces(self, moves: Sequence[Line | Arc]) -> list[Piece]:
        pieces = []
        for move in moves:
            start, end = self._plane_point(move.start), self._plane_point(move.end)
            if isinstance(move, Arc):
                pieces.append(Piece(start, end, (move.center[1], move.center[0]), move.sweep_rad))
            elif start != end:
                pieces.append(Piece(start, end))
        return pieces

    # ------------------------------------------------------------------ cycles of one block

    def cycle(self, g: GWord, words: BlockWords, line: int) -> list[QueueItem]:
        """Return the moves of G74, G75 or G76; none where the block gives parameters only.

        Raises:
            ProgramError: a word is missing or makes no sense, the spindle is at rest, a limit would be passed.
        """
        self._refuse_compensation(words)
        names = (*self.dialect.incremental, *self.state.axis_names)
        if not any(name in words.by_letter for name in names):
            self._set_cycle_parameters(g, words)
            return []
        x, z = self._axes()
        try:
            if g.action is Action.THREAD_PASSES:
                return list(self._items(self._threads(g, words), self.motion.start, line))
            p, q = self._increments(words, "P"), self._increments(words, "Q")
            relief = self._length(words, "R") or 0.0
            end = self.motion.target(self.motion.axis_words())
            retract = self.state.turning.retract
            start = self._here()
            if g.action is Action.FACE_PECK:
                steps = peck(start, Pecking(end[z], end[x], q, p, retract, relief))
            else:
                steps = exchanged(peck(start[::-1], Pecking(end[x], end[z], p, q, retract, relief)))
        except TurningError as error:
            raise self.fail(f"G{g.code}: {error.what}", error.hint, g.word) from None
        return list(self._items(steps, self.motion.start, line))

    def _set_cycle_parameters(self, g: GWord, words: BlockWords) -> None:
        turning = self.state.turning
        if g.action is not Action.THREAD_PASSES:
            retract = self._length(words, "R")
            if retract is None:
                raise self.fail(f"G{g.code} without a position", "Add X or U, Z or W.", g.word)
            self.state.turning = replace(turning, retract=retract)
            return
        if (word := words.take("P")) is not None:
            number = whole_number(
                word, "finishing passes, chamfer and angle in six digits", self.fail, 999_999
            )
            finishing, rest = divmod(number, 10_000)
            chamfer, angle = divmod(rest, 100)
            if finishing < 1 or angle not in (0, 29, 30, 55, 60, 80):
                raise self.fail(
                    f"P{number:06d} is none of finishing passes, chamfer and angle",
                    "Write two digits of each, like P020060: the angle is 0, 29, 30, 55, 60 or 80.",
                    word,
                )
            turning = replace(turning, finishing=finishing, chamfer=chamfer / 10.0, angle_deg=float(angle))
        if "Q" in words.by_letter:
            turning = replace(turning, least=self._increments(words, "Q"))
        if (allowance := self._length(words, "R")) is not None:
            turning = replace(turning, allowance=allowance)
        self.state.turning = turning

    def _threads(self, g: GWord, words: BlockWords) -> list[Step]:
        turning = self.state.turning
        height, first = self._increments(words, "P"), self._increments(words, "Q")
        taper = self._length(words, "R") or 0.0
        end = self.motion.target(self.motion.axis_words())
        numbers = Threading(
            end=self._plane_point(end),
            taper=taper,
            height_mm=height,
            first_mm=first,
            least_mm=turning.least,
            allowance_mm=turning.allowance,
            finishing=turning.finishing,
            angle_deg=turning.angle_deg,
            chamfer_leads=turning.chamfer,
            lead_mm=self._lead(),
        )
        return threads(self._here(), numbers)

    # ------------------------------------------------------------------ words and places

    def _length(self, words: BlockWords, letter: str) -> float | None:
        value = words.length(letter)
        return None if value is None else value * (MM_PER_INCH if self._inch else 1.0)

    def _increments(self, words: BlockWords, letter: str) -> float:
        """Take a word that counts increments without a point; 0 without one. In mm."""
        word = words.take(letter)
        if word is None:
            return 0.0
        if word.value < 0.0:
            raise self.fail(f"{letter} is negative", "Write it from 0 up.", word)
        if word.point:
            return word.value * (MM_PER_INCH if self._inch else 1.0)
        return word.value * (_INCREMENT_INCH * MM_PER_INCH if self._inch else _INCREMENT_MM)

    @property
    def _inch(self) -> bool:
        return bool(self.state.modal.whole[INCH])

    def _axes(self) -> tuple[int, int]:
        letters = self.state.modal.letter_axis
        x, z = (int(letters[ord(letter) - ord("A")]) for letter in "XZ")
        if NO_AXIS in (x, z):
            raise self.fail(
                "a turning cycle on a machine without X and Z", "Choose a lathe.", self.motion.place()
            )
        return x, z

    def _here(self) -> Point:
        return self._plane_point(self.motion.start)

    def _plane_point(self, point: AxisPoint) -> Point:
        x, z = self._axes()
        return point[x], point[z]

    def _diameter_share(self) -> float:
        """Return what a programmed difference in X is as a radius."""
        return 0.5 if self.motion.is_diameter(self._axes()[0]) else 1.0

    def _refuse_compensation(self, words: BlockWords) -> None:
        if self.state.side or self.state.compensation.active:
            raise self.fail(
                "a turning cycle while radius compensation is active",
                "Cancel it with G40 first.",
                self.motion.place(),
            )

    # ------------------------------------------------------------------ steps into moves

    def _lead(self) -> float:
        lead = float(self.state.modal.real[FEED])
        if lead <= 0.0:
            raise self.fail("a thread without a lead", "Add F and the lead.", self.motion.place())
        return lead

    def _items(
        self, steps: Sequence[Step], others: AxisPoint, line: int, *, stops: bool = True
    ) -> Iterator[QueueItem]:
        """Yield the moves of steps; the axes besides X and Z come to `others` with the first."""
        x, z = self._axes()
        at = self.motion.start
        for step in steps:
            goal = list(others)
            goal[x], goal[z] = step.end
            end = tuple(goal)
            if end == at:
                continue
            self.motion.check_limits(end)
            if step.arc is not None:
                yield self._arc(step.arc, at, end, line)
            elif step.thread:
                yield Line(at, end, self._thread_feed(at, end), False, False, line)
            elif step.rapid:
                yield Line(at, end, Feed(), True, stops, line)
            else:
                yield from self.motion.cut(at, end, line)
            at = end

    def _arc(self, arc: Piece, start: AxisPoint, end: AxisPoint, line: int) -> Arc:
        x, z = self._axes()
        assert arc.center is not None
        normal = int(self.state.modal.letter_axis[ord("Y") - ord("A")])
        center = arc.center[1], arc.center[0]
        feed = self.motion.feed(start, end, straight=False)
        return Arc(start, end, center, arc.sweep_rad, (z, x, normal), feed, self.motion.exact_stop, line)

    def _changing_thread(self, end: AxisPoint, words: BlockWords, line: int) -> Iterator[Line]:
        """Yield a thread whose lead changes by K with each turn of the spindle: a line for each turn.

        After n turns it has come by F n + K n^2 / 2, so the mean lead of a turn is that in its middle.

        Raises:
            ProgramError: K is missing, the lead comes down to 0 before the end, or what `_thread_feed` says.
        """
        growth = self._length(words, "K")
        if growth is None:
            raise self.fail(
                "a thread of changing lead without K", "Add K and the change per turn.", self.motion.place()
            )
        self.motion.check_limits(end)
        start, lead = self.motion.start, self._lead()
        long = max(abs(b - a) for a, b in zip(start, end, strict=True))
        square = lead * lead + 2.0 * growth * long
        if square <= 0.0:
            raise self.fail(
                "the lead of the thread comes down to 0 before its end",
                f"With K{growth:g} it can be {-lead * lead / (2.0 * growth):.6g} mm long at the most.",
                self.motion.place(),
            )
        turns = 2.0 * long / (lead + math.sqrt(square))
        if turns > MOST_PASSES:
            raise self.fail(f"a thread of {turns:.0f} turns", "Check F and K.", self.motion.place())
        at, turned = start, 0.0
        while at != end:
            next_turn = min(math.floor(turned + 1.0), turns)
            if turns - next_turn < SAME_MM:
                next_turn, to = turns, end
            else:
                share = (lead + 0.5 * growth * next_turn) * next_turn / long
                to = tuple(a + share * (b - a) for a, b in zip(start, end, strict=True))
            mean = lead + 0.5 * growth * (turned + next_turn)
            yield Line(at, to, self._thread_feed(at, to, mean), False, False, line)
            at, turned = to, next_turn

    def _thread_feed(self, start: AxisPoint, end: AxisPoint, lead: float | None = None) -> Feed:
        """Return the feed of a thread: the lead along the axis that goes further, at the speed of the spindle.

        `lead` is the one in force if it is None.

        Raises:
            ProgramError: the spindle is at rest, its speed changes with X, or an axis cannot follow it.
        """
        spindle = self.state.spindle
        modal = self.state.modal
        rpm = self.motion.rpm(start, start) if spindle.direction else 0.0
        if rpm <= 0.0:
            raise self.fail(
                "a thread with the spindle at rest",
                "Start it with S and M3 or M4 first.",
                self.motion.place(),
            )
        if spindle.surface_speed:
            raise self.fail(
                "a thread with constant surface speed (G96)",
                "Its lead would change with X: select G97 first.",
                self.motion.place(),
            )
        if modal.whole[FEED_MODE] != FEED_PER_REVOLUTION:
            raise self.fail(
                "a thread without feed per revolution",
                "F is the lead: select feed per revolution first.",
                self.motion.place(),
            )
        ways = [abs(b - a) for a, b in zip(start, end, strict=True)]
        longest = max(range(len(ways)), key=ways.__getitem__)
        speed = (self._lead() if lead is None else lead) * rpm / SECONDS_PER_MINUTE
        for index, axis in enumerate(self.state.machine.axes):
            wanted = speed * ways[index] / ways[longest]
            if wanted > axis.vmax:
                raise self.fail(
                    f"the thread needs {wanted * SECONDS_PER_MINUTE:.0f} mm/min of axis {axis.name}, which has "
                    f"{axis.vmax * SECONDS_PER_MINUTE:.0f}",
                    "Turn the spindle slower.",
                    self.motion.place(),
                )
        return Feed(speed_mm_s=speed * math.hypot(*ways) / ways[longest])


def _or(value: float | None, other: float) -> float:
    return other if value is None else value
