"""A profile of straight lines and arcs, as LinuxCNC's G70 to G72 take one: moved off by a distance, turned, mirrored.

Points are complex numbers, Z + X i, in the units of the program. Source: LinuxCNC G-code manual, "G70", "G71", "G72",
and what `rs274` makes of programs.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from polycnc.nc.blocks._moves import GeometryError

NEAR, SHORT, GAP = 1e-6, 1e-3, 1e-2
"""Lengths below which points are one, a part is none, and a gap is none."""
_MOST_ROUNDS = 1000


@dataclass(frozen=True, slots=True)
class Part:
    """A straight line, or with `center` an arc, counter-clockwise from Z to X with `ccw`.

    One with a `corner` has no length yet: it is that far from the sides of its corner, straight, or round if `rounds`.
    """

    start: complex
    end: complex
    center: complex | None = None
    ccw: bool = False
    corner: float = 0.0
    rounds: bool = False

    @property
    def size(self) -> float:
        """How far the part can be moved off, at least."""
        chord = abs(self.end - self.start)
        return chord if self.center is None else min(chord, abs(self.start - self.center))

    @property
    def goes_on(self) -> bool:
        """Whether the part never goes back along Z, which falls."""
        back = (self.end - self.start).real
        if self.center is None:
            return back <= SHORT
        side = 1.0 if self.ccw else -1.0
        heights = ((point - self.center).imag * side for point in (self.start, self.end))
        return all(height >= -SHORT for height in heights) and back <= -SHORT

    def moved(self, by: complex) -> Part:
        """Return the part elsewhere."""
        center = None if self.center is None else self.center + by
        return replace(self, start=self.start + by, end=self.end + by, center=center)

    def beside(self, distance: float) -> Part:
        """Return the part moved off to the left of its way back."""
        if self.center is None:
            back = self.start - self.end
            return self.moved(1j * distance * back / abs(back))
        radius = abs(self.start - self.center)
        share = (radius + (distance if self.ccw else -distance)) / radius
        around = (self.center + share * (point - self.center) for point in (self.start, self.end))
        start, end = around
        return Part(start, end, self.center, self.ccw)

    def crossings(self, x: float) -> list[float]:
        """Return where along Z the part has a height, an arc at the larger Z first."""
        if self.center is None:
            low, high = sorted((self.start.imag, self.end.imag))
            if not low - NEAR <= x <= high + NEAR:
                return []
            rise = self.end - self.start
            if abs(rise.imag) < NEAR:
                return [self.start.real, self.end.real]
            return [(x - self.start.imag) / rise.imag * rise.real + self.start.real]
        radius, height = abs(self.start - self.center), x - self.center.imag
        square = radius * radius - height * height
        if square < -NEAR:
            return []
        half = math.sqrt(max(square, 0.0))
        found = (self.center.real + half, self.center.real - half)
        return [z for z in found if self._holds(complex(z, x), self.center)]

    def _holds(self, point: complex, center: complex) -> bool:
        side = 1.0 if self.ccw else -1.0
        after = ((self.start - center).conjugate() * (point - center)).imag * side
        before = ((self.end - center).conjugate() * (point - center)).imag * side
        return after >= -NEAR and before <= NEAR


@dataclass(frozen=True, slots=True)
class View:
    """How a profile is looked at: turned by a quarter, then with X, and with Z, the other way round."""

    turned: bool = False
    x_over: bool = False
    z_over: bool = False

    def seen(self, part: Part) -> Part:
        """Return a part as it is seen."""
        center = None if part.center is None else self._see(part.center)
        over = self.x_over is not self.z_over
        start, end = self._see(part.start), self._see(part.end)
        return Part(start, end, center, part.ccw is not over, part.corner, part.rounds)

    def _see(self, point: complex) -> complex:
        point = -1j * point if self.turned else point
        return complex(-point.real if self.z_over else point.real, -point.imag if self.x_over else point.imag)

    def back(self, point: complex) -> complex:
        """Return the point that is seen there."""
        point = complex(
            -point.real if self.z_over else point.real, -point.imag if self.x_over else point.imag
        )
        return 1j * point if self.turned else point

    def falling(self, parts: Sequence[Part]) -> View:
        """Return the view in which X and Z fall from the end of the first part on."""
        way = parts[0].end - parts[-1].end
        way = -1j * way if self.turned else way
        return replace(self, x_over=way.imag > 0.0, z_over=way.real < 0.0)


def with_corners(profile: Sequence[Part]) -> list[Part]:
    """Return a profile whose chamfers and rounded corners have their lengths.

    Raises:
        GeometryError: one does not fit.
    """
    parts = list(profile)
    for at in range(1, len(parts) - 1):
        if parts[at].corner:
            parts[at - 1 : at + 2] = _with_corner(*parts[at - 1 : at + 2])
    return [part for part in parts if part.size >= SHORT]


def _with_corner(before: Part, corner: Part, after: Part) -> list[Part]:
    for aside in (corner.corner, -corner.corner):
        one, two = before.beside(aside), after.beside(aside)
        if (one.end - two.start).real <= GAP:
            break
    else:
        raise GeometryError("a corner of the profile does not fit", "Make A or C smaller.")
    one, two = _joined(one, two)
    center = (one.end + two.start) / 2.0
    start, end = one.beside(-aside).end, two.beside(-aside).start
    made = Part(start, end)
    if corner.rounds:
        made = Part(start, end, center, max((start - center).imag, (end - center).imag) > 0.0)
    return [replace(before, end=start), made, replace(after, start=end)]


def moved_off(profile: Sequence[Part], distance: float) -> list[Part]:
    """Return a profile moved off by a distance to the side that its first part, the way to it, comes from.

    Raises:
        GeometryError: it has nothing left.
    """
    first, parts = profile[0], list(profile[1:])
    if not parts:
        raise GeometryError("the profile has one move only", "Write the way to its beginning first.")
    approach, across = first.end - first.start, parts[-1].start - first.start
    if across != 0.0 and (approach / across).imag < 0.0:
        distance = -distance
    gone, rounds = 0.0, 0
    while gone != distance:
        rounds += 1
        least = min([part.size / 2.0 for part in parts] + [abs(distance - gone)])
        if rounds > _MOST_ROUNDS:
            raise GeometryError("the profile cannot be moved off so far", "Make D smaller.")
        step = math.copysign(least, distance)
        parts = [part for each in parts if (part := each.beside(step)).size >= SHORT]
        parts = _shortened(_bridged(parts, step, distance > 0.0))
        if not parts:
            raise GeometryError("nothing of the profile is left so far off", "Make D smaller.")
        gone = distance if least == abs(distance - gone) else gone + step
    for at, (one, two) in enumerate(pairwise(parts)):
        middle = (one.end + two.start) / 2.0
        parts[at], parts[at + 1] = replace(one, end=middle), replace(parts[at + 1], start=middle)
    return [replace(first, end=parts[0].start), *parts]


def _bridged(parts: Sequence[Part], step: float, ccw: bool) -> list[Part]:
    """Return parts with an arc about their corner between those that have left a gap."""
    found = [*parts[:1]]
    for one, two in pairwise(parts):
        if (one.end - two.start).real > GAP:
            center = (one.beside(-step).end + two.beside(-step).start) / 2.0
            found.append(Part(one.end, two.start, center, ccw))
        found.append(two)
    return found


def _shortened(parts: list[Part]) -> list[Part]:
    """Return parts that end where the next ones begin, without those that go back."""
    at = 0
    while at < len(parts) - 1:
        if not parts[at].goes_on:
            before = max(at - 1, 0)
            del parts[at if parts[at].size < parts[before].size or at == 0 else before]
            at = 0
        if at + 1 >= len(parts):
            break
        if parts[at].size < SHORT:
            del parts[at]
            at = 0
        else:
            parts[at], parts[at + 1] = _joined(parts[at], parts[at + 1])
        at += 1
    return parts


def _joined(one: Part, two: Part) -> tuple[Part, Part]:
    """Return two parts with the one point where they meet as end and start."""
    if one.center is not None and two.center is not None:
        meets = _meeting_of_arcs(one, two, one.center, two.center)
    elif one.center is None and two.center is None:
        meets = _meeting_of_lines(one, two)
    elif abs(two.start - one.end) < NEAR:
        meets = None
    elif one.center is not None:
        meets = _meeting(two.start, two.end, one.end, one.center, two.start)
    else:
        assert two.center is not None
        meets = _meeting(one.start, one.end, two.end, two.center, two.start)
    return (one, two) if meets is None else (replace(one, end=meets), replace(two, start=meets))


def _meeting_of_lines(one: Part, two: Part) -> complex:
    along = (two.start - two.end).conjugate() / abs(two.start - two.end)
    start, end = (one.start - two.end) * along, (one.end - two.end) * along
    if start.imag == end.imag:
        raise GeometryError("two lines of the profile meet nowhere", "Make D smaller, or one line of them.")
    share = start.imag / (start.imag - end.imag)
    return (start + share * (end - start)) / along + two.end


def _meeting(start: complex, end: complex, on: complex, center: complex, near: complex) -> complex:
    """Return where a line meets the circle about `center` through `on`, the point next to `near`."""
    along = (start - end).conjugate() / abs(start - end)
    middle = (center - end) * along
    half = math.sqrt(max(abs(center - on) ** 2 - middle.imag**2, 0.0))
    found = [(middle.real + side * half) / along + end for side in (1.0, -1.0)]
    return min(found, key=lambda point: abs(near - point))


def _meeting_of_arcs(one: Part, two: Part, first: complex, second: complex) -> complex | None:
    own, other, apart = abs(two.start - second), abs(one.start - first), abs(second - first)
    if apart == 0.0:
        return None
    cosine = (apart * apart + own * own - other * other) / 2.0 / own / apart
    turn = complex(cosine, math.sqrt(1.0 - min(cosine * cosine, 1.0)))
    return turn * (first - second) / apart * own + second


def goes_on(parts: Iterable[Part]) -> bool:
    """Tell whether no part goes back along Z."""
    return all(part.goes_on for part in parts)
