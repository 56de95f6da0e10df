"""What the records of a tool path come to: which moves, which holes, which arcs. The one reading for output and proof.

A drilling cycle is modal: it holds until CYCLE/OFF, another cycle or a tool change, whatever stands between its
points. A GOTO in it is a hole; GOHOME and a retraction are moves that leave it in force.
"""

from __future__ import annotations

import math
from typing import NamedTuple, TypeAlias

from polycnc.errors import ProgramError
from polycnc.post.tool_path._arcs import TWO_PI, sweep_of
from polycnc.post.tool_path._cycles import Levels, level_of, levels_of
from polycnc.post.tool_path._records import (
    UPRIGHT,
    Axis,
    Circle,
    Cycle,
    CycleOff,
    Delta,
    From,
    Goto,
    Home,
    Path,
    Rapid,
    Record,
    Retract,
    Tool,
    Vector,
    WorkOffset,
)

_SAME_MM = 1e-4


class Straight(NamedTuple):
    """A straight move; `start` is None where it is not known."""

    line: int
    start: Vector | None
    end: Vector
    axis: Vector
    rapid: bool


class Hole(NamedTuple):
    """A hole of a cycle at a point; the tool comes from `start`, which is None where it is not known."""

    line: int
    start: Vector | None
    point: Vector
    axis: Vector
    cycle: Cycle
    levels: Levels


class Turn(NamedTuple):
    """An arc that turns by `angle` rad about `normal` through `center`."""

    line: int
    start: Vector
    end: Vector
    axis: Vector
    center: Vector
    normal: Vector
    angle: float


Act: TypeAlias = Straight | Hole | Turn


class CourseError(Exception):
    """Records that come to no move; `line`, `what` and `hint` say why."""

    def __init__(self, line: int, what: str, hint: str) -> None:
        super().__init__(what)
        self.line, self.what, self.hint = line, what, hint

    def as_error(self) -> ProgramError:
        """Return the error for users, without a place."""
        return ProgramError(self.what, hint=self.hint)


class Course:
    """Where the tool is and what holds, record by record."""

    def __init__(self) -> None:
        self.here: Vector | None = None
        self.axis: Vector = UPRIGHT
        self.work_offset = 1
        self.cycle: Cycle | None = None
        self._home: Vector | None = None
        self._rapid = False
        self._changed = False  # after a tool change nobody knows where the machine stands
        self._last: Cycle | None = None
        self._initial: Vector | None = None
        self._jumped = 0  # the line of a FROM that says the tool is elsewhere than it went

    def take(self, record: Record) -> Act | None:
        """Return what a record makes the tool do, None if nothing.

        Raises:
            CourseError: nothing can come of it.
        """
        if isinstance(record, Goto):
            line, x, y, z, axis = record
            if axis is not None:
                self.axis = axis
            return self._point(line, (x, y, z))
        match record:
            case Rapid():
                self._rapid = True
            case Circle():
                return self._turn(record)
            case Delta():
                return self._point(record.line, self._behind(record))
            case Home():
                return self._go_home(record)
            case Retract():
                return self._up(record)
            case From():
                self._start_from(record)
            case Axis():
                self.axis = record.axis
            case Cycle():
                self._begin(record)
            case CycleOff(on=False):
                self.cycle = None
            case Tool():
                self.cycle, self._changed = None, True
            case Path(work_offset=int(number)) | WorkOffset(number=number) if number != self.work_offset:
                self.work_offset, self._changed = number, True
                self.cycle = self.here = self._initial = self._home = None
            case CycleOff(on=True):
                if self._last is None:
                    raise CourseError(
                        record.line, "CYCLE/ON without a cycle before", "Write the cycle itself."
                    )
                self._begin(self._last)
            case _:
                pass
        return None

    def _start_from(self, record: From) -> None:
        """Begin at a point; elsewhere than the tool stands, it has changed."""
        before, self.here = self.here, (record.x, record.y, record.z)
        self._home = self.here
        elsewhere = before is not None and math.dist(before, self.here) > _SAME_MM and not self._changed
        self._jumped = record.line if elsewhere else 0
        self._changed |= elsewhere
        self.axis = record.axis or self.axis

    def plain(self, end: Vector) -> Vector | None:
        """Go straight with the feed, and return from where; None, going nowhere, where it is not as plain as that."""
        start = self.here
        if start is None or not self.is_plain:
            return None
        self.here = end
        return start

    @property
    def is_plain(self) -> bool:
        """Whether the next point is a straight feed move from where the tool is."""
        return (
            self.here is not None
            and self.cycle is None
            and not self._rapid
            and not self._changed
            and not self._jumped
        )

    def _begin(self, cycle: Cycle) -> None:
        self.cycle = self._last = cycle
        self._initial = self.here

    def _point(self, line: int, point: Vector) -> Act:
        rapid, self._rapid = self._rapid, False
        self._arrive(line, rapid or self.cycle is not None)
        start = self._start()
        if self.cycle is None:
            self.here = point
            return Straight(line, start, point, self.axis, rapid)
        initial = level_of(self._initial, point, self.axis)
        levels = levels_of(self.cycle, level_of(start, point, self.axis), initial)
        i, j, k = self.axis
        self.here = (point[0] + levels.out * i, point[1] + levels.out * j, point[2] + levels.out * k)
        return Hole(line, start, point, self.axis, self.cycle, levels)

    def _arrive(self, line: int, by_rapid: bool) -> None:
        """Know the way that a move begins with: after a FROM elsewhere it cannot be a feed.

        Raises:
            CourseError: it is.
        """
        jumped, self._jumped = self._jumped, 0
        if jumped and not by_rapid:
            raise CourseError(
                line,
                f"a feed move from where FROM on line {jumped} says the tool is, but it went elsewhere",
                "Write RAPID and a GOTO to that point in place of FROM.",
            )

    def _start(self) -> Vector | None:
        """Return where a move begins, None where that is not known."""
        changed, self._changed = self._changed, False
        return None if changed else self.here

    def _straight(self, line: int, end: Vector) -> Straight:
        """Return a rapid that is no hole, whether a cycle holds or not."""
        self._jumped = 0
        start, self.here, self._rapid = self._start(), end, False
        return Straight(line, start, end, self.axis, True)

    def _go_home(self, record: Home) -> Straight:
        home = record.point or self._home
        if home is None:
            raise CourseError(
                record.line, "GOHOME without a FROM", "Write FROM at the beginning, or GOHOME/x,y,z."
            )
        return self._straight(record.line, home)

    def _up(self, record: Retract) -> Straight | None:
        if self.here is None:
            raise CourseError(record.line, "RETRCT from an unknown point", "Write FROM or GOTO before it.")
        if self.axis != UPRIGHT:
            raise CourseError(
                record.line, "RETRCT with a tilted tool", "Write the way out as RAPID and GOTO."
            )
        x, y, z = self.here
        return self._straight(record.line, (x, y, record.z)) if z < record.z else None

    def _turn(self, record: Circle) -> Turn:
        if self.cycle is not None:
            raise CourseError(record.line, "an arc within a drilling cycle", "Write CYCLE/OFF before it.")
        self._arrive(record.line, False)
        if self._changed and self.here is not None:
            raise CourseError(
                record.line,
                "an arc right after a tool change, from where the tool is not yet",
                "Write a GOTO to the start of the arc before it.",
            )
        start, self._rapid = self.here, False
        if start is None:
            raise CourseError(record.line, "an arc without a start point", "Write FROM or GOTO before it.")
        end = (record.x, record.y, record.z)
        angle = sweep_of(start, end, record.center, record.normal) + TWO_PI * (record.turns - 1)
        self.here = end
        return Turn(record.line, start, end, self.axis, record.center, record.normal, angle)

    def _behind(self, record: Delta) -> Vector:
        if self.here is None:
            raise CourseError(
                record.line, "a move by a distance from an unknown point", "Write FROM or GOTO before it."
            )
        x, y, z = self.here
        if record.along_axis:
            i, j, k = self.axis
            return x + i * record.x, y + j * record.x, z + k * record.x
        return x + record.x, y + record.y, z + record.z
