"""Turning cycles as geometry: a contour and a few numbers go in, the steps of the tool come out.

Points are (x, z) in mm, x the radius. A cycle that works along Z (G71, G74) and its twin that works along X (G72, G75)
are one: the second sees the world with its axes exchanged.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from polycnc.nc.blocks._moves import GeometryError

SAME_MM = 1e-9
MOST_PASSES = 100_000

Point = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Piece:
    """A line of a contour, or with `center` an arc; `sweep_rad` is positive from Z to X (counter-clockwise in ZX)."""

    start: Point
    end: Point
    center: Point | None = None
    sweep_rad: float = 0.0

    def shifted(self, by: Point) -> Piece:
        """Return the same piece elsewhere."""
        center = None if self.center is None else _add(self.center, by)
        return replace(self, start=_add(self.start, by), end=_add(self.end, by), center=center)

    def exchanged(self) -> Piece:
        """Return the piece with its axes exchanged."""
        center = None if self.center is None else self.center[::-1]
        return Piece(self.start[::-1], self.end[::-1], center, -self.sweep_rad)


@dataclass(frozen=True, slots=True)
class Step:
    """A step of the tool: straight to `end`, or along `arc`; `thread` steps go with the spindle."""

    end: Point
    rapid: bool = False
    arc: Piece | None = None
    thread: bool = False

    def exchanged(self) -> Step:
        """Return the step with its axes exchanged."""
        return replace(self, end=self.end[::-1], arc=None if self.arc is None else self.arc.exchanged())


@dataclass(frozen=True, slots=True)
class Turning:
    """What turning cycles keep: the motion in force, its corner and taper, and what the first blocks of cycles said.

    Corner (machine coordinates) and taper are None and 0 before they were programmed. Lengths are mm, along X radii.
    """

    motion: str = ""
    corner: tuple[float | None, float | None] = (None, None)
    taper: float = 0.0
    rough: tuple[float, float] = (0.0, 0.5)  # G71: depth, escape
    face: tuple[float, float] = (0.0, 0.5)  # G72
    relief: tuple[float, float, int] = (0.0, 0.0, 1)  # G73: along X, along Z, passes
    retract: float = 0.0  # G74, G75
    finishing: int = 1  # G76
    chamfer: float = 1.0  # leads
    angle_deg: float = 60.0
    least: float = 0.0
    allowance: float = 0.0


@dataclass(frozen=True, slots=True)
class Roughing:
    """The numbers of G71 and G72: depth of a cut, escape, allowances along X (a radius) and Z."""

    depth_mm: float
    escape_mm: float
    allowance: Point


def _add(a: Point, b: Point) -> Point:
    return a[0] + b[0], a[1] + b[1]


def _sign(value: float) -> float:
    return (value > 0.0) - (value < 0.0)


def exchanged(steps: Sequence[Step]) -> list[Step]:
    """Return steps with their axes exchanged."""
    return [step.exchanged() for step in steps]


# ------------------------------------------------------------------ roughing along Z (G71)


def rough(contour: Sequence[Piece], numbers: Roughing, *, first_rapid: bool) -> list[Step]:
    """Return the steps of roughing along Z, from the start of the first piece and back to it.

    The first piece is the way from the start to the contour, along X; `first_rapid` says that it is a rapid, and so
    are the infeeds. The others rise steadily from there, in X and along Z.

    Raises:
        GeometryError: The contour does not, or a number makes no sense.
    """
    start = contour[0].start
    rest = [piece.shifted(numbers.allowance) for piece in contour[1:]]
    if not rest:
        raise GeometryError("the contour has one block only", "Give it two blocks and more.")
    if abs(contour[0].end[1] - start[1]) > SAME_MM:
        raise GeometryError(
            "the first block of the contour moves the axis along which is roughed",
            "Let it go to the first diameter (G71) or the first Z (G72) only.",
        )
    x_way = _sign(contour[0].end[0] - start[0])
    z_way = _sign(contour[-1].end[1] - contour[0].end[1])
    if z_way == 0.0:
        raise GeometryError("the contour comes back to where it begins", "End it where the part ends.")
    if x_way == 0.0:
        raise GeometryError("the contour leaves nothing to rough", "Start away from it.")
    _check_steady(rest, x_way, z_way)
    check_top(contour, x_way)
    if numbers.depth_mm <= 0.0:
        raise GeometryError("the depth of a cut is not above zero", "Give U (G71) or W (G72) above 0.")
    corner = _add(start, numbers.allowance)
    bottom = rest[0].start[0]
    count = math.ceil((abs(bottom - corner[0]) - SAME_MM) / numbers.depth_mm) - 1
    if count > MOST_PASSES:
        raise GeometryError(f"roughing would take {count} passes", "Give a larger depth of a cut.")
    steps = [Step(corner, rapid=True)] if corner != start else []
    for number in range(1, count + 1):
        level = corner[0] + x_way * number * numbers.depth_mm
        at = _crossing(rest, level, x_way)
        escape = level - x_way * numbers.escape_mm
        steps.append(Step((level, corner[1]), rapid=first_rapid))
        steps.append(Step((level, at)))
        steps.append(Step((escape, at - z_way * numbers.escape_mm), rapid=True))
        steps.append(Step((escape, corner[1]), rapid=True))
    steps.append(Step(rest[0].start, rapid=first_rapid))
    steps += [along(piece) for piece in rest]
    return [*steps, *back(rest[-1].end, start)]


def back(at: Point, start: Point) -> list[Step]:
    """Return the way from the end of a contour to the start: along X first."""
    steps = [] if abs(at[0] - start[0]) < SAME_MM else [Step((start[0], at[1]), rapid=True)]
    return steps if abs(at[1] - start[1]) < SAME_MM else [*steps, Step(start, rapid=True)]


def along(piece: Piece) -> Step:
    """Return the step along a piece."""
    return Step(piece.end, arc=None if piece.center is None else piece)


def _check_steady(pieces: Sequence[Piece], x_way: float, z_way: float) -> None:
    """Refuse a contour that turns back in one of its axes."""
    for piece in pieces:
        points = [piece.start, *extremes(piece), piece.end]
        for before, after in itertools.pairwise(points):
            if (after[0] - before[0]) * x_way > SAME_MM or (after[1] - before[1]) * z_way < -SAME_MM:
                raise GeometryError(
                    "the contour turns back, and its first block names one axis",
                    "Name both in it (add W0 for G71, U0 for G72): then pockets are cut.",
                )


def check_top(contour: Sequence[Piece], x_way: float) -> None:
    """Refuse a contour that goes in Z beyond where the cycle begins: the way back would cross the part.

    Raises:
        GeometryError: It does.
    """
    top = contour[0].start[0]
    for piece in contour:
        out = min((x - top) * x_way for x, _ in (piece.start, *extremes(piece), piece.end))
        if out < -SAME_MM and abs(piece.end[1] - piece.start[1]) > SAME_MM:
            raise GeometryError("the contour comes out beyond the start", "Start further away from it.")


def extremes(piece: Piece) -> list[Point]:
    """Return the points of an arc where it turns back in an axis, in their order."""
    if piece.center is None:
        return []
    first = angle_of(piece.start, piece.center)
    radius = math.dist(piece.start, piece.center)
    way = _sign(piece.sweep_rad)
    found = []
    quarter = math.ceil(first / (0.5 * math.pi)) if way > 0 else math.floor(first / (0.5 * math.pi))
    while (quarter * 0.5 * math.pi - (first + piece.sweep_rad)) * way < -SAME_MM:
        angle = quarter * 0.5 * math.pi
        if abs(angle - first) > SAME_MM:
            found.append(
                (piece.center[0] + radius * math.sin(angle), piece.center[1] + radius * math.cos(angle))
            )
        quarter += int(way)
    return found


def angle_of(point: Point, center: Point) -> float:
    """Return the angle of a point seen from a centre, positive from Z to X."""
    return math.atan2(point[0] - center[0], point[1] - center[1])


def _crossing(pieces: Sequence[Piece], level: float, x_way: float) -> float:
    """Return the Z at which a contour that rises steadily comes to a level; its end, if it stays below."""
    for piece in pieces:
        if (level - piece.end[0]) * x_way < -SAME_MM:
            continue
        rise = piece.end[0] - piece.start[0]
        if piece.center is None:
            if abs(rise) < SAME_MM:
                return piece.start[1]
            return piece.start[1] + (piece.end[1] - piece.start[1]) * (level - piece.start[0]) / rise
        radius = math.dist(piece.start, piece.center)
        half = math.sqrt(max(radius**2 - (level - piece.center[0]) ** 2, 0.0))
        low, high = sorted((piece.start[1], piece.end[1]))
        candidates = (piece.center[1] - half, piece.center[1] + half)
        return min(candidates, key=lambda z: max(low - z, z - high, 0.0))
    return pieces[-1].end[1]


# ------------------------------------------------------------------ repeating a pattern (G73)


def repeat(
    contour: Sequence[Piece], relief: Point, passes: int, allowance: Point, *, first_rapid: bool
) -> list[Step]:
    """Return the steps of a contour that is cut `passes` times, from `relief` (x, z) away down to the allowance.

    Raises:
        GeometryError: A number makes no sense.
    """
    if not 1 <= passes <= MOST_PASSES:
        raise GeometryError(f"{passes} passes cannot be", "Give R and the number of passes from 1 up.")
    steps: list[Step] = []
    for number in range(passes):
        share = 1.0 - number / (passes - 1) if passes > 1 else 0.0
        by = allowance[0] + share * relief[0], allowance[1] + share * relief[1]
        steps.append(Step(_add(contour[0].start, by), rapid=True))
        steps.append(Step(_add(contour[0].end, by), rapid=first_rapid))
        steps += [along(piece.shifted(by)) for piece in contour[1:]]
    return [*steps, *back(_add(contour[-1].end, by), contour[0].start)]


# ------------------------------------------------------------------ grooves and holes (G74, G75)


@dataclass(frozen=True, slots=True)
class Pecking:
    """The numbers of G74: Z of the bottom, last X, peck along Z, step along X, retract of a peck, relief at the bottom.

    `peck_mm` 0 goes in without a stop, `step_mm` 0 makes one groove only.
    """

    bottom: float
    last: float
    peck_mm: float
    step_mm: float
    retract_mm: float
    relief_mm: float


def peck(start: Point, numbers: Pecking) -> list[Step]:
    """Return the steps of pecking along Z at one X or several, from `start` and back to it.

    Raises:
        GeometryError: A number makes no sense.
    """
    across, depth = numbers.last - start[0], numbers.bottom - start[1]
    if abs(across) > SAME_MM and numbers.step_mm <= 0.0:
        raise GeometryError(
            "several grooves without the step between them", "Give P (G74) or Q (G75) above 0."
        )
    if numbers.peck_mm < 0.0 or numbers.relief_mm < 0.0 or numbers.retract_mm < 0.0:
        raise GeometryError("a negative peck, retract or relief", "Write it from 0 up.")
    grooves = _stops(start[0], numbers.last, numbers.step_mm)
    levels = _stops(start[1], numbers.bottom, numbers.peck_mm)[1:] if depth else []
    if len(grooves) * len(levels) > MOST_PASSES:
        raise GeometryError("more pecks than a groove is worth", "Give larger steps.")
    way, side = _sign(depth), _sign(across)
    steps: list[Step] = []
    for number, x in enumerate(grooves):
        if number:
            steps.append(Step((x, start[1]), rapid=True))
        for level in levels:
            steps.append(Step((x, level)))
            if level != levels[-1] and numbers.retract_mm:
                steps.append(Step((x, level - way * numbers.retract_mm), rapid=True))
        if levels and numbers.relief_mm and number:
            x -= side * numbers.relief_mm
            steps.append(Step((x, levels[-1]), rapid=True))
        steps.append(Step((x, start[1]), rapid=True))
    return steps if abs(x - start[0]) < SAME_MM else [*steps, Step(start, rapid=True)]


def _stops(begin: float, end: float, step: float) -> list[float]:
    """Return `begin`, then every `step` towards `end`, and `end`."""
    way = end - begin
    if abs(way) < SAME_MM:
        return [begin]
    if step <= 0.0:
        return [begin, end]
    count = math.ceil((abs(way) - SAME_MM) / step)
    if count > MOST_PASSES:
        raise GeometryError(f"{count} steps are more than a groove is worth", "Give a larger step.")
    return [begin + _sign(way) * step * number for number in range(count)] + [end]


# ------------------------------------------------------------------ single cuts (G90, G92, G94)


def box(
    start: Point, corner: Point, taper: float, *, thread: bool = False, chamfer: float = 0.0
) -> list[Step]:
    """Return the four steps of a cut along Z: in, along, out, back; `taper` is added to x where the cut begins.

    A thread is left along a line of 45 degrees over the last `chamfer`.
    """
    begin = corner[0] + taper, start[1]
    return [Step(begin, rapid=True), *_cut(begin, corner, start[0], thread, chamfer), Step(start, rapid=True)]


def _cut(begin: Point, end: Point, out: float, thread: bool, chamfer: float) -> Iterator[Step]:
    way = _sign(end[1] - begin[1])
    chamfer = min(chamfer, abs(end[1] - begin[1]))
    if thread and chamfer > 0.0:
        share = chamfer / abs(end[1] - begin[1])
        x = end[0] + (begin[0] - end[0]) * share
        leave = _sign(out - end[0])
        yield Step((x, end[1] - way * chamfer), thread=True)
        yield Step((x + leave * min(chamfer, abs(out - x)), end[1]), thread=True)
    else:
        yield Step(end, thread=thread)
    yield Step((out, end[1]), rapid=thread)


# ------------------------------------------------------------------ threads in many passes (G76)


@dataclass(frozen=True, slots=True)
class Threading:
    """The numbers of G76: end of the thread at its root, taper, height, first depth, least depth, allowance, lead.

    `finishing` passes cut the full height; `angle_deg` is that of the tool: it goes in along a flank. The last
    `chamfer_leads` leads go out along 45 degrees. All along X are radii.
    """

    end: Point
    taper: float
    height_mm: float
    first_mm: float
    least_mm: float
    allowance_mm: float
    finishing: int
    angle_deg: float
    chamfer_leads: float
    lead_mm: float


def thread_depths(numbers: Threading) -> list[float]:
    """Return the depth of every pass: equal areas of chip, but each at least `least_mm` deeper than the one before.

    Raises:
        GeometryError: A number makes no sense.
    """
    if numbers.height_mm <= 0.0 or numbers.first_mm <= 0.0:
        raise GeometryError("height or first depth of the thread is not above zero", "Give P and Q above 0.")
    rough = numbers.height_mm - numbers.allowance_mm
    if numbers.allowance_mm < 0.0 or rough <= 0.0:
        raise GeometryError("the allowance is no part of the thread's height", "Give R from 0 up, below P.")
    depths: list[float] = []
    depth, number = 0.0, 1
    while depth < rough - SAME_MM:
        depth = min(max(numbers.first_mm * math.sqrt(number), depth + numbers.least_mm), rough)
        depths.append(depth)
        number += 1
        if number > MOST_PASSES:
            raise GeometryError("more passes than a thread is worth", "Give larger depths.")
    return depths + [numbers.height_mm] * numbers.finishing


def threads(start: Point, numbers: Threading) -> list[Step]:
    """Return the steps of a thread in many passes, from `start` and back to it."""
    way = _sign(numbers.end[1] - start[1])
    inwards = _sign(numbers.end[0] + numbers.taper - start[0])
    if way == 0.0 or inwards == 0.0:
        raise GeometryError("the thread has no length, or lies where the tool is", "Check X and Z.")
    chamfer = numbers.chamfer_leads * numbers.lead_mm
    slope = math.tan(math.radians(0.5 * numbers.angle_deg))
    steps: list[Step] = []
    for depth in thread_depths(numbers):
        missing = -inwards * (numbers.height_mm - depth)
        z = start[1] + way * depth * slope
        begin = numbers.end[0] + numbers.taper + missing, z
        end = numbers.end[0] + missing, numbers.end[1]
        steps.append(Step((start[0], z), rapid=True))
        steps.append(Step(begin, rapid=True))
        steps += _cut(begin, end, start[0], True, chamfer)
        steps.append(Step(start, rapid=True))
    return steps
