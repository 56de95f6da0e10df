"""What reading a tool path in APT words must remember, and how points and arcs come of it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

import numpy as np
import numpy.typing as npt

from polycnc.post.tool_path._arcs import SAME_POINT_MM, off_circle, radius_at, sweep_of
from polycnc.post.tool_path._cl_statement import Statement
from polycnc.post.tool_path._records import (
    LARGEST_MM,
    MOST_TURNS,
    UPRIGHT,
    Axis,
    Circle,
    Compensation,
    Coolant,
    Delta,
    End,
    From,
    Goto,
    Home,
    Path,
    Points,
    Rapid,
    Record,
    Retract,
    Text,
    Tool,
    ToolShape,
    Vector,
    WorkOffset,
)
from polycnc.post.tool_path._source import Remarks

ArcAxis: TypeAlias = Literal["auto", "counterclockwise", "clockwise"]
"""What the axis of CIRCLE/ is for: arcs by the right-hand rule, or against it; "auto" by the kind of file."""


_SAME_FRAME = 1e-6
_ANGLE_DEG = 0.5
_OFF_ANGLE_MM = 0.05
_MOVES = (Goto, Circle, Delta, Home, Retract, End)
_RAPIDS = (Rapid, Goto, Home, Retract)
_BEFORE_TOOLS = (Rapid, Home, Retract, Text, ToolShape, Axis, From, Path, Coolant, Compensation)


@dataclass(slots=True)
class PendingCircle:
    """An arc that waits for its end point."""

    statement: Statement
    center: Vector
    normal: Vector
    angle_deg: float | None = None
    turns: int = 1


@dataclass(slots=True)
class Reading:
    """What reading a tool path must remember: units, the last point, an arc that waits for its end."""

    remarks: Remarks
    arc_axis: ArcAxis = "auto"
    scale: float = 1.0
    circle: PendingCircle | None = None
    position: Vector | None = None
    direction: Vector | None = None
    clsf_word: str = ""
    """The first word that only the CLSF of NX has, empty if there was none."""
    right_handed: int = 0
    """The line of the first CIRCLE/ that was read by the right-hand rule because nothing said otherwise, 0 if none."""
    both_ways: Statement | None = None
    """The first arc whose angle fits either sense of rotation."""
    turned_round: bool = False
    """Whether the angle of an arc said that its axis does not tell the sense of rotation."""
    frames: list[tuple[float, ...]] = field(default_factory=list)
    """The coordinate systems in the order in which they were first given (MSYS, CSYS)."""
    frame: int = 0
    """The number of the one in force, 0 for none."""
    in_world: bool = False
    """Whether points count from one zero whatever coordinate systems come (TRNTYP/WORLD)."""
    matrix: list[float] | None = None
    """The numbers of a coordinate system that stands in remarks, while they come."""
    announced: Tool | None = None
    """A tool that was described and not loaded yet."""
    clearance_z: float | None = None
    side: Compensation | None = None
    """The last CUTCOM with a side, for CUTCOM/ON."""
    resumes: bool = False
    """Whether CUTCOM/ON waits for its side, which comes with the next statement or is the last one."""
    cycle_on: bool = False
    threads: bool = False
    lead: float | None = None
    """The last PITCH, in mm."""
    tool: Tool | None = None
    """The last tool change."""
    offset: int | None = None
    """The number of the length offset in force."""
    held: list[Record] = field(default_factory=list)
    """A tool change and what stands after it up to the first move, for its offset; at first what comes before it."""
    before_tools: bool = True
    """Whether nothing but rapids came so far."""
    cycle_began: int = 0
    """How many moves came before the last CYCLE."""
    units_said: bool = False
    mode_said: bool = False
    """Whether there was a MODE, which Autodesk writes: its points of cycles by place are the bottoms of holes."""
    unsure_cycle: tuple[Statement, float] | None = None
    """Such a cycle and its clearance, up to its first hole."""
    known: int = 0
    unknown: int = 0
    moves: int = 0

    is_tilted: bool = False
    """Whether the last tool axis is not upright."""
    axis_unsure: Statement | None = None
    """A MULTAX/OFF that leaves open how the tool stands."""
    is_lathe: bool = False
    """Whether the tool that was described last is one for turning."""

    @property
    def waits(self) -> bool:
        """Whether the next point needs a look: a CUTCOM/ON waits for its side, a tool for its change."""
        return self.resumes or self.announced is not None or self.axis_unsure is not None

    def hold(self, records: Iterable[Record]) -> Iterator[Record]:
        """Yield records, but a tool change and what stands after it only before the first move.

        Rapids before the first tool change are left out: the length of the tool that is in the spindle then is unknown.
        """
        for record in records:
            if isinstance(record, Tool):
                yield from self._without_rapids()
                self.held.append(record)
                self.offset = record.number if record.h is None else record.h
            elif self._holds(record):
                self.held.append(record)
            else:
                yield from self.release()
                yield record

    def release(self) -> Iterator[Record]:
        """Yield what is held."""
        held, self.held, self.before_tools = self.held, [], False
        yield from held

    def _holds(self, record: Record) -> bool:
        if not self.before_tools:
            return bool(self.held) and not isinstance(record, _MOVES)
        if not isinstance(record, Goto):
            return isinstance(record, _BEFORE_TOOLS)
        moves = (each for each in reversed(self.held) if isinstance(each, _RAPIDS))
        return isinstance(next(moves, None), Rapid)

    def _without_rapids(self) -> Iterator[Record]:
        """Yield what is held before a tool change; rapids only where tools were changed before."""
        first = self.before_tools
        for record in self.release():
            if not first or not isinstance(record, _RAPIDS):
                yield record
            elif not isinstance(record, Rapid):
                self.remarks.add(
                    record.line,
                    "a rapid before the first tool change is left out: the length of the tool in the spindle is not "
                    "known",
                )

    def take_offset(self, statement: Statement, number: int) -> None:
        """Take the number of the length offset.

        Raises:
            ProgramError: the tool has moved with another one.
        """
        if self.held and isinstance(self.held[0], Tool):
            self.held[0] = self.held[0]._replace(h=number)
        elif number != self.offset:
            raise statement.fail(
                f"length offset {number} for a tool that has moved with "
                + ("none" if self.offset is None else str(self.offset)),
                "Write it right after the tool change, before the tool moves.",
            )
        self.offset = number

    def resume(self, statement: Statement) -> Compensation:
        """Return the compensation that CUTCOM/ON takes up again.

        Raises:
            ProgramError: there was none.
        """
        self.resumes = False
        if self.side is None:
            raise statement.fail(
                "CUTCOM/ON without a side before or after it", "Write CUTCOM/LEFT or CUTCOM/RIGHT."
            )
        return self.side._replace(line=statement.line)

    def load(self, line: int) -> Iterator[Tool]:
        """Yield the change to the tool that was described, where nothing else has loaded it."""
        announced, self.announced = self.announced, None
        if announced is not None and (self.tool is None or self.tool.number != announced.number):
            self.tool = announced._replace(line=line)
            self.threads = self.cycle_on = False
            yield self.tool

    def take_frame(self, line: int, numbers: tuple[float, ...]) -> Iterator[WorkOffset]:
        """Yield the change to a coordinate system, if it is another one than that in force; the first is 1.

        After TRNTYP/WORLD a coordinate system is only the set-up of an operation: its points count from the world.
        """
        if self.in_world:
            return
        place = next((at for at, each in enumerate(self.frames, 1) if _same_frame(each, numbers)), 0)
        if not place:
            self.frames.append(numbers)
            place = len(self.frames)
        before, self.frame = self.frame, place
        if before and before != place:
            self.forget_position()
            yield WorkOffset(line, place, frame=True)

    def forget_position(self) -> None:
        """Know that positions count from another zero: nothing says where the tool is."""
        self.position = None
        self.clearance_z = None
        self.cycle_on = False

    def check_units(self, statement: Statement) -> None:
        """Refuse a feed in inches where nothing says the unit of the lengths, which would be read as mm.

        Threads in inches are cut on metric parts too: only in a CLSF, which never says its unit, they are refused.

        Raises:
            ProgramError: it is so.
        """
        if self.units_said or (statement.major == "PITCH" and not self.clsf_word):
            return
        if statement.words() & {"IPM", "IPR", "FPM"}:
            raise statement.fail(
                "a feed in inches in a tool path that does not say the unit of its lengths",
                "Write UNITS/INCHES or UNITS/MM as its first line.",
            )

    def turns_clockwise(self, statement: Statement) -> bool:
        """Return whether the axis of this CIRCLE/ or MOVARC/ is for a clockwise direction."""
        if self.arc_axis != "auto":
            return self.arc_axis == "clockwise"
        if statement.major != "CIRCLE":
            return False
        if not self.clsf_word and not self.right_handed:
            self.right_handed = statement.line
        return bool(self.clsf_word)

    def point(self, line: int, x: float, y: float, z: float, axis: Vector | None = None) -> Goto | Circle:
        """Return the move to a point.

        Raises:
            ProgramError: how the tool stands there is left open.
        """
        if axis is not None:
            self.is_tilted, self.axis_unsure = axis != UPRIGHT, None
        elif self.axis_unsure is not None:
            raise self.axis_unsure.fail(
                "MULTAX/OFF while the tool is tilted, and points without a tool axis after it",
                "Write TLAXIS/0,0,1 after it if the tool is upright there, or let the CAM system write the axis.",
            )
        if self.scale != 1.0:
            x, y, z = x * self.scale, y * self.scale, z * self.scale
        self.moves += 1
        if self.unsure_cycle is not None:
            self._check_surface(*self.unsure_cycle, z)
        if self.circle is not None:
            circle, self.circle = self.circle, None
            return self.arc(circle, (x, y, z))
        self.position = (x, y, z)
        return Goto(line, x, y, z, axis)

    def points(self, line: int, xyz: npt.NDArray[np.float64]) -> Points | None:
        """Return the moves to points; None if one is too far away, or the first needs a look."""
        if self.scale != 1.0:
            xyz = xyz * self.scale
        if not np.abs(xyz).max() <= LARGEST_MM or self.unsure_cycle is not None:
            return None
        self.moves += len(xyz)
        x, y, z = xyz[-1].tolist()
        self.position = (x, y, z)
        return Points(line, xyz)

    def _check_surface(self, cycle: Statement, clearance: float, z: float) -> None:
        """Refuse a first hole that is no surface: the cycle's clearance is the height of the tool, so it is absolute.

        Raises:
            ProgramError: it is so.
        """
        self.unsure_cycle = None
        if self.position is None or not self.cycle_on:
            return
        if abs(self.position[2] - clearance) <= SAME_POINT_MM < abs(z):
            raise cycle.fail(
                f"a cycle whose clearance, {clearance / self.scale:g}, is the height of the tool, and whose first "
                f"point at Z{z / self.scale:g} seems to be the bottom of the hole, not its surface",
                "Let the CAM system write the moves of the holes as points, or name the levels (DEPTH, CLEAR).",
            )

    def arc(self, circle: PendingCircle, end: Vector) -> Circle:
        """Return the arc to an end point.

        Raises:
            ProgramError: there is no start point, or start and end lie on different circles.
        """
        start, statement = self.position, circle.statement
        self.moves += 1
        if start is None:
            raise statement.fail("an arc without a start point", "Write a GOTO or FROM before it.")
        if off := off_circle(start, end, circle.center, circle.normal):
            raise statement.fail(
                f"the end point of the arc lies {off:.4g} mm off the circle through its start",
                "Check the centre, and the points before and after the arc.",
            )
        turns, normal = circle.turns, circle.normal
        if circle.angle_deg is not None:
            sweep = math.degrees(sweep_of(start, end, circle.center, normal))
            angle = abs(circle.angle_deg)
            if self.arc_axis == "auto" and self._turns_round(circle, start, angle, sweep):
                normal, sweep = (-normal[0], -normal[1], -normal[2]), 360.0 - sweep
            turns = max(1, round((angle - sweep) / 360.0) + 1)
        if turns > MOST_TURNS:
            raise statement.fail(f"an arc of {turns} turns", f"Write at most {MOST_TURNS} turns in one arc.")
        self.position = end
        return Circle(statement.line, *end, circle.center, normal, turns)

    def _turns_round(self, circle: PendingCircle, start: Vector, angle: float, sweep: float) -> bool:
        """Return whether an arc turns against its axis, as its ANGLE has it: some systems give the plane's normal.

        Raises:
            ProgramError: the angle fits neither sense, or both where axes do not tell it.
        """
        radius = radius_at(start, circle.center, circle.normal)
        near = _ANGLE_DEG + math.degrees(_OFF_ANGLE_MM / max(radius, _OFF_ANGLE_MM))
        with_axis, against = (abs((angle - each + 180.0) % 360.0 - 180.0) <= near for each in (sweep, -sweep))
        if not with_axis and not against:
            raise circle.statement.fail(
                f"ANGLE,{angle:g} of an arc whose points are {sweep:.5g} degree apart",
                "Check the angle, the centre, and the points before and after the arc.",
            )
        if with_axis and against:
            self.both_ways = self.both_ways or circle.statement
        self.turned_round |= not with_axis
        if self.turned_round and self.both_ways is not None:
            raise self.both_ways.fail(
                "an arc that may turn either way: other arcs show that their axes do not tell the sense of rotation",
                "Let the CAM system write the axis by the right-hand rule, or split half and whole turns.",
            )
        return not with_axis


def _same_frame(one: tuple[float, ...], other: tuple[float, ...]) -> bool:
    same = len(one) == len(other)
    return same and all(abs(a - b) <= _SAME_FRAME for a, b in zip(one, other, strict=True))


Handler: TypeAlias = Callable[[Reading, Statement], Iterator[Record]]
"""Reads one statement."""
