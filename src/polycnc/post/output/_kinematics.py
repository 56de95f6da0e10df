"""From tool axis and tip on the part to the positions of a machine with two rotary axes.

The axes are named in their order from the part to the tool, and each counts as the tool turns on the part: by the
right-hand rule about its direction. So the tool axis on the part is R1 R2 (0, 0, 1), whether an axis carries the part
(which it then turns the other way) or the tool.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from polycnc.post.macros._parameters import FiveAxis, RotaryAxis
from polycnc.post.tool_path._arcs import cross, dot
from polycnc.post.tool_path._records import UPRIGHT, Vector

Angles = tuple[float, float]

_POLE = 1e-6  # a tool axis nearer to the direction of the first axis than this, in rad, leaves that axis where it is
_MOST_DEG = 5.0  # that the rotary axes turn in one piece of a move
_MOST_PIECES = 100_000
_WHOLE_TURN = 360.0


class Kinematics:
    """The rotary axes of a control file, with all angles in degree and lengths in mm."""

    def __init__(self, geometry: FiveAxis) -> None:
        self.axes = geometry.axis
        self.on_machine = geometry.output == "machine"
        self.letters = (self.axes[0].letter, self.axes[1].letter)
        self._u, self._v = (_unit(axis.direction) for axis in self.axes)
        self._tables = [(axis, _unit(axis.direction)) for axis in self.axes if axis.on == "table"]
        self.has_head = any(axis.on == "head" for axis in self.axes)

    def axis_of(self, angles: Angles) -> Vector:
        """Return the tool axis on the part."""
        return turned(self._u, angles[0], turned(self._v, angles[1], UPRIGHT))

    def nearest(self, axis: Vector, now: Angles) -> Angles | None:
        """Return the angles for a tool axis that lie within the limits and next to `now`; None if there are none."""
        found = (
            placed
            for angles in self._solutions(axis, now)
            if (placed := self._within(angles, now)) is not None
        )
        return min(found, key=lambda each: abs(each[0] - now[0]) + abs(each[1] - now[1]), default=None)

    def position(self, tip: Vector, angles: Angles, length_mm: float) -> Vector:
        """Return where the linear axes stand so that a tool of a length has its tip at a point of the part."""
        on_table = tip
        for (axis, direction), angle in zip(self._tables, angles, strict=False):
            on_table = _about(axis.point_mm, direction, -angle, on_table)
        if not self.has_head:
            return on_table
        nose: Vector = (0.0, 0.0, -length_mm)
        hangs = nose
        for axis, angle in zip(reversed(self.axes), reversed(angles), strict=True):
            if axis.on == "head":
                hangs = _about(axis.point_mm, _unit(axis.direction), angle, hangs)
        return (
            on_table[0] - hangs[0] + nose[0],
            on_table[1] - hangs[1] + nose[1],
            on_table[2] - hangs[2] + nose[2],
        )

    def pieces(
        self,
        start: Vector,
        before: Angles,
        end: Vector,
        angles: Angles,
        length_mm: float,
        tolerance_mm: float,
    ) -> Iterator[tuple[Vector, Angles]]:
        """Yield the ends of pieces in which the tip stays within the tolerance of its line.

        Between two blocks the machine moves all its axes in proportion, and the tip leaves its line.
        """
        turn = max(abs(angles[0] - before[0]), abs(angles[1] - before[1]))
        count = max(1, math.ceil(turn / _MOST_DEG))
        if self.on_machine and turn > 0.0:
            while (
                count < _MOST_PIECES
                and (off := self._off_line(start, before, end, angles, length_mm, count)) > tolerance_mm
            ):
                count = max(count + 1, math.ceil(count * math.sqrt(off / tolerance_mm)))
        else:
            count = 1
        for number in range(1, count):
            part = number / count
            yield _between(start, end, part), _mixed(before, angles, part)
        yield end, angles

    def _off_line(
        self, start: Vector, before: Angles, end: Vector, angles: Angles, length_mm: float, count: int
    ) -> float:
        """Return how far the tip lies off in the middle of any of so many pieces.

        In the middle of a piece the tip lies by half the second difference of the positions off.
        """
        worst = 0.0
        for number in range(count):
            points = [
                self.position(
                    _between(start, end, part), _mixed(before, angles, part), length_mm
                )
                for part in (number / count, (number + 0.5) / count, (number + 1.0) / count)
            ]  # fmt: skip
            first, middle, last = points
            worst = max(worst, math.dist(middle, _between(first, last, 0.5)))
        return worst

    def _solutions(self, axis: Vector, now: Angles) -> Iterator[Angles]:
        """Yield the angles that give a tool axis, in any turn: two, one or none of them."""
        u, v = self._u, self._v
        fixed = dot(u, v) * dot(v, UPRIGHT)
        cosine, sine = dot(u, UPRIGHT) - fixed, dot(u, cross(v, UPRIGHT))
        size = math.hypot(cosine, sine)
        level = (dot(u, axis) - fixed) / size
        if abs(level) > 1.0 + 1e-9:
            return
        middle = math.atan2(sine, cosine)
        if math.hypot(*cross(u, axis)) < _POLE:
            level = (math.copysign(1.0, dot(u, axis)) - fixed) / size
        half = math.acos(min(1.0, max(-1.0, level)))
        for second in (middle + half, middle - half):
            lean = turned(v, math.degrees(second), UPRIGHT)
            from_, to = _across(lean, u), _across(axis, u)
            if math.hypot(*to) < _POLE or math.hypot(*from_) < _POLE:
                first = now[0]
            else:
                first = math.degrees(math.atan2(dot(u, cross(from_, to)), dot(from_, to)))
            yield first, math.degrees(second)

    def _within(self, angles: Angles, now: Angles) -> Angles | None:
        first = _nearest_turn(self.axes[0], angles[0], now[0])
        second = _nearest_turn(self.axes[1], angles[1], now[1])
        return None if first is None or second is None else (first, second)


def turned(direction: Vector, angle_deg: float, vector: Vector) -> Vector:
    """Return a vector turned about a direction of length 1 by the right-hand rule."""
    angle = math.radians(angle_deg)
    cosine, sine = math.cos(angle), math.sin(angle)
    along = dot(direction, vector) * (1.0 - cosine)
    i, j, k = cross(direction, vector)
    return (
        vector[0] * cosine + i * sine + direction[0] * along,
        vector[1] * cosine + j * sine + direction[1] * along,
        vector[2] * cosine + k * sine + direction[2] * along,
    )


def _about(point: Vector, direction: Vector, angle_deg: float, where: Vector) -> Vector:
    away = (where[0] - point[0], where[1] - point[1], where[2] - point[2])
    i, j, k = turned(direction, angle_deg, away)
    return point[0] + i, point[1] + j, point[2] + k


def _nearest_turn(axis: RotaryAxis, angle: float, now: float) -> float | None:
    """Return the angle, whole turns away, that lies within the limits of an axis and next to `now`."""
    near = angle - _WHOLE_TURN * round((angle - now) / _WHOLE_TURN)
    if axis.limits_deg is None:
        return near
    low, high = axis.limits_deg
    if near > high:
        near -= _WHOLE_TURN * math.ceil((near - high) / _WHOLE_TURN - 1e-12)
    elif near < low:
        near += _WHOLE_TURN * math.ceil((low - near) / _WHOLE_TURN - 1e-12)
    return min(max(near, low), high) if low - 1e-9 <= near <= high + 1e-9 else None


def _unit(vector: Vector) -> Vector:
    size = math.hypot(*vector)
    return vector[0] / size, vector[1] / size, vector[2] / size


def _across(vector: Vector, direction: Vector) -> Vector:
    along = dot(vector, direction)
    return (
        vector[0] - along * direction[0],
        vector[1] - along * direction[1],
        vector[2] - along * direction[2],
    )


def _between(start: Vector, end: Vector, part: float) -> Vector:
    return (
        start[0] + (end[0] - start[0]) * part,
        start[1] + (end[1] - start[1]) * part,
        start[2] + (end[2] - start[2]) * part,
    )


def _mixed(before: Angles, angles: Angles, part: float) -> Angles:
    return before[0] + (angles[0] - before[0]) * part, before[1] + (angles[1] - before[1]) * part
