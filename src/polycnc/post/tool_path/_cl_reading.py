"""What reading a tool path in APT words must remember, and how points and arcs come of it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TypeAlias

from polycnc.post.tool_path._arcs import off_circle, sweep_of
from polycnc.post.tool_path._cl_statement import Statement
from polycnc.post.tool_path._records import Circle, Goto, Record, Vector
from polycnc.post.tool_path._source import Remarks


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
    scale: float = 1.0
    circle: PendingCircle | None = None
    position: Vector | None = None
    direction: Vector | None = None

    def point(self, line: int, x: float, y: float, z: float, axis: Vector | None = None) -> Goto | Circle:
        """Return the move to a point."""
        if self.scale != 1.0:
            x, y, z = x * self.scale, y * self.scale, z * self.scale
        if self.circle is not None:
            circle, self.circle = self.circle, None
            return self.arc(circle, (x, y, z))
        self.position = (x, y, z)
        return Goto(line, x, y, z, axis)

    def arc(self, circle: PendingCircle, end: Vector) -> Circle:
        """Return the arc to an end point.

        Raises:
            ProgramError: there is no start point, or start and end lie on different circles.
        """
        start, statement = self.position, circle.statement
        if start is None:
            raise statement.fail("an arc without a start point", "Write a GOTO or FROM before it.")
        if off := off_circle(start, end, circle.center, circle.normal):
            raise statement.fail(
                f"the end point of the arc lies {off:.4g} mm off the circle through its start",
                "Check the centre, and the points before and behind the arc.",
            )
        turns = circle.turns
        if circle.angle_deg is not None:
            sweep = sweep_of(start, end, circle.center, circle.normal)
            turns = max(1, round((abs(circle.angle_deg) - math.degrees(sweep)) / 360.0) + 1)
        self.position = end
        return Circle(statement.line, *end, circle.center, circle.normal, turns)


Handler: TypeAlias = Callable[[Reading, Statement], Iterator[Record]]
"""Reads one statement."""
