"""Drilling cycles as moves: what happens at one hole, whether the control does it by a cycle of its own or not."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Literal, NamedTuple, TypeAlias

from polycnc.post.tool_path._records import Cycle, Vector

MOST_PECKS = 100_000

StepKind: TypeAlias = Literal["rapid", "feed", "dwell", "reverse", "forward"]


class Step(NamedTuple):
    """One step at a hole: a rapid or a feed to a point, a pause, or the spindle turning over."""

    kind: StepKind
    point: Vector


class Levels(NamedTuple):
    """Heights at one hole along the tool axis, counted from its point; `travel` is on the way to it."""

    travel: float
    start: float
    bottom: float
    out: float


def levels_of(cycle: Cycle, here: float | None, initial: float | None) -> Levels:
    """Return the heights at a hole.

    `here` is where the tool stands and `initial` where it stood before the first hole of the cycle, both counted
    from the point of this hole along the tool axis; None where that is not known.
    """
    start = cycle.clearance
    out = cycle.out if cycle.out is not None else initial
    out = start if out is None else max(out, start)
    travel = max(start, out) if here is None else max(here, start, out)
    return Levels(travel, start, -cycle.depth, out)


def hole_steps(
    cycle: Cycle,
    point: Vector,
    axis: Vector,
    here: Vector | None,
    levels: Levels,
    chip_break_mm: float,
    reentry_mm: float,
) -> Iterator[Step]:
    """Yield the steps at a hole; moves to where the tool stands already are left out."""
    before = None if here is None else _level(here, point, axis)
    if here is not None and before is not None and before < levels.travel:
        yield Step("rapid", _at(here, axis, levels.travel - before))
    yield from (Step("rapid", _at(point, axis, level)) for level in (levels.travel, levels.out, levels.start))
    for kind, level in _cuts(cycle, levels, chip_break_mm, reentry_mm):
        yield Step(kind, _at(point, axis, level))
    yield Step("rapid", _at(point, axis, levels.out))


def without_pecks(cycle: Cycle) -> Cycle:
    """Return a cycle that cuts the same hole at once."""
    return cycle._replace(kind="drill") if cycle.kind in ("deep", "chip_break") else cycle


def peck_depths(cycle: Cycle, levels: Levels) -> list[float]:
    """Return the levels at which a cycle with pecks backs up, each counted from the start of the feed."""
    count = math.ceil((levels.start - levels.bottom - 1e-9) / cycle.peck)
    return [levels.start - number * cycle.peck for number in range(1, min(count, MOST_PECKS))]


def _cuts(
    cycle: Cycle, levels: Levels, chip_break_mm: float, reentry_mm: float
) -> Iterator[tuple[StepKind, float]]:
    """Yield what is done between the start of the feed and the way out."""
    bottom = levels.bottom
    if cycle.kind in ("deep", "chip_break"):
        for depth in peck_depths(cycle, levels):
            yield "feed", depth
            if cycle.kind == "deep":
                yield "rapid", levels.start
                yield "rapid", min(depth + reentry_mm, levels.start)
            else:
                yield "rapid", min(depth + chip_break_mm, levels.start)
    yield "feed", bottom
    if cycle.dwell_s > 0.0:
        yield "dwell", bottom
    if cycle.kind == "tap":
        yield "reverse", bottom
    if cycle.kind in ("tap", "bore"):
        yield "feed", levels.start
    if cycle.kind == "tap":
        yield "forward", levels.start


def _level(here: Vector, point: Vector, axis: Vector) -> float:
    return sum((a - b) * n for a, b, n in zip(here, point, axis, strict=True))


def _at(point: Vector, axis: Vector, level: float) -> Vector:
    return point[0] + level * axis[0], point[1] + level * axis[1], point[2] + level * axis[2]


def level_of(here: Vector | None, point: Vector, axis: Vector) -> float | None:
    """Return how high the tool stands above the point of a hole, along the tool axis."""
    return None if here is None else _level(here, point, axis)
